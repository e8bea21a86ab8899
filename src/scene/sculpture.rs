//! Sculptures: what strokes make of a formula.

use std::sync::{Arc, OnceLock};

use glam::{DAffine3, DVec3};

use super::{
    color::{WHITE, default_color},
    leaf::Numbers,
    lower::Lower,
    solid::{Origin, Solid},
    spanned::Spanned,
    spec::{
        AdvanceSpec, DeedSpec, FalloffSpec, MirrorSpec, PathSpec, SculptureSpec, Section,
        StrokeSpec,
    },
};
use crate::{
    diagnostic::Diagnostic,
    hrb::{Samples, Storage},
    isosurface::Regions,
    math::Aabb,
    mesh::{Border, Mesh},
    progress::Progress,
    raster::Field,
    sculpt::{
        Contact, DEPTH, Deed, Falloff, Felt, Path, Piece, Plan, Sculpture, Shape, Stroke, Tool,
    },
};

/// A sculpture of a scene.
#[derive(Debug)]
pub struct Carving {
    plan: Arc<Plan>,
    /// Whether a film shows one stroke after the other.
    pub is_filmed: bool,
    /// When all is done, once that is known.
    done: OnceLock<Arc<Carved>>,
}

/// What a sculpture is like at some time of the work.
#[derive(Debug)]
pub struct Carved {
    plan: Arc<Plan>,
    sculpture: Sculpture<f32>,
    felt: Vec<Felt>,
}

impl Carving {
    fn new(plan: Plan, is_filmed: bool) -> Self {
        Self { plan: plan.into(), is_filmed, done: OnceLock::new() }
    }

    /// What it looks like when this part of the work is done, from 0 to 1, or all if that is not filmed;
    /// `None` if `progress` asks to stop.
    #[must_use]
    pub fn at(&self, time: f64, progress: &dyn Progress) -> Option<Arc<Carved>> {
        let n = match self.is_filmed {
            true => (time * self.plan.n() as f64).round() as usize,
            false => self.plan.n(),
        };
        let is_done = n == self.plan.n();
        if let Some(done) = self.done.get().filter(|_| is_done) {
            return Some(done.clone());
        }
        let (sculpture, felt) = self.plan.carved(n, progress)?;
        let carved = Arc::new(Carved { plan: self.plan.clone(), sculpture, felt });
        Some(if is_done { self.done.get_or_init(|| carved).clone() } else { carved })
    }

    /// The box of all its samples.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        self.plan.bounds()
    }

    /// The bytes that its octrees may take at most: as it begins, and at work.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        // A value of four bytes in each, its corners, and a part of the nodes.
        const BYTES_PER_SAMPLE: u64 = 2 * 6;
        BYTES_PER_SAMPLE * self.plan.size().iter().map(|&n| u64::from(n)).product::<u64>()
    }
}

impl Carved {
    /// The mesh that has followed the tools, in scene coordinates.
    #[must_use]
    pub fn mesh(&self) -> Mesh {
        self.plan.mesh(&self.sculpture)
    }

    /// What the octree takes.
    #[must_use]
    pub fn storage(&self) -> Storage {
        self.sculpture.octree().storage()
    }

    /// What hands have felt.
    #[must_use]
    pub fn felt(&self) -> &[Felt] {
        &self.felt
    }
}

impl Field for Carved {
    fn size(&self) -> [u32; 3] {
        self.plan.size()
    }

    fn placing(&self) -> DAffine3 {
        self.plan.placing()
    }

    fn is_capped(&self) -> bool {
        true
    }

    fn bricks(&self) -> Vec<[u32; 3]> {
        Regions::bricks(self.sculpture.octree(), self.sculpture.isovalue(), Border::Capped)
    }

    fn values(&self, first: [u32; 3], end: [u32; 3]) -> Vec<f32> {
        let samples = Samples { first, end };
        self.sculpture.octree().offsets(&samples, self.sculpture.isovalue())
    }
}

impl Lower<'_> {
    /// All sculptures, after `n_before` other things with colours.
    pub(super) fn sculptures(
        &mut self,
        specs: &[Section<SculptureSpec>],
        n_before: usize,
    ) -> Vec<Solid> {
        let sculpture = |(i, section)| self.sculpture(i, n_before + i, section);
        specs.iter().enumerate().filter_map(sculpture).collect()
    }

    fn sculpture(
        &mut self,
        number: usize,
        index: usize,
        section: &Section<SculptureSpec>,
    ) -> Option<Solid> {
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
        let strokes: Vec<Vec<Stroke>> = (1..)
            .zip(&spec.strokes)
            .filter_map(|stroke| self.stroke(stroke, &bounds, size))
            .collect();
        if strokes.len() < spec.strokes.len() {
            return None;
        }
        let plan = Plan::new(start, bounds, size, strokes.concat());
        if plan.is_of_nothing() && !section.is_damaged {
            self.errors.push(
                Diagnostic::new(section.span.clone(), "nothing is left of the sculpture")
                    .help("begin with a solid, as in f = \"x^2 + y^2 + z^2 - 0.5\", or fill"),
            );
            return None;
        }
        let origin = Origin::Sculpture(Carving::new(plan, spec.film.unwrap_or(false)));
        Some(Solid { name, material, origin })
    }

    /// A stroke and its mirror image, if it has one, piece by piece.
    fn stroke(
        &mut self,
        (number, section): (usize, &Section<StrokeSpec>),
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
        let contact = self.contact(spec, samples);
        let (deed, at_deed) = (*deed.get_ref(), deed);
        let tool = |is_mirrored: bool| Tool {
            shape: shape.clone(),
            deed: match deed {
                DeedSpec::Add => Deed::Add,
                DeedSpec::Remove => Deed::Remove,
                DeedSpec::Fill => Deed::Fill,
                DeedSpec::Cut => Deed::Cut,
                DeedSpec::Smooth => Deed::Smooth,
                DeedSpec::Drag => Deed::Drag,
                DeedSpec::Inflate => Deed::Inflate,
                DeedSpec::Twist | DeedSpec::Bend => {
                    let mirror = spec.mirror.filter(|_| is_mirrored);
                    let axis = flipped(axis.normalize_or(DVec3::Z), mirror, 0.0);
                    let angle = if is_mirrored { -angle } else { angle };
                    match deed {
                        DeedSpec::Twist => Deed::Twist { axis, angle },
                        _ => Deed::Bend { axis, angle },
                    }
                }
            },
            radius,
            strength: match deed {
                DeedSpec::Smooth => strength,
                _ => strength * radius / (2.0 * DEPTH),
            },
            falloff: match spec.falloff.unwrap_or(match contact {
                Some(_) => FalloffSpec::Hard,
                None => FalloffSpec::Smooth,
            }) {
                FalloffSpec::Linear => Falloff::Linear,
                FalloffSpec::Smooth => Falloff::Smooth,
                FalloffSpec::Hard => Falloff::Hard,
            },
            range: [-DEPTH, DEPTH],
        };
        let is_led = matches!(deed, DeedSpec::Drag | DeedSpec::Bend) || contact.is_some();
        let usual = if is_led { PathSpec::Line } else { PathSpec::Points };
        let path = match spec.path.unwrap_or(usual) {
            PathSpec::Points => Path::Points,
            PathSpec::Line => Path::Line,
            PathSpec::Curve => Path::Curve,
        };
        let to_samples = |p: &Numbers<3>| samples * (DVec3::from_array(p.0) - bounds.min);
        let places: Vec<DVec3> = at.get_ref().iter().map(to_samples).collect();
        let times = self.whole("times", spec.times.as_ref(), 1..=1000, 1);
        let pieces = path.pieces(&places);
        let goes = pieces.iter().any(|piece| piece.from != piece.to);
        if let Some(fault) = match (deed, contact) {
            (DeedSpec::Bend, _) if !goes => Some(("a bend has an arm", BEND_HELP)),
            (DeedSpec::Remove | DeedSpec::Cut, Some(_)) if goes => None,
            (DeedSpec::Remove | DeedSpec::Cut, Some(_)) => {
                Some(("a tool that is pushed goes somewhere", PUSH_HELP))
            }
            (_, Some(_)) => Some(("what is pushed takes away", "write do = \"remove\" or \"cut\"")),
            _ => None,
        } {
            let (message, help) = fault;
            self.errors.push(Diagnostic::new(at_deed.span(), message).help(help));
            return None;
        }
        // Piece by piece with their images, unless a hand pushes.
        let ways: Vec<Vec<Piece>> = match contact.is_some() || spec.mirror.is_none() {
            true => vec![pieces],
            false => pieces.into_iter().map(|piece| vec![piece]).collect(),
        };
        let middle = 0.5 * samples * bounds.size();
        let image = |piece: &Piece| {
            let flip = |p: DVec3| match spec.mirror {
                Some(mirror) => flipped(p, Some(mirror), 2.0 * middle[mirror as usize]),
                None => p,
            };
            Piece { from: flip(piece.from), to: flip(piece.to) }
        };
        let stroke = |is_image: bool, way: &[Piece]| Stroke {
            tool: tool(is_image),
            pieces: if is_image { way.iter().map(image).collect() } else { way.to_vec() },
            contact,
            number,
        };
        let sides: &[bool] = if spec.mirror.is_some() { &[false, true] } else { &[false] };
        let once = ways.iter().flat_map(|way| sides.iter().map(|&is| stroke(is, way)));
        Some((0..times).flat_map(|_| once.clone()).collect())
    }

    /// How a stroke's tool is pushed, if it is.
    fn contact(&mut self, spec: &StrokeSpec, samples: f64) -> Option<Contact> {
        let step = spec.step.as_ref().map(|step| self.positive("step", step) * samples);
        let stiffness = spec.stiffness.as_ref().map(|it| self.positive("stiffness", it));
        let moments = self.whole("moments", spec.moments.as_ref(), 1..=100_000, 1000) as usize;
        match spec.advance.as_ref().map(Spanned::get_ref) {
            Some(AdvanceSpec::Contact) => Some(Contact {
                // Ways would have too many moments.
                step: step.unwrap_or(1.0).max(1e-3),
                stiffness: stiffness.unwrap_or(1.0) / samples,
                moments,
            }),
            _ => None,
        }
    }
}

const BEND_HELP: &str = "add the place that its arm goes to, as in at = [[0, 0, 0], [1, 0, 0]]";
const PUSH_HELP: &str = "add the places of its way, as in at = [[0, 0, 1], [0, 0, 0]]";

/// The mirror image of a place, with the plane at half of `twice`.
fn flipped(mut p: DVec3, mirror: Option<MirrorSpec>, twice: f64) -> DVec3 {
    if let Some(mirror) = mirror {
        p[mirror as usize] = twice - p[mirror as usize];
    }
    p
}
