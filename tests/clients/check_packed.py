"""Checks a packed table against the one that it was made from: python check_packed.py PACKED.exr TABLE.exr

Needs numpy and OpenEXR. Prints the relative L2 distance of S below 73 degrees; exit code 1 above 20 %.
"""
import sys

import numpy as np
from read_packed import read_packed
from read_table import directions, read, solid_angles


def main(packed, plain):
    head, flux = read_packed(packed)
    _, bins = read(plain)
    n = head["vair:face"]
    names = sorted(k for k in bins[0][1] if k != "error")
    names = ["R", "G", "B"] if "R" in names else names
    theta = np.arcsin(directions(n)[..., 2])
    weight = solid_angles(n) * (np.abs(np.degrees(theta)) < 73) / np.cos(theta) ** 2
    apart = square = 0.0
    for found, (header, maps) in zip(flux, bins):
        at, low, high = (float(np.ravel(header[f"vair:theta_{k}deg"])[0]) for k in ("", "from_", "to_"))
        if abs(at) < 73:
            node = np.sin(np.radians(high)) - np.sin(np.radians(low))
            density = [f / solid_angles(n) for f in (found[0], maps[names[0]])]
            apart += node * (weight * (density[0] - density[1]) ** 2).sum()
            square += node * (weight * density[1] ** 2).sum()
    error = np.sqrt(apart / square)
    print(f"{names[0]}: {100 * error:.2f} %")
    return 0 if error < 0.2 else 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:3]))
