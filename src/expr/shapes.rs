//! Shapes: functions whose results are solids, and what their arguments are.
//!
//! A [`Solid`] has two fields that are negative inside and 0 on the same surface. `distance` is the
//! signed distance where there is one: lengths of `offset`, `shell` and roundings are measured with
//! it. `surface` is as simple as can be: of a box, a maximum without a root, which has a gradient
//! everywhere near the faces, where the root in the distance would end. Pictures and meshes are made
//! of `surface`; a tape holds nothing of the other one.
//!
//! Transforms replace the coordinates in what was made before ([`Graph::substitute`]): shapes are
//! parts of the graph like any formula, and equal parts are computed once.

mod lattices;
mod primitives;
mod repeat;
mod sections;
pub(super) mod sets;
mod transforms;

pub(super) use repeat::MAX_NODES;

use super::graph::{Graph, Id};
use crate::math::{Binary, Constant, Unary};

/// A shape in a graph; see the file's text.
#[derive(Clone, Copy, Debug)]
pub(super) struct Solid {
    /// Negative inside, 0 on the surface.
    pub(super) surface: Id,
    /// The signed distance, or a bound of it, or what stands in for it.
    pub(super) distance: Id,
    /// Whether `distance` grows by 1 for each unit of length away from the surface.
    pub(super) is_metric: bool,
}

impl Solid {
    /// A solid whose field is its distance.
    fn exact(field: Id) -> Self {
        Self { surface: field, distance: field, is_metric: true }
    }

    /// The solid inside a formula, whose values mean nothing but their sign.
    pub(super) fn of_formula(field: Id) -> Self {
        Self { surface: field, distance: field, is_metric: false }
    }

    /// Both fields changed alike.
    fn map(self, mut f: impl FnMut(Id) -> Id) -> Self {
        let surface = f(self.surface);
        let distance = if self.distance == self.surface { surface } else { f(self.distance) };
        Self { surface, distance, ..self }
    }

    /// The solid in other coordinates.
    fn at(self, g: &mut Graph, coordinates: [Id; 3]) -> Self {
        let [surface, distance] = g.substitute([self.surface, self.distance], coordinates);
        Self { surface, distance, ..self }
    }
}

/// What a parameter of a shape takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Kind {
    /// A shape, or a formula that depends on the coordinates.
    Solid,
    /// Any number of shapes, at least one.
    Solids,
    /// A number.
    Number,
    /// A number that may be left out: then it is as given.
    Or(f64),
    /// A number that may be left out.
    Optional,
    /// A number that only a name gives, as in `r = 0.1`, or nothing.
    Named,
}

/// A function that makes a shape.
pub(super) struct Function {
    pub(super) name: &'static str,
    pub(super) parameters: &'static [(&'static str, Kind)],
    build: fn(&mut Build<'_>) -> Result<Solid, Complaint>,
}

/// What is wrong with an argument.
#[derive(Debug)]
pub(super) struct Complaint {
    /// Of which parameter; of the whole call if of none.
    pub(super) parameter: Option<usize>,
    /// What is wrong, after the name of the parameter.
    pub(super) message: String,
    /// What would be right.
    pub(super) help: String,
}

/// A number with its node in the graph.
#[derive(Clone, Copy, Debug)]
pub(super) struct Number {
    pub(super) id: Id,
    pub(super) value: f64,
}

/// What stands for a parameter in a call.
#[derive(Clone, Debug)]
pub(super) enum Argument {
    Solids(Vec<Solid>),
    Number(Option<Number>),
}

/// A call that is being made a solid.
pub(super) struct Build<'a> {
    pub(super) g: &'a mut Graph,
    pub(super) arguments: Vec<Argument>,
    /// What is probably not meant.
    pub(super) warning: Option<&'static str>,
}

impl Function {
    /// How a call is written.
    pub(super) fn usage(&self) -> String {
        let parameter = |&(name, kind): &(&str, Kind)| match kind {
            Kind::Solid | Kind::Number => name.to_owned(),
            Kind::Solids => format!("{name}, b, …"),
            Kind::Or(value) => format!("{name} = {value}"),
            Kind::Optional => format!("[{name}]"),
            Kind::Named => format!("[{name} = …]"),
        };
        let parameters: Vec<String> = self.parameters.iter().map(parameter).collect();
        format!("{}({})", self.name, parameters.join(", "))
    }

    /// Makes the solid.
    pub(super) fn build(&self, call: &mut Build<'_>) -> Result<Solid, Complaint> {
        (self.build)(call)
    }
}

impl Build<'_> {
    /// The shape that the parameter `index` takes.
    fn solid(&self, index: usize) -> Solid {
        self.solids(index)[0]
    }

    fn solids(&self, index: usize) -> &[Solid] {
        match &self.arguments[index] {
            Argument::Solids(solids) => solids,
            Argument::Number(_) => &[],
        }
    }

    /// The number that the parameter `index` was given, if it was.
    fn given(&self, index: usize) -> Option<Number> {
        match self.arguments[index] {
            Argument::Number(number) => number,
            Argument::Solids(_) => None,
        }
    }

    /// The number of a parameter that has one always.
    fn number(&mut self, index: usize) -> Number {
        let given = self.given(index);
        given.unwrap_or_else(|| Number { id: exact(self.g, 0.0), value: 0.0 })
    }

    /// A number above 0.
    fn positive(&mut self, index: usize) -> Result<Number, Complaint> {
        let number = self.number(index);
        match number.value > 0.0 {
            true => Ok(number),
            false => Err(complaint(index, format!("is {}", number.value), "it must be above 0")),
        }
    }

    /// A number that is not negative, and less than `limit` if there is one.
    fn rounding(&mut self, index: usize, limit: Option<f64>) -> Result<Number, Complaint> {
        let number = self.number(index);
        if number.value < 0.0 {
            let message = format!("is {}", number.value);
            return Err(complaint(index, message, "it must not be below 0"));
        }
        match limit {
            Some(limit) if number.value > limit => Err(complaint(
                index,
                format!("is {}", number.value),
                &format!("the shape has room for {limit} at most"),
            )),
            _ => Ok(number),
        }
    }

    fn coordinates(&mut self) -> [Id; 3] {
        [0, 1, 2].map(|axis| self.g.variable(axis))
    }

    /// Half of a number.
    fn half(&mut self, a: Id) -> Id {
        let half = exact(self.g, 0.5);
        self.g.mul(a, half)
    }
}

fn complaint(parameter: usize, message: impl Into<String>, help: &str) -> Complaint {
    Complaint { parameter: Some(parameter), message: message.into(), help: help.to_owned() }
}

fn exact(g: &mut Graph, value: f64) -> Id {
    g.constant(Constant::exact(value))
}

fn min(g: &mut Graph, a: Id, b: Id) -> Id {
    g.binary(Binary::Min, a, b)
}

fn max(g: &mut Graph, a: Id, b: Id) -> Id {
    g.binary(Binary::Max, a, b)
}

fn abs(g: &mut Graph, a: Id) -> Id {
    g.unary(Unary::Abs, a)
}

/// Several nodes made one by a tree as low as can be: shortening drops whole branches of it.
fn folded(g: &mut Graph, op: Binary, parts: &[Id]) -> Id {
    let mut row = parts.to_vec();
    while row.len() > 1 {
        row = row
            .chunks(2)
            .map(|pair| match *pair {
                [a, b] => g.binary(op, a, b),
                _ => pair[0],
            })
            .collect();
    }
    row.first().copied().unwrap_or_else(|| exact(g, 0.0))
}

const N: Kind = Kind::Number;
const S: Kind = Kind::Solid;

/// A function that makes a shape.
const fn new(
    name: &'static str,
    parameters: &'static [(&'static str, Kind)],
    build: fn(&mut Build<'_>) -> Result<Solid, Complaint>,
) -> Function {
    Function { name, parameters, build }
}

/// The parameters of a periodic surface.
const LATTICE: &[(&str, Kind)] = &[
    ("cell", N),
    ("thickness", Kind::Named),
    ("fraction", Kind::Named),
    ("skeletal", Kind::Named),
];

const AXIS: &[(&str, Kind)] =
    &[("radius", N), ("height", Kind::Optional), ("round", Kind::Or(0.0))];
const TURN: &[(&str, Kind)] = &[("a", S), ("degrees", N)];

/// All functions that make shapes, in the order in which they are listed to the user.
pub(super) static FUNCTIONS: [Function; 42] = [
    new("sphere", &[("radius", N)], primitives::sphere),
    new(
        "box",
        &[("x", N), ("y", Kind::Optional), ("z", Kind::Optional), ("round", Kind::Named)],
        primitives::cuboid,
    ),
    new("cylinder", AXIS, |b| primitives::cylinder(b, 2)),
    new("cyl_x", AXIS, |b| primitives::cylinder(b, 0)),
    new("cyl_y", AXIS, |b| primitives::cylinder(b, 1)),
    new("cyl_z", AXIS, |b| primitives::cylinder(b, 2)),
    new("cone", &[("radius", N), ("height", N), ("top", Kind::Or(0.0))], primitives::cone),
    new("capsule", &[("radius", N), ("height", N)], primitives::capsule),
    new("torus", &[("radius", N), ("tube", N)], primitives::torus),
    new(
        "half_space",
        &[("x", N), ("y", N), ("z", N), ("offset", Kind::Or(0.0))],
        primitives::half_space,
    ),
    new(
        "plane",
        &[("x", N), ("y", N), ("z", N), ("thickness", N), ("offset", Kind::Or(0.0))],
        primitives::plane,
    ),
    new("extrude", &[("a", S), ("height", N)], sections::extrude),
    new("revolve", &[("a", S), ("offset", Kind::Or(0.0))], sections::revolve),
    new("solid", &[("formula", S)], |b| Ok(b.solid(0))),
    new("gyroid", LATTICE, |b| lattices::build(b, &lattices::GYROID)),
    new("schwarz_p", LATTICE, |b| lattices::build(b, &lattices::SCHWARZ_P)),
    new("schwarz_d", LATTICE, |b| lattices::build(b, &lattices::SCHWARZ_D)),
    new("neovius", LATTICE, |b| lattices::build(b, &lattices::NEOVIUS)),
    new("iwp", LATTICE, |b| lattices::build(b, &lattices::IWP)),
    new("fischer_koch_s", LATTICE, |b| lattices::build(b, &lattices::FISCHER_KOCH_S)),
    new("lidinoid", LATTICE, |b| lattices::build(b, &lattices::LIDINOID)),
    new("union", &[("a", Kind::Solids), ("r", Kind::Or(0.0))], sets::union),
    new("intersection", &[("a", Kind::Solids), ("r", Kind::Or(0.0))], sets::intersection),
    new("difference", &[("a", Kind::Solids), ("r", Kind::Or(0.0))], sets::difference),
    new("complement", &[("a", S)], sets::complement),
    new("offset", &[("a", S), ("distance", N)], sets::offset),
    new("shell", &[("a", S), ("thickness", N)], sets::shell),
    new("translate", &[("a", S), ("x", N), ("y", N), ("z", N)], transforms::translate),
    new("rotate", &[("a", S), ("x", N), ("y", N), ("z", N)], transforms::rotate),
    new("rotate_x", TURN, |b| transforms::rotate_about(b, 0)),
    new("rotate_y", TURN, |b| transforms::rotate_about(b, 1)),
    new("rotate_z", TURN, |b| transforms::rotate_about(b, 2)),
    new(
        "scale",
        &[("a", S), ("x", N), ("y", Kind::Optional), ("z", Kind::Optional)],
        transforms::scale,
    ),
    new("mirror", &[("a", S), ("x", N), ("y", N), ("z", N)], transforms::mirror),
    new(
        "affine",
        &[
            ("a", S),
            ("xx", N),
            ("xy", N),
            ("xz", N),
            ("tx", N),
            ("yx", N),
            ("yy", N),
            ("yz", N),
            ("ty", N),
            ("zx", N),
            ("zy", N),
            ("zz", N),
            ("tz", N),
        ],
        transforms::affine,
    ),
    new("twist", TURN, |b| transforms::twist(b, 2)),
    new("twist_x", TURN, |b| transforms::twist(b, 0)),
    new("twist_y", TURN, |b| transforms::twist(b, 1)),
    new("twist_z", TURN, |b| transforms::twist(b, 2)),
    new("repeat_x", repeat::ALONG, |b| repeat::along(b, 0)),
    new("repeat_y", repeat::ALONG, |b| repeat::along(b, 1)),
    new("repeat_z", repeat::ALONG, |b| repeat::along(b, 2)),
];

/// The function of this name.
pub(super) fn find(name: &str) -> Option<&'static Function> {
    FUNCTIONS.iter().find(|function| function.name == name)
}

/// Whether there is a function of this name.
pub(super) fn exists(name: &str) -> bool {
    find(name).is_some()
}
