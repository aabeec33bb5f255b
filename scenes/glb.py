# SPDX-License-Identifier: CC0-1.0
"""Writes binary glTF 2.0 files, to the same bytes on every run, with nothing but the standard library.

A scene is a tree of nodes; a node carries at most a mesh, a camera or a light:

    glb = Glb("box")
    white = glb.material("white", base=(0.7, 0.7, 0.7), **MATTE)
    glb.mesh("floor", [(shapes.quad(...), white)])
    glb.camera("camera", eye=(0, 1, 4), target=(0, 1, 0), yfov=0.6, aspect=1)
    glb.write("box.glb")
"""

import json
import math
import struct
import sys
import zlib
from dataclasses import dataclass, field
from pathlib import Path

POSITION_DIGITS = 6  # decimals kept: micrometres, so that no libm's last bit can reach the file
MATTE = {"metallic": 0.0, "roughness": 1.0, "specular": 0.0}  # Lambert and nothing else

FLOAT, UINT16, UINT32 = 5126, 5123, 5125
ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER = 34962, 34963
LAYOUT = {(FLOAT, "VEC3"): "<3f", (FLOAT, "VEC2"): "<2f", (UINT16, "SCALAR"): "<H", (UINT32, "SCALAR"): "<I"}


@dataclass
class Mesh:
    """Indexed triangles, counter-clockwise seen from outside; without normals they are flat."""

    positions: list  # (x, y, z), metres
    triangles: list  # (i, j, k), into positions
    normals: list = None  # unit, one per position
    uvs: list = None  # one per position; v runs down the image


@dataclass
class Glb:
    name: str
    document: dict = field(default_factory=dict)
    binary: bytearray = field(default_factory=bytearray)

    def __post_init__(self):
        self.document = {
            "asset": {
                "version": "2.0",
                "generator": f"Relumine scenes/{self.name}",
                "copyright": "CC0 1.0"
            },
            "scene": 0,
            "scenes": [{
                "nodes": []
            }],
            "nodes": [],
        }

    def material(self,
                 name,
                 base=(1, 1, 1),
                 metallic=0.0,
                 roughness=1.0,
                 texture=None,
                 emission=None,
                 specular=None,
                 ior=None,
                 transmission=None,
                 thickness=None,
                 double_sided=False,
                 alpha_mode=None,
                 alpha=1.0):
        """Metallic-roughness; `emission` is radiance, one-sided unless `double_sided`; `alpha_mode` MASK or BLEND."""
        pbr = {"baseColorFactor": [*base, alpha], "metallicFactor": metallic, "roughnessFactor": roughness}
        if texture is not None:
            pbr["baseColorTexture"] = {"index": texture}
        material = {"name": name, "pbrMetallicRoughness": pbr, "doubleSided": double_sided}
        if alpha_mode is not None:
            material["alphaMode"] = alpha_mode
        extensions = {}
        if emission is not None:
            strength = max(emission)
            material["emissiveFactor"] = [value / strength for value in emission]
            extensions["KHR_materials_emissive_strength"] = {"emissiveStrength": strength}
        if specular is not None:
            extensions["KHR_materials_specular"] = {"specularFactor": specular}
        if ior is not None:
            extensions["KHR_materials_ior"] = {"ior": ior}
        if transmission is not None:
            extensions["KHR_materials_transmission"] = {"transmissionFactor": transmission}
        if thickness is not None:
            extensions["KHR_materials_volume"] = {"thicknessFactor": thickness}
        if extensions:
            material["extensions"] = extensions
            self._use(*extensions)
        return self._append("materials", material)

    def texture(self, name, image):
        """An embedded PNG, repeated both ways, bilinear; returns what `material(texture=…)` wants."""
        source = self._append("images", {
            "name": name,
            "mimeType": "image/png",
            "bufferView": self._view(image)
        })
        if "samplers" not in self.document:
            self._append("samplers", {"magFilter": 9729, "minFilter": 9729, "wrapS": 10497, "wrapT": 10497})
        return self._append("textures", {"name": name, "source": source, "sampler": 0})

    def mesh(self, name, parts, parent=None, **transform):
        """A node with one primitive for each (Mesh, material) of `parts`; `transform` as in `node`."""
        return self.node(name, parent, mesh=self.model(name, parts), **transform)

    def model(self, name, parts):
        """What several nodes may show: `node(…, mesh=model)`."""
        primitives = [self._primitive(shape, material) for shape, material in parts]
        return self._append("meshes", {"name": name, "primitives": primitives})

    def camera(self, name, eye, target, yfov, aspect, parent=None):
        """A perspective camera, upright; `yfov` in radians, `aspect` = width / height."""
        index = self._append(
            "cameras", {
                "name": name,
                "type": "perspective",
                "perspective": {
                    "yfov": _rounded(yfov),
                    "aspectRatio": aspect,
                    "znear": 0.01
                },
            })
        return self.node(name, parent, camera=index, translation=eye, rotation=looking(eye, target))

    def orthographic_camera(self, name, eye, target, half_side, parent=None):
        """Parallel rays through a square; upright."""
        index = self._append(
            "cameras", {
                "name": name,
                "type": "orthographic",
                "orthographic": {
                    "xmag": half_side,
                    "ymag": half_side,
                    "znear": 0.01,
                    "zfar": 1000.0
                },
            })
        return self.node(name, parent, camera=index, translation=eye, rotation=looking(eye, target))

    def point_light(self, name, position, intensity, parent=None):
        """`intensity` in W/sr per channel (Relumine takes KHR units as radiometric)."""
        return self._light(name, {"type": "point"}, intensity, parent, translation=position)

    def spot_light(self, name, position, target, intensity, half_angle, parent=None):
        """As `point_light`, within `half_angle` (radians) of the direction to `target`, with a hard edge."""
        spot = {"innerConeAngle": half_angle * 0.999, "outerConeAngle": half_angle}
        return self._light(name, {"type": "spot", "spot": spot}, intensity, parent, translation=position,
                           rotation=looking(position, target))

    def directional_light(self, name, towards, irradiance, parent=None):
        """Light that travels `towards`; `irradiance` on a plane across it."""
        return self._light(name, {"type": "directional"}, irradiance, parent,
                           rotation=looking((0, 0, 0), towards))

    def _light(self, name, kind, intensity, parent, **place):
        self._use("KHR_lights_punctual")
        lights = self.document.setdefault("extensions", {}).setdefault("KHR_lights_punctual",
                                                                       {"lights": []})["lights"]
        strength = max(intensity)
        lights.append({
            "name": name,
            **kind,
            "color": [value / strength for value in intensity],
            "intensity": strength
        })
        extension = {"KHR_lights_punctual": {"light": len(lights) - 1}}
        return self.node(name, parent, extensions=extension, **place)

    def node(self, name, parent=None, translation=None, rotation=None, scale=None, **content):
        """Adds a node under `parent` (None: the scene), returns its index; `rotation` is a quaternion x y z w."""
        node = {"name": name, **content}
        for key, value in (("translation", translation), ("rotation", rotation), ("scale", scale)):
            if value is not None:
                node[key] = [_rounded(x) for x in value]
        index = self._append("nodes", node)
        siblings = self.document["scenes"][0]["nodes"] if parent is None \
            else self.document["nodes"][parent].setdefault("children", [])
        siblings.append(index)
        return index

    def write(self, path):
        self.document["buffers"] = [{"byteLength": len(self.binary)}]
        text = json.dumps(self.document, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
        chunks += struct.pack("<II", len(self.binary), 0x004E4942) + self.binary
        with open(path, "wb") as file:
            file.write(struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks)

    def _primitive(self, shape, material):
        attributes = {"POSITION": self._accessor(shape.positions, FLOAT, "VEC3", ARRAY_BUFFER, bounds=True)}
        if shape.normals:
            attributes["NORMAL"] = self._accessor(shape.normals, FLOAT, "VEC3", ARRAY_BUFFER)
        if shape.uvs:
            attributes["TEXCOORD_0"] = self._accessor(shape.uvs, FLOAT, "VEC2", ARRAY_BUFFER)
        indices = [(index, ) for triangle in shape.triangles for index in triangle]
        width = UINT16 if len(shape.positions) < 0xFFFF else UINT32
        return {
            "attributes": attributes,
            "indices": self._accessor(indices, width, "SCALAR", ELEMENT_ARRAY_BUFFER),
            "material": material
        }

    def _accessor(self, rows, component, kind, target, bounds=False):
        layout = LAYOUT[component, kind]
        if component == FLOAT:
            rows = [tuple(_as_float32(x) for x in row) for row in rows]
        data = b"".join(struct.pack(layout, *row) for row in rows)
        accessor = {
            "bufferView": self._view(data, target),
            "componentType": component,
            "count": len(rows),
            "type": kind
        }
        if bounds:
            accessor["min"] = [min(column) for column in zip(*rows)]
            accessor["max"] = [max(column) for column in zip(*rows)]
        return self._append("accessors", accessor)

    def _view(self, data, target=None):
        self.binary.extend(b"\0" * (-len(self.binary) % 4))
        view = {"buffer": 0, "byteOffset": len(self.binary), "byteLength": len(data)}
        if target:
            view["target"] = target
        self.binary.extend(data)
        self.binary.extend(b"\0" * (-len(self.binary) % 4))
        return self._append("bufferViews", view)

    def _append(self, key, value):
        self.document.setdefault(key, []).append(value)
        return len(self.document[key]) - 1

    def _use(self, *extensions):
        used = self.document.setdefault("extensionsUsed", [])
        used.extend(name for name in extensions if name not in used)


def output_folder(default):
    """Where a scene script writes: its argument, or `default` beside the script itself."""
    return Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent / default


def about(axis, degrees):
    """The quaternion that turns by `degrees` about a unit `axis`."""
    half = math.radians(degrees) / 2
    return (*(math.sin(half) * x for x in axis), math.cos(half))


def looking(eye, target):
    """The rotation of a camera at `eye` that looks at `target`, upright: first pitch, then yaw."""
    x, y, z = (t - e for t, e in zip(target, eye))
    yaw, pitch = math.atan2(-x, -z) / 2, math.atan2(y, math.hypot(x, z)) / 2
    return (math.cos(yaw) * math.sin(pitch), math.sin(yaw) * math.cos(pitch),
            -math.sin(yaw) * math.sin(pitch), math.cos(yaw) * math.cos(pitch))


def png(width, height, pixels, palette):
    """A palette PNG; `pixels` index `palette`, (r, g, b) or (r, g, b, a) in 0..255, sRGB; row by row from the top."""
    rows = b"".join(b"\0" + bytes(pixels[y * width:(y + 1) * width]) for y in range(height))
    header = struct.pack(">IIBBBBB", width, height, 8, 3, 0, 0, 0)
    colours = bytes(value for colour in palette for value in colour[:3])
    alphas = bytes(colour[3] for colour in palette if len(colour) > 3)
    chunks = ((b"IHDR", header), (b"PLTE", colours), *([(b"tRNS", alphas)] if alphas else []),
              (b"IDAT", zlib.compress(rows, 9)), (b"IEND", b""))
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
        for kind, data in chunks)


def write_pfm(path, width, height, pixels):
    """A colour PFM; `pixels` are (r, g, b), row by row from the top (the file itself runs upwards)."""
    with open(path, "wb") as file:
        file.write(f"PF\n{width} {height}\n-1.0\n".encode())
        for y in reversed(range(height)):
            for pixel in pixels[y * width:(y + 1) * width]:
                file.write(struct.pack("<3f", *pixel))


def write_hdr(path, rows):
    """A Radiance picture (RGBE, run-length coded) of rows of (r, g, b) from the top; 8 to 32767 wide."""
    width = len(rows[0])
    with open(path, "wb") as file:
        file.write(f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {len(rows)} +X {width}\n".encode())
        for row in rows:
            file.write(struct.pack(">BBH", 2, 2, width))
            for channel in zip(*(_rgbe(pixel) for pixel in row)):
                file.write(_runs(channel))


def _rgbe(pixel):
    """The channels' mantissas and their common exponent."""
    if max(pixel) < 1e-32:
        return (0, 0, 0, 0)
    exponent = math.frexp(max(pixel))[1]
    return (*(min(255, int(math.ldexp(value, 8 - exponent))) for value in pixel), exponent + 128)


def _runs(values):
    """Bytes as runs (128 + length, value) and literals (length, values)."""
    coded, literal, start = bytearray(), bytearray(), 0

    def flush():
        for i in range(0, len(literal), 128):
            part = literal[i:i + 128]
            coded.extend((len(part), *part))
        literal.clear()

    while start < len(values):
        end = start
        while end < len(values) and end - start < 127 and values[end] == values[start]:
            end += 1
        if end - start > 2:
            flush()
            coded.extend((128 + end - start, values[start]))
        else:
            literal.extend(values[start:end])
        start = end
    flush()
    return bytes(coded)


def _rounded(x):
    return round(x, POSITION_DIGITS) + 0.0  # + 0.0 turns -0.0 into 0.0


def _as_float32(x):
    return struct.unpack("<f", struct.pack("<f", _rounded(x)))[0]
