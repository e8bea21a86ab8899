//! `[params]`, `[let]`, `[shapes]` and `--set`: the names that all formulas of a scene share.
//!
//! Which names there are is settled here; what they stand for is the business of
//! [`crate::expr::Expr::resolve`].

use std::{borrow::Cow, ops::Range};

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use toml::{
    Spanned,
    de::{DeTable, DeValue},
};

use super::{explain::kind_of_value, formula::Formula, lower::Lower};
use crate::{
    diagnostic::{Diagnostic, Origin, did_you_mean},
    expr::{Ast, Definition, DefinitionKind, Node, parse},
};

/// The coordinates keep their meaning.
const COORDINATES: [&str; 3] = ["x", "y", "z"];

/// The entries of `[params]`, `[let]` or `[shapes]`, in the order of the file.
#[derive(Clone, Debug, Default)]
pub(super) struct Named(Vec<Entry>);

/// One name with its value.
#[derive(Clone, Debug)]
struct Entry {
    /// As it is written.
    name: String,
    span: Range<usize>,
    formula: Formula,
}

impl JsonSchema for Named {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "Named".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "type": "object",
            "additionalProperties": { "type": ["number", "string"] },
        })
    }
}

impl Named {
    /// Reads a section of names. A value that is refused is noted, and stands as 1.
    pub(super) fn read(table: DeTable<'_>, source: &str, errors: &mut Vec<Diagnostic>) -> Self {
        let entry = |(key, value): (Spanned<Cow<'_, str>>, Spanned<DeValue<'_>>)| {
            let formula = formula(&value, source).unwrap_or_else(|error| {
                errors.push(error);
                Formula::of_number("1", value.span(), source)
            });
            Entry { span: key.span(), name: key.into_inner().into_owned(), formula }
        };
        let mut entries: Vec<Entry> = table.into_iter().map(entry).collect();
        entries.sort_by_key(|entry| entry.span.start);
        Self(entries)
    }

    /// The same entries, read as shapes.
    pub(super) fn into_shapes(self) -> Self {
        let shape = |entry: Entry| Entry { formula: entry.formula.into_shape(), ..entry };
        Self(self.0.into_iter().map(shape).collect())
    }

    /// The same entries in another text.
    pub(super) fn in_text(self, origin: Origin) -> Self {
        let moved = |entry: Entry| Entry { formula: entry.formula.in_text(origin), ..entry };
        Self(self.0.into_iter().map(moved).collect())
    }

    /// Puts entries of an included file before these.
    pub(super) fn include(&mut self, included: Self) {
        self.0.splice(..0, included.0);
    }

    /// Without the entries that `other` has as well.
    pub(super) fn without(mut self, other: &Self) -> Self {
        let name = |entry: &Entry| identifier(&entry.name);
        self.0.retain(|entry| !other.0.iter().any(|other| name(other) == name(entry)));
        self
    }
}

/// The formula that a value in the file stands for.
fn formula(value: &Spanned<DeValue<'_>>, source: &str) -> Result<Formula, Diagnostic> {
    let span = value.span();
    let text = match value.get_ref() {
        DeValue::String(text) => return Ok(Formula::of_string(text, span, source)),
        DeValue::Float(number) if number.as_str().contains(['n', 'N']) => {
            return Err(Diagnostic::new(span, "expected a finite number"));
        }
        DeValue::Float(number) => number.as_str().to_owned(),
        DeValue::Integer(number) if number.radix() == 10 => number.as_str().to_owned(),
        DeValue::Integer(number) => {
            let value = i64::from_str_radix(number.as_str(), number.radix());
            let too_large = |_| Diagnostic::new(span.clone(), "the number is too large");
            value.map_err(too_large)?.to_string()
        }
        other => {
            return Err(Diagnostic::new(span, "expected a number or a formula in quotes")
                .label(format!("this is {}", kind_of_value(other))));
        }
    };
    Ok(Formula::of_number(&text, span, source))
}

/// A setting of the command line, taken apart.
struct Setting {
    name: String,
    formula: Formula,
    ast: Option<Ast>,
}

impl Lower<'_> {
    /// Makes the definitions of the scene known to all formulas that are resolved afterwards.
    /// Parameters that change have their values in `frame`, which counts from 0.
    pub(super) fn define(&mut self, params: &Named, lets: &Named, shapes: &Named, frame: u32) {
        let mut settings = self.settings(params, lets);
        let params = params.0.iter().map(|entry| (DefinitionKind::Parameter, entry));
        let lets = lets.0.iter().map(|entry| (DefinitionKind::Let, entry));
        let shapes = shapes.0.iter().map(|entry| (DefinitionKind::Shape, entry));
        for (kind, entry) in params.chain(lets).chain(shapes) {
            let ast = self.parse(&entry.formula);
            let Some(name) = self.name(entry) else { continue };
            let set = settings.iter().rposition(|set| set.name == name);
            let (formula, ast) = match set.filter(|_| kind == DefinitionKind::Parameter) {
                Some(index) => {
                    let set = settings.swap_remove(index);
                    (set.formula, set.ast)
                }
                None => match self.tracks.iter().find(|track| track.name == name) {
                    Some(track) => {
                        let formula = track.formula(frame, self.source);
                        let ast = self.parse(&formula);
                        (formula, ast)
                    }
                    None => (entry.formula.clone(), ast),
                },
            };
            // An empty tree stands for a formula that could not be read.
            let ast = ast.unwrap_or_else(|| Ast { nodes: Vec::new() });
            self.definitions.push(Definition { name, kind, ast });
            self.formulas.push(formula);
        }
    }

    /// The name of an entry, if it may be defined.
    fn name(&mut self, entry: &Entry) -> Option<String> {
        let mistake = match identifier(&entry.name) {
            None => Diagnostic::new(entry.span.clone(), format!("`{}` is no name", entry.name))
                .label("cannot stand in a formula")
                .help("a name has letters, digits and `_`, and begins with a letter"),
            Some(name) if COORDINATES.contains(&name.as_str()) => {
                Diagnostic::new(entry.span.clone(), format!("`{name}` is a coordinate"))
                    .label("cannot mean anything else")
                    .help("choose another name")
            }
            Some(name) if self.definitions.iter().any(|known| known.name == name) => {
                Diagnostic::new(entry.span.clone(), format!("`{name}` is defined twice"))
                    .label("the second one")
                    .help(
                        "names of [params], [let] and [shapes] must differ, also in included files",
                    )
            }
            Some(name) => return Some(name),
        };
        self.errors.push(Diagnostic { origin: entry.formula.origin(), ..mistake });
        None
    }

    /// What was set on the command line, as far as it makes sense. Of two settings of a name the
    /// last one counts.
    fn settings(&mut self, params: &Named, lets: &Named) -> Vec<Setting> {
        let mut settings: Vec<Setting> = Vec::new();
        for (index, argument) in self.settings.iter().enumerate() {
            match split(argument) {
                Ok((name, value)) => {
                    let formula = Formula::in_setting(index, argument, value);
                    let ast = self.parse(&formula);
                    match settable(&argument[name.clone()], params, lets) {
                        Ok(set) => match self.tracks.iter().find(|track| track.name == set) {
                            Some(track) => {
                                let message = format!("`{set}` cannot be set");
                                let mistake = Diagnostic::new(name, message)
                                    .label("changes from frame to frame")
                                    .help(format!("its values stand in {}", track.section));
                                self.errors.push(in_setting(index, mistake));
                            }
                            None => {
                                settings.retain(|other| other.name != set);
                                settings.push(Setting { name: set, formula, ast });
                            }
                        },
                        Err(help) => {
                            let set = &argument[name.clone()];
                            let mistake = no_parameter(name, set, &help);
                            self.errors.push(in_setting(index, mistake));
                        }
                    }
                }
                Err(mistake) => self.errors.push(in_setting(index, mistake)),
            }
        }
        settings
    }
}

fn in_setting(index: usize, mistake: Diagnostic) -> Diagnostic {
    Diagnostic { origin: Origin::Setting(index), ..mistake }
}

/// The places of name and value in `name=value`.
fn split(argument: &str) -> Result<(Range<usize>, Range<usize>), Diagnostic> {
    const HELP: &str = "write --set name=value, as in --set a=0.5 or --set \"a=sqrt(2)/2\"";
    let mistake = |span: Range<usize>, message: &str| Diagnostic::new(span, message).help(HELP);
    let Some(equals) = argument.find('=') else {
        return Err(mistake(0..argument.len(), "the setting has no value").label("no `=` in here"));
    };
    let trimmed = |part: Range<usize>| {
        let text = &argument[part.clone()];
        let start = part.start + text.len() - text.trim_start().len();
        start..start + text.trim().len()
    };
    let (name, value) = (trimmed(0..equals), trimmed(equals + 1..argument.len()));
    match (name.is_empty(), value.is_empty()) {
        (true, _) => Err(mistake(equals..equals + 1, "the setting has no name")),
        (_, true) => Err(mistake(equals..equals + 1, "the setting has no value")),
        _ => Ok((name, value)),
    }
}

/// The name of a parameter, or what to say to one who writes another.
pub(super) fn settable(written: &str, params: &Named, lets: &Named) -> Result<String, String> {
    let name = identifier(written).unwrap_or_else(|| written.to_owned());
    let has =
        |named: &Named| named.0.iter().any(|entry| identifier(&entry.name).as_ref() == Some(&name));
    if has(params) {
        return Ok(name);
    }
    if has(lets) {
        return Err(format!(
            "`{name}` is defined in [let]; what can be set is defined in [params]"
        ));
    }
    let known: Vec<&str> = params.0.iter().map(|entry| entry.name.as_str()).collect();
    let list = match known.as_slice() {
        [] => "the scene has no [params]".to_owned(),
        _ => format!("[params] has {}", known.join(", ")),
    };
    Err(match did_you_mean(&name, known) {
        Some(meant) => format!("did you mean `{meant}`? {list}"),
        None => list,
    })
}

/// That `written` is no parameter.
pub(super) fn no_parameter(span: Range<usize>, written: &str, help: &str) -> Diagnostic {
    Diagnostic::new(span, format!("the scene has no parameter `{written}`")).help(help)
}

/// The name that formulas know `written` by, if it is one.
fn identifier(written: &str) -> Option<String> {
    match parse(written).ok()?.nodes.as_slice() {
        [(Node::Name(name), span)] if *span == (0..written.len()) => Some(name.clone()),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_are_split_at_the_first_equals_sign() {
        assert_eq!(split("a=0.5"), Ok((0..1, 2..5)));
        assert_eq!(split(" a = b = c "), Ok((1..2, 5..10)));
        for bad in ["", "a", "=1", "a=", " = "] {
            assert!(split(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn names_are_what_formulas_take_for_names() {
        assert_eq!(identifier("a_1").as_deref(), Some("a_1"));
        for bad in ["", "2a", "a-b", "a b", "(a)", " a", "1"] {
            assert_eq!(identifier(bad), None, "{bad}");
        }
    }
}
