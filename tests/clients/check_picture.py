"""Reads all passes of a rendered picture with Python's OpenEXR: check_picture.py PICTURE.exr SPP GROOM.usdc

Names, types and ranges; and with the groom that was rendered, exported and read by Pixar's USD, that ids and
roots are those of its strands and depths within its bounds.
"""
import json
import sys

import numpy as np
import OpenEXR
from pxr import Usd, UsdGeom

NONE = 0xFFFFFFFF
FLOAT = ["R", "G", "B", "A", "Z", "root.U", "root.V", "variance.Y"]
HALF = [f"{name}.{axis}" for name, axes in (("albedo", "RGB"), ("normal", "XYZ"), ("tangent", "XYZ")) for axis in axes]
WHOLE = ["strand.id", "samples"]


def check(path, spp, groom):
    with OpenEXR.File(path, separate_channels=True) as file:
        header = dict(file.header())  # emptied when the file closes
        c = {name: channel.pixels for name, channel in file.channels().items()}
    for names, kind in ((FLOAT, "f4"), (HALF, "f2"), (WHOLE, "u4")):
        for name in names:
            assert name in c, f"no channel {name}, only {sorted(c)}"
            assert c[name].dtype == np.dtype(kind), f"{name} is {c[name].dtype}"
    extra = [name for name in c if name not in FLOAT + HALF + WHOLE and not name.startswith("Crypto")]
    assert not extra, f"unknown channels {extra}"
    provenance = json.loads(header["vair:provenance"])
    assert {"program", "species", "species_text", "settings", "seed"} <= set(provenance), sorted(provenance)

    alpha = c["A"].astype(float)
    on, full = alpha > 0, alpha == 1
    assert full.sum() > 100, "the subject is missing"
    assert ((0 <= alpha) & (alpha <= 1)).all() and np.abs(alpha * spp - np.round(alpha * spp)).max() < 1e-3
    beauty = np.stack([c[x].astype(float) for x in "RGB"])
    assert np.isfinite(beauty).all() and (beauty >= 0).all(), "radiance is negative or not finite"
    mean = beauty[1][full].mean()
    assert 0.001 < mean < 20, f"the subject is black or blown: {mean}"
    assert (c["samples"] == spp).all(), f"samples are {np.unique(c['samples'])}"
    assert np.isfinite(c["variance.Y"]).all() and (c["variance.Y"] >= 0).all() and c["variance.Y"][full].mean() > 0

    def vector(name):
        return np.stack([c[f"{name}.{x}"].astype(float) for x in ("RGB" if name == "albedo" else "XYZ")])

    assert (vector("albedo") >= 0).all() and (vector("albedo") <= 1.001).all()
    assert (vector("albedo").sum(0)[on] > 0).all(), "black albedo on the subject"
    hair = c["strand.id"] != NONE
    for name, where in (("normal", full), ("tangent", full & hair)):
        length = np.linalg.norm(vector(name), axis=0)
        assert (length <= 1.002).all(), f"{name} is {length.max()} long"
        assert (length[~on] == 0).all()
        # A mean of unit vectors that differ is shorter, but where one surface is seen it is not.
        assert np.percentile(length[where], 95) > 0.9, f"{name} is {np.percentile(length[where], 95)} long"
    across = (vector("normal") * vector("tangent")).sum(0)[full & hair]
    assert np.abs(across).mean() < 0.2, f"normals lean along the strands: {np.abs(across).mean()}"

    assert (np.isfinite(c["Z"]) == on).all() and (c["Z"][on] > 0).all()
    assert (on | ~hair).all(), "strands where there is no subject"
    for name in ("root.U", "root.V"):
        assert ((0 <= c[name]) & (c[name] <= 1)).all() and (c[name][~hair] == 0).all()
    points, roots = strands_of(groom)
    seen = np.unique(c["strand.id"][hair])
    assert len(seen) > 100 and all(int(number) in roots for number in seen), "an id that no strand has"
    uv = np.stack([c["root.U"][hair], c["root.V"][hair]], 1)
    roots_seen = np.array([roots[int(number)] for number in c["strand.id"][hair]])
    assert (uv == roots_seen).all(), "a root is not that of its strand"
    # The camera is outside: depths differ by no more than the groom is large.
    size = 1000 * np.linalg.norm(points.max(0) - points.min(0))
    depth = c["Z"][hair].astype(float)
    assert 0.05 * size < np.ptp(depth) < size, f"depths spread over {np.ptp(depth)} mm, the groom is {size} mm"
    return f"{on.mean():.2f} of the picture, {len(seen)} of {len(roots)} strands"


def strands_of(path):
    """Points of all strands in meters, and the texture coordinates of the root of each id."""
    points, roots = [], {}
    stage = Usd.Stage.Open(path)
    for prim in stage.Traverse():
        if prim.IsA(UsdGeom.BasisCurves) and "/geo/render/" in str(prim.GetPath()):
            points.append(np.array(UsdGeom.Curves(prim).GetPointsAttr().Get()))
            value = lambda name: np.array(prim.GetAttribute(f"primvars:{name}").Get())
            ids = value("curve_id").astype(np.uint32)
            roots.update(zip(map(int, ids), value("groom_root_uv")))
    return np.concatenate(points).astype(float), roots


def main():
    try:
        print(f"OK {sys.argv[1]}: {check(sys.argv[1], int(sys.argv[2]), sys.argv[3])}")
    except AssertionError as fault:
        sys.exit(f"FAIL {sys.argv[1]}: {fault}")


main()
