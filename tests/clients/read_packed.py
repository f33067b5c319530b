"""Reads a packed scattering table with nothing but docs/table-format.md."""
import numpy as np
import OpenEXR
from read_table import solid_angles


def expand(bits, values, tiles, side):
    """Tiles [tile, row, column] of depth-first quadtrees: 1 splits, 0 and single texels take a value."""
    out, bit, value = np.zeros((tiles, side, side)), iter(bits), iter(values)

    def square(tile, y, x, size):
        if size > 1 and next(bit):
            half = size // 2
            for dy, dx in ((0, 0), (0, half), (half, 0), (half, half)):
                square(tile, y + dy, x + dx, half)
        else:
            tile[y : y + size, x : x + size] = next(value)

    for tile in out:
        square(tile, 0, 0, side)
    return out


def unfold(t):
    """All six faces from the half y > 0, which three tiles hold."""
    h = t.shape[1] // 2
    x, y, z = t
    halves = [x[:, :h], x[:, h:]]
    sides = [np.concatenate([half[:, ::-1], half], axis=1) for half in halves]
    caps = [np.concatenate([half[::-1], half]) for half in (z[:h], z[h:])]
    return np.stack([*sides, y, y, *caps])


def read_packed(path):
    """Attributes and flux[node, channel, face, v, u] of a table that was packed without --rank."""
    parts = OpenEXR.File(path, separate_channels=True).parts
    head = parts[0].header
    pixels = {p.header["name"]: p.channels.get("Y") for p in parts[1:]}
    albedo, mix, trees, values = (pixels[k].pixels for k in ("albedo", "mix", "trees", "values"))
    if head["vair:format"] != 2 or head["vair:aligned"]:
        raise ValueError(f"{path} is not packed, or packed with --rank")
    n, nodes, images = head["vair:face"], head["vair:bins"], head["vair:images"]
    bits = np.unpackbits(trees.ravel().astype("<u4").view(np.uint8), bitorder="little")
    faces = 3 if head["vair:folded"] else 6
    tiles = expand(bits[: head["vair:bits"]], values.ravel(), nodes * images * faces, n)
    tiles = tiles.reshape(nodes, images, faces, n, n)
    density = np.einsum("ck,jkfvu->jcfvu", mix.reshape(-1, images), tiles)
    if head["vair:folded"]:
        density = np.array([[unfold(channel) for channel in node] for node in density])
    flux = np.maximum(density, 0) * solid_angles(n)
    flux *= (albedo / flux.sum(axis=(2, 3, 4)))[..., None, None, None]
    return head, flux
