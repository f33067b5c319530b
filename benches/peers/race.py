"""Time to equal error: Vair with a baked table, Vair with Chiang, Mitsuba 3 (llvm), Cycles, on one scene.

Each renderer's error is the relative mean square error (measure.py) of its pixels of fur against a picture
of its own of many samples and another seed, whose own noise is taken off. Time is processor seconds of
rendering alone, so that other jobs on the machine count little. Processor seconds to an error are those of
the measured picture times its error over the target: error falls as one over the samples.

Mitsuba and Cycles are stopped after 16 scattering events, Vair's paths have no end.
"""
import argparse
import json
import os
import subprocess
import sys

import numpy as np

import measure

parser = argparse.ArgumentParser()
parser.add_argument("--vair", default="target/release/vair")
parser.add_argument("--strands", default="1e5")
parser.add_argument("--spp", type=int, default=32)
parser.add_argument("--reference", type=int, default=512)
parser.add_argument("--res", default="240x135")
parser.add_argument("--species", default="red-fox")
parser.add_argument("--env", default="studio")
parser.add_argument("--zoom", default="1.6")
parser.add_argument("--target", type=float, default=0.05)
parser.add_argument("--chiang", default="sigma_a=0.06:0.10:0.20,beta_m=0.3,beta_n=0.3,alpha=2,eta=1.55")
parser.add_argument("--only", default="vair-table,vair-chiang,mitsuba,cycles")
parser.add_argument("--vair-options", default="", help="more options for vair render")
args = parser.parse_args()
here = os.path.dirname(os.path.abspath(__file__))
folder = "target/peers/race"
os.makedirs(folder, exist_ok=True)


def run(command):
    result = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    if result.returncode:
        sys.exit(f"{' '.join(command)}\n{result.stdout}{result.stderr}")
    return result.stdout


def vair(model, spp, seed, export=False):
    path, stats = f"{folder}/vair-{model}.exr", f"{folder}/vair.json"
    run([args.vair, "-q", "render", args.species, "--skin", "ball", "--strands", args.strands, "--model", model,
         "--chiang", args.chiang, "--env", args.env, "--env-visible", "--view", "35,12", "--zoom", args.zoom,
         "--res", args.res, "--spp", str(spp), "--filter", "box", "--picture-seed", str(seed), "-o", path,
         "--stats", stats, *args.vair_options.split(), *(["--mitsuba", folder] if export else [])])
    numbers = json.load(open(stats))
    stages = numbers["stages"]
    line = {"cpu_s": stages["render"]["cpu_s"], "peak_mb": numbers["peak_mb"], "rays": numbers["rays"],
            "load_s": sum(stages[s]["cpu_s"] for s in ("groom", "scene"))}
    picture, alpha = measure.read_exr(path)
    return picture, line, alpha


def mitsuba(spp, seed):
    path = f"{folder}/mitsuba.npy"
    out = run([sys.executable, "-B", f"{here}/mitsuba_render.py", folder, path, "--spp", str(spp), "--seed", str(seed),
               "--depth", "17"])
    return np.load(path).astype(float), json.loads(out.splitlines()[-1])


def cycles(spp, seed):
    path = f"{folder}/cycles.exr"
    out = run(["target/peers-cycles/bin/python", "-B", f"{here}/cycles_render.py", folder, path, "--spp", str(spp),
               "--seed", str(seed)])
    line = next(line for line in out.splitlines() if line.startswith("{"))
    return measure.read_exr(path)[0], json.loads(line)


# The scene for the others, and which pixels are fur.
_, _, alpha = vair("chiang", 8, 0, export=True)
fur = alpha > 0.99
width, height = (int(n) for n in args.res.split("x"))
kinds = {
    "vair-table": lambda spp, seed: vair("table", spp, seed)[:2],
    "vair-chiang": lambda spp, seed: vair("chiang", spp, seed)[:2],
    "mitsuba": mitsuba,
    "cycles": cycles,
}
print(f"{args.species}, {args.strands} strands, {args.res}, {args.spp} samples, {int(fur.sum())} pixels of fur")
print("| renderer | M samples / CPU s | relMSE | CPU s to relMSE %g | peak MB | mean |" % args.target)
print("| --- | --- | --- | --- | --- | --- |")
for name in args.only.split(","):
    picture, line = kinds[name](args.spp, 1)
    reference, _ = kinds[name](args.reference, 2)
    # Independent noise of the reference adds to the error what its samples allow.
    error = measure.rel_mse(picture, reference, fur) / (1 + args.spp / args.reference)
    seconds = line["cpu_s"] * error / args.target
    rate = width * height * args.spp / line["cpu_s"] / 1e6
    mean = ", ".join(f"{m:.4f}" for m in reference[fur].mean(axis=0))
    print(f"| {name} | {rate:.3f} | {error:.4f} | {seconds:.1f} | {line['peak_mb']} | {mean} |", flush=True)
    measure.write_png(f"{folder}/{name}.png", reference)
