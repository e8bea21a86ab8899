//! Two meshes that test writers: awkward numbers and names, one closed and one open.

use glam::DVec3;

use crate::mesh::Mesh;

/// A tetrahedron without any symmetry, and two triangles that share an edge.
pub(super) fn meshes() -> Vec<Mesh> {
    let closed = Mesh {
        name: "Würfel <1> & \"a\"".into(),
        positions: vec![
            [0.1, -0.0, 1e-7],
            [1.0 / 3.0, 0.25, -1e-12],
            [-0.7, 2.2, 0.3],
            [0.0, 0.5, 3.000_000_2],
        ],
        normals: Vec::new(),
        triangles: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
        color: [1.0, 0.212_230_76, 0.0],
    };
    let open = Mesh {
        name: "two words".into(),
        positions: vec![[0.0; 3], [4.0, 0.0, -1.0], [0.0, 4.5, 0.0], [123.456, 1e-3, 7.0]],
        normals: Vec::new(),
        triangles: vec![[0, 1, 2], [2, 1, 3]],
        color: [0.1, 0.2, 0.3],
    };
    let mut meshes = vec![closed, open];
    for mesh in &mut meshes {
        let middle = DVec3::new(0.05, 0.8, 0.9);
        mesh.normals = mesh
            .positions
            .iter()
            .map(|p| (DVec3::from_array(p.map(f64::from)) - middle).normalize())
            .map(|n| n.as_vec3().to_array())
            .collect();
    }
    assert!(meshes[0].shape().volume > 0.0);
    meshes
}

/// A vector of the scene in a y-up file.
pub(super) fn y_up([x, y, z]: [f32; 3]) -> [f32; 3] {
    [x, z, -y]
}
