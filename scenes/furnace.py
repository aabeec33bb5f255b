# SPDX-License-Identifier: CC0-1.0
"""Writes the white furnaces: scenes in which a renderer that neither loses nor invents energy sees radiance 1.

furnace-walls-50.glb, -80.glb   closed room with a block, emission 1 - rho and albedo rho (.5, .8) everywhere
furnace-KIND.glb + white.pfm    a white sphere of one BSDF in an environment of radiance 1

Everything is flat-shaded: interpolated normals would lose energy at silhouettes by themselves.
"""

from glb import MATTE, Glb, output_folder, write_pfm
from shapes import box, icosphere, joined, moved, rewound, rotation

SOLID = {"transmission": 1.0, "thickness": 1.0, "ior": 1.5}
KINDS = {
    "diffuse": MATTE,
    "metal": {
        "metallic": 1.0,
        "roughness": 0.3
    },
    "dielectric": {
        "metallic": 0.0,
        "roughness": 0.3
    },
    "glass": {
        "roughness": 0.0,
        **SOLID
    },
    "rough-glass": {
        "roughness": 0.3,
        **SOLID
    },
}


def main():
    folder = output_folder("")
    for percent in (50, 80):
        walls(percent / 100).write(folder / f"furnace-walls-{percent}.glb")
    for kind, properties in KINDS.items():
        sphere(kind, properties).write(folder / f"furnace-{kind}.glb")
    write_pfm(folder / "white.pfm", 4, 2, [(1.0, 1.0, 1.0)] * 8)


def walls(albedo):
    glb = Glb("furnace.py")
    emission = 1 - albedo
    material = glb.material("wall", (albedo, ) * 3, emission=(emission, ) * 3, **MATTE)
    room = rewound(box((-1, -1, -1), (1, 1, 1)))
    block = moved(box((-0.3, -0.5, -0.2), (0.3, 0.5, 0.2)),
                  offset=(0.2, -0.3, -0.3),
                  turn=rotation((0.6, 0.8, 0), 40))
    glb.mesh("room and block", [(joined([room, block]), material)])
    glb.camera("camera", eye=(-0.4, 0.3, 0.8), target=(0.2, -0.2, -0.3), yfov=1.2, aspect=1.0)
    return glb


def sphere(kind, properties):
    glb = Glb("furnace.py")
    glb.mesh("sphere", [(icosphere(level=3), glb.material(kind, **properties))])
    glb.camera("camera", eye=(0, 0, 4), target=(0, 0, 0), yfov=0.6, aspect=1.0)
    return glb


if __name__ == "__main__":
    main()
