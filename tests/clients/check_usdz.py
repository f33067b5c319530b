"""Pixar's library reads a proxy: check_usdz.py PROXY.usdz ASSET.usdc

Both were exported by one command. The archive is one that can be mapped into memory, Pixar's checker finds
nothing, with its rules for phones, and the one mesh in it lies between the skin and the ends of the hairs
of ASSET and has the colors of their coat.
"""

import struct
import sys
import zipfile

import numpy as np
from pxr import Usd, UsdGeom, UsdUtils


def fail(message):
    print(f"FAIL {message}")
    sys.exit(1)


def check_archive(path):
    with zipfile.ZipFile(path) as archive, open(path, "rb") as file:
        if archive.testzip():
            fail(f"{path}: a checksum is wrong")
        for member in archive.infolist():
            file.seek(member.header_offset + 26)
            name, extra = struct.unpack("<HH", file.read(4))
            at = member.header_offset + 30 + name + extra
            if member.compress_type != zipfile.ZIP_STORED or at % 64:
                fail(f"{path}: {member.filename} is packed, or begins at {at}, no multiple of 64")
        return archive.namelist()


def values(prim, name):
    return np.array(prim.GetAttribute(name).Get())


def main(path, asset):
    names = check_archive(path)
    checker = UsdUtils.ComplianceChecker(arkit=True)
    checker.CheckCompliance(path)
    for message in checker.GetErrors() + checker.GetFailedChecks() + checker.GetWarnings():
        fail(f"{path}: {message}")
    stage = Usd.Stage.Open(path)
    shown = [prim for prim in stage.Traverse() if prim.IsA(UsdGeom.Boundable)]
    if [prim.GetTypeName() for prim in shown] != ["Mesh"]:
        fail(f"{path}: there should be one mesh, not {shown}")
    mesh = shown[0]
    points, colors = values(mesh, "points"), values(mesh, "primvars:displayColor")
    corners = values(mesh, "faceVertexIndices")
    if len(colors) != len(points) or len(values(mesh, "primvars:st")) != len(corners):
        fail(f"{path}: {len(colors)} colors for {len(points)} points")
    whole = Usd.Stage.Open(asset)
    curves = [p for p in whole.Traverse() if p.IsA(UsdGeom.BasisCurves) and "/render/" in str(p.GetPath())]
    ends = np.concatenate([values(p, "points") for p in curves])
    skin = next(p for p in whole.Traverse() if p.IsA(UsdGeom.Mesh))
    inner = values(skin, "points")
    slack = 1e-3 * (inner.max(0) - inner.min(0)).max()
    outer = [np.minimum(ends.min(0), inner.min(0)), np.maximum(ends.max(0), inner.max(0))]
    if (points.min(0) < outer[0] - slack).any() or (points.max(0) > outer[1] + slack).any():
        fail(f"{path}: the mesh goes beyond the hairs")
    size = [np.ptp(p, 0) for p in (inner, points)]
    if not (size[1] >= size[0] - slack).all():
        fail(f"{path}: {size[1]} is smaller than the skin, {size[0]}")
    coat = np.concatenate([values(p, "primvars:displayColor") for p in curves])
    off = np.abs(colors.mean(0) - coat.mean(0)).max()
    if off > 0.1:
        fail(f"{path}: mean color {colors.mean(0)}, that of the strands is {coat.mean(0)}")
    print(f"OK {path}: {', '.join(names)}; {len(points)} points, mean color off by {off:.3f}, {size[1]} for a skin of {size[0]} m")


main(*sys.argv[1:])
