"""The scene of cycles.py inside Blender: blender -b --python cycles_scene.py -- GROOM.hair SCENE.json SAMPLES BOUNCES THREADS SEED OUT.exr [PICTURE...]

Reads the very groom file and the camera, size, material and environment of the very scene file that `pelage trace` gets. Prints
`seconds SECONDS` of the call that renders, and `mean RADIANCE FILE` of its picture and of each further one. A name OUT.gbuffer.exr gets
the channels that `pelage denoise` reads. Blender 3.4 makes hair objects from Python only by way of geometry nodes: the strands
stand in a curve object, which a node group hands over to a hair object with their radii.
"""
import json
import math
import struct
import sys
import time

import bpy
import mathutils
import numpy


def read_cyhair(path):
    """Points [strand][point][3] and the diameter of a groom that pelage wrote (meters, Z up), with Y up as in its scenes."""
    data = open(path, "rb").read()
    magic, strands, points, bits, segments, thickness = struct.unpack_from("<4sIIIIf", data)
    assert magic == b"HAIR", "not a cyHAIR file"
    at = 128
    if bits & 1:
        counts = numpy.frombuffer(data, "<u2", strands, at)
        segments = int(counts[0])
        assert (counts == segments).all(), "strands of one length are expected"
        at += 2 * strands
    xyz = numpy.frombuffer(data, "<f4", 3 * points, at).reshape(strands, segments + 1, 3)
    at += 12 * points
    if bits & 4:
        thickness = float(numpy.median(numpy.frombuffer(data, "<f4", points, at)))
    return numpy.stack([xyz[..., 0], xyz[..., 2], -xyz[..., 1]], axis=-1), thickness


def strand_curves(xyz):
    curves = bpy.data.curves.new("strands", "CURVE")
    curves.dimensions = "3D"
    for strand in xyz:
        spline = curves.splines.new("POLY")
        spline.points.add(len(strand) - 1)
        spline.points.foreach_set("co", numpy.hstack([strand, numpy.ones((len(strand), 1), "f4")]).ravel())
    return bpy.data.objects.new("strands", curves)


def hair_object(strands, radius, material):
    hair = bpy.data.objects.new("hair", bpy.data.hair_curves.new("hair"))
    hair.data.materials.append(material)
    group = bpy.data.node_groups.new("hair", "GeometryNodeTree")
    group.inputs.new("NodeSocketGeometry", "in")
    group.outputs.new("NodeSocketGeometry", "out")
    info = group.nodes.new("GeometryNodeObjectInfo")
    info.inputs["Object"].default_value = strands
    set_radius = group.nodes.new("GeometryNodeSetCurveRadius")
    set_radius.inputs["Radius"].default_value = radius
    set_material = group.nodes.new("GeometryNodeSetMaterial")
    set_material.inputs["Material"].default_value = material
    output = group.nodes.new("NodeGroupOutput")
    group.links.new(info.outputs["Geometry"], set_radius.inputs["Curve"])
    group.links.new(set_radius.outputs["Curve"], set_material.inputs["Geometry"])
    group.links.new(set_material.outputs["Geometry"], output.inputs[0])
    hair.modifiers.new("hair", "NODES").node_group = group
    return hair


def solve(function, value):
    """x in 0...1 where a rising function reaches the value."""
    low, high = 0.0, 1.0
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if function(middle) < value else (low, middle)
    return low


def hair_material(fiber):
    """Principled Hair with the absorption and the roughness of a material of Pelage (Chiang 2016, eq. 7 and 8, inverted)."""
    material = bpy.data.materials.new("hair")
    material.use_nodes = True
    nodes = material.node_tree.nodes
    nodes.clear()
    hair = nodes.new("ShaderNodeBsdfHairPrincipled")
    hair.parametrization = "ABSORPTION"
    # d'Eon 2011, table 1: as Pelage has it.
    hair.inputs["Absorption Coefficient"].default_value = [
        fiber["eumelanin"] * e + fiber["pheomelanin"] * p for e, p in ((0.419, 0.187), (0.697, 0.4), (1.37, 1.05))]
    longitudinal = 2 * math.radians(fiber["beta_longitudinal"])
    azimuthal = math.radians(fiber["beta_azimuthal"]) * math.sqrt(3) / math.pi
    hair.inputs["Roughness"].default_value = solve(lambda b: 0.726 * b + 0.812 * b**2 + 3.7 * b**20, longitudinal)
    hair.inputs["Radial Roughness"].default_value = solve(
        lambda b: math.sqrt(math.pi / 8) * (0.265 * b + 1.194 * b**2 + 5.372 * b**22), azimuthal)
    hair.inputs["Coat"].default_value = 0
    hair.inputs["IOR"].default_value = fiber["eta"]
    hair.inputs["Offset"].default_value = math.radians(fiber["cuticle_tilt"])
    hair.inputs["Random Color"].default_value = hair.inputs["Random Roughness"].default_value = 0
    output = nodes.new("ShaderNodeOutputMaterial")
    material.node_tree.links.new(hair.outputs[0], output.inputs["Surface"])
    return material


def add_gbuffer(scene, material):
    """Passes, and outputs of the material, that `pelage denoise` reads (docs/denoise.md)."""
    layer = scene.view_layers[0]
    layer.use_pass_position = layer.use_pass_z = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    hair, geometry = nodes.new("ShaderNodeHairInfo"), nodes.new("ShaderNodeNewGeometry")
    for name, kind, value in (("strand", "VALUE", hair.outputs["Random"]), ("u", "VALUE", hair.outputs["Intercept"]),
                              ("tangent", "COLOR", geometry.outputs["Tangent"])):
        aov = layer.aovs.add()
        aov.name, aov.type = name, kind
        output = nodes.new("ShaderNodeOutputAOV")
        output.name = name
        links.new(value, output.inputs["Value" if kind == "VALUE" else "Color"])
    scene.render.image_settings.file_format = "OPEN_EXR_MULTILAYER"


def print_mean(path):
    image = bpy.data.images.load(path)
    pixels = numpy.empty(len(image.pixels), "f4")
    image.pixels.foreach_get(pixels)
    print("mean", pixels.reshape(-1, image.channels)[:, :3].mean(dtype="f8"), path)


def look(camera, eye, target):
    """Y is up, as in the scene file."""
    back = (mathutils.Vector(eye) - mathutils.Vector(target)).normalized()
    right = mathutils.Vector((0, 1, 0)).cross(back).normalized()
    camera.matrix_world = mathutils.Matrix.Translation(eye) @ mathutils.Matrix((right, back.cross(right), back)).transposed().to_4x4()


def main():
    groom, scene_file, samples, bounces, threads, seed, out, *pictures = sys.argv[sys.argv.index("--") + 1:]
    description = json.load(open(scene_file))
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    xyz, diameter = read_cyhair(groom)
    strands = strand_curves(xyz)
    hair = hair_object(strands, diameter / 2, hair_material(description["grooms"][0]["material"]))
    scene.collection.objects.link(hair)

    eye, target = description["camera"]["eye"], description["camera"]["target"]
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.data.sensor_fit = "VERTICAL"
    camera.data.angle = math.radians(description["camera"]["fov"])
    camera.data.clip_start = 0.001
    look(camera, eye, target)
    scene.collection.objects.link(camera)
    scene.camera = camera

    scene.world = bpy.data.worlds.new("world")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (*description["environment"]["radiance"], 1)

    render = scene.render
    render.engine = "CYCLES"
    width, height = description["settings"]["width"], description["settings"]["height"]
    render.resolution_x, render.resolution_y, render.resolution_percentage = width, height, 100
    render.threads_mode, render.threads = "FIXED", int(threads)
    render.filepath = out
    render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR", "32"
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.samples, cycles.seed = int(samples), int(seed)
    cycles.pixel_filter_type = "BOX"
    cycles.use_adaptive_sampling = False
    cycles.use_denoising = False
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = cycles.transmission_bounces = int(bounces)
    cycles.transparent_max_bounces = int(bounces)
    cycles.blur_glossy = cycles.sample_clamp_indirect = 0  # the same fiber and all light at every bounce
    scene.cycles_curves.shape = "RIBBONS"
    is_gbuffer = out.endswith(".gbuffer.exr")
    if is_gbuffer:
        add_gbuffer(scene, hair.data.materials[0])

    start = time.perf_counter()
    bpy.ops.render.render(write_still=True)
    print("seconds", time.perf_counter() - start)
    for picture in (*([] if is_gbuffer else [out]), *pictures):
        print_mean(picture)


main()
