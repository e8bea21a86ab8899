//! What the schema says about the values of a scene file.

use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde_json::json;

use super::leaf::{Background, Color, Detail, Ends, Number, Numbers, Table, Target, Whole};

/// `JsonSchema` for types whose schema is written out wherever they occur.
macro_rules! schemas {
    ($($type:ident: $schema:expr;)*) => {$(
        impl JsonSchema for $type {
            fn inline_schema() -> bool {
                true
            }

            fn schema_name() -> Cow<'static, str> {
                stringify!($type).into()
            }

            fn json_schema(_: &mut SchemaGenerator) -> Schema {
                $schema
            }
        }
    )*};
}

schemas! {
    Number: json_schema!({ "type": "number" });
    Whole: json_schema!({ "type": "integer" });
    Detail: json_schema!({ "anyOf": [{ "type": "integer" }, { "const": "auto" }] });
    Ends: json_schema!({ "type": "array", "items": end(), "minItems": 2, "maxItems": 2 });
    Target: json_schema!({ "type": ["boolean", "string"] });
    Color: json_schema!({ "anyOf": [hex(), components()] });
    Background: json_schema!({ "anyOf": [{ "const": "transparent" }, hex(), components()] });
}

/// A number. JSON has no infinite ones: what leads TOML there makes them null.
fn end() -> serde_json::Value {
    json!({ "anyOf": [{ "type": "number" }, { "const": null }] })
}

/// "#rrggbb"
fn hex() -> serde_json::Value {
    json!({ "type": "string", "pattern": "^#[0-9a-fA-F]{6}$" })
}

/// `[r, g, b]`
fn components() -> serde_json::Value {
    let component = json!({ "type": "number", "minimum": 0, "maximum": 1 });
    json!({ "type": "array", "items": component, "minItems": 3, "maxItems": 3 })
}

impl<const N: usize> JsonSchema for Numbers<N> {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        format!("Numbers{N}").into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "type": "array",
            "items": { "type": "number" },
            "minItems": N,
            "maxItems": N,
        })
    }
}

impl<T: JsonSchema> JsonSchema for Table<T> {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        T::schema_name()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        T::json_schema(generator)
    }
}
