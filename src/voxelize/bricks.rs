//! The last levels of a search that certifies: bricks of 4³ voxels.
//!
//! - *Bounds.* One gradient and one value for a brick decide most of its voxels; see `affine`.
//! - *Trends.* Where F is monotone along all three axes of a brick, its range over a voxel is that
//!   between two opposite corners, and what their signs say of the voxel is exact.
//! - *Corners, slopes, points.* Without a trend a voxel is looked at by itself: by the value over
//!   it, by the signs at its corners, by its own gradient.
//!
//! What is left open is looked at more closely; see `closer`.

use fearless_simd::Simd;

use super::{
    affine::VoxelVerdict,
    brick::{BRICK_EDGE, BRICK_VOXELS, Brick, octant, of_octant, offset, places},
    closer_points::{KnownSlopes, look_at_points},
    node::Trend,
    search::{Run, Search},
    signs::{Signs, steps_to, steps_to_children},
};
use crate::{
    eval::{BATCH, SlopeVerdict},
    expr::Tape,
    math::Lanes,
};

/// From the place of a brick's first corner to that of the first corner of each voxel.
const STEPS: [u32; BRICK_VOXELS] = {
    let mut steps = [0; BRICK_VOXELS];
    let mut m = 0;
    while m < BRICK_VOXELS {
        steps[m] = steps_to(offset(m as u32));
        m += 1;
    }
    steps
};

const BRICK_SIDE: usize = BRICK_EDGE as usize;

/// Octants with fewer open voxels than this are not bounded by a gradient of their own.
const WORTH_BOUNDS: u32 = 2;

/// Voxel `m` of the brick number `brick`.
#[derive(Clone, Copy)]
pub(super) struct OpenVoxel {
    pub(super) brick: usize,
    pub(super) m: u32,
}

impl<S: Simd, L: Lanes<Token = S>, const G: usize> Search<S, L, G> {
    /// Finds the voxels of the bricks of a run.
    pub(super) fn search_bricks(&mut self, run: &Run) {
        let tape = &*run.tape;
        let mut bricks = self.bricks_of(run);
        self.bound(tape, &mut bricks);
        self.test_octants(tape, &mut bricks);
        self.bound_octants(tape, &mut bricks);
        self.follow_trends(tape, &mut bricks);
        let (mut with_trend, mut without) = (Vec::new(), Vec::new());
        for (i, brick) in bricks.iter().enumerate() {
            let voxel = |m: u32| OpenVoxel { brick: i, m };
            let known = brick.with_trend();
            with_trend.extend(places(brick.open() & known).map(voxel));
            without.extend(places(brick.open() & !known).map(voxel));
        }
        self.test_voxels(tape, &mut bricks, &mut without);
        self.certify_at_corners(tape, &mut bricks, &mut without);
        self.test_slopes_of_voxels(tape, &mut bricks, &mut with_trend, &mut without);
        self.look_closer(tape, &mut bricks, &with_trend, &without);
        self.keep(tape, &bricks);
    }

    /// The bricks of a run, of which nothing is known yet.
    pub(super) fn bricks_of(&self, run: &Run) -> Vec<Brick> {
        let n_voxels = self.lattice.n_voxels();
        let firsts = run.places().map(|ijk| ijk.map(|i| i * BRICK_EDGE));
        firsts.map(|first| Brick::new(first, n_voxels)).collect()
    }

    /// What the gradient over each brick tells of it, and its value in the middle.
    pub(super) fn bound(&mut self, tape: &Tape, bricks: &mut [Brick]) {
        for batch in bricks.chunks_mut(BATCH) {
            if !self.records[0].pays() {
                return;
            }
            let firsts = batch.iter().map(|brick| brick.first);
            let (found, voxels) = self.bound_cubes::<BRICK_SIDE>(tape, firsts);
            for (lane, brick) in batch.iter_mut().enumerate() {
                let is = |lanes: u64| lanes >> lane & 1 == 1;
                if is(found.verdict.empty) {
                    brick.mixed = 0;
                } else if is(found.verdict.continuous & found.verdict.in_region) {
                    brick.regular = brick.present;
                    brick.trends = [Trend::new(found.rising.map(is), found.falling.map(is)); 8];
                    if brick.is_whole() {
                        brick.tell(&voxels[lane]);
                    }
                }
                self.records[0].note(brick.has_trend(0) || brick.open() != brick.present);
            }
        }
    }

    /// Tests the octants of bricks of which the bounds told nothing by the values of F over them:
    /// that may tell more than their gradients, and costs less.
    pub(super) fn test_octants(&mut self, tape: &Tape, bricks: &mut [Brick]) {
        let mut untold: Vec<(usize, u32)> = Vec::new();
        for (i, brick) in bricks.iter().enumerate() {
            if brick.mixed == brick.present && brick.certified == 0 && !brick.has_trend(0) {
                untold.extend((0..8).map(|c| (i, c)));
            }
        }
        for batch in untold.chunks(BATCH) {
            for (lane, &(i, c)) in batch.iter().enumerate() {
                self.corners.write_box(&mut self.boxes, lane, bricks[i].voxel(8 * c), 2);
            }
            let verdict = self.values.eval(tape, &self.boxes, batch.len(), false);
            let inside = verdict.inside();
            let regular = verdict.continuous & verdict.in_region;
            for (lane, &(i, c)) in batch.iter().enumerate() {
                let brick = &mut bricks[i];
                let present = of_octant(octant(brick.present, c).into(), c);
                brick.regular |= present * (regular >> lane & 1);
                if verdict.empty >> lane & 1 == 1 {
                    brick.mixed &= !present;
                } else if inside >> lane & 1 == 1 {
                    brick.mixed &= !present;
                    brick.inside |= present;
                }
            }
        }
    }

    /// What gradients tell of octants without a trend that have several voxels left.
    fn bound_octants(&mut self, tape: &Tape, bricks: &mut [Brick]) {
        let mut open: Vec<(usize, u32)> = Vec::new();
        for (i, brick) in bricks.iter().enumerate() {
            let is_worth = |&c: &u32| {
                octant(brick.open(), c).count_ones() >= WORTH_BOUNDS && !brick.has_trend(c)
            };
            open.extend((0..8).filter(is_worth).map(|c| (i, c)));
        }
        for batch in open.chunks(BATCH) {
            if !self.records[1].pays() {
                return;
            }
            let firsts = batch.iter().map(|&(i, c)| bricks[i].voxel(8 * c));
            let (found, voxels) = self.bound_cubes::<2>(tape, firsts);
            for (lane, &(i, c)) in batch.iter().enumerate() {
                let is = |lanes: u64| lanes >> lane & 1 == 1;
                let brick = &mut bricks[i];
                let present = octant(brick.present, c);
                let open_before = octant(brick.open(), c);
                if is(found.verdict.empty) {
                    brick.mixed &= !of_octant(present.into(), c);
                } else if is(found.verdict.continuous & found.verdict.in_region) {
                    brick.regular |= of_octant(present.into(), c);
                    brick.trends[c as usize] =
                        Trend::new(found.rising.map(is), found.falling.map(is));
                    if present == u8::MAX {
                        brick.tell(&voxels[lane].of_octant(c));
                    }
                }
                let told = brick.has_trend(c) || octant(brick.open(), c) != open_before;
                self.records[1].note(told);
            }
        }
    }

    /// What gradients tell of up to 64 cubes of EDGE³ voxels, and of their voxels; the latter
    /// means nothing unless the cube lies in the lattice whole and F is continuous in it.
    fn bound_cubes<const EDGE: usize>(
        &mut self,
        tape: &Tape,
        firsts: impl ExactSizeIterator<Item = [u32; 3]>,
    ) -> (SlopeVerdict, [VoxelVerdict; BATCH]) {
        let n = firsts.len();
        for (lane, first) in firsts.enumerate() {
            self.corners.write_box(&mut self.boxes, lane, first, EDGE as u32);
            let middle = first.map(|i| i + EDGE as u32 / 2);
            self.corners.write_box(&mut self.inner_boxes, lane, middle, 0);
        }
        self.effort.gradients += n as u64;
        self.effort.corners += n as u64;
        let found = self.slopes.gradients(tape, &self.boxes, n);
        let middles = self.values.ranges(tape, &self.inner_boxes, n);
        (found, self.affine.tell::<EDGE>(&middles, self.slopes.slopes(), n))
    }

    /// Decides the voxels of octants with a trend by the signs at two of their corners, which tell
    /// everything.
    fn follow_trends(&mut self, tape: &Tape, bricks: &mut [Brick]) {
        for brick in &*bricks {
            let first = self.signs.place(brick.first);
            for m in places(brick.open() & brick.with_trend()) {
                let [least, most] = ends(brick, m);
                self.signs.ask_if(brick.negative >> m & 1 == 0, first + least);
                self.signs.ask_if(brick.positive >> m & 1 == 0, first + most);
            }
        }
        self.tell_signs(tape);
        for brick in bricks {
            let first = self.signs.place(brick.first);
            for m in places(brick.open() & brick.with_trend()) {
                let [least, most] = self.signs.get(first, &ends(brick, m));
                // Without a branch: what comes out is as good as random.
                let is_negative = (brick.negative >> m & 1 == 1) | least.have(Signs::NEGATIVE);
                let is_positive = (brick.positive >> m & 1 == 1) | most.have(Signs::POSITIVE);
                let is_empty = !is_negative & least.have(Signs::POSITIVE);
                let is_inside = !is_positive & most.have(Signs::NEGATIVE);
                brick.certified |= u64::from(is_negative & is_positive) << m;
                brick.mixed &= !(u64::from(is_empty | is_inside) << m);
                brick.inside |= u64::from(is_inside) << m;
            }
        }
    }

    /// Tests voxels by the values of F over them.
    pub(super) fn test_voxels(
        &mut self,
        tape: &Tape,
        bricks: &mut [Brick],
        open: &mut Vec<OpenVoxel>,
    ) {
        for batch in open.chunks(BATCH) {
            for (lane, voxel) in batch.iter().enumerate() {
                let place = bricks[voxel.brick].voxel(voxel.m);
                self.corners.write_box(&mut self.boxes, lane, place, 1);
            }
            let verdict = self.values.eval(tape, &self.boxes, batch.len(), false);
            // A voxel is not divided: it counts as inside for the part in which F is defined.
            let (empty, inside) = (verdict.empty, verdict.inside_where_defined());
            let regular = verdict.continuous & verdict.in_region;
            let ends = !verdict.defined & !empty & (u64::MAX >> (BATCH - batch.len()));
            self.open.iter_mut().for_each(|found| found.meets_end |= ends != 0);
            for (lane, &OpenVoxel { brick, m }) in batch.iter().enumerate() {
                let bit = |lanes: u64| (lanes >> lane & 1) << m;
                let brick = &mut bricks[brick];
                brick.mixed &= !(bit(empty) | bit(inside));
                brick.inside |= bit(inside);
                brick.regular |= bit(regular);
            }
        }
        retain_open(open, bricks);
    }

    /// Certifies voxels in which F is continuous and which have corners of both signs.
    fn certify_at_corners(&mut self, tape: &Tape, bricks: &mut [Brick], open: &mut Vec<OpenVoxel>) {
        let corners = steps_to_children(1);
        let is_regular = |brick: &Brick, m: u32| brick.regular >> m & 1 == 1;
        for &OpenVoxel { brick, m } in &*open {
            let brick = &bricks[brick];
            if is_regular(brick, m) {
                self.signs.ask(self.signs.place(brick.first) + STEPS[m as usize], &corners);
            }
        }
        self.tell_signs(tape);
        for &OpenVoxel { brick, m } in &*open {
            let brick = &mut bricks[brick];
            if is_regular(brick, m) && self.signs_of(brick, m).have(Signs::BOTH) {
                brick.certified |= 1 << m;
            }
        }
        retain_open(open, bricks);
    }

    /// What is known of the corners of a voxel.
    fn signs_of(&self, brick: &Brick, m: u32) -> Signs {
        let first = self.signs.place(brick.first) + STEPS[m as usize];
        let corners = self.signs.get(first, &steps_to_children(1));
        corners.into_iter().fold(Signs::default(), Signs::and)
    }

    fn tell_signs(&mut self, tape: &Tape) {
        self.effort.corners += self.signs.tell(&mut self.values, tape, &mut self.boxes);
    }

    /// Tests voxels by the gradient over them, and by values at points. Those with a trend that
    /// stay open are moved to `with_trend`.
    fn test_slopes_of_voxels(
        &mut self,
        tape: &Tape,
        bricks: &mut [Brick],
        with_trend: &mut Vec<OpenVoxel>,
        without: &mut Vec<OpenVoxel>,
    ) {
        let mut regular = std::mem::take(without);
        regular.retain(|&voxel| {
            let is_regular = bricks[voxel.brick].regular >> voxel.m & 1 == 1;
            if !is_regular {
                without.push(voxel);
            }
            is_regular
        });
        self.effort.gradients += regular.len() as u64;
        let (mut left, mut known) = (Vec::new(), Vec::new());
        for batch in regular.chunks(BATCH) {
            for (lane, voxel) in batch.iter().enumerate() {
                let boxes = [&mut self.boxes, &mut self.inner_boxes];
                let place = bricks[voxel.brick].voxel(voxel.m);
                self.corners.write_node(boxes, lane, place, 1);
            }
            let (outer, inner) = (&self.boxes, &self.inner_boxes);
            let found = self.slopes.eval(&mut self.values, tape, outer, inner, batch.len());
            for (lane, &voxel) in batch.iter().enumerate() {
                let is = |lanes: u64| lanes >> lane & 1 == 1;
                let brick = &mut bricks[voxel.brick];
                let bit = 1 << voxel.m;
                if is(found.verdict.empty) {
                    brick.mixed &= !bit;
                } else if is(found.verdict.negative) {
                    brick.mixed &= !bit;
                    brick.inside |= bit;
                } else if is(found.crossed) {
                    brick.certified |= bit;
                } else {
                    let (rising, falling) = (found.rising.map(is), found.falling.map(is));
                    if Trend::new(rising, falling).is_known() {
                        with_trend.push(voxel);
                    } else {
                        let steepest = self.slopes.steepest(lane);
                        let slopes = KnownSlopes { rising, falling, steepest };
                        known.push((brick.voxel(voxel.m), slopes, self.signs_of(brick, voxel.m)));
                        left.push(voxel);
                    }
                }
            }
        }
        let findings = look_at_points(&mut self.values, &self.lattice, tape, &known);
        for (voxel, finding) in left.iter().zip(findings) {
            bricks[voxel.brick].conclude(voxel.m, finding);
        }
        retain_open(&mut left, bricks);
        without.append(&mut left);
    }

    /// Looks closer at voxels that are neither certified nor dropped.
    fn look_closer(
        &mut self,
        tape: &Tape,
        bricks: &mut [Brick],
        with_trend: &[OpenVoxel],
        without: &[OpenVoxel],
    ) {
        self.effort.closer_looks += (with_trend.len() + without.len()) as u64;
        let n_gradients = &mut self.effort.gradients;
        let places = |open: &[OpenVoxel]| -> Vec<[u32; 3]> {
            open.iter().map(|&OpenVoxel { brick, m }| bricks[brick].voxel(m)).collect()
        };
        let found = self.exact.look_at_whole(tape, &places(with_trend), n_gradients);
        let found_in_parts = self.closer.look_at_parts(tape, &places(without), n_gradients);
        let open = with_trend.iter().chain(without);
        for (voxel, finding) in open.zip(found.into_iter().chain(found_in_parts)) {
            bricks[voxel.brick].conclude(voxel.m, finding);
        }
    }

    /// Keeps the voxels that are left.
    fn keep(&mut self, tape: &Tape, bricks: &[Brick]) {
        let last = self.depth as usize - 1;
        let [octants, voxels] = &mut self.masks[last - 1..] else {
            unreachable!("an octree has at least the levels of a brick")
        };
        let mut n_voxels = self.normal_finder.len() as u32;
        for brick in bricks {
            let divided = brick.push_masks([octants, voxels]);
            self.effort.boxes[last] += u64::from((divided & brick.present).count_ones());
            let n_octants = (0..8).filter(|&c| octant(brick.present, c) != 0).count();
            self.effort.boxes[last - 1] += n_octants as u64;
            let of_brick = |m: u32| n_voxels + (brick.mixed & ((1 << m) - 1)).count_ones();
            self.candidates.extend(places(brick.open()).map(of_brick));
            n_voxels += brick.mixed.count_ones();
        }
        let kept = bricks.iter().flat_map(|brick| places(brick.mixed).map(|m| brick.voxel(m)));
        self.normal_finder.find(tape, kept);
    }
}

/// From the place of a brick's first corner to those of voxel `m` where F is least and where it is
/// largest.
#[inline(always)]
fn ends(brick: &Brick, m: u32) -> [u32; 2] {
    let trend = brick.trends[m as usize / 8];
    [trend.to_least(1), trend.to_most(1)].map(|corner| STEPS[m as usize] + steps_to(corner))
}

/// Keeps the voxels that are not decided.
fn retain_open(open: &mut Vec<OpenVoxel>, bricks: &[Brick]) {
    open.retain(|voxel| bricks[voxel.brick].open() >> voxel.m & 1 == 1);
}
