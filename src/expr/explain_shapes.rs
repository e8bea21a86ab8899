//! What is said about shapes that cannot be made.

use std::ops::Range;

use super::{
    explain::meant,
    shapes::{Complaint, FUNCTIONS, Function, Kind},
};
use crate::diagnostic::Diagnostic;

/// `name` stands without parentheses, and makes shapes.
pub(super) fn bare_shape(function: &Function, span: Range<usize>) -> Diagnostic {
    Diagnostic::new(span, format!("`{}` lacks its sizes", function.name))
        .label("this makes a shape")
        .help(write_so(function))
}

/// What makes shapes, for one who looks for something else.
pub(super) fn known_shapes() -> String {
    let names: Vec<&str> = FUNCTIONS.iter().map(|function| function.name).collect();
    format!("shapes are made by {}", names.join(", "))
}

/// What other languages call shapes and what is done to them, and how it is written here.
const ELSEWHERE: [(&str, &str); 44] = [
    ("cube", "box"),
    ("cuboid", "box"),
    ("rounded_box", "box"),
    ("roundedBox", "box"),
    ("ball", "sphere"),
    ("cyl", "cylinder"),
    ("capped_cylinder", "cylinder"),
    ("pipe", "cylinder"),
    ("tube", "shell"),
    ("frustum", "cone"),
    ("capped_cone", "cone"),
    ("pill", "capsule"),
    ("donut", "torus"),
    ("circle", "cyl_z"),
    ("square", "box"),
    ("rect", "box"),
    ("rectangle", "box"),
    ("slab", "plane"),
    ("halfspace", "half_space"),
    ("linear_extrude", "extrude"),
    ("rotate_extrude", "revolve"),
    ("lathe", "revolve"),
    ("move", "translate"),
    ("at", "translate"),
    ("shift", "translate"),
    ("orient", "rotate"),
    ("reflect", "mirror"),
    ("multmatrix", "affine"),
    ("matrix", "affine"),
    ("add", "union"),
    ("fuse", "union"),
    ("merge", "union"),
    ("join", "union"),
    ("smooth_union", "union"),
    ("blend", "union"),
    ("intersect", "intersection"),
    ("subtract", "difference"),
    ("cut", "difference"),
    ("minus", "difference"),
    ("inverse", "complement"),
    ("invert", "complement"),
    ("expand", "offset"),
    ("diamond", "schwarz_d"),
    ("primitive", "schwarz_p"),
];

/// The function that `name` stands for in another language, as it is written here.
pub(super) fn elsewhere(name: &str) -> Option<String> {
    let (_, here) = ELSEWHERE.iter().find(|(elsewhere, _)| *elsewhere == name)?;
    FUNCTIONS.iter().find(|function| function.name == *here).map(Function::usage)
}

fn write_so(function: &Function) -> String {
    let usage = function.usage();
    match function.parameters.first() {
        Some((_, Kind::Solid)) => {
            let rest = usage.replacen("a, ", "", 1);
            format!("write `{usage}` or `a.{rest}`")
        }
        _ => format!("write `{usage}`"),
    }
}

/// A difference of a shape and a value.
pub(super) fn shape_and_value(span: Range<usize>) -> Diagnostic {
    Diagnostic::new(span, "this can be read in two ways")
        .label("one side is a shape, the other is none")
        .help(
            "write `a - solid(b)` to cut off a shape, `a + (-b)` to subtract values; \
             `offset(a, length)` grows a shape",
        )
}

/// `a + b` and `a*b` of shapes.
pub(super) fn arithmetic(span: Range<usize>) -> Diagnostic {
    Diagnostic::new(span, "shapes are not added or multiplied")
        .label("both sides are shapes")
        .help("write `|` for their union, `&` for their intersection")
}

/// `a | b - c`
pub(super) fn order_of_sets(span: Range<usize>, sign: &str) -> Diagnostic {
    Diagnostic::new(span, "this can be read in two ways")
        .label("what belongs together here?")
        .help(format!("write `(a | b) {sign} c` or `a | (b {sign} c)`"))
}

/// A number where a shape is joined.
pub(super) fn no_shape(span: Range<usize>) -> Diagnostic {
    Diagnostic::new(span, "this is a number, not a shape").label("the same everywhere").help(
        "write a shape, such as sphere(1), or a formula in x, y and z that is negative inside",
    )
}

pub(super) fn equation_for_shape(span: Range<usize>) -> Diagnostic {
    Diagnostic::new(span, "a shape is no equation")
        .label("does not say what is inside")
        .help("write `<=` or `>=` in place of `=`")
}

/// A parameter that takes a shape got a number.
pub(super) fn number_for_shape(function: &Function, name: &str, span: Range<usize>) -> Diagnostic {
    Diagnostic::new(span, format!("`{name}` of `{}` is a number, not a shape", function.name))
        .label("a shape is wanted here")
        .help(write_so(function))
}

/// A parameter that takes a number got something else.
pub(super) fn no_number(
    function: &Function,
    name: &str,
    span: Range<usize>,
    is_shape: bool,
) -> Diagnostic {
    let what = if is_shape { "a shape" } else { "not the same everywhere" };
    Diagnostic::new(span, format!("`{name}` of `{}` is {what}", function.name))
        .label("a number is wanted here")
        .help(write_so(function))
}

pub(super) fn no_value(function: &str, name: &str, span: Range<usize>) -> Diagnostic {
    Diagnostic::new(span, format!("`{name}` of `{function}` has no value"))
        .label("undefined, or too large")
        .help("it divides by 0, perhaps, or takes a root of a negative number")
}

/// An argument that the shape cannot have.
pub(super) fn wrong_argument(
    function: &Function,
    span: Range<usize>,
    complaint: &Complaint,
) -> Diagnostic {
    let message = match complaint.parameter.and_then(|index| function.parameters.get(index)) {
        Some((name, _)) => format!("`{name}` of `{}` {}", function.name, complaint.message),
        None => format!("`{}` {}", function.name, complaint.message),
    };
    Diagnostic::new(span, message).help(complaint.help.clone())
}

pub(super) fn too_large(span: Range<usize>) -> Diagnostic {
    Diagnostic::new(span, "the shape is too large a formula")
        .label("more than a million operations")
        .help("use fewer copies of copies")
}

pub(super) fn unknown_argument(function: &Function, name: &str, span: Range<usize>) -> Diagnostic {
    let known: Vec<&str> = function.parameters.iter().map(|&(name, _)| name).collect();
    let begun = known.iter().copied().find(|known| known.starts_with(name));
    let hint = match begun.or_else(|| meant(name, &known)) {
        Some(meant) => format!("did you mean `{meant}`? "),
        None => String::new(),
    };
    Diagnostic::new(span, format!("`{}` has no argument `{name}`", function.name))
        .label("not known here")
        .help(format!("{hint}{}", write_so(function)))
}

pub(super) fn given_before(function: &Function, name: &str, span: Range<usize>) -> Diagnostic {
    Diagnostic::new(span, format!("`{name}` of `{}` is given twice", function.name))
        .label("given before")
        .help(write_so(function))
}

pub(super) fn after_names(function: &Function, span: Range<usize>) -> Diagnostic {
    Diagnostic::new(span, "an argument without a name follows one with a name")
        .label("which one is this?")
        .help(write_so(function))
}

pub(super) fn too_many(function: &Function, span: Range<usize>, found: usize) -> Diagnostic {
    let n = function.parameters.iter().filter(|(_, kind)| *kind != Kind::Named).count();
    let named = function.parameters.iter().find(|(_, kind)| *kind == Kind::Named);
    let hint =
        named.map_or(String::new(), |(name, _)| format!("; give others by name, `{name} = …`"));
    let s = if n == 1 { "" } else { "s" };
    Diagnostic::new(span, format!("`{}` takes {n} argument{s} at most, not {found}", function.name))
        .help(format!("{}{hint}", write_so(function)))
}

pub(super) fn missing_argument(function: &Function, name: &str, span: Range<usize>) -> Diagnostic {
    Diagnostic::new(span, format!("`{}` lacks `{name}`", function.name)).help(write_so(function))
}

/// A length that is measured with values that are none.
pub(super) fn no_length(name: &str, span: Range<usize>, why: &str) -> Diagnostic {
    Diagnostic::new(span, format!("lengths in `{name}` are not true: {why}"))
        .label("larger or smaller than written")
        .help(
            "formulas, twists and uneven scales have no distances; do this before them if you can",
        )
}
