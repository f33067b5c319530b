"""Renders a scene folder written by `vair render --mitsuba FOLDER` with Cycles (PyPI's bpy).

python cycles_render.py FOLDER OUT.exr --spp N [--seed S] [--bounces B] [--shape THICK|RIBBONS]

Prints one line of JSON like mitsuba_render.py. What hides noise is off: adaptive sampling, denoising,
clamping, blurred gloss, the light threshold.
"""
import argparse
import json
import math
import os
import resource
import time
import xml.etree.ElementTree as ET

import bpy
import numpy as np

parser = argparse.ArgumentParser()
parser.add_argument("folder")
parser.add_argument("out")
parser.add_argument("--spp", type=int, default=64)
parser.add_argument("--seed", type=int, default=0)
parser.add_argument("--bounces", type=int, default=15, help="scattering events less one")
parser.add_argument("--shape", default="RIBBONS", choices=["THICK", "RIBBONS"])
args = parser.parse_args()
started = time.time()


def cpu():
    usage = resource.getrusage(resource.RUSAGE_SELF)
    return usage.ru_utime + usage.ru_stime


def z_up(v):
    """A turn that puts Y up to Z up and the middle of the environment where Cycles has it."""
    return np.asarray(v)[..., [2, 0, 1]] * [-1, -1, 1]


xml = ET.parse(os.path.join(args.folder, "scene.xml")).getroot()


def value(name, type_="float"):
    return next(e for e in xml.iter(type_) if e.get("name") == name).get("value")


def floats(text):
    return [float(t) for t in text.replace(",", " ").split()]


bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
scene.render.engine = "CYCLES"
scene.render.resolution_x = int(value("width", "integer"))
scene.render.resolution_y = int(value("height", "integer"))
scene.render.resolution_percentage = 100
c = scene.cycles
c.device, c.samples, c.seed = "CPU", args.spp, args.seed
c.use_adaptive_sampling = c.use_denoising = False
c.sample_clamp_direct = c.sample_clamp_indirect = 0
c.blur_glossy, c.light_sampling_threshold = 0, 0
c.max_bounces = c.diffuse_bounces = c.glossy_bounces = c.transmission_bounces = args.bounces
c.pixel_filter_type = "BOX"
scene.cycles_curves.shape = args.shape
scene.render.use_persistent_data = True

# Strands: points on the B-spline, through which Cycles puts a Catmull-Rom spline.
strands = open(os.path.join(args.folder, "hair.txt")).read().strip().split("\n\n")
controls = [np.fromstring(s, sep=" ").reshape(-1, 4) for s in strands]
points = [(k[:-2] + 4 * k[1:-1] + k[2:]) / 6 for k in controls]
curves = bpy.data.hair_curves.new("fur")
curves.add_curves([len(p) for p in points])
every = np.concatenate(points)
curves.position_data.foreach_set("vector", z_up(every[:, :3]).astype(np.float32).ravel())
radius = curves.attributes.get("radius") or curves.attributes.new("radius", "FLOAT", "POINT")
radius.data.foreach_set("value", np.maximum(every[:, 3], 0).astype(np.float32))
fur = bpy.data.objects.new("fur", curves)
scene.collection.objects.link(fur)
hair = bpy.data.materials.new("hair")
hair.use_nodes = True
nodes, links = hair.node_tree.nodes, hair.node_tree.links
nodes.clear()
shader = nodes.new("ShaderNodeBsdfHairPrincipled")
shader.model, shader.parametrization = "CHIANG", "ABSORPTION"
for name, v in [
    ("Absorption Coefficient", floats(value("sigma_a", "rgb"))), ("Roughness", float(value("longitudinal_roughness"))),
    ("Radial Roughness", float(value("azimuthal_roughness"))), ("Coat", 0.0), ("IOR", float(value("int_ior"))),
    # Cycles counts the tilt of strands that run from root to tip the other way.
    ("Offset", -math.radians(float(value("scale_tilt")))), ("Random Roughness", 0.0),
]:
    shader.inputs[name].default_value = v
links.new(shader.outputs[0], nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
curves.materials.append(hair)

# Skin.
path = os.path.join(args.folder, "skin.ply")
if os.path.exists(path):
    data = open(path, "rb").read()
    head, body = data.split(b"end_header\n", 1)
    count = [int(line.split()[2]) for line in head.decode().splitlines() if line.startswith("element")]
    vertices = np.frombuffer(body, "<f4", count[0] * 9).reshape(-1, 9)
    faces = np.frombuffer(body, np.dtype([("n", "u1"), ("i", "<i4", 3)]), count[1], count[0] * 36)["i"]
    mesh = bpy.data.meshes.new("skin")
    mesh.from_pydata(z_up(vertices[:, :3]).tolist(), [], faces.tolist())
    mesh.shade_smooth()
    paint = bpy.data.materials.new("skin")
    paint.use_nodes = True
    paint.node_tree.nodes.clear()
    diffuse = paint.node_tree.nodes.new("ShaderNodeBsdfDiffuse")
    diffuse.inputs["Color"].default_value = [*vertices[:, 6:].mean(axis=0).tolist(), 1]
    out = paint.node_tree.nodes.new("ShaderNodeOutputMaterial")
    paint.node_tree.links.new(diffuse.outputs[0], out.inputs["Surface"])
    mesh.materials.append(paint)
    scene.collection.objects.link(bpy.data.objects.new("skin", mesh))

# Light.
world = bpy.data.worlds.new("world")
scene.world = world
world.use_nodes = True
nodes, links = world.node_tree.nodes, world.node_tree.links
picture = nodes.new("ShaderNodeTexEnvironment")
picture.image = bpy.data.images.load(os.path.abspath(os.path.join(args.folder, "environment.exr")))
turn = float(next(e for e in xml.iter("rotate")).get("angle")) - 180
mapping, place = nodes.new("ShaderNodeMapping"), nodes.new("ShaderNodeTexCoord")
mapping.inputs["Rotation"].default_value = (0, 0, -math.radians(turn))
links.new(place.outputs["Generated"], mapping.inputs["Vector"])
links.new(mapping.outputs["Vector"], picture.inputs["Vector"])
links.new(picture.outputs["Color"], nodes["Background"].inputs["Color"])

# Camera.
look = next(e for e in xml.iter("lookat"))
origin, target, up = (z_up(floats(look.get(k))) for k in ("origin", "target", "up"))
backward = (origin - target) / np.linalg.norm(origin - target)
right = np.cross(up, backward)
right /= np.linalg.norm(right)
matrix = np.eye(4)
matrix[:3, 0], matrix[:3, 1], matrix[:3, 2], matrix[:3, 3] = right, np.cross(backward, right), backward, origin
camera = bpy.data.cameras.new("camera")
camera.sensor_fit, camera.angle_x = "HORIZONTAL", math.radians(float(value("fov")))
camera.clip_start, camera.clip_end = 1, 1e6
eye = bpy.data.objects.new("camera", camera)
from mathutils import Matrix
eye.matrix_world = Matrix(matrix.tolist())
scene.collection.objects.link(eye)
scene.camera = eye
scene.render.image_settings.file_format = "OPEN_EXR"
scene.render.image_settings.color_depth = "32"
scene.render.image_settings.color_mode = "RGBA"
scene.view_settings.view_transform = "Standard" if hasattr(scene.view_settings, "view_transform") else ""


def render(spp, path):
    c.samples = spp
    scene.render.filepath = os.path.abspath(path)
    bpy.ops.render.render(write_still=True)


# Strands are sorted before the clock starts.
render(1, args.out)
loaded = time.time() - started
before, cpu_before = time.time(), cpu()
render(args.spp, args.out)
print(json.dumps({
    "renderer": f"Cycles {bpy.app.version_string} {args.shape}", "load_s": round(loaded, 3),
    "wall_s": round(time.time() - before, 3), "cpu_s": round(cpu() - cpu_before, 3),
    "peak_mb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024, "spp": args.spp}))
