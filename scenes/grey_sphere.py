# SPDX-License-Identifier: CC0-1.0
"""Writes grey-sphere.glb: inside a sphere of radius 1 and albedo 1/2, lit from its centre by intensity pi, L = 1.

Irradiance is pi from the light and pi·L from the sphere itself, so L = (1/2)/pi · (pi + pi·L), hence L = 1. The
sphere is made of 5120 flat triangles, scaled until its *area* is 4·pi: then the mean of L over the surface is 1
exactly (flux in = flux absorbed). What is left is the direct light's cos/r² over one triangle: at any point
L is in [0.9988, 1.0006].
"""

import math

from glb import MATTE, Glb, output_folder
from shapes import area, icosphere, moved, rewound


def main():
    glb = Glb("grey_sphere.py")
    sphere = icosphere(level=4)
    sphere = rewound(moved(sphere, scale=math.sqrt(4 * math.pi / area(sphere))))
    glb.mesh("sphere", [(sphere, glb.material("grey", (0.5, 0.5, 0.5), **MATTE))])
    glb.point_light("light", position=(0, 0, 0), intensity=(math.pi, math.pi, math.pi))
    glb.camera("camera", eye=(0.1, 0.2, 0.6), target=(-0.1, -0.2, -0.6), yfov=1.6, aspect=1.0)
    glb.write(output_folder("") / "grey-sphere.glb")


if __name__ == "__main__":
    main()
