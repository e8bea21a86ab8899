"""assimp: every triangle arrives, in its place."""

import re
import subprocess
import sys

import common


def check(path, kind, surfaces):
    run = subprocess.run(["assimp", "info", path, "-r"], capture_output=True, text=True)
    if run.returncode != 0:
        return [(run.stdout + run.stderr).strip().splitlines()[-1]]
    faults = [line for line in run.stdout.splitlines() if re.match("error|warn", line, re.I)]
    found = {name: int(n) for name, n in re.findall(r"^(\w+):\s+(\d+)\b", run.stdout, re.M)}
    if found.get("Faces") != common.total(surfaces, "triangles"):
        faults.append(f"{found.get('Faces')} triangles")
    n_meshes = len(surfaces) if kind in common.APART else 1
    if found.get("Meshes") != n_meshes:
        faults.append(f"{found.get('Meshes')} meshes")
    corner = [
        [float(x) for x in re.findall(r"-?\d[\d.e+-]*", line)[-3:]]
        for line in run.stdout.splitlines()
        if re.match(r"(Minimum|Maximum) point", line)
    ]
    if len(corner) == 2 and kind in common.Y_UP:
        corner = common.z_up(*corner)
    for is_at, ours in zip(corner, common.bounds(surfaces)):
        if not common.is_near(is_at, ours, 1e-5):
            faults.append(f"a corner at {list(is_at)} instead of {ours}")
    return faults


common.each(sys.argv[1], "assimp", common.KINDS, check)
