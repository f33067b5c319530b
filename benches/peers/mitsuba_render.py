"""Renders a scene folder written by `vair render --mitsuba FOLDER` with Mitsuba 3.

python mitsuba_render.py FOLDER OUT.npy --spp N [--seed S] [--depth D] [--variant V]

Writes the linear picture as a NumPy array of height x width x 3 and prints one line of JSON: seconds of
loading, wall and processor seconds of rendering, peak memory.
"""
import argparse
import json
import os
import resource
import time

import mitsuba as mi
import numpy as np

parser = argparse.ArgumentParser()
parser.add_argument("folder")
parser.add_argument("out")
parser.add_argument("--spp", type=int, default=64)
parser.add_argument("--seed", type=int, default=0)
parser.add_argument("--depth", type=int, default=-1, help="path length: scattering events + 1; -1 for no end")
parser.add_argument("--rr-depth", type=int, default=5)
parser.add_argument("--variant", default="llvm_ad_rgb")
parser.add_argument("--sampler", default="independent")
args = parser.parse_args()


def cpu():
    usage = resource.getrusage(resource.RUSAGE_SELF)
    return usage.ru_utime + usage.ru_stime


mi.set_variant(args.variant)
started = time.time()
scene = mi.load_file(os.path.join(args.folder, "scene.xml"))
integrator = mi.load_dict({"type": "path", "max_depth": args.depth, "rr_depth": args.rr_depth})
sensor = scene.sensors()[0]
film = sensor.film()
sampler = {"type": args.sampler}
loaded = time.time() - started


def render(spp, seed):
    return np.array(mi.render(scene, integrator=integrator, spp=spp, seed=seed))


# The kernel is compiled before the clock starts.
passes = []
render(1, args.seed + 1000003)
before, cpu_before = time.time(), cpu()
left, k = args.spp, 0
while left > 0:
    # One pass may have 2^32 samples; small ones keep memory low.
    n = min(left, 64)
    passes.append((n, render(n, args.seed * 1009 + k)))
    left, k = left - n, k + 1
picture = sum(n * p[..., :3] for n, p in passes) / args.spp
print(json.dumps({
    "renderer": "Mitsuba " + mi.__version__ + " " + args.variant,
    "load_s": round(loaded, 3),
    "wall_s": round(time.time() - before, 3),
    "cpu_s": round(cpu() - cpu_before, 3),
    "peak_mb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024,
    "spp": args.spp,
}))
np.save(args.out, picture.astype(np.float32))
