# SPDX-License-Identifier: CC0-1.0
"""Writes cornell.glb and cornell-glossy.glb: the Cornell box, with matte and with half metallic floor.

Coordinates: Cornell Program of Computer Graphics, "Cornell Box Data", 1998 (measured, in millimetres). The colours
are rounded RGB stand-ins for the measured spectra. Turned by 180° about y: so the camera looks along -z.
"""

from glb import MATTE, Glb, output_folder
from shapes import joined, quad

WHITE, RED, GREEN = (0.73, 0.73, 0.73), (0.63, 0.065, 0.05), (0.14, 0.45, 0.091)
LIGHT = (18.0, 14.0, 7.0)  # radiance

FLOOR = ((552.8, 0, 0), (0, 0, 0), (0, 0, 559.2), (549.6, 0, 559.2))
CEILING = ((556, 548.8, 0), (556, 548.8, 559.2), (0, 548.8, 559.2), (0, 548.8, 0))
BACK = ((549.6, 0, 559.2), (0, 0, 559.2), (0, 548.8, 559.2), (556, 548.8, 559.2))
RIGHT = ((0, 0, 559.2), (0, 0, 0), (0, 548.8, 0), (0, 548.8, 559.2))
LEFT = ((552.8, 0, 0), (549.6, 0, 559.2), (556, 548.8, 559.2), (556, 548.8, 0))
LAMP = (
    (343, 548.7, 227), (343, 548.7, 332), (213, 548.7, 332), (213, 548.7, 227))  # 0.1 mm below the ceiling
SHORT = ((130, 65), (82, 225), (240, 272), (290, 114)), 165  # plan (x, z), height
TALL = ((423, 247), (265, 296), (314, 456), (472, 406)), 330


def main():
    glossy = {"metallic": 0.5, "roughness": 0.3, "specular": 0.0}
    for name, floor in (("cornell", MATTE), ("cornell-glossy", glossy)):
        cornell_box(name, floor).write(output_folder("") / f"{name}.glb")


def cornell_box(name, floor):
    glb = Glb("cornell.py")
    white = glb.material("white", WHITE, double_sided=True, **MATTE)
    glb.mesh("floor", [(face(FLOOR), glb.material("floor", WHITE, double_sided=True, **floor))])
    glb.mesh("ceiling and back", [(joined([face(CEILING), face(BACK)]), white)])
    glb.mesh("left", [(face(LEFT), glb.material("red", RED, double_sided=True, **MATTE))])
    glb.mesh("right", [(face(RIGHT), glb.material("green", GREEN, double_sided=True, **MATTE))])
    glb.mesh("short block", [(block(*SHORT), white)])
    glb.mesh("tall block", [(block(*TALL), white)])
    glb.mesh("lamp", [(face(LAMP), glb.material("lamp", (0, 0, 0), emission=LIGHT, **MATTE))])
    glb.camera("camera", eye=metres((278, 273, -800)), target=metres((278, 273, 0)), yfov=0.6861, aspect=1.0)
    return glb


def metres(p):
    return (-p[0] / 1000, p[1] / 1000, -p[2] / 1000)


def face(corners):
    return quad(*(metres(p) for p in corners))


def block(plan, height):
    """Four sides and a top on the plan's corners, which run counter-clockwise seen from above."""
    sides = [((ax, 0, az), (bx, 0, bz), (bx, height, bz), (ax, height, az))
             for (ax, az), (bx, bz) in zip(plan, plan[1:] + plan[:1])]
    top = tuple((x, height, z) for x, z in plan)
    return joined([face(corners) for corners in (*sides, top)])


if __name__ == "__main__":
    main()
