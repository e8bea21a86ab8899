//! The JSON Schema of scene files: fresh, and true of the scenes that are there.
//!
//! `configs/schema.json` must be what `render schema` prints; `ZEROSET_BLESS=schema` (or `all`)
//! rewrites it, and the test fails nonetheless.

#![expect(clippy::unwrap_used, reason = "a test that cannot prepare its case has failed")]

use std::{
    env, fs,
    path::{Path, PathBuf},
    process::Command,
};

use serde_json::{Map, Value};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn committed() -> PathBuf {
    root().join("configs/schema.json")
}

fn schema() -> Value {
    serde_json::from_str(&fs::read_to_string(committed()).unwrap()).unwrap()
}

#[test]
fn it_is_fresh() {
    let output = Command::new(env!("CARGO_BIN_EXE_render")).arg("schema").output().unwrap();
    assert_eq!(output.status.code(), Some(0));
    let printed = String::from_utf8(output.stdout).unwrap();
    if fs::read_to_string(committed()).unwrap_or_default() == printed {
        return;
    }
    if env::var("ZEROSET_BLESS").is_ok_and(|wanted| wanted == "schema" || wanted == "all") {
        fs::write(committed(), printed).unwrap();
    }
    panic!("configs/schema.json is not what `render schema` prints: ZEROSET_BLESS=schema");
}

#[test]
fn shipped_scenes_are_valid_and_name_it() {
    let schema = schema();
    for (folder, first) in [("configs", "./schema.json"), ("gallery", "../configs/schema.json")] {
        let scenes = fs::read_dir(root().join(folder)).unwrap().map(|entry| entry.unwrap().path());
        for path in scenes.filter(|path| path.extension().is_some_and(|ending| ending == "toml")) {
            let text = fs::read_to_string(&path).unwrap();
            assert!(text.starts_with(&format!("#:schema {first}\n")), "{}", path.display());
            check(&toml::from_str(&text).unwrap(), &schema)
                .unwrap_or_else(|mistake| panic!("{}: {mistake}", path.display()));
        }
    }
}

#[test]
fn every_key_is_described() {
    fn described(schema: &Value, place: &str) {
        for (key, schema) in schema["properties"].as_object().into_iter().flatten() {
            let place = format!("{place}.{key}");
            assert!(schema["description"].is_string(), "{place} has no description");
            described(schema, &place);
            described(&schema["items"], &place);
        }
    }
    described(&schema(), "");
}

#[test]
fn mistakes_are_found() {
    let schema = schema();
    let mistake = |rest: &str| {
        let text = format!("version = 1\n[[surface]]\nf = 'x'\n{rest}");
        check(&toml::from_str(&text).unwrap(), &schema).unwrap_err()
    };
    for (scene, complaint) in [
        ("colour = '#ffffff'", "unknown key `colour`"),
        ("color = 'red'", "none of the choices"),
        ("inside = 'out'", "none of the choices"),
        ("specular = 2", "out of range"),
        ("[domain]\nmin = [0, 0]", "wrong length"),
        ("[voxels]\nresolution = 2.5", "none of the choices"),
        ("[image]\nwidth = 2.5", "expected integer"),
        ("[[light]]\nintensity = 1", "`direction` is missing"),
        ("[params]\na = true", "expected"),
        ("[light]\ndirection = [0, 0, 1]", "expected array"),
    ] {
        assert!(mistake(scene).contains(complaint), "{scene}: {}", mistake(scene));
    }
    assert!(check(&toml::from_str("version = 1").unwrap(), &schema).is_err());
    assert!(
        check(&toml::from_str("version = 2\nsurface = [{f = 'x'}]").unwrap(), &schema).is_err()
    );
}

/// Whether `value` obeys `schema`: as much of draft 7 as the schema uses, anything else panics.
fn check(value: &Value, schema: &Value) -> Result<(), String> {
    let schema = schema.as_object().unwrap();
    for (keyword, rule) in schema {
        match keyword.as_str() {
            "$schema" | "title" | "description" | "default" | "format" | "properties" => {}
            "type" => has_type(value, rule)?,
            "const" => expect(value == rule, "wrong constant")?,
            "enum" => {
                expect(rule.as_array().unwrap().contains(value), "none of the choices")?;
            }
            "anyOf" | "oneOf" => {
                let mut choices = rule.as_array().unwrap().iter();
                let fits = choices.any(|choice| check(value, choice).is_ok());
                expect(fits, "none of the choices")?;
            }
            "minimum" => in_range(value, |x| x >= rule.as_f64().unwrap())?,
            "maximum" => in_range(value, |x| x <= rule.as_f64().unwrap())?,
            "pattern" => is_color(value, rule)?,
            "minItems" => has_length(value, |n| n >= rule.as_u64().unwrap() as usize)?,
            "maxItems" => has_length(value, |n| n <= rule.as_u64().unwrap() as usize)?,
            "items" => {
                for element in value.as_array().into_iter().flatten() {
                    check(element, rule)?;
                }
            }
            "required" => {
                for key in rule.as_array().unwrap().iter().map(|key| key.as_str().unwrap()) {
                    expect(value.get(key).is_some(), &format!("`{key}` is missing"))?;
                }
            }
            "additionalProperties" => {}
            other => panic!("the test does not know `{other}`"),
        }
    }
    match value {
        Value::Object(table) => members(table, schema),
        _ => Ok(()),
    }
}

fn members(table: &Map<String, Value>, schema: &Map<String, Value>) -> Result<(), String> {
    for (key, value) in table {
        let known = schema.get("properties").and_then(|properties| properties.get(key));
        match (known, schema.get("additionalProperties")) {
            (Some(schema), _) => check(value, schema).map_err(|text| format!("`{key}`: {text}"))?,
            (None, Some(Value::Bool(false))) => return Err(format!("unknown key `{key}`")),
            (None, Some(schema)) => check(value, schema)?,
            (None, None) => {}
        }
    }
    Ok(())
}

fn expect(holds: bool, complaint: &str) -> Result<(), String> {
    if holds { Ok(()) } else { Err(complaint.to_owned()) }
}

fn has_type(value: &Value, rule: &Value) -> Result<(), String> {
    let is = |name: &Value| match name.as_str().unwrap() {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "boolean" => value.is_boolean(),
        "number" => value.is_number(),
        "integer" => value.is_i64() || value.is_u64(),
        other => panic!("unknown type {other}"),
    };
    let fits = rule.as_array().map_or_else(|| is(rule), |names| names.iter().any(is));
    expect(fits, &format!("expected {rule}").replace('"', ""))
}

fn in_range(value: &Value, holds: impl Fn(f64) -> bool) -> Result<(), String> {
    expect(value.as_f64().is_none_or(holds), "out of range")
}

fn has_length(value: &Value, holds: impl Fn(usize) -> bool) -> Result<(), String> {
    expect(value.as_array().is_none_or(|array| holds(array.len())), "wrong length")
}

/// The only pattern is that of a colour.
fn is_color(value: &Value, rule: &Value) -> Result<(), String> {
    assert_eq!(rule, "^#[0-9a-fA-F]{6}$");
    let is_color = |text: &str| {
        let digits = text.strip_prefix('#').unwrap_or_default();
        digits.len() == 6 && digits.chars().all(|digit| digit.is_ascii_hexdigit())
    };
    expect(value.as_str().is_none_or(is_color), "no colour")
}
