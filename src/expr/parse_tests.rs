//! Tests of the parser: trees, spans, limits, and a round trip of random trees.

use proptest::prelude::*;

use super::{brackets::MAX_DEPTH, *};

/// The tree with all its brackets.
fn show(ast: &Ast) -> String {
    let mut shown: Vec<String> = Vec::new();
    for (node, _) in &ast.nodes {
        let at = |id: &NodeId| shown[*id as usize].as_str();
        let text = match node {
            Node::Number { text } | Node::Name(text) => text.clone(),
            Node::Named(name, a) => format!("{name}={}", at(a)),
            Node::Neg(a) => format!("(-{})", at(a)),
            Node::Abs(a) => format!("|{}|", at(a)),
            Node::Binary(op, a, b) => format!("({}{}{})", at(a), symbol(*op), at(b)),
            Node::Call(name, args) => {
                format!("{name}({})", args.iter().map(at).collect::<Vec<_>>().join(","))
            }
            Node::Equation(a, b) => format!("{}={}", at(a), at(b)),
            Node::Comparison(Comparison::AtMost, a, b) => format!("{}<={}", at(a), at(b)),
            Node::Comparison(Comparison::AtLeast, a, b) => format!("{}>={}", at(a), at(b)),
        };
        shown.push(text);
    }
    shown.pop().unwrap_or_default()
}

fn symbol(op: BinaryOp) -> char {
    match op {
        BinaryOp::Add => '+',
        BinaryOp::Sub => '-',
        BinaryOp::Mul => '*',
        BinaryOp::Div => '/',
        BinaryOp::Pow => '^',
        BinaryOp::Intersection => '&',
        BinaryOp::Union => '!',
    }
}

fn shown_shape(text: &str) -> String {
    show(&parse_shape(text).unwrap())
}

#[test]
fn signs_of_shapes_bind_loosely() {
    assert_eq!(shown_shape("a | b & c - d*2 | e"), "((a!(b&(c-(d*2))))!e)");
    assert_eq!(shown_shape("(a | b) & c ∩ d ∪ e"), "((((a!b)&c)&d)!e)");
    assert_eq!(shown_shape("a - b - c <= 0"), "((a-b)-c)<=0");
}

/// A bar after a value joins shapes, unless it closes an absolute value.
#[test]
fn bars_of_shapes_are_unions() {
    assert_eq!(shown_shape("sphere(|x|) | |y| | z"), "((sphere(|x|)!|y|)!z)");
    assert_eq!(shown_shape("|x| | |y - |z||"), "(|x|!|(y-|z|)|)");
    assert!(parse_shape("f(2|x|)").is_err(), "a union whose right side lacks its end");
}

#[test]
fn points_call_with_what_stands_before_them() {
    assert_eq!(shown_shape("a.scale(2).mirror(1, 0, 0)"), "mirror(scale(a,2),1,0,0)");
    assert_eq!(shown_shape("-(a | b).scale(.5)^2"), "(-(scale((a!b),.5)^2))");
    assert_eq!(shown("1.5x.scale(2.)"), "(1.5*scale(x,2.))");
    let ast = parse_shape(" a .scale( 2 )").unwrap();
    assert_eq!(ast.extent(ast.nodes.len() as NodeId - 1), 1..12);
}

#[test]
fn arguments_of_shapes_have_names() {
    assert_eq!(shown_shape("union(a, b, r = 2 + 1)"), "union(a,b,r=(2+1))");
    assert_eq!(shown("box(round = x, z = 1)"), "box(round=x,z=1)");
    assert!(parse("max(a = 1, b)").is_err() && parse("box(1 + a = 2)").is_err());
}

#[test]
fn mistakes_in_shapes_are_marked() {
    for (text, span) in [
        ("a || b", 2..4),
        ("a && b", 2..4),
        ("a.scale", 1..7),
        ("a | ", 2..3),
        ("| a", 0..1),
        ("a.scale(1", 7..8),
    ] {
        assert_eq!(parse_shape(text).unwrap_err()[0].span, span, "{text}");
    }
    assert_eq!(parse("a & b").unwrap_err()[0].span, 2..3);
}

fn shown(text: &str) -> String {
    show(&parse(text).unwrap())
}

#[test]
fn precedence_is_that_of_mathematics() {
    for (text, tree) in [
        ("a-b-c", "((a-b)-c)"),
        ("a/b*c", "((a/b)*c)"),
        ("a+b*c^d", "(a+(b*(c^d)))"),
        ("a^b^c", "(a^(b^c))"),
        ("-x^2", "(-(x^2))"),
        ("2^-3*x", "((2^(-3))*x)"),
        ("2^-x^2", "(2^(-(x^2)))"),
        ("-a*b", "((-a)*b)"),
        ("a - - + -b", "(a-(-(-b)))"),
        ("+x", "x"),
        ("(((x)))", "x"),
        ("a+b = c*d", "(a+b)=(c*d)"),
    ] {
        assert_eq!(shown(text), tree, "{text}");
    }
}

#[test]
fn bars_nest_and_stand_side_by_side() {
    for (text, tree) in [
        ("||x|-1|", "|(|x|-1)|"),
        ("|x|+|y|", "(|x|+|y|)"),
        ("|x|^(2/3)", "(|x|^(2/3))"),
        ("|x-|y||", "|(x-|y|)|"),
        ("|-|x||*|y|", "(|(-|x|)|*|y|)"),
        ("|max(|x|,|y|)|", "|max(|x|,|y|)|"),
    ] {
        assert_eq!(shown(text), tree, "{text}");
    }
}

#[test]
fn bars_close_if_they_can_and_open_if_not() {
    for (text, tree) in [
        ("2|x|", "(2*|x|)"),
        ("x|y|", "(x*|y|)"),
        ("|x||y|", "(|x|*|y|)"),
        ("|x| |y|^2", "(|x|*(|y|^2))"),
        ("|(2|x|)|", "|(2*|x|)|"),
        ("|2*|x||", "|(2*|x|)|"),
        ("(x+1)|y|-1", "(((x+1)*|y|)-1)"),
        ("|x|²|y|", "((|x|^2)*|y|)"),
        ("∣x∣", "|x|"),
    ] {
        assert_eq!(shown(text), tree, "{text}");
    }
    for (text, span, message) in [
        ("|x|y|", 2..4, "an operator is missing between `|` and `y`"),
        ("|x|(y)", 2..4, "an operator is missing between `|` and `(`"),
        ("|2|x||", 2..4, "an operator is missing between `|` and `x`"),
        ("x|y", 1..2, "`|` is never closed"),
        ("|x||", 3..4, "`|` is never closed"),
    ] {
        assert_mistake(text, span, message);
    }
}

#[test]
fn products_without_a_sign_bind_as_with_one() {
    for (text, tree) in [
        ("2x", "(2*x)"),
        ("2x^2", "(2*(x^2))"),
        ("-2x", "((-2)*x)"),
        ("2 x y", "((2*x)*y)"),
        ("3(x+1)", "(3*(x+1))"),
        ("(x+1)(y-1)", "((x+1)*(y-1))"),
        ("(x+1)y", "((x+1)*y)"),
        ("2sin(x)cos(y)", "((2*sin(x))*cos(y))"),
        ("x^2y^3", "((x^2)*(y^3))"),
        ("x^(2)y", "((x^2)*y)"),
        ("e^(2)x", "((e^2)*x)"),
        ("2^(x)y", "((2^x)*y)"),
        ("2x/3", "((2*x)/3)"),
        ("1/2*x", "((1/2)*x)"),
        ("1/2*3x", "(((1/2)*3)*x)"),
        ("1/(2x)", "(1/(2*x))"),
        ("2x-3y", "((2*x)-(3*y))"),
        ("2e", "(2*e)"),
        ("2e3x", "(2e3*x)"),
        ("x y²(z)", "((x*(y^2))*z)"),
        ("x(y)", "x(y)"),
        ("2x = 3y", "(2*x)=(3*y)"),
    ] {
        assert_eq!(shown(text), tree, "{text}");
    }
}

#[test]
fn products_that_could_be_mistaken_are_refused() {
    for (text, span, help) in [
        ("1/2x", 0..4, "write `(1/2)*x` or `1/(2*x)`"),
        ("y + 1/2(x+1)", 4..8, "write `(1/2)*(…)` or `1/(2*(…))`"),
        ("x/y²z", 0..6, "write `(x/y²)*z` or `x/(y²*z)`"),
        ("9/4 y^2", 0..5, "write `(9/4)*y` or `9/(4*y)`"),
        ("1/-2x", 0..5, "write `(1/-2)*x` or `1/(-2*x)`"),
        ("1/2|x|", 0..4, "write `(1/2)*|…|` or `1/(2*|…|)`"),
        ("1/2sin(x)", 0..6, "write `(1/2)*sin(…)` or `1/(2*sin(…))`"),
        ("e^2x", 0..4, "write `e^(2)*x` or `e^(2*x)`"),
        ("2^3x", 0..4, "write `2^(3)*x` or `2^(3*x)`"),
        ("x^-2y", 0..5, "write `x^(-2)*y` or `x^(-2*y)`"),
        ("x^n y", 0..5, "write `x^(n)*y` or `x^(n*y)`"),
        ("√x y", 0..6, "write `sqrt(x)*y` or `sqrt(x*y)`"),
        ("√x²", 0..6, "write `sqrt(x)^2` or `sqrt(x^2)`"),
        ("-√x^3", 1..6, "write `sqrt(x)^…` or `sqrt(x^…)`"),
        ("x²^3", 0..4, "write `(a^b)^c` or `a^(b^c)`"),
    ] {
        let errors = parse(text).unwrap_err();
        assert_eq!(errors[0].message, "this can be read in two ways", "{text}");
        assert_eq!(
            (errors[0].span.clone(), errors[0].help.as_deref()),
            (span, Some(help)),
            "{text}"
        );
    }
    for (text, span, message) in [
        ("2 3", 0..3, "an operator is missing between `2` and `3`"),
        ("x 2", 0..3, "an operator is missing between `x` and `2`"),
        ("(x)2", 2..4, "an operator is missing between `)` and `2`"),
        ("sin x", 0..5, "the argument of `sin` needs parentheses"),
        ("1/sin x", 2..7, "the argument of `sin` needs parentheses"),
    ] {
        assert_mistake(text, span, message);
    }
}

#[test]
fn printed_signs_mean_what_they_mean() {
    for (text, tree) in [
        ("x²", "(x^2)"),
        ("-x²", "(-(x^2))"),
        ("x¹⁰y⁻³", "((x^10)*(y^(-3)))"),
        ("(x+1)²", "((x+1)^2)"),
        ("2^x²", "(2^(x^2))"),
        ("a·b×c⋅d", "(((a*b)*c)*d)"),
        ("a÷b−c", "((a/b)-c)"),
        ("2πr²", "((2*pi)*(r^2))"),
        ("θ+φ+ϕ+ρ+τ", "((((theta+phi)+phi)+rho)+tau)"),
        ("√2", "sqrt(2)"),
        ("√2x", "(sqrt(2)*x)"),
        ("2√3", "(2*sqrt(3))"),
        ("√(x²+y²)-1", "(sqrt(((x^2)+(y^2)))-1)"),
        ("√√x+1", "(sqrt(sqrt(x))+1)"),
        ("√-x", "sqrt((-x))"),
        ("∛x*2", "(cbrt(x)*2)"),
        ("√sin(x)", "sqrt(sin(x))"),
        ("2**3**x", "(2^(3^x))"),
        ("sin²(x)+cos^2(x)", "((sin(x)^2)+(cos(x)^2))"),
        ("2sin³(x)y", "((2*(sin(x)^3))*y)"),
        ("x²(y)", "((x^2)*y)"),
    ] {
        assert_eq!(shown(text), tree, "{text}");
    }
    assert_mistake("sin⁻¹(x)", 3..8, "this can be the inverse function or the reciprocal");
    assert_mistake("²x", 0..2, "nothing stands before `²`");
}

#[test]
fn spans_are_exact_in_bytes() {
    let ast = parse("√π·|θ|²").unwrap();
    let spans: Vec<_> = ast.nodes.iter().map(|(_, span)| span.clone()).collect();
    assert_eq!(show(&ast), "(sqrt(pi)*(|theta|^2))");
    assert_eq!(spans, [3..5, 0..3, 8..10, 7..11, 11..13, 7..13, 0..13]);
    let ast = parse("sin²(x)").unwrap();
    let spans: Vec<_> = ast.nodes.iter().map(|(_, span)| span.clone()).collect();
    assert_eq!(spans, [6..7, 0..3, 3..5, 0..8]);
}

#[test]
fn comparisons_stand_alone() {
    for (text, tree) in [
        ("x^2 <= 1", "(x^2)<=1"),
        ("x < 1", "x<=1"),
        ("x ≥ y+1", "x>=(y+1)"),
        ("x > 2y", "x>=(2*y)"),
        ("|x| ≤ 1", "|x|<=1"),
    ] {
        assert_eq!(shown(text), tree, "{text}");
    }
    for (text, span, message) in [
        ("0 <= x <= 1", 7..9, "a formula has one `=`, `<=` or `>=` at most"),
        ("x = y < 1", 6..7, "a formula has one `=`, `<=` or `>=` at most"),
        ("max(x < 1, y)", 6..7, "`<` stands inside brackets"),
        ("x <=", 2..4, "nothing follows `<=`"),
    ] {
        assert_mistake(text, span, message);
    }
    let help = |text| parse(text).unwrap_err()[0].help.clone().unwrap();
    assert!(help("max(x >= 1, y)").ends_with("`b - a` for `a >= b`"));
}

fn assert_mistake(text: &str, span: Range<usize>, message: &str) {
    let errors = parse(text).unwrap_err();
    assert_eq!((errors[0].span.clone(), errors[0].message.as_str()), (span, message), "{text}");
}

#[test]
fn calls_keep_their_arguments_and_the_span_of_their_name() {
    let ast = parse(" atan2(y, x)+f()").unwrap();
    assert_eq!(show(&ast), "(atan2(y,x)+f())");
    let spans: Vec<_> = ast.nodes.iter().map(|(_, span)| span.clone()).collect();
    assert_eq!(spans, [7..8, 10..11, 1..6, 13..14, 1..16]);
}

#[test]
fn spans_cover_brackets() {
    let ast = parse("(x+1)*(y)").unwrap();
    assert_eq!(ast.nodes.last().unwrap().1, 0..9);
}

#[test]
fn mistakes_are_marked_where_they_are() {
    for (text, span, message) in [
        ("", 0..0, "the formula is empty"),
        ("  ", 0..2, "the formula is empty"),
        ("x +", 2..3, "nothing follows `+`"),
        ("* x", 0..1, "nothing stands before `*`"),
        ("x + * y", 2..5, "nothing stands between `+` and `*`"),
        ("x = = y", 2..5, "nothing stands between `=` and `=`"),
        ("()", 0..2, "nothing stands between `(` and `)`"),
        ("max(x,)", 5..7, "nothing stands between `,` and `)`"),
        ("2*(x+1", 2..3, "`(` is never closed"),
        ("2*(", 2..3, "`(` is never closed"),
        ("sin(", 3..4, "`(` is never closed"),
        ("|x+1", 0..1, "`|` is never closed"),
        ("(|x)", 1..2, "`|` is never closed"),
        ("|(x|", 1..2, "`(` is never closed"),
        ("x+1)", 3..4, "`)` closes nothing"),
        ("x  2", 0..4, "an operator is missing between `x` and `2`"),
        ("1,5*x", 1..2, "`,` stands outside a call"),
        ("x=y=z", 3..4, "a formula has one `=` at most"),
        ("(x=y)", 2..3, "`=` stands inside brackets"),
    ] {
        assert_mistake(text, span, message);
    }
    assert_eq!(parse("x 2").unwrap_err()[0].help.as_deref(), Some("write `x*2` for a product"));
}

/// Runs on the smallest stack that a worker thread has.
fn on_a_small_stack(test: fn()) {
    let thread = std::thread::Builder::new().stack_size(256 << 10).spawn(test).unwrap();
    thread.join().unwrap();
}

#[test]
fn depth_is_limited_and_length_is_not() {
    on_a_small_stack(|| {
        let nested = |open: &str, n: usize, close: &str| open.repeat(n) + "x" + &close.repeat(n);
        for open in ["(", "sin(", "1+2*-(", "-max(x,2^("] {
            let close = ")".repeat(open.matches('(').count());
            assert!(parse(&nested(open, 500, &close)).is_ok(), "{open}");
        }
        assert!(parse(&nested("|", MAX_DEPTH, "|")).is_ok());
        let too_deep = parse(&nested("(", 1001, ")")).unwrap_err();
        assert_eq!(too_deep[0].span, 1000..1001);

        assert_eq!(parse(&("-".repeat(10_000) + "x")).unwrap().nodes.len(), 10_001);
        assert_eq!(parse(&("x^".repeat(10_000) + "x")).unwrap().nodes.len(), 20_001);
        assert_eq!(parse(&("x+".repeat(10_000) + "x")).unwrap().nodes.len(), 20_001);
        assert!(parse(&"|".repeat(10_000)).is_err());
        assert!(parse(&"(".repeat(90_000)).is_err());
    });
}

/// Random trees, as the nodes in the order in which the parser makes them.
fn trees() -> impl Strategy<Value = Vec<Node>> {
    let leaf = prop_oneof![
        "[0-9]{1,3}(\\.[0-9]{0,2})?(e-?[0-9])?".prop_map(|text| Node::Number { text }),
        "[a-df-z_][a-z0-9_]{0,3}".prop_map(Node::Name),
    ];
    let op = prop::sample::select(vec![
        BinaryOp::Add,
        BinaryOp::Sub,
        BinaryOp::Mul,
        BinaryOp::Div,
        BinaryOp::Pow,
    ]);
    leaf.prop_map(|node| vec![node]).prop_recursive(6, 60, 3, move |inner| {
        let args = prop::collection::vec(inner.clone(), 0..4);
        prop_oneof![
            inner.clone().prop_map(|a| join(vec![a], |ids| Node::Neg(ids[0]))),
            inner.clone().prop_map(|a| join(vec![a], |ids| Node::Abs(ids[0]))),
            (op.clone(), inner.clone(), inner)
                .prop_map(|(op, a, b)| join(vec![a, b], |ids| Node::Binary(op, ids[0], ids[1]))),
            ("[a-z]{1,4}", args)
                .prop_map(|(name, args)| join(args, |ids| Node::Call(name, ids.to_vec()))),
        ]
    })
}

/// Puts trees side by side in one arena, and `root` above them.
fn join(parts: Vec<Vec<Node>>, root: impl FnOnce(&[NodeId]) -> Node) -> Vec<Node> {
    let mut nodes: Vec<Node> = Vec::new();
    let mut ids = Vec::new();
    for part in parts {
        let base = nodes.len() as NodeId;
        nodes.extend(part.into_iter().map(|node| match node {
            Node::Neg(a) => Node::Neg(a + base),
            Node::Abs(a) => Node::Abs(a + base),
            Node::Binary(op, a, b) => Node::Binary(op, a + base, b + base),
            Node::Call(name, args) => Node::Call(name, args.iter().map(|a| a + base).collect()),
            leaf => leaf,
        }));
        ids.push(nodes.len() as NodeId - 1);
    }
    nodes.push(root(&ids));
    nodes
}

proptest! {
    #[test]
    fn a_printed_tree_is_read_back(nodes in trees()) {
        let ast = Ast { nodes: nodes.into_iter().map(|node| (node, 0..0)).collect() };
        let read = parse(&show(&ast)).unwrap();
        let nodes = |ast: &Ast| ast.nodes.iter().map(|n| n.0.clone()).collect::<Vec<_>>();
        prop_assert_eq!(nodes(&read), nodes(&ast));
    }

    #[test]
    fn token_soup_gives_an_answer_with_spans_in_the_text(
        soup in "([-+*/^(),|= <>]|sin|x|2|\\.5|1e|²|⁻|√|π|≤|·|é){0,40}",
    ) {
        match parse(&soup) {
            Ok(ast) => prop_assert!(ast.nodes.iter().all(|(_, s)| soup.get(s.clone()).is_some())),
            Err(errors) => prop_assert!(errors.iter().all(|e| soup.get(e.span.clone()).is_some())),
        }
    }
}
