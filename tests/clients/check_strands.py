"""Reads one groom in all plain formats and compares them: check_strands.py STEM

STEM.npz by numpy, STEM.ply by plyfile, STEM.glb by pygltflib, STEM.hair by the layout that its author
published; all have the same points.
"""
import sys

import numpy as np
import plyfile
import pygltflib


def read_hair(path):
    data = open(path, "rb").read()
    assert data[:4] == b"HAIR"
    strands, points, flags, segments = np.frombuffer(data, "<u4", 4, 4)
    at = 128
    if flags & 1:
        segments = np.frombuffer(data, "<u2", strands, at)
        at += 2 * strands
    offsets = np.concatenate([[0], np.cumsum(segments.astype(int) + 1)])
    xyz = np.frombuffer(data, "<f4", 3 * points, at).reshape(-1, 3)
    at += 12 * points
    thickness = np.frombuffer(data, "<f4", points, at)
    at += 4 * points + (4 * points if flags & 8 else 0)
    colors = np.frombuffer(data, "<f4", 3 * points, at).reshape(-1, 3)
    assert at + 12 * points == len(data)
    return offsets, xyz, thickness, colors


def srgb(linear):
    linear = np.clip(linear, 0, 1)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


def main():
    stem = sys.argv[1]
    npz = np.load(stem + ".npz")
    points, widths, offsets, colors = (npz[k] for k in ("points", "widths", "offsets", "colors"))
    assert offsets[0] == 0 and offsets[-1] == len(points) == len(widths) == len(colors)

    o, p, w, c = read_hair(stem + ".hair")
    assert (o == offsets).all() and (p == points).all() and (w == widths).all() and (c == colors).all()

    ply = plyfile.PlyData.read(stem + ".ply")["vertex"]
    assert (np.stack([ply["x"], ply["y"], ply["z"]], 1) == points).all() and (ply["width"] == widths).all()
    assert (ply["strand"] == np.repeat(np.arange(len(offsets) - 1), np.diff(offsets.astype(int)))).all()
    red = np.round(255 * srgb(colors[:, 0].astype(float)))
    assert np.abs(ply["red"] - red).max() <= 1

    gltf = pygltflib.GLTF2().load(stem + ".glb")
    blob = gltf.binary_blob()
    primitive = gltf.meshes[0].primitives[0]

    def array(index, dtype, width):
        accessor = gltf.accessors[index]
        view = gltf.bufferViews[accessor.bufferView]
        return np.frombuffer(blob, dtype, accessor.count * width, view.byteOffset).reshape(-1, width)

    assert (array(primitive.attributes.POSITION, "<f4", 3) == points).all()
    pairs = array(primitive.indices, "<u4", 1).reshape(-1, 2)
    first = np.delete(np.arange(len(points)), offsets[1:] - 1)
    assert (pairs == np.stack([first, first + 1], 1)).all()
    assert (array(primitive.attributes.COLOR_0, "<f4", 3) == np.clip(colors, 0, 1)).all()
    print(f"OK {stem}: {len(offsets) - 1} strands of {len(points)} points are the same in .npz, .hair, .ply and .glb")


main()
