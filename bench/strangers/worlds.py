# SPDX-License-Identifier: CC0-1.0
"""Ten small worlds that have little in common, written as glTF; y is up, metres, the cameras look along -z."""
import dataclasses
import math
import pathlib
import random
import sys
from collections.abc import Callable

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scenes"))
import glb as gltf  # noqa: E402  (after the path)
from glb import MATTE, Glb, about  # noqa: E402
from shapes import add, ball, box, quad, sheet  # noqa: E402

X, Y, Z = (1, 0, 0), (0, 1, 0), (0, 0, 1)
WHITE, RED, GREEN = (0.75, 0.73, 0.70), (0.65, 0.08, 0.06), (0.12, 0.45, 0.10)
SQUARE = 1.0  # aspect of every camera


@dataclasses.dataclass(frozen=True)
class World:
    name: str
    about: str
    write: Callable[[pathlib.Path], None]
    sky: bool = False  # lit by the smooth sky
    env_rotate: float = 0.0  # degrees
    noisy: int = 1  # how many times as many samples the reference gets


def knot(turns=(2, 3), ring=0.6, thickness=0.18, columns=150, rows=16):
    """A torus knot with smooth normals, about the y axis."""
    p, q = turns

    def centre(t):
        r = ring + 0.25 * math.cos(q * t)
        return (r * math.cos(p * t), 0.4 * math.sin(q * t), r * math.sin(p * t))

    def point(u, v):
        t, a = 2 * math.pi * u, -2 * math.pi * v
        ahead, behind = centre(t + 1e-3), centre(t - 1e-3)
        along = unit(tuple(x - y for x, y in zip(ahead, behind)))
        side = unit(cross(along, Y))
        up = cross(side, along)
        return tuple(c + thickness * (math.cos(a) * s + math.sin(a) * w) for c, s, w in zip(centre(t), side, up))

    return sheet(point, columns, rows)


def unit(v):
    length = math.sqrt(sum(x * x for x in v))
    return tuple(x / length for x in v)


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def matte(glb, colour):
    return glb.material("matte", colour, double_sided=True, **MATTE)


def metal(glb, colour, roughness, share=1.0):
    """GGX of alpha `roughness`², `share` of it metal, the rest matte."""
    return glb.material("metal", colour, metallic=share, roughness=roughness, specular=0.0, double_sided=True)


def sphere(radius):
    return ball(radius, 64, 32)


def block(half, centre=(0, 0, 0)):
    return box(tuple(c - h for c, h in zip(centre, half)), add(centre, half))


def put(glb, shape, material, place=(0, 0, 0), degrees=0.0, size=1.0):
    glb.mesh("thing", [(shape, material)], translation=place, rotation=about(Y, degrees), scale=(size, ) * 3)


def ground(glb, material, half=4.0):
    put(glb, quad((-half, 0, half), (half, 0, half), (half, 0, -half), (-half, 0, -half)), material)


def put_room(glb, half, height, walls, left, right):
    """Floor, ceiling and three walls; open towards the camera."""
    x, z = half
    put(glb, quad((-x, 0, z), (x, 0, z), (x, 0, -z), (-x, 0, -z)), walls)
    put(glb, quad((-x, height, -z), (x, height, -z), (x, height, z), (-x, height, z)), walls)
    put(glb, quad((-x, 0, -z), (x, 0, -z), (x, height, -z), (-x, height, -z)), walls)
    put(glb, quad((-x, 0, z), (-x, 0, -z), (-x, height, -z), (-x, height, z)), left)
    put(glb, quad((x, 0, -z), (x, 0, z), (x, height, z), (x, height, -z)), right)


def put_lamp(glb, centre, half, radiance):
    """A square that shines downwards."""
    x, y, z = centre
    light = glb.material("lamp", (0.5, 0.5, 0.5), emission=radiance, **MATTE)
    put(glb, quad((x - half, y, z - half), (x + half, y, z - half), (x + half, y, z + half), (x - half, y, z + half)),
        light)


def write_lamps(path):
    glb = Glb("worlds.py")
    put_room(glb, (1.2, 1.5), 2.0, metal(glb, (0.7, 0.7, 0.7), 0.35, share=0.5), matte(glb, (0.65, 0.30, 0.06)),
             matte(glb, (0.12, 0.45, 0.50)))
    put(glb, knot(), metal(glb, (0.90, 0.90, 0.95), 0.4), (0.2, 0.5, -0.3), size=0.6)
    put(glb, block((0.2, 0.4, 0.2)), matte(glb, (0.8, 0.8, 0.8)), (-0.6, 0.4, 0.3))
    glb.point_light("lamp", (-0.7, 1.6, 0.2), (2.0, 1.8, 1.5))
    glb.point_light("lamp", (0.9, 0.3, -1.0), (0.5, 1.0, 2.0))
    glb.spot_light("spot", (0, 1.9, 0.5), (0.3, 0, -0.4), (9, 9, 9), half_angle=0.5)
    glb.camera("camera", (0, 1, 2.9), (0, 1, 0), math.radians(45), SQUARE)
    glb.write(path)


def write_window(path):
    glb = Glb("worlds.py")
    white, x, y, z = matte(glb, (0.78, 0.76, 0.72)), 1.5, 2.4, 2.6
    put(glb, quad((-x, 0, z), (x, 0, z), (x, 0, -z), (-x, 0, -z)), matte(glb, (0.50, 0.35, 0.22)))
    put(glb, quad((-x, y, -z), (x, y, -z), (x, y, z), (-x, y, z)), white)
    put(glb, quad((-x, 0, -z), (x, 0, -z), (x, y, -z), (-x, y, -z)), white)
    put(glb, quad((x, 0, z), (-x, 0, z), (-x, y, z), (x, y, z)), white)
    put(glb, quad((x, 0, -z), (x, 0, z), (x, y, z), (x, y, -z)), matte(glb, (0.7, 0.5, 0.4)))
    for z0, z1, y0, y1 in ((-z, -1.6, 0, y), (-0.2, z, 0, y), (-1.6, -0.2, 0, 0.7), (-1.6, -0.2, 1.9, y)):
        put(glb, quad((-x, y0, z1), (-x, y0, z0), (-x, y1, z0), (-x, y1, z1)), white)  # around the window
    put(glb, block((0.4, 0.35, 0.3)), metal(glb, (0.70, 0.70, 0.75), 0.4), (0.5, 0.35, -1.2), 20)
    put(glb, sphere(0.35), matte(glb, (0.8, 0.6, 0.3)), (-0.5, 0.35, -0.7))
    glb.camera("camera", (0, 1.1, 2.4), (-0.3, 0.8, -1), math.radians(65), SQUARE)
    glb.write(path)


def write_materials(path):
    glb = Glb("worlds.py")
    put_room(glb, (1, 1), 2.0, matte(glb, WHITE), matte(glb, RED), matte(glb, GREEN))
    put_lamp(glb, (0, 1.99, 0), 0.3, (14, 12, 9))
    for i, (roughness, share) in enumerate(((0.15, 1), (0.35, 1), (0.6, 1), (1, 1), (0.3, 0.5))):
        place = (-0.7 + 0.35 * i, 0.27 if i % 2 else 0.9, -0.4 + 0.3 * (i % 3))
        put(glb, sphere(0.27), metal(glb, (0.90, 0.75, 0.45), roughness, share), place)
    put(glb, block((0.3, 0.35, 0.3)), matte(glb, (0.3, 0.4, 0.7)), (-0.4, 0.35, 0.4), 25)
    glb.camera("camera", (0, 1, 3.6), (0, 1, 0), math.radians(38), SQUARE)
    glb.write(path)


def write_mirrors(path):
    glb = Glb("worlds.py")
    put_room(glb, (1, 1), 2.0, matte(glb, (0.7, 0.7, 0.7)), metal(glb, (0.90, 0.90, 0.92), 0.04),
             metal(glb, (0.95, 0.80, 0.60), 0.25))
    put_lamp(glb, (0, 1.99, 0), 0.25, (18, 18, 18))
    put(glb, block((0.25, 0.5, 0.25)), matte(glb, (0.7, 0.3, 0.1)), (-0.3, 0.5, -0.2), 30)
    put(glb, sphere(0.3), matte(glb, (0.2, 0.5, 0.7)), (0.45, 0.3, 0.3))
    glb.camera("camera", (0.2, 1, 3.4), (0, 0.9, 0), math.radians(40), SQUARE)
    glb.write(path)


def write_gloss(path):
    glb = Glb("worlds.py")
    put_room(glb, (1, 1), 2.0, metal(glb, (0.85, 0.85, 0.85), 0.3), metal(glb, (0.9, 0.4, 0.3), 0.5),
             metal(glb, (0.4, 0.7, 0.9), 0.2, share=0.7))
    put_lamp(glb, (0, 1.99, 0), 0.3, (8, 8, 8))
    put(glb, sphere(0.35), metal(glb, (0.9, 0.9, 0.9), 0.2), (-0.4, 0.35, 0.2))
    put(glb, block((0.25, 0.5, 0.25)), metal(glb, (0.8, 0.7, 0.4), 0.35), (0.4, 0.5, -0.2), 20)
    glb.camera("camera", (0, 1, 3.6), (0, 1, 0), math.radians(38), SQUARE)
    glb.write(path)


def write_instances(path):
    glb, rng = Glb("worlds.py"), random.Random(3)
    ground(glb, metal(glb, (0.60, 0.60, 0.62), 0.5))
    shape = knot()
    models = [glb.model("knot", [(shape, material)])
              for material in (metal(glb, (0.95, 0.80, 0.40), 0.3), metal(glb, (0.4, 0.6, 0.8), 0.6, share=0.6),
                               matte(glb, (0.7, 0.2, 0.2)))]
    for i in range(9):
        size = tuple(rng.uniform(0.3, 0.8) * sign for sign in ((1 if i % 2 else -1), 1, 1))  # some are mirrored
        glb.node("copy", mesh=models[i % 3], translation=(-1.4 + 1.4 * (i % 3), 0.5, -1.4 + 1.2 * (i // 3)),
                 rotation=about(Y, 40 * i), scale=size)
    glb.camera("camera", (2, 2.2, 4), (0, 0.5, 0), math.radians(40), SQUARE)
    glb.write(path)


def write_orthographic(path):
    glb = Glb("worlds.py")
    ground(glb, metal(glb, (0.6, 0.6, 0.6), 0.4, share=0.5))
    put(glb, knot(), metal(glb, (0.8, 0.5, 0.3), 0.5), (0, 0.62, 0))
    put(glb, block((0.25, 0.25, 0.25)), matte(glb, (0.3, 0.5, 0.8)), (1.2, 0.25, 0.4))
    glb.point_light("lamp", (-1, 2, 1), (6, 5, 4))
    glb.directional_light("sun", (-2, -4, 1), (1.0, 1.1, 1.4))
    glb.spot_light("spot", (1.5, 2.5, 1.5), (0.6, 0, 0.6), (20, 4, 4), half_angle=0.3)
    glb.orthographic_camera("camera", (3, 3, 3), (0, 0.4, 0), half_side=1.7)
    glb.write(path)


def leaf_picture(side=32):
    """A green ellipse, opaque, on nothing."""
    inside = [((x - 15.5) / 14.0)**2 + ((y - 15.5) / 6.2)**2 < 1 for y in range(side) for x in range(side)]
    return gltf.png(side, side, [int(i) for i in inside], [(70, 160, 50, 0), (70, 160, 50, 255)])


def write_leaves(path):
    glb, rng = Glb("worlds.py"), random.Random(7)
    ground(glb, matte(glb, (0.55, 0.50, 0.45)))
    leaf = glb.material("leaf", (1, 1, 1), texture=glb.texture("leaf", leaf_picture()), alpha_mode="MASK",
                        double_sided=True, **MATTE)
    veil = glb.material("veil", (0.8, 0.3, 0.2), alpha_mode="BLEND", alpha=0.45, double_sided=True, **MATTE)
    card = quad((-0.5, -0.5, 0), (0.5, -0.5, 0), (0.5, 0.5, 0), (-0.5, 0.5, 0))
    model = glb.model("leaf", [(card, leaf)])
    for _ in range(120):
        place = tuple(rng.gauss(0, 0.45) * flat + up for flat, up in ((1, 0), (0.5, 0.85), (1, 0)))
        axis = unit(tuple(rng.gauss(0, 1) for _ in range(3)))
        glb.node("leaf", mesh=model, translation=place, rotation=about(axis, rng.uniform(0, 360)),
                 scale=(rng.uniform(0.2, 0.5), ) * 3)
    put(glb, card, veil, (0.9, 0.5, 0.8), -30)
    glb.camera("camera", (0, 1.2, 3.4), (0, 0.6, 0), math.radians(42), SQUARE)
    glb.write(path)


def write_emissive(path):
    glb = Glb("worlds.py")
    put_room(glb, (1, 1), 2.0, matte(glb, WHITE), matte(glb, RED), matte(glb, GREEN))
    light = glb.material("light", (0.1, 0.1, 0.1), emission=(4.0, 3.4, 5.0), double_sided=True, **MATTE)
    put(glb, knot(ring=0.35, thickness=0.05, columns=96, rows=8), light, (0.1, 1.1, -0.4))
    put(glb, sphere(0.35), metal(glb, (0.8, 0.8, 0.8), 0.3), (-0.4, 0.35, 0.2))
    put(glb, block((0.3, 0.3, 0.3)), matte(glb, (0.8, 0.8, 0.8)), (0.5, 0.3, 0.3), 15)
    glb.camera("camera", (0, 1, 3.6), (0, 1, 0), math.radians(38), SQUARE)
    glb.write(path)


def write_wall(path):
    """Two rooms behind one another; the wall between them, 1 cm thick, has a gap, and the lamp is in the other one."""
    glb = Glb("worlds.py")
    white, thick = matte(glb, (0.80, 0.78, 0.75)), 0.005
    put_room(glb, (1, 2), 2.0, white, matte(glb, (0.7, 0.4, 0.3)), white)
    put(glb, block((0.65, 1, thick), (-0.35, 1, -0.6)), white)  # leaves a gap of 40 cm, then a strip at the right
    put(glb, block((0.15, 1, thick), (0.85, 1, -0.6)), matte(glb, (0.3, 0.5, 0.4)))
    put(glb, block((thick, 0.4, 0.35), (-0.35, 0.4, 0.1)), matte(glb, (0.4, 0.5, 0.8)))  # a screen
    put(glb, sphere(0.25), matte(glb, (0.75, 0.7, 0.3)), (0.2, 0.25, 0.2))
    put_lamp(glb, (0.2, 1.99, -1.3), 0.4, (22, 20, 17))
    glb.camera("camera", (0, 1, 3.9), (0, 1, 0), math.radians(40), SQUARE)
    glb.write(path)


WORLDS = [
    World("lamps", "two lamps without area and a spot in a room that shines a little", write_lamps, noisy=4),
    World("window", "a closed room with one window to a smooth sky", write_window, sky=True, env_rotate=75),
    World("materials", "a room with metal of four roughnesses and a mixture", write_materials),
    World("mirrors", "a room with one mirror and one glossy wall", write_mirrors, noisy=2),
    World("gloss", "a room all of glossy metal", write_gloss, noisy=2),
    World("instances", "nine copies of one mesh, scaled and mirrored, under a sky", write_instances, sky=True),
    World("orthographic", "parallel rays; a lamp, a sun and a spot without area", write_orthographic, noisy=2),
    World("leaves", "120 leaves cut out by a mask, and a veil", write_leaves, sky=True, env_rotate=200),
    World("emissive", "a room lit by a knot of 1,536 triangles", write_emissive),
    World("wall", "light that comes from another room, past a wall of 1 cm", write_wall),
]
