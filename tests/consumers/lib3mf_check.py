"""lib3mf, the 3MF Consortium's own: read strictly, without a warning, with its units and types."""

import importlib.metadata
import sys

import lib3mf
from lib3mf import get_wrapper

import common


def check(path, kind, surfaces):
    wrapper = get_wrapper()
    model = wrapper.CreateModel()
    reader = model.QueryReader("3mf")
    reader.SetStrictModeActive(True)
    reader.ReadFromFile(path)
    faults = [reader.GetWarning(i)[1] for i in range(reader.GetWarningCount())]
    if model.GetUnit() != lib3mf.ModelUnit.MilliMeter:
        faults.append(f"lengths are {model.GetUnit()}")
    objects = model.GetMeshObjects()
    found = []
    while objects.MoveNext():
        thing = objects.GetCurrentMeshObject()
        found.append(
            {
                "name": thing.GetName(),
                "vertices": thing.GetVertexCount(),
                "triangles": thing.GetTriangleCount(),
                "closed": thing.IsManifoldAndOriented(),
            }
        )
        if not thing.IsValid():
            faults.append(f"{thing.GetName()} is not valid")
    ours = [{key: surface[key] for key in found[0]} for surface in surfaces]
    if found != ours:
        faults.append(f"{found} instead of {ours}")
    return faults


common.each(sys.argv[1], f"lib3mf {importlib.metadata.version('lib3mf')}", ["3mf"], check)
