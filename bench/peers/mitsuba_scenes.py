#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The same Mitsuba scenes, rendered by Mitsuba 3 and by relumine: block means in standard errors; see README.md."""
import argparse
import pathlib
import subprocess
import tempfile

import mitsuba as mi
import numpy as np

SIZE, BLOCK, MAX_DEPTH = 64, 16, 5

HEAD = f"""<scene version="3.0.0">
<integrator type="path"><integer name="max_depth" value="{MAX_DEPTH + 1}"/></integrator>
<sensor type="perspective"><float name="fov" value="45"/>
  <transform name="to_world"><lookat origin="1.5, 1.2, 5" target="0, 0.3, 0" up="0, 1, 0"/></transform>
  <sampler type="independent"/><film type="hdrfilm"><integer name="width" value="{SIZE}"/>
  <integer name="height" value="{SIZE}"/><rfilter type="box"/></film></sensor>
<shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-90"/><scale value="4"/>
  <translate y="-0.5"/></transform><bsdf type="twosided"><bsdf type="diffuse">
  <texture type="checkerboard" name="reflectance"><rgb name="color0" value=".7 .3 .2"/>
  <rgb name="color1" value=".2 .3 .6"/><transform name="to_uv"><scale x="5" y="3"/><translate x=".1" y=".3"/>
  </transform></texture></bsdf></bsdf></shape>
"""
LAMP = """<shape type="disk"><transform name="to_world"><rotate x="1" angle="90"/><scale value=".8"/>
  <translate x="1" y="3"/></transform><bsdf type="diffuse"/>
  <emitter type="area"><rgb name="radiance" value="12 10 8"/></emitter></shape>"""
SCENES = {
    "diffuse": HEAD + LAMP + """
<shape type="sphere"><point name="center" x="-.8" y=".2" z="0"/><float name="radius" value=".7"/>
  <bsdf type="plastic"><rgb name="diffuse_reflectance" value=".6 .2 .1"/></bsdf></shape>
<shape type="cube"><transform name="to_world"><scale value=".4"/><rotate y="1" angle="30"/>
  <translate x="1" y="-.1" z=".5"/></transform><bsdf type="twosided"><bsdf type="blendbsdf">
  <float name="weight" value=".3"/><bsdf type="diffuse"><rgb name="reflectance" value=".1 .7 .2"/></bsdf>
  <bsdf type="diffuse"><rgb name="reflectance" value=".8 .8 .1"/></bsdf></bsdf></bsdf></shape>
</scene>""",
    "metal": HEAD + """
<shape type="sphere"><point name="center" x="-.6" y=".2" z="0"/><float name="radius" value=".7"/>
  <bsdf type="roughconductor"><string name="distribution" value="ggx"/><float name="alpha" value=".3"/>
  <rgb name="specular_reflectance" value=".9 .7 .4"/></bsdf></shape>
<shape type="cylinder"><point name="p0" value="1 -.5 .3"/><point name="p1" value="1 .8 .1"/>
  <float name="radius" value=".3"/><bsdf type="twosided"><bsdf type="diffuse"/></bsdf></shape>
<emitter type="constant"><rgb name="radiance" value=".5 .6 .8"/></emitter>
<emitter type="point"><point name="position" value="2 3 2"/><rgb name="intensity" value="8 7 5"/></emitter>
<emitter type="directional"><vector name="direction" value="1 -2 -1"/><rgb name="irradiance" value=".8 .8 .5"/>
</emitter></scene>""",
    "glass": HEAD + """
<shape type="sphere"><point name="center" x="-.5" y=".2" z="0"/><float name="radius" value=".7"/>
  <bsdf type="dielectric"><float name="int_ior" value="1.5"/><float name="ext_ior" value="1"/></bsdf></shape>
<shape type="rectangle"><transform name="to_world"><scale x=".5" y=".7"/><rotate y="1" angle="20"/>
  <translate x="1.1" y=".2" z=".8"/></transform><bsdf type="thindielectric"/></shape>
<emitter type="envmap"><string name="filename" value="sky.exr"/><float name="scale" value="1.5"/>
  <transform name="to_world"><rotate y="1" angle="70"/></transform></emitter></scene>""",
}
SCENES["brushed"] = HEAD + LAMP + """
<shape type="sphere"><point name="center" x="-.8" y=".2" z="0"/><float name="radius" value=".7"/>
  <bsdf type="roughconductor"><string name="distribution" value="ggx"/><float name="alpha_u" value=".4"/>
  <float name="alpha_v" value=".1"/></bsdf></shape>
<shape type="disk"><transform name="to_world"><scale value=".6"/><rotate x="1" angle="-50"/>
  <translate x=".8" y=".1" z=".6"/></transform><bsdf type="twosided"><bsdf type="roughconductor"><string name="distribution" value="ggx"/>
  <float name="alpha_u" value=".08"/><float name="alpha_v" value=".5"/></bsdf></bsdf></shape>
<shape type="rectangle"><transform name="to_world"><scale value=".7"/><rotate z="1" angle="30"/>
  <translate x=".9" y=".6" z="-1"/></transform><bsdf type="twosided"><bsdf type="roughconductor"><string name="distribution" value="ggx"/>
  <float name="alpha_u" value=".05"/><float name="alpha_v" value=".3"/></bsdf></bsdf></shape>
<emitter type="constant"><rgb name="radiance" value=".5 .6 .8"/></emitter></scene>"""
SCENES["brushed-glass"] = HEAD + LAMP + """
<shape type="sphere"><point name="center" x="-.6" y=".2" z="0"/><float name="radius" value=".7"/>
  <bsdf type="roughdielectric"><string name="distribution" value="ggx"/><float name="alpha_u" value=".35"/>
  <float name="alpha_v" value=".1"/></bsdf></shape>
<emitter type="constant"><rgb name="radiance" value=".5 .6 .8"/></emitter></scene>"""
BALL = """<shape type="sphere"><point name="center" x="-.6" y=".2" z="0"/><float name="radius" value=".7"/>
  <bsdf type="roughdielectric"><string name="distribution" value="ggx"/><float name="alpha" value=".2"/></bsdf></shape>
<emitter type="constant"/><emitter type="spot"><transform name="to_world"><lookat origin="2, 4, 2" target="0, 0, 0"
  up="0, 1, 0"/></transform><float name="cutoff_angle" value="12"/><float name="beam_width" value="12"/>
  <rgb name="intensity" value="20 10 10"/></emitter></scene>"""
SCENES["orthographic"] = HEAD.replace('"perspective"', '"orthographic"').replace('<float name="fov" value="45"/>', "").replace(
    '<lookat', '<scale x="2" y="2"/><lookat') + BALL
SCENES["lens"] = HEAD.replace('"perspective"', '"thinlens"').replace(
    '<float name="fov" value="45"/>', '<float name="fov" value="45"/><float name="aperture_radius" value=".3"/>'
    '<float name="focus_distance" value="3"/>') + BALL
SCENES["shifted"] = HEAD.replace(
    '<float name="fov" value="45"/>', '<float name="fov" value="45"/><float name="principal_point_offset_x" value=".1"/>'
    '<float name="principal_point_offset_y" value="-.2"/>') + BALL


def write_sky(path):
    """Smooth, different in every direction."""
    v, u = np.meshgrid((np.arange(128) + 0.5) / 128, (np.arange(256) + 0.5) / 256, indexing="ij")
    sky = np.stack([0.6 + 0.5 * np.sin(2 * np.pi * u), 0.8 - 0.5 * v, 0.5 + 0.4 * np.cos(2 * np.pi * u) * np.sin(np.pi * v)], 2)
    mi.Bitmap(sky.astype(np.float32)).write(str(path))


def read_pfm(path):
    with open(path, "rb") as file:
        assert file.readline().strip() == b"PF"
        width, height = map(int, file.readline().split())
        order = "<f4" if float(file.readline()) < 0 else ">f4"
        return np.frombuffer(file.read(), order).reshape(height, width, 3)[::-1].astype(np.float64)


def blocks(picture):
    n = SIZE // BLOCK
    return picture.reshape(n, BLOCK, n, BLOCK, 3).mean((1, 3))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--relumine", default="build/release/relumine")
    parser.add_argument("--spp", type=int, default=64)
    parser.add_argument("--seeds", type=int, default=4)
    parser.add_argument("--limit", type=float, default=0.01, help="largest difference of a block, beside its noise")
    parser.add_argument("--only", default="", help="the scene of that name")
    parser.add_argument("--out", help="folder for the pictures of both, as PNG")
    args = parser.parse_args()
    mi.set_variant("scalar_rgb")
    failed = False
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        write_sky(folder / "sky.exr")
        for name, text in SCENES.items():
            if args.only not in ("", name):
                continue
            file = folder / f"{name}.xml"
            file.write_text(text)
            scene = mi.load_file(str(file))
            theirs, ours = [], []
            for seed in range(args.seeds):
                theirs.append(np.array(mi.render(scene, spp=args.spp, seed=seed), dtype=np.float64)[:, :, :3])
                subprocess.run([args.relumine, "render", str(file), "-o", str(folder / "out.pfm"), "--method", "path",
                                "--spp", str(args.spp), "--max-depth", str(MAX_DEPTH), "--seed", str(seed),
                                "--masking", "separable", "--quiet", "--no-progress"], check=True)
                ours.append(read_pfm(folder / "out.pfm"))
            a, b = (np.stack([blocks(p) for p in pictures]) for pictures in (ours, theirs))
            error = np.sqrt((a.var(0, ddof=1) + b.var(0, ddof=1)) / args.seeds)
            relative = np.abs(a.mean(0) - b.mean(0)) / (b.mean(0) + 0.01)
            excess = np.maximum(relative - 5 * error / (b.mean(0) + 0.01), 0)
            print(f"{name}: mean {a.mean() / b.mean():.4f} of Mitsuba's; blocks differ by {100 * relative.mean():.2f} % "
                  f"on average, {100 * relative.max():.2f} % at most, {100 * excess.max():.2f} % beside noise")
            failed |= bool(excess.max() > args.limit)
            if args.out:
                out = pathlib.Path(args.out)
                out.mkdir(parents=True, exist_ok=True)
                both = np.concatenate([np.mean(ours, 0), np.mean(theirs, 0)], 1).astype(np.float32)
                mi.util.write_bitmap(str(out / f"{name}.png"), both, write_async=False)
    raise SystemExit(1 if failed else 0)


if __name__ == "__main__":
    main()
