"""Blender imports assets: check_blender.py FILE.usdc PICTURE.exr SCENE.xml OUT.png ...

FILE was exported, PICTURE rendered and SCENE written (render --mitsuba) with the same arguments. Blender's
own USD finds all shader nodes, MaterialX's too; curves, radii and attributes arrive as they stand in the
file; Cycles draws skin and strands from the camera of SCENE, and what it covers is what PICTURE covers.
"""

import os
import re
import sys

import bpy
import numpy as np

bpy.utils.expose_bundled_modules()

import OpenImageIO as oiio  # noqa: E402
from mathutils import Matrix, Vector  # noqa: E402
from pxr import Usd, UsdGeom  # noqa: E402

SAMPLES = 64
# Strands are thinner than pixels: which pixel at the edge has one is noise, so coverage is averaged first, over
# five pixels of a picture 240 wide.
BLUR = 5 / 240
LEAST_OVERLAP = 0.98
MOST_OFF = 0.01
# What readers in Blender need, and where it has to arrive.
WANTED = {
    "radius": "POINT",
    "displayColor": "POINT",
    "curve_id": "CURVE",
    "surface_uv_coordinate": "CURVE",
}


def fail(message):
    print(f"FAIL {message}")
    sys.exit(1)


def check_shaders(stage):
    """Every shader's node is known to this build, with MaterialX, and its inputs have the node's types."""
    from pxr import Sdr

    registry, count = Sdr.Registry(), 0
    for prim in stage.Traverse():
        if prim.GetTypeName() != "Shader":
            continue
        name = prim.GetAttribute("info:id").Get()
        node = registry.GetShaderNodeByIdentifier(name)
        if not node:
            fail(f"{prim.GetPath()}: Blender knows no node {name}")
        for attribute in prim.GetAttributes():
            base = attribute.GetName()
            if not base.startswith("inputs:"):
                continue
            known = node.GetShaderInput(base[7:])
            if not known:
                fail(f"{attribute.GetPath()}: {name} has no such input")
            wanted = known.GetTypeAsSdfType().GetSdfType()
            if wanted != attribute.GetTypeName():
                fail(f"{attribute.GetPath()} is {attribute.GetTypeName()}, the node has {wanted}")
        count += 1
    return count


def check_import(stage):
    found = {o.name: o for o in bpy.data.objects if o.type == "CURVES"}
    strands = 0
    for prim in stage.Traverse():
        if not prim.IsA(UsdGeom.BasisCurves) or "/render/" not in str(prim.GetPath()):
            continue
        curves = UsdGeom.BasisCurves(prim)
        name = prim.GetName()
        if name not in found:
            fail(f"{name} did not arrive; there are {sorted(found)}")
        data = found[name].data
        widths = np.array(curves.GetWidthsAttr().Get())
        points = np.array(curves.GetPointsAttr().Get())
        counts = np.array(curves.GetCurveVertexCountsAttr().Get())
        radius, place = np.empty(len(data.points), "f4"), np.empty(3 * len(data.points), "f4")
        data.attributes["radius"].data.foreach_get("value", radius)
        data.attributes["position"].data.foreach_get("vector", place)
        if len(data.curves) != len(counts) or place.tobytes() != points.tobytes():
            fail(f"{name}: {len(data.curves)} curves for {len(counts)}, or other points")
        if radius.tobytes() != (widths / 2).tobytes():
            fail(f"{name}: radii are not half the widths")
        for attribute, domain in WANTED.items():
            if attribute not in data.attributes or data.attributes[attribute].domain != domain:
                fail(f"{name}: attribute {attribute} did not arrive on {domain}")
        ids = np.empty(len(counts), "i4")
        data.attributes["curve_id"].data.foreach_get("value", ids)
        if ids.tobytes() != np.array(prim.GetAttribute("primvars:curve_id").Get()).tobytes():
            fail(f"{name}: ids differ")
        properties = dict(found[name].items()) | dict(data.items())
        if properties.get("vair_class") != name:
            fail(f"{name}: no custom property vair_class, there are {sorted(properties)}")
        give_material(data, properties)
        strands += len(counts)
    return strands


def give_material(data, properties):
    """Principled hair by the numbers in the file: Blender does not import bindings of curves."""
    material = bpy.data.materials.new("hair")
    material.use_nodes = True
    nodes = material.node_tree.nodes
    nodes.clear()
    hair, out = nodes.new("ShaderNodeBsdfHairPrincipled"), nodes.new("ShaderNodeOutputMaterial")
    hair.model, hair.parametrization = properties["vair_blender_hair_model"], "ABSORPTION"
    hair.inputs["Roughness"].default_value = properties["vair_blender_roughness"]
    hair.inputs["Radial Roughness"].default_value = properties["vair_blender_radial_roughness"]
    hair.inputs["IOR"].default_value = properties["vair_blender_ior"]
    hair.inputs["Offset"].default_value = properties["vair_blender_offset"]
    hair.inputs["Coat"].default_value = 0
    absorption = hair.inputs["Absorption Coefficient"]
    absorption.default_value = list(properties["vair_blender_absorption_coefficient"])[:3]
    if "absorption" in data.attributes:
        reader = nodes.new("ShaderNodeAttribute")
        reader.attribute_name = "absorption"
        material.node_tree.links.new(reader.outputs["Vector"], absorption)
    material.node_tree.links.new(hair.outputs[0], out.inputs["Surface"])
    data.materials.clear()
    data.materials.append(material)


def set_camera(path):
    """The camera of a Mitsuba scene; its axes are those of the file, Y up, Blender's Z up."""
    text = open(path).read()
    sensor = text[text.index("<sensor") : text.index("</sensor>")]
    fov = float(re.search(r'"fov" value="([^"]+)"', sensor).group(1))
    look = re.search(r'origin="([^"]+)" target="([^"]+)" up="([^"]+)"', sensor)
    origin, target, up = (Vector([float(x) for x in g.split(",")]) for g in look.groups())
    # The scene's unit is the millimeter, the file's the meter.
    origin, target = origin / 1000, target / 1000
    back = (origin - target).normalized()
    right = up.cross(back).normalized()
    axes = Matrix((right, back.cross(right), back)).transposed().to_4x4()
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.matrix_world = Matrix.Rotation(np.pi / 2, 4, "X") @ Matrix.Translation(origin) @ axes
    camera.data.sensor_fit, camera.data.angle = "HORIZONTAL", np.radians(fov)
    camera.data.clip_start, camera.data.clip_end = 0.001, 100
    bpy.context.collection.objects.link(camera)
    bpy.context.scene.camera = camera


def render(size, png):
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.device, scene.cycles.samples = "CPU", SAMPLES
    scene.cycles_curves.shape = "THICK"
    scene.render.resolution_x, scene.render.resolution_y = size
    scene.render.film_transparent = True
    world = bpy.data.worlds.new("white")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs[0].default_value = (1, 1, 1, 1)
    scene.world = world
    scene.render.image_settings.file_format = "PNG"
    scene.render.image_settings.color_mode = "RGBA"
    scene.render.filepath = os.path.abspath(png)
    bpy.ops.render.render(write_still=True)
    return oiio.ImageBuf(png).get_pixels()[:, :, 3]


def blurred(image):
    n = round(BLUR * image.shape[1])
    sums = np.cumsum(np.cumsum(np.pad(image, ((n, 0), (n, 0))), 0), 1)
    return (sums[n:, n:] - sums[:-n, n:] - sums[n:, :-n] + sums[:-n, :-n]) / n**2


def check(file, picture, camera, png):
    stage = Usd.Stage.Open(file)
    shaders = check_shaders(stage)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.usd_import(filepath=file)
    strands = check_import(stage)
    image = oiio.ImageBuf(picture)
    own = image.get_pixels()[:, :, image.spec().channelnames.index("A")]
    set_camera(camera)
    other = render(own.shape[1::-1], png)
    a, b = blurred(own) > 0.5, blurred(other) > 0.5
    overlap = (a & b).sum() / (a | b).sum()
    off = other.sum() / own.sum() - 1
    if abs(off) > MOST_OFF:
        fail(f"{file}: Cycles covers {off:+.2%} more than Vair: are the strands wider or narrower?")
    if overlap < LEAST_OVERLAP:
        fail(f"{file}: Cycles covers other pixels than Vair: intersection over union {overlap:.3f}")
    print(f"OK {file}: {shaders} shader nodes, {strands} strands, intersection over union {overlap:.4f}, coverage off by {off:+.2%}")


for at in range(1, len(sys.argv), 4):
    check(*sys.argv[at : at + 4])
