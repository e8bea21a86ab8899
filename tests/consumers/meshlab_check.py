"""MeshLab: two-manifold, with as many holes as there are borders, in its place, with colours."""

import importlib.metadata
import sys

import pymeshlab

import common


def check(path, kind, surfaces):
    meshes = pymeshlab.MeshSet()
    meshes.load_new_mesh(path)
    meshes.generate_by_merging_visible_meshes(mergevertices=kind == "stl")
    mesh = meshes.current_mesh()
    faults = []
    if mesh.face_number() != common.total(surfaces, "triangles"):
        faults.append(f"{mesh.face_number()} triangles")
    if mesh.vertex_number() != common.total(surfaces, "vertices"):
        faults.append(f"{mesh.vertex_number()} vertices")
    topology = meshes.get_topological_measures()
    if topology["non_two_manifold_edges"] + topology["non_two_manifold_vertices"] > 0:
        faults.append("not manifold")
    if (topology["boundary_edges"] == 0) != common.is_closed(surfaces):
        faults.append(f"{topology['boundary_edges']} edges at the border")
    box = mesh.bounding_box()
    corners = list(box.min()), list(box.max())
    if kind in common.Y_UP:
        corners = common.z_up(*corners)
    for is_at, ours in zip(corners, common.bounds(surfaces)):
        if not common.is_near(is_at, ours):
            faults.append(f"a corner at {is_at} instead of {ours}")
    return faults


common.each(
    sys.argv[1], f"pymeshlab {importlib.metadata.version('pymeshlab')}", common.KINDS, check
)
