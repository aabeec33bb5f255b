# SPDX-License-Identifier: Apache-2.0
"""Turns a .glb of the validation scenes into a Mitsuba 3 scene (variant llvm_ad_rgb).

What is read: the node hierarchy, triangle meshes, metallic-roughness factors with specularFactor 0, emissive
one-sided meshes, the first perspective camera. Textures, transmission and further lights are refused.
"""
import json
import struct

import drjit as dr
import mitsuba as mi
import numpy as np

COMPONENTS = {5120: "i1", 5121: "u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}


class Metal(mi.BSDF):
    """(1 - metallic) * base / pi + metallic * GGX with Schlick's F = base + (1 - base)(1 - w.h)^5, both sides.

    Separable Smith masking and visible normals are Mitsuba's own. One sample picks a lobe by `metallic`; its
    density is that of both lobes together, as is the one that light samples are weighed against.
    """

    def __init__(self, props):
        super().__init__(props)
        self.base = mi.Color3f(props["base_color"])
        self.metallic = float(props["metallic"])
        self.lobe = mi.MicrofacetDistribution(mi.MicrofacetType.GGX, float(props["alpha"]), True)
        lobes = mi.BSDFFlags.FrontSide | mi.BSDFFlags.BackSide
        self.m_components = [mi.BSDFFlags.GlossyReflection | lobes, mi.BSDFFlags.DiffuseReflection | lobes]
        self.m_flags = self.m_components[0] | self.m_components[1]

    def eval_pdf_upper(self, w_out, w_in):
        """f * cos and pdf of two directions above the surface."""
        cos_out, cos_in = w_out.z, w_in.z
        active = (cos_out > 0) & (cos_in > 0)
        h = dr.normalize(w_out + w_in)
        normal_density = self.lobe.eval(h)
        masking_out = self.lobe.smith_g1(w_out, h)
        f0 = self.base
        fresnel = f0 + (1 - f0) * (1 - dr.clip(dr.dot(w_in, h), 0, 1)) ** 5
        glossy = normal_density * masking_out / (4 * cos_out)  # also the density of visible normals, of w_in
        value = self.metallic * fresnel * glossy * self.lobe.smith_g1(w_in, h)
        pdf = self.metallic * glossy
        if self.metallic < 1:
            lambert = (1 - self.metallic) * dr.inv_pi * cos_in
            value += f0 * lambert
            pdf += lambert
        return dr.select(active, value, 0), dr.select(active, pdf, 0)

    def eval_pdf(self, ctx, si, wo, active=True):
        side = dr.sign(si.wi.z)
        return self.eval_pdf_upper(mi.Vector3f(si.wi.x, si.wi.y, si.wi.z * side),
                                   mi.Vector3f(wo.x, wo.y, wo.z * side))

    def eval(self, ctx, si, wo, active=True):
        return self.eval_pdf(ctx, si, wo, active)[0]

    def pdf(self, ctx, si, wo, active=True):
        return self.eval_pdf(ctx, si, wo, active)[1]

    def sample(self, ctx, si, sample1, sample2, active=True):
        side = dr.sign(si.wi.z)
        w_out = mi.Vector3f(si.wi.x, si.wi.y, si.wi.z * side)
        h, _ = self.lobe.sample(w_out, sample2)
        w_in = mi.reflect(w_out, h)
        if self.metallic < 1:
            w_in = dr.select(sample1 < self.metallic, w_in, mi.warp.square_to_cosine_hemisphere(sample2))
        value, pdf = self.eval_pdf_upper(w_out, w_in)
        active = mi.Bool(active) & (pdf > 0)
        bs = dr.zeros(mi.BSDFSample3f)
        bs.wo = mi.Vector3f(w_in.x, w_in.y, w_in.z * side)
        bs.pdf = pdf
        bs.eta = 1
        bs.sampled_type = mi.UInt32(int(mi.BSDFFlags.GlossyReflection))
        bs.sampled_component = mi.UInt32(0)
        return bs, dr.select(active, value / pdf, 0)

    def traverse(self, callback):
        pass

    def to_string(self):
        return f"Metal[metallic={self.metallic}]"


mi.register_bsdf("gltf_metal", lambda props: Metal(props))


class Glb:
    """A parsed .glb: `json` and `accessor(i)` as an array of rows."""

    def __init__(self, path):
        data = open(path, "rb").read()
        magic, _, total = struct.unpack_from("<4sII", data)
        if magic != b"glTF" or total > len(data):
            raise SystemExit(f"{path}: expected a whole .glb file")
        json_bytes, _ = struct.unpack_from("<II", data, 12)
        self.json = json.loads(data[20:20 + json_bytes])
        self.binary = data[20 + json_bytes + 8:]

    def accessor(self, index):
        a = self.json["accessors"][index]
        view = self.json["bufferViews"][a["bufferView"]]
        if "sparse" in a or "byteStride" in view:
            raise SystemExit(f"accessor {index}: expected tightly packed values, found sparse or strided ones")
        width = WIDTHS[a["type"]]
        start = view.get("byteOffset", 0) + a.get("byteOffset", 0)
        values = np.frombuffer(self.binary, COMPONENTS[a["componentType"]], a["count"] * width, start)
        return values.reshape(a["count"], width)


def node_matrix(node):
    if "matrix" in node:
        return np.array(node["matrix"], dtype=np.float64).reshape(4, 4).T
    x, y, z, w = node.get("rotation", (0, 0, 0, 1))
    m = np.eye(4)
    m[:3, :3] = [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                 [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                 [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]
    m[:3, :3] *= np.array(node.get("scale", (1, 1, 1)))
    m[:3, 3] = node.get("translation", (0, 0, 0))
    return m


def world_nodes(gltf):
    """Yields (node, world-from-node matrix) of the default scene."""
    stack = [(i, np.eye(4)) for i in gltf["scenes"][gltf.get("scene", 0)]["nodes"]]
    while stack:
        index, parent = stack.pop()
        node = gltf["nodes"][index]
        world = parent @ node_matrix(node)
        yield node, world
        stack += [(child, world) for child in node.get("children", ())]


def bsdf_of(material, model):
    pbr = material.get("pbrMetallicRoughness", {})
    if any("Texture" in key for key in (*material, *pbr)):
        raise SystemExit(f"material {material.get('name')}: expected no textures")
    if material.get("extensions", {}).get("KHR_materials_specular", {}).get("specularFactor", 1) != 0:
        raise SystemExit(f"material {material.get('name')}: expected KHR_materials_specular with specularFactor 0")
    base = [float(x) for x in pbr.get("baseColorFactor", (1, 1, 1, 1))[:3]]
    metallic, roughness = float(pbr.get("metallicFactor", 1)), float(pbr.get("roughnessFactor", 1))
    diffuse = {"type": "diffuse", "reflectance": {"type": "rgb", "value": base}}
    if metallic == 0:
        return {"type": "twosided", "bsdf": diffuse}
    if model == "python":
        return {"type": "gltf_metal", "base_color": mi.ScalarColor3f(base), "metallic": metallic,
                "alpha": roughness * roughness}
    metal = {"type": "principled", "base_color": {"type": "rgb", "value": base}, "metallic": 1.0,
             "roughness": roughness, "specular": 0.5}
    both = metal if metallic == 1 else {"type": "blendbsdf", "weight": metallic, "a": diffuse, "b": metal}
    return {"type": "twosided", "bsdf": both}


def emission_of(material):
    strength = material.get("extensions", {}).get("KHR_materials_emissive_strength", {}).get("emissiveStrength", 1)
    return [float(strength * x) for x in material.get("emissiveFactor", (0, 0, 0))]


def mesh_of(glb, primitive, world, bsdf, emission):
    """A mi.Mesh in world space; flat where the file has no normals."""
    if primitive.get("mode", 4) != 4:
        raise SystemExit("primitive: expected triangles")
    positions = glb.accessor(primitive["attributes"]["POSITION"]) @ world[:3, :3].T + world[:3, 3]
    triangles = glb.accessor(primitive["indices"]).reshape(-1, 3)
    if np.linalg.det(world[:3, :3]) < 0:
        triangles = triangles[:, ::-1]
    has_normals = "NORMAL" in primitive["attributes"]
    props = mi.Properties()
    props["bsdf"] = mi.load_dict(bsdf)
    props["face_normals"] = not has_normals
    if any(emission):
        props["emitter"] = mi.load_dict({"type": "area", "radiance": {"type": "rgb", "value": emission}})
    mesh = mi.Mesh("mesh", len(positions), len(triangles), has_vertex_normals=has_normals, props=props)
    params = mi.traverse(mesh)
    params["vertex_positions"] = mi.Float(positions.astype(np.float32).ravel())
    params["faces"] = mi.UInt32(triangles.astype(np.uint32).ravel())
    if has_normals:
        normals = glb.accessor(primitive["attributes"]["NORMAL"]) @ np.linalg.inv(world[:3, :3])
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
        params["vertex_normals"] = mi.Float(normals.astype(np.float32).ravel())
    params.update()
    return mesh


def sensor_of(camera, world, width, height, sampler):
    turned = world @ np.diag([-1.0, 1, -1, 1])  # Mitsuba looks along +z with +x to the left, glTF along -z
    return {"type": "perspective", "fov_axis": "y", "fov": float(np.degrees(camera["perspective"]["yfov"])),
            "near_clip": 1e-3, "far_clip": 1e4, "to_world": mi.ScalarTransform4f(turned),
            "film": {"type": "hdrfilm", "width": width, "height": height, "pixel_format": "rgb",
                     "component_format": "float32", "rfilter": {"type": "box"}},
            "sampler": {"type": sampler}}


def load(path, environment, width, height, sampler, model):
    """The scene; `model` of metal: "python" (Metal above) or "principled" (blended with diffuse)."""
    glb = Glb(path)
    materials = glb.json["materials"]
    scene = {"type": "scene"}
    for node, world in world_nodes(glb.json):
        if "camera" in node and "sensor" not in scene:
            scene["sensor"] = sensor_of(glb.json["cameras"][node["camera"]], world, width, height, sampler)
        if "mesh" not in node:
            continue
        for primitive in glb.json["meshes"][node["mesh"]]["primitives"]:
            material = materials[primitive["material"]]
            scene[f"shape{len(scene)}"] = mesh_of(glb, primitive, world, bsdf_of(material, model),
                                                 emission_of(material))
    if environment:  # u = atan2(z, x) / 2 pi + 1/2 is a quarter turn from Mitsuba's
        scene["environment"] = {"type": "envmap", "filename": str(environment),
                                "to_world": mi.ScalarTransform4f().rotate([0, 1, 0], 90)}
    return mi.load_dict(scene)
