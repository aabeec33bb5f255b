#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A scene that Blender's exporter writes, rendered by relumine and by Cycles; block means compared; see README.md."""
import argparse
import json
import math
import pathlib
import random
import subprocess

import bpy
import numpy as np

SPHERES = {  # name: inputs of the Principled BSDF
    "chalk": {"Base Color": (0.8, 0.75, 0.7, 1), "Roughness": 1.0, "Specular IOR Level": 0.0},
    "plastic": {"Base Color": (0.1, 0.3, 0.7, 1), "Roughness": 0.35},
    "white": {"Base Color": (0.9, 0.9, 0.9, 1), "Roughness": 0.5},
    "gold": {"Base Color": (0.9, 0.6, 0.2, 1), "Roughness": 0.3, "Metallic": 1.0},
    "lacquer": {"Base Color": (0.6, 0.05, 0.03, 1), "Roughness": 0.6, "Coat Weight": 1.0, "Coat Roughness": 0.1},
    "coated metal": {"Base Color": (0.5, 0.5, 0.55, 1), "Roughness": 0.5, "Metallic": 1.0, "Coat Weight": 1.0,
                     "Coat Roughness": 0.05},
    "cloth": {"Base Color": (0.15, 0.05, 0.2, 1), "Roughness": 0.9, "Sheen Weight": 0.6, "Sheen Roughness": 0.5,
              "Sheen Tint": (0.9, 0.8, 1, 1)},
}


def material(name, inputs, texture=None):
    made = bpy.data.materials.new(name)
    nodes, links = made.node_tree.nodes, made.node_tree.links
    bsdf = nodes["Principled BSDF"]
    bsdf.distribution = "GGX"  # single scattering, as ours
    for key, value in inputs.items():
        bsdf.inputs[key].default_value = value
    if texture:
        node = nodes.new("ShaderNodeTexImage")
        node.image = texture
        links.new(node.outputs["Color"], bsdf.inputs["Base Color"])
    return made


def checker():
    """8 x 8 fields of two colours; packed, so that it travels in the .glb."""
    image = bpy.data.images.new("checker", 64, 64)
    y, x = np.mgrid[0:64, 0:64] // 8
    pixels = np.where(((x + y) % 2)[..., None], (0.75, 0.72, 0.65, 1), (0.25, 0.3, 0.35, 1))
    image.pixels.foreach_set(pixels.astype(np.float32).ravel())
    image.pack()
    return image


def placed(add, name, mat, **where):
    add(**where)
    thing = bpy.context.object
    thing.name = name
    thing.data.materials.append(mat)
    return thing


def build(size):
    """Floor, wall, spheres of each material, instanced cubes; a point light, a sun and a glowing panel."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    render = bpy.context.scene.render  # its aspect goes into the exported camera
    render.resolution_x = render.resolution_y = size
    render.resolution_percentage = 100
    mesh = bpy.ops.mesh
    placed(mesh.primitive_plane_add, "floor", material("floor", {"Roughness": 1, "Specular IOR Level": 0}, checker()),
           size=12)
    placed(mesh.primitive_plane_add, "wall", material("wall", {"Base Color": (0.6, 0.6, 0.6, 1), "Roughness": 1,
                                                               "Specular IOR Level": 0}),
           size=12, location=(0, 3.5, 6), rotation=(math.pi / 2, 0, 0))
    for i, (name, inputs) in enumerate(SPHERES.items()):
        at = (1.35 * (i % 4 - 1.5) + (0.7 if i > 3 else 0), 1.2 - 1.7 * (i // 4), 0.6)
        sphere = placed(mesh.primitive_uv_sphere_add, name, material(name, inputs), radius=0.6, location=at,
                        segments=96, ring_count=48)
        for polygon in sphere.data.polygons:
            polygon.use_smooth = True
    cube = placed(mesh.primitive_cube_add, "cube", material("cube", {"Base Color": (0.2, 0.5, 0.25, 1),
                                                                     "Roughness": 0.8}), size=0.3,
                  location=(-2.4, -1.6, 0.15))
    numbers = random.Random(1)
    for i in range(8):
        copy = bpy.data.objects.new(f"cube {i}", cube.data)  # shares the mesh
        copy.location = (-1.8 + 0.55 * i, -1.7 + 0.1 * numbers.random(), 0.15)
        copy.rotation_euler = (0, 0, numbers.random())
        bpy.context.collection.objects.link(copy)
    placed(mesh.primitive_plane_add, "panel", material("panel", {"Base Color": (0, 0, 0, 1), "Roughness": 1,
                                                                 "Specular IOR Level": 0,
                                                                 "Emission Color": (1, 0.8, 0.6, 1),
                                                                 "Emission Strength": 12}),
           size=1.2, location=(-3.2, 0, 3), rotation=(0, math.radians(125), 0))
    for kind, name, energy, at in (("POINT", "lamp", 250, (2.5, -2, 4)), ("SUN", "sun", 0.8, (0, 0, 5))):
        light = bpy.data.lights.new(name, kind)
        light.energy = energy
        if kind == "POINT":
            light.shadow_soft_size = 0  # a point, as in the file
        else:
            light.angle = 0
        thing = bpy.data.objects.new(name, light)
        thing.location = at
        thing.rotation_euler = (math.radians(35), math.radians(-25), 0)
        bpy.context.collection.objects.link(thing)
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.location, camera.rotation_euler = (0, -7.5, 3.4), (math.radians(70), 0, 0)
    bpy.context.collection.objects.link(camera)
    bpy.context.scene.camera = camera


def export(path, args):
    bpy.ops.export_scene.gltf(filepath=str(path), export_format="GLB", export_lights=True, export_cameras=True,
                              export_import_convert_lighting_mode="COMPAT",  # watts over 4 pi, not lumens
                              export_draco_mesh_compression_enable=args.draco,
                              export_image_format="WEBP" if args.webp else "AUTO")


def read_picture(path):
    image = bpy.data.images.load(str(path))
    width, height = image.size
    pixels = np.empty(width * height * 4, np.float32)
    image.pixels.foreach_get(pixels)
    return pixels.reshape(height, width, 4)[::-1, :, :3].astype(np.float64)


def read_pfm(path):
    """height x width x 3, top row first."""
    with open(path, "rb") as file:
        kind = file.readline().strip()
        width, height = map(int, file.readline().split())
        order = "<f4" if float(file.readline()) < 0 else ">f4"
        if kind != b"PF":
            raise SystemExit(f"{path}: expected a colour PFM, found {kind!r}")
        return np.frombuffer(file.read(), order).reshape(height, width, 3)[::-1].astype(np.float64)


def render_cycles(args):
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    cycles = scene.cycles
    cycles.device, cycles.samples, cycles.use_denoising, cycles.use_adaptive_sampling = "CPU", args.spp, False, False
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = args.max_depth
    cycles.sample_clamp_indirect = cycles.sample_clamp_direct = cycles.blur_glossy = 0
    cycles.pixel_filter_type, cycles.filter_width = "BOX", 1
    world = bpy.data.worlds.new("dark")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0
    scene.world = world
    if args.threads:
        scene.render.threads_mode, scene.render.threads = "FIXED", args.threads
    scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "OPEN_EXR", "32"
    scene.render.filepath = str(args.out / "cycles.exr")
    bpy.ops.render.render(write_still=True)
    return read_picture(args.out / "cycles.exr")


def render_relumine(glb, args):
    picture = args.out / "relumine.pfm"
    # Cycles counts bounces after the first hit: as many as our scattering vertices less the one that lights it.
    subprocess.run([args.relumine, "render", str(glb), "-o", str(picture), "--quiet", "--method", args.method,
                    "--size", f"{args.size}x{args.size}", "--spp", str(args.spp), "--max-depth",
                    str(args.max_depth + 1), "--threads", str(args.threads)], check=True)
    return read_pfm(picture)


def block_means(picture, side):
    height, width, _ = picture.shape
    return picture.reshape(height // side, side, width // side, side, 3).mean(axis=(1, 3))


def save_png(picture, path):
    """As a screen shows it: sRGB."""
    clipped = np.clip(picture[::-1], 0, 1)
    shown = np.where(clipped <= 0.0031308, 12.92 * clipped, 1.055 * clipped ** (1 / 2.4) - 0.055)
    height, width, _ = picture.shape
    image = bpy.data.images.new(path.stem, width, height)
    image.pixels.foreach_set(np.dstack([shown, np.ones((height, width))]).astype(np.float32).ravel())
    image.filepath_raw, image.file_format = str(path), "PNG"
    image.save()


def sphere_masks(args):
    """Blocks whose centre lies well inside each sphere's outline and away from those of nearer spheres, which hide it."""
    from bpy_extras.object_utils import world_to_camera_view
    scene, camera = bpy.context.scene, bpy.context.scene.camera
    count = args.size // args.block
    y, x = (np.mgrid[0:count, 0:count] + 0.5) / count
    outlines = {}
    for name in SPHERES:
        u, v, depth = world_to_camera_view(scene, camera, bpy.data.objects[name].location)
        outlines[name] = u, 1 - v, 0.6 / (depth * 2 * math.tan(camera.data.angle / 2)), depth

    def within(name, share):
        u, v, radius, _ = outlines[name]
        return (x - u) ** 2 + (y - v) ** 2 < (share * radius) ** 2

    for name, (_, _, _, depth) in outlines.items():
        mask = within(name, 0.9)
        for other, (_, _, _, nearer) in outlines.items():
            if nearer < depth:
                mask &= ~within(other, 1.2)
        yield name, mask


def compare(ours, theirs, args):
    a, b = block_means(ours, args.block), block_means(theirs, args.block)
    lit = b.mean(axis=2) > 0.02 * b.mean()
    difference = (np.abs(a - b).mean(axis=2) / b.mean(axis=2).clip(1e-9))[lit]
    result = {"mean_ratio": float(ours.mean() / theirs.mean()), "blocks": int(lit.sum()),
              "median_difference": float(np.median(difference)),
              "difference_of_95_percent": float(np.percentile(difference, 95)),
              "median_ratio_by_sphere": {name: round(float(np.median(a[mask].mean(axis=1) / b[mask].mean(axis=1))), 3)
                                         for name, mask in sphere_masks(args)}}
    save_png(np.concatenate([ours, theirs], axis=1), args.out / "relumine-and-cycles.png")
    return result


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--relumine", default="build/release/relumine")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("cycles"), help="folder for what is made")
    parser.add_argument("--size", type=int, default=256, help="pixels")
    parser.add_argument("--block", type=int, default=4, help="pixels")
    parser.add_argument("--spp", type=int, default=256)
    parser.add_argument("--max-depth", type=int, default=6)
    parser.add_argument("--method", default="path")
    parser.add_argument("--threads", type=int, default=0)
    parser.add_argument("--draco", action="store_true", help="pack the meshes with Draco")
    parser.add_argument("--webp", action="store_true", help="pack the pictures as WebP")
    args = parser.parse_args()
    if args.size % args.block:
        raise SystemExit(f"--size: expected a multiple of --block = {args.block}, found {args.size}")
    args.out = args.out.resolve()
    args.out.mkdir(parents=True, exist_ok=True)
    build(args.size)
    export(args.out / "scene.glb", args)
    ours = render_relumine(args.out / "scene.glb", args)
    theirs = render_cycles(args)
    print(json.dumps({"blender": bpy.app.version_string, **compare(ours, theirs, args)}, indent=2))


if __name__ == "__main__":
    main()
