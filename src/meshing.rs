//! Surfaces of a scene to meshes, each with what is known of it.

use crate::{
    expr::Tape,
    math::{Lattice, SimdLevel},
    mesh::{self, FormulaSettings, Mesh},
    octree::Storage,
    scene::{MeshSettings, Scene, Shape},
    statistics,
};

/// The meshes of all surfaces that have voxels, then those of solids, which have these `shapes`, in the
/// order of the scene, and their numbers.
pub fn meshes(
    scene: &Scene,
    storages: &[Box<dyn Storage>],
    shapes: &[Shape<'_>],
    lattice: &Lattice,
    simd: SimdLevel,
) -> (Vec<Mesh>, Vec<statistics::Mesh>) {
    let MeshSettings { border, vertex, most_triangles, .. } = scene.mesh;
    let settings = FormulaSettings { border, vertex, simd };
    let (mut meshes, mut numbers) = (Vec::new(), Vec::new());
    let mut finish = |mut mesh: Mesh, tape: Option<&Tape>| {
        let split_vertices = mesh.split_touching();
        let full = most_triangles.map(|n_wanted| {
            let full = mesh.clone();
            thin_out(&mut mesh, n_wanted as usize, tape, simd);
            full
        });
        numbers.push(statistics::Mesh::of(&mesh, full.as_ref(), split_vertices));
        meshes.push(mesh);
    };
    for (surface, storage) in scene.surfaces.iter().zip(storages) {
        let tape = surface.expr.tape();
        let mut mesh = mesh::of_formula(&tape, &**storage, lattice, &settings);
        if mesh.triangles.is_empty() {
            continue;
        }
        mesh.name.clone_from(&surface.name);
        mesh.color = surface.material.color;
        finish(mesh, Some(&tape));
    }
    for (solid, shape) in scene.solids.iter().zip(shapes) {
        let mut mesh = shape.mesh();
        mesh.name.clone_from(&solid.name);
        mesh.color = solid.material.color;
        finish(mesh, None);
    }
    (meshes, numbers)
}

/// Leaves `n_wanted` triangles of a mesh, if it can, with the normals of its formula, if it has one.
pub(crate) fn thin_out(mesh: &mut Mesh, n_wanted: usize, tape: Option<&Tape>, simd: SimdLevel) {
    let n_before = mesh.triangles.len();
    mesh.decimate(n_wanted);
    if let Some(tape) = tape
        && mesh.triangles.len() < n_before
    {
        mesh.take_normals_of(tape, simd);
    }
}

/// What the user should know about a mesh that is not clean, or has more triangles than are wanted.
#[must_use]
pub fn notes(numbers: &statistics::Mesh, settings: &MeshSettings) -> Vec<String> {
    let statistics::Mesh { name, open_edges, faults, triangles, .. } = numbers;
    let mut notes = Vec::new();
    if *faults > 0 {
        notes.push(format!("the mesh of `{name}` is not clean: {faults} faults, see --stats"));
    } else if *open_edges > 0 {
        notes.push(format!(
            "the mesh of `{name}` is open, with {open_edges} edges at its border: cap = true in \
             [mesh] closes a solid where the domain ends"
        ));
    }
    if let Some(most) = settings.most_triangles.filter(|&most| *triangles > u64::from(most)) {
        notes.push(format!(
            "the mesh of `{name}` has {triangles} triangles, not {most}: with fewer it would not \
             keep its holes and pieces, or fold"
        ));
    }
    notes
}
