//! Surfaces in the scene file: formulas, blends, colours.

use schemars::JsonSchema;
use serde::Deserialize;

use crate::scene::{
    leaf::{Color, Number, Numbers, Table, Whole},
    spanned::Spanned,
};

/// What is drawn: one of `f`, `shape`, `blend`, `spheres` and `file`.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct SurfaceSpec {
    /// For messages and statistics; "surface 1" and so on by default.
    pub(in crate::scene) name: Option<String>,
    /// The formula; `a = b` means a − b = 0, and `a <= b` is a solid.
    pub(in crate::scene) f: Option<Spanned<String>>,
    /// A shape: solids joined by `|` (union), `&` (intersection) and `-` (difference).
    pub(in crate::scene) shape: Option<Spanned<String>>,
    /// A blend of spheres.
    pub(in crate::scene) blend: Option<Spanned<Table<BlendSpec>>>,
    /// The union of spheres, each `[x, y, z, radius]`.
    pub(in crate::scene) spheres: Option<Spanned<Vec<Spanned<Numbers<4>>>>>,
    /// A function graph in the text format of libfive and Fidget: the file `NAME.vm`, relative to
    /// the folder of the scene.
    pub(in crate::scene) file: Option<Spanned<String>>,
    /// The sign of F inside: negative by default for `f` and `file`, positive for `blend`; a
    /// comparison says itself what is inside, and shapes and spheres have no other.
    pub(in crate::scene) inside: Option<Spanned<Inside>>,
    /// What is kept, as an inequality; the cuts are open. `clip` of `[domain]` applies as well.
    pub(in crate::scene) clip: Option<Spanned<String>>,
    /// Whether the cuts of clips are closed; by default as `[domain]` says.
    pub(in crate::scene) cap: Option<Spanned<bool>>,
    /// By default the next of a small palette.
    pub(in crate::scene) color: Option<Spanned<Color>>,
    /// What the colour tells instead: "position", "normal", "certificate", "curvature", "value" (F in
    /// the middle of the voxel) or a formula. `palette` and `color_range` are for the last three.
    pub(in crate::scene) color_by: Option<Spanned<String>>,
    /// The colours for numbers; "viridis" by default, "blue-red" for curvature.
    pub(in crate::scene) palette: Option<Spanned<PaletteSpec>>,
    /// The numbers with the first and the last of these colours; by default [-1, 1], and for
    /// curvature [-10, 10] divided by the longest edge of the domain.
    pub(in crate::scene) color_range: Option<Spanned<Numbers<2>>>,
    /// The colour seen from inside; by default the same.
    pub(in crate::scene) back_color: Option<Color>,
    /// Strength of the highlight in [0, 1]; 0.3 by default.
    #[schemars(range(min = 0, max = 1))]
    pub(in crate::scene) specular: Option<Spanned<Number>>,
    /// Exponent of the highlight from 1 to 1000; 32 by default.
    #[schemars(range(min = 1, max = 1000))]
    pub(in crate::scene) shininess: Option<Spanned<Whole>>,
}

/// A blend of spheres: the sum of (1 − (a d / radius)²)⁴ over the balls in which it is positive,
/// minus the threshold; d is the distance to a centre.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct BlendSpec {
    /// The value of the sum on the surface, above 0.
    pub(in crate::scene) threshold: Spanned<Number>,
    /// Where a sphere with `a = 1` ends, above 0.
    pub(in crate::scene) radius: Spanned<Number>,
    /// Each `[x, y, z, a]`: the centre, and a > 0 that scales the distance to it.
    pub(in crate::scene) spheres: Spanned<Vec<Spanned<Numbers<4>>>>,
}

/// Which sign of F means inside.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub(in crate::scene) enum Inside {
    Negative,
    Positive,
}

/// Colours in a row.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub(in crate::scene) enum PaletteSpec {
    /// Dark blue to yellow.
    Viridis,
    /// Black to white over red.
    Magma,
    /// Blue to yellow over red.
    Plasma,
    /// As viridis, for all kinds of colour vision.
    Cividis,
    /// Many colours.
    Turbo,
    /// Blue to white to red.
    BlueRed,
    /// Black to white.
    Gray,
}
