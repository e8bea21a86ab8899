//! How far a surface reaches, and little else: what a camera must know to be placed.
//!
//! All voxels tell, but few of them stand at the rim. So voxels are found by values alone, which costs
//! little, and bounds how far those of each block of 32³ can reach; only blocks that may reach farthest
//! are searched with everything that voxelization has.

use std::sync::OnceLock;

use glam::DVec3;
use rayon::prelude::*;

use super::{
    BlockVoxels, Effort, Octant, Settings, Voxelization, Wish, find_blocks, finder,
    signs::BLOCK_LEVELS, voxelize,
};
use crate::{
    Result,
    expr::Expr,
    math::{Lattice, SimdLevel},
    octree::Storage as _,
    progress::Unwatched,
};

/// The voxels of a surface, found where they matter.
#[derive(Debug)]
pub struct Outline {
    lattice: Lattice,
    simd: SimdLevel,
    blocks: Vec<Block>,
    /// Boxes that were decided by values.
    effort: Effort,
}

#[derive(Debug)]
struct Block {
    level: u32,
    /// Centres of voxels, by values.
    centers: Vec<DVec3>,
    /// To be searched, unless values are all that is wanted.
    octant: Option<Octant>,
    found: OnceLock<Found>,
}

/// What was found in a block.
#[derive(Debug)]
struct Found {
    centers: Vec<DVec3>,
    effort: Effort,
}

impl Outline {
    /// Of the surface of `expr` in the voxels of `lattice`; by values alone unless `certify`.
    ///
    /// # Errors
    /// As [`voxelize()`].
    pub fn new(expr: &Expr, lattice: &Lattice, simd: SimdLevel, certify: bool) -> Result<Self> {
        let blocks = if lattice.depth() > BLOCK_LEVELS {
            by_values(expr, lattice, simd, certify)
        } else {
            let settings = Settings { simd, certify, ..Settings::default() };
            let Voxelization { octree, effort, .. } =
                voxelize(expr, lattice, &settings, &Unwatched)?;
            let voxels = BlockVoxels { lattice: lattice.clone(), octree, effort };
            vec![(Block::known(0, centers(&voxels)), voxels.effort)]
        };
        let mut all = Self {
            lattice: lattice.clone(),
            simd,
            blocks: Vec::with_capacity(blocks.len()),
            effort: Effort::default(),
        };
        for (block, effort) in blocks {
            all.effort.add_below(block.level, &effort);
            all.blocks.push(block);
        }
        Ok(all)
    }

    /// The voxels' lattice.
    #[must_use]
    pub fn lattice(&self) -> &Lattice {
        &self.lattice
    }

    /// For each direction d, the largest d·p over the centres p of all voxels; negative infinity
    /// if there are none.
    #[must_use]
    pub fn reach<const N: usize>(&self, directions: [DVec3; N]) -> [f64; N] {
        let bounds: Vec<[f64; N]> =
            self.blocks.par_iter().map(|block| reach(&block.centers, directions)).collect();
        let mut farthest = [f64::NEG_INFINITY; N];
        for k in 0..N {
            let mut order: Vec<usize> = (0..self.blocks.len()).collect();
            order.sort_by(|&a, &b| bounds[b][k].total_cmp(&bounds[a][k]));
            for i in order {
                if bounds[i][k] <= farthest[k] {
                    break;
                }
                let found = reach(self.centers(&self.blocks[i]), directions);
                farthest = farther(farthest, found);
            }
        }
        farthest
    }

    /// Whether there is no voxel.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.blocks.iter().all(|block| self.centers(block).is_empty())
    }

    /// The first and the last voxel along each axis by values alone, which the voxels cannot
    /// exceed.
    #[must_use]
    pub fn loose_bounds(&self) -> Option<([u32; 3], [u32; 3])> {
        let of_blocks = self.blocks.iter().map(|block| reach(&block.centers, AXES));
        self.bounds_from(of_blocks.fold([f64::NEG_INFINITY; 6], farther))
    }

    /// The first and the last voxel along each axis.
    #[must_use]
    pub fn bounds(&self) -> Option<([u32; 3], [u32; 3])> {
        self.bounds_from(self.reach(AXES))
    }

    fn bounds_from(&self, reach: [f64; 6]) -> Option<([u32; 3], [u32; 3])> {
        let [x1, y1, z1, x0, y0, z0] = reach;
        let voxel = |x: f64, y: f64, z: f64| self.lattice.voxel_at(DVec3::new(x, y, z));
        x1.is_finite().then(|| (voxel(-x0, -y0, -z0), voxel(x1, y1, z1)))
    }

    /// The part of all voxels that the surface may meet, if it is more than `least`.
    #[must_use]
    pub fn part_above(&self, least: f64) -> Option<f64> {
        let all = self.lattice.n_voxels().map(f64::from).iter().product::<f64>();
        let part = |n: usize| n as f64 / all;
        let by_values = part(self.blocks.iter().map(|block| block.centers.len()).sum());
        let exact = || part(self.blocks.iter().map(|block| self.centers(block).len()).sum());
        (by_values > least).then(exact).filter(|&part| part > least)
    }

    /// What it took so far.
    #[must_use]
    pub fn effort(&self) -> Effort {
        let mut effort = self.effort.clone();
        for block in &self.blocks {
            if let Some(found) = block.found.get() {
                effort.add_below(block.level, &found.effort);
            }
        }
        effort
    }

    /// The centres of a block's voxels.
    fn centers<'b>(&self, block: &'b Block) -> &'b [DVec3] {
        let Some(octant) = &block.octant else { return &block.centers };
        let find = || {
            let voxels = finder(self.simd).find(octant, &self.lattice);
            Found { centers: centers(&voxels), effort: voxels.effort }
        };
        &block.found.get_or_init(find).centers
    }
}

impl Block {
    fn known(level: u32, centers: Vec<DVec3>) -> Self {
        Self { level, centers, octant: None, found: OnceLock::new() }
    }
}

/// All blocks with voxels, by values alone, and what each took.
fn by_values(
    expr: &Expr,
    lattice: &Lattice,
    simd: SimdLevel,
    certify: bool,
) -> Vec<(Block, Effort)> {
    let last = lattice.depth() - BLOCK_LEVELS;
    let wish = |level: u32, _: &_| if level == last { Wish::Keep } else { Wish::Divide };
    let octants = find_blocks(expr.tape(), lattice, simd, &wish);
    let find = |finder: &mut Box<dyn super::FindVoxels>, octant: Octant| {
        let (places, block, effort) = finder.find_by_values(&octant, lattice);
        let centers: Vec<DVec3> = places.iter().map(|&ijk| block.voxel_center(ijk)).collect();
        let octant = certify.then_some(octant);
        (Block { level: last, centers, octant, found: OnceLock::new() }, effort)
    };
    octants.into_par_iter().map_init(|| finder(simd), find).collect()
}

/// The centres of all voxels of a block.
fn centers(BlockVoxels { octree, lattice, .. }: &BlockVoxels) -> Vec<DVec3> {
    let mut centers = Vec::with_capacity(octree.voxel_count() as usize);
    for part in octree.parts() {
        octree.visit(part, &mut |voxel| centers.push(lattice.voxel_center(voxel.ijk)));
    }
    centers
}

/// There and back along each axis.
const AXES: [DVec3; 6] = [DVec3::X, DVec3::Y, DVec3::Z, DVec3::NEG_X, DVec3::NEG_Y, DVec3::NEG_Z];

/// The farther of each two.
fn farther<const N: usize>(a: [f64; N], b: [f64; N]) -> [f64; N] {
    std::array::from_fn(|k| if b[k] > a[k] { b[k] } else { a[k] })
}

fn reach<const N: usize>(centers: &[DVec3], directions: [DVec3; N]) -> [f64; N] {
    let mut reach = [f64::NEG_INFINITY; N];
    for center in centers {
        for k in 0..N {
            let at = directions[k].dot(*center);
            reach[k] = if at > reach[k] { at } else { reach[k] };
        }
    }
    reach
}
