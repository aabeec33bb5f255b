# SPDX-License-Identifier: CC0-1.0
"""Writes interior.glb and interior-sky.hdr: a sun-lit room that most light enters to be reflected twice or more.

x runs to the right, y up, z to the viewer; the floor is y = 0. The room is closed but for one window, without
glass, in the left wall: the sun falls through it on the floor and on a screen 1 cm thick, whose other side
faces the dark part of the room with a lamp. Metres throughout.
"""

import math
import random

import textures
from glb import MATTE, Glb, about, output_folder, write_hdr
from shapes import (ball, box, curve, dot, joined, lathe, moved, quad, rotation, rounded_box, tube,
                    without_uvs, wooden)

X, Y, Z = (1, 0, 0), (0, 1, 0), (0, 0, 1)
LEFT, RIGHT, BACK, FRONT, CEILING = -2.5, 2.5, -2.1, 2.3, 2.6  # the room's inner faces
WALL = 0.28
WINDOW = {"z": (-1.0, 0.62), "y": (0.82, 2.22)}

SUN_ELEVATION, SUN_AZIMUTH = 33.0, 163.0  # degrees; azimuth of atan2(z, x)
SUN_DIAMETER = 1.0  # degrees; the true sun has 0.53
SUN_IRRADIANCE = (13.0, 11.4, 9.2)  # on a plane that faces it; the sky's on the ground is about 2

TABLE, SCREEN, SIDEBOARD, CHAIR = (-0.35, 0, 0.25), (0.78, 0, -0.95), (1.55, 0, -1.84), (-1.45, 0, -1.2)
TABLE_TOP, SIDEBOARD_TOP = 0.40, 0.74


def main():
    folder = output_folder("")
    glb = Glb("interior.py")
    add_room(glb)
    add_window(glb)
    add_floor(glb)
    add_table(glb)
    add_glasses_of_water(glb)
    add_chair(glb)
    add_screen(glb)
    add_sideboard(glb)
    add_lamp(glb)
    add_mirror(glb)
    glb.camera("room", eye=(2.05, 1.42, 2.12), target=(-0.3, 0.80, -0.95), yfov=0.90, aspect=1.5)
    glb.camera("sideboard", eye=(1.05, 1.22, 0.75), target=(1.5, 0.92, -1.95), yfov=0.70, aspect=1.5)
    glb.write(folder / "interior.glb")
    write_sky(folder / "interior-sky.hdr", 1024, 512)


# --- the room ---


def add_room(glb):
    plaster = glb.material("plaster", (0.80, 0.78, 0.74), **MATTE)
    green = glb.material("green paint", (0.42, 0.54, 0.49), roughness=0.75)
    z, y = WINDOW["z"], WINDOW["y"]
    left, right, back, front = LEFT - WALL, RIGHT + WALL, BACK - WALL, FRONT + WALL
    bottom, top = -0.2, CEILING + WALL
    walls = [
        box((left, bottom, back), (LEFT, top, z[0])),  # the left wall, round the window
        box((left, bottom, z[1]), (LEFT, top, front)),
        box((left, bottom, z[0]), (LEFT, y[0], z[1])),
        box((left, y[1], z[0]), (LEFT, top, z[1])),
        box((RIGHT, bottom, back), (right, top, front)),
        box((left, bottom, FRONT), (right, top, front)),
        box((left, CEILING, back), (right, top, front)),
    ]
    glb.mesh("walls and ceiling", [(without_uvs(joined(walls)), plaster)])
    glb.mesh("back wall", [(without_uvs(box((left, bottom, back), (right, top, BACK))), green)])

    paint = glb.material("white paint", (0.80, 0.79, 0.76), roughness=0.35)
    skirting = [
        moved(rounded_box((RIGHT - LEFT, 0.09, 0.016), 0.004, 1), (0, 0.045, BACK + 0.006)),
        moved(rounded_box((0.016, 0.09, FRONT - BACK), 0.004, 1), (LEFT + 0.006, 0.045, (BACK + FRONT) / 2)),
        moved(rounded_box((0.016, 0.09, FRONT - BACK), 0.004, 1), (RIGHT - 0.006, 0.045, (BACK + FRONT) / 2)),
    ]
    glb.mesh("skirting", [(without_uvs(joined(skirting)), paint)])


def add_window(glb):
    """A casement of two by two openings in the middle of the wall, and its sill."""
    paint = glb.material("window paint", (0.80, 0.79, 0.76), roughness=0.35)
    (z0, z1), (y0, y1) = WINDOW["z"], WINDOW["y"]
    x, z, wide = LEFT - 0.15, (z0 + z1) / 2, z1 - z0
    depth, frame, bar = 0.06, 0.055, 0.03
    parts = [
        moved(rounded_box((WALL + 0.06, 0.03, wide + 0.12), 0.008), (LEFT - 0.08, y0 + 0.002, z)),
        moved(rounded_box((depth, frame, wide), 0.006, 1), (x, y0 + frame / 2, z)),
        moved(rounded_box((depth, frame, wide), 0.006, 1), (x, y1 - frame / 2, z)),
        moved(rounded_box((depth, bar, wide), 0.006, 1), (x, y0 + 0.66 * (y1 - y0), z)),
    ]
    for place, thick in ((z0 + frame / 2, frame), (z1 - frame / 2, frame), (z, 1.8 * bar)):
        parts.append(moved(rounded_box((depth, y1 - y0, thick), 0.006, 1), (x, (y0 + y1) / 2, place)))
    glb.mesh("window", [(without_uvs(joined(parts)), paint)])


def add_floor(glb):
    """Varnished boards along x over a dark ground, every course shifted; a rug."""
    wood = glb.material("floor", (1.0, 0.94, 0.86),
                        roughness=0.36,
                        texture=glb.texture("wood", textures.wood()))
    ground = glb.material("under the floor", (0.05, 0.04, 0.03), **MATTE)
    chance = random.Random(17)
    wide, long, gap = 0.16, 1.9, 0.0012
    boards = []
    for course in range(math.ceil((FRONT - BACK) / wide)):
        z = BACK + (course + 0.5) * wide
        start = LEFT - chance.uniform(0, long)
        while start < RIGHT:
            low, high = max(start, LEFT - 0.02), min(start + long, RIGHT + 0.02)
            if high - low > 0.02:
                plank = wooden((high - low - gap, 0.02, wide - gap), 0.0015,
                               (chance.random(), chance.random()), 1)
                boards.append(moved(plank, ((low + high) / 2, -0.01, z)))
            start += long
    glb.mesh("floor", [(joined(boards), wood)])
    glb.mesh("under the floor",
             [(without_uvs(box((LEFT - 0.1, -0.15, BACK - 0.1),
                               (RIGHT + 0.1, -0.012, FRONT + 0.1))), ground)])

    wool = glb.material("rug", (0.78, 0.75, 0.70), texture=glb.texture("weave", textures.linen()), **MATTE)
    rug = rounded_box((1.9, 0.012, 1.35), 0.005, 1)
    rug.uvs = [(v / 1.35, u / 0.12) for u, v in rug.uvs]
    glb.mesh("rug", [(rug, wool)], translation=(TABLE[0], 0.006, TABLE[2]), rotation=about(Y, 6))


# --- furniture ---


def add_table(glb):
    """A low table of red lacquer (GGX alpha 0.06) on legs of polished steel (0.05); two books and a bowl."""
    lacquer = glb.material("red lacquer", (0.42, 0.035, 0.03), roughness=math.sqrt(0.06))
    steel = glb.material("steel", (0.77, 0.76, 0.74), metallic=1.0, roughness=math.sqrt(0.05))
    copper = glb.material("copper", (0.95, 0.60, 0.42), metallic=1.0, roughness=math.sqrt(0.12))
    turn = about(Y, 6)
    glb.mesh("table", [(without_uvs(rounded_box((1.05, 0.035, 0.62), 0.012, 3)), lacquer)],
             translation=(TABLE[0], TABLE_TOP - 0.0175, TABLE[2]),
             rotation=turn)
    legs = []
    for side in (-0.42, 0.42):
        legs.append(
            tube(
                curve([(side, 0.37, -0.24), (side, 0.05, -0.24), (side, 0.014, -0.2), (side, 0.014, 0.2),
                       (side, 0.05, 0.24), (side, 0.37, 0.24)], 6), lambda t: 0.012, 14))
    glb.mesh("legs", [(without_uvs(joined(legs)), steel)],
             translation=add_height(TABLE, 0.012),
             rotation=turn)

    inner = curve([(0.0, 0.016), (0.06, 0.022), (0.11, 0.05), (0.135, 0.088)], 6)
    outer = curve([(0.055, 0.0), (0.058, 0.012), (0.114, 0.046), (0.139, 0.088)], 6)
    profile = [(0.0, 0.004), (0.05, 0.004), *outer, (0.137, 0.0905), *reversed(inner)]
    glb.mesh("bowl", [(lathe([(max(r, 0.0), y) for r, y in profile], 56), copper)],
             translation=(TABLE[0] - 0.25, TABLE_TOP, TABLE[2] - 0.05))
    add_books(glb)


def add_books(glb):
    covers = [
        glb.material("blue cover", (0.05, 0.13, 0.28), roughness=0.45),
        glb.material("ochre cover", (0.55, 0.36, 0.08), roughness=0.45)
    ]
    paper = glb.material("paper", (0.82, 0.78, 0.70), **MATTE)
    height = TABLE_TOP
    for cover, size, degrees in ((covers[0], (0.25, 0.032, 0.18), 24), (covers[1], (0.21, 0.024, 0.145), 8)):
        boards = [
            moved(rounded_box((size[0], 0.003, size[2]), 0.001, 1), (0, y, 0))
            for y in (0.0015, size[1] - 0.0015)
        ]
        boards.append(moved(rounded_box((size[0], size[1], 0.003), 0.001, 1), (0, size[1] / 2, size[2] / 2)))
        pages = moved(rounded_box((size[0] - 0.01, size[1] - 0.006, size[2] - 0.008), 0.001, 1),
                      (0, size[1] / 2, 0.002))
        glb.mesh("book", [(without_uvs(joined(boards)), cover), (without_uvs(pages), paper)],
                 translation=(TABLE[0] + 0.30, height, TABLE[2] - 0.08),
                 rotation=about(Y, degrees))
        height += size[1]


def add_glasses_of_water(glb):
    """On the table and by the lamp: tumblers of one closed surface, water a hair's breadth from the glass."""
    glass = glb.material("glass", (1, 1, 1), roughness=0.0, transmission=1.0, thickness=0.002, ior=1.5)
    water = glb.material("water", (1, 1, 1), roughness=0.0, transmission=1.0, thickness=0.05, ior=1.33)
    tumbler = [(0.0, 0.0), (0.026, 0.0), (0.0285, 0.0012), *curve([(0.0295, 0.004), (0.0325, 0.05),
                                                                   (0.036, 0.118)], 5), (0.0355, 0.1192),
               (0.0346, 0.1185), *curve([(0.0340, 0.116), (0.0306, 0.05), (0.0275, 0.013)], 5),
               (0.0250, 0.0105), (0.0, 0.0100)]
    body = [(0.0, 0.0103), (0.0248, 0.0108), *curve([(0.0272, 0.0132), (0.0303, 0.05), (0.03185, 0.080)], 4),
            (0.0312, 0.0796), (0.0, 0.0792)]
    for name, profile, material in (("glass", tumbler, glass), ("water", body, water)):
        shape = [(lathe([(max(r, 0.0), y) for r, y in profile], 48), material)]
        glb.mesh(name, shape, translation=(TABLE[0] + 0.02, TABLE_TOP, TABLE[2] + 0.12))
        glb.mesh(name, shape, translation=(SIDEBOARD[0] + 0.03, SIDEBOARD_TOP, SIDEBOARD[2] + 0.1))


def add_chair(glb):
    """An armchair of ochre cloth, turned to the table."""
    cloth = glb.material("ochre cloth", (0.62, 0.38, 0.10), **MATTE)
    oak = glb.material("oak", (0.36, 0.22, 0.11), roughness=0.4)
    cushions = [
        moved(rounded_box((0.66, 0.16, 0.66), 0.05, 4), (0, 0.36, 0.02)),
        moved(rounded_box((0.66, 0.56, 0.15), 0.06, 4), (0, 0.66, -0.30), rotation(X, -12)),
        moved(rounded_box((0.12, 0.34, 0.72), 0.045, 4), (-0.39, 0.41, 0.0)),
        moved(rounded_box((0.12, 0.34, 0.72), 0.045, 4), (0.39, 0.41, 0.0)),
        moved(rounded_box((0.86, 0.10, 0.70), 0.03, 2), (0, 0.25, 0.0)),
    ]
    legs = [lathe([(0.0, 0.0), (0.013, 0.0), (0.024, 0.21), (0.0, 0.21)], 16)]
    legs = [moved(legs[0], (x, 0, z)) for x in (-0.36, 0.36) for z in (-0.28, 0.28)]
    glb.mesh("armchair", [(without_uvs(joined(cushions)), cloth), (without_uvs(joined(legs)), oak)],
             translation=CHAIR,
             rotation=about(Y, 38))


def add_screen(glb):
    """A wall 1 cm thick between the sun and the sideboard, in two steel feet."""
    white = glb.material("screen", (0.72, 0.70, 0.66), **MATTE)
    steel = glb.material("brushed steel", (0.60, 0.60, 0.60), metallic=1.0, roughness=math.sqrt(0.2))
    glb.mesh("screen", [(without_uvs(box((-0.005, 0.015, -0.72), (0.005, 1.62, 0.72))), white)],
             translation=SCREEN)
    feet = [moved(rounded_box((0.36, 0.03, 0.05), 0.006, 2), (0, 0.015, z)) for z in (-0.55, 0.55)]
    glb.mesh("feet", [(without_uvs(joined(feet)), steel)], translation=SCREEN)


def add_sideboard(glb):
    """Lacquered walnut (GGX alpha 0.1) with brass handles (0.08), a pewter vase (0.15); a print above it."""
    walnut = glb.material("walnut", (0.24, 0.13, 0.07), roughness=math.sqrt(0.1))
    brass = glb.material("brass", (0.89, 0.70, 0.38), metallic=1.0, roughness=math.sqrt(0.08))
    pewter = glb.material("pewter", (0.62, 0.61, 0.60), metallic=1.0, roughness=math.sqrt(0.15))
    wide, deep, low = 1.5, 0.44, 0.16
    front = deep / 2
    parts = [
        moved(rounded_box((wide, SIDEBOARD_TOP - low, deep), 0.01, 2), (0, (SIDEBOARD_TOP + low) / 2, 0))
    ]
    parts += [
        moved(rounded_box((wide / 3 - 0.012, SIDEBOARD_TOP - low - 0.05, 0.02), 0.006, 2),
              (x, (SIDEBOARD_TOP + low) / 2, front + 0.006)) for x in (-wide / 3, 0, wide / 3)
    ]
    foot = lathe([(0.0, 0.0), (0.012, 0.0), (0.02, low + 0.01), (0.0, low + 0.01)], 16)
    parts += [moved(foot, (x, 0, z)) for x in (-0.66, 0.66) for z in (-0.16, 0.16)]
    handles = [
        moved(rounded_box((0.012, 0.14, 0.022), 0.005, 2), (x, 0.5, front + 0.027))
        for x in (-wide / 6 - 0.04, wide / 6 - 0.05, wide / 6 + 0.05)
    ]
    glb.mesh("sideboard", [(joined([without_uvs(part) for part in parts]), walnut),
                           (without_uvs(joined(handles)), brass)],
             translation=SIDEBOARD)

    outside = curve([(0.05, 0.0), (0.075, 0.06), (0.092, 0.15), (0.07, 0.235), (0.036, 0.30), (0.047, 0.345)],
                    7)
    inside = curve([(0.043, 0.345), (0.032, 0.30), (0.066, 0.235), (0.087, 0.15)], 5)
    profile = [(0.0, 0.003), (0.045, 0.003), *outside, (0.045, 0.347), *inside, (0.0, 0.05)]
    glb.mesh("vase", [(lathe([(max(r, 0.0), y) for r, y in profile], 56), pewter)],
             translation=(SIDEBOARD[0] + 0.42, SIDEBOARD_TOP, SIDEBOARD[2] + 0.02))

    print_ = glb.material("print", (0.9, 0.9, 0.9), texture=glb.texture("lemon", textures.lemon()), **MATTE)
    frame = glb.material("picture frame", (0.05, 0.05, 0.05), roughness=0.4)
    half, place = 0.24, (SIDEBOARD[0] + 0.3, 1.56, BACK)
    picture = quad((-half, -half, 0.018), (half, -half, 0.018), (half, half, 0.018), (-half, half, 0.018))
    border = moved(rounded_box((2 * half + 0.05, 2 * half + 0.05, 0.03), 0.004, 1), (0, 0, 0.002))
    glb.mesh("print", [(picture, print_), (without_uvs(border), frame)], translation=place)


def add_lamp(glb):
    """A brass foot, an opal bulb of 720 triangles, and a bellied shade of paper 1 mm thick, open at both ends."""
    brass = glb.material("lamp brass", (0.89, 0.70, 0.38), metallic=1.0, roughness=math.sqrt(0.1))
    paper = glb.material("shade", (0.85, 0.80, 0.68), **MATTE)
    light = glb.material("bulb", (0, 0, 0), emission=(26.0, 18.0, 9.5), **MATTE)
    place = (SIDEBOARD[0] - 0.34, SIDEBOARD_TOP, SIDEBOARD[2] + 0.02)
    foot = [(0.0, 0.0), (0.085, 0.0), *curve([(0.088, 0.006), (0.07, 0.018), (0.02, 0.034), (0.009, 0.07),
                                              (0.012, 0.14), (0.022, 0.19), (0.010, 0.235),
                                              (0.009, 0.27)], 5), (0.0, 0.272)]
    glb.mesh("lamp foot", [(lathe([(max(r, 0.0), y) for r, y in foot], 40), brass)], translation=place)
    bulb = ball(0.045, 24, 16, lambda p: (p[0], p[1] * 1.1, p[2]))
    glb.mesh("bulb", [(bulb, light)], translation=add_height(place, 0.324))
    line = curve([(0.165, 0.215), (0.178, 0.27), (0.160, 0.35), (0.115, 0.425), (0.088, 0.47)], 8)
    inner = [(r - 0.001, y) for r, y in line]
    glb.mesh("shade", [(lathe([*line, *reversed(inner), line[0]], 72), paper)], translation=place)


def add_mirror(glb):
    """A round mirror in an oak ring, where it sees the sunlit floor and no lamp."""
    silver = glb.material("mirror", (0.93, 0.93, 0.92), metallic=1.0, roughness=0.0)
    oak = glb.material("mirror frame", (0.30, 0.18, 0.09), roughness=0.4)
    facing = rotation(X, 90)
    face = lathe([(0.40, 0.0), (0.0, 0.0)], 64)
    ring = lathe([(0.398, -0.02), (0.435, -0.02), *curve([(0.438, 0.0), (0.425, 0.016), (0.405, 0.012),
                                                          (0.396, 0.001)], 4), (0.398, -0.02)], 64)
    glb.mesh("mirror", [(moved(face, turn=facing), silver), (moved(ring, turn=facing), oak)],
             translation=(-0.50, 1.45, BACK + 0.021))


def add_height(place, height):
    return (place[0], place[1] + height, place[2])


# --- outside ---


def write_sky(path, width, height):
    """A blue sky, paler at the horizon and about the sun, over sunlit ground; the sun is an even disc."""
    sun = direction(math.radians(90 - SUN_ELEVATION), math.radians(SUN_AZIMUTH))
    rows = [[sky(direction(*angles(column + 0.5, row + 0.5, width, height)), sun) for column in range(width)]
            for row in range(height)]
    texels = sun_texels(sun, width, height)
    total = sum(share * solid_angle(row, width, height) for (_, row), share in texels.items())
    for (column, row), share in texels.items():
        rows[row][column] = tuple(value + share / total * power
                                  for value, power in zip(rows[row][column], SUN_IRRADIANCE))
    write_hdr(path, rows)


def sky(w, sun):
    if w[1] < 0:
        return (0.42, 0.38, 0.30)
    haze = (1 - w[1]) ** 4
    glow = 1.6 * math.exp(-(round(angle_between(w, sun), 4) / 0.22) ** 1.2)
    return tuple(
        round(zenith + (horizon - zenith) * haze + glow * warm, 3)
        for zenith, horizon, warm in zip((0.26, 0.48, 0.95), (1.0, 1.05, 1.1), (1.0, 0.9, 0.75)))


def sun_texels(sun, width, height, parts=16):
    """The share of each texel that the sun covers, by a grid of `parts` squared points."""
    radius = math.radians(SUN_DIAMETER / 2)
    column = int((math.atan2(sun[2], sun[0]) / (2 * math.pi) + 0.5) * width)
    row = int(math.acos(sun[1]) / math.pi * height)
    covered = {}
    for y in range(row - 4, row + 5):
        for x in range(column - 4, column + 5):
            inside = sum(
                angle_between(direction(*angles(x + (i + 0.5) / parts, y +
                                                (j + 0.5) / parts, width, height)), sun) < radius
                for i in range(parts) for j in range(parts))
            if inside:
                covered[x, y] = inside / parts ** 2
    return covered


def solid_angle(row, width, height):
    return 2 * math.pi / width * (math.cos(math.pi * row / height) - math.cos(math.pi * (row + 1) / height))


def angles(x, y, width, height):
    """Polar angle and azimuth (of atan2(z, x)) at a place of the picture."""
    return math.pi * y / height, 2 * math.pi * (x / width - 0.5)


def direction(polar, azimuth):
    return (math.sin(polar) * math.cos(azimuth), math.cos(polar), math.sin(polar) * math.sin(azimuth))


def angle_between(a, b):
    return math.acos(max(-1.0, min(1.0, dot(a, b))))


if __name__ == "__main__":
    main()
