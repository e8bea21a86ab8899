//! Surfaces of a scene to meshes, each with what is known of it.

use crate::{
    math::{Lattice, SimdLevel},
    mesh::{self, FormulaSettings, Mesh},
    octree::Storage,
    scene::{MeshSettings, Scene},
    statistics,
};

/// The meshes of all surfaces that have voxels, then those of volumes, in the order of the scene, and
/// their numbers.
pub fn meshes(
    scene: &Scene,
    storages: &[Box<dyn Storage>],
    lattice: &Lattice,
    simd: SimdLevel,
) -> (Vec<Mesh>, Vec<statistics::Mesh>) {
    let MeshSettings { border, vertex, .. } = scene.mesh;
    let settings = FormulaSettings { border, vertex, simd };
    let (mut meshes, mut numbers) = (Vec::new(), Vec::new());
    for (surface, storage) in scene.surfaces.iter().zip(storages) {
        let tape = surface.expr.tape();
        let mut mesh = mesh::of_formula(&tape, &**storage, lattice, &settings);
        if mesh.triangles.is_empty() {
            continue;
        }
        mesh.name.clone_from(&surface.name);
        mesh.color = surface.material.color;
        let split_vertices = mesh.split_touching();
        numbers.push(statistics::Mesh::of(&mesh, split_vertices));
        meshes.push(mesh);
    }
    for mesh in &*scene.isosurfaces {
        let mut mesh = mesh.clone();
        let split_vertices = mesh.split_touching();
        numbers.push(statistics::Mesh::of(&mesh, split_vertices));
        meshes.push(mesh);
    }
    (meshes, numbers)
}

/// What the user should know about a mesh that is not clean.
#[must_use]
pub fn note(numbers: &statistics::Mesh) -> Option<String> {
    let statistics::Mesh { name, open_edges, faults, .. } = numbers;
    if *faults > 0 {
        return Some(format!("the mesh of `{name}` is not clean: {faults} faults, see --stats"));
    }
    (*open_edges > 0).then(|| {
        format!(
            "the mesh of `{name}` is open, with {open_edges} edges at its border: cap = true in \
             [mesh] closes a solid where the domain ends"
        )
    })
}
