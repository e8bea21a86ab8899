//! The values that a sweep gives to parameters, in the scene file.

use std::{borrow::Cow, collections::BTreeMap, fmt};

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{
    Deserialize, Deserializer,
    de::{Error, MapAccess, SeqAccess, Visitor, value::MapAccessDeserializer},
};

use crate::scene::{leaf::Number, spanned::Spanned};

/// Parameters with their values.
pub(in crate::scene) type SweepSpec = BTreeMap<Spanned<String>, Spanned<ValuesSpec>>;

const HELP: &str = "write the first value, the last one and how many, as in [0, 1, 11], or all of them, \
                    as in { values = [0, 0.2, 1] }";

/// The values of one parameter.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::scene) enum ValuesSpec {
    /// The first one, the last one and how many there are at even intervals.
    Even([f64; 3]),
    /// All of them.
    Listed(Vec<f64>),
}

/// `{ values = [...] }`
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Listed {
    values: Vec<Number>,
}

impl<'de> Deserialize<'de> for ValuesSpec {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(ValuesVisitor)
    }
}

struct ValuesVisitor;

impl<'de> Visitor<'de> for ValuesVisitor {
    type Value = ValuesSpec;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "values\n{HELP}")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<ValuesSpec, A::Error> {
        let mut numbers = Vec::new();
        while let Some(Number(number)) = seq.next_element()? {
            numbers.push(number);
        }
        let n = numbers.len();
        let wrong = |_| A::Error::custom(format!("expected 3 numbers, found {n}\n{HELP}"));
        numbers.try_into().map(ValuesSpec::Even).map_err(wrong)
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<ValuesSpec, A::Error> {
        let Listed { values } = Listed::deserialize(MapAccessDeserializer::new(map))?;
        Ok(ValuesSpec::Listed(values.into_iter().map(|Number(value)| value).collect()))
    }
}

impl JsonSchema for ValuesSpec {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "Values".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "anyOf": [
                { "type": "array", "items": { "type": "number" }, "minItems": 3, "maxItems": 3 },
                {
                    "type": "object",
                    "properties": {
                        "values": { "type": "array", "items": { "type": "number" }, "minItems": 1 },
                    },
                    "required": ["values"],
                    "additionalProperties": false,
                },
            ],
        })
    }
}
