//! The JSON Schema of scene files, for editors: what completes keys and shows their descriptions.
//!
//! It is made from the types in [`super::spec`]; their docs are its descriptions.

use schemars::{
    Schema,
    generate::SchemaSettings,
    transform::{RecursiveTransform, Transform},
};
use serde_json::{Value, json};

use super::spec::{SceneSpec, VERSION};

/// The schema as JSON text. It is written for draft 7, which all editors of TOML know.
#[must_use]
pub fn schema() -> String {
    let settings = SchemaSettings::draft07().with(|settings| settings.inline_subschemas = true);
    let mut schema = settings.into_generator().into_root_schema_for::<SceneSpec>();
    RecursiveTransform(without_null).transform(&mut schema);
    schema.insert("title".to_owned(), json!("Scene of zeroset"));
    require_version(&mut schema);
    format!("{:#}\n", schema.to_value())
}

/// `version` is looked at before all else, so it has no type.
fn require_version(schema: &mut Schema) {
    let version = json!({
        "description": "The version of the format.",
        "const": VERSION.parse::<u32>().unwrap_or_default(),
    });
    if let Some(properties) = schema.pointer_mut("/properties").and_then(Value::as_object_mut) {
        properties.insert("version".to_owned(), version);
    }
    if let Some(required) = schema.pointer_mut("/required").and_then(Value::as_array_mut) {
        required.insert(0, json!("version"));
    }
}

/// What is optional may be left out, but TOML has no null.
fn without_null(schema: &mut Schema) {
    let is_null = |value: &Value| value == "null" || value == &json!({ "type": "null" });
    for key in ["type", "enum"] {
        if let Some(Value::Array(choices)) = schema.get_mut(key) {
            choices.retain(|choice| !is_null(choice) && !choice.is_null());
            if let ("type", [only]) = (key, choices.as_slice()) {
                let only = only.clone();
                schema.insert(key.to_owned(), only);
            }
        }
    }
    let Some(Value::Array(choices)) = schema.get_mut("anyOf") else { return };
    choices.retain(|choice| !is_null(choice));
    if let [Value::Object(only)] = choices.as_slice() {
        let only = only.clone();
        schema.remove("anyOf");
        for (key, value) in only {
            // The words of the place say more than those of the type.
            if schema.get(&key).is_none() {
                schema.insert(key, value);
            }
        }
    }
}
