"""Blender: upright, at its place, smooth, with its colours."""

import contextlib
import os
import sys

import bpy

import common

IMPORT = {
    "glb": lambda path: bpy.ops.import_scene.gltf(filepath=path),
    "gltf": lambda path: bpy.ops.import_scene.gltf(filepath=path),
    "obj": lambda path: bpy.ops.wm.obj_import(filepath=path),
    "ply": lambda path: bpy.ops.wm.ply_import(filepath=path),
    "stl": lambda path: bpy.ops.wm.stl_import(filepath=path),
}


@contextlib.contextmanager
def silence():
    """Importers print to the standard output, where rows go."""
    kept = os.dup(1)
    with open(os.devnull, "wb") as nowhere:
        os.dup2(nowhere.fileno(), 1)
        try:
            yield
        finally:
            os.dup2(kept, 1)
            os.close(kept)


def is_smooth(mesh):
    """Whether all corners at a vertex have one normal."""
    at = {}
    for loop in mesh.loops:
        normal = mesh.corner_normals[loop.index].vector
        if at.setdefault(loop.vertex_index, normal).dot(normal) < 0.9999:
            return False
    return True


def base_color(thing):
    for slot in thing.material_slots:
        for node in slot.material.node_tree.nodes:
            if node.type == "BSDF_PRINCIPLED":
                inputs = node.inputs
                return inputs["Base Color"].default_value[:3], inputs["Metallic"].default_value
    return None, None


def vertex_colors(mesh):
    """The linear colours of vertices, to the precision of bytes."""
    for layer in mesh.color_attributes:
        for point in layer.data:
            yield tuple(round(c, 2) for c in point.color[:3])


def check(path, kind, surfaces):
    with silence():
        bpy.ops.wm.read_factory_settings(use_empty=True)
        IMPORT[kind](path)
    found = [thing for thing in bpy.data.objects if thing.type == "MESH"]
    bpy.context.view_layer.update()
    faults = []
    if len(found) != (len(surfaces) if kind in common.APART else 1):
        faults.append(f"{len(found)} objects")
    if sum(len(thing.data.polygons) for thing in found) != common.total(surfaces, "triangles"):
        faults.append("triangles are missing")
    points = [thing.matrix_world @ v.co for thing in found for v in thing.data.vertices]
    for pick, ours in zip((min, max), common.bounds(surfaces)):
        corner = [pick(p[axis] for p in points) for axis in range(3)]
        if not common.is_near(corner, ours):
            faults.append(f"a corner at {corner} instead of {ours}")
    for thing in found:
        angles = [round(angle, 6) for angle in thing.matrix_world.to_euler()]
        # Blender turns what it takes for y-up by the object, but for glTF.
        if kind != "obj" and any(angles):
            faults.append(f"turned by {angles}")
        if kind != "stl" and not is_smooth(thing.data):
            faults.append(f"{thing.name} is not smooth")
    if kind in ("glb", "gltf"):
        by_name = {surface["name"]: surface for surface in surfaces}
        for thing in found:
            color, metallic = base_color(thing)
            surface = by_name.get(thing.name)
            if surface is None or not common.is_near(color, surface["color"]) or metallic != 0:
                faults.append(f"{thing.name} has the colour {color}")
            if "scene" not in thing:
                faults.append("no name of the scene")
    if kind in ("ply", "obj"):
        ours = {tuple(round(c, 2) for c in surface["color"]) for surface in surfaces}
        theirs = {color for thing in found for color in vertex_colors(thing.data)}
        if ours != theirs:
            faults.append(f"colours {theirs} instead of {ours}")
    return faults


common.each(sys.argv[1], f"Blender {bpy.app.version_string}", IMPORT, check)
