"""Reads a scattering table with nothing but the formulas of docs/table-format.md."""
import numpy as np
import OpenEXR


def unwarp(s):
    """Plane coordinate of a texture coordinate, both in [-1, 1]."""
    return np.sqrt(2) * np.sin(np.pi * s / 6) / np.sqrt(np.cos(np.pi * s / 3))


def solid_angles(n):
    """Steradians of the n x n texels of one face, [v, u]; all faces are alike."""
    x = unwarp(np.linspace(-1, 1, n + 1))
    y = x[:, None]
    return np.diff(np.diff(np.arctan2(x * y, np.sqrt(1 + x * x + y * y)), axis=0), axis=1)


def directions(n):
    """Unit vectors through the texel centers, [face, v, u, xyz]; z is the fiber, root to tip."""
    v, u = np.meshgrid(*[unwarp((np.arange(n) + 0.5) * 2 / n - 1)] * 2, indexing="ij")
    one = np.ones_like(u)
    faces = [(one, u, v), (-one, u, v), (u, one, v), (u, -one, v), (u, v, one), (u, v, -one)]
    w = np.stack([np.stack(face, axis=-1) for face in faces])
    return w / np.linalg.norm(w, axis=-1, keepdims=True)


def read(path):
    """Attributes of the table and, per bin, its attributes and {channel: flux[face, v, u]}."""
    parts = OpenEXR.File(path, separate_channels=True).parts
    n = parts[0].header["vair:face"]
    cube = lambda part: {k: c.pixels.reshape(6, n, n) for k, c in part.channels.items()}
    return parts[0].header, [(part.header, cube(part)) for part in parts]
