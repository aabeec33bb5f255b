# SPDX-License-Identifier: CC0-1.0
"""Writes validation/: two small scenes for block-mean comparisons with other renderers.

room.glb             closed room, one-sided lamp; matte, metal (GGX alpha 0.09) and half-and-half surfaces
open.glb, sky.pfm    the same kinds of surface under a smooth 64 × 32 environment with a warm, bright patch
"""

import math

from glb import MATTE, Glb, about, output_folder, write_pfm
from shapes import box, box_sides, icosphere, moved, quad, rewound

METAL = {"metallic": 1.0, "roughness": 0.3}
MIX = {"metallic": 0.5, "roughness": 0.3, "specular": 0.0}
UP = (0, 1, 0)


def main():
    folder = output_folder("validation")
    folder.mkdir(exist_ok=True)
    room().write(folder / "room.glb")
    under_the_sky().write(folder / "open.glb")
    write_sky(folder / "sky.pfm", 64, 32)


def room():
    glb = Glb("validation.py")
    white = glb.material("white", (0.7, 0.7, 0.7), double_sided=True, **MATTE)
    ochre = glb.material("ochre", (0.6, 0.35, 0.1), double_sided=True, **MATTE)
    floor = glb.material("floor", (0.55, 0.6, 0.65), double_sided=True, **MIX)
    metal = glb.material("metal", (0.9, 0.7, 0.5), double_sided=True, **METAL)
    lamp = glb.material("lamp", (0, 0, 0), emission=(12.0, 11.0, 9.0), **MATTE)

    walls = {"left": ochre, "right": white, "floor": floor, "ceiling": white, "back": white, "front": white}
    for (name, material), side in zip(walls.items(), box_sides((-1, 0, -1), (1, 2, 3))):
        glb.mesh(name, [(rewound(side), material)])
    glb.mesh("lamp", [(quad((-0.4, 1.99, -0.3), (0.4, 1.99, -0.3), (0.4, 1.99, 0.5),
                            (-0.4, 1.99, 0.5)), lamp)])
    glb.mesh("block", [(box((-0.25, 0, -0.25), (0.25, 1.1, 0.25)), metal)],
             translation=(-0.4, 0, -0.35),
             rotation=about(UP, 20))
    glb.mesh("cube", [(box((-0.25, 0, -0.25), (0.25, 0.5, 0.25)), white)],
             translation=(0.4, 0, 0.2),
             rotation=about(UP, -18))
    glb.camera("camera", eye=(0, 1, 2.9), target=(0, 0.9, 0), yfov=0.75, aspect=1.0)
    return glb


def under_the_sky():
    glb = Glb("validation.py")
    ground = glb.material("ground", (0.5, 0.48, 0.45), double_sided=True, **MIX)
    matte = glb.material("matte", (0.7, 0.25, 0.2), double_sided=True, **MATTE)
    metal = glb.material("metal", (0.8, 0.8, 0.85), double_sided=True, **METAL)

    glb.mesh("ground", [(quad((-3, 0, 3), (3, 0, 3), (3, 0, -3), (-3, 0, -3)), ground)])
    glb.mesh("cube", [(box((-0.4, 0, -0.4), (0.4, 0.8, 0.4)), matte)],
             translation=(-0.7, 0, 0),
             rotation=about(UP, 30))
    glb.mesh("ball", [(moved(icosphere(level=2), scale=0.5), metal)], translation=(0.6, 0.5, 0.1))
    glb.camera("camera", eye=(0.3, 1.6, 3.6), target=(0, 0.4, 0), yfov=0.6, aspect=1.0)
    return glb


def write_sky(path, width, height):
    """Bluish gradient over a brown ground, and a warm patch of about 15° towards (1, 1, 1)."""
    pixels = []
    for row in range(height):
        polar = math.pi * (row + 0.5) / height
        for column in range(width):
            azimuth = 2 * math.pi * ((column + 0.5) / width - 0.5)  # of atan2(z, x)
            x, y, z = math.sin(polar) * math.cos(azimuth), math.cos(
                polar), math.sin(polar) * math.sin(azimuth)
            up = max(y, 0.0)
            base = (0.9 - 0.6 * up, 1.0 - 0.45 * up, 1.1 - 0.1 * up) if y > 0 else (0.25, 0.2, 0.15)
            glow = 40 * math.exp(60 * ((x + y + z) / math.sqrt(3) - 1))
            pixels.append(tuple(round(b + glow * warm, 4) for b, warm in zip(base, (1.0, 0.8, 0.5))))
    write_pfm(path, width, height, pixels)


if __name__ == "__main__":
    main()
