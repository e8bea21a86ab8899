//! Sculptures: what strokes make of a formula.

use std::sync::Arc;

use glam::DVec3;

use super::{
    color::{WHITE, default_color},
    leaf::Numbers,
    lower::Lower,
    spanned::Spanned,
    spec::{DeedSpec, FalloffSpec, MirrorSpec, PathSpec, SculptureSpec, Section, StrokeSpec},
    volume::polygons,
};
use crate::{
    diagnostic::Diagnostic,
    math::Aabb,
    mesh::Mesh,
    raster::{Material, Model},
    sculpt::{DEPTH, Deed, Falloff, Path, Piece, Plan, Shape, Stroke, Tool},
};

/// A sculpture of a scene.
#[derive(Clone, Debug)]
pub struct Carving {
    name: String,
    material: Material,
    plan: Arc<Plan>,
    /// Whether a film shows one stroke after the other.
    pub is_filmed: bool,
}

impl Carving {
    /// What it looks like when this part of the work is done, from 0 to 1.
    #[must_use]
    pub fn at(&self, time: f64) -> (Model, Mesh) {
        let n = (time * self.plan.n_pieces() as f64).round() as usize;
        let mut mesh = self.plan.mesh(&self.plan.carved(n));
        mesh.name.clone_from(&self.name);
        mesh.color = self.material.color;
        let (name, material) = (self.name.clone(), self.material);
        (Model { name, polygons: polygons(&mesh), material }, mesh)
    }
}

impl Lower<'_> {
    /// All sculptures, after `n_before` other things with colours.
    pub(super) fn carvings(
        &mut self,
        specs: &[Section<SculptureSpec>],
        n_before: usize,
    ) -> Vec<Carving> {
        let carving = |(i, section)| self.carving(i, n_before + i, section);
        specs.iter().enumerate().filter_map(carving).collect()
    }

    fn carving(
        &mut self,
        number: usize,
        index: usize,
        section: &Section<SculptureSpec>,
    ) -> Option<Carving> {
        let spec = &section.spec;
        let usual = if self.has_matcap { WHITE } else { default_color(index) };
        let colors = (spec.color.unwrap_or(usual), spec.back_color);
        let material = self.material_of(colors, spec.specular.as_ref(), spec.shininess.as_ref());
        let name = spec.name.clone().unwrap_or_else(|| format!("sculpture {}", number + 1));
        let size = self.whole("size", spec.size.as_ref(), 8..=512, 128);
        let mut corner = |key: &str, corner: &Option<Spanned<Numbers<3>>>, usual: f64| {
            let given = corner.as_ref().map(|corner| self.coordinates(key, corner));
            DVec3::from_array(given.unwrap_or([usual; 3]))
        };
        let bounds =
            Aabb { min: corner("min", &spec.min, -1.0), max: corner("max", &spec.max, 1.0) };
        if bounds.min.cmpge(bounds.max).any() {
            let span =
                spec.max.as_ref().or(spec.min.as_ref()).map_or(section.span.clone(), Spanned::span);
            self.errors.push(
                Diagnostic::new(span, "the box of the sculpture is empty")
                    .help("every number of `min` must be below its partner in `max`"),
            );
            return None;
        }
        let start = match &spec.f {
            Some(f) => Some(self.resolve_once(&self.formula(f))?.expr.tape()),
            None => None,
        };
        let strokes: Vec<Vec<Stroke>> =
            spec.strokes.iter().filter_map(|stroke| self.stroke(stroke, &bounds, size)).collect();
        if strokes.len() < spec.strokes.len() {
            return None;
        }
        let plan = Plan::new(start.as_ref(), bounds, size, strokes.concat());
        let is_filmed = spec.film.unwrap_or(false);
        Some(Carving { name, material, plan: plan.into(), is_filmed })
    }

    /// The sculptures when all is done, as polygons and as meshes.
    pub(super) fn carved(
        &mut self,
        specs: &[Section<SculptureSpec>],
        carvings: &[Carving],
    ) -> (Vec<Model>, Vec<Mesh>) {
        let carved: Vec<(Model, Mesh)> = carvings.iter().map(|carving| carving.at(1.0)).collect();
        // After a mistake some are missing, and there is no picture.
        if carvings.len() == specs.len() {
            for (section, (_, mesh)) in specs.iter().zip(&carved) {
                if mesh.triangles.is_empty() {
                    self.errors.push(
                        Diagnostic::new(section.span.clone(), "nothing is left of the sculpture")
                            .help(
                                "begin with a solid, as in f = \"x^2 + y^2 + z^2 - 0.5\", or fill",
                            ),
                    );
                }
            }
        }
        carved.into_iter().unzip()
    }

    /// A stroke and its mirror image, if it has one, piece by piece.
    fn stroke(
        &mut self,
        section: &Section<StrokeSpec>,
        bounds: &Aabb,
        size: u32,
    ) -> Option<Vec<Stroke>> {
        let spec = &section.spec;
        let mut missing = |key: &str, example: &str| {
            self.errors.push(
                Diagnostic::new(section.span.clone(), format!("the stroke has no `{key}`"))
                    .help(format!("add it, as in {example}")),
            );
        };
        let Some(deed) = &spec.deed else {
            missing("do", "do = \"add\"");
            return None;
        };
        let Some(at) = spec.at.as_ref().filter(|at| !at.get_ref().is_empty()) else {
            missing("at", "at = [[0, 0, 1]]");
            return None;
        };
        let Some(radius) = &spec.radius else {
            missing("radius", "radius = 0.2");
            return None;
        };
        let samples = f64::from(size) / bounds.size().max_element();
        let radius = self.positive("radius", radius) * samples;
        let strength = self.number("strength", spec.strength.as_ref(), 0.0..=100.0, 0.5);
        let angle = self.number("angle", spec.angle.as_ref(), -3600.0..=3600.0, 90.0).to_radians();
        let axis = spec.axis.as_ref().map_or(DVec3::Z, |axis| self.direction("axis", axis));
        let shape = match spec.tool.as_ref().map(|tool| (tool.get_ref().as_str(), tool)) {
            None | Some(("ball", _)) => Shape::Ball,
            Some(("cube", _)) => Shape::Cube,
            Some((_, formula)) => {
                let formula = self.formula(formula);
                Shape::Formula(Box::new(self.resolve_once(&formula)?.expr.tape()))
            }
        };
        let deed = *deed.get_ref();
        let tool = |is_mirrored: bool| Tool {
            shape: shape.clone(),
            deed: match deed {
                DeedSpec::Add => Deed::Add,
                DeedSpec::Remove => Deed::Remove,
                DeedSpec::Fill => Deed::Fill,
                DeedSpec::Cut => Deed::Cut,
                DeedSpec::Smooth => Deed::Smooth,
                DeedSpec::Drag => Deed::Drag,
                DeedSpec::Twist => Deed::Twist {
                    axis: flipped(
                        axis.normalize_or(DVec3::Z),
                        spec.mirror.filter(|_| is_mirrored),
                        0.0,
                    ),
                    angle: if is_mirrored { -angle } else { angle },
                },
            },
            radius,
            strength: match deed {
                DeedSpec::Smooth => strength,
                _ => strength * radius / (2.0 * DEPTH),
            },
            falloff: match spec.falloff.unwrap_or(FalloffSpec::Smooth) {
                FalloffSpec::Linear => Falloff::Linear,
                FalloffSpec::Smooth => Falloff::Smooth,
                FalloffSpec::Hard => Falloff::Hard,
            },
            range: [-DEPTH, DEPTH],
        };
        let usual = if deed == DeedSpec::Drag { PathSpec::Line } else { PathSpec::Points };
        let path = match spec.path.unwrap_or(usual) {
            PathSpec::Points => Path::Points,
            PathSpec::Line => Path::Line,
            PathSpec::Curve => Path::Curve,
        };
        let to_samples = |p: &Numbers<3>| samples * (DVec3::from_array(p.0) - bounds.min);
        let places: Vec<DVec3> = at.get_ref().iter().map(to_samples).collect();
        let times = self.whole("times", spec.times.as_ref(), 1..=1000, 1);
        let pieces = path.pieces(&places).repeat(times as usize);
        let Some(mirror) = spec.mirror else {
            return Some(vec![Stroke { tool: tool(false), pieces }]);
        };
        let middle = 0.5 * samples * bounds.size();
        let flip = |p: DVec3| flipped(p, Some(mirror), 2.0 * middle[mirror as usize]);
        let both = pieces.into_iter().flat_map(|piece| {
            let image = Piece { from: flip(piece.from), to: flip(piece.to) };
            [(false, piece), (true, image)]
        });
        Some(both.map(|(is, piece)| Stroke { tool: tool(is), pieces: vec![piece] }).collect())
    }
}

/// The mirror image of a place, with the plane at half of `twice`.
fn flipped(mut p: DVec3, mirror: Option<MirrorSpec>, twice: f64) -> DVec3 {
    if let Some(mirror) = mirror {
        p[mirror as usize] = twice - p[mirror as usize];
    }
    p
}
