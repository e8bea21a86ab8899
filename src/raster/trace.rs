//! Where rays meet the surface itself: proven misses, bracketed roots.
//!
//! A voxel says that the surface may be in it, not where. Along the part of a ray in it F is a
//! function of one variable, of which intervals tell everything that is needed: if F is not 0
//! there the ray goes on to the next voxel, and if the slope along the ray has one sign the signs
//! at the ends tell whether there is a root, and there is only one. Otherwise the part is halved,
//! the nearer half first. A part that stays open when it is a thousandth of a voxel counts as a
//! hit: the ray touches the surface.
//!
//! The rays of a block are followed 64 at a time, each from cell to cell by itself.
//!
//! *Based on:* D. Mitchell, "Robust Ray Intersection with Interval Arithmetic", Graphics Interface
//! 1990.

use fearless_simd::{Simd, f64x8};
use glam::DVec3;

use super::{
    roots::Bracket,
    screen::Ray,
    sight::Sight,
    sweep::{Sighting, Swept},
    walk::{Cells, Span, Walk},
};
use crate::{
    eval::{
        BATCH, BoxEvaluator, Boxes, GradientEvaluator, POINT_BATCH, PointEvaluator, Points,
        SlopeEvaluator, batch,
    },
    expr::Tape,
    math::{SimdLevel, SimdTask},
};

/// A ray that is followed through a block.
#[derive(Clone, Copy, Debug)]
pub(super) struct Quest {
    /// Its sample in the tile.
    pub(super) sample: u32,
    pub(super) ray: Ray,
    /// What is nearer than this does not matter; in front of the eye.
    pub(super) from: f64,
    /// What is farther away than this does not matter.
    pub(super) farthest: f64,
}

/// Where a ray meets the surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Meeting {
    /// The sample of the ray.
    pub(super) sample: u32,
    pub(super) depth: f64,
}

/// Finds where rays meet a surface; a thread's own.
pub(super) trait Trace: Send {
    /// Finds the first meeting of each quest with the surface of `tape` in `cells`.
    fn trace(&mut self, scene: &Traced<'_>, quests: &[Quest], meetings: &mut Vec<Meeting>);

    /// Finds the meetings of the rays of a tile with the surface in the cells of a block, if nothing
    /// nearer is known; the last one of each ray is the nearest.
    fn sweep(&mut self, swept: &Swept<'_>, sight: &mut Sight, sightings: &mut Vec<Sighting>);

    /// The gradients of `tape` at some points, which may be zero or not finite.
    fn gradients(&mut self, tape: &Tape, points: &[DVec3]) -> Vec<DVec3>;

    /// The values of `tape` at some points; NaN where it is undefined.
    fn values(&mut self, tape: &Tape, points: &[DVec3]) -> Vec<f64>;

    /// The tape where its choices went as they do in all cells.
    fn shortened(&mut self, scene: &Traced<'_>) -> Tape;

    /// The mean curvature of F = const at each of some points, positive where it bulges towards
    /// larger F; 0 where it has none. Every point comes with the edge of its voxel.
    fn curvatures(&mut self, tape: &Tape, points: &[(DVec3, f64)]) -> Vec<f64>;
}

/// What rays are followed through.
#[derive(Clone, Copy)]
pub(super) struct Traced<'a> {
    pub(super) tape: &'a Tape,
    pub(super) cells: &'a Cells,
    pub(super) eye: DVec3,
}

/// A tracer for the instruction set.
pub(super) fn tracer(simd: SimdLevel) -> Box<dyn Trace> {
    struct New;
    impl SimdTask for New {
        type Output = Box<dyn Trace>;

        fn run<S: Simd>(self, simd: S) -> Box<dyn Trace> {
            Box::new(Tracer::new(simd))
        }
    }
    simd.run(New)
}

/// How often a part of a ray is halved: a cell may be as large as four voxels.
const MAX_HALVINGS: u32 = 12;

pub(super) struct Tracer<S: Simd> {
    pub(super) simd: S,
    values: BoxEvaluator<f64x8<S>, { BATCH / 8 }>,
    slopes: SlopeEvaluator<f64x8<S>, { BATCH / 8 }>,
    pub(super) points: PointEvaluator<S>,
    gradients: GradientEvaluator<S>,
    boxes: Boxes<f64>,
}

/// A quest on its way.
pub(super) struct Lane<'a> {
    quest: Quest,
    /// Through which cells it goes on.
    walk: Option<(Walk, &'a Cells)>,
    parts: Parts,
}

/// Parts of a cell that are still to be looked at, the nearest last, and how often each was halved.
#[derive(Default)]
struct Parts {
    parts: [(Span, u32); MAX_HALVINGS as usize + 2],
    n: usize,
}

impl Parts {
    fn is_empty(&self) -> bool {
        self.n == 0
    }

    /// The nearest; there must be one.
    fn last(&self) -> Span {
        self.parts[self.n - 1].0
    }

    fn push(&mut self, span: Span, halvings: u32) {
        self.parts[self.n] = (span, halvings);
        self.n += 1;
    }

    fn pop(&mut self) -> Option<(Span, u32)> {
        self.n = self.n.checked_sub(1)?;
        Some(self.parts[self.n])
    }
}

/// What became of a part.
pub(super) enum Outcome {
    /// No surface.
    Miss,
    /// Exactly one root, by the values at the ends.
    Root,
    /// To be halved.
    Open,
}

impl<S: Simd> Tracer<S> {
    fn new(simd: S) -> Self {
        Self {
            simd,
            values: BoxEvaluator::new(simd),
            slopes: SlopeEvaluator::new(simd),
            points: PointEvaluator::new(simd),
            gradients: GradientEvaluator::new(simd),
            boxes: Boxes::default(),
        }
    }
}

impl<S: Simd> Trace for Tracer<S> {
    fn trace(&mut self, scene: &Traced<'_>, quests: &[Quest], meetings: &mut Vec<Meeting>) {
        let Traced { tape, cells, eye } = *scene;
        let mut rest = quests.iter();
        let mut next = || rest.find_map(|quest| Lane::of_quest(quest, cells));
        self.follow(tape, eye, &mut next, meetings);
    }

    fn shortened(&mut self, scene: &Traced<'_>) -> Tape {
        let (min, max) = scene.cells.bounds();
        for axis in 0..3 {
            self.boxes.lo[axis][0] = scene.eye[axis] + min[axis];
            self.boxes.hi[axis][0] = scene.eye[axis] + max[axis];
        }
        self.values.eval(scene.tape, &self.boxes, 1, true);
        scene.tape.shortened(self.values.choices(0))
    }

    fn sweep(&mut self, swept: &Swept<'_>, sight: &mut Sight, sightings: &mut Vec<Sighting>) {
        self.sweep_cells(swept, sight, sightings);
    }

    fn gradients(&mut self, tape: &Tape, points: &[DVec3]) -> Vec<DVec3> {
        self.gradients_at(tape, points)
    }

    fn values(&mut self, tape: &Tape, points: &[DVec3]) -> Vec<f64> {
        let mut values = Vec::with_capacity(points.len());
        for some in points.chunks(POINT_BATCH) {
            values.extend_from_slice(&self.points.eval(tape, &batch(some))[..some.len()]);
        }
        values
    }

    /// Second derivatives are differences of gradients.
    fn curvatures(&mut self, tape: &Tape, points: &[(DVec3, f64)]) -> Vec<f64> {
        let steps = [DVec3::X, -DVec3::X, DVec3::Y, -DVec3::Y, DVec3::Z, -DVec3::Z];
        let step_of = |&(p, voxel_size): &(DVec3, f64)| {
            (STEP_VOXELS * voxel_size).max(STEP_COORDINATE * p.abs().max_element())
        };
        let around = points.iter().flat_map(|point| {
            let step = step_of(point);
            steps.map(|axis| point.0 + step * axis)
        });
        let gradients = self.gradients_at(tape, &around.collect::<Vec<DVec3>>());
        let (of_points, _) = gradients.as_chunks::<6>();
        points.iter().zip(of_points).map(|(point, g)| mean_curvature(g, step_of(point))).collect()
    }
}

/// Steps for second derivatives: a part of a voxel, and of coordinates, so that neither the
/// surface bends much nor rounding shows.
const STEP_VOXELS: f64 = 1e-3;
const STEP_COORDINATE: f64 = 1e-6;

/// From the gradients g a step before and behind along each axis: div(g / |g|) / 2.
fn mean_curvature([x1, x0, y1, y0, z1, z0]: &[DVec3; 6], step: f64) -> f64 {
    let g = (*x1 + *x0 + *y1 + *y0 + *z1 + *z0) / 6.0;
    let columns = [*x1 - *x0, *y1 - *y0, *z1 - *z0].map(|difference| difference / (2.0 * step));
    let trace = columns[0].x + columns[1].y + columns[2].z;
    let along = g.dot(g.x * columns[0] + g.y * columns[1] + g.z * columns[2]);
    let square = g.length_squared();
    let curvature = 0.5 * (square * trace - along) / (square * square.sqrt());
    if curvature.is_finite() { curvature } else { 0.0 }
}

impl<'a> Lane<'a> {
    /// The quest at its first cell, if there is one.
    fn of_quest(quest: &Quest, cells: &'a Cells) -> Option<Self> {
        let walk = Walk::new(cells, &quest.ray, quest.from)?;
        let mut lane = Self { quest: *quest, walk: Some((walk, cells)), parts: Parts::default() };
        lane.advance().then_some(lane)
    }

    /// A quest that ends with a part of its ray.
    pub(super) fn of_part(quest: Quest, span: Span) -> Self {
        let mut lane = Self { quest, walk: None, parts: Parts::default() };
        lane.parts.push(span, 0);
        lane
    }

    /// Goes on to the next part, unless one is left; false if there is none.
    fn advance(&mut self) -> bool {
        if self.parts.is_empty()
            && let Some((walk, cells)) = &mut self.walk
            && walk.depth() <= self.quest.farthest
            && let Some(span) = walk.next_cell(cells)
        {
            self.parts.push(span, 0);
        }
        !self.parts.is_empty()
    }

    /// Nothing more is looked for.
    fn finish(&mut self) {
        self.parts.n = 0;
        self.walk = None;
    }
}

impl<S: Simd> Tracer<S> {
    /// Follows lanes until they are done, 64 at a time; `next` begins them.
    pub(super) fn follow<'a>(
        &mut self,
        tape: &Tape,
        eye: DVec3,
        next: &mut dyn FnMut() -> Option<Lane<'a>>,
        meetings: &mut Vec<Meeting>,
    ) {
        let mut lanes: Vec<Lane<'a>> = Vec::new();
        let mut brackets = Vec::new();
        loop {
            let mut i = 0;
            while i < lanes.len() {
                if lanes[i].advance() {
                    i += 1;
                } else if let Some(lane) = next() {
                    lanes[i] = lane;
                    i += 1;
                } else {
                    lanes.swap_remove(i);
                }
            }
            while lanes.len() < BATCH {
                let Some(lane) = next() else { break };
                lanes.push(lane);
            }
            if lanes.is_empty() {
                break;
            }
            self.test(tape, eye, &mut lanes, &mut brackets, meetings);
            self.find_roots(tape, eye, &brackets, &mut |i, depth| {
                let quest = &lanes[i].quest;
                if depth <= quest.farthest {
                    meetings.push(Meeting { sample: quest.sample, depth });
                }
                lanes[i].finish();
            });
            brackets.clear();
        }
    }
}

impl<S: Simd> Tracer<S> {
    /// Tests the nearest part of every lane: takes it off, halves it, or finds a bracket or, where
    /// it was halved often enough, a meeting.
    fn test(
        &mut self,
        tape: &Tape,
        eye: DVec3,
        lanes: &mut [Lane<'_>],
        brackets: &mut Vec<Bracket>,
        meetings: &mut Vec<Meeting>,
    ) {
        self.write_boxes(eye, lanes);
        let found = self.slopes.gradients(tape, &self.boxes, lanes.len());
        let verdict = found.verdict;
        let is_open = |i: usize| (verdict.empty | verdict.negative) >> i & 1 == 0;
        let open: Vec<usize> = (0..lanes.len()).filter(|&i| is_open(i)).collect();
        (0..lanes.len()).filter(|&i| !is_open(i)).for_each(|i| {
            lanes[i].parts.pop();
        });
        for some in open.chunks(POINT_BATCH / 2) {
            let mut ends: Points = [[0.0; POINT_BATCH]; 3];
            for (k, &i) in some.iter().enumerate() {
                let span = lanes[i].parts.last();
                for (end, depth) in [span.from, span.to].into_iter().enumerate() {
                    let p = eye + lanes[i].quest.ray.at(depth);
                    (0..3).for_each(|axis| ends[axis][2 * k + end] = p[axis]);
                }
            }
            let values = self.points.eval(tape, &ends);
            for (k, &i) in some.iter().enumerate() {
                let values = [values[2 * k], values[2 * k + 1]];
                let Some((span, halvings)) = lanes[i].parts.pop() else { continue };
                let quest = lanes[i].quest;
                let is_continuous = verdict.continuous >> i & 1 == 1;
                let slope = self.slope_along(i, quest.ray.direction);
                match outcome(values, slope, span.to - span.from, is_continuous) {
                    Outcome::Miss => {}
                    Outcome::Root => brackets.push(Bracket {
                        id: i,
                        ray: quest.ray,
                        span,
                        values,
                        in_region: verdict.in_region >> i & 1 == 1,
                    }),
                    Outcome::Open if halvings == MAX_HALVINGS => {
                        let depth = 0.5 * (span.from + span.to);
                        if depth <= quest.farthest {
                            meetings.push(Meeting { sample: quest.sample, depth });
                        }
                        lanes[i].finish();
                    }
                    Outcome::Open => {
                        let middle = 0.5 * (span.from + span.to);
                        let far = Span { from: middle, to: span.to };
                        let near = Span { from: span.from, to: middle };
                        lanes[i].parts.push(far, halvings + 1);
                        lanes[i].parts.push(near, halvings + 1);
                    }
                }
            }
        }
    }

    /// Writes the boxes of the nearest parts of all lanes.
    fn write_boxes(&mut self, eye: DVec3, lanes: &[Lane<'_>]) {
        for (i, lane) in lanes.iter().enumerate() {
            let span = lane.parts.last();
            let from = eye + lane.quest.ray.at(span.from);
            let to = eye + lane.quest.ray.at(span.to);
            for axis in 0..3 {
                let (a, b) = (from[axis], to[axis]);
                let (lo, hi) = if a < b { (a, b) } else { (b, a) };
                let rounding = 4.0 * f64::EPSILON * (eye[axis].abs() + lo.abs() + hi.abs());
                self.boxes.lo[axis][i] = lo - rounding;
                self.boxes.hi[axis][i] = hi + rounding;
            }
        }
    }

    /// Bounds of the slope of F along a ray, over the box of lane `i`.
    fn slope_along(&self, i: usize, direction: DVec3) -> [f64; 2] {
        let Boxes { lo, hi } = self.slopes.slopes();
        let (mut least, mut most) = (0.0, 0.0);
        for axis in 0..3 {
            let d = direction[axis];
            let (a, b) = (lo[axis][i] * d, hi[axis][i] * d);
            least += if a < b { a } else { b };
            most += if a < b { b } else { a };
        }
        [least, most]
    }

    /// The gradients of `tape` at some points.
    fn gradients_at(&mut self, tape: &Tape, points: &[DVec3]) -> Vec<DVec3> {
        let mut gradients: Vec<DVec3> = Vec::with_capacity(points.len());
        for some in points.chunks(POINT_BATCH) {
            let [x, y, z] = self.gradients.eval(tape, &batch(some));
            gradients.extend((0..some.len()).map(|k| DVec3::new(x[k], y[k], z[k])));
        }
        gradients
    }
}

/// What the values at both ends of a part tell, with bounds of the slope between them.
pub(super) fn outcome(
    [f, g]: [f64; 2],
    [least, most]: [f64; 2],
    length: f64,
    is_continuous: bool,
) -> Outcome {
    if !(f.is_finite() && g.is_finite() && is_continuous) {
        return Outcome::Open;
    }
    let is_monotone = least >= 0.0 || most <= 0.0;
    match ((f < 0.0) != (g < 0.0), is_monotone) {
        (true, true) => Outcome::Root,
        (false, true) => Outcome::Miss,
        (true, false) => Outcome::Open,
        (false, false) => {
            // From both ends F can come no closer to 0 than where the steepest lines meet.
            let (f, g, down, up) =
                if f < 0.0 { (-f, -g, -most, -least) } else { (f, g, least, most) };
            let closest = (up * f - down * g + up * down * length) / (up - down);
            if closest > 1e-12 * (f + g) { Outcome::Miss } else { Outcome::Open }
        }
    }
}
