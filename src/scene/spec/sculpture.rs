//! Sculptures and their strokes in the scene file.

use schemars::JsonSchema;
use serde::Deserialize;

use super::Section;
use crate::scene::{
    leaf::{Color, Number, Numbers, Whole},
    spanned::Spanned,
};

/// A solid on a grid of samples, and the strokes that change it.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct SculptureSpec {
    /// For messages and meshes; "sculpture 1" and so on by default.
    pub(in crate::scene) name: Option<String>,
    /// What it is before the first stroke: F < 0 is solid. By default there is nothing.
    pub(in crate::scene) f: Option<Spanned<String>>,
    /// Samples along the longest edge of its box, from 8 to 512; 128 by default.
    #[schemars(range(min = 8, max = 512))]
    pub(in crate::scene) size: Option<Spanned<Whole>>,
    /// The first corner of its box; `[-1, -1, -1]` by default.
    pub(in crate::scene) min: Option<Spanned<Numbers<3>>>,
    /// The last corner of its box; `[1, 1, 1]` by default.
    pub(in crate::scene) max: Option<Spanned<Numbers<3>>>,
    /// Whether a film shows one stroke after the other; false by default.
    pub(in crate::scene) film: Option<bool>,
    /// The strokes, in order.
    #[serde(rename = "stroke", default)]
    pub(in crate::scene) strokes: Vec<Section<StrokeSpec>>,
    /// By default the next of a small palette.
    pub(in crate::scene) color: Option<Color>,
    /// The colour seen from inside; by default the same.
    pub(in crate::scene) back_color: Option<Color>,
    /// Strength of the highlight in [0, 1]; 0.3 by default.
    #[schemars(range(min = 0, max = 1))]
    pub(in crate::scene) specular: Option<Spanned<Number>>,
    /// Exponent of the highlight from 1 to 1000; 32 by default.
    #[schemars(range(min = 1, max = 1000))]
    pub(in crate::scene) shininess: Option<Spanned<Whole>>,
}

/// A stroke of a tool.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct StrokeSpec {
    /// What the tool does: "add", "remove", "fill", "cut", "smooth", "twist", "drag", "bend" or
    /// "inflate".
    #[serde(rename = "do")]
    #[schemars(required)]
    pub(in crate::scene) deed: Option<Spanned<DeedSpec>>,
    /// Where it goes: one place or more. A bend has its hinge at the first place, and its arm towards the
    /// next.
    #[schemars(required)]
    pub(in crate::scene) at: Option<Spanned<Vec<Numbers<3>>>>,
    /// How it gets from place to place; "points" by default, "line" for drags, bends and tools that
    /// are pushed.
    pub(in crate::scene) path: Option<PathSpec>,
    /// "ball", "cube", or a formula in radii from the tool's middle with F < 0 inside; "ball" by
    /// default.
    pub(in crate::scene) tool: Option<Spanned<String>>,
    /// From the tool's middle to its border.
    #[schemars(required)]
    pub(in crate::scene) radius: Option<Spanned<Number>>,
    /// By how much an addition or removal moves the surface in the tool's middle, in parts of its radius;
    /// more than 4 samples set down a ball or dig a hole of their own. The same of an inflation. How much
    /// is smoothed, in [0, 1]. 0.5 by default.
    pub(in crate::scene) strength: Option<Spanned<Number>>,
    /// How the effect falls off from the tool's middle; "smooth" by default, "hard" for tools that are
    /// pushed.
    pub(in crate::scene) falloff: Option<FalloffSpec>,
    /// The axis of a twist or a bend; `[0, 0, 1]` by default.
    pub(in crate::scene) axis: Option<Spanned<Numbers<3>>>,
    /// Degrees of a twist in the tool's middle, or of a bend; 90 by default.
    pub(in crate::scene) angle: Option<Spanned<Number>>,
    /// How often it is done; 1 by default.
    #[schemars(range(min = 1, max = 1000))]
    pub(in crate::scene) times: Option<Spanned<Whole>>,
    /// "contact": the tool is pushed, and moves on only when nothing solid is left in it. "free" by
    /// default.
    pub(in crate::scene) advance: Option<Spanned<AdvanceSpec>>,
    /// Of a tool that is pushed: how far the hand goes in a moment; a sample by default.
    pub(in crate::scene) step: Option<Spanned<Number>>,
    /// Of a tool that is pushed: the force for each length by which it lags behind the hand; 1 by
    /// default.
    pub(in crate::scene) stiffness: Option<Spanned<Number>>,
    /// Of a tool that is pushed: moments after which it stops, wherever it is; 1000 by default.
    #[schemars(range(min = 1, max = 100_000))]
    pub(in crate::scene) moments: Option<Spanned<Whole>>,
    /// Whether the same happens on the other side of a plane through the middle of the box.
    pub(in crate::scene) mirror: Option<MirrorSpec>,
}

/// What a tool does.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub(in crate::scene) enum DeedSpec {
    /// Raises the surface.
    Add,
    /// Lowers the surface.
    Remove,
    /// Makes solid what is in the tool.
    Fill,
    /// Empties what is in the tool.
    Cut,
    /// Smooths the surface.
    Smooth,
    /// Turns what is in the tool; the volume stays what it is.
    Twist,
    /// Drags what is in the tool along its way; the volume stays what it is.
    Drag,
    /// Bends what is in the tool about the beginning of its way; the volume stays what it is.
    Bend,
    /// Raises the surface in the inner half of the tool and lowers it in the outer; the volume stays
    /// what it is.
    Inflate,
}

/// How a tool moves on.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub(in crate::scene) enum AdvanceSpec {
    /// As it is led.
    Free,
    /// When nothing solid is left in it.
    Contact,
}

/// How a tool gets from place to place.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub(in crate::scene) enum PathSpec {
    /// It is set down at each.
    Points,
    /// Along straight lines.
    Line,
    /// Along a smooth curve.
    Curve,
}

/// How the effect of a tool falls off.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub(in crate::scene) enum FalloffSpec {
    /// Evenly.
    Linear,
    /// Smoothly.
    Smooth,
    /// Not at all.
    Hard,
}

/// A plane across an axis.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub(in crate::scene) enum MirrorSpec {
    X,
    Y,
    Z,
}
