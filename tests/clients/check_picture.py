"""Opens a rendered picture with Python's OpenEXR: all passes there, all numbers finite, and the
beauty pass is neither black nor blown. Usage: check_picture.py PICTURE.exr"""

import json
import sys

import numpy
import OpenEXR

PASSES = ["R", "G", "B", "A", "Z", "albedo.R", "normal.X", "tangent.Z", "strand.id", "root.U", "samples", "variance.Y"]


def check(path):
    with OpenEXR.File(path, separate_channels=True) as file:
        header, channels = file.header(), file.channels()
        for name in PASSES:
            if name not in channels:
                return f"no channel {name}, only {sorted(channels)}"
            if not numpy.isfinite(channels[name].pixels.astype("f8")[channels["A"].pixels > 0]).all():
                return f"channel {name} is not finite on the subject"
        provenance = json.loads(header["vair:provenance"])
        if "species_text" not in provenance or "seed" not in provenance:
            return f"provenance lacks the species: {sorted(provenance)}"
        luminance = channels["G"].pixels[channels["A"].pixels > 0.5]
        if luminance.size == 0 or not 0.001 < luminance.mean() < 20:
            return "the subject is missing, black or blown"
        return None


fault = check(sys.argv[1])
print(f"FAIL {sys.argv[1]}: {fault}" if fault else f"OK {sys.argv[1]}")
sys.exit(1 if fault else 0)
