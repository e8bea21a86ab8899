"""trimesh and manifold3d: closed, wound outwards, of the right volume; as in the file and welded."""

import importlib.metadata
import os
import re
import sys

import numpy
import trimesh

import common


def meshes(path):
    """What a file holds, vertices as they stand there."""
    scene = trimesh.load_scene(path, process=False)
    return [mesh for mesh in scene.dump() if isinstance(mesh, trimesh.Trimesh)]


def check_trimesh(path, kind, surfaces):
    faults = []
    found = meshes(path)
    if len(found) != (len(surfaces) if kind in common.APART else 1):
        faults.append(f"{len(found)} meshes")
    if sum(len(mesh.faces) for mesh in found) != common.total(surfaces, "triangles"):
        faults.append("triangles are missing")
    low = numpy.min([mesh.bounds[0] for mesh in found], axis=0)
    high = numpy.max([mesh.bounds[1] for mesh in found], axis=0)
    if kind in common.Y_UP:
        low, high = common.z_up(low, high)
    for is_box, ours in zip((low, high), common.bounds(surfaces)):
        if not common.is_near(is_box, ours):
            faults.append(f"a corner at {list(is_box)} instead of {ours}")
    for state in ("in the file", "welded"):
        if state == "welded":
            for mesh in found:
                mesh.merge_vertices(merge_norm=True, merge_tex=True)
        elif kind == "stl":
            continue  # it has no shared vertices
        if all(mesh.is_watertight for mesh in found) != common.is_closed(surfaces):
            faults.append(f"{state}: closed or not")
        if not all(mesh.is_winding_consistent for mesh in found):
            faults.append(f"{state}: wound both ways")
        n_vertices = sum(len(mesh.vertices) for mesh in found)
        if n_vertices != common.total(surfaces, "vertices"):
            faults.append(f"{state}: {n_vertices} vertices")
        volume = sum(mesh.volume for mesh in found)
        if common.is_closed(surfaces) and not common.is_near(
            [volume], [common.total(surfaces, "volume")], 1e-5
        ):
            faults.append(f"{state}: volume {volume}")
    return faults


def check_manifold(path, kind, surfaces):
    import manifold3d

    if not common.is_closed(surfaces):
        return None
    faults, found = [], []
    for mesh in meshes(path):
        if kind == "stl":
            mesh.merge_vertices()
        solid = manifold3d.Manifold(
            manifold3d.Mesh(
                numpy.asarray(mesh.vertices, numpy.float32),
                numpy.asarray(mesh.faces, numpy.uint32),
            )
        )
        if solid.status() != manifold3d.Error.NoError:
            faults.append(str(solid.status()))
            continue
        found.append(sum(2 - 2 * part.genus() for part in solid.decompose()))
    ours = [surface["euler"] for surface in surfaces]
    if sorted(found) != sorted(ours if kind in common.APART else [sum(ours)]):
        faults.append(f"Euler numbers {found} instead of {ours}")
    return faults


def check_points(tool, path):
    """Voxels as points: all of them, with colours."""
    with open(path, "rb") as file:
        n = int(re.search(rb"element vertex (\d+)", file.read(1000)).group(1))
    points = trimesh.load(path)
    is_whole = len(points.vertices) == n == len(points.colors)
    common.row(tool, os.path.basename(path), [] if is_whole else ["points are missing"])


if __name__ == "__main__":
    name, folder = sys.argv[1:]
    tool = f"{name} {importlib.metadata.version(name)}"
    check = {"trimesh": check_trimesh, "manifold3d": check_manifold}[name]
    common.each(folder, tool, common.KINDS, check)
    if name == "trimesh":
        check_points(tool, os.path.join(folder, "layers_true.ply"))
