//! Formulas as programs: a list of operations on earlier results, equal ones shared.
//!
//! [`Graph`] is the builder. Every node goes through [`simplify`], which folds constants with
//! outward rounding and drops operations that do nothing; shortening a tape uses the same rules.

use rustc_hash::FxHashMap;

use crate::math::{Binary, Constant, Interval, Notes, Number, Point, Unary, Wave, elementary};

/// Index of a node in its list.
pub type Id = u32;

/// One operation; operands are earlier nodes.
#[derive(Clone, Copy, Debug)]
pub enum Node {
    /// The coordinate x, y or z (0, 1 or 2).
    Variable(u8),
    /// A real constant.
    Constant(Constant),
    /// An operation on one result.
    Unary(Unary, Id),
    /// An operation on two results. Where it commutes, a constant is the second.
    Binary(Binary, Id, Id),
}

impl Node {
    /// The constant, if it is one.
    #[must_use]
    pub fn constant(&self) -> Option<&Constant> {
        match self {
            Self::Constant(c) => Some(c),
            _ => None,
        }
    }

    /// The nodes that this one reads.
    pub fn operands(&self) -> impl Iterator<Item = Id> + use<> {
        let (a, b) = match *self {
            Self::Variable(_) | Self::Constant(_) => (None, None),
            Self::Unary(_, a) => (Some(a), None),
            Self::Binary(_, a, b) => (Some(a), Some(b)),
        };
        a.into_iter().chain(b)
    }

    /// The same operation on other operands.
    #[must_use]
    pub fn map_operands(self, f: impl Fn(Id) -> Id) -> Self {
        match self {
            Self::Variable(_) | Self::Constant(_) => self,
            Self::Unary(op, a) => Self::Unary(op, f(a)),
            Self::Binary(op, a, b) => Self::Binary(op, f(a), f(b)),
        }
    }

    /// The node as bits, for finding equal ones.
    fn key(&self) -> NodeKey {
        match *self {
            Self::Variable(axis) => NodeKey::Variable(axis),
            Self::Constant(c) => NodeKey::Constant([c.value, c.lo, c.hi].map(f64::to_bits)),
            Self::Unary(op, a) => NodeKey::Unary(op, a),
            Self::Binary(op, a, b) => NodeKey::Binary(op, a, b),
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum NodeKey {
    Variable(u8),
    Constant([u64; 3]),
    Unary(Unary, Id),
    Binary(Binary, Id, Id),
}

/// What a node turns out to be.
pub(super) enum Simplified {
    /// This node.
    Node(Node),
    /// The result of an earlier one.
    Alias(Id),
}

/// Folds constants and drops what does nothing. `node_of` gives earlier nodes.
pub(super) fn simplify(node: Node, node_of: impl Fn(Id) -> Node + Copy) -> Simplified {
    if let Some(c) = fold(node, node_of) {
        return Simplified::Node(Node::Constant(c));
    }
    match node {
        Node::Variable(_) | Node::Constant(_) => Simplified::Node(node),
        Node::Unary(op, a) => match (op, node_of(a)) {
            (Unary::Neg, Node::Unary(Unary::Neg, inner)) => Simplified::Alias(inner),
            (Unary::Abs | Unary::Square, Node::Unary(Unary::Neg | Unary::Abs, inner)) => {
                Simplified::Node(Node::Unary(op, inner))
            }
            _ => Simplified::Node(node),
        },
        Node::Binary(op, a, b) => simplify_binary(op, a, b, node_of),
    }
}

fn simplify_binary(op: Binary, a: Id, b: Id, node_of: impl Fn(Id) -> Node + Copy) -> Simplified {
    let is = |id, v: f64| node_of(id).constant().and_then(Constant::as_exact) == Some(v);
    let negated = |id| simplify(Node::Unary(Unary::Neg, id), node_of);
    match op {
        Binary::Add if is(a, 0.0) => Simplified::Alias(b),
        Binary::Add | Binary::Sub if is(b, 0.0) => Simplified::Alias(a),
        Binary::Sub if is(a, 0.0) => negated(b),
        Binary::Mul if is(a, 1.0) => Simplified::Alias(b),
        Binary::Mul if is(b, 1.0) => Simplified::Alias(a),
        // Where a factor is undefined, so is the product.
        Binary::Mul if is(b, 0.0) && is_total(a, node_of) => Simplified::Alias(b),
        Binary::Mul if is(a, 0.0) && is_total(b, node_of) => Simplified::Alias(a),
        Binary::Mul if is(a, -1.0) => negated(b),
        Binary::Mul if is(b, -1.0) => negated(a),
        Binary::Mul if a == b => Simplified::Node(Node::Unary(Unary::Square, a)),
        Binary::Min | Binary::Max if a == b => Simplified::Alias(a),
        Binary::Sub if a == b && is_total(a, node_of) => {
            Simplified::Node(Node::Constant(Constant::exact(0.0)))
        }
        _ if op.commutes() && node_of(a).constant().is_some() => {
            Simplified::Node(Node::Binary(op, b, a))
        }
        // One order, so that a b and b a are one node.
        _ if op.commutes() && b < a && node_of(b).constant().is_none() => {
            Simplified::Node(Node::Binary(op, b, a))
        }
        _ => Simplified::Node(Node::Binary(op, a, b)),
    }
}

/// Nodes that are looked at to find out whether a value is defined everywhere; trees with more of them
/// count as if they were not.
const MAX_LOOK: usize = 64;

/// Whether a value is defined everywhere, as far as is easily seen.
fn is_total(id: Id, node_of: impl Fn(Id) -> Node) -> bool {
    let mut open = vec![id];
    let mut n_left = MAX_LOOK;
    while let Some(id) = open.pop() {
        let Some(left) = n_left.checked_sub(1) else { return false };
        n_left = left;
        let node = node_of(id);
        match node {
            Node::Unary(
                Unary::Recip | Unary::Sqrt | Unary::Ln | Unary::Acos | Unary::Asin | Unary::Tan,
                _,
            )
            | Node::Binary(Binary::Atan2 { .. } | Binary::Harmonic { .. }, ..) => return false,
            _ => open.extend(node.operands()),
        }
    }
    true
}

/// The value of an operation on constants, if it is defined and finite.
fn fold(node: Node, node_of: impl Fn(Id) -> Node) -> Option<Constant> {
    let mut operands = [Constant::exact(0.0); 2];
    let mut n_operands = 0;
    for id in node.operands() {
        operands[n_operands] = *node_of(id).constant()?;
        n_operands += 1;
    }
    if n_operands == 0 {
        return None;
    }
    let (point, _) = evaluate::<Point<f64>>(node, &operands);
    if let Some(v) = exact_result(node, &operands).filter(|v| *v == point.0) {
        return Some(Constant::exact(v));
    }
    let (range, notes) = evaluate::<Interval<f64>>(node, &operands);
    let usable = !notes.discontinuous && range.lo.is_finite() && range.hi.is_finite();
    (usable && point.0.is_finite()).then_some(Constant {
        value: point.0,
        lo: range.lo,
        hi: range.hi,
    })
}

fn evaluate<N: Number<Lanes = f64>>(node: Node, operands: &[Constant; 2]) -> (N, Notes<bool>) {
    let mut slots = operands.map(|c| [N::constant((), &c)]);
    let mut notes = [Notes::clear::<f64>(())];
    match node {
        Node::Variable(_) | Node::Constant(_) => {}
        Node::Unary(op, _) => op.apply(&mut slots, &mut notes, (0, 0)),
        Node::Binary(op, ..) => op.apply(&mut slots, &mut notes, (0, 1, 0)),
    }
    (slots[0][0], notes[0])
}

/// The result of simple arithmetic where f64 holds it without rounding, shown by a fused
/// multiply-add that finds no remainder.
fn exact_result(node: Node, operands: &[Constant; 2]) -> Option<f64> {
    let [a, b] = operands.map(|c| c.as_exact());
    if let Node::Binary(Binary::Mul, ..) = node
        && (a == Some(0.0) || b == Some(0.0))
    {
        return Some(0.0);
    }
    let a = a?;
    let without_remainder = |v: f64, remainder: f64| {
        (v.is_finite() && v.abs() > 1e-200 && remainder == 0.0).then_some(v)
    };
    match node {
        Node::Unary(Unary::Square | Unary::Sqrt, _) if a == 0.0 => Some(0.0),
        Node::Unary(Unary::Neg, _) => Some(-a),
        Node::Unary(Unary::Abs, _) => Some(a.abs()),
        Node::Unary(Unary::Square, _) => without_remainder(a * a, libm::fma(a, a, -(a * a))),
        Node::Unary(Unary::Recip, _) => without_remainder(1.0 / a, libm::fma(1.0 / a, a, -1.0)),
        Node::Unary(Unary::Sqrt, _) => {
            let remainder = libm::fma(a.sqrt(), a.sqrt(), -a);
            without_remainder(a.sqrt(), remainder).filter(|_| a > 1e-200)
        }
        Node::Unary(Unary::Powi(n), _) => {
            let v = elementary::powi(a, n);
            (a.fract() == 0.0 && v.abs() < 1e15).then_some(v)
        }
        Node::Binary(Binary::Add, ..) => without_remainder(a + b?, sum_remainder(a, b?)),
        Node::Binary(Binary::Sub, ..) => without_remainder(a - b?, sum_remainder(a, -b?)),
        Node::Binary(Binary::Mul, ..) => without_remainder(a * b?, libm::fma(a, b?, -(a * b?))),
        Node::Binary(Binary::Min, ..) => Some(a.min(b?)),
        Node::Binary(Binary::Max, ..) => Some(a.max(b?)),
        _ => None,
    }
}

/// The rounding error of a + b (Knuth's two-sum).
fn sum_remainder(a: f64, b: f64) -> f64 {
    let s = a + b;
    let t = s - a;
    (a - (s - t)) + (b - t)
}

/// A growing program in which equal operations are one node.
#[derive(Clone, Debug, Default)]
pub struct Graph {
    nodes: Vec<Node>,
    known: FxHashMap<NodeKey, Id>,
}

impl Graph {
    /// The nodes so far, operands before their users.
    #[must_use]
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    fn node(&self, id: Id) -> Node {
        self.nodes[id as usize]
    }

    /// Adds a node, or finds what it equals.
    pub fn add_node(&mut self, node: Node) -> Id {
        match simplify(node, |id| self.node(id)) {
            Simplified::Alias(id) => id,
            Simplified::Node(node) => *self.known.entry(node.key()).or_insert_with(|| {
                self.nodes.push(node);
                (self.nodes.len() - 1) as Id
            }),
        }
    }

    /// Adds what `root` of another graph needs, and returns what `root` is here.
    pub fn import(&mut self, other: &Self, root: Id) -> Id {
        let (nodes, roots) = prune(&other.nodes, &[root]);
        let mut moved: Vec<Id> = Vec::with_capacity(nodes.len());
        for node in nodes {
            let node = node.map_operands(|operand| moved[operand as usize]);
            moved.push(self.add_node(node));
        }
        moved[roots[0] as usize]
    }

    /// The coordinate x, y or z (0, 1 or 2).
    pub fn variable(&mut self, axis: u8) -> Id {
        self.add_node(Node::Variable(axis))
    }

    /// A constant.
    pub fn constant(&mut self, c: Constant) -> Id {
        self.add_node(Node::Constant(c))
    }

    /// An operation on one result.
    pub fn unary(&mut self, op: Unary, a: Id) -> Id {
        self.add_node(Node::Unary(op, a))
    }

    /// An operation on two results.
    pub fn binary(&mut self, op: Binary, a: Id, b: Id) -> Id {
        self.add_node(Node::Binary(op, a, b))
    }

    /// a + b
    pub fn add(&mut self, a: Id, b: Id) -> Id {
        self.binary(Binary::Add, a, b)
    }

    /// a − b. Subtracting a constant adds its negative, so that it is one operation.
    pub fn sub(&mut self, a: Id, b: Id) -> Id {
        if self.node(b).constant().is_some() || self.node(a).constant().is_some() {
            let negative = self.unary(Unary::Neg, b);
            return self.add(a, negative);
        }
        self.binary(Binary::Sub, a, b)
    }

    /// a b
    pub fn mul(&mut self, a: Id, b: Id) -> Id {
        self.binary(Binary::Mul, a, b)
    }

    /// a / b
    pub fn div(&mut self, a: Id, b: Id) -> Id {
        let exact = |id| self.node(id).constant().and_then(Constant::as_exact);
        if let (Some(p), Some(q)) = (exact(a), exact(b)) {
            let quotient = p / q;
            // Subnormal numbers could hide a remainder.
            let is_normal = p == 0.0 || (p.abs() > 1e-200 && quotient.abs() > 1e-200);
            if quotient.is_finite() && is_normal && libm::fma(quotient, q, -p) == 0.0 {
                return self.constant(Constant::exact(quotient));
            }
        }
        let inverse = self.unary(Unary::Recip, b);
        self.mul(a, inverse)
    }

    /// aⁿ, an exact power.
    pub fn powi(&mut self, a: Id, n: i32) -> Id {
        let power = match n.unsigned_abs() {
            0 => return self.constant(Constant::exact(1.0)),
            1 => a,
            2 => self.unary(Unary::Square, a),
            m => self.unary(Unary::Powi(m), a),
        };
        if n < 0 { self.unary(Unary::Recip, power) } else { power }
    }

    /// aᵇ. An integer exponent gives an exact power, defined for negative a too; any other one
    /// means exp(b ln a), so that a positive power of 0 is 0.
    pub fn pow(&mut self, a: Id, b: Id) -> Id {
        let exponent = self.node(b).constant().copied();
        if let Some(n) = exponent.and_then(|c| c.as_integer()) {
            return self.powi(a, n);
        }
        if exponent.and_then(|c| c.as_exact()) == Some(0.5) {
            return self.unary(Unary::Sqrt, a);
        }
        let is_e =
            self.node(a).constant().is_some_and(|c| *c == Constant::rounded(std::f64::consts::E));
        if is_e {
            return self.unary(Unary::Exp, b);
        }
        let ln = self.unary(Unary::Ln, a);
        let product = self.mul(ln, b);
        self.unary(Unary::Exp, product)
    }

    /// sin a or cos a. Waves of a multiple of an angle become harmonics, which need no angle; an
    /// angle inside any other argument is lifted where only whole multiples of it occur.
    pub fn wave(&mut self, wave: Wave, a: Id) -> Id {
        if let Some((n, y, x)) = self.angle_multiple(a) {
            let harmonic = self.binary(Binary::Harmonic { wave, n: n.unsigned_abs() }, y, x);
            let odd = n < 0 && wave == Wave::Sin;
            return if odd { self.unary(Unary::Neg, harmonic) } else { harmonic };
        }
        let lifted = self.lift_angles(a, 0, &mut FxHashMap::default()).unwrap_or(a);
        self.unary(Unary::Wave(wave), lifted)
    }

    /// tan a; of a multiple of an angle, as a quotient of harmonics.
    pub fn tan(&mut self, a: Id) -> Id {
        if self.angle_multiple(a).is_some() {
            let (sin, cos) = (self.wave(Wave::Sin, a), self.wave(Wave::Cos, a));
            return self.div(sin, cos);
        }
        let lifted = self.lift_angles(a, 0, &mut FxHashMap::default()).unwrap_or(a);
        self.unary(Unary::Tan, lifted)
    }

    /// Recognises n times the angle of (x, y): (n, y, x), with n not 0.
    fn angle_multiple(&self, mut a: Id) -> Option<(i32, Id, Id)> {
        let mut n = 1_i32;
        loop {
            match self.node(a) {
                Node::Binary(Binary::Atan2 { .. }, y, x) => return Some((n, y, x)),
                Node::Unary(Unary::Neg, b) => (n, a) = (-n, b),
                Node::Binary(Binary::Mul, b, c) => {
                    let factor = self.node(c).constant()?.as_integer()?;
                    let product = n.checked_mul(factor)?;
                    let is_small = (1..=MAX_HARMONIC).contains(&product.unsigned_abs());
                    (n, a) = is_small.then_some((product, b))?;
                }
                _ => return None,
            }
        }
    }

    /// The same sum with its angles lifted where they occur as whole multiples; elsewhere they keep
    /// their cut. Nothing if the sum is nested too deep to look through, or has too many terms.
    /// `done` holds what was lifted so far.
    fn lift_angles(&mut self, a: Id, depth: u32, done: &mut FxHashMap<Id, Id>) -> Option<Id> {
        if let Some(&lifted) = done.get(&a) {
            return Some(lifted);
        }
        if depth > MAX_LIFT_DEPTH || done.len() > MAX_LIFTED {
            return None;
        }
        let lifted = match self.node(a) {
            Node::Binary(Binary::Atan2 { .. }, y, x) => {
                self.binary(Binary::Atan2 { lifted: true }, y, x)
            }
            Node::Unary(Unary::Neg, b) => {
                let b = self.lift_angles(b, depth + 1, done)?;
                self.unary(Unary::Neg, b)
            }
            Node::Binary(op @ (Binary::Add | Binary::Sub), b, c) => {
                let b = self.lift_angles(b, depth + 1, done)?;
                let c = self.lift_angles(c, depth + 1, done)?;
                self.binary(op, b, c)
            }
            Node::Binary(Binary::Mul, b, c)
                if self.node(c).constant().and_then(Constant::as_integer).is_some() =>
            {
                let b = self.lift_angles(b, depth + 1, done)?;
                self.mul(b, c)
            }
            _ => a,
        };
        done.insert(a, lifted);
        Some(lifted)
    }
}

/// Above this the error bound of a harmonic in f32 is no longer small.
const MAX_HARMONIC: u32 = 1024;

/// Sums nested deeper than this keep the cuts of their angles.
const MAX_LIFT_DEPTH: u32 = 64;

/// Sums of more parts than this keep the cuts of their angles.
const MAX_LIFTED: usize = 1024;

/// Removes what the roots do not need; returns where the roots are then.
#[must_use]
pub(super) fn prune(nodes: &[Node], roots: &[Id]) -> (Vec<Node>, Vec<Id>) {
    let mut needed = vec![false; nodes.len()];
    roots.iter().for_each(|&root| needed[root as usize] = true);
    for id in (0..nodes.len()).rev() {
        if needed[id] {
            nodes[id].operands().for_each(|operand| needed[operand as usize] = true);
        }
    }
    let mut moved = vec![0; nodes.len()];
    let mut kept = Vec::new();
    for (id, node) in nodes.iter().enumerate().filter(|&(id, _)| needed[id]) {
        moved[id] = kept.len() as Id;
        kept.push(node.map_operands(|operand| moved[operand as usize]));
    }
    (kept, roots.iter().map(|&root| moved[root as usize]).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn exact(graph: &mut Graph, v: f64) -> Id {
        graph.constant(Constant::exact(v))
    }

    #[test]
    fn equal_parts_are_one_node() {
        let mut g = Graph::default();
        let (x, y) = (g.variable(0), g.variable(1));
        assert_eq!(g.add(x, y), g.add(x, y));
        assert_eq!(g.mul(x, x), g.powi(x, 2));
    }

    #[test]
    fn a_difference_of_equals_is_zero() {
        let mut g = Graph::default();
        let (x, y) = (g.variable(0), g.variable(1));
        let (a, b) = (g.mul(x, y), g.mul(y, x));
        let difference = g.sub(a, b);
        assert_eq!(g.node(difference).constant(), Some(&Constant::exact(0.0)));
    }

    #[test]
    fn exact_arithmetic_stays_exact() {
        let mut g = Graph::default();
        let (six, three, four) = (exact(&mut g, 6.0), exact(&mut g, 3.0), exact(&mut g, 4.0));
        let two = g.div(six, three);
        let nine_quarters = {
            let nine = g.mul(three, three);
            g.div(nine, four)
        };
        assert_eq!(g.node(two).constant(), Some(&Constant::exact(2.0)));
        assert_eq!(g.node(nine_quarters).constant(), Some(&Constant::exact(2.25)));
        let third = g.unary(Unary::Recip, three);
        let c = *g.node(third).constant().unwrap();
        assert!(c.lo < 1.0 / 3.0 && 1.0 / 3.0 < c.hi && c.as_exact().is_none());
    }

    /// The remainders of these are below the smallest number.
    #[test]
    fn underflow_does_not_pass_for_exactness() {
        let mut g = Graph::default();
        let (five, three) = (exact(&mut g, 25e-324), exact(&mut g, 15e-324));
        let divisor = exact(&mut g, 1.1);
        let (quotient, root) = (g.div(five, divisor), g.unary(Unary::Sqrt, three));
        for id in [quotient, root] {
            let c = *g.node(id).constant().unwrap();
            assert!(c.lo < c.hi, "{c:?}");
        }
    }

    #[test]
    fn zeros_stay_exact() {
        let mut g = Graph::default();
        let (zero, third) = (exact(&mut g, 0.0), exact(&mut g, 3.0));
        let third = g.unary(Unary::Recip, third);
        let (square, root) = (g.powi(zero, 2), g.unary(Unary::Sqrt, zero));
        assert_eq!([square, root, g.mul(third, zero)], [zero; 3]);
    }

    #[test]
    fn division_by_zero_is_not_folded() {
        let mut g = Graph::default();
        let (one, zero) = (exact(&mut g, 1.0), exact(&mut g, 0.0));
        let quotient = g.div(one, zero);
        assert!(g.node(quotient).constant().is_none());
    }

    #[test]
    fn waves_of_angles_become_harmonics() {
        let mut g = Graph::default();
        let (x, y, z) = (g.variable(0), g.variable(1), g.variable(2));
        let theta = g.binary(Binary::Atan2 { lifted: false }, y, x);
        let minus_three = exact(&mut g, -3.0);
        let angle = g.mul(minus_three, theta);
        let sine = g.wave(Wave::Sin, angle);
        let Node::Unary(Unary::Neg, inner) = g.node(sine) else { panic!("sine is odd") };
        assert!(matches!(
            g.node(inner),
            Node::Binary(Binary::Harmonic { wave: Wave::Sin, n: 3 }, b, a) if (a, b) == (x, y)
        ));
        let twisted = g.add(angle, z);
        let wave = g.wave(Wave::Cos, twisted);
        assert!(matches!(g.node(wave), Node::Unary(Unary::Wave(Wave::Cos), _)));
        assert!(
            g.nodes().iter().any(|n| matches!(n, Node::Binary(Binary::Atan2 { lifted: true }, ..)))
        );
    }

    /// 2¹⁰⁰ θ as a sum whose halves are shared, and θ·2·2·…: neither takes long nor much stack.
    #[test]
    fn large_multiples_of_angles_are_given_up() {
        let mut g = Graph::default();
        let (x, y, two) = (g.variable(0), g.variable(1), exact(&mut g, 2.0));
        let theta = g.binary(Binary::Atan2 { lifted: false }, y, x);
        let sum = (0..100).fold(theta, |sum, _| g.add(sum, sum));
        let product = (0..10_000).fold(theta, |product, _| g.mul(product, two));
        for a in [sum, product] {
            let wave = g.wave(Wave::Sin, a);
            assert!(matches!(g.node(wave), Node::Unary(Unary::Wave(Wave::Sin), b) if b == a));
        }
    }

    #[test]
    fn half_an_angle_keeps_its_cut() {
        let mut g = Graph::default();
        let (x, y) = (g.variable(0), g.variable(1));
        let theta = g.binary(Binary::Atan2 { lifted: false }, y, x);
        let half = exact(&mut g, 0.5);
        let angle = g.mul(theta, half);
        g.wave(Wave::Cos, angle);
        assert!(
            !g.nodes()
                .iter()
                .any(|n| matches!(n, Node::Binary(Binary::Atan2 { lifted: true }, ..)))
        );
    }

    #[test]
    fn pruning_keeps_what_the_root_needs() {
        let mut g = Graph::default();
        let (x, y) = (g.variable(0), g.variable(1));
        let sum = g.add(x, y);
        g.mul(x, y);
        let (nodes, roots) = prune(g.nodes(), &[sum]);
        assert_eq!(roots, [2]);
        assert!(matches!(
            nodes[..],
            [Node::Variable(0), Node::Variable(1), Node::Binary(Binary::Add, 0, 1)]
        ));
    }
}
