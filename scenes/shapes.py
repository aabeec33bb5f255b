# SPDX-License-Identifier: CC0-1.0
"""Shapes to build scenes from: each returns a `Mesh` around the origin, counter-clockwise seen from outside."""

import math

from glb import Mesh

# --- vectors ---


def add(a, b):
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


def sub(a, b):
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def mul(a, s):
    return (a[0] * s, a[1] * s, a[2] * s)


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def length(a):
    return math.sqrt(dot(a, a))


def unit(a):
    return mul(a, 1 / length(a))


def mix(a, b, t):
    return tuple(x + (y - x) * t for x, y in zip(a, b))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def rotation(axis, degrees):
    """The function that turns a vector by `degrees` about a unit `axis`. [Rodrigues]"""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return lambda v: add(add(mul(v, c), mul(cross(axis, v), s)), mul(axis, dot(axis, v) * (1 - c)))


# --- meshes as values ---


def moved(mesh, offset=(0, 0, 0), turn=lambda v: v, scale=1.0):
    """The mesh scaled, turned (a rotation), then shifted."""
    positions = [add(turn(mul(p, scale)), offset) for p in mesh.positions]
    normals = [turn(n) for n in mesh.normals] if mesh.normals else None
    return Mesh(positions, mesh.triangles, normals, mesh.uvs)


def joined(meshes):
    """One mesh of many; all must have the same attributes."""
    positions, triangles, normals, uvs = [], [], [], []
    for mesh in meshes:
        first = len(positions)
        positions += mesh.positions
        triangles += [(a + first, b + first, c + first) for a, b, c in mesh.triangles]
        normals += mesh.normals or []
        uvs += mesh.uvs or []
    return Mesh(positions, triangles, normals or None, uvs or None)


def rewound(mesh):
    """The mesh with its triangles facing the other way; normals stay."""
    return Mesh(mesh.positions, [(a, c, b) for a, b, c in mesh.triangles], mesh.normals, mesh.uvs)


def without_uvs(mesh):
    return Mesh(mesh.positions, mesh.triangles, mesh.normals)


def area(mesh):
    return sum(length(_twice_area(mesh, triangle)) / 2 for triangle in mesh.triangles)


def smooth(mesh):
    """The mesh with smooth normals, weighted by angle; vertices in the same place share one."""
    total = {}
    keys = [tuple(round(x, 7) for x in p) for p in mesh.positions]
    for triangle in mesh.triangles:
        twice_area = _twice_area(mesh, triangle)
        if length(twice_area) < 1e-14:
            continue
        normal = unit(twice_area)
        for corner in range(3):
            here, left, right = (triangle[(corner + i) % 3] for i in range(3))
            p = mesh.positions[here]
            angle = _angle(sub(mesh.positions[left], p), sub(mesh.positions[right], p))
            total[keys[here]] = add(total.get(keys[here], (0, 0, 0)), mul(normal, angle))
    return Mesh(mesh.positions, mesh.triangles, [unit(total[key]) for key in keys], mesh.uvs)


def _twice_area(mesh, triangle):
    a, b, c = (mesh.positions[i] for i in triangle)
    return cross(sub(b, a), sub(c, a))


def _angle(a, b):
    return math.acos(max(-1.0, min(1.0, dot(a, b) / (length(a) * length(b)))))


# --- flat shapes ---


def quad(a, b, c, d):
    """Two flat triangles with uvs; a is the lower left corner, the rest counter-clockwise."""
    return Mesh([a, b, c, d], [(0, 1, 2), (0, 2, 3)], None, [(0, 1), (1, 1), (1, 0), (0, 0)])


def box(low, high):
    """Twelve flat triangles."""
    return joined(box_sides(low, high))


def box_sides(low, high):
    """The quads -x, +x, -y, +y, -z, +z of a box."""
    corners = [tuple((low, high)[i >> axis & 1][axis] for axis in range(3)) for i in range(8)]
    faces = ((0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6))
    return [quad(*(corners[i] for i in face)) for face in faces]


def rounded_box(size, radius, steps=2):
    """A box about the origin with rounded edges; uvs in metres, u along the longer edge of each side."""
    inner = [s / 2 - radius for s in size]
    arc = [math.tan(math.pi / 4 * i / steps) for i in range(steps + 1)]
    meshes = []
    for axis in range(3):
        others = [i for i in range(3) if i != axis]
        along = max(others, key=lambda i: size[i])
        across = others[0] if others[1] == along else others[1]
        for sign in (-1, 1):
            positions, normals, uvs = [], [], []
            lines = [[-inner[i] - radius * t for t in reversed(arc)] + [inner[i] + radius * t for t in arc]
                     for i in others]
            for y in lines[1]:
                for x in lines[0]:
                    p = [0.0] * 3
                    p[axis], p[others[0]], p[others[1]] = sign * (inner[axis] + radius), x, y
                    core = tuple(max(-inner[i], min(inner[i], p[i])) for i in range(3))
                    normal = unit(sub(p, core))
                    positions.append(add(core, mul(normal, radius)))
                    normals.append(normal)
                    uvs.append((p[along], p[across]))
            side = Mesh(positions, _grid_triangles(len(lines[0]), len(lines[1])), normals, uvs)
            outward = (sign > 0) == (axis != 1)  # (others, axis) is left-handed for y
            meshes.append(side if outward else rewound(side))
    return joined(meshes)


def wooden(size, radius, uv_offset=(0, 0), steps=2):
    """A board whose grain runs along its longest side; the wood's picture is 1.6 m long and 0.16 m high."""
    board = rounded_box(size, radius, steps)
    board.uvs = [(u / 1.6 + uv_offset[0], v / 0.16 + uv_offset[1]) for u, v in board.uvs]
    return board


# --- curved shapes ---


def _grid_triangles(columns, rows):
    """Triangles of a grid of vertices, row by row; they face columns × rows."""
    triangles = []
    for row in range(rows - 1):
        for column in range(columns - 1):
            a = row * columns + column
            b, c, d = a + 1, a + columns + 1, a + columns
            triangles += [(a, b, c), (a, c, d)]
    return triangles


def sheet(point, columns, rows):
    """The surface point(u, v), u and v in [0, 1], with smooth normals towards ∂u × ∂v."""
    steps = [(x / columns, y / rows) for y in range(rows + 1) for x in range(columns + 1)]
    return smooth(
        Mesh([point(u, v) for u, v in steps], _grid_triangles(columns + 1, rows + 1), None,
             [(u, 1 - v) for u, v in steps]))


def curve(points, steps):
    """A smooth line through `points`, `steps` pieces from one to the next. [Catmull-Rom]"""
    padded = [points[0], *points, points[-1]]
    line = []
    for a, b, c, d in zip(padded, padded[1:], padded[2:], padded[3:]):
        for i in range(steps):
            t = i / steps
            line.append(
                tuple(0.5 * (2 * q + (r - p) * t + (2 * p - 5 * q + 4 * r - s) * t * t +
                             (3 * q - p - 3 * r + s) * t ** 3) for p, q, r, s in zip(a, b, c, d)))
    return [*line, tuple(points[-1])]


def lathe(profile, sides):
    """The surface that `profile`, points (radius, y), sweeps about the y axis, with smooth normals.

    A profile that runs upwards faces outwards. A point on the axis becomes a single vertex.
    """
    positions, rings = [], []
    for radius, y in profile:
        pole = radius < 1e-9
        rings.append([len(positions)] *
                     (sides + 1) if pole else [len(positions) + i % sides for i in range(sides + 1)])
        for i in range(1 if pole else sides):
            angle = 2 * math.pi * i / sides
            positions.append((radius * math.cos(angle), y, -radius * math.sin(angle)))
    triangles = []
    for low, high in zip(rings, rings[1:]):
        for i in range(sides):
            a, b, c, d = low[i], low[i + 1], high[i + 1], high[i]
            triangles += [t for t in ((a, b, c), (a, c, d)) if len(set(t)) == 3]
    return smooth(Mesh(positions, triangles))


def ball(radius, sides, rows, shape=lambda p: p):
    """A sphere of latitudes and longitudes; `shape` may deform its points before the normals are taken."""
    angles = [math.pi * row / rows for row in range(rows + 1)]
    sphere = lathe([(radius * math.sin(a) if 0 < a < math.pi else 0.0, -radius * math.cos(a))
                    for a in angles], sides)
    return smooth(Mesh([shape(p) for p in sphere.positions], sphere.triangles))


def icosphere(level):
    """A unit sphere of 20 · 4^level nearly equal, flat triangles."""
    g = (1 + math.sqrt(5)) / 2
    positions = [
        unit(p) for p in ((-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g), (0, -1, -g),
                          (0, 1, -g), (g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1))
    ]
    triangles = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4),
                 (11, 10, 2), (10, 7, 6), (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9),
                 (4, 9, 5), (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1)]
    for _ in range(level):
        middles, finer = {}, []

        def middle(i, j):
            key = (min(i, j), max(i, j))
            if key not in middles:
                middles[key] = len(positions)
                positions.append(unit(add(positions[i], positions[j])))
            return middles[key]

        for a, b, c in triangles:
            ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
            finer += [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
        triangles = finer
    return Mesh(positions, triangles)


def tube(path, radius, sides):
    """A round tube along `path`; `radius` is a function of the fraction along it. The ends stay open."""
    side = unit(cross(sub(path[1], path[0]), (0.31, 0.17, 0.93)))
    positions = []
    for i, centre in enumerate(path):
        along = unit(sub(path[min(i + 1, len(path) - 1)], path[max(i - 1, 0)]))
        side = unit(sub(side, mul(along, dot(side, along))))  # carried along: no twist
        other = cross(along, side)
        for j in range(sides + 1):
            angle = 2 * math.pi * j / sides
            direction = add(mul(side, math.cos(angle)), mul(other, math.sin(angle)))
            positions.append(add(centre, mul(direction, radius(i / (len(path) - 1)))))
    return smooth(Mesh(positions, _grid_triangles(sides + 1, len(path))))


def torus(ring, thickness, sides, rows):
    """About the y axis: `ring` to the middle of the tube, `thickness` its radius."""
    angles = [2 * math.pi * row / rows for row in range(rows + 1)]
    return lathe([(ring + thickness * math.cos(a), thickness * math.sin(a)) for a in angles], sides)
