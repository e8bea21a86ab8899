//! Tests of names, functions and definitions: values, mistakes with their places, limits.

use proptest::prelude::*;

use super::*;
use crate::{
    diagnostic::Diagnostic,
    expr::{Instruction, parse},
    math::{Constant, Notes, Number, Point},
};

/// Parameters are written `a: 1`, parts `a = x`.
fn definitions(lines: &[&str]) -> Vec<Definition> {
    let definition = |line: &&str| {
        let (kind, sign) = match line.contains(':') {
            true => (DefinitionKind::Parameter, ':'),
            false => (DefinitionKind::Let, '='),
        };
        let (name, formula) = line.split_once(sign).unwrap();
        Definition { name: name.trim().to_owned(), kind, ast: parse(formula).unwrap() }
    };
    lines.iter().map(definition).collect()
}

fn resolved(text: &str, lines: &[&str]) -> Resolved {
    resolve(&parse(text).unwrap(), &definitions(lines)).unwrap()
}

fn mistakes(text: &str, lines: &[&str]) -> Vec<Mistake> {
    resolve(&parse(text).unwrap(), &definitions(lines)).unwrap_err()
}

/// The only mistake.
fn mistake(text: &str, lines: &[&str]) -> (Option<usize>, Diagnostic) {
    let mistakes = mistakes(text, lines);
    assert_eq!(mistakes.len(), 1, "{mistakes:?}");
    (mistakes[0].definition, mistakes[0].diagnostic.clone())
}

/// The value of a formula at a point.
fn value(expr: &Expr, point: [f64; 3]) -> f64 {
    let tape = expr.tape();
    let mut slots: Vec<[Point<f64>; 1]> = point.map(|c| [Point(c)]).to_vec();
    slots.resize(tape.n_slots(), [Point(0.0)]);
    let mut notes = [Notes::clear::<f64>(())];
    for instruction in tape.instructions() {
        match *instruction {
            Instruction::Constant(c, out) => slots[out as usize] = [Point::constant((), &c)],
            Instruction::Unary(op, a, out) => {
                op.apply(&mut slots, &mut notes, (a as usize, out as usize));
            }
            Instruction::Binary(op, a, b, out) => {
                op.apply(&mut slots, &mut notes, (a as usize, b as usize, out as usize));
            }
            Instruction::BinaryConstant(op, a, c, out) => {
                op.apply_constant(&mut slots, &mut notes, (a as usize, out as usize), &c);
            }
        }
    }
    slots[tape.result()][0].0
}

fn at(text: &str, point: [f64; 3]) -> f64 {
    value(&resolved(text, &[]).expr, point)
}

#[test]
fn functions_have_their_values() {
    for (text, wanted) in [
        ("tau - 2pi", 0.0),
        ("cbrt(-8)", -2.0),
        ("log2(8)", 3.0),
        ("log10(1000)", 3.0),
        ("ln(e)", 1.0),
        ("tan(x)", libm::tan(0.7)),
        ("asin(x)", libm::asin(0.7)),
        ("acos(x)", libm::acos(0.7)),
        ("atan(x)", libm::atan(0.7)),
        ("atan2(x, y)", libm::atan2(0.7, -1.25)),
        ("sinh(x)", libm::sinh(0.7)),
        ("cosh(x)", libm::cosh(0.7)),
        ("tanh(x)", libm::tanh(0.7)),
        ("tan(2theta)", libm::tan(2.0 * libm::atan2(-1.25, 0.7))),
        ("sign(y)", -1.0),
        ("floor(y)", -2.0),
        ("ceil(y)", -1.0),
        ("round(-2.5)", -3.0),
        ("mod(y, 1)", 0.75),
        ("mod(x, -1)", 0.7 - 1.0),
        ("mod(7, 3)", 1.0),
        ("clamp(y, -1, 1)", -1.0),
        ("hypot(3, 4)", 5.0),
        ("hypot(2, 3, 6)", 7.0),
        ("pow(2, 10)", 1024.0),
        ("min(3, 1, 2) + max(3, 1, 2)", 4.0),
        ("step(0.7, x)", 1.0),
        ("step(0.71, x)", 0.0),
        ("step(0.5, x)", 1.0),
        ("smoothstep(0, 1, 0.25)", 0.15625),
        ("smoothstep(1, 2, 7)", 1.0),
        ("smoothstep(1, 0, 1)", 0.0),
        ("mix(1, 3, 0.25)", 1.5),
        ("smin(1, 1, 1)", 0.75),
        ("smax(1, 1, 1)", 1.25),
        ("smin(1, 3, 1)", 1.0),
        ("smin(1, 1.5, 1)", 1.0 - 0.0625),
        ("smin(1, 2, 0)", 1.0),
        ("sin²(x) + cos²(x)", 1.0),
    ] {
        let found = at(text, [0.7, -1.25, 0.0]);
        assert!((found - wanted).abs() < 1e-12, "{text} = {found}, not {wanted}");
    }
}

#[test]
fn relations_become_differences() {
    for (text, wanted, relation) in [
        ("x - 1", 1.0, Relation::Value),
        ("x = 5", -3.0, Relation::Equation),
        ("x <= 5", -3.0, Relation::Solid),
        ("x >= 5", 3.0, Relation::Solid),
        ("5 > x", -3.0, Relation::Solid),
    ] {
        let resolved = resolved(text, &[]);
        let found = value(&resolved.expr, [2.0, 0.0, 0.0]);
        assert_eq!((found, resolved.relation), (wanted, relation), "{text}");
    }
}

#[test]
fn definitions_may_use_each_other_in_any_order() {
    let lines = ["b = a*x + c", "a: 2k", "k: 3/2", "c = y^k2", "k2: 2"];
    let resolved = resolved("b + a", &lines);
    assert_eq!(value(&resolved.expr, [10.0, 3.0, 0.0]), 42.0);
    assert!(resolved.warnings.is_empty());
}

#[test]
fn greek_letters_are_their_names() {
    assert_eq!(value(&resolved("α x + λ", &["alpha: 2", "λ: 1"]).expr, [3.0, 0.0, 0.0]), 7.0);
}

#[test]
fn definitions_hide_built_in_names_with_a_warning() {
    let lines = ["phi: (1+√5)/2", "e: 1", "r: 2"];
    let resolved = resolved("phi x + r phi", &lines);
    let golden = (1.0 + 5.0_f64.sqrt()) / 2.0;
    assert_eq!(value(&resolved.expr, [1.0, 0.0, 0.0]), 3.0 * golden);
    let warned: Vec<_> = resolved.warnings.iter().map(|w| w.definition).collect();
    assert_eq!(warned, [Some(0), Some(2)]); // e is not used
    let warning = &resolved.warnings[0].diagnostic;
    assert_eq!(warning.message, "`phi` is defined here and hides the angle from the z axis `phi`");
    assert_eq!(warning.span, 1..11);
}

#[test]
fn cycles_are_shown_once() {
    let (definition, diagnostic) = mistake("c", &["a = b + 1", "b = x + c", "c = a", "d = c"]);
    assert_eq!(diagnostic.message, "`a` is defined by itself: a -> b -> c -> a");
    assert_eq!((definition, diagnostic.span), (Some(2), 1..2));
    let (definition, diagnostic) = mistake("1", &["q = 2q"]);
    assert_eq!(diagnostic.message, "`q` is defined by itself: q -> q");
    assert_eq!((definition, diagnostic.span), (Some(0), 2..3));

    let long: Vec<String> = (0..100).map(|i| format!("a{i} = a{}", (i + 1) % 100)).collect();
    let long: Vec<&str> = long.iter().map(String::as_str).collect();
    let shown = "a0 -> a1 -> a2 -> a3 -> (93 more) -> a97 -> a98 -> a99 -> a0";
    assert!(mistake("x", &long).1.message.ends_with(shown));
}

#[test]
fn parameters_are_constants() {
    let (definition, diagnostic) = mistake("a", &["a: 2x"]);
    assert_eq!(diagnostic.message, "the parameter `a` depends on `x`");
    assert_eq!((definition, diagnostic.span), (Some(0), 2..3));
    let (_, diagnostic) = mistake("a", &["b = theta", "a: 1 + b"]);
    assert_eq!(diagnostic.message, "the parameter `a` depends on `b`");
    assert_eq!(value(&resolved("a", &["b = 2", "a: b^2"]).expr, [0.0; 3]), 4.0);

    for formula in ["1/0", "ln(-1)", "exp(1000)", "1/floor(0.5)"] {
        let (definition, diagnostic) = mistake("a x", &[&format!("a: {formula}")]);
        assert_eq!((definition, diagnostic.message.as_str()), (Some(0), "`a` has no value"));
    }
    for formula in ["floor(2)", "sign(0)", "0^(1/3)", "round(2.5)", "sqrt(0)"] {
        resolved("a x", &[&format!("a: {formula}")]);
    }
}

#[test]
fn names_of_definitions_are_checked() {
    for (line, message) in [
        ("2a: 1", "`2a` cannot be a name in a formula"),
        ("a-b = 1", "`a-b` cannot be a name in a formula"),
        (" = 1", "`` cannot be a name in a formula"),
        ("sin: 1", "`sin` is a function and cannot be defined anew"),
    ] {
        let (definition, diagnostic) = mistake("x", &[line]);
        assert_eq!((definition, diagnostic.message.as_str()), (Some(0), message));
    }
    let (definition, diagnostic) = mistake("a", &["a: 1", "a = x"]);
    assert_eq!((definition, diagnostic.message.as_str()), (Some(1), "`a` is defined twice"));
    let relation =
        Definition { ast: parse("x < 1").unwrap(), ..definitions(&["a = x"])[0].clone() };
    let found = resolve(&parse("a").unwrap(), &[relation]).unwrap_err();
    assert_eq!(found[0].diagnostic.message, "a definition is a value");
}

#[test]
fn mistakes_say_where_and_what_instead() {
    for (text, span, help) in [
        (
            "1 + foo",
            4..7,
            "known names are a, b1, x, y, z, r, theta, phi, rho, pi, tau, e; others are defined in [params] or [let]",
        ),
        (
            "tehta",
            0..5,
            "did you mean `theta`? known names are a, b1, x, y, z, r, theta, phi, rho, pi, tau, e",
        ),
        (
            "PI",
            0..2,
            "did you mean `pi`? known names are a, b1, x, y, z, r, theta, phi, rho, pi, tau, e",
        ),
        ("2xyz", 1..4, "write `x*y*z` for a product"),
        ("ax^2", 0..2, "write `a*x` for a product"),
        ("1 + sin", 4..7, "write its argument in parentheses: `sin(…)`"),
        ("Sqrt(x)", 0..4, "did you mean `sqrt`?"),
        ("sqr(x)", 0..3, "did you mean `sqrt`?"),
        ("arctan(x)", 0..6, "write `atan(a)`"),
        ("log(x)", 0..3, "write `ln` for the natural one, `log10` or `log2`"),
        ("x(y+1)", 0..1, "to multiply, write `x*(…)`"),
        ("a(y+1)", 0..1, "to multiply, write `a*(…)`"),
        ("atan2(x)", 0..5, "write `atan2(y, x)`"),
        ("max(x)", 0..3, "write `max(a, b, …)`"),
        ("smin(x, y)", 0..4, "write `smin(a, b, radius)`"),
        ("sin()", 0..3, "write `sin(a)`"),
    ] {
        let (definition, diagnostic) = mistake(text, &["a: 1", "b1 = x"]);
        assert_eq!(definition, None);
        assert_eq!((diagnostic.span, diagnostic.help.as_deref()), (span, Some(help)), "{text}");
    }
    let (definition, diagnostic) = mistake("x", &["a: 1", "b = sin + 1"]);
    assert_eq!((definition, diagnostic.span), (Some(1), 1..4));
}

#[test]
fn all_mistakes_are_found_up_to_a_limit() {
    assert_eq!(mistakes("foo(1) + bar + max(x)", &["a: q", "b: x"]).len(), 5);
    assert_eq!(mistakes(&("foo+".repeat(1000) + "1"), &[]).len(), MAX_MISTAKES);
}

#[test]
fn what_a_refused_definition_breaks_is_no_mistake() {
    let refused = Definition { ast: Ast::default(), ..definitions(&["a: 1"])[0].clone() };
    let lines = [refused, definitions(&["b: a"])[0].clone()];
    assert_eq!(resolve(&parse("b").unwrap(), &lines).unwrap_err(), []);
    let found = resolve(&parse("b + q").unwrap(), &lines).unwrap_err();
    assert_eq!(found.len(), 1);
    assert!(resolve(&parse("x").unwrap(), &lines).is_ok());
}

/// Runs on the smallest stack that a worker thread has.
fn on_a_small_stack(test: impl FnOnce() + Send + 'static) {
    let thread = std::thread::Builder::new().stack_size(256 << 10).spawn(test).unwrap();
    thread.join().unwrap();
}

fn chain(n: usize, first: &str, formula: impl Fn(usize) -> String) -> Vec<Definition> {
    let ast = |i| parse(&if i == 0 { first.to_owned() } else { formula(i - 1) }).unwrap();
    let definition =
        |i| Definition { name: format!("a{i}"), kind: DefinitionKind::Let, ast: ast(i) };
    (0..n).rev().map(definition).collect()
}

#[test]
fn sizes_and_chains_are_no_danger() {
    on_a_small_stack(|| {
        // A chain whose end comes first.
        let definitions = chain(10_000, "x", |i| format!("a{i} + 1"));
        let resolved = resolve(&parse("a9999").unwrap(), &definitions).unwrap();
        assert_eq!(value(&resolved.expr, [1.0, 0.0, 0.0]), 10_000.0);

        // 2¹⁰⁰ x, and the same inside a wave: nothing is written out.
        let definitions = chain(101, "theta", |i| format!("a{i} + a{i}"));
        for (text, n) in [("a100", 105), ("sin(a100)", 106)] {
            let resolved = resolve(&parse(text).unwrap(), &definitions).unwrap();
            assert!(resolved.expr.tape().instructions().len() < n);
        }
        let definitions = chain(10_000, "theta", |i| format!("a{i} * 2"));
        assert!(resolve(&parse("cos(a9999)").unwrap(), &definitions).is_ok());

        for (text, depth) in [("x+", 10_000), ("x^", 10_000), ("sin(x)*", 10_000), ("-", 10_000)] {
            let ast = parse(&(text.repeat(depth) + "y")).unwrap();
            let _ = resolve(&ast, &[]).unwrap().expr.tape();
        }
        for open in ["(1+", "sin(x+", "max(x,-(y*", "|1+"] {
            let close = if open.starts_with('|') { "|" } else { ")" };
            let close = close.repeat(500 * open.matches(['(', '|']).count());
            let ast = parse(&(open.repeat(500) + "z" + &close)).unwrap();
            let _ = resolve(&ast, &[]).unwrap().expr.tape();
        }
    });
}

/// The longest texts of every shape, well formed or not: quadratic time would be minutes.
#[test]
fn long_texts_take_linear_time() {
    let begun = std::time::Instant::now();
    let shapes = [
        "x+",
        "x ",
        "-",
        "x^",
        "x^-",
        "√",
        "x²",
        "(",
        "(x)",
        "|",
        "x|",
        "|x|",
        "2|x|+",
        "x/",
        "x^2y",
        "max(x,",
        "sin(x)",
        "f(",
        ",",
        "=",
        "x<",
        "foo+",
        "a+",
        "b*",
        "sin²(x)",
        "1/2*",
        "smin(x,y,1)-",
        "|x||",
        "-√",
        "x^(2)",
        "2^3*",
    ];
    let lines = definitions(&["a: 1", "b = x"]);
    for shape in shapes {
        let n_tokens = shape.chars().filter(|c| *c != ' ').count();
        for end in ["", "y"] {
            let Ok(ast) = parse(&(shape.repeat(100_000 / n_tokens - 1) + end)) else { continue };
            if let Ok(resolved) = resolve(&ast, &lines) {
                let _ = resolved.expr.tape();
            }
        }
    }
    assert!(begun.elapsed().as_secs() < 60, "{:?}", begun.elapsed());
}

#[test]
fn parts_are_shared() {
    let lines = ["s = sin(x*y) + 1", "t = s^2"];
    let shared = resolved("t + s*t", &lines).expr.tape();
    let once = resolved("(sin(x*y) + 1)^2 + (sin(x*y) + 1)*(sin(x*y) + 1)^2", &[]).expr.tape();
    assert_eq!(shared.instructions().len(), once.instructions().len());
    assert_eq!(shared.instructions().len(), 6);
}

#[test]
fn constants_of_the_language_are_enclosed() {
    let Resolved { expr, .. } = resolved("x = tau", &[]);
    let constants = expr.tape();
    let tau = constants.instructions().iter().find_map(|instruction| match instruction {
        Instruction::BinaryConstant(_, _, c, _) => Some(*c),
        _ => None,
    });
    let Constant { lo, hi, .. } = tau.unwrap();
    assert!(lo < -std::f64::consts::TAU && -std::f64::consts::TAU < hi);
}

fn soup() -> impl Strategy<Value = String> {
    "([-+*/^(),|=<> ]|[a-f]|x|theta|phi|2|\\.5|²|√|π|≤|sin\\(|max\\(|smin\\(|mod\\(|foo|\\(a|\\)){0,30}"
}

proptest! {
    #[test]
    fn soup_with_definitions_gives_an_answer_with_spans_in_its_text(
        formula in soup(),
        texts in prop::collection::vec((prop::bool::ANY, soup()), 0..6),
    ) {
        let mut definitions = Vec::new();
        for (i, (is_parameter, text)) in texts.iter().enumerate() {
            let kind = if *is_parameter { DefinitionKind::Parameter } else { DefinitionKind::Let };
            let name = ["a", "b", "phi", "c", "d", "e"][i].to_owned();
            definitions.push(Definition { name, kind, ast: parse(text).unwrap_or_default() });
        }
        let Ok(ast) = parse(&formula) else { return Ok(()) };
        let said = match resolve(&ast, &definitions) {
            Ok(resolved) => {
                let _ = resolved.expr.tape();
                resolved.warnings
            }
            Err(mistakes) => mistakes,
        };
        for Mistake { definition, diagnostic } in said {
            let text = definition.map_or(&formula, |index| &texts[index].1);
            prop_assert!(text.get(diagnostic.span).is_some());
        }
    }
}
