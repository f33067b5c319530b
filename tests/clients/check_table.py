"""Checks a scattering table as a stranger would: python check_table.py TABLE.exr

Needs numpy and OpenEXR. Prints OK or what is wrong; exit code 0 or 1.
"""
import sys

import numpy as np
from read_azimuths import azimuths as bracket
from read_table import directions, read, solid_angles

UNITS_PER_PHOTON = 2**32
LEDGER = ("emitted", "escaped", "absorbed", "truncated", "lost")


def integers(header, name):
    return [int(word) for word in header["vair:" + name].split()]


def floats(header, name):
    return np.array(header["vair:" + name].split(), dtype=float)


def number(header, name):
    return float(np.ravel(header["vair:" + name])[0])


def check_azimuth(head, header, azimuth):
    """The bounds of a bin of azimuth: even over what symmetry leaves."""
    ranges = {"both-axes": (0, 90), "minor-axis": (-90, 90), "none": (0, 360)}
    start, end = ranges[head["vair:symmetry"]]
    width = (end - start) / head["vair:azimuths"]
    expected = start + width * (azimuth + np.array([0, 0.5, 1]))
    names = ("azimuth_from_deg", "azimuth_deg", "azimuth_to_deg")
    found = np.array([number(header, name) for name in names])
    if abs(found - expected).max() > 1e-9:
        yield f"{header['name']}: azimuth {found}, not {expected}"
    # Its middle is read from it alone, and so is every azimuth that is the same.
    middle = expected[1]
    same = {
        "both-axes": [(middle, False), (-middle, True), (180 - middle, True), (180 + middle, False)],
        "minor-axis": [(middle, False), (180 - middle, True)],
        "none": [(middle, False), (middle - 360, False)],
    }[head["vair:symmetry"]]
    for psi, mirrored in same:
        shares = {(k, m): share for k, m, share in bracket(head, psi)}
        if abs(shares.get((azimuth, mirrored), 0) - 1) > 1e-9:
            yield f"{header['name']}: {psi} degrees are read from {shares}"


def check(path):
    """Yields one line for each thing that is wrong."""
    head, bins = read(path)
    n = head["vair:face"]
    azimuths = head["vair:azimuths"] if head["vair:format"] == 3 else 1
    if head["vair:format"] not in (1, 3) or head["vair:warp"] != "unicube":
        yield f"format {head['vair:format']}, warp {head['vair:warp']}"
    if len(bins) != azimuths * head["vair:bins"]:
        yield f"{len(bins)} parts for {azimuths} azimuths of {head['vair:bins']} bins"

    omega = solid_angles(n)
    if abs(6 * omega.sum() - 4 * np.pi) > 1e-12:
        yield f"the texels sum to {6 * omega.sum()} sr"
    # The directions belong to the solid angles: even light has no first moment and z^2 averages 1/3.
    w = directions(n)
    first = np.abs((w * omega[..., None]).sum(axis=(0, 1, 2))).max()
    second = (w[..., 2] ** 2 * omega).sum() / (4 * np.pi)
    if first > 1e-12 or abs(second - 1 / 3) > 1 / n**2:
        yield f"moments of the directions: {first}, {second}"

    structure = head["vair:kind"] == "structure"
    if structure:
        channels = [f"a{k:02}" for k in range(len(floats(head, "levels")))]
    else:
        channels = ["R", "G", "B"]
    edges = []
    for k, (header, maps) in enumerate(bins):
        name = header["name"]
        azimuth, number_in_it = divmod(k, head["vair:bins"])
        expected = f"bin{number_in_it:02}"
        if azimuths > 1:
            expected = f"azimuth{azimuth:02}-{expected}"
            yield from check_azimuth(head, header, azimuth)
        if name != expected:
            yield f"part {k} is called {name}, not {expected}"
        errors = ["error"] if structure else [f"error.{c}" for c in channels]
        if sorted(maps) != sorted(channels + errors):
            yield f"{name} has channels {sorted(maps)}"
            continue
        edges.append((number(header, "theta_from_deg"), number(header, "theta_to_deg")))

        emitted, escaped, absorbed, truncated, lost = (integers(header, x) for x in LEDGER)
        for e, *parts in zip(emitted, escaped, absorbed, truncated, lost):
            if e != sum(parts):
                yield f"{name}: the ledger does not balance: {e} != {parts}"
        if abs(emitted[0] / UNITS_PER_PHOTON - number(header, "photons")) > 1e-6:
            yield f"{name}: {emitted[0]} units are not {number(header, 'photons')} photons"

        entries = len(channels) if structure else head["vair:bakes"]
        if len(emitted) != entries:
            yield f"{name}: {len(emitted)} ledgers, not {entries}"

        albedo = floats(header, "albedo")
        for k, channel in enumerate(channels):
            flux = maps[channel].astype(float)
            if not np.isfinite(flux).all() or flux.min() < 0:
                yield f"{name} {channel}: negative or not finite"
            if abs(flux.sum() - albedo[k]) > 1e-5 * max(albedo[k], 1e-6):
                yield f"{name} {channel}: texels sum to {flux.sum()}, the albedo is {albedo[k]}"
            if structure and abs(escaped[k] / emitted[k] - albedo[k]) > 1e-12:
                yield f"{name} {channel}: {escaped[k]}/{emitted[k]} is not {albedo[k]}"

    # Every azimuth has all inclinations.
    if edges != edges[: head["vair:bins"]] * azimuths:
        yield "inclinations differ from azimuth to azimuth"
    edges = sorted(edges[: head["vair:bins"]])
    gaps = [abs(a[1] - b[0]) for a, b in zip(edges, edges[1:])]
    if abs(edges[0][0] + 90) + abs(edges[-1][1] - 90) + max(gaps, default=0) > 1e-9:
        yield f"the bins do not cover -90 to 90 degrees: {edges}"


def main():
    wrong = list(check(sys.argv[1]))
    for line in wrong:
        print("FAIL", line)
    if not wrong:
        print("OK", sys.argv[1])
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
