//! Meshes with fewer triangles: edges collapse, the one that moves the surface least first.
//!
//! *Invariant:* what is a manifold stays one, with as many pieces, holes and borders as it had. No
//! collapse turns a triangle over, or makes one flat. Borders move along themselves only.
//!
//! *Based on:* M. Garland, P. Heckbert, "Surface Simplification Using Quadric Error Metrics", SIGGRAPH
//! 1997; P. Trettner, L. Kobbelt, "Fast and Robust QEM Minimization using Probabilistic Quadrics",
//! Eurographics 2020 (a little uncertainty makes every least place unique and triangles round).

use std::{cmp::Reverse, collections::BinaryHeap};

use glam::DVec3;
use rayon::prelude::*;

use super::{
    Mesh,
    fans::Fans,
    quadric::Quadric,
    repair::{NONE, Side},
};

/// What distances from the middle of a triangle count beside those from its plane. It decides only
/// where the surface turns by less than its square root, in radians, from vertex to vertex.
const ROUNDNESS: f64 = 1e-4;

/// What distances from a border count beside those from triangles.
const BORDER_WEIGHT: f64 = 10.0;

/// The cosine of the angle by which a triangle may turn at once.
const MOST_TURN: f64 = 0.25;

/// Twice the area of a triangle over the square of its longest side: what is thinner must not become
/// thinner still.
const THINNEST: f64 = 0.01;

/// Each round collapses edges of this share, the cheapest: those that were refused get another chance
/// before dear ones are taken instead.
const SHARE: f64 = 0.25;

/// A round that takes less than one in this many triangles away is the last one.
const WORTHWHILE: usize = 1000;

impl Mesh {
    /// Collapses edges until there are at most `n_wanted` triangles, or nothing is left that may
    /// collapse. Does nothing to a mesh that is no oriented manifold. Normals of length 1 are
    /// needed; those of vertices that move are interpolated.
    pub fn decimate(&mut self, n_wanted: usize) {
        if self.triangles.len() <= n_wanted
            || !self.positions.as_flattened().iter().all(|c| c.is_finite())
        {
            return;
        }
        let Some(fans) = Fans::new(self) else { return };
        let mut decimation = Decimation::new(self, fans);
        let mut share = SHARE;
        while decimation.fans.n_triangles() > n_wanted {
            let n_before = decimation.fans.n_triangles();
            decimation.round(n_wanted, share);
            let is_worthwhile = (n_before - decimation.fans.n_triangles()) * WORTHWHILE >= n_before;
            match is_worthwhile {
                true => share = SHARE,
                false if share < 1.0 => share = 1.0,
                false => break,
            }
        }
        let left = decimation.fans.triangles.into_iter().filter(|corners| corners[0] != NONE);
        self.triangles = left.collect();
        self.drop_unused();
    }
}

struct Decimation<'a> {
    mesh: &'a mut Mesh,
    fans: Fans,
    /// The place from which quadrics count, so that those of small triangles are exact enough.
    origin: DVec3,
    /// At each vertex, the planes of all triangles that came together there.
    quadrics: Vec<Quadric>,
    /// What distances from a border count, for each length of it.
    border_weight: f64,
    /// How often each vertex has changed.
    versions: Vec<u32>,
}

/// The upper half of the bits of a number that is not negative: they have its order.
type Cost = u32;

/// An edge that waits; the order is that of costs, which are never negative, and then of vertices.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Waiting {
    cost: Cost,
    edge: [u32; 2],
    /// The versions of its ends, added.
    version: u32,
}

/// What becomes of an edge.
struct Target {
    /// Of the precision of files, from the origin.
    place: DVec3,
    position: [f32; 3],
    cost: f64,
}

impl<'a> Decimation<'a> {
    fn new(mesh: &'a mut Mesh, fans: Fans) -> Self {
        let n = mesh.positions.len();
        let mut low = DVec3::INFINITY;
        let mut high = DVec3::NEG_INFINITY;
        for &p in &mesh.positions {
            let p = DVec3::from_array(p.map(f64::from));
            (low, high) = (low.min(p), high.max(p));
        }
        let origin = 0.5 * (low + high);
        let quadrics = vec![Quadric::default(); n];
        let border_weight = 0.0;
        let mut new = Self { mesh, fans, origin, quadrics, border_weight, versions: vec![0; n] };
        new.border_weight = BORDER_WEIGHT * new.mean_length();
        for t in 0..new.fans.triangles.len() {
            new.add_quadrics(t);
        }
        new
    }

    /// The mean length of edges.
    fn mean_length(&self) -> f64 {
        let length = |side| self.at(self.fans.from(side)).distance(self.at(self.fans.to(side)));
        self.fans.edges().map(length).sum::<f64>() / self.fans.edges().count().max(1) as f64
    }

    /// From the origin.
    fn at(&self, v: u32) -> DVec3 {
        DVec3::from_array(self.mesh.positions[v as usize].map(f64::from)) - self.origin
    }

    fn normal(&self, v: u32) -> DVec3 {
        DVec3::from_array(self.mesh.normals[v as usize].map(f64::from))
    }

    /// Adds the plane of a triangle to its corners, and those across it at the border.
    fn add_quadrics(&mut self, t: usize) {
        let corners = self.fans.triangles[t];
        let [a, b, c] = corners.map(|v| self.at(v));
        let across = (b - a).cross(c - a);
        let Some(n) = across.try_normalize() else { return };
        let area = 0.5 * across.length();
        let middle = (a + b + c) / 3.0;
        let plane = Quadric::plane(middle, n, area) + Quadric::point(middle, ROUNDNESS * area);
        for v in corners {
            let of_v = &mut self.quadrics[v as usize];
            *of_v = *of_v + plane;
        }
        for (i, (from, to)) in [(a, b), (b, c), (c, a)].into_iter().enumerate() {
            if self.fans.is_open((3 * t + i) as Side)
                && let Some(outwards) = (to - from).cross(n).try_normalize()
            {
                let weight = self.border_weight * (to - from).length();
                let border = Quadric::plane(from, outwards, weight);
                for v in [corners[i], corners[(i + 1) % 3]] {
                    let of_v = &mut self.quadrics[v as usize];
                    *of_v = *of_v + border;
                }
            }
        }
    }

    /// Collapses edges of the cheapest `share` until few enough triangles are left or no edge waits.
    fn round(&mut self, n_wanted: usize, share: f64) {
        let edges: Vec<Side> = self.fans.edges().collect();
        let waiting =
            edges.par_iter().map(|&side| self.waiting(self.fans.from(side), self.fans.to(side)));
        let mut waiting: Vec<Waiting> = waiting.collect();
        let n = ((waiting.len() as f64 * share) as usize).min(waiting.len() - 1);
        let most = waiting.select_nth_unstable(n).1.cost;
        waiting.truncate(n + 1);
        let mut queue: BinaryHeap<Reverse<Waiting>> = waiting.into_iter().map(Reverse).collect();
        while self.fans.n_triangles() > n_wanted
            && let Some(Reverse(Waiting { edge: [u, v], version, .. })) = queue.pop()
        {
            let is_old = self.fans.is_gone(u)
                || self.fans.is_gone(v)
                || version != self.versions[u as usize].wrapping_add(self.versions[v as usize]);
            if is_old {
                continue;
            }
            let Some(side) = self.fans.side_between(u, v) else { continue };
            let target = self.target(u, v);
            if self.fans.may_collapse(side) && self.keeps_shape(u, v, target.place) {
                let kept = self.collapse(side, &target);
                let of_kept = self.fans.neighbors(kept).map(|w| self.waiting(kept, w));
                queue.extend(of_kept.filter(|waiting| waiting.cost <= most).map(Reverse));
            }
        }
    }

    fn waiting(&self, u: u32, v: u32) -> Waiting {
        Waiting {
            cost: (self.target(u, v).cost.to_bits() >> 32) as u32,
            edge: [u.min(v), u.max(v)],
            version: self.versions[u as usize].wrapping_add(self.versions[v as usize]),
        }
    }

    /// Where the ends of an edge meet best: at the border if one is there, between them if both are.
    fn target(&self, u: u32, v: u32) -> Target {
        let (u, v) = (u.min(v), u.max(v));
        let quadric = self.quadrics[u as usize] + self.quadrics[v as usize];
        let (at_u, at_v) = (self.at(u), self.at(v));
        let best = match [u, v].map(|v| self.fans.is_border(v)) {
            [true, false] => at_u,
            [false, true] => at_v,
            [true, true] => {
                at_u + quadric.least_between(at_u, at_v).clamp(0.0, 1.0) * (at_v - at_u)
            }
            [false, false] => quadric.least(),
        };
        let best = if best.is_finite() { best } else { 0.5 * (at_u + at_v) };
        let position = (best + self.origin).as_vec3().to_array();
        let place = DVec3::from_array(position.map(f64::from)) - self.origin;
        let cost = quadric.at(place);
        Target { place, position, cost }
    }

    /// Whether the triangles at both ends of an edge stay what they are if these move to `place`.
    fn keeps_shape(&self, u: u32, v: u32, place: DVec3) -> bool {
        [(u, v), (v, u)].into_iter().all(|(moved, other)| {
            self.fans.sides(moved).all(|side| {
                let corners = self.fans.triangles[side as usize / 3];
                corners.contains(&other) || self.keeps_triangle(corners, moved, place)
            })
        })
    }

    fn keeps_triangle(&self, corners: [u32; 3], moved: u32, place: DVec3) -> bool {
        let before = corners.map(|v| self.at(v));
        let after = corners.map(|v| if v == moved { place } else { self.at(v) });
        let across = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a);
        let (old, new) = (across(before), across(after));
        let up = corners.map(|v| self.normal(v)).into_iter().sum::<DVec3>();
        let is_turned = old.dot(new) <= MOST_TURN * old.length() * new.length()
            || (new.dot(up) <= 0.0 && old.dot(up) > 0.0);
        let thickness = |[a, b, c]: [DVec3; 3], across: DVec3| {
            let longest =
                a.distance_squared(b).max(b.distance_squared(c)).max(c.distance_squared(a));
            across.length() / longest
        };
        let thin = thickness(after, new);
        // What was flat has no direction that it could keep.
        new != DVec3::ZERO
            && (!is_turned || old == DVec3::ZERO)
            && (thin >= THINNEST || thin >= thickness(before, old))
    }

    /// The vertex that is left.
    fn collapse(&mut self, side: Side, target: &Target) -> u32 {
        let (kept, gone) = (self.fans.from(side), self.fans.to(side));
        let (from, to) = (self.at(kept), self.at(gone));
        let along = to - from;
        let part = (target.place - from).dot(along) / along.length_squared();
        let part = if part.is_finite() { part.clamp(0.0, 1.0) } else { 0.5 };
        let (a, b) = (self.normal(kept), self.normal(gone));
        let normal = (a + part * (b - a)).normalize_or(a);
        let i = kept as usize;
        self.mesh.positions[i] = target.position;
        self.mesh.normals[i] = normal.as_vec3().to_array();
        self.quadrics[i] = self.quadrics[i] + self.quadrics[gone as usize];
        self.versions[i] = self.versions[i].wrapping_add(1);
        self.fans.collapse(side);
        kept
    }
}
