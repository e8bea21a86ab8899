//! Symmetric surfaces have symmetric voxels, exactly, and symmetric certificates.

use std::collections::BTreeMap;

use zeroset::octree::Storage;

use crate::{SURFACES, Surface, lattice, octree, scene};

/// Which coordinate stands where, from 1: a symmetry of the voxels in a cube. A negative one is mirrored.
pub(crate) type Symmetry = [i8; 3];

/// Where a voxel goes, if there are `n` along each axis.
fn image(symmetry: Symmetry, ijk: [u32; 3], n: u32) -> [u32; 3] {
    symmetry.map(|coordinate| {
        let i = ijk[usize::from(coordinate.unsigned_abs()) - 1];
        if coordinate < 0 { n - 1 - i } else { i }
    })
}

/// All voxels, and whether they are certified.
fn voxels(surface: &Surface, resolution: u32) -> BTreeMap<[u32; 3], bool> {
    let octree = octree(&scene(surface).surfaces[0].expr, &lattice(surface, resolution));
    let mut voxels = BTreeMap::new();
    for part in octree.parts() {
        octree.visit(part, &mut |voxel| {
            voxels.insert(voxel.ijk, voxel.certified);
        });
    }
    voxels
}

/// How many voxels have no image, and how many of the others have one with another certificate.
fn odd(voxels: &BTreeMap<[u32; 3], bool>, symmetry: Symmetry, n: u32) -> [usize; 2] {
    let images = voxels.iter().map(|(&ijk, certified)| (certified, image(symmetry, ijk, n)));
    let found = images.map(|(certified, ijk)| (certified, voxels.get(&ijk)));
    found.fold([0; 2], |[lost, differ], (certified, found)| match found {
        None => [lost + 1, differ],
        Some(other) => [lost, differ + usize::from(certified != other)],
    })
}

#[test]
fn symmetric_surfaces_have_symmetric_voxels() {
    let mut failures = Vec::new();
    for surface in SURFACES {
        for n in [64, 75] {
            let voxels = voxels(surface, n);
            for &symmetry in surface.symmetries {
                let odd = odd(&voxels, symmetry, n);
                if odd != [0; 2] {
                    failures.push(format!(
                        "{}, {symmetry:?} at {n}: of {} voxels {} have no image, {} another certificate",
                        surface.name, voxels.len(), odd[0], odd[1],
                    ));
                }
            }
        }
    }
    assert!(failures.is_empty(), "{failures:#?}");
}

/// Symmetries that exchange factors of a product. Its slopes are a sum of products of intervals, of which
/// the factors cannot be taken out without becoming wider: another order has other bounds. They decide
/// about few voxels, none of them certified, because through the image of such a one the surface passes.
#[test]
fn an_exchange_of_factors_moves_candidates_alone() {
    for (name, symmetry) in [
        ("kummer_quartic", [2, 1, -3]),
        ("togliatti_quintic", [1, -2, 3]),
        ("barth_sextic", [2, 3, 1]),
        ("barth_sextic_30_cusps", [2, 3, 1]),
        ("barth_decic", [2, 3, 1]),
    ] {
        for n in [64, 75] {
            let voxels = voxels(crate::meshed::published(name), n);
            let certified = voxels.iter().filter(|(_, certified)| **certified);
            let mut images = certified.map(|(&ijk, _)| image(symmetry, ijk, n));
            assert!(images.all(|ijk| voxels.contains_key(&ijk)), "{name} at {n}");
            let [lost, differ] = odd(&voxels, symmetry, n);
            assert!(300 * (lost + differ) < voxels.len(), "{name} at {n}: {lost}, {differ}");
        }
    }
}

/// Symmetries that a surface does not have are missing in its voxels as well: the comparison can fail.
#[test]
fn asymmetric_surfaces_have_asymmetric_voxels() {
    for (name, symmetry) in
        [("gyroid", [-1, 2, 3]), ("schwarz_D", [-1, -2, -3]), ("barth_sextic", [2, 1, 3])]
    {
        let surface = crate::meshed::published(name);
        assert!(odd(&voxels(surface, 64), symmetry, 64)[0] > 1000, "{name}");
    }
}
