use super::*;
use proptest::prelude::*;

/// What is complained about, with the text that it marks.
fn mistakes(text: &str) -> Vec<(String, String)> {
    let mistakes = read(text).unwrap_err();
    mistakes.into_iter().map(|m| (m.message, text[m.span].to_owned())).collect()
}

/// What is computed.
fn program(expr: &Expr) -> String {
    format!("{:?} {}", expr.tape().instructions(), expr.tape().result())
}

fn program_of(formula: &str) -> String {
    let ast = super::super::parse(formula).unwrap();
    program(&Expr::resolve(&ast, &[]).unwrap().expr)
}

#[test]
fn operations_are_what_formulas_call_otherwise() {
    let operations = [
        ("add _x _y", "x + y"),
        ("sub _x _y", "x - y"),
        ("mul _x _y", "x y"),
        ("div _x _y", "x/y"),
        ("neg _x", "-x"),
        ("recip _x", "1/x"),
        ("square _x", "x^2"),
        ("sqrt _x", "sqrt(x)"),
        ("abs _x", "|x|"),
        ("not _x", "1 - |sign(x)|"),
        ("min _x _y", "min(x, y)"),
        ("max _x _y", "max(x, y)"),
        ("compare _x _y", "sign(x - y)"),
        ("mod _x _y", "mod(x, |y|)"),
        ("exp _x", "e^x"),
        ("ln _x", "ln(x)"),
        ("sin _x", "sin(x)"),
        ("cos _x", "cos(x)"),
        ("tan _x", "tan(x)"),
        ("asin _x", "asin(x)"),
        ("acos _x", "acos(x)"),
        ("atan _x", "atan(x)"),
        ("atan2 _x _y", "atan2(x, y)"),
        ("floor _x", "floor(x)"),
        ("ceil _x", "ceil(x)"),
        ("round _x", "round(x)"),
        ("var-z", "z"),
        ("const -1.5e1", "-15"),
        ("const +0.1", "0.1"),
    ];
    for (operation, formula) in operations {
        let text = format!("_x var-x\n_y var-y\n_ {operation}");
        assert_eq!(program(&read(&text).unwrap()), program_of(formula), "{operation}");
    }
}

#[test]
fn remainders_are_euclidean() {
    for (a, b) in [(7.5_f64, 2.0), (-7.5, 2.0), (7.5, -2.0), (-7.5, -2.0), (0.0, 3.0)] {
        let text = format!("_a const {a}\n_b const {b}\n_ mod _a _b");
        let remainder = read(&text).unwrap().constant();
        assert_eq!(remainder, Some(a.rem_euclid(b)), "{a} mod {b}");
    }
}

#[test]
fn constants_enclose_their_decimals() {
    let constant = |written: &str| {
        let expr = read(&format!("_0 const {written}")).unwrap();
        *expr.graph.nodes()[expr.root as usize].constant().unwrap()
    };
    for (written, value) in [("-11", -11.0), ("+.5", 0.5), ("1E3", 1e3), ("-0", 0.0), ("2.", 2.0)] {
        assert_eq!(constant(written).as_exact(), Some(value), "{written}");
    }
    for (written, value) in [("0.1", 0.1), ("-0.92795134", -0.927_951_34), ("1e-400", 0.0)] {
        let c = constant(written);
        assert!(c.lo < value && c.value == value && value < c.hi, "{written}: {c:?}");
    }
}

#[test]
fn names_are_any_words_and_layout_is_free() {
    let text = "\u{feff}# a sphere\r\n\r\nx var-x # east\r\n  \t_é  square   x\r\n1 const 1#\r\n\
                f sub _é 1\r\n# the end";
    assert_eq!(program(&read(text).unwrap()), program_of("x^2 - 1"));
}

#[test]
fn what_the_result_does_not_need_is_dropped() {
    let text = "_x var-x\n_y var-y\n_a sin _y\n_b add _x _x";
    assert_eq!(program(&read(text).unwrap()), program_of("x + x"));
    assert_eq!(read("_x var-x\n_x2 square _x").unwrap().graph.nodes().len(), 2);
}

#[test]
fn mistakes_are_found_where_they_are() {
    for (text, message, marked) in [
        ("", "the file has no operation", ""),
        ("# nothing\n\n", "the file has no operation", ""),
        ("_x var-x\n_", "`_` has no operation", "_"),
        ("_x var-w", "unknown operation `var-w`", "var-w"),
        ("_x var-x\n_r rand _x", "no formula can express the operation `rand`", "rand"),
        ("_x var-x 1", "`var-x` takes no operand, not 1", "var-x"),
        ("_x var-x\n_n neg _x _x", "`neg` takes 1 operand, not 2", "neg"),
        ("_x var-x\n_m min _x", "`min` takes 2 operands, not 1", "min"),
        ("_x var-x\n_m max _x _x _x", "`max` takes 2 operands, not 3", "max"),
        ("_0 const", "`const` takes 1 operand, not 0", "const"),
        ("_x var-x\n_n neg _y", "`_y` is not defined", "_y"),
        ("_n neg _n", "`_n` is not defined", "_n"),
        ("_n neg _x\n_x var-x", "`_x` is not defined", "_x"),
        ("_x var-x\n_x var-y", "`_x` is defined twice", "_x"),
        ("_x var-x\nneg _x", "the line does not name its result", "neg"),
        ("_0 const 1,5", "`1,5` is not a number", "1,5"),
        ("_0 const inf", "`inf` is not a number", "inf"),
        ("_0 const -nan", "`-nan` is not a number", "-nan"),
        ("_0 const --1", "`--1` is not a number", "--1"),
        ("_0 const .", "`.` is not a number", "."),
        ("_0 const -1e999", "the number `-1e999` is too large", "-1e999"),
    ] {
        assert_eq!(mistakes(text), [(message.to_owned(), marked.to_owned())], "{text}");
    }
    let help = read("_n neg _x\n_x var-x").unwrap_err()[0].help.clone();
    assert_eq!(help.as_deref(), Some("line 2 defines it; an operand is a name of a line above"));
}

#[test]
fn one_run_finds_many_mistakes_and_each_once() {
    let text = "_a foo _x\n_b add _a _p\n_c sub _q _r\nneg _a\n_d mul _b _c\n";
    let marked: Vec<String> = mistakes(text).into_iter().map(|(_, marked)| marked).collect();
    assert_eq!(marked, ["foo", "_p", "_q", "_r", "neg"]);
    assert_eq!(mistakes(&"_n sub _p _q\n".repeat(1000)).len(), MAX_MISTAKES);
}

#[test]
fn long_words_are_cut_in_messages() {
    let (message, marked) = mistakes(&format!("_x {}", "é".repeat(1000))).remove(0);
    assert!(message.chars().count() < 100 && marked.len() == 2000, "{message}");
}

/// Neither recursion nor time that grows faster than the text.
#[test]
fn long_chains_are_read() {
    let mut text = "_0 var-x\n".to_owned();
    (1..100_000).for_each(|i| text += &format!("_{i} sin _{}\n", i - 1));
    let expr = read(&text).unwrap();
    assert_eq!(expr.graph.nodes().len(), 100_000);
    assert_eq!(expr.root, 99_999);
}

proptest! {
    #[test]
    fn soup_gives_an_answer_with_spans_in_the_text(
        soup in "(_[abc]|_x var-x|add|neg|min|const|var-y|mod|1e|-2.5|#|é|\u{feff}|\r|\t| | |\n|\n){0,60}",
    ) {
        match read(&soup) {
            Ok(expr) => prop_assert!(expr.tape().n_slots() >= 3),
            Err(mistakes) => {
                prop_assert!(!mistakes.is_empty());
                for mistake in mistakes {
                    prop_assert!(soup.get(mistake.span.clone()).is_some(), "{mistake:?}");
                }
            }
        }
    }
}
