"""Checks a file of sums: python check_sums.py SUMS.safetensors

Needs numpy and safetensors. The books must balance to the last unit, the albedos be shares. Exit code 0 or 1.
"""
import sys

from read_sums import flux, read_sums


def check(path):
    about, sums = read_sums(path)
    photons = sums["photons"]
    if int(photons.sum()) != sum(span["end"] - span["start"] for span in about["spans"]):
        yield f"{photons.sum()} photons, but spans {about['spans']}"
    levels = about["plan"]["settings"]["levels"]
    axes = (2, 3, 4)
    for level in range(len(levels)):
        left = sums["texels"][..., level].sum(axis=axes) + sums["bare"].sum(axis=axes)
        rest = sum(sums[name][..., level] for name in ("absorbed", "truncated", "lost"))
        if ((left + rest) != photons << 32).any():
            yield f"level {level}: the books do not balance"
    albedo = flux(sums).sum(axis=axes)
    black = flux(sums, len(levels) - 1).sum(axis=axes)
    if not (albedo <= 1 + 1e-12).all() or not (black < albedo).all() or not (black > 0).all():
        yield f"albedos {albedo} clear, {black} black"


wrong = list(check(sys.argv[1]))
for line in wrong:
    print("FAIL", line)
if not wrong:
    print("OK", sys.argv[1])
sys.exit(1 if wrong else 0)
