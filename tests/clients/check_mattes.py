"""Reads Cryptomatte layers with Python's OpenEXR, after the specification and nothing else: check_mattes.py
PICTURE.exr [PREVIEW.npy]

Ids are hashes of the names, ranks are in order, coverage sums to the alpha of the picture. The preview is an
array of colors: each name's color by its coverage.
"""
import json
import struct
import sys

import numpy as np
import OpenEXR


def murmur3(data):
    """MurmurHash3_x86_32 with seed 0."""
    mask, h = 0xFFFFFFFF, 0
    rotate = lambda x, n: ((x << n) | (x >> (32 - n))) & mask
    mix = lambda k: rotate(k * 0xCC9E2D51 & mask, 15) * 0x1B873593 & mask
    whole = len(data) // 4 * 4
    for (k,) in struct.iter_unpack("<I", data[:whole]):
        h = (rotate(h ^ mix(k), 13) * 5 + 0xE6546B64) & mask
    if data[whole:]:
        h ^= mix(int.from_bytes(data[whole:], "little"))
    h ^= len(data)
    for shift, factor in ((16, 0x85EBCA6B), (13, 0xC2B2AE35)):
        h = (h ^ (h >> shift)) * factor & mask
    return h ^ (h >> 16)


def id_of(name):
    h = murmur3(name.encode())
    return h ^ (1 << 23) if (h >> 23) & 255 in (0, 255) else h


def read(path):
    """Of each set of names: the manifest, ids and coverages (ranks, height, width)."""
    with OpenEXR.File(path, separate_channels=True) as file:
        header = dict(file.header())  # emptied when the file closes
        channels = {name: channel.pixels for name, channel in file.channels().items()}
    sets = {}
    for key in [k for k in header if k.startswith("cryptomatte/") and k.endswith("/name")]:
        base, layer = key[: -len("/name")], header[key]
        assert base == f"cryptomatte/{murmur3(layer.encode()):08x}"[:19], (base, layer)
        assert header[base + "/hash"] == "MurmurHash3_32" and header[base + "/conversion"] == "uint32_to_float32"
        ids, coverages = [], []
        for i in range(100):
            if f"{layer}{i:02}.R" not in channels:
                break
            for id_channel, coverage in (("R", "G"), ("B", "A")):
                plane = channels[f"{layer}{i:02}.{id_channel}"]
                assert plane.dtype == np.float32
                ids.append(plane.view(np.uint32))
                coverages.append(channels[f"{layer}{i:02}.{coverage}"])
        sets[layer] = (json.loads(header[base + "/manifest"]), np.array(ids), np.array(coverages))
    return sets, channels


def main():
    sets, channels = read(sys.argv[1])
    assert set(sets) == {"CryptoClass", "CryptoZone"}, f"there are only {sorted(sets)}"
    samples = channels["samples"].astype(float)
    for layer, (manifest, ids, coverage) in sets.items():
        assert len(ids) >= 6, f"{layer} has only {len(ids)} ranks"
        assert {"skin", "ground"} < set(manifest)
        known = {int(text, 16): name for name, text in manifest.items()}
        for number, name in known.items():
            assert number == id_of(name), f"{layer}: the id of {name} is {number:08x}"
        assert (np.diff(coverage, axis=0) <= 0).all(), f"{layer}: ranks out of order"
        assert ((ids == 0) == (coverage == 0)).all() and set(np.unique(ids)) <= set(known) | {0}
        counts = coverage * samples
        assert np.abs(counts - np.round(counts)).max() < 1e-3, f"{layer}: coverage is no share of the samples"
        of = {name: np.where(ids == number, coverage, 0).sum(0) for number, name in known.items()}
        subject = sum(share for name, share in of.items() if name != "ground")
        off = np.abs(subject - channels["A"]).max()
        assert off < 1e-6, f"{layer}: coverage is {off} off the alpha"
        hair = sum(share for name, share in of.items() if name not in ("skin", "ground"))
        strand = channels["strand.id"] != 0xFFFFFFFF
        assert ((hair > 0) == strand).all(), f"{layer}: hair is not where strands are"
        means = ", ".join(f"{name} {share.mean():.3f}" for name, share in of.items())
        print(f"OK {sys.argv[1]}: {layer} {means}")
        if layer == "CryptoClass" and len(sys.argv) > 2:
            colors = np.random.default_rng(3).random((len(of), 3))
            np.save(sys.argv[2], sum(share[..., None] * color for share, color in zip(of.values(), colors)))
    # What a strand's id says of its class (its top four bits) is what the first rank says, where only one is seen.
    manifest, ids, coverage = sets["CryptoClass"]
    classes = [name for name in manifest if name not in ("skin", "ground")]
    alone = (coverage[0] == 1) & strand
    assert alone.sum() > 50, "hardly a pixel shows one class alone"
    seen = {name: set(np.unique(channels["strand.id"][alone & (ids[0] == id_of(name))] >> 28)) for name in classes}
    assert all(len(bits) <= 1 for bits in seen.values()), f"classes and ids disagree: {seen}"


main()
