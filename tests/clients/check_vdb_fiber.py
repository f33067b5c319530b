"""Holds the grids of a fiber against what the program says of it: check_vdb_fiber.py GRIDS.vdb SUMMARY.json"""
import json
import sys

import numpy as np

try:
    import openvdb
except ImportError:
    import pyopenvdb as openvdb


def main():
    grids = {grid.name: grid for grid in openvdb.readAll(sys.argv[1])[0]}
    summary = json.load(open(sys.argv[2]))
    voxel = grids["ior"].transform.voxelSize()[0]

    def values(name):
        grid = grids[name]
        lo, hi = grid.evalActiveVoxelBoundingBox()
        shape = [b - a + 1 for a, b in zip(lo, hi)]
        block = np.zeros(shape + ([3] if grid.valueTypeName == "vec3s" else []), "f4")
        grid.copyToArray(block, ijk=lo)
        return block

    ior, density, medulla, absorption = (values(n) for n in ("ior", "density", "medulla", "absorption"))
    inside = ior != grids["ior"].background
    # Voids may have the index of the surroundings; they are in the medulla.
    inside |= medulla > 0
    layers = ior.shape[2]
    assert abs(layers * voxel / summary["period_um"] - 1) < 1e-6, (layers * voxel, summary["period_um"])
    a, b = summary["semi_axes_um"]
    area = inside.sum() * voxel**2 / layers
    assert abs(area / (np.pi * a * b) - 1) < 0.05, f"the section is {area} um2, an ellipse of its axes {np.pi * a * b}"
    width, height = (np.ptp(np.nonzero(inside.any(axis=(1 - k, 2)))[0]) + 1 for k in range(2))
    assert abs(width * voxel / (2 * a) - 1) < 0.08 and abs(height * voxel / (2 * b) - 1) < 0.08
    indices = sorted(set(np.unique(ior[inside]).tolist()))
    assert all(1 <= i < 2.5 for i in indices), indices
    assert (density[inside & (medulla == 0)] == 1).all() and density[~inside].max(initial=0) == 0
    assert (absorption[inside & (medulla == 0)].min(axis=-1) >= 0).all() and absorption[~inside].max(initial=0) == 0
    # The share of the medulla that is air, over the whole section.
    told = summary["medulla"]["air_fraction"] * summary["medulla"]["ratio"] ** 2
    found = medulla[inside].mean()
    assert told == 0 or abs(found / told - 1) < 0.03, f"voids fill {found} of the fiber, not {told}"
    print(f"OK {sys.argv[1]}: {inside.sum()} voxels of {voxel:.4f} um, section {area / (np.pi * a * b):.4f} of the ellipse, indices {indices}, voids {found:.4f} of the fiber, {told:.4f} as told")


main()
