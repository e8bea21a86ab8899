//! Storage of the voxels that meet a surface, whatever the storage is.
//!
//! Stolte & Kaufman keep storage apart from subdivision (1998, section 4); so does this crate:
//! voxelization produces voxels, a [`Storage`] holds them, rasterization visits them.

mod dense;
mod detail;
mod masks;
mod morton;
mod normal;
mod pointer;

pub use dense::{DenseGrid, DenseGridBuilder, dense_grid_bytes};
pub use detail::{Detail, DetailLevel};

pub use masks::{LevelMasks, NodeState, bits};
pub use morton::MortonOctree;
pub use normal::OctNormal;
pub use pointer::{PointerOctree, PointerOctreeBuilder};

use fixedbitset::FixedBitSet;

/// One stored voxel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Voxel {
    /// Position in the storage's canonical order (Morton order), from 0 without gaps.
    pub rank: u32,
    /// Lattice coordinates (x, y, z), each below the lattice's count on its axis.
    pub ijk: [u32; 3],
    /// Outward unit normal of the surface at the voxel's centre.
    pub normal: OctNormal,
    /// Whether the surface provably passes through; if not, that could not be disproved.
    pub certified: bool,
}

/// A run of voxels that are neighbours in canonical order: the unit of parallel work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    /// Level of the octree node whose voxels these are; the root has level 0.
    pub level: u32,
    /// Index of that node among the nodes of its level.
    pub index: u32,
    /// Coordinates of that node on its level's lattice.
    pub ijk: [u32; 3],
}

/// What is known about a place in the domain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Occupancy {
    /// Proven outside.
    Empty,
    /// Proven inside.
    Inside,
    /// The surface passes through, or that could not be disproved.
    Surface,
}

/// Bytes held on the heap, by what they are for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Bytes {
    /// Where voxels are, and what lies inside.
    pub shape: u64,
    /// Normals.
    pub normals: u64,
    /// Certificates.
    pub certificates: u64,
}

impl Bytes {
    /// Of normals and certificates, which all storages keep alike, and a shape.
    fn new(shape: usize, normals: &[OctNormal], certified: &FixedBitSet) -> Self {
        Self {
            shape: shape as u64,
            normals: size_of_val(normals) as u64,
            certificates: size_of_val(certified.as_slice()) as u64,
        }
    }
}

/// Holds the voxels of one surface.
pub trait Storage: std::fmt::Debug + Send + Sync {
    /// Number of levels below the root; the lattice has `2^depth` voxels along an axis at most.
    fn depth(&self) -> u32;

    /// Number of stored voxels.
    fn voxel_count(&self) -> u32;

    /// Bytes held on the heap.
    fn bytes(&self) -> Bytes;

    /// Splits the voxels into parts for parallel traversal, in canonical order. The split depends
    /// on the stored voxels alone, never on the number of threads.
    fn parts(&self) -> Vec<Part>;

    /// Calls `visit` for every voxel of `part`, in canonical order.
    fn visit(&self, part: Part, visit: &mut dyn FnMut(Voxel));

    /// The normal of the voxel at `rank`.
    ///
    /// # Panics
    /// If `rank` is not below [`Storage::voxel_count`].
    fn normal(&self, rank: u32) -> OctNormal;

    /// Whether the surface provably passes through the voxel at `rank`.
    ///
    /// # Panics
    /// If `rank` is not below [`Storage::voxel_count`].
    fn is_certified(&self, rank: u32) -> bool;

    /// The rank of the voxel at `ijk`, if one is stored there.
    fn find(&self, ijk: [u32; 3]) -> Option<u32>;

    /// What is known about the voxel at `ijk`.
    fn occupancy(&self, ijk: [u32; 3]) -> Occupancy;

    /// The octree that this is, if it is one.
    fn as_morton(&self) -> Option<&MortonOctree> {
        None
    }
}

/// Takes voxels one by one, in any order, each once.
pub trait StoreVoxels {
    /// Stores a voxel.
    fn store(&mut self, ijk: [u32; 3], normal: OctNormal, certified: bool);

    /// Notes that the node at `ijk` of `level` lies inside and has no voxels.
    fn store_inside(&mut self, level: u32, ijk: [u32; 3]);

    /// Puts the voxels in canonical order.
    fn finish(self: Box<Self>) -> Box<dyn Storage>;
}

/// Which storage holds the voxels. They differ in memory and speed, never in the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum StorageKind {
    /// [`MortonOctree`].
    #[default]
    Morton,
    /// [`PointerOctree`].
    Pointer,
    /// [`DenseGrid`].
    Dense,
}

impl StorageKind {
    /// Keeps what `octree` holds in a storage of this kind.
    #[must_use]
    pub fn keep(self, octree: MortonOctree) -> Box<dyn Storage> {
        let mut storage: Box<dyn StoreVoxels> = match self {
            Self::Morton => return Box::new(octree),
            Self::Pointer => Box::new(PointerOctreeBuilder::new(octree.depth())),
            Self::Dense => Box::new(DenseGridBuilder::new(octree.depth())),
        };
        octree.visit_inside(&mut |level, ijk| storage.store_inside(level, ijk));
        for part in octree.parts() {
            octree.visit(part, &mut |v| storage.store(v.ijk, v.normal, v.certified));
        }
        storage.finish()
    }
}
