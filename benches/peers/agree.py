"""Vair and Mitsuba 3 on the same groom, skin, light, camera and hair model: do the pictures agree?

Prints mean colors and the difference in means over blocks of pixels, in standard errors; writes both
pictures and their difference to target/peers/agree. Exit code 1 if the means differ by more than 1 per cent
or the difference is more than noise.
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
# Fewer would be wider: as thick as they are far apart, flat strands and round ones do differ.
parser.add_argument("--strands", default="2.5e5")
parser.add_argument("--spp", type=int, default=256)
parser.add_argument("--res", default="240x180")
parser.add_argument("--species", default="polar-bear")
parser.add_argument("--env", default="studio")
parser.add_argument("--chiang", default="sigma_a=0.06:0.10:0.20,beta_m=0.3,beta_n=0.3,alpha=2,eta=1.55")
parser.add_argument("--view", default="35,12")
parser.add_argument("--zoom", default="1")
args = parser.parse_args()
here = os.path.dirname(os.path.abspath(__file__))
folder = "target/peers/agree"
os.makedirs(folder, exist_ok=True)


def vair(seed):
    path = f"{folder}/vair-{seed}.exr"
    subprocess.run(
        [args.vair, "-q", "render", args.species, "--skin", "ball", "--strands", args.strands, "--model", "chiang",
         "--chiang", args.chiang, "--env", args.env, "--env-visible", "--view", args.view, "--zoom", args.zoom,
         "--res", args.res, "--spp", str(args.spp), "--filter", "box", "--picture-seed", str(seed),
         "--mitsuba", folder, "-o", path], check=True)
    return measure.read_exr(path)


def mitsuba(seed):
    path = f"{folder}/mitsuba-{seed}.npy"
    line = subprocess.run(
        [sys.executable, f"{here}/mitsuba_render.py", folder, path, "--spp", str(args.spp), "--seed", str(seed)],
        check=True, stdout=subprocess.PIPE, text=True).stdout
    return np.load(path).astype(np.float64), json.loads(line)


(first, alpha), (second, _) = vair(1), vair(2)
(peer_a, _), (peer_b, _) = mitsuba(1), mitsuba(2)
ours, theirs = (first + second) / 2, (peer_a + peer_b) / 2
fur = alpha > 0.99
print(f"{int(fur.sum())} pixels of fur")
means = ours[fur].mean(axis=0), theirs[fur].mean(axis=0)
for channel, a, b in zip("RGB", *means):
    print(f"mean {channel}: Vair {a:.5f}, Mitsuba {b:.5f}, {100 * (a / b - 1):+.2f} %")
# Noise from the two halves of each, difference against it, over blocks of 8 x 8 pixels.
size = 8
inside = measure.blurred(fur[..., None].astype(float), size)[..., 0] > 0.999
halves = [measure.blurred(x - y, size)[inside] for x, y in [(first, second), (peer_a, peer_b)]]
noise = np.sqrt(sum((h ** 2).mean() for h in halves)) / 2
difference = measure.blurred(ours - theirs, size)[inside]
rms = float(np.sqrt((difference ** 2).mean()))
level = float(measure.blurred(theirs, size)[inside].mean())
ratio = rms / noise
print(f"blocks of {size} x {size}: difference {100 * rms / level:.2f} % (rms of the mean), noise {100 * noise / level:.2f} %, "
      f"ratio {ratio:.2f}")
measure.write_png(f"{folder}/vair.png", ours)
measure.write_png(f"{folder}/mitsuba.png", theirs)
measure.write_png(f"{folder}/difference.png", 0.5 + 2 * (ours - theirs))
off = max(abs(a / b - 1) for a, b in zip(*means))
print(json.dumps({"mean_off": off, "block_ratio": ratio}))
sys.exit(int(off > 0.01 or ratio > 1.5))
