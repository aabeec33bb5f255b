# SPDX-License-Identifier: Apache-2.0
"""The scenes, each under its light. Gather rays bring back what has no noise: environment, or light of point lights."""
import dataclasses
import math
import pathlib
import random
from collections.abc import Callable

import environments
import make_scenes
from command import Options, Relumine, View
from reference import References

import demo  # make_scenes has put scenes/ on the path
import glb as gltf
from shapes import add, ball, box, joined, moved, mul, quad, rotation, rounded_box, torus, tube

X, Y, Z = (1, 0, 0), (0, 1, 0), (0, 0, 1)
SUN_BEHIND_THE_BLINDS = 5.0  # env_rotate in degrees: its light falls towards the camera, from the left
GLOSS_ALPHA = 0.07  # GGX; glTF's roughness is its square root


@dataclasses.dataclass(frozen=True)
class Cell:
    """A scene under its light."""
    name: str
    about: str  # for the report
    file: pathlib.Path
    environment: pathlib.Path | None = None
    env_rotate: float = 0.0
    radiance: str = "emission"  # what gather rays bring back

    @property
    def path_depth(self) -> int:
        """Scattering vertices of the paths that carry the same light."""
        return 2 if self.radiance == "direct" else 1

    def view(self, width: int, height: int, spp: int) -> View:
        extra: Options = {"radiance": self.radiance}
        if spp > 1:
            extra |= {"spp": spp, "pixel-sampling": "jitter"}
        return View(self.file, self.environment, self.env_rotate, width, height, extra)


NAMES = ("shadow", "dragon", "armadillo", "armadillo-sun", "still-life", "window", "room", "blinds", "foliage", "gloss")


def make_cells(folder: pathlib.Path, wanted: list[str], dragon: pathlib.Path,
               armadillo: pathlib.Path | None) -> tuple[list[Cell], pathlib.Path, list[str]]:
    """Those wanted that can be made, the white environment, and why others cannot."""
    skies = environments.write_environments(folder)
    models = [m for m in ("shadow", "dragon", "armadillo") if any(name.startswith(m) for name in wanted)]
    made, missing = make_scenes.make_all(folder, dragon, armadillo, models) if models else ([], [])
    smooth, sun = skies["smooth"], skies["sun"]
    cells = {}
    for scene in made:
        light = smooth if scene.name == "armadillo" else sun
        kind = "smooth sky" if light == smooth else "sun and sky"
        cells[scene.name] = Cell(scene.name, f"{scene.model}; {kind}", scene.file, light, scene.env_rotate)
        if scene.name == "armadillo":
            cells["armadillo-sun"] = Cell("armadillo-sun", "the same; sun and sky", scene.file, sun, scene.env_rotate)
    scenes = make_scenes.ROOT / "scenes"
    sky = scenes / "sky.exr"
    side, behind = make_scenes.SUN_TO_THE_LEFT, SUN_BEHIND_THE_BLINDS
    for name, write, about, light in (
        ("still-life", write_still_life, "demo.glb without its glass: textures, glaze, by a window; sky.exr, its sun in the map",
         (sky,)),
        ("window", write_window, "matte room with things in it, lit through one window by the smooth sky", (smooth, side)),
        ("room", write_room, "closed room, glossy floor, two point lights: final gather of their direct light",
         (None, 0.0, "direct")),
        ("blinds", write_blinds, "matte floor and a ball behind 48 slats; sun and sky", (sun, behind)),
        ("foliage", write_foliage, "a bush of 2,400 leaves; smooth sky", (smooth, side)),
        ("gloss", write_gloss, f"sharply glossy metal (GGX alpha {GLOSS_ALPHA:g}); smooth sky", (smooth, side)),
    ):
        if name in wanted:
            file = folder / f"{name}.glb"
            write(file)
            cells[name] = Cell(name, about, file, *light)
    return [cells[name] for name in wanted if name in cells], skies["white"], missing


def references(relumine: Relumine, out: pathlib.Path, rays: int, max_passes: int, log: Callable[[str], None]) -> References:
    """The same for all programs of this folder, so that each finds what another has rendered."""
    return References(relumine, out / "references", rays, max(1, rays // 4), max_passes, log, sampler="sobol")


# --- scenes of our own; metres, y up ---


def ground(side: float) -> gltf.Mesh:
    return quad((-side, 0, side), (side, 0, side), (side, 0, -side), (-side, 0, -side))


def write_still_life(file: pathlib.Path) -> None:
    """The README's picture without the wine glass: what stands behind glass, gather rays and paths see at other depths."""
    glb = gltf.Glb("bench/equal-error")
    root = glb.node("room", rotation=gltf.about(Y, demo.SUN_FROM - demo.SUN_AZIMUTH))
    for add_part in (demo.add_room, demo.add_window, demo.add_table, demo.add_cloth, demo.add_vase, demo.add_bowl,
                     demo.add_fruit, demo.add_books, demo.add_cup):
        add_part(glb, root)
    glb.camera("camera", eye=(0.58, 0.50, 1.78), target=(-0.05, 0.15, -0.1), yfov=0.46, aspect=1.5, parent=root)
    glb.write(file)


def write_window(file: pathlib.Path) -> None:
    """Four metres wide; the window is in the left wall, the camera inside."""
    glb = gltf.Glb("bench/equal-error")
    plaster = glb.material("plaster", (0.7, 0.68, 0.63), **gltf.MATTE)
    floor = glb.material("floor", (0.35, 0.24, 0.16), roughness=0.5)
    left, right, back, front, high, thick = -2.0, 2.0, -2.0, 3.0, 2.6, 0.2
    walls = [box((left - thick, 0, back), (left, 0.8, front)), box((left - thick, 2.1, back), (left, high, front)),
             box((left - thick, 0.8, back), (left, 2.1, -1.5)), box((left - thick, 0.8, 1.3), (left, 2.1, front)),
             box((right, 0, back), (right + thick, high, front)), box((left, 0, back - thick), (right, high, back)),
             box((left, 0, front), (right, high, front + thick)),
             box((left - thick, high, back - thick), (right + thick, high + thick, front + thick))]
    glb.mesh("walls", [(joined(walls), plaster)])
    glb.mesh("floor", [(box((left, -thick, back), (right, 0, front)), floor)])
    put_things(glb)
    glb.camera("camera", eye=(0.9, 1.5, 2.7), target=(-0.35, 0.85, -0.6), yfov=0.9, aspect=1.0)
    glb.write(file)


def write_room(file: pathlib.Path) -> None:
    """A closed box with two lamps that are points: sharp shadows, and light from one wall to the next."""
    glb = gltf.Glb("bench/equal-error")
    white, red, green = (glb.material(name, colour, **gltf.MATTE) for name, colour in (
        ("white", (0.73, 0.73, 0.73)), ("red", (0.63, 0.07, 0.05)), ("green", (0.14, 0.45, 0.09))))
    shiny = glb.material("floor", (0.7, 0.66, 0.6), metallic=0.5, roughness=0.45)
    w, h, d = 2.0, 2.6, 3.0
    glb.mesh("floor", [(quad((-w, 0, d), (w, 0, d), (w, 0, -d), (-w, 0, -d)), shiny)])
    glb.mesh("ceiling, back, front", [(joined([
        quad((-w, h, -d), (w, h, -d), (w, h, d), (-w, h, d)), quad((-w, 0, -d), (w, 0, -d), (w, h, -d), (-w, h, -d)),
        quad((w, 0, d), (-w, 0, d), (-w, h, d), (w, h, d))]), white)])
    glb.mesh("left", [(quad((-w, 0, d), (-w, 0, -d), (-w, h, -d), (-w, h, d)), red)])
    glb.mesh("right", [(quad((w, 0, -d), (w, 0, d), (w, h, d), (w, h, -d)), green)])
    put_things(glb)
    glb.point_light("lamp", (0.5, 2.2, -0.4), (6.0, 5.4, 4.4))
    glb.point_light("small lamp", (-1.3, 0.9, 1.0), (1.0, 1.1, 1.4))
    glb.camera("camera", eye=(0.6, 1.5, 2.8), target=(-0.1, 0.85, -1.0), yfov=0.9, aspect=1.0)
    glb.write(file)


def put_things(glb: gltf.Glb) -> None:
    """A table with a ball and a ring on it, a block and a chair's worth of thin legs."""
    wood = glb.material("wood", (0.45, 0.3, 0.18), roughness=0.6)
    grey = glb.material("grey", (0.5, 0.5, 0.52), **gltf.MATTE)
    metal = glb.material("metal", (0.85, 0.8, 0.7), metallic=1.0, roughness=0.45)
    legs = [box((x - 0.025, 0, z - 0.025), (x + 0.025, 0.72, z + 0.025)) for x in (-0.75, 0.35) for z in (-0.9, -0.3)]
    glb.mesh("table", [(joined([*legs, box((-0.85, 0.72, -1.0), (0.45, 0.76, -0.2))]), wood)])
    glb.mesh("ball", [(moved(ball(0.2, 48, 32), (-0.5, 0.96, -0.6)), metal)])
    glb.mesh("ring", [(moved(torus(0.16, 0.05, 64, 24), (0.1, 0.81, -0.55)), grey)])
    glb.mesh("block", [(moved(box((-0.3, 0, -0.25), (0.3, 1.1, 0.25)), (1.2, 0, -0.9), rotation(Y, 25)), grey)])


def write_blinds(file: pathlib.Path) -> None:
    """Slats stand in the sun between it and what is seen; every slat is 3 mm thick."""
    glb = gltf.Glb("bench/equal-error")
    floor = glb.material("floor", (0.55, 0.5, 0.45), **gltf.MATTE)
    paint = glb.material("paint", (0.75, 0.74, 0.7), roughness=0.5)
    tile = glb.material("glaze", (0.15, 0.3, 0.5), roughness=0.3)
    glb.mesh("floor", [(ground(6), floor)])
    slat = box((-0.7, -0.0015, -0.02), (0.7, 0.0015, 0.02))
    tilted = rotation(X, 35)
    for side, turn in (("left", 60.0), ("back", 0.0)):
        slats = [moved(slat, (0, 0.06 + 0.045 * i, -0.75), tilted) for i in range(24)]
        posts = [box((x - 0.008, 0, -0.76), (x + 0.008, 1.15, -0.744)) for x in (-0.7, 0.7)]
        glb.mesh(f"blind, {side}", [(joined([*slats, *posts]), paint)], rotation=gltf.about(Y, turn))
    glb.mesh("ball", [(moved(ball(0.2, 64, 40), (0, 0.2, -0.1)), tile)])
    glb.camera("camera", eye=(0.9, 1.1, 1.9), target=(-0.05, 0.32, -0.2), yfov=0.6, aspect=1.0)
    glb.write(file)


def write_foliage(file: pathlib.Path) -> None:
    """Stems from one root, leaves of two triangles bent along the middle."""
    glb = gltf.Glb("bench/equal-error")
    soil = glb.material("soil", (0.35, 0.3, 0.25), **gltf.MATTE)
    bark = glb.material("bark", (0.25, 0.17, 0.1), roughness=0.8)
    green = glb.material("leaf", (0.2, 0.42, 0.1), roughness=0.5, double_sided=True)
    glb.mesh("ground", [(ground(6), soil)])
    chance = random.Random(5)
    stems, leaves = [], []
    for i in range(40):
        around, lean = rotation(Y, 360 * i / 40 + chance.uniform(-15, 15)), chance.uniform(0.1, 0.55)
        tall = chance.uniform(0.5, 1.0)
        line = [around((lean * t * t, tall * t, 0)) for t in (j / 8 for j in range(9))]
        stems.append(tube(line, lambda t: 0.009 - 0.006 * t, 6))
        for _ in range(60):
            t = chance.uniform(0.25, 1.0)
            turning, tilting = rotation(Y, chance.uniform(0, 360)), rotation(X, chance.uniform(-60, 25))
            place = around((lean * t * t, tall * t, 0))
            leaves.append(moved(leaf(chance.uniform(0.05, 0.09)), place, lambda v: turning(tilting(v))))
    glb.mesh("stems", [(joined(stems), bark)])
    glb.mesh("leaves", [(joined(leaves), green)])
    glb.camera("camera", eye=(0.7, 1.0, 2.0), target=(0.0, 0.45, 0.0), yfov=0.6, aspect=1.0)
    glb.write(file)


def leaf(size: float) -> gltf.Mesh:
    """Along z from the origin, folded along its middle."""
    half, lift = 0.3 * size, 0.08 * size
    points = [(0, 0, 0), (half, lift, size / 2), (0, 0, size), (-half, lift, size / 2)]
    return gltf.Mesh(points, [(0, 2, 1), (0, 3, 2)])


def write_gloss(file: pathlib.Path) -> None:
    """A tray of sharply glossy metal with things of the same metal on it, and matte ones to be mirrored."""
    glb = gltf.Glb("bench/equal-error")
    sharp = math.sqrt(GLOSS_ALPHA)
    floor = glb.material("floor", (0.4, 0.4, 0.42), metallic=0.0, roughness=0.8)
    steel = glb.material("steel", (0.8, 0.8, 0.82), metallic=1.0, roughness=sharp)
    gold = glb.material("gold", (0.95, 0.75, 0.4), metallic=1.0, roughness=sharp)
    red = glb.material("red", (0.55, 0.12, 0.08), **gltf.MATTE)
    glb.mesh("floor", [(ground(8), floor)])
    glb.mesh("tray", [(moved(rounded_box((1.6, 0.06, 1.2), 0.02), (0, 0.03, 0)), steel)])
    glb.mesh("ball", [(moved(ball(0.25, 96, 64), (-0.35, 0.31, -0.15)), gold)])
    glb.mesh("ring", [(moved(torus(0.22, 0.07, 96, 40), (0.35, 0.13, 0.1)), steel)])
    cubes = [moved(rounded_box((0.16, 0.16, 0.16), 0.015), add((0.28, 0.14, -0.35), mul(X, 0.26 * i)),
                   rotation(Y, 20 + 25 * i)) for i in range(2)]
    glb.mesh("cubes", [(joined(cubes), red)])
    glb.camera("camera", eye=(0.6, 1.15, 1.9), target=(0.0, 0.16, -0.05), yfov=0.6, aspect=1.0)
    glb.write(file)
