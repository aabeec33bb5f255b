# SPDX-License-Identifier: CC0-1.0
"""Writes the tiny glTF scenes of the regression pictures into scenes/ (or a folder given): a feature or two each.

They are .gltf with their bytes inside, so that a test can change one word of one and see the picture fail.
"""

import math
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "scenes"))

from glb import ARRAY_BUFFER, FLOAT, MATTE, about, looking, write_pfm  # noqa: E402
from gltf_text import Gltf, png, painted, letter, holes, bumps, rough_metal, brushes, MIRRORED, CLAMPED, REPEATED  # noqa: E402
from shapes import Mesh, ball, box, quad  # noqa: E402


def ground(gltf, colour=(0.5, 0.5, 0.5), size=3.0, **properties):
    material = gltf.material("ground", colour, **(properties or MATTE))
    floor = quad((-size, 0, size), (size, 0, size), (size, 0, -size), (-size, 0, -size))
    gltf.mesh("ground", [(floor, material)])


def lamp(gltf, radiance=(9, 8, 7), height=2.6, half=0.7, double_sided=False):
    material = gltf.material("lamp", (0, 0, 0), emission=radiance, double_sided=double_sided, **MATTE)
    shape = quad((-half, height, -half), (half, height, -half), (half, height, half), (-half, height, half))
    gltf.mesh("lamp", [(shape, material)])


SPHERE = ball(0.6, 28, 14)


def balls(gltf, materials):
    """Spheres in a row on the ground."""
    for i, material in enumerate(materials):
        x = 1.35 * (i - (len(materials) - 1) / 2)
        gltf.mesh("ball", [(SPHERE, material)], translation=(x, 0.6, 0))


def with_uvs(*corners, scale=1.0, shift=0.0):
    """A quad whose texture coordinates run from the first corner along both edges."""
    uvs = [(0, scale), (scale, scale), (scale, 0), (0, 0)]
    return Mesh(list(corners), [(0, 1, 2), (0, 2, 3)], None, [(u + shift, v + shift) for u, v in uvs])


def upright(x, scale=1.0, shift=0.0, half=0.6):
    return with_uvs((x - half, 0.05, 0), (x + half, 0.05, 0), (x + half, 1.25, 0), (x - half, 1.25, 0),
                    scale=scale, shift=shift)


# --- the scenes ---


def room(glossy=False):
    gltf = Gltf(eye=(0, 1, 3.9), target=(0, 0.95, 0), yfov=0.62)
    white = gltf.material("white", (0.7, 0.7, 0.7), **MATTE)
    red = gltf.material("red", (0.6, 0.08, 0.06), **MATTE)
    green = gltf.material("green", (0.12, 0.45, 0.1), **MATTE)
    x, z = 1.3, 1.2
    gltf.mesh("floor", [(quad((-x, 0, z), (x, 0, z), (x, 0, -z), (-x, 0, -z)), white)])
    gltf.mesh("ceiling", [(quad((-x, 2, -z), (x, 2, -z), (x, 2, z), (-x, 2, z)), white)])
    gltf.mesh("back", [(quad((-x, 0, -z), (x, 0, -z), (x, 2, -z), (-x, 2, -z)), white)])
    gltf.mesh("left", [(quad((-x, 0, z), (-x, 0, -z), (-x, 2, -z), (-x, 2, z)), red)])
    gltf.mesh("right", [(quad((x, 0, -z), (x, 0, z), (x, 2, z), (x, 2, -z)), green)])
    lamp(gltf, (11, 9, 6), 1.98, 0.4)
    gltf.mesh("block", [(box((-0.3, 0, -0.3), (0.3, 0.9, 0.3)), white)], translation=(-0.4, 0, -0.3),
              rotation=about((0, 1, 0), 25))
    if glossy:
        gltf.mesh("glossy", [(SPHERE, gltf.material("glossy", (0.9, 0.7, 0.4), metallic=1, roughness=0.4))],
                  translation=(0.55, 0.5, 0.3), scale=(0.8, 0.8, 0.8))
    return gltf


def glossy_room():
    return room(True)


def indirect():
    """A room lit through a gap above a screen: all light in view has been reflected."""
    gltf = room()
    black = gltf.material("screen", (0.5, 0.5, 0.6), double_sided=True, **MATTE)
    gltf.mesh("screen", [(box((-0.7, 1.62, -0.7), (0.7, 1.65, 0.7)), black)])
    return gltf


def metals():
    gltf = Gltf()
    ground(gltf, (0.3, 0.35, 0.4))
    gold = (1.0, 0.77, 0.34)
    balls(gltf, [gltf.material(f"r{r}", gold, metallic=1, roughness=r) for r in (0.0, 0.3, 0.65)])
    return gltf


def coats():
    gltf = Gltf()
    ground(gltf)
    balls(gltf, [
        gltf.material("smooth", (0.7, 0.1, 0.1), roughness=0.0),
        gltf.material("satin", (0.1, 0.5, 0.15), roughness=0.4, ior=1.9),
        gltf.material("mixed", (0.2, 0.3, 0.8), metallic=0.5, roughness=0.5)
    ])
    return gltf


def layers():
    """A room of surfaces under a clear coat, under sheen and under both."""

    def coat(roughness):
        return {"KHR_materials_clearcoat": {"clearcoatFactor": 1, "clearcoatRoughnessFactor": roughness}}

    def sheen(colour, roughness):
        return {"KHR_materials_sheen": {"sheenColorFactor": colour, "sheenRoughnessFactor": roughness}}

    gltf = room()
    gltf.more(0, extensions=sheen([0.3, 0.4, 0.6], 0.5))
    gltf.more(1, extensions=coat(0.35))
    gltf.more(2, extensions={**coat(0.6), **sheen([0.5, 0.5, 0.2], 0.7)})
    lacquer = gltf.more(gltf.material("lacquer", (0.5, 0.3, 0.1), roughness=0.7), extensions=coat(0.3))
    gltf.mesh("boards", [(quad((-1.3, 0.002, 1.2), (1.3, 0.002, 1.2), (1.3, 0.002, -1.2), (-1.3, 0.002, -1.2)), lacquer)])
    car = gltf.more(gltf.material("car", (0.8, 0.5, 0.2), metallic=1, roughness=0.6), extensions=coat(0.25))
    gltf.mesh("car", [(SPHERE, car)], translation=(0.55, 0.5, 0.3), scale=(0.8, 0.8, 0.8))
    return gltf


def specular():
    gltf = Gltf()
    ground(gltf)
    balls(gltf, [
        gltf.material("none", (0.5, 0.5, 0.5), roughness=0.3, specular=0.0),
        gltf.more(gltf.material("tinted", (0.2, 0.2, 0.2), roughness=0.3),
                  extensions={"KHR_materials_specular": {"specularColorFactor": [4.0, 1.0, 0.2]}}),
        gltf.material("half", (0.5, 0.5, 0.5), roughness=0.3, specular=0.5, ior=2.2)
    ])
    return gltf


def glass():
    gltf = Gltf()
    ground(gltf)
    absorbing = gltf.material("absorbing", (1, 1, 1), roughness=0, transmission=1.0, thickness=1.0, ior=1.5)
    gltf.document["materials"][absorbing]["extensions"]["KHR_materials_volume"].update(
        {"attenuationColor": [0.9, 0.4, 0.2], "attenuationDistance": 0.7})
    balls(gltf, [
        gltf.material("clear", (1, 1, 1), roughness=0, transmission=1.0, thickness=1.0, ior=1.5), absorbing,
        gltf.material("rough", (0.9, 1, 0.9), roughness=0.45, transmission=1.0, thickness=1.0, ior=1.33)
    ])
    return gltf


def thin_glass():
    gltf = Gltf()
    ground(gltf)
    lamp(gltf, (6, 6, 6))
    panes = [
        gltf.material("pane", (0.9, 0.5, 0.3), roughness=0, transmission=1.0),
        gltf.material("frosted", (0.8, 0.9, 1), roughness=0.5, transmission=1.0),
        gltf.material("half", (0.4, 0.7, 0.3), roughness=0, transmission=0.5)
    ]
    for x, pane in zip((-1.3, 0, 1.3), panes):
        gltf.mesh("pane", [(upright(x, half=0.5), pane)], translation=(0, 0, 0.3))
    blue = gltf.material("post", (0.2, 0.3, 0.8), **MATTE)
    gltf.mesh("post", [(box((-1.7, 0, -0.9), (1.7, 0.45, -0.6)), blue)])
    return gltf


def wraps():
    """A letter out of its square: repeated, mirrored, clamped."""
    gltf = Gltf(eye=(0, 0.65, 4), target=(0, 0.65, 0))
    image = painted(16, letter)
    for x, wrap in ((-1.3, REPEATED), (0, MIRRORED), (1.3, CLAMPED)):
        texture = gltf.picture(image, wrap)
        gltf.mesh("sign", [(upright(x, 2.0, -0.35), gltf.material("sign", texture=texture, **MATTE))])
    return gltf


def texture_transform():
    gltf = Gltf(eye=(0, 0.65, 4), target=(0, 0.65, 0))
    for x, transform in ((-1.3, {}), (0, {"offset": [0.3, -0.2], "rotation": 0.5}),
                         (1.3, {"rotation": -0.3, "scale": [1.7, 0.8]})):
        texture = gltf.picture(painted(16, letter), REPEATED, nearest=x < 0)
        material = gltf.material("sign", texture=texture, **MATTE)
        gltf.document["materials"][material]["pbrMetallicRoughness"]["baseColorTexture"]["extensions"] = {
            "KHR_texture_transform": transform
        }
        gltf.mesh("sign", [(upright(x), material)])
    gltf._use("KHR_texture_transform")
    return gltf


def normal_map():
    gltf = Gltf(eye=(0, 0.65, 4), target=(0, 0.65, 0))
    bumpy = gltf.picture(painted(16, bumps))
    for x, scale in ((-0.7, 1.0), (0.7, 0.5)):
        material = gltf.material("bumpy", (0.7, 0.7, 0.7), **MATTE)
        gltf.more(material, normalTexture={"index": bumpy, "scale": scale})
        gltf.mesh("sign", [(upright(x), material)])
    gltf.light("directional", (3, 3, 3), (2, 2.5, 2))
    return gltf


def rough_metal_map():
    gltf = Gltf(eye=(0, 1.6, 3), target=(0, 0.3, 0))
    material = gltf.material("map", (0.9, 0.6, 0.4), metallic=1, roughness=1)
    gltf.more(material, {"metallicRoughnessTexture": {"index": gltf.picture(painted(16, rough_metal), CLAMPED)}})
    floor = with_uvs((-1.5, 0, 1.2), (1.5, 0, 1.2), (1.5, 0, -1.2), (-1.5, 0, -1.2))
    gltf.mesh("floor", [(floor, material)])
    return gltf


def alpha():
    """A mask, a blend, both with shadows; a vertex-coloured square that ignores its alpha."""
    gltf = Gltf()
    ground(gltf)
    lamp(gltf, (9, 9, 9))
    image = painted(16, holes)
    for x, mode in ((-1.2, {"alphaMode": "MASK", "alphaCutoff": 0.5}), (0, {"alphaMode": "BLEND"}), (1.2, {})):
        material = gltf.material("holes", texture=gltf.picture(image, CLAMPED), **MATTE)
        gltf.mesh("sheet", [(upright(x, half=0.5), gltf.more(material, **mode))])
    return gltf


def vertex_colours():
    gltf = Gltf()
    material = gltf.material("painted", (1, 1, 1), **MATTE)
    colours = [(0.9, 0.1, 0.1, 1), (0.1, 0.9, 0.1, 1), (0.1, 0.1, 0.9, 1), (0.9, 0.9, 0.9, 1)]
    gltf.coloured(upright(0, half=1.2), colours, material)
    ground(gltf)
    return gltf


def bright_picture():
    """A picture that glows and lights the ground; the back of a lamp is dark, of the other is not."""
    gltf = Gltf(eye=(0.8, 1.6, 3.4), target=(0, 0.5, 0))
    ground(gltf)
    glowing = gltf.material("glowing", (0, 0, 0), emission=(5, 5, 5), **MATTE)
    gltf.more(glowing, emissiveTexture={"index": gltf.picture(painted(16, letter), CLAMPED)})
    gltf.mesh("screen", [(upright(0), glowing)], translation=(-0.4, 0, -0.6))
    for x, both in ((0.8, True), (1.5, False)):
        light = gltf.material("side", (0, 0, 0), emission=(4, 2, 1), double_sided=both, **MATTE)
        panel = with_uvs((x, 0.2, -0.3), (x, 0.2, 0.3), (x, 0.8, 0.3), (x, 0.8, -0.3))
        gltf.mesh("panel", [(panel, light)])
    return gltf


def punctual():
    """Point, spot and directional light, each of a colour."""
    gltf = Gltf()
    ground(gltf, (0.7, 0.7, 0.7))
    balls(gltf, [gltf.material("ball", (0.7, 0.7, g), **MATTE) for g in (0.7, 0.2)])
    gltf.light("point", (5, 1.5, 1), (-1.4, 1.8, 1))
    gltf.light("spot", (0.6, 6, 1), (1.2, 2.4, 1.2), (0.6, 0, 0.2), innerConeAngle=0.2, outerConeAngle=0.5)
    gltf.light("directional", (0.05, 0.1, 0.35), (1, 2, -1.5))
    return gltf


def many_lights():
    """Sixty glowing tiles and eight points: a light tree."""
    gltf = Gltf(eye=(0, 2.2, 4.2), target=(0, 0.2, 0))
    ground(gltf, (0.6, 0.6, 0.6))
    colours = ((6, 1, 1), (1, 6, 1), (1, 1, 6), (4, 4, 1))
    glow = [gltf.material("tile", (0, 0, 0), emission=c, **MATTE) for c in colours]
    tile = quad((-0.06, 0, -0.06), (0.06, 0, -0.06), (0.06, 0, 0.06), (-0.06, 0, 0.06))
    for i in range(60):
        x, z = (i % 10 - 4.5) * 0.42, (i // 10 - 2.5) * 0.5
        gltf.mesh("tile", [(tile, glow[(i * 7 + i // 10) % 4])], translation=(x, 0.25 + 0.02 * (i % 7), z))
    for i in range(8):
        gltf.light("point", (0.06, 0.05, 0.08), ((i - 3.5) * 0.5, 0.3, 1.5 - 0.4 * (i % 3)))
    return gltf


def instances():
    """One mesh under nested nodes: turned, stretched, mirrored."""
    gltf = Gltf()
    ground(gltf)
    lamp(gltf)
    material = gltf.material("clay", (0.7, 0.4, 0.3), roughness=0.6)
    gltf.mesh("first", [(SPHERE, material)], translation=(-1.3, 0.5, 0), scale=(0.9, 0.6, 0.5),
              rotation=about((0, 0, 1), 30))
    mesh = len(gltf.document["meshes"]) - 1
    parent = gltf.node("parent", translation=(0.5, 0.7, 0), rotation=about((0, 1, 0), 40), scale=(1, 1, -0.7))
    gltf.node("child", parent, mesh=mesh, scale=(0.5, 1.1, 0.6))
    gltf.node("other", parent, mesh=mesh, translation=(0.9, -0.2, 0), scale=(-0.5, 0.4, 1.2),
              rotation=about((1, 0, 0), 25))
    return gltf


def orthographic():
    gltf = Gltf(eye=None)
    ground(gltf)
    lamp(gltf)
    balls(gltf, [gltf.material("ball", (0.6, 0.5, 0.3), roughness=0.5)] * 2)
    camera = gltf._append("cameras", {
        "name": "flat", "type": "orthographic",
        "orthographic": {"xmag": 1.8, "ymag": 1.2, "znear": 0.01, "zfar": 100}
    })
    gltf.node("flat", camera=camera, translation=(2, 3, 3), rotation=looking((2, 3, 3), (0, 0.4, 0)))
    return gltf


def mirrors():
    """A specular prefix: matte things seen in mirrors."""
    gltf = Gltf()
    ground(gltf, (0.6, 0.5, 0.4))
    lamp(gltf)
    mirror = gltf.material("mirror", (0.9, 0.9, 0.95), metallic=1, roughness=0)
    gltf.mesh("mirror", [(upright(0, half=1.6), mirror)], translation=(0, 0, -1), scale=(1, 1.4, 1))
    balls(gltf, [gltf.material("ball", c, **MATTE) for c in ((0.7, 0.2, 0.2), (0.2, 0.3, 0.7))])
    return gltf


def brushed_disk():
    """A metal disk brushed around its middle, in coordinates that turn with it: tangents lie along the radius,
    across the brushing."""
    rings, spokes, radius = 6, 48, 1.15
    positions, uvs, tangents = [], [], []
    for i in range(rings + 1):
        for k in range(spokes + 1):
            angle, r = 2 * math.pi * k / spokes, 0.08 + (radius - 0.08) * i / rings
            positions.append((r * math.cos(angle), r * math.sin(angle), 0))
            uvs.append((i / rings, k / spokes))
            tangents.append((math.cos(angle), math.sin(angle), 0, 1))
    triangles = []
    for i in range(rings):
        for k in range(spokes):
            a, b = i * (spokes + 1) + k, (i + 1) * (spokes + 1) + k
            triangles += [(a, b, b + 1), (a, b + 1, a + 1)]
    return Mesh(positions, triangles, [(0, 0, 1)] * len(positions), uvs), tangents


def brushed():
    """KHR_materials_anisotropy: a disk by its tangents under points of light; a ball along a texture's direction."""
    gltf = Gltf(eye=(0, 1.5, 4.2), target=(0, 0.8, 0))
    ground(gltf, (0.25, 0.25, 0.28))
    steel = gltf.more(gltf.material("steel", (0.7, 0.7, 0.72), metallic=1, roughness=0.3),
                      extensions={"KHR_materials_anisotropy": {"anisotropyStrength": 0.6}})
    disk, tangents = brushed_disk()
    gltf.mesh("disk", [(disk, steel)], translation=(-0.75, 1.05, -0.3), rotation=about((1, 0, 0), -25),
              scale=(0.85, 0.85, 0.85))
    gltf.document["meshes"][-1]["primitives"][0]["attributes"]["TANGENT"] = gltf._accessor(
        tangents, FLOAT, "VEC4", ARRAY_BUFFER)
    painted_lacquer = gltf.more(
        gltf.material("lacquer", (0.5, 0.12, 0.05), metallic=0.3, roughness=0.3),
        extensions={
            "KHR_materials_anisotropy": {
                "anisotropyStrength": 0.9,
                "anisotropyRotation": 0.5,
                "anisotropyTexture": {"index": gltf.picture(painted(8, brushes), CLAMPED)}
            }
        })
    gltf.mesh("sheet", [(with_uvs((0.35, 0.02, 0.9), (1.75, 0.02, 0.9), (1.75, 0.9, -0.3), (0.35, 0.9, -0.3)),
                         painted_lacquer)])
    for x in (-1.6, 0.2, 1.7):
        gltf.light("point", (3, 2.7, 2.3), (x, 2.4, 1.8))
    lamp(gltf, (4, 4, 5), 3.2, 0.5)
    return gltf


SCENES = [
    room, glossy_room, indirect, metals, coats, layers, specular, glass, thin_glass, wraps, texture_transform, normal_map,
    rough_metal_map, brushed, alpha, vertex_colours, bright_picture, punctual, many_lights, instances, orthographic,
    mirrors
]


def main():
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else HERE / "scenes"
    for scene in SCENES:
        scene().save(folder, scene.__name__.replace("_", "-"))
    (folder / "letter.png").write_bytes(painted(16, letter))  # for the pbrt scenes
    write_pfm(folder / "gonio.pfm", 8, 8, [(0.1 + 0.25 * (x % 4), 0.1 + 0.2 * (y % 5), 0.2) for y in range(8)
                                           for x in range(8)])


if __name__ == "__main__":
    main()
