"""Opens a coat in Blender and draws its density: check_blender_vdb.py GRIDS.vdb PICTURE.png [LAYER.usda]

Run by a Python that has bpy. With a layer, also imports that and expects a volume with the same grids.
"""
import os
import sys

import bpy
import mathutils


def grids_of(volume):
    volume.grids.load()
    assert volume.grids.is_loaded, "the grids did not load"
    return {grid.name: (grid.data_type, grid.channels) for grid in volume.grids}


def main():
    vdb, picture = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
    bpy.ops.wm.read_factory_settings(use_empty=True)
    if len(sys.argv) > 3:
        bpy.ops.wm.usd_import(filepath=os.path.abspath(sys.argv[3]))
        volumes = [o for o in bpy.data.objects if o.type == "VOLUME"]
        assert len(volumes) == 1, [o.type for o in bpy.data.objects]
        assert os.path.samefile(bpy.path.abspath(volumes[0].data.filepath), vdb)
        wanted = grids_of(volumes[0].data)
        bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.object.volume_import(filepath=vdb, align="WORLD", location=(0, 0, 0), rotation=(0, 0, 0))
    volume = next(o for o in bpy.data.objects if o.type == "VOLUME")
    grids = grids_of(volume.data)
    assert grids["density"] == ("FLOAT", 1) and grids["color"] == ("VECTOR_FLOAT", 3), grids
    assert len(sys.argv) <= 3 or wanted == grids, (wanted, grids)
    # Fur is Y up; so is the camera.
    material = bpy.data.materials.new("coat")
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    shader, out = nodes.new("ShaderNodeVolumePrincipled"), nodes.new("ShaderNodeOutputMaterial")
    shader.inputs["Density"].default_value = 1.0
    shader.inputs["Color Attribute"].default_value = "color"
    shader.inputs["Color"].default_value = (1, 1, 1, 1)
    links.new(shader.outputs["Volume"], out.inputs["Volume"])
    volume.data.materials.append(material)
    scene = bpy.context.scene
    corners = [volume.matrix_world @ mathutils.Vector(c) for c in volume.bound_box]
    middle = sum(corners, mathutils.Vector()) / 8
    size = max((c - middle).length for c in corners)
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.data.clip_start = 0.01
    scene.collection.objects.link(camera)
    camera.location = middle + mathutils.Vector((-0.6, 0.3, 0.75)).normalized() * 3.2 * size
    camera.rotation_mode = "QUATERNION"
    back = (camera.location - middle).normalized()
    right = mathutils.Vector((0, 1, 0)).cross(back).normalized()
    camera.rotation_quaternion = mathutils.Matrix((right, back.cross(right), back)).transposed().to_quaternion()
    scene.camera = camera
    sun = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
    sun.data.energy = 4
    sun.rotation_mode = "QUATERNION"
    sun.rotation_quaternion = mathutils.Vector((-0.3, 1, 0.8)).to_track_quat("Z", "Y")
    scene.collection.objects.link(sun)
    scene.world = bpy.data.worlds.new("world")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs[0].default_value = (0.6, 0.7, 0.8, 1)
    scene.render.engine = "CYCLES"
    scene.cycles.samples = 24
    scene.cycles.volume_bounces = 12
    scene.cycles.max_bounces = 14
    scene.render.resolution_x, scene.render.resolution_y = 320, 240
    scene.render.film_transparent = True
    scene.render.filepath = picture
    bpy.ops.render.render(write_still=True)
    pixels = list(bpy.data.images.load(picture).pixels)[3::4]
    covered = sum(1 for alpha in pixels if alpha > 0.2) / len(pixels)
    assert 0.02 < covered < 0.9, f"the coat covers {covered} of the picture"
    print(f"OK {vdb}: {sorted(grids)}, covers {covered:.3f} of the picture")


main()
