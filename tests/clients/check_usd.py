"""Pixar's library reads assets: check_usd.py NAME ...   (NAME.usda and NAME.usdc, and NAME.raw if it is there)

All validators pass, both files print as the same text, curves are what their schema asks for, and every
number is bit for bit the one in NAME.raw (see tests/raw/arrays.rs).
"""

import re
import struct
import sys
from pathlib import Path

import numpy as np
from pxr import Sdf, Usd, UsdGeom, UsdShade, UsdValidation


def fail(message):
    print(f"FAIL {message}")
    sys.exit(1)


def arrays_of(path):
    """The arrays of a .raw file: attribute path, numbers."""
    data, at = path.read_bytes(), 0
    while at < len(data):
        (length,) = struct.unpack_from("<I", data, at)
        name = data[at + 4 : at + 4 + length].decode()
        at += 4 + length
        kind, count = data[at : at + 1], struct.unpack_from("<I", data, at + 1)[0]
        at += 5
        yield name, np.frombuffer(data, "<f4" if kind == b"f" else "<i4", count, at)
        at += 4 * count


def check_validators(stage, name):
    validators = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
    # Without MaterialX in this build its nodes are unknown; check_blender.py has one that knows them.
    for error in UsdValidation.ValidationContext(validators).Validate(stage):
        if "ND_" in error.GetMessage():
            continue
        fail(f"{name}: {error.GetName()}: {error.GetMessage()}")
    return len(validators)


def check_stage(stage, name, widest=5e-3):
    """`widest`: the largest diameter that is sound, in meters."""
    root = stage.GetDefaultPrim()
    if not root or not Usd.ModelAPI(root).IsKind("component"):
        fail(f"{name}: the default prim is no component")
    if not (stage.HasAuthoredMetadata("metersPerUnit") and stage.HasAuthoredMetadata("upAxis")):
        fail(f"{name}: units or up axis are missing")
    purposes = set()
    for prim in stage.Traverse():
        if prim.IsA(UsdGeom.BasisCurves):
            purposes.add(UsdGeom.Imageable(prim).ComputePurpose())
            check_curves(UsdGeom.BasisCurves(prim), stage, f"{name} {prim.GetPath()}", widest)
    if "render" not in purposes:
        fail(f"{name}: no curves with the purpose render")
    return purposes


def check_curves(curves, stage, name, widest):
    counts = np.array(curves.GetCurveVertexCountsAttr().Get())
    points = np.array(curves.GetPointsAttr().Get())
    widths = np.array(curves.GetWidthsAttr().Get())
    if counts.sum() != len(points) or counts.min() < 2:
        fail(f"{name}: {len(points)} points but counts sum to {counts.sum()}, the least is {counts.min()}")
    if curves.GetWidthsInterpolation() != "vertex" or len(widths) != len(points):
        fail(f"{name}: {len(widths)} widths for {len(points)} points")
    meters = widths * UsdGeom.GetStageMetersPerUnit(stage)
    if not (np.isfinite(points).all() and meters.min() > 1e-7 and meters.max() < widest):
        fail(f"{name}: points or widths are not sound, widths {meters.min()} to {meters.max()} m")
    half = widths.max() / 2
    extent = np.array(curves.GetExtentAttr().Get())
    if not np.allclose(extent, [points.min(0) - half, points.max(0) + half], rtol=1e-5, atol=1e-6 * np.abs(extent).max()):
        fail(f"{name}: extent {extent.tolist()}")
    if curves.GetTypeAttr().Get() == "cubic" and curves.GetBasisAttr().Get() == "bezier" and ((counts - 4) % 3).any():
        fail(f"{name}: counts do not fit bezier curves")
    api = UsdGeom.PrimvarsAPI(curves)
    if api.HasPrimvar("id"):
        fail(f"{name}: a primvar called id, which Arnold takes for its own")
    expected = {"constant": 1, "uniform": len(counts), "vertex": len(points)}
    for primvar in api.GetPrimvars():
        if not primvar.HasValue():
            continue
        found, wanted = len(primvar.Get()), expected.get(primvar.GetInterpolation())
        if found != wanted:
            fail(f"{name}: {primvar.GetName()} has {found} values, {wanted} expected")
    ids = api.GetPrimvar("curve_id")
    if ids.HasValue() and len(set(ids.Get())) != len(counts):
        fail(f"{name}: ids are not unique")
    binding = UsdShade.MaterialBindingAPI(curves)
    if binding.GetDirectBinding().GetMaterialPath() and not binding.ComputeBoundMaterial()[0]:
        fail(f"{name}: the material that is bound is not there")


def text_of(path):
    """As Pixar prints it, without the file's own name in it."""
    text = Sdf.Layer.FindOrOpen(str(path)).ExportToString()
    return re.sub(r"asset identifier = @.*@", "", text)


def check_numbers(stage, raw, name):
    count = 0
    for path, numbers in arrays_of(raw):
        variant, _, path = path.rpartition(":/")
        path = "/" + path.lstrip("/")
        if variant:
            stage.GetDefaultPrim().GetVariantSet("lod").SetVariantSelection(variant)
        attribute = stage.GetAttributeAtPath(path)
        if not attribute or not attribute.HasValue():
            fail(f"{name}: {variant} {path} is missing")
        found = np.array(attribute.Get()).reshape(-1)
        # Widths of coarser levels are scaled after they were grown.
        scaled = path.endswith(".widths") and variant not in ("", "full")
        same = np.allclose(found, numbers, rtol=1e-6, atol=0) if scaled else found.tobytes() == numbers.tobytes()
        if len(found) != len(numbers) or not same:
            fail(f"{name}: {variant} {path} differs from what was grown")
        count += 1
    return count


def check_levels(stage, name):
    """Every coarser level is a part of the finer one."""
    variants = stage.GetDefaultPrim().GetVariantSet("lod")
    finer = None
    for variant in ["full", "medium", "low", "far"]:
        if not variants.HasAuthoredVariant(variant):
            continue
        variants.SetVariantSelection(variant)
        ids = set()
        for prim in stage.Traverse():
            value = prim.GetAttribute("primvars:curve_id")
            if "/render/" in str(prim.GetPath()) and value and value.HasValue():
                ids |= set(value.Get())
        if finer is not None and not ids < finer:
            fail(f"{name}: level {variant} has strands that the finer one has not")
        finer = ids


def content(stage):
    """All that prims below the root are given: type and value of attributes, targets of relationships."""
    found = {}
    for prim in stage.Traverse():
        if prim == stage.GetDefaultPrim():
            continue
        found[str(prim.GetPath())] = (prim.GetTypeName(), prim.GetAppliedSchemas(), prim.GetCustomData())
        for attribute in prim.GetAuthoredAttributes():
            value = attribute.Get()
            value = np.array(value).tobytes() if hasattr(value, "__len__") and not isinstance(value, str) else value
            found[str(attribute.GetPath())] = (attribute.GetTypeName(), value, attribute.GetMetadata("interpolation"), attribute.GetConnections())
        for relationship in prim.GetAuthoredRelationships():
            found[str(relationship.GetPath())] = relationship.GetTargets()
    return found


def check_coats(stage, path):
    """Every choice of coat is what that coat is by itself, in NAME-COAT, at every level of detail."""
    root = stage.GetDefaultPrim()
    coats, levels = (root.GetVariantSet(name) for name in ("coat", "lod"))
    seen = []
    for coat in coats.GetVariantNames():
        alone = Usd.Stage.Open(f"{path.with_suffix('')}-{coat}{path.suffix}")
        alone.SetEditTarget(alone.GetSessionLayer())
        coats.SetVariantSelection(coat)
        for level in levels.GetVariantNames():
            levels.SetVariantSelection(level)
            alone.GetDefaultPrim().GetVariantSet("lod").SetVariantSelection(level)
            ours, theirs = content(stage), content(alone)
            other = [key for key in ours.keys() | theirs.keys() if ours.get(key) != theirs.get(key)]
            if other:
                fail(f"{path}: {coat} {level} differs from the coat by itself: {sorted(other)[:3]}")
            # A strand that stands for many is wider than hair.
            check_stage(stage, f"{path} {coat} {level}", 5e-3 if level == "full" else 5e-2)
        skin = root.GetChild("geo").GetChild("skin").GetAttribute("primvars:displayColor")
        seen.append(np.array(skin.Get()).tobytes())
    if len(set(seen)) < len(seen):
        fail(f"{path}: two coats have skin of the same color")
    return len(seen)


for name in sys.argv[1:]:
    paths = [Path(f"{name}.{suffix}") for suffix in ("usda", "usdc")]
    if text_of(paths[0]) != text_of(paths[1]):
        fail(f"{name}: the two forms print as different text")
    for path in paths:
        stage = Usd.Stage.Open(str(path))
        stage.SetEditTarget(stage.GetSessionLayer())
        validators = check_validators(stage, path)
        purposes = check_stage(stage, path)
        raw = path.with_suffix(".raw")
        count = check_numbers(stage, raw, path) if raw.exists() else 0
        check_levels(stage, path)
        coats = check_coats(stage, path)
    print(f"OK {name}: {validators} validators, {count} arrays bit for bit, {coats} coats, purposes {', '.join(sorted(purposes))}")
