# SPDX-License-Identifier: CC0-1.0
"""Writes two scenes that are hard to light by chance.

hall.glb     44 m long, under 600 small lamps of three colours (1,200 emissive triangles), with glossy blocks
glazed.glb   a room whose one window has a clear pane and a brown one; to be lit by interior-sky.hdr
"""

import random

from glb import MATTE, Glb, about, output_folder
from shapes import box, box_sides, joined, quad, rewound, without_uvs


def main():
    folder = output_folder("")
    hall().write(folder / "hall.glb")
    glazed().write(folder / "glazed.glb")


def hall():
    glb = Glb("lights.py")
    long, wide, high = 40.0, 5.0, 5.0
    grey = glb.material("grey", (0.6, 0.6, 0.6), double_sided=True, **MATTE)
    red = glb.material("glossy red", (0.3, 0.1, 0.08), roughness=0.4)
    colours = ((270.0, 180.0, 90.0), (90.0, 150.0, 270.0), (240.0, 240.0, 240.0))
    lamps = [glb.material("lamp", (0, 0, 0), emission=colour, **MATTE) for colour in colours]
    glb.mesh("hall", [(without_uvs(joined([rewound(s)
                                           for s in box_sides((-wide, 0, -long), (wide, high, 4))])), grey)])
    chance = random.Random(1)
    parts = [[], [], []]
    for row in range(60):
        for column in range(10):
            x, y, z, half = column - 4.5 + chance.uniform(-0.2, 0.2), 4.4 + chance.uniform(
                -0.3, 0.3), row * 0.72 - 39.5, 0.03
            parts[chance.randrange(3)].append(
                without_uvs(
                    quad((x - half, y, z - half), (x + half, y, z - half), (x + half, y, z + half),
                         (x - half, y, z + half))))
    for part, lamp in zip(parts, lamps):
        glb.mesh("lamps", [(joined(part), lamp)])
    blocks = []
    for _ in range(40):
        x, z, half = chance.uniform(-4.5, 4.5), chance.uniform(-39, 1), chance.uniform(0.2, 0.5)
        blocks.append(
            without_uvs(box((x - half, 0, z - half), (x + half, chance.uniform(0.4, 2.5), z + half))))
    glb.mesh("blocks", [(joined(blocks), red)])
    glb.camera("camera", eye=(0, 1.8, 3.4), target=(0, 1.4, -10), yfov=0.9, aspect=1.5)
    return glb


def glazed():
    glb = Glb("lights.py")
    white = glb.material("white", (0.7, 0.7, 0.68), **MATTE)
    red = glb.material("glossy red", (0.45, 0.06, 0.04), roughness=0.3)
    blue = glb.material("blue", (0.1, 0.2, 0.45), **MATTE)
    clear = glb.material("clear glass", (1, 1, 1), roughness=0.0, transmission=1.0)
    brown = glb.material("brown glass", (0.9, 0.65, 0.35), roughness=0.0, transmission=1.0)
    wall, left, right, back, front, high = 0.2, -2.0, 2.0, -2.0, 2.2, 2.5
    z, y = (-0.8, 0.8), (0.7, 2.1)  # of the window, in the left wall
    outer = left - wall
    walls = [
        box((outer, -0.2, back), (left, high, z[0])),
        box((outer, -0.2, z[1]), (left, high, front)),
        box((outer, -0.2, z[0]), (left, y[0], z[1])),
        box((outer, y[1], z[0]), (left, high, z[1])),
        box((right, -0.2, back), (right + wall, high, front)),
        box((outer, -0.2, back - wall), (right + wall, high, back)),
        box((outer, -0.2, front), (right + wall, high, front + wall)),
        box((outer, high, back - wall), (right + wall, high + wall, front + wall)),
        box((outer, -0.2, back), (right, 0, front)),
    ]
    glb.mesh("walls", [(without_uvs(joined(walls)), white)])
    for x, glass, span in ((left - 0.05, clear, z), (left - 0.12, brown, (0.0, z[1]))):
        pane = quad((x, y[0], span[0]), (x, y[0], span[1]), (x, y[1], span[1]), (x, y[1], span[0]))
        glb.mesh("pane", [(without_uvs(pane), glass)])
    for name, size, material, place, degrees in (("block", (0.5, 0.9, 0.5), red, (0.2, 0, -0.6), 25),
                                                 ("cube", (0.4, 0.4, 0.4), blue, (-0.5, 0, 0.5), -15)):
        shape = without_uvs(box((-size[0] / 2, 0, -size[2] / 2), (size[0] / 2, size[1], size[2] / 2)))
        glb.mesh(name, [(shape, material)], translation=place, rotation=about((0, 1, 0), degrees))
    glb.camera("camera", eye=(1.7, 1.5, 2.0), target=(-0.4, 0.7, -0.4), yfov=0.9, aspect=1.5)
    return glb


if __name__ == "__main__":
    main()
