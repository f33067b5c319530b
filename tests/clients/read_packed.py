"""Reads a packed scattering table with nothing but docs/table-format.md."""
import numpy as np
import OpenEXR
from read_table import directions, solid_angles


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


def from_cone(images, theta_node, n, folded):
    """Densities [image, face, v, u] of a node from images [image, row, column] aligned by its cone."""
    rows, columns = images.shape[1:]
    w = directions(3 * n)
    theta, phi = np.arcsin(w[..., 2]), np.arctan2(w[..., 1], w[..., 0])
    turn = np.abs(phi) / np.pi if folded else (phi / np.pi + 1) / 2
    y = ((theta + theta_node) / np.pi + 1) / 2 * rows - 0.5
    x = turn * columns - 0.5
    row, column = np.floor(y).astype(int), np.floor(x).astype(int)
    density = np.zeros((len(images), *theta.shape))
    for dy, dx in ((0, 0), (0, 1), (1, 0), (1, 1)):
        share = np.abs(1 - dy - (y - row)) * np.abs(1 - dx - (x - column))
        r = np.clip(row + dy, 0, rows - 1)
        c = np.clip(column + dx, 0, columns - 1) if folded else (column + dx) % columns
        density += share * images[:, r, c]
    density /= np.maximum(np.cos(theta), 1e-3)
    return density.reshape(-1, 6, n, 3, n, 3).mean(axis=(3, 5))


def read_packed(path):
    """Attributes and flux[node, channel, face, v, u] of a packed table."""
    parts = OpenEXR.File(path, separate_channels=True).parts
    head = parts[0].header
    pixels = {p.header["name"]: p.channels.get("Y") for p in parts[1:]}
    albedo, mix, trees, values = (pixels[k].pixels for k in ("albedo", "mix", "trees", "values"))
    if head["vair:format"] != 2:
        raise ValueError(f"{path} is not packed")
    n, nodes, images, folded = (head[f"vair:{k}"] for k in ("face", "bins", "images", "folded"))
    bits = np.unpackbits(trees.ravel().astype("<u4").view(np.uint8), bitorder="little")
    bits, values = bits[: head["vair:bits"]], values.ravel()
    if head["vair:aligned"]:
        rows, columns = 4 * n, 2 * n if folded else 4 * n
        tiles = expand(bits, values, images * rows // columns, columns).reshape(images, rows, columns)
        theta = np.radians(np.array(head["vair:theta_deg"].split(), dtype=float))
        mix = mix.reshape(nodes, -1, images)
        density = [np.tensordot(m, from_cone(tiles, t, n, folded), 1) for m, t in zip(mix, theta)]
    else:
        faces = 3 if folded else 6
        tiles = expand(bits, values, nodes * images * faces, n).reshape(nodes, images, faces, n, n)
        density = np.einsum("ck,jkfvu->jcfvu", mix.reshape(-1, images), tiles)
        if folded:
            density = [[unfold(channel) for channel in node] for node in density]
    flux = np.maximum(density, 0) * solid_angles(n)
    flux *= (albedo / flux.sum(axis=(2, 3, 4)))[..., None, None, None]
    return head, flux
