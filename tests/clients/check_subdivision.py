"""Blender's subdivision surface is the skin that fur grows on: check_subdivision.py VAIR FOLDER

Blender writes a monkey as a cage, with open borders, creased edges and a turned and scaled object; VAIR exports
fur on it. Every point of the skin in that export lies on the surface that Blender makes of the cage (by
OpenSubdiv, its points at the limit), and every point of Blender's is there.
"""

import subprocess
import sys
from pathlib import Path

import bpy
import numpy as np
from mathutils.kdtree import KDTree

vair, folder = sys.argv[1], Path(sys.argv[2])
folder.mkdir(parents=True, exist_ok=True)
LEVELS = 4


def fail(message):
    print(f"FAIL {message}")
    sys.exit(1)


def tree_of(points):
    tree = KDTree(len(points))
    for i, point in enumerate(points):
        tree.insert(point, i)
    tree.balance()
    return tree


bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.mesh.primitive_monkey_add(size=0.3, location=(0.1, 0.2, 0.3), rotation=(0.4, 0.2, 0.1))
monkey = bpy.context.object
monkey.scale = (1.0, 1.2, 0.9)
creases = monkey.data.attributes.new("crease_edge", "FLOAT", "EDGE")
for edge in range(0, len(monkey.data.edges), 9):
    creases.data[edge].value = 1.0
subdivision = monkey.modifiers.new("subdivision", "SUBSURF")
subdivision.levels = subdivision.render_levels = LEVELS
subdivision.quality = LEVELS
bpy.ops.wm.usd_export(filepath=str(folder / "cage.usdc"))

made = folder / "fur.usdc"
command = [vair, "--quiet", "export", "mink", "--skin", folder / "cage.usdc", "--strands", "100", "--levels", "1"]
subprocess.run([*command, "--up", "z", "--no-material", "-o", made], check=True)

evaluated = monkey.evaluated_get(bpy.context.evaluated_depsgraph_get())
surface = evaluated.to_mesh()
truth = np.array([evaluated.matrix_world @ v.co for v in surface.vertices])
pictured = {}
for loop, uv in zip(surface.loops, surface.uv_layers[0].uv):
    pictured.setdefault(loop.vertex_index, []).append(np.array(uv.vector))
cage = np.array([monkey.matrix_world @ v.co for v in monkey.data.vertices])
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.wm.usd_import(filepath=str(made), import_curves=False)
skins = [o for o in bpy.data.objects if o.type == "MESH" and "skin" in o.name]
if len(skins) != 1:
    fail(f"{made}: {len(skins)} skins")
ours = np.array([skins[0].matrix_world @ v.co for v in skins[0].data.vertices])


def apart(points, others):
    """The largest distance of points to the nearest of others."""
    tree = tree_of(others)
    return max(tree.find(point)[2] for point in points)


size = np.ptp(cage, axis=0).max()
there, back, before = apart(ours, truth), apart(truth, ours), apart(cage, truth)
if max(there, back) > 2e-5 * size or before < 1e-2 * size:
    fail(f"skin and Blender's surface are {there / size:.1e} and {back / size:.1e} of its size apart, the cage {before / size:.1e}")
print(f"OK {made}: {len(ours)} points of the skin, {there / size:.1e} and {back / size:.1e} of its size from Blender's surface; the cage {before / size:.1e}")

# Texture coordinates of every seventh corner are among those that Blender has at that point.
skin, tree = skins[0].data, tree_of(truth)
near = [tree.find(point)[1] for point in ours]
uvs = list(zip(skin.loops, skin.uv_layers[0].uv))[::7]
worst = max(min(abs(np.array(uv.vector) - other).max() for other in pictured[near[loop.vertex_index]]) for loop, uv in uvs)
if worst > 2e-4:
    fail(f"{made}: texture coordinates are {worst:.1e} off")
print(f"OK {made}: texture coordinates within {worst:.1e}")
