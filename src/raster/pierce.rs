//! Where a ray first meets the surface in the cells of a chunk.
//!
//! *Based on:* J. Amanatides, A. Woo, "A Fast Voxel Traversal Algorithm for Ray Tracing", Eurographics
//! 1987 (from cell to cell); S. Parker, P. Shirley, Y. Livnat, C. Hansen, P.-P. Sloan, "Interactive Ray
//! Tracing for Isosurface Rendering", IEEE Visualization 1998 (values between eight corners are a cubic
//! along a ray).

use glam::DVec3;

use super::{
    cubic::{Cubic, first_root, from_powers},
    field::{Block, CHUNK, Chunk, Field},
    screen::Ray,
};

/// A cell is looked at as much longer than it is, as a part of it: where two of them meet, rounding must
/// not hide a root from both.
const OVERLAP: f64 = 1e-9;

/// A chunk's cells with their values.
pub(super) struct Pierced<'a> {
    chunk: &'a Chunk,
    block: Block,
    /// The box around the cells that show a surface, and whether a face of it closes the solid; cells are
    /// unit cubes from 0 on.
    bounds: [DVec3; 2],
    is_closed: [[bool; 3]; 2],
}

/// Where a ray meets a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pierce {
    /// How far along the ray.
    pub(super) depth: f64,
    /// The axis across the face of the box that it meets, and whether that is the upper one; `None` on
    /// the surface itself.
    pub(super) face: Option<(usize, bool)>,
}

impl<'a> Pierced<'a> {
    pub(super) fn new(field: &dyn Field, chunk: &'a Chunk) -> Self {
        let size = DVec3::from_array(field.size().map(f64::from));
        let [low, high] = chunk.bounds(field.size());
        let is_closed = [
            [0, 1, 2].map(|axis| field.is_capped() && low[axis] == 0.0),
            [0, 1, 2].map(|axis| field.is_capped() && high[axis] == size[axis]),
        ];
        let first = DVec3::from_array(chunk.place.map(|i| f64::from(i * CHUNK as u32)));
        let bounds = [low, high].map(|corner| corner - first + 0.5);
        Self { chunk, block: Block::read(field, chunk.place), bounds, is_closed }
    }

    /// The first place where a ray, in the chunk's own coordinates, meets the surface between two depths.
    pub(super) fn first(&self, ray: &Ray, depths: [f64; 2]) -> Option<Pierce> {
        let span = self.span(ray, depths)?;
        if let Some(face) = span.entry
            && self.is_inside(ray.at(span.from))
        {
            return Some(Pierce { depth: span.from, face: Some(face) });
        }
        if let Some(depth) = self.walk(ray, &span) {
            return Some(Pierce { depth, face: None });
        }
        let face = span.exit?;
        self.is_inside(ray.at(span.to)).then_some(Pierce { depth: span.to, face: Some(face) })
    }

    /// The part of a ray in the chunk.
    fn span(&self, ray: &Ray, [from, to]: [f64; 2]) -> Option<Span> {
        let (mut span, mut faces) = (Span { from, to, entry: None, exit: None }, [None; 2]);
        for axis in 0..3 {
            let (o, d) = (ray.origin[axis], ray.direction[axis]);
            let [low, high] = self.bounds.map(|bound| bound[axis]);
            if d == 0.0 {
                if o < low || o > high {
                    return None;
                }
                continue;
            }
            let inverse = 1.0 / d;
            let [a, b] = [(low - o) * inverse, (high - o) * inverse];
            let is_up = d > 0.0;
            let (enter, leave) = if is_up { (a, b) } else { (b, a) };
            if enter > span.from {
                (span.from, faces[0]) = (enter, Some((axis, !is_up)));
            }
            if leave < span.to {
                (span.to, faces[1]) = (leave, Some((axis, is_up)));
            }
        }
        let is_closed =
            |&(axis, is_upper): &(usize, bool)| self.is_closed[usize::from(is_upper)][axis];
        [span.entry, span.exit] = faces.map(|face| face.filter(is_closed));
        (span.from <= span.to).then_some(span)
    }

    /// How far along a ray the first root is, from cell to cell.
    fn walk(&self, ray: &Ray, span: &Span) -> Option<f64> {
        let start = ray.at(span.from);
        let inverse = ray.direction.recip();
        let mut cell = start.to_array().map(|i| (i as usize).min(CHUNK - 1));
        let mut from = span.from;
        loop {
            // The next faces along each axis.
            let next = |axis: usize| {
                let ahead = cell[axis] + usize::from(ray.direction[axis] > 0.0);
                match ray.direction[axis] == 0.0 {
                    true => f64::INFINITY,
                    false => (ahead as f64 - ray.origin[axis]) * inverse[axis],
                }
            };
            let faces = [next(0), next(1), next(2)];
            let axis = match faces {
                [x, y, z] if x <= y && x <= z => 0,
                [_, y, z] if y <= z => 1,
                _ => 2,
            };
            let to = faces[axis].clamp(from, span.to);
            if self.chunk.shown[cell[2]] >> (cell[0] + CHUNK * cell[1]) & 1 == 1
                && let Some(root) = self.root(ray, cell, from, to)
            {
                return Some(root);
            }
            from = to;
            if to >= span.to {
                return None;
            }
            let is_up = ray.direction[axis] > 0.0;
            match cell[axis] {
                0 if !is_up => return None,
                i if is_up && i + 1 == CHUNK => return None,
                _ if is_up => cell[axis] += 1,
                _ => cell[axis] -= 1,
            }
        }
    }

    /// The first root in a cell, between two depths.
    fn root(&self, ray: &Ray, cell: [usize; 3], from: f64, to: f64) -> Option<f64> {
        let overlap = OVERLAP / ray.direction.abs().max_element();
        let (from, to) = (from - overlap, to + overlap);
        let first = DVec3::from_array(cell.map(|i| i as f64));
        let (start, end) = (ray.at(from) - first, ray.at(to) - first);
        let cubic = along(&self.block.corners(cell), start, end - start);
        first_root(&cubic).map(|s| from + s * (to - from))
    }

    fn is_inside(&self, p: DVec3) -> bool {
        let cell = p.to_array().map(|i| (i as usize).min(CHUNK - 1));
        let start = p - DVec3::from_array(cell.map(|i| i as f64));
        along(&self.block.corners(cell), start, DVec3::ZERO)[0] >= 0.0
    }
}

/// The part of a ray in a chunk, and the closed faces of the grid's box at its ends.
struct Span {
    from: f64,
    to: f64,
    entry: Option<(usize, bool)>,
    exit: Option<(usize, bool)>,
}

/// The values along a line through a unit cube, from those at its corners, x + 2y + 4z.
#[inline]
fn along(corners: &[f64; 8], start: DVec3, way: DVec3) -> Cubic {
    let [a, b, c, d, e, f, g, h] = *corners;
    let ([x, y, z], [u, v, w]) = (start.to_array(), way.to_array());
    // Of 1, x, y, z, xy, xz, yz and xyz.
    let [kx, ky, kz] = [b - a, c - a, e - a];
    let [kxy, kxz, kyz] = [d - b - ky, f - b - kz, g - c - kz];
    let kxyz = (h - g - f + e) - kxy;
    // Products of two and of three coordinates, by powers of the way.
    let [xy, xz, yz] = [x * y, x * z, y * z];
    let [xv, xw, yw] = [x * v + y * u, x * w + z * u, y * w + z * v];
    let [uv, uw, vw] = [u * v, u * w, v * w];
    from_powers([
        a + kx * x + ky * y + kz * z + kxy * xy + kxz * xz + kyz * yz + kxyz * (xy * z),
        kx * u + ky * v + kz * w + kxy * xv + kxz * xw + kyz * yw + kxyz * (xv * z + xy * w),
        kxy * uv + kxz * uw + kyz * vw + kxyz * (uv * z + xv * w),
        kxyz * (uv * w),
    ])
}
