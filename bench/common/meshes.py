# SPDX-License-Identifier: Apache-2.0
"""Triangle meshes with numpy: reading PLY and OBJ, Loop subdivision, smooth normals, a closed shape of our own.

A mesh is (positions, triangles): n x 3 float64 and m x 3 int64, counter-clockwise seen from outside.
"""
import gzip
import io
import pathlib

import numpy as np

Mesh = tuple[np.ndarray, np.ndarray]


# --- files ---


def read_ply(path: pathlib.Path) -> Mesh:
    """ASCII PLY of triangles, perhaps gzipped, whose vertices begin with x y z and come before the faces."""
    raw = pathlib.Path(path).read_bytes()
    text = gzip.decompress(raw) if raw[:2] == b"\x1f\x8b" else raw
    header, _, body = text.partition(b"end_header\n")
    words = [line.split() for line in header.decode().splitlines()]
    if ["format", "ascii", "1.0"] not in words:
        raise ValueError(f"{path}: expected an ASCII PLY")
    counts = {w[1]: int(w[2]) for w in words if w and w[0] == "element"}
    properties = sum(1 for w in words if w and w[0] == "property" and w[1] != "list")
    numbers = np.array(body.split(), dtype=np.float64)
    split = counts["vertex"] * properties
    faces = numbers[split:].reshape(counts["face"], 4).astype(np.int64)
    if not np.all(faces[:, 0] == 3):
        raise ValueError(f"{path}: expected triangles alone")
    return numbers[:split].reshape(-1, properties)[:, :3].copy(), faces[:, 1:]


def read_obj(path: pathlib.Path) -> Mesh:
    """Positions and triangles of an OBJ; other lines are passed over."""
    positions, triangles = [], []
    with io.open(path, encoding="utf-8", errors="replace") as file:
        for line in file:
            words = line.split()
            if words[:1] == ["v"]:
                positions.append([float(x) for x in words[1:4]])
            elif words[:1] == ["f"]:
                if len(words) != 4:
                    raise ValueError(f"{path}: expected triangles, found a face of {len(words) - 1} vertices")
                triangles.append([int(word.split("/")[0]) for word in words[1:]])
    corners = np.array(triangles, dtype=np.int64)
    corners = np.where(corners > 0, corners - 1, len(positions) + corners)
    return np.array(positions), corners


# --- topology ---


def edges(triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Undirected edges (k x 2, sorted), the edge of each triangle's side i -> i + 1 (m x 3), triangles per edge (k)."""
    sides = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2).reshape(-1, 2)
    unique, inverse, counts = np.unique(np.sort(sides, axis=1), axis=0, return_inverse=True, return_counts=True)
    return unique, inverse.reshape(-1, 3), counts


def is_closed(mesh: Mesh) -> bool:
    """Whether every edge has two triangles that run along it in opposite directions."""
    triangles = mesh[1]
    sides = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2).reshape(-1, 2)
    if len(np.unique(sides, axis=0)) != len(sides):
        return False
    return bool(np.all(edges(triangles)[2] == 2))


def euler_characteristic(mesh: Mesh) -> int:
    """V - E + F of the vertices in use; 2 for a sphere."""
    return len(np.unique(mesh[1])) - len(edges(mesh[1])[0]) + len(mesh[1])


# --- geometry ---


def loop_subdivision(mesh: Mesh, steps: int = 1) -> Mesh:
    """Loop's scheme [Loop 1987] with his vertex weights; closed meshes only. Four times the triangles a step."""
    for _ in range(steps):
        mesh = _loop_step(mesh)
    return mesh


def _loop_step(mesh: Mesh) -> Mesh:
    positions, triangles = mesh
    if not is_closed(mesh):
        raise ValueError("Loop subdivision: expected a closed mesh, found an edge without exactly two triangles")
    ends, side_edges, _ = edges(triangles)
    # Old vertices: (1 - k beta) v + beta * the sum of its k neighbours.
    valence = np.bincount(ends.ravel(), minlength=len(positions))
    around = np.zeros_like(positions)
    np.add.at(around, ends[:, 0], positions[ends[:, 1]])
    np.add.at(around, ends[:, 1], positions[ends[:, 0]])
    k = np.maximum(valence, 1)
    beta = (5 / 8 - (3 / 8 + np.cos(2 * np.pi / k) / 4)**2) / k
    moved = (1 - valence * beta)[:, None] * positions + beta[:, None] * around
    # New vertices: 3/8 of the edge's ends, 1/8 of the two corners across.
    across = np.zeros((len(ends), 3))
    np.add.at(across, side_edges, positions[np.roll(triangles, -2, axis=1)])
    middles = 3 / 8 * positions[ends].sum(axis=1) + across / 8
    a, b, c = triangles.T
    ab, bc, ca = (side_edges + len(positions)).T
    finer = np.concatenate([np.stack(t, axis=1) for t in ((a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca))])
    return np.concatenate([moved, middles]), finer


def smooth_normals(mesh: Mesh) -> np.ndarray:
    """Unit normals of the vertices: the mean of their triangles, weighted by area."""
    positions, triangles = mesh
    a, b, c = (positions[triangles[:, i]] for i in range(3))
    twice_area = np.cross(b - a, c - a)
    normals = np.zeros_like(positions)
    for i in range(3):
        np.add.at(normals, triangles[:, i], twice_area)
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    return np.where(length > 0, normals / np.maximum(length, 1e-300), (0.0, 1.0, 0.0))


def signed_volume(mesh: Mesh) -> float:
    """Above 0 where triangles face outwards."""
    a, b, c = (mesh[0][mesh[1][:, i]] for i in range(3))
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6)


def without_degenerate_triangles(mesh: Mesh) -> Mesh:
    """Leaves out triangles without area, which have no normal."""
    a, b, c = (mesh[0][mesh[1][:, i]] for i in range(3))
    return mesh[0], mesh[1][np.linalg.norm(np.cross(b - a, c - a), axis=1) > 0]


# --- shapes ---


def icosahedron() -> Mesh:
    """Twenty triangles, corners at distance 1."""
    g = (1 + 5**0.5) / 2
    corners = np.array([(-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g), (0, -1, -g), (0, 1, -g),
                        (g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1)])
    triangles = ((0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2),
                 (10, 7, 6), (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11),
                 (6, 2, 10), (8, 6, 7), (9, 8, 1))
    return corners / np.linalg.norm(corners, axis=1, keepdims=True), np.array(triangles)


def sphere(level: int) -> Mesh:
    """A unit sphere of 20 * 4^level triangles: the icosahedron, subdivided and pushed outwards at every step."""
    mesh = icosahedron()
    for _ in range(level):
        positions, triangles = loop_subdivision(mesh)
        mesh = positions / np.linalg.norm(positions, axis=1, keepdims=True), triangles
    return mesh


def knobbed_shape() -> Mesh:
    """327,680 triangles, closed: a sphere with horns, knobs and grain; stands in for the armadillo."""
    positions, triangles = sphere(5)
    generator = np.random.default_rng(1987)
    radius = np.ones(len(positions))
    for count, height, sharpness in ((16, 0.8, 20.0), (60, 0.12, 120.0), (240, 0.045, 500.0)):
        centres = generator.normal(size=(count, 3))
        centres /= np.linalg.norm(centres, axis=1, keepdims=True)
        radius += height * np.exp(sharpness * (positions @ centres.T - 1)).sum(axis=1)
    positions, triangles = loop_subdivision((positions * radius[:, None], triangles), 2)
    grain = np.sin(55 * positions) * np.cos(47 * np.roll(positions, 1, axis=1))
    return positions + 0.003 * grain, triangles
