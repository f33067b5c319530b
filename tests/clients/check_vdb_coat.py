"""Holds the grids of a coat against its strands: check_vdb_coat.py GRIDS.vdb STRANDS.npz

Reads the grids by OpenVDB and the strands, exported by the same command, by numpy: their area and volume
are integrated along the curves here, not by the program that wrote the grids.
"""
import sys

import numpy as np

try:
    import openvdb
except ImportError:
    import pyopenvdb as openvdb

CLASSES = {"density": "fog volume", "fraction": "fog volume", "surface": "level set"}


def spline(points, offsets, steps):
    """Points of all Catmull-Rom spans at the parameters in `steps`, ends pinned by reflection."""
    first = np.delete(np.arange(len(points)), offsets[1:] - 1)
    ends = np.zeros(len(points), bool)
    ends[offsets[:-1]] = True
    b, c = points[first], points[first + 1]
    a = np.where(ends[first][:, None], 2 * b - c, points[np.maximum(first - 1, 0)])
    last = np.isin(first + 2, offsets[1:])
    d = np.where(last[:, None], 2 * c - b, points[np.minimum(first + 2, len(points) - 1)])
    t = np.asarray(steps)[:, None, None]
    h = 0.5 * (2 * b + (c - a) * t + (2 * a - 5 * b + 4 * c - d) * t**2 + (3 * b - a - 3 * c + d) * t**3)
    return h, first


def strand_sums(strands):
    points, widths = strands["points"].astype(float), strands["widths"].astype(float)
    steps = np.linspace(0, 1, 33)
    h, first = spline(points, strands["offsets"].astype(int), steps)
    pieces = np.linalg.norm(np.diff(h, axis=0), axis=2)
    w = widths[first] + (widths[first + 1] - widths[first]) * steps[:, None]
    middle = 0.5 * (w[1:] + w[:-1])
    return (pieces * middle).sum(), (pieces * np.pi / 4 * middle**2).sum(), h


def main():
    strands = np.load(sys.argv[2])
    grids = {grid.name: grid for grid in openvdb.readAll(sys.argv[1])[0]}
    area, volume, curve = strand_sums(strands)
    for name, grid in grids.items():
        assert grid.metadata["class"] == CLASSES.get(name, "unknown"), (name, grid.metadata["class"])
        assert grid.metadata["file_voxel_count"] == grid.activeVoxelCount() > 0, name
    voxel = grids["density"].transform.voxelSize()[0]
    assert all(abs(g.transform.voxelSize()[0] / voxel - 1) < 1e-12 for g in grids.values())

    def total(name):
        values = [item.value for item in grids[name].citerOnValues()]
        assert min(values) >= 0, f"{name} has negative values"
        return float(np.sum(values, dtype=float)) * voxel**3

    share = total("density") / area
    assert abs(share - 1) < 2e-3, f"density holds {share} of the strands' area"
    line = f"area {share:.6f}"
    if "fraction" in grids:
        share = total("fraction") / volume
        assert abs(share - 1) < 3e-3, f"fraction holds {share} of the strands' volume"
        line += f", volume {share:.6f}"
    # Every voxel that a curve passes through is active, and none lies away from all curves.
    density = grids["density"].getConstAccessor()
    sample = curve[::8].reshape(-1, 3)[:: max(1, curve.shape[1] // 4000)]
    places = np.floor(sample / voxel + 0.5).astype(int)
    missed = sum(not density.isValueOn(tuple(int(c) for c in p)) for p in places)
    assert missed <= 1e-3 * len(places), f"{missed} of {len(places)} places on strands are not in the grid"
    for item in grids["tangent"].citerOnValues() if "tangent" in grids else []:
        assert sum(c * c for c in item.value) <= 1.00001, "a mean direction is longer than 1"
    if "surface" in grids:
        # Roots lie on the skin, most tips above it.
        surface = grids["surface"].getConstAccessor()
        offsets = strands["offsets"].astype(int)

        def at(points):
            places = np.floor(points / voxel + 0.5).astype(int)
            return np.array([surface.getValue(tuple(int(c) for c in p)) for p in places])

        roots = at(strands["points"][offsets[:-1]][:2000])
        assert np.abs(roots).max() < voxel, f"a root is {np.abs(roots).max()} m from the skin"
        inside = (at(strands["points"][offsets[1:] - 1][:2000]) < 0).mean()
        assert inside < 0.1, f"{inside} of the tips are inside the skin"
        line += f", roots within {np.abs(roots).max() / voxel:.2f} voxels of the skin, {inside:.3f} of tips inside"
    print(f"OK {sys.argv[1]}: {line}")


main()
