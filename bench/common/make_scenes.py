# SPDX-License-Identifier: Apache-2.0
"""The experiment's scenes as glTF: `shadow` exists; `dragon` and `armadillo` are put on a ground plane here."""
import dataclasses
import math
import pathlib
import sys

import numpy as np

import meshes

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scenes"))
import glb as gltf  # noqa: E402  (after the path)
from shapes import quad  # noqa: E402

ENOUGH_TRIANGLES = 300_000  # the paper's armadillo has 346 k
SUN_TO_THE_LEFT = 75.0  # env_rotate in degrees: the sun of our environments shines from the front, left
SUN_IN_THE_METAL = -14.0  # the same: its highlight lies on the plane, at the left, behind the posts
ALPHA = 0.2  # GGX; glTF's roughness is its square root


@dataclasses.dataclass(frozen=True)
class Scene:
    name: str
    file: pathlib.Path
    model: str  # what is shown, in words, for the report
    env_rotate: float = 0.0  # degrees


NAMES = ("shadow", "dragon", "armadillo")


def make_all(folder: pathlib.Path, dragon: pathlib.Path, armadillo: pathlib.Path | None,
             wanted: list[str] | None = None) -> tuple[list[Scene], list[str]]:
    """The scenes that are wanted (None: all) and can be made, and why others cannot."""
    folder.mkdir(parents=True, exist_ok=True)
    scenes, missing = [], []
    for name in wanted or NAMES:
        if name == "shadow":
            model = "bars and boxes over strongly glossy metal (GGX alpha 0.07), 110 triangles"
            scenes.append(Scene(name, ROOT / "scenes/shadow.glb", model, SUN_IN_THE_METAL))
        elif name == "armadillo":
            scenes.append(make_armadillo(folder / "armadillo.glb", armadillo))
        elif name != "dragon":
            raise SystemExit(f"--scenes: expected some of {','.join(NAMES)}, found {name}")
        elif dragon.exists():
            scenes.append(make_dragon(folder / "dragon.glb", dragon))
        else:
            missing.append(f"dragon: {dragon.name} is missing; scripts/fetch-models fetches it")
    return scenes, missing


def make_dragon(target: pathlib.Path, source: pathlib.Path) -> Scene:
    mesh = meshes.read_ply(source)
    model = f"Stanford dragon, {len(mesh[1]):,} triangles, metal (GGX alpha 0.2)"
    scene = Scene("dragon", target, model, SUN_TO_THE_LEFT)
    if up_to_date(target, source):
        return scene
    write_scene(target, stood(meshes.without_degenerate_triangles(mesh), width=1.0), base=(0.93, 0.72, 0.42),
                eye=(0.45, 0.75, 1.9), target_point=(0.0, 0.29, 0.0), yfov=0.56)
    return scene


def make_armadillo(target: pathlib.Path, source: pathlib.Path | None) -> Scene:
    """The armadillo refined by Loop subdivision, or, without its file, a closed shape of our own."""
    steps = 0
    if source is None:
        mesh, words = meshes.knobbed_shape(), "stand-in for the armadillo (no --armadillo FILE): a knobbed sphere"
    else:
        mesh, words = meshes.read_obj(source), f"{source.name}"
        while len(mesh[1]) < ENOUGH_TRIANGLES:
            mesh, steps = meshes.loop_subdivision(mesh), steps + 1
        words += f", {steps} steps of Loop subdivision" if steps else ""
    scene = Scene("armadillo", target, f"{words}, {len(mesh[1]):,} triangles, metal (GGX alpha 0.2)", SUN_TO_THE_LEFT)
    # The armadillo faces +z, towards the camera.
    write_scene(target, stood(mesh, height=1.0), base=(0.78, 0.80, 0.83),
                eye=(0.75, 0.95, 2.35), target_point=(0.0, 0.47, 0.0), yfov=0.56)
    return scene


def up_to_date(target: pathlib.Path, source: pathlib.Path) -> bool:
    """Whether `target` is younger than its source and than this code."""
    makers = [source, *pathlib.Path(__file__).parent.glob("*.py")]
    return target.exists() and all(target.stat().st_mtime > maker.stat().st_mtime for maker in makers)


def stood(mesh: meshes.Mesh, width: float | None = None, height: float | None = None) -> meshes.Mesh:
    """The mesh scaled to this width or height in metres, its foot at the origin."""
    positions = mesh[0]
    low, high = positions.min(axis=0), positions.max(axis=0)
    scale = width / (high[0] - low[0]) if width else height / (high[1] - low[1])
    foot = np.array([(low[0] + high[0]) / 2, low[1], (low[2] + high[2]) / 2])
    return (positions - foot) * scale, mesh[1]


def write_scene(target: pathlib.Path, mesh: meshes.Mesh, base: tuple[float, float, float],
                eye: tuple[float, float, float], target_point: tuple[float, float, float], yfov: float) -> None:
    """A metal model with smooth normals on a rough, slightly glossy floor; camera `eye` looks at `target_point`."""
    glb = gltf.Glb("bench/paper")
    glb.document["asset"]["copyright"] = "see bench/paper/README.md"
    metal = glb.material("metal", base, metallic=1.0, roughness=math.sqrt(ALPHA))
    floor = glb.material("floor", (0.42, 0.40, 0.37), metallic=0.0, roughness=0.7)
    side = 16.0  # metres from the middle
    corners = ((-side, 0, side), (side, 0, side), (side, 0, -side), (-side, 0, -side))
    glb.mesh("floor", [(quad(*corners), floor)])
    normals = meshes.smooth_normals(mesh)
    glb.mesh("model", [(gltf.Mesh(mesh[0].tolist(), mesh[1].tolist(), normals.tolist()), metal)])
    glb.camera("camera", eye=eye, target=target_point, yfov=yfov, aspect=1.0)
    glb.write(target)
