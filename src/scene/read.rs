//! From TOML text to a [`SceneSpec`], with as many mistakes as can be found in one go.
//!
//! serde stops at the first mistake. So each section is read on its own, and where one of its
//! entries is refused, the rest is read again without it.

use std::ops::Range;

use serde::Deserialize;
use toml::{
    Spanned,
    de::{DeTable, DeValue, Deserializer},
};

use super::{
    definitions::Named,
    explain::{place_of_key, refused, unknown_section},
    spec::{AnimationSpec, SceneSpec, Section, SurfaceSpec, VERSION},
};
use crate::diagnostic::Diagnostic;

/// After so many mistakes in one section the reader goes on to the next.
const MAX_RETRIES: usize = 16;

/// Reads a scene file. The spec lacks every entry that `errors` complains about; there is none at
/// all if the text is not TOML or has another version.
pub(super) fn read(source: &str, errors: &mut Vec<Diagnostic>) -> Option<SceneSpec> {
    let (root, mistakes) = DeTable::parse_recoverable(source);
    if !mistakes.is_empty() {
        errors.extend(mistakes.iter().map(|mistake| syntax(mistake, source)));
        return None;
    }
    let root = root.into_inner();
    if let Err(error) = check_version(&root) {
        errors.push(error);
        return None;
    }
    Some(sections(root, source, errors))
}

/// TOML's own words, cut in message and label, with help for what people write often.
pub(super) fn syntax(error: &toml::de::Error, source: &str) -> Diagnostic {
    let (message, label) = match error.message().split_once(", expected ") {
        Some((message, expected)) => (message, format!("expected {expected}")),
        None => (error.message(), String::new()),
    };
    let span = error.span().unwrap_or(0..0);
    let written = source.get(span.clone()).unwrap_or_default();
    let number = number_of_quantity(written);
    let diagnostic = Diagnostic::new(span, message).label(label);
    match message {
        "string values must be quoted" if !number.is_empty() => Diagnostic {
            message: "a number has no unit".to_owned(),
            ..diagnostic
                .label("not a number")
                .help(format!("write {number}, or a formula in quotes"))
        },
        "string values must be quoted" => diagnostic
            .label("not in quotes")
            .help("write text and formulas in quotes, as in f = \"x^2 + y^2 = 1\""),
        "duplicate key" => diagnostic.label("given before").help(
            "remove one of the two; a second surface is a second [[surface]], in double brackets",
        ),
        "invalid key-value pair" => diagnostic
            .help("a scene is written in TOML: lines such as [section], key = value and # comment"),
        _ => diagnostic,
    }
}

/// The number of a quantity such as `3.5mm` or `10 voxels`; nothing if it is something else.
fn number_of_quantity(written: &str) -> &str {
    let is_digit = |c: char| c.is_ascii_digit() || c == '.';
    let digits = written.find(|c| !is_digit(c)).unwrap_or(written.len());
    let unit = written[digits..].trim_start();
    let is_unit = !unit.is_empty() && unit.chars().all(|c| c.is_alphabetic() || c == '%');
    if is_unit { &written[..digits] } else { "" }
}

pub(super) fn check_version(root: &DeTable<'_>) -> Result<(), Diagnostic> {
    let help = format!("this program reads `version = {VERSION}`");
    let Some((_, version)) = root.iter().find(|(key, _)| key.get_ref() == "version") else {
        return Err(Diagnostic::new(0..0, "the scene does not say its version")
            .help(format!("write `version = {VERSION}` as the first line")));
    };
    match version.get_ref() {
        DeValue::Integer(number) if number.as_str() == VERSION => Ok(()),
        DeValue::Integer(number) => {
            Err(Diagnostic::new(version.span(), format!("unknown version {number}"))
                .label("not supported")
                .help(help))
        }
        _ => Err(Diagnostic::new(version.span(), "the version is not a whole number").help(help)),
    }
}

fn sections(root: DeTable<'_>, source: &str, errors: &mut Vec<Diagnostic>) -> SceneSpec {
    let mut spec = SceneSpec::default();
    let mut has_surface = false;
    for (key, value) in root {
        let key_span = key.span();
        match key.get_ref().as_ref() {
            "version" => {}
            "surface" => {
                has_surface = true;
                spec.surfaces = surfaces(value, errors);
            }
            "model" => {
                let help = "a model is written in double brackets";
                spec.models = repeated("[[model]]", help, value, errors);
            }
            "volume" => {
                has_surface = true;
                let help = "a volume is written in double brackets";
                spec.volumes = repeated("[[volume]]", help, value, errors);
            }
            "sculpture" => {
                has_surface = true;
                let help = "a sculpture is written in double brackets";
                spec.sculptures = repeated("[[sculpture]]", help, value, errors);
            }
            "light" => {
                let help = "a light is written in double brackets";
                spec.lights = repeated("[[light]]", help, value, errors);
            }
            "about" => spec.about = section("[about]", value, errors),
            "params" => spec.params = names("[params]", value, source, errors),
            "let" => spec.lets = names("[let]", value, source, errors),
            "shapes" => spec.shapes = names("[shapes]", value, source, errors).into_shapes(),
            "include" => spec.include = file_names(value, errors),
            "domain" => spec.domain = section("[domain]", value, errors),
            "voxels" => spec.voxels = section("[voxels]", value, errors),
            "camera" => spec.camera = section("[camera]", value, errors),
            "image" => spec.image = section("[image]", value, errors),
            "output" => spec.output = section("[output]", value, errors),
            "mesh" => spec.mesh = section("[mesh]", value, errors),
            "animation" => spec.animation = Some(animation(value, errors)),
            "sweep" => spec.sweep = Some(section("[sweep]", value, errors)),
            unknown => errors.push(unknown_section(unknown, key_span)),
        }
    }
    if !has_surface {
        errors.push(
            Diagnostic::new(0..0, "the scene has no surface")
                .help("add [[surface]] and below it a formula, as in f = \"x^2 + y^2 + z^2 = 1\""),
        );
    }
    spec
}

fn surfaces(
    value: Spanned<DeValue<'_>>,
    errors: &mut Vec<Diagnostic>,
) -> Vec<Section<SurfaceSpec>> {
    if let DeValue::Array(array) = value.get_ref()
        && array.is_empty()
    {
        errors.push(Diagnostic::new(value.span(), "the scene has no surface"));
    }
    repeated("[[surface]]", "a surface is written in double brackets", value, errors)
}

/// Reads the section of a film, and those in it each on its own.
fn animation(
    mut value: Spanned<DeValue<'_>>,
    errors: &mut Vec<Diagnostic>,
) -> Section<AnimationSpec> {
    let (params, keys) = match value.get_mut() {
        DeValue::Table(table) => (table.remove("params"), table.remove("key")),
        _ => (None, None),
    };
    let mut animation: Section<AnimationSpec> = section("[animation]", value, errors);
    if let Some(params) = params {
        animation.spec.params = section("[animation.params]", params, errors);
    }
    if let Some(keys) = keys {
        let help = "a key of the camera is written in double brackets";
        animation.spec.key = repeated("[[animation.key]]", help, keys, errors);
    }
    animation
}

/// Reads all sections of a name that may stand several times.
fn repeated<'i, T: Deserialize<'i> + Default>(
    name: &str,
    complaint: &str,
    value: Spanned<DeValue<'i>>,
    errors: &mut Vec<Diagnostic>,
) -> Vec<Section<T>> {
    let span = value.span();
    let DeValue::Array(array) = value.into_inner() else {
        errors.push(Diagnostic::new(span, complaint).label(format!("expected {name}")));
        return Vec::new();
    };
    array.into_iter().map(|element| section(name, element, errors)).collect()
}

/// Reads `include`.
pub(super) fn file_names(
    value: Spanned<DeValue<'_>>,
    errors: &mut Vec<Diagnostic>,
) -> Vec<super::spanned::Spanned<String>> {
    let span = value.span();
    let names = Vec::deserialize(toml::de::ValueDeserializer::from(value));
    names.unwrap_or_else(|_| {
        errors.push(
            Diagnostic::new(span, "expected names of files")
                .help("write them in square brackets, as in include = [\"parts.toml\"]"),
        );
        Vec::new()
    })
}

/// Reads a section whose keys the user chooses.
pub(super) fn names(
    name: &str,
    value: Spanned<DeValue<'_>>,
    source: &str,
    errors: &mut Vec<Diagnostic>,
) -> Named {
    let span = value.span();
    let table = match value.into_inner() {
        DeValue::Table(table) => table,
        DeValue::Array(_) => {
            let mistake = Diagnostic::new(span, format!("{name} is written in single brackets"));
            errors.push(mistake.label(format!("expected {name}")));
            return Named::default();
        }
        _ => {
            errors.push(no_table(name, span));
            return Named::default();
        }
    };
    Named::read(table, source, errors)
}

fn no_table(name: &str, span: Range<usize>) -> Diagnostic {
    Diagnostic::new(span, format!("{name} is a section"))
        .label("expected a table, with its keys on the lines below it")
}

/// Reads one section, without the entries that are refused.
fn section<'i, T: Deserialize<'i> + Default>(
    name: &str,
    value: Spanned<DeValue<'i>>,
    errors: &mut Vec<Diagnostic>,
) -> Section<T> {
    let span = value.span();
    let damaged = Section { spec: T::default(), span: span.clone(), is_damaged: true };
    let DeValue::Table(mut table) = value.into_inner() else {
        errors.push(no_table(name, span));
        return damaged;
    };
    for n_refused in 0..MAX_RETRIES {
        let deserializer = Deserializer::from(Spanned::new(span.clone(), table.clone()));
        let error = match T::deserialize(deserializer) {
            Ok(spec) => return Section { spec, span, is_damaged: n_refused > 0 },
            Err(error) => error,
        };
        let at = error.span().unwrap_or(span.clone());
        let culprit = entry_at(&table, &at);
        errors.push(refused(&error, at.clone(), &place_of_key(name, culprit, &at)));
        let Some(key) = culprit.map(|(key, _)| key.clone()) else { break };
        table.remove(&key);
    }
    damaged
}

/// An entry of a table.
pub(super) type Entry<'a, 'i> = (&'a Spanned<std::borrow::Cow<'i, str>>, &'a Spanned<DeValue<'i>>);

/// The entry that a mistake at `at` belongs to.
fn entry_at<'a, 'i>(table: &'a DeTable<'i>, at: &Range<usize>) -> Option<Entry<'a, 'i>> {
    let covers = |span: Range<usize>| span.start <= at.start && at.end <= span.end;
    table.iter().find(|(key, value)| covers(key.span()) || covers(value.span()))
}
