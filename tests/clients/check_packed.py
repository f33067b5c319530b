"""Checks a packed table against the one that it was made from: python check_packed.py PACKED.exr TABLE.exr SAID.json

SAID is what `vair table pack --json` said. Needs numpy and OpenEXR. Prints the relative L2 distance of S
below 73 degrees; exit code 1 if that is not what was said.
"""
import json
import sys

import numpy as np
from read_packed import read_packed
from read_table import directions, read, solid_angles


def main(packed, plain, said):
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
    with open(said) as file:
        expected = json.load(file)["channels"][0]["against_input"]["error"]
    agrees = abs(error - expected) < 1e-3
    print("OK" if agrees else "FAIL", f"{packed}: {names[0]} {100 * error:.2f} %, said {100 * expected:.2f} %")
    return 0 if agrees else 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:4]))
