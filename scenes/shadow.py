# SPDX-License-Identifier: CC0-1.0
"""Writes shadow.glb: 110 triangles, bars and boxes on strongly glossy metal, after the paper's scene `shadow`.

To be lit by an HDR environment. The plane's GGX alpha is 0.07: reflections, and the shadows the bars cast into
the sun's highlight, are sharp at their foot and soft further off.
"""

import math

from glb import MATTE, Glb, about, output_folder
from shapes import box, quad

UP = (0, 1, 0)


def main():
    glb = Glb("shadow.py")
    metal = glb.material("metal", (0.85, 0.82, 0.78),
                         metallic=1.0,
                         roughness=math.sqrt(0.07),
                         double_sided=True)
    grey = glb.material("grey", (0.6, 0.6, 0.6), **MATTE)
    red = glb.material("red", (0.6, 0.1, 0.07), **MATTE)
    blue = glb.material("blue", (0.08, 0.2, 0.5), **MATTE)

    glb.mesh("plane", [(quad((-4, 0, 4), (4, 0, 4), (4, 0, -4), (-4, 0, -4)), metal)])
    for name, size, material, x, z, degrees in (("red box", (0.36, 0.5, 0.36), red, -0.62, -0.35,
                                                 20), ("blue box", (0.5, 0.22, 0.3), blue, 0.55, 0.5, -25),
                                                ("post 1", (0.03, 0.9, 0.03), grey, -0.1, -0.5,
                                                 0), ("post 2", (0.03, 0.9, 0.03), grey, 0.7, -0.5, 0),
                                                ("post 3", (0.03, 0.7, 0.03), grey, -0.45, 0.45,
                                                 30), ("post 4", (0.03, 0.5, 0.03), grey, 0.05, 0.25, 10),
                                                ("post 5", (0.03, 0.35, 0.03), grey, -0.15, 0.75, 50)):
        glb.mesh(name, [(standing(size), material)], translation=(x, 0, z), rotation=about(UP, degrees))
    for name, y in (("upper rail", 0.8), ("lower rail", 0.45)):  # between posts 1 and 2, in front of them
        glb.mesh(name, [(standing((0.95, 0.03, 0.03)), grey)], translation=(0.3, y, -0.47))
    glb.camera("camera", eye=(0.6, 1.9, 2.5), target=(0.08, 0.24, 0), yfov=0.62, aspect=1.0)
    glb.write(output_folder("") / "shadow.glb")


def standing(size):
    x, y, z = size
    return box((-x / 2, 0, -z / 2), (x / 2, y, z / 2))


if __name__ == "__main__":
    main()
