"""Zeroset and VTK's vtkFlyingEdges3D at the same isosurfaces, with one thread each; the table is for
BENCHMARKS.md.

    just bench-volumes

Needs a Python with NumPy and VTK (`pip install numpy vtk`). Four models of A. Leon Salas, 2008, are
sampled here; ZEROSET_DATA names a folder whose `volumes` hold scans, as raw samples packed with xz, and
without it these are left out. Both programs read the same bytes, and take turns.
"""

import json
import lzma
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import vtk
from vtk.util import numpy_support

ROOT = Path(__file__).resolve().parent.parent
PROGRAM = ROOT / "target/release/examples/isosurfaces"
ISOVALUE = 60
ROUNDS = 5
SIZES = [256, 512]

# What lies at radii up to 1 is solid, and its density 255 (1 - r).
MODELS = {
    "esfera": lambda x, y, z: np.sqrt(x**2 + y**2 + z**2),
    "tronco": lambda x, y, z: np.sqrt(x**2 + 2 * y * z),
    "silla": lambda x, y, z: np.sin(x * z) + y + np.cos(x * z),
    "jarrón": lambda x, y, z: x * np.sin(x) + y * np.cos(y) + z * np.sin(z),
}
SCANS = ["aneurism_256x256x256_uint8", "bonsai_256x256x256_uint8"]


def sampled(radius, n):
    """The densities of a model in the cube from -1 to 1, at the middles of n x n x n voxels."""
    middles = (np.arange(n) + 0.5) * 2 / n - 1
    samples = np.zeros((n, n, n), np.uint8)
    y, x = np.meshgrid(middles, middles, indexing="ij")
    with np.errstate(invalid="ignore"):
        for k, z in enumerate(middles):
            r = radius(x, y, np.full_like(x, z))
            density = np.clip(np.floor(255 * (1 - r)), 0, 255)
            # Where the radius is undefined there is nothing.
            samples[k] = np.where(r <= 1, density, 0).astype(np.uint8)
    return samples


def volumes():
    """Names, and samples with z first."""
    for name, radius in MODELS.items():
        for n in SIZES:
            yield f"{name}, {n}³", sampled(radius, n)
    data = os.environ.get("ZEROSET_DATA")
    if data is None:
        print("ZEROSET_DATA is not set: scans are left out", file=sys.stderr)
        return
    for scan in SCANS:
        packed = Path(data, "volumes", f"{scan}.raw.xz")
        size = [int(n) for n in scan.split("_")[1].split("x")]
        samples = np.frombuffer(lzma.decompress(packed.read_bytes()), np.uint8)
        yield f"{scan.split('_')[0]}, {size[0]}³", samples.reshape(size[::-1])


class Vtk:
    def __init__(self, samples):
        self.image = vtk.vtkImageData()
        self.image.SetDimensions(samples.shape[::-1])
        self.samples = samples
        scalars = numpy_support.numpy_to_vtk(samples.ravel(), deep=0)
        self.image.GetPointData().SetScalars(scalars)

    def round(self):
        """Milliseconds, and triangles."""
        edges = vtk.vtkFlyingEdges3D()
        edges.SetInputData(self.image)
        edges.SetValue(0, ISOVALUE)
        edges.ComputeNormalsOff()
        edges.ComputeGradientsOff()
        edges.ComputeScalarsOff()
        start = time.perf_counter()
        edges.Update()
        elapsed = 1e3 * (time.perf_counter() - start)
        return elapsed, edges.GetOutput().GetNumberOfPolys()


class Zeroset:
    def __init__(self, path):
        command = [PROGRAM, path, str(ISOVALUE)]
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
        self.process = subprocess.Popen(command, text=True, **pipes)

    def round(self):
        print(file=self.process.stdin, flush=True)
        return json.loads(self.process.stdout.readline())

    def close(self):
        self.process.stdin.close()
        self.process.wait()


def row(name, samples, folder):
    """A line of the table."""
    size = "x".join(str(n) for n in samples.shape[::-1])
    path = Path(folder, f"volume_{size}_uint8.raw")
    samples.tofile(path)
    theirs, ours = Vtk(samples), Zeroset(path)
    times = {"vtk": [], "build": [], "bricks": [], "extraction": []}
    for i in range(ROUNDS + 1):
        # Both fetch their memory first.
        is_timed = i > 0
        elapsed, n_theirs = theirs.round()
        answer = ours.round()
        if is_timed:
            times["vtk"].append(elapsed)
            for step in ["build", "bricks", "extraction"]:
                times[step].append(answer[step])
    ours.close()
    median = {step: statistics.median(values) for step, values in times.items()}
    found = median["bricks"] + median["extraction"]
    cells = [short(median[step]) for step in times]
    cells += [f"{median['vtk'] / t:.2f}" for t in [found, median["build"] + found]]
    cells += [f"{n:,}" for n in [n_theirs, answer["triangles"]]]
    return f"| {name} | {' | '.join(cells)} |"


def short(v):
    return f"{v:.0f}" if v >= 100 else f"{v:.1f}"


def main():
    command = ["cargo", "build", "--release", "--example", "isosurfaces"]
    subprocess.run(command, cwd=ROOT, check=True)
    vtk.vtkSMPTools.SetBackend("Sequential")
    print(
        "| volume | VTK, ms | Zeroset, build, ms | bricks, ms | extraction, ms "
        "| VTK / (bricks + extraction) | VTK / all | triangles, VTK | triangles, Zeroset |\n"
        "|---|---|---|---|---|---|---|---|---|"
    )
    with tempfile.TemporaryDirectory() as folder:
        for name, samples in volumes():
            print(row(name, samples, folder), flush=True)


if __name__ == "__main__":
    main()
