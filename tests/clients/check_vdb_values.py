"""Reads .vdb files by OpenVDB and compares every voxel, bit by bit, with the .raw file beside each.

check_vdb_values.py FILE.vdb ...   (what .raw holds: tests/raw/grids.rs). Also checks that what the
metadata say of the voxels is what the library counts.
"""
import struct
import sys

import numpy

try:
    import openvdb
except ImportError:
    import pyopenvdb as openvdb


class Raw:
    def __init__(self, path):
        self.data, self.at = open(path, "rb").read(), 0

    def take(self, dtype, count):
        values = numpy.frombuffer(self.data, dtype, count, self.at)
        self.at += values.nbytes
        return values

    def number(self):
        return int(self.take("<u4", 1)[0])


def same_bits(a, b):
    a, b = numpy.ascontiguousarray(a, "<f4"), numpy.ascontiguousarray(b, "<f4")
    # -0 and 0 are one value to the library, which stores only one of them for inactive voxels.
    return a.shape == b.shape and ((a.view("<u4") == b.view("<u4")) | ((a == 0) & (b == 0))).all()


def read_block(grid, origin, edge, components):
    shape = (edge,) * 3 + ((3,) if components == 3 else ())
    block = numpy.full(shape, numpy.nan, "<f4")
    grid.copyToArray(block, ijk=origin)
    return block


def activity(grid, origin):
    access = grid.getConstAccessor()
    places = numpy.ndindex(8, 8, 8)
    return [access.isValueOn(tuple(origin[k] + place[k] for k in range(3))) for place in places]


def check_grid(grid, raw, where):
    components = raw.number()
    background = raw.take("<f4", components)
    assert same_bits(numpy.atleast_1d(grid.background), background), f"{where}: background"
    active = 0
    leaves = raw.number()
    for _ in range(leaves):
        origin = tuple(int(v) for v in raw.take("<i4", 3))
        mask = numpy.unpackbits(raw.take("u1", 64), bitorder="little")
        values = raw.take("<f4", 512 * components)
        shape = (8, 8, 8) + ((3,) if components == 3 else ())
        block = read_block(grid, origin, 8, components)
        assert same_bits(block, values.reshape(shape)), f"{where}: values of the leaf at {origin}"
        assert activity(grid, origin) == [bool(b) for b in mask], f"{where}: activity at {origin}"
        active += int(mask.sum())
    for _ in range(raw.number()):
        origin = tuple(int(v) for v in raw.take("<i4", 3))
        edge, is_active = raw.number(), raw.number()
        value = raw.take("<f4", components)
        block = read_block(grid, origin, edge, components)
        assert same_bits(block, numpy.broadcast_to(value, block.shape[:3] + (components,)).reshape(block.shape)), f"{where}: tile at {origin}"
        assert grid.getConstAccessor().isValueOn(origin) == bool(is_active), f"{where}: tile at {origin}"
        active += is_active * edge**3
    assert grid.leafCount() == leaves, f"{where}: {grid.leafCount()} leaves, not {leaves}"
    assert grid.activeVoxelCount() == active, f"{where}: {grid.activeVoxelCount()} active, not {active}"
    # The voxels around all of this have the background.
    assert same_bits(numpy.atleast_1d(grid.getConstAccessor().getValue((100000, 3, 5))), background), where
    return active


def check_metadata(grid, where, half):
    data = grid.metadata
    assert data["is_saved_as_half_float"] == half, where
    assert data["file_voxel_count"] == grid.activeVoxelCount(), where
    if grid.activeVoxelCount():
        lo, hi = grid.evalActiveVoxelBoundingBox()
        assert tuple(data["file_bbox_min"]) == tuple(lo) and tuple(data["file_bbox_max"]) == tuple(hi), where
    share = data["file_mem_bytes"] / grid.memUsage()
    assert 0.9 < share < 1.1, f"{where}: file_mem_bytes is {share} of what the library uses"
    return f"{data['file_mem_bytes']} of {grid.memUsage()} bytes"


def main():
    for path in sys.argv[1:]:
        raw = Raw(path.removesuffix("vdb") + "raw")
        grids, _ = openvdb.readAll(path)
        grids = {grid.name: grid for grid in grids}
        count = 0
        while raw.at < len(raw.data):
            name = bytes(raw.take("u1", raw.number())).decode()
            voxel = float(raw.take("<f8", 1)[0])
            grid = grids.pop(name)
            count += check_grid(grid, raw, f"{path} {name}")
            share = check_metadata(grid, f"{path} {name}", "half" in path)
            print(f"  {name}: {grid.valueTypeName}, {grid.activeVoxelCount()} active, memory {share}")
            assert grid.transform.voxelSize()[0] == voxel, f"{path} {name}: voxel size"
        assert not grids, f"{path}: more grids than written: {sorted(grids)}"
        print(f"OK {path}: {count} active voxels, all values equal bit by bit")


main()
