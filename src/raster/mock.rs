//! A storage for tests: a sorted list of voxels, its parts the nodes of one level.

use glam::DVec3;

use super::{Coloring, Content, Layer, Material, Source, layer::Drawn};
use crate::{
    math::{Aabb, Lattice, morton_encode},
    octree::{Bytes, Detail, Occupancy, OctNormal, Part, Storage, Voxel},
};

/// Parts are nodes this many levels above the voxels.
const PART_LEVELS: u32 = 3;

#[derive(Debug)]
pub(super) struct Mock {
    pub(super) lattice: Lattice,
    pub(super) voxels: Vec<Voxel>,
    pub(super) parts: Vec<Part>,
    /// Where each part's voxels begin, by the part's index; one more for the end.
    starts: Vec<usize>,
}

impl Mock {
    /// Stores the voxels at `places`, in any order, without duplicates.
    pub(super) fn new(
        lattice: Lattice,
        places: impl IntoIterator<Item = ([u32; 3], DVec3)>,
    ) -> Self {
        let mut places: Vec<_> = places.into_iter().collect();
        places.sort_by_key(|&(ijk, _)| morton_encode(ijk));
        places.dedup_by_key(|&mut (ijk, _)| ijk);
        let voxels: Vec<Voxel> = (0..)
            .zip(places)
            .map(|(rank, (ijk, n))| {
                let normal = OctNormal::encode(n);
                Voxel { rank, ijk, normal, certified: rank % 2 == 0 }
            })
            .collect();
        let level = lattice.depth().saturating_sub(PART_LEVELS);
        let mut starts = Vec::new();
        let mut parts: Vec<Part> = Vec::new();
        for voxel in &voxels {
            let ijk = voxel.ijk.map(|i| i >> PART_LEVELS);
            if parts.last().is_none_or(|part| part.ijk != ijk) {
                parts.push(Part { level, index: parts.len() as u32, ijk });
                starts.push(voxel.rank as usize);
            }
        }
        starts.push(voxels.len());
        Self { lattice, voxels, parts, starts }
    }

    /// The voxels of [-1, 1]^3 that meet the zero set of `f`, judged by its linear part at their
    /// centres. `f` returns value and gradient.
    pub(super) fn surface(resolution: u32, f: impl Fn(DVec3) -> (f64, DVec3)) -> Self {
        let lattice = Lattice::new(Aabb { min: DVec3::NEG_ONE, max: DVec3::ONE }, resolution);
        let half = 0.5 * lattice.voxel_size();
        let mut places = Vec::new();
        for x in 0..resolution {
            for y in 0..resolution {
                for z in 0..resolution {
                    let (value, gradient) = f(lattice.voxel_center([x, y, z]));
                    if value.abs() <= half * gradient.abs().element_sum() {
                        places.push(([x, y, z], gradient));
                    }
                }
            }
        }
        Self::new(lattice, places)
    }

    pub(super) fn sphere(resolution: u32, radius: f64) -> Self {
        Self::surface(resolution, |p| (p.length_squared() - radius * radius, 2.0 * p))
    }

    pub(super) fn layer(&self, color: [f32; 3]) -> Layer<'_> {
        let material = Material { color, back_color: None, specular: 0.3, shininess: 40 };
        // Tests end soon.
        let detail = Box::leak(Box::new(Detail::new(self, &self.lattice)));
        let (source, lattice) = (Source::Stored(detail), &self.lattice);
        Layer { source, lattice, material, coloring: &Coloring::Plain, tape: None }
    }
}

/// Its voxels' cubes.
impl Content for Mock {
    fn reach<const N: usize>(&self, directions: [DVec3; N]) -> [f64; N] {
        Drawn { voxels: vec![(self, &self.lattice)], ..Drawn::default() }.reach(directions)
    }
}

impl Storage for Mock {
    fn depth(&self) -> u32 {
        self.lattice.depth()
    }

    fn voxel_count(&self) -> u32 {
        self.voxels.len() as u32
    }

    fn bytes(&self) -> Bytes {
        Bytes::default()
    }

    fn parts(&self) -> Vec<Part> {
        self.parts.clone()
    }

    fn visit(&self, part: Part, visit: &mut dyn FnMut(Voxel)) {
        let index = part.index as usize;
        self.voxels[self.starts[index]..self.starts[index + 1]].iter().for_each(|&v| visit(v));
    }

    fn normal(&self, rank: u32) -> OctNormal {
        self.voxels[rank as usize].normal
    }

    fn is_certified(&self, rank: u32) -> bool {
        self.voxels[rank as usize].certified
    }

    fn find(&self, ijk: [u32; 3]) -> Option<u32> {
        let code = morton_encode(ijk);
        let found = self.voxels.binary_search_by_key(&code, |v| morton_encode(v.ijk));
        found.ok().map(|i| i as u32)
    }

    fn occupancy(&self, ijk: [u32; 3]) -> Occupancy {
        self.find(ijk).map_or(Occupancy::Empty, |_| Occupancy::Surface)
    }
}
