# SPDX-License-Identifier: Apache-2.0
"""Writes large glTF scenes quickly, with nothing but the standard library: floors of bumps, many of everything."""
import array
import json
import math
import pathlib
import struct
import zlib

FLOAT, UINT32 = 5126, 5125


class Large:
    """A binary glTF file whose buffer is made of arrays, not of lists."""

    def __init__(self):
        self.document = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": []}], "nodes": [], "meshes": [],
                         "materials": [], "accessors": [], "bufferViews": []}
        self.chunks, self.size = [], 0

    def view(self, data: bytes) -> int:
        self.document["bufferViews"].append({"buffer": 0, "byteOffset": self.size, "byteLength": len(data)})
        padding = bytes(-len(data) % 4)
        self.chunks += [data, padding]
        self.size += len(data) + len(padding)
        return len(self.document["bufferViews"]) - 1

    def accessor(self, values: array.array, component: int, kind: str, **bounds) -> int:
        count = len(values) // (3 if kind == "VEC3" else 2 if kind == "VEC2" else 1)
        self.document["accessors"].append({"bufferView": self.view(values.tobytes()), "componentType": component,
                                           "count": count, "type": kind, **bounds})
        return len(self.document["accessors"]) - 1

    def material(self, color=(0.7, 0.7, 0.7), emission=0.0, texture=None) -> int:
        surface = {"baseColorFactor": [*color, 1], "metallicFactor": 0, "roughnessFactor": 1}
        if texture is not None:
            surface["baseColorTexture"] = {"index": texture}
        self.document["materials"].append({"pbrMetallicRoughness": surface, "emissiveFactor": [emission] * 3})
        return len(self.document["materials"]) - 1

    def texture(self, png: bytes) -> int:
        images = self.document.setdefault("images", [])
        images.append({"bufferView": self.view(png), "mimeType": "image/png"})
        self.document.setdefault("textures", []).append({"source": len(images) - 1})
        return len(images) - 1

    def bumps(self, columns: int, rows: int, size: float, material: int, height=0.05, uv=False) -> int:
        """A floor of 2 * columns * rows triangles around the origin; returns the mesh."""
        xs = [size * (i / columns - 0.5) for i in range(columns + 1)]
        waves = [math.sin(37 * x / size) * height * size for x in xs]
        positions, indices = array.array("f"), array.array("I")
        for j in range(rows + 1):
            z = size * (j / rows - 0.5)
            wave = math.cos(31 * z / size)
            positions.extend([value for x, w in zip(xs, waves) for value in (x, w * wave, z)])
        width = columns + 1
        for first in range(0, rows * width, width):
            indices.extend([index for a in range(first, first + columns)
                            for index in (a, a + width, a + 1, a + 1, a + width, a + width + 1)])
        low = [-size / 2, -height * size, -size / 2]
        attributes = {"POSITION": self.accessor(positions, FLOAT, "VEC3", min=low, max=[-x for x in low])}
        if uv:
            coordinates = array.array("f", [value for j in range(rows + 1) for i in range(columns + 1)
                                            for value in (i / columns, j / rows)])
            attributes["TEXCOORD_0"] = self.accessor(coordinates, FLOAT, "VEC2")
        return self.mesh(attributes, self.accessor(indices, UINT32, "SCALAR"), material)

    def mesh(self, attributes: dict, indices: int, material: int) -> int:
        primitive = {"attributes": attributes, "indices": indices, "material": material}
        self.document["meshes"].append({"primitives": [primitive]})
        return len(self.document["meshes"]) - 1

    def place(self, mesh: int, at=(0, 0, 0)) -> None:
        self.document["scenes"][0]["nodes"].append(len(self.document["nodes"]))
        self.document["nodes"].append({"mesh": mesh, "translation": list(at)})

    def camera(self, height: float, distance: float) -> None:
        half = math.atan2(-height, distance) / 2
        self.document["cameras"] = [{"type": "perspective",
                                     "perspective": {"yfov": 0.9, "znear": 0.01, "aspectRatio": 1}}]
        self.document["scenes"][0]["nodes"].append(len(self.document["nodes"]))
        self.document["nodes"].append({"camera": 0, "translation": [0, height, distance],
                                       "rotation": [math.sin(half), 0, 0, math.cos(half)]})

    def write(self, path: pathlib.Path) -> pathlib.Path:
        self.document["buffers"] = [{"byteLength": self.size}]
        text = json.dumps({key: value for key, value in self.document.items() if value != []}).encode()
        text += b" " * (-len(text) % 4)
        with path.open("wb") as file:
            file.write(b"glTF" + struct.pack("<II", 2, 28 + len(text) + self.size))
            file.write(struct.pack("<I", len(text)) + b"JSON" + text + struct.pack("<I", self.size) + b"BIN\0")
            file.writelines(self.chunks)
        return path


def png(side: int, number: int) -> bytes:
    """A square picture of stripes, another for each number; RGB."""
    stripe = bytes((x * (number % 7 + 1) * (c + 1) + number) & 255 for x in range(side) for c in range(3))
    rows = b"".join(b"\0" + (stripe if y & 32 else stripe[::-1]) for y in range(side))

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", side, side, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows, 1)) + chunk(b"IEND", b"")


def grid(count: int, size: float):
    """Places for `count` things on a square of this size around the origin."""
    side = math.isqrt(count - 1) + 1
    for i in range(count):
        yield (size * ((i % side + 0.5) / side - 0.5), 0, size * ((i // side + 0.5) / side - 0.5))


def triangles(path: pathlib.Path, count: int) -> pathlib.Path:
    """One mesh."""
    scene = Large()
    side = math.isqrt(count // 2)
    scene.place(scene.bumps(side, count // 2 // side, 10, scene.material()))
    scene.camera(4, 8)
    return scene.write(path)


def instances(path: pathlib.Path, count: int, each: int) -> pathlib.Path:
    """`count` placements of one mesh of `each` triangles."""
    scene = Large()
    side = math.isqrt(each // 2)
    mesh = scene.bumps(side, side, 10 / math.sqrt(count), scene.material(), height=0.2)
    for at in grid(count, 10):
        scene.place(mesh, at)
    scene.camera(4, 8)
    return scene.write(path)


def materials(path: pathlib.Path, count: int) -> pathlib.Path:
    """As many meshes, each with a material of its own."""
    scene = Large()
    for i, at in enumerate(grid(count, 10)):
        color = [(i * k % 97 + 1) / 100 for k in (13, 29, 71)]
        scene.place(scene.bumps(8, 8, 10 / math.sqrt(count), scene.material(color), height=0.2), at)
    scene.camera(4, 8)
    return scene.write(path)


def textures(path: pathlib.Path, count: int, side: int) -> pathlib.Path:
    """As many meshes, each with a picture of its own."""
    scene = Large()
    for i, at in enumerate(grid(count, 10)):
        material = scene.material(texture=scene.texture(png(side, i)))
        scene.place(scene.bumps(4, 4, 10 / math.sqrt(count), material, uv=True), at)
    scene.camera(4, 8)
    return scene.write(path)


def lamps(path: pathlib.Path, count: int) -> pathlib.Path:
    """A floor under a wavy sheet of `count` triangles, every second square of which shines, each on its own."""
    scene = Large()
    scene.place(scene.bumps(64, 64, 10, scene.material()))
    side = math.isqrt(count // 2)
    mesh = scene.bumps(side, count // 2 // side, 10, scene.material(emission=0.2))
    scene.place(mesh, (0, 6, 0))
    scene.document["materials"][-1]["doubleSided"] = True
    scene.camera(3, 6)
    return scene.write(path)
