//! What must hold for any bytes: no panic, and every mistake marks text that is there.

use std::{ops::Range, path::Path};

use zeroset::{
    Error,
    expr::{Definition, DefinitionKind, Expr, parse, parse_shape},
    import, scene,
};

/// Reads the last line as a formula and those before it as definitions: `a: 1` is a parameter,
/// `a = x` a part. What is read is resolved and made a tape.
pub(crate) fn formula(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    let mut lines: Vec<&str> = text.split('\n').collect();
    let formula = lines.pop().unwrap_or_default();
    let mut formulas = Vec::new();
    let mut definitions = Vec::new();
    for line in lines {
        let Some(at) = line.find([':', '=']) else { continue };
        let is_parameter = line[at..].starts_with(':');
        let kind = if is_parameter { DefinitionKind::Parameter } else { DefinitionKind::Let };
        let ast = parse(&line[at + 1..]).unwrap_or_else(|mistakes| {
            mistakes.iter().for_each(|mistake| check_span(&line[at + 1..], &mistake.span));
            Default::default()
        });
        formulas.push(&line[at + 1..]);
        definitions.push(Definition { name: line[..at].trim().to_owned(), kind, ast });
    }
    shape(formula, &definitions);
    let ast = match parse(formula) {
        Ok(ast) => ast,
        Err(mistakes) => {
            return mistakes.iter().for_each(|mistake| check_span(formula, &mistake.span));
        }
    };
    ast.nodes.iter().for_each(|(_, span)| check_span(formula, span));
    let said = match Expr::resolve(&ast, &definitions) {
        Ok(resolved) => {
            assert!(resolved.expr.tape().n_slots() >= 3, "room for the coordinates");
            resolved.warnings
        }
        Err(mistakes) => mistakes,
    };
    for mistake in said {
        let text = mistake.definition.map_or(formula, |index| formulas[index]);
        check_span(text, &mistake.diagnostic.span);
    }
}

/// Reads the same as a shape.
fn shape(text: &str, definitions: &[Definition]) {
    let mistakes = match parse_shape(text) {
        Ok(ast) => match Expr::resolve_shape(&ast, definitions) {
            Ok(resolved) => {
                assert!(resolved.expr.tape().n_slots() >= 3, "room for the coordinates");
                return;
            }
            Err(mistakes) => {
                let own = mistakes.into_iter().filter(|mistake| mistake.definition.is_none());
                own.map(|mistake| mistake.diagnostic).collect()
            }
        },
        Err(mistakes) => mistakes,
    };
    mistakes.iter().for_each(|mistake| check_span(text, &mistake.span));
}

/// Reads a function graph.
pub(crate) fn graph(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    match Expr::from_vm(text) {
        Ok(expr) => assert!(expr.tape().n_slots() >= 3, "room for the coordinates"),
        Err(mistakes) => {
            assert!(!mistakes.is_empty(), "refused without a reason");
            mistakes.iter().for_each(|mistake| check_span(text, &mistake.span));
        }
    }
}

/// Reads a scene file. It has no folder, so that no file that it names is opened.
pub(crate) fn scene(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    if let Err(rejection) = scene::parse(Path::new("fuzz.toml"), text) {
        assert!(!rejection.diagnostics.is_empty(), "refused without a reason");
        assert!(rejection.sources.models.is_empty(), "a file was read");
        rejection.diagnostics.iter().for_each(|mistake| check_span(text, &mistake.span));
    }
}

/// Converts a file of another program, whose ending is the first line; what comes of it is a scene.
pub(crate) fn import(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    let Some((ending, text)) = text.split_once('\n') else { return };
    let path = Path::new("fuzz").with_extension(ending);
    match import::convert_text(&path, text.to_owned()) {
        Ok(converted) => {
            let scene = scene::parse(Path::new("fuzz.toml"), &converted.scene);
            assert!(scene.is_ok(), "{}\n{:?}", converted.scene, scene.err());
        }
        Err(Error::Scene(rejection)) => {
            assert!(!rejection.diagnostics.is_empty(), "refused without a reason");
            rejection.diagnostics.iter().for_each(|mistake| check_span(text, &mistake.span));
        }
        Err(_) => {}
    }
}

fn check_span(text: &str, span: &Range<usize>) {
    assert!(text.get(span.clone()).is_some(), "{span:?} is no part of {text:?}");
}
