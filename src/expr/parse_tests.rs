//! Tests of the parser: trees, spans, limits, and a round trip of random trees.

use proptest::prelude::*;

use super::*;

/// The tree with all its brackets.
fn show(ast: &Ast) -> String {
    let mut shown: Vec<String> = Vec::new();
    for (node, _) in &ast.nodes {
        let at = |id: &NodeId| shown[*id as usize].as_str();
        let text = match node {
            Node::Number { text } | Node::Name(text) => text.clone(),
            Node::Neg(a) => format!("(-{})", at(a)),
            Node::Abs(a) => format!("|{}|", at(a)),
            Node::Binary(op, a, b) => format!("({}{}{})", at(a), symbol(*op), at(b)),
            Node::Call(name, args) => {
                format!("{name}({})", args.iter().map(at).collect::<Vec<_>>().join(","))
            }
            Node::Equation(a, b) => format!("{}={}", at(a), at(b)),
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
    }
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
        ("2x", 0..2, "an operator is missing between `2` and `x`"),
        ("x  y", 0..4, "an operator is missing between `x` and `y`"),
        ("(x)(y)", 2..4, "an operator is missing between `)` and `(`"),
        ("|x||y|", 2..4, "an operator is missing between `|` and `|`"),
        ("1,5*x", 1..2, "`,` stands outside a call"),
        ("x=y=z", 3..4, "a formula has one `=` at most"),
        ("(x=y)", 2..3, "`=` stands inside brackets"),
    ] {
        let errors = parse(text).unwrap_err();
        assert_eq!((errors[0].span.clone(), errors[0].message.as_str()), (span, message), "{text}");
    }
    assert_eq!(parse("2x").unwrap_err()[0].help.as_deref(), Some("write `2*x` for a product"));
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
        soup in "([-+*/^(),|= ]|sin|x|2|\\.5|1e|²|é){0,40}",
    ) {
        match parse(&soup) {
            Ok(ast) => prop_assert!(ast.nodes.iter().all(|(_, s)| soup.get(s.clone()).is_some())),
            Err(errors) => prop_assert!(errors.iter().all(|e| soup.get(e.span.clone()).is_some())),
        }
    }
}
