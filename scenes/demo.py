# SPDX-License-Identifier: CC0-1.0
"""Writes demo.glb: a still life on a table by a window, the picture of the README. Lit by sky.exr from outside.

The table top is y = 0; x runs to the right, z to the viewer. The window is in the left wall; the room is open to
the right and behind the camera. Everything hangs under one turned node, so that sky.exr needs no rotation for its
sun to come in.
"""

import math
import random

import textures
from glb import MATTE, Glb, Mesh, about, output_folder
from shapes import (add, ball, box, cross, curve, joined, lathe, length, mix, moved, mul, quad, rotation,
                    rounded_box, sheet, smooth, sub, tube, unit, without_uvs, wooden)

SUN_AZIMUTH = 36.0  # of sky.exr, degrees of atan2(z, x)
SUN_FROM = 138.0  # where the room wants it
X, Y, Z = (1, 0, 0), (0, 1, 0), (0, 0, 1)

LEFT, RIGHT, BACK, FRONT, FLOOR, CEILING = -0.85, 1.9, -0.62, 2.1, -0.74, 1.75  # the room's inner faces
WALL = 0.16
BOWL_RADIUS, BOWL_CENTRE = 0.20, 0.22  # the inner sphere and its height above the table
CLOTH_TOP = 0.0015
AWNING = 0.8  # the ceiling ends here: sky light from above the camera
WINDOW = {"z": (-0.38, 0.66), "y": (-0.03, 1.22)}
TABLE = {"x": (-0.72, 0.92), "z": (-0.52, 0.42), "thickness": 0.035}

VASE, BOWL, GLASS = (-0.06, 0, -0.27), (-0.33, 0, -0.03), (0.16, 0, -0.06)
BOOKS, CUP = (0.40, 0, -0.24), (0.37, 0, 0.15)
LEMON_PLACE, HALF_PLACE = (0.055, CLOTH_TOP, 0.155), (-0.035, CLOTH_TOP, 0.20)


def main():
    glb = Glb("demo.py")
    root = glb.node("room", rotation=about(Y, SUN_FROM - SUN_AZIMUTH))
    add_room(glb, root)
    add_window(glb, root)
    add_table(glb, root)
    add_cloth(glb, root)
    add_vase(glb, root)
    add_bowl(glb, root)
    add_fruit(glb, root)
    add_glass(glb, root)
    add_books(glb, root)
    add_cup(glb, root)
    glb.camera("camera",
               eye=(0.58, 0.50, 1.78),
               target=(-0.05, 0.15, -0.1),
               yfov=0.46,
               aspect=1.5,
               parent=root)
    glb.write(output_folder("") / "demo.glb")


# --- the room ---


def add_room(glb, root):
    plaster = glb.material("plaster", (0.58, 0.52, 0.45), **MATTE)
    boards = glb.material("floor boards", (0.30, 0.20, 0.12), **MATTE)
    z, y = WINDOW["z"], WINDOW["y"]
    outer, top, bottom = LEFT - WALL, CEILING + WALL, FLOOR - WALL
    walls = [
        box((outer, bottom, BACK - WALL), (LEFT, top, z[0])),  # the left wall, round the window
        box((outer, bottom, z[1]), (LEFT, top, FRONT)),
        box((outer, bottom, z[0]), (LEFT, y[0], z[1])),
        box((outer, y[1], z[0]), (LEFT, top, z[1])),
        box((LEFT, bottom, BACK - WALL), (RIGHT, top, BACK)),
        box((LEFT, CEILING, BACK), (RIGHT, top, AWNING)),
    ]
    glb.mesh("walls and ceiling", [(joined(walls), plaster)], root)
    glb.mesh("floor", [(box((LEFT, bottom, BACK), (RIGHT, FLOOR, FRONT)), boards)], root)


def add_window(glb, root):
    """A casement of two by three panes, without glass, and its sill."""
    paint = glb.material("paint", (0.80, 0.78, 0.72), roughness=0.35)
    (z0, z1), (y0, y1) = WINDOW["z"], WINDOW["y"]
    sill = moved(rounded_box((0.26, 0.03, z1 - z0 + 0.10), 0.008), (LEFT - 0.07, y0 + 0.005, (z0 + z1) / 2))
    y0 += 0.02  # the sill's top
    depth, frame, bar = 0.05, 0.05, 0.026
    x, z, y = LEFT - 0.11, (z0 + z1) / 2, (y0 + y1) / 2

    def rail(height, thickness):
        return moved(rounded_box((depth, thickness, z1 - z0), 0.006, 1), (x, height, z))

    def stile(place, thickness):
        return moved(rounded_box((depth, y1 - y0, thickness), 0.006, 1), (x, y, place))

    parts = [
        sill,
        rail(y0 + frame / 2, frame),
        rail(y1 - frame / 2, frame),
        stile(z0 + frame / 2, frame),
        stile(z1 - frame / 2, frame),
        stile(z, bar * 1.6)
    ]
    parts += [rail(y0 + (y1 - y0) * third / 3, bar) for third in (1, 2)]
    glb.mesh("window", [(without_uvs(joined(parts)), paint)], root)


def add_table(glb, root):
    """Six planks on an apron and four legs; every plank shows another part of the wood."""
    wood = glb.material("wood", (1, 1, 1), roughness=0.38, texture=glb.texture("wood", textures.wood()))
    (x0, x1), (z0, z1) = TABLE["x"], TABLE["z"]
    thick, planks = TABLE["thickness"], 6
    width, middle = (z1 - z0) / planks, (x0 + x1) / 2
    chance = random.Random(7)
    parts = []
    for i in range(planks):
        plank = wooden((x1 - x0, thick, width - 0.0012), 0.0025, (chance.random(), chance.random()))
        parts.append(moved(plank, (middle, -thick / 2, z0 + (i + 0.5) * width)))
    apron = 0.09
    for z in (z0 + 0.05, z1 - 0.05):
        parts.append(moved(wooden((x1 - x0 - 0.12, apron, 0.02), 0.002), (middle, -thick - apron / 2, z)))
    leg = -FLOOR - thick
    for x in (x0 + 0.06, x1 - 0.06):
        for z in (z0 + 0.06, z1 - 0.06):
            parts.append(moved(wooden((0.055, leg, 0.055), 0.004), (x, -thick - leg / 2, z)))
    glb.mesh("table", [(joined(parts), wood)], root)


def add_cloth(glb, root):
    """Linen that lies on the table and hangs over its front edge."""
    linen = glb.material("linen", (1, 1, 1),
                         double_sided=True,
                         texture=glb.texture("linen", textures.linen()),
                         **MATTE)
    edge, bend = TABLE["z"][1], 0.008
    flat, hanging, width = 0.40, 0.22, 0.37

    def point(u, v):
        """u across, v from the hanging end to the far end."""
        along = (1 - v) * (flat + hanging)  # from the far end
        x = (u - 0.5) * width
        z = edge - flat + min(along, flat)
        calm = min(1.0, (2 * abs(x) / width) ** 3 + max(0.0, z - 0.27) / 0.15)  # flat under the lemons
        ridge = max(0.0,
                    math.sin(24 * x + 5 * z + 0.8)) ** 2 + 0.7 * max(0.0, math.sin(38 * x - 9 * z + 2.5)) ** 2
        lift = CLOTH_TOP + 0.005 * calm * ridge
        sway = 0.010 * math.sin(8 * z + 0.5) + 0.12 * (z - 0.2)
        if along < flat:
            return (x + sway, lift, z)
        down = along - flat
        angle = min(down / bend, math.pi / 2)
        fold = 0.022 * min(down / 0.13, 1.0) * (1.4 + math.sin(34 * x + 1.3) + 0.4 * math.sin(61 * x + 0.4))
        fall = bend * (1 - math.cos(angle)) + max(0.0, down - bend * math.pi / 2)
        return (x * (1 - 0.5 * down) + sway, lift - fall, edge + bend * math.sin(angle) + fold)

    glb.mesh("cloth", [(sheet(point, 60, 56), linen)], root)


# --- things on the table ---


def add_vase(glb, root):
    glaze = glb.material("glaze", (0.02, 0.13, 0.16), roughness=0.14)
    outside = curve([(0.047, 0.004), (0.055, 0.03), (0.080, 0.085), (0.090, 0.14), (0.074, 0.20),
                     (0.042, 0.245), (0.034, 0.275), (0.043, 0.305), (0.047, 0.312)], 6)
    inside = curve([(0.0425, 0.313), (0.039, 0.305), (0.030, 0.275), (0.037, 0.245), (0.069, 0.20),
                    (0.084, 0.14)], 4)
    profile = [(0.0, 0.0), (0.043, 0.0), *outside, (0.0455, 0.3145), *inside, (0.03, 0.05), (0.0, 0.05)]
    glb.mesh("vase", [(lathe(profile, 64), glaze)], root, translation=VASE)

    bark = glb.material("bark", (0.12, 0.08, 0.05), roughness=0.8)
    leaf = glb.material("leaf", (0.15, 0.20, 0.09), roughness=0.5, double_sided=True)
    chance = random.Random(11)
    stems, leaves = [], []
    for turn, lean, tall in ((195, 0.19, 0.20), (150, 0.07, 0.27), (15, 0.16, 0.22), (255, 0.10, 0.17),
                             (335, 0.25, 0.11)):
        out = rotation(Y, turn)(X)
        path = curve([
            add(mul(out, -0.012), (0, 0.10, 0)),
            add(mul(out, 0.018), (0, 0.29, 0)),
            add(mul(out, 0.03 + lean * 0.45), (0, 0.29 + tall * 0.6, 0)),
            add(mul(out, 0.03 + lean), (0, 0.29 + tall, 0))
        ], 8)
        stems.append(tube(path, lambda t: 0.0026 - 0.0016 * t, 6))
        for i in range(10, len(path) - 1):
            along = unit(sub(path[i + 1], path[i]))
            for side in (0, 180):
                around = rotation(along, i * 80 + side + chance.uniform(-25, 25))
                start = around(unit(cross(along, Z if abs(along[2]) < 0.9 else X)))
                leaves.append(leaf_shape(path[i], along, start, chance.uniform(0.040, 0.060)))
        leaves.append(leaf_shape(path[-1], along, start, 0.05))
    glb.mesh("twigs", [(joined(stems), bark), (joined(leaves), leaf)], root, translation=VASE)


def leaf_shape(root, along, out, size):
    """A narrow leaf that leaves its twig at `root` between `along` and `out`, and droops a little."""
    heading = unit(add(mul(along, 0.75), out))
    across = unit(cross(heading, out)) if length(cross(heading, out)) > 1e-3 else unit(cross(heading, Y))
    up = cross(across, heading)

    def point(u, v):
        width = size * (0.012 + 0.17 * math.sin(math.pi * v ** 0.8))
        droop = -0.18 * size * v * v + 0.25 * abs(u - 0.5) * width
        return add(add(add(root, mul(heading, size * v)), mul(across, (u - 0.5) * 2 * width)), mul(up, droop))

    shape = sheet(point, 2, 5)
    shape.uvs = None
    return shape


def add_bowl(glb, root):
    copper = glb.material("copper", (0.95, 0.60, 0.42), metallic=1.0, roughness=0.3)
    radius, centre, thick = BOWL_RADIUS, BOWL_CENTRE, 0.003
    rim = math.asin(0.142 / radius)

    def arc(r, start, end, steps):
        return [(r * math.sin(a), centre - r * math.cos(a))
                for a in (start + (end - start) * i / steps for i in range(steps + 1))]

    start = math.asin(0.058 / (radius + thick))
    foot = [(0.0, 0.0), (0.049, 0.0), (0.0512, 0.0009), (0.052, 0.003), (0.0515, 0.010), (0.0525, 0.018)]
    lip = [(0.1455, 0.0815), (0.1462, 0.083), (0.1455, 0.0845), (0.1440, 0.0848), (0.1428, 0.0838)]
    profile = [
        *foot, *arc(radius + thick, start, rim, 16), *lip, *arc(radius, rim, 0.0, 16)[:-1],
        (0.0, centre - radius)
    ]
    glb.mesh("bowl", [(lathe(profile, 80), copper)], root, translation=BOWL)


def add_fruit(glb, root):
    peel = glb.material("orange peel", (0.80, 0.24, 0.02), roughness=0.42)
    zest = glb.material("lemon zest", (0.85, 0.62, 0.05), roughness=0.38)
    skin = glb.material("pear skin", (0.50, 0.50, 0.10), roughness=0.35)
    stalk = glb.material("stalk", (0.10, 0.06, 0.03), roughness=0.7)

    radius = 0.037  # five in a ring touch the bowl's inner sphere and each other, one lies on them
    ring = radius / math.sin(math.pi / 5)
    height = BOWL_CENTRE - math.sqrt((BOWL_RADIUS - radius) ** 2 - ring ** 2)
    angles = [0.4 + 0.4 * math.pi * i for i in range(5)]
    seats = [(ring * math.cos(a), height, ring * math.sin(a)) for a in angles]
    seats.append((0, height + math.sqrt(4 * radius ** 2 - ring ** 2), 0))
    chance = random.Random(3)
    oranges = []
    for seat in seats:
        axis = unit(tuple(chance.uniform(-1, 1) for _ in range(3)))
        oranges.append(moved(orange(radius), seat, rotation(axis, chance.uniform(0, 180))))
    glb.mesh("oranges", [(joined(oranges), peel)], root, translation=BOWL)

    pulp = glb.material("lemon pulp", (1, 1, 1),
                        roughness=0.3,
                        texture=glb.texture("lemon", textures.lemon()))
    whole = resting(lemon(), LEMON_PLACE, rotation(Y, 25))
    half, cut = half_lemon(tilt=30, turn=-62)
    below = min(y for _, y, _ in half.positions)
    half, cut = (moved(part, sub(HALF_PLACE, (0, below, 0))) for part in (half, cut))
    glb.mesh("lemons", [(joined([whole, half]), zest), (cut, pulp)], root)

    body, stem = pear()
    glb.mesh("pear", [(body, skin), (stem, stalk)], root, translation=add(BOOKS, (-0.01, 0.066, 0.0)))


def orange(radius):

    def shape(p):
        polar = math.acos(max(-1.0, min(1.0, p[1] / radius)))
        return mul(p, 1 - 0.07 * math.exp(-(polar / 0.16) ** 2))  # the dimple at the stalk

    return ball(radius, 32, 18, shape)


LEMON = curve([(0.0, -0.047), (0.0055, -0.0455), (0.009, -0.041), (0.0165, -0.034), (0.0255, -0.018),
               (0.0287, 0.0), (0.0255, 0.018), (0.0165, 0.033), (0.0085, 0.040), (0.0045, 0.044),
               (0.0, 0.045)], 3)


def lemon():
    """Lies along x."""
    return moved(lathe([(max(r, 0.0), y) for r, y in LEMON], 40), turn=rotation(Z, 90))


def half_lemon(tilt, turn):
    """The peel, and the cut through the middle: facing x, tilted up, then turned about y, degrees."""
    peel = lathe([(max(r, 0.0), y) for r, y in LEMON if y <= 0], 40)
    rim = [p for p in peel.positions if p[1] == 0]
    positions = [(0.0, 0.0, 0.0), *rim]
    triangles = [(0, 1 + i, 1 + (i + 1) % len(rim)) for i in range(len(rim))]
    cut = Mesh(positions, triangles, [Y] * len(positions),
               [(0.5 + x / 0.06, 0.5 + z / 0.06) for x, _, z in positions])
    facing, turning = rotation(Z, tilt - 90), rotation(Y, turn)
    return tuple(moved(part, turn=lambda v: turning(facing(v))) for part in (peel, cut))


def resting(mesh, place, turn=lambda v: v):
    """The mesh turned, and put on the height place[1] so that its lowest point just touches."""
    turned = moved(mesh, turn=turn)
    return moved(turned, (place[0], place[1] - min(p[1] for p in turned.positions), place[2]))


def pear():
    profile = curve([(0.0, 0.003), (0.012, 0.0), (0.028, 0.008), (0.038, 0.028), (0.035, 0.050),
                     (0.022, 0.073), (0.0165, 0.090), (0.012, 0.099), (0.004, 0.101), (0.0, 0.0995)], 4)
    profile = [(max(r, 0.0), y) for r, y in profile]
    body = lathe(profile, 44)
    lean = [(x + 0.9 * y * y, y, z) for x, y, z in body.positions]
    body = smooth(Mesh(lean, body.triangles))
    top = (0.9 * 0.0995 ** 2, 0.0985, 0.0)
    stem = tube(curve(
        [top, add(top,
                  (0.002, 0.01, 0.0)), add(top, (0.008, 0.024, 0.003))], 4), lambda t: 0.0018 + 0.0008 * t, 8)
    return body, stem


def add_glass(glb, root):
    """One closed surface: up the outside, over the lip, down the inside."""
    glass = glb.material("glass", (1, 1, 1), roughness=0.0, transmission=1.0, thickness=0.002, ior=1.5)
    outside = curve([(0.0345, 0.0020), (0.030, 0.0042), (0.014, 0.0075), (0.0055, 0.014), (0.0040, 0.035),
                     (0.0042, 0.070), (0.0085, 0.084), (0.026, 0.100), (0.0385, 0.130), (0.0385, 0.160),
                     (0.0335, 0.198)], 6)
    inside = curve([(0.0321, 0.198), (0.0368, 0.160), (0.0367, 0.131), (0.0240, 0.102), (0.0085, 0.0895),
                    (0.0, 0.088)], 6)
    profile = [(0.0, 0.0), (0.0335, 0.0), (0.0345, 0.0008), *outside, (0.0331, 0.1987), (0.0325, 0.1987),
               *inside]
    profile = [(max(r, 0.0), y) for r, y in profile]
    glb.mesh("glass", [(lathe(profile, 56), glass)], root, translation=GLASS)


def add_cup(glb, root):
    """White porcelain on a saucer."""
    porcelain = glb.material("porcelain", (0.85, 0.83, 0.78), roughness=0.12)
    saucer = [(0.0, 0.003), (0.030, 0.003), (0.0312, 0.0008), (0.0325, 0.0), (0.0345, 0.0005),
              (0.0365, 0.0035), *curve([(0.050, 0.006), (0.066, 0.0125), (0.0735, 0.0165)], 4),
              (0.0743, 0.0175), (0.0735, 0.0182), *curve([(0.066, 0.0150), (0.050, 0.0088), (0.036, 0.0066),
                                                          (0.0, 0.0062)], 4)]
    outside = curve([(0.0215, 0.0009), (0.0225, 0.005), (0.0330, 0.016), (0.0395, 0.034), (0.0410, 0.052),
                     (0.0420, 0.0595)], 5)
    inside = curve([(0.0400, 0.0597), (0.0388, 0.052), (0.0372, 0.034), (0.0305, 0.0175), (0.018, 0.009),
                    (0.0, 0.0075)], 5)
    cup = lathe([(0.0, 0.002), (0.019, 0.002), (0.0198, 0.0), (0.0208, 0.0), *outside, (0.0416, 0.0605),
                 (0.0405, 0.0605), *inside], 56)
    handle = tube(
        curve([(0.0385, 0.047, 0), (0.052, 0.0515, 0), (0.0625, 0.044, 0), (0.060, 0.030, 0),
               (0.047, 0.0215, 0), (0.0340, 0.0205, 0)], 5), lambda t: 0.0036, 10)
    cup, handle = (moved(part, (0, 0.0063, 0), rotation(Y, -35)) for part in (cup, handle))
    glb.mesh("cup", [(joined([lathe(saucer, 64), cup, handle]), porcelain)], root, translation=CUP)


def add_books(glb, root):
    paper = glb.material("paper", (1, 1, 1), texture=glb.texture("pages", textures.pages()), **MATTE)
    covers = [
        glb.material("red cover", (0.33, 0.04, 0.035), roughness=0.5),
        glb.material("blue cover", (0.05, 0.10, 0.20), roughness=0.5)
    ]
    y = 0.0
    for cover, size, turn in ((covers[1], (0.24, 0.036, 0.165), 12), (covers[0], (0.205, 0.030, 0.14), 27)):
        boards, pages = book(size)
        glb.mesh("book", [(boards, cover), (pages, paper)],
                 root,
                 translation=add(BOOKS, (0, y, 0)),
                 rotation=about(Y, turn))
        y += size[1]


def book(size):
    """Lies flat on y = 0, its rounded spine towards +z."""
    wide, high, deep = size
    board, inset = 0.003, 0.004
    back = deep / 2

    def spine(u, v):
        angle = math.pi * (v - 0.5)
        return ((u - 0.5) * wide, high / 2 + high / 2 * math.sin(angle),
                back - 0.004 + 0.008 * math.cos(angle))

    def inner(u, v):
        x, y, z = spine(1 - u, v)
        return (x, high / 2 + (y - high / 2) * 0.85, z - board)

    covers = [
        moved(rounded_box((wide, board, deep), 0.0012), (0, y, -0.004)) for y in (board / 2, high - board / 2)
    ]
    covers += [sheet(spine, 2, 16), sheet(inner, 2, 16)]
    pages = moved(rounded_box((wide - 2 * inset, high - 2 * board, deep - inset), 0.001),
                  (0, high / 2, -0.002))
    pages.uvs = [(y * 60, 0.5) for _, y, _ in pages.positions]  # the sheets lie on each other
    return without_uvs(joined(covers)), pages


if __name__ == "__main__":
    main()
