# SPDX-License-Identifier: CC0-1.0
"""What the scenes of scenes.py are made with: glTF as text, and painted pictures."""

import base64
import json
import math
import struct
import sys
import zlib
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scenes"))

from glb import FLOAT, ARRAY_BUFFER, LAYOUT, Glb, looking  # noqa: E402

LAYOUT[FLOAT, "VEC4"] = "<4f"
MIRRORED, CLAMPED, REPEATED = 33648, 33071, 10497


class Gltf(Glb):
    """A scene as text; materials take further members of glTF."""

    def __init__(self, eye=(0, 1.4, 4.2), target=(0, 0.7, 0), yfov=0.62):
        super().__init__("scenes.py")
        self.kept = {}
        self.document["asset"]["generator"] = "Relumine tests/pictures/scenes.py"
        if eye is not None:
            self.camera("camera", eye, target, yfov, 1.5)

    def save(self, folder, name):
        text = "data:application/octet-stream;base64," + base64.b64encode(bytes(self.binary)).decode()
        self.document["buffers"] = [{"byteLength": len(self.binary), "uri": text}]
        (folder / f"{name}.gltf").write_text(json.dumps(self.document, indent=1) + "\n")

    def _primitive(self, shape, material):
        """Every shape's numbers stand in the file once."""
        if id(shape) not in self.kept:
            self.kept[id(shape)] = (shape, super()._primitive(shape, material))  # the shape: ids stay taken
        kept = self.kept[id(shape)][1]
        return {**kept, "attributes": dict(kept["attributes"]), "material": material}

    def more(self, material, pbr=None, extensions=None, **members):
        """Adds members to a material; returns it."""
        target = self.document["materials"][material]
        target.update(members)
        target["pbrMetallicRoughness"].update(pbr or {})
        if extensions:
            target.setdefault("extensions", {}).update(extensions)
            self._use(*extensions)
        return material

    def picture(self, image, wrap=REPEATED, nearest=False):
        """A texture with a sampler of its own."""
        source = self._append("images", {"mimeType": "image/png", "bufferView": self._view(image)})
        kind = 9728 if nearest else 9729
        sampler = self._append("samplers", {"magFilter": kind, "minFilter": kind, "wrapS": wrap, "wrapT": wrap})
        return self._append("textures", {"source": source, "sampler": sampler})

    def light(self, kind, colour, position=(0, 0, 0), target=(0, 0, 0), **spot):
        """A light of KHR_lights_punctual that looks from its position at a target."""
        self._use("KHR_lights_punctual")
        lights = self.document.setdefault("extensions", {}).setdefault("KHR_lights_punctual",
                                                                       {"lights": []})["lights"]
        strength = max(colour)
        light = {"type": kind, "color": [c / strength for c in colour], "intensity": strength}
        if spot:
            light["spot"] = spot
        lights.append(light)
        self.node(kind, translation=position, rotation=looking(position, target),
                  extensions={"KHR_lights_punctual": {"light": len(lights) - 1}})

    def coloured(self, shape, colours, material):
        """A mesh with COLOR_0."""
        self.mesh("coloured", [(shape, material)])
        attribute = self._accessor(colours, FLOAT, "VEC4", ARRAY_BUFFER)
        self.document["meshes"][-1]["primitives"][0]["attributes"]["COLOR_0"] = attribute


def png(width, height, pixels):
    """An RGBA picture of 8 bits; stored, because versions of zlib pack differently."""
    rows = b"".join(b"\0" + bytes(v for p in pixels[y * width:(y + 1) * width] for v in p) for y in range(height))
    chunks = ((b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 6, 0, 0, 0)),
              (b"IDAT", zlib.compress(rows, 0)), (b"IEND", b""))
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(d)) + k + d + struct.pack(">I", zlib.crc32(k + d)) for k, d in chunks)


def painted(size, colour):
    return png(size, size, [colour((x + 0.5) / size, (y + 0.5) / size) for y in range(size) for x in range(size)])


def letter(u, v):
    """An F on a gradient: neither symmetric nor periodic."""
    if (0.2 < u < 0.35 and 0.1 < v < 0.9) or (0.2 < u < 0.8 and 0.1 < v < 0.25) or (0.2 < u < 0.6
                                                                                   and 0.45 < v < 0.6):
        return (220, 40, 30, 255)
    return (round(60 + 150 * u), round(200 - 120 * v), 120, 255)


def holes(u, v):
    """The letter's gradient with a round hole and a rim that fades."""
    radius = math.hypot(u - 0.5, v - 0.5)
    return (230, 190, 60, max(0, min(255, round(255 * (radius - 0.15) / 0.25))))


def bumps(u, v):
    """Normals that lean to +u on the left and to +v below: wrong signs show at once."""
    x = 0.55 if u < 0.5 else -0.1
    y = 0.45 if v > 0.5 else -0.2
    z = math.sqrt(1 - x * x - y * y)
    return tuple(round(127.5 * (c + 1)) for c in (x, y, z)) + (255, )


def rough_metal(u, v):
    """Roughness (green) grows to the right, metal (blue) stands in two bands."""
    return (0, round(60 + 190 * u), 255 if int(4 * v) % 2 else 0, 255)


def brushes(u, v):
    """The direction of more roughness (red, green) turns from left to right; less of it (blue) below."""
    angle = 2.4 * u
    return (round(127.5 * (math.cos(angle) + 1)), round(127.5 * (math.sin(angle) + 1)), round(255 - 160 * v), 255)
