"""Reads a file of sums with nothing but docs/sums-format.md."""
import json

import numpy as np
from safetensors import safe_open


def read_sums(path):
    """What the sums are of, and the arrays by name."""
    with safe_open(path, "np") as file:
        about = json.loads(file.metadata()["vair"])
        return about, {name: file.get_tensor(name) for name in file.keys()}


def flux(sums, level=0):
    """Flux fractions [channel, node, face, v, u] at an absorption level."""
    left = sums["texels"][..., level].astype(float) + sums["bare"]
    return left / (sums["photons"][..., None, None, None] * 2.0**32)
