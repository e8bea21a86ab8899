"""What the files should hold, and how outcomes are told."""

import json
import math
import os

KINDS = ["glb", "gltf", "obj", "ply", "stl", "3mf"]
# Formats in which y points up; the others are z-up, as scenes are.
Y_UP = {"glb", "gltf", "obj"}
# Formats that keep surfaces apart.
APART = {"glb", "gltf", "obj", "3mf"}


def scenes(folder):
    with open(os.path.join(folder, "expected.json"), encoding="utf-8") as file:
        return json.load(file)


def bounds(surfaces):
    """The box around all of them."""
    low = [min(s["min"][axis] for s in surfaces) for axis in range(3)]
    high = [max(s["max"][axis] for s in surfaces) for axis in range(3)]
    return low, high


def z_up(low, high):
    """A box of a y-up file as it stands in the scene."""
    return [low[0], -high[2], low[1]], [high[0], -low[2], high[1]]


def is_near(a, b, slack=2e-6):
    return all(math.isclose(x, y, rel_tol=slack, abs_tol=slack) for x, y in zip(a, b))


def total(surfaces, key):
    return sum(s[key] for s in surfaces)


def is_closed(surfaces):
    return all(s["closed"] for s in surfaces)


def row(tool, name, faults, more="ok"):
    print(tool, name, f"FAULT: {'; '.join(faults)}" if faults else more, sep="\t", flush=True)


def each(folder, tool, kinds, check):
    """Checks every scene in every kind; what a check raises is a fault, and None is no answer."""
    for expected in scenes(folder):
        for kind in kinds:
            name = f"{expected['scene']}.{kind}"
            try:
                faults = check(os.path.join(folder, name), kind, expected["surfaces"])
            except Exception as error:  # whatever a library throws
                faults = [f"{type(error).__name__}: {error}".replace("\n", " ")]
            if faults is not None:
                row(tool, name, faults)
