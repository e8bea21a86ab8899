//! What to tell about a surface that is not where it was looked for, with numbers and a way out.

use std::borrow::Borrow;

use glam::DVec3;

use crate::{
    expr::Expr,
    math::{Aabb, Lattice, SimdLevel},
    octree::{MortonOctree, Storage as _},
    voxelize::{Extent, FieldRange, Outline, find_extent, sample_field},
};

/// Where surfaces are looked for if neither the scene nor their extent says.
pub const FALLBACK_DOMAIN: Aabb = Aabb { min: DVec3::splat(-5.0), max: DVec3::splat(5.0) };

/// A surface that fills less than this part of the domain's longest edge deserves a smaller one.
const SMALL_PART: f64 = 0.1;

/// A surface that may meet more than this part of all voxels was hardly told from space itself.
const LARGE_PART: f64 = 0.5;

/// How much larger than the surface its extent may be, as a part of the extent's longest edge: it
/// is found with coarse voxels and rounded.
const EXTENT_SLACK: f64 = 0.05;

/// The box that holds all of `surfaces`, for a scene that gives none, and a note that says which.
#[must_use]
pub fn choose_domain(
    surfaces: impl Iterator<Item = (impl AsRef<str>, impl Borrow<Expr>)>,
    simd: SimdLevel,
) -> (Aabb, String) {
    let mut whole = Extent::Nothing;
    let mut unbounded = Vec::new();
    for (name, expr) in surfaces {
        let extent = find_extent(expr.borrow(), simd);
        let name = format!("`{}`", name.as_ref());
        if extent == Extent::Unbounded && !unbounded.contains(&name) {
            unbounded.push(name);
        }
        whole = whole.union(extent);
    }
    match whole {
        Extent::Within(bounds) => {
            (bounds, format!("all of it lies in {}, which is searched", toml(bounds)))
        }
        Extent::Nothing => (FALLBACK_DOMAIN, format!("{} is searched", toml(FALLBACK_DOMAIN))),
        Extent::Unbounded => {
            let names = unbounded.join(" and ");
            let note = format!(
                "no bound was found for {names} within 2^20 of the origin; {} is searched: give \
                 another `min` and `max` in [domain], or a `clip`",
                toml(FALLBACK_DOMAIN)
            );
            (FALLBACK_DOMAIN, note)
        }
    }
}

/// Why a surface has no voxel in `domain`.
#[must_use]
pub fn why_empty(name: &str, expr: &Expr, domain: Aabb, simd: SimdLevel) -> String {
    if let Some(value) = expr.constant() {
        return format!("`{name}` has no points: F is {value} everywhere, whatever x, y and z are");
    }
    let range = sample_field(expr, domain, simd);
    let found = match find_extent(expr, simd) {
        Extent::Nothing => "it has no points within 2^20 of the origin".to_owned(),
        Extent::Within(bounds) => format!("if it has points, they lie in {}", toml(bounds)),
        Extent::Unbounded => nearest(&range),
    };
    format!("`{name}` does not meet the domain: {range}; {found}")
}

/// Where F comes nearest to zero on the sampled points.
fn nearest(range: &FieldRange) -> String {
    let ends = [range.least, range.most].into_iter().flatten();
    let by_size = |a: &(f64, DVec3), b: &(f64, DVec3)| a.0.abs().total_cmp(&b.0.abs());
    match ends.min_by(by_size) {
        Some((_, p)) => {
            format!("it comes nearest to 0 at ({:.4}, {:.4}, {:.4}): look there", p.x, p.y, p.z)
        }
        None => "look where it is defined".to_owned(),
    }
}

/// The voxels that a surface may meet, as far as advice depends on them.
#[derive(Clone, Copy, Debug)]
pub struct Occupied<'a> {
    /// Where they lie.
    lattice: &'a Lattice,
    /// The first and the last along each axis.
    bounds: ([u32; 3], [u32; 3]),
    /// The part of all voxels that they are, if that is too large.
    large_part: Option<f64>,
}

impl<'a> Occupied<'a> {
    /// Those of an octree, if there are any.
    #[must_use]
    pub fn of_octree(octree: &MortonOctree, lattice: &'a Lattice) -> Option<Self> {
        let all = lattice.n_voxels().map(f64::from).iter().product::<f64>();
        let part = f64::from(octree.voxel_count()) / all;
        let large_part = Some(part).filter(|&part| part > LARGE_PART);
        Some(Self { lattice, bounds: octree.bounds()?, large_part })
    }

    /// Those of an outline, if there are any.
    #[must_use]
    pub fn of_outline(outline: &'a Outline) -> Option<Self> {
        let (lattice, large_part) = (outline.lattice(), outline.part_above(LARGE_PART));
        let loose = Self { lattice, bounds: outline.loose_bounds()?, large_part };
        // Only what would be told must be exact.
        let is_exact = loose.is_cut() || loose.edge() < 2.0 * SMALL_PART * loose.longest();
        Some(if is_exact { Self { bounds: outline.bounds()?, ..loose } } else { loose })
    }

    /// Whether they reach the border of the domain.
    fn is_cut(&self) -> bool {
        let (Self { bounds: (least, most), .. }, n) = (self, self.lattice.n_voxels());
        (0..3).any(|axis| least[axis] == 0 || most[axis] + 1 == n[axis])
    }

    /// The longest edge of their box, in voxels.
    fn edge(&self) -> f64 {
        let (least, most) = self.bounds;
        (0..3).map(|axis| most[axis] + 1 - least[axis]).max().map_or(0.0, f64::from)
    }

    /// The domain's longest edge, in voxels.
    fn longest(&self) -> f64 {
        self.lattice.n_voxels().into_iter().max().map_or(1.0, f64::from)
    }
}

/// What the user may want to know about a surface that was found: that it could hardly be excluded
/// from anywhere, that the domain cuts it though it could hold all of it, or is far too large.
#[must_use]
pub fn about(name: &str, expr: &Expr, found: &Occupied<'_>, simd: SimdLevel) -> Option<String> {
    if let Some(part) = found.large_part {
        return Some(format!(
            "`{name}` was excluded from only {:.0} % of the voxels: F may be 0 everywhere, or its \
             formula is too involved for this resolution",
            100.0 * (1.0 - part)
        ));
    }
    let (is_cut, edge, longest) = (found.is_cut(), found.edge(), found.longest());
    let is_small = edge < SMALL_PART * longest;
    if !is_cut && !is_small {
        return None;
    }
    let Extent::Within(bounds) = find_extent(expr, simd) else { return None };
    let domain = found.lattice.bounds();
    let slack = EXTENT_SLACK * bounds.size().max_element();
    let leaves =
        (bounds.min.cmplt(domain.min - slack) | bounds.max.cmpgt(domain.max + slack)).any();
    if is_cut && leaves {
        Some(format!("the domain cuts `{name}`: all of it lies in {}", toml(bounds)))
    } else if is_small {
        Some(format!(
            "`{name}` fills {edge} of {longest} voxels: all of it lies in {}",
            toml(bounds)
        ))
    } else {
        None
    }
}

/// What to tell of the mesh of a surface that may be singular at `places`, the first of them at `first`.
#[must_use]
pub fn of_singular(name: &str, places: u64, first: Option<[f64; 3]>) -> Option<String> {
    let [x, y, z] = first?;
    let where_it_is = match places {
        1 => "in one place,".to_owned(),
        n => format!("in {n} places, the first"),
    };
    Some(format!(
        "`{name}` may touch or cross itself, or end, {where_it_is} near ({x:.4}, {y:.4}, {z:.4}): what \
         its mesh joins there and what it parts depends on the voxels"
    ))
}

/// A box as it is written in a scene.
fn toml(bounds: Aabb) -> String {
    let list = |v: DVec3| format!("[{}, {}, {}]", v.x, v.y, v.z);
    format!("min = {}, max = {}", list(bounds.min), list(bounds.max))
}
