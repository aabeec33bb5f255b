#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Core-seconds for the same variance: relumine's `path` against Mitsuba 3's llvm_ad_rgb `path`; see README.md."""
import argparse
import itertools
import json
import os
import pathlib
import platform
import statistics
import subprocess
import sys
import tempfile
import time

import mitsuba as mi
import numpy as np

mi.set_variant("llvm_ad_rgb")
import drjit as dr  # noqa: E402  (after the variant)
import gltf_to_mitsuba  # noqa: E402

MEASURES = ("variance", "relative_variance")


def read_pfm(path):
    """height x width x 3, top row first."""
    with open(path, "rb") as file:
        kind = file.readline().strip()
        width, height = map(int, file.readline().split())
        order = "<f4" if float(file.readline()) < 0 else ">f4"
        if kind != b"PF":
            raise SystemExit(f"{path}: expected a colour PFM, found {kind!r}")
        return np.frombuffer(file.read(), order).reshape(height, width, 3)[::-1].astype(np.float64)


class Relumine:
    """The command; `render` returns the picture and its times in seconds, of the stage "render" alone."""

    def __init__(self, name, glb, environment, sampler, args):
        self.name, self.sampler = name, sampler
        self.file = pathlib.Path(args.scratch) / "relumine.pfm"
        self.command = [args.relumine, "render", str(glb), "-o", str(self.file), "--quiet", "--stats", "-",
                        "--method", "path",
                        "--size", f"{args.size}x{args.size}", "--spp", str(args.spp), "--sampler", sampler,
                        "--max-depth", str(args.max_depth), "--masking", "separable",
                        "--threads", str(args.threads)]
        self.command += ["--environment", str(environment)] if environment else []
        self.compile_seconds = 0.0

    def render(self, seed):
        run = subprocess.run([*self.command, "--seed", str(seed)], stdout=subprocess.PIPE, text=True, check=True)
        stats = json.loads(run.stdout)
        wall = stats["stage_seconds"]["render"]
        # The command tells the CPU time of all its stages; they share it by their wall-clock time.
        return read_pfm(self.file), {"wall": wall, "core": stats["cpu_seconds"] * wall / stats["total_seconds"]}


class Mitsuba:
    """The Python package in this process; the first render, which compiles the kernels, is not measured."""

    def __init__(self, name, glb, environment, sampler, args):
        self.name, self.sampler, self.spp = name, sampler, args.spp
        self.scene = gltf_to_mitsuba.load(glb, environment, args.size, args.size, sampler, args.bsdf)
        per_pass = {"samples_per_pass": 64} if args.spp > 64 and args.spp % 64 == 0 else {}  # bounds the memory
        self.integrator = mi.load_dict({"type": "path", "max_depth": args.max_depth + 1, **per_pass})
        times = [self.render(seed)[1]["wall"] for seed in (10**6, 10**6 + 1)]
        self.compile_seconds = max(0.0, times[0] - times[1])

    def render(self, seed):
        wall, core = time.perf_counter(), time.process_time()
        image = mi.render(self.scene, integrator=self.integrator, spp=self.spp, seed=seed)
        dr.eval(image)
        dr.sync_thread()
        times = {"wall": time.perf_counter() - wall, "core": time.process_time() - core}
        return np.array(image, dtype=np.float64), times


def included_pixels(folder, args):
    """False in blocks that show the light, and in their neighbours; these hold noise of edges, not of light."""
    keep = np.ones((args.size, args.size), bool)
    blocks_file = folder / "blocks-mean.pfm"
    if not blocks_file.exists() or (folder / "environment.exr").exists():
        return keep
    blocks = read_pfm(blocks_file).max(axis=2)
    bright = np.pad(blocks > args.exclude_above, 1)
    rows, columns = blocks.shape
    near = np.any([bright[dy:dy + rows, dx:dx + columns] for dy in range(3) for dx in range(3)], axis=0)
    if args.size % rows or args.size % columns:
        raise SystemExit(f"--size: expected a multiple of the {columns} x {rows} blocks, found {args.size}")
    return keep & ~np.kron(near, np.ones((args.size // rows, args.size // columns), bool))


def interleaved(renderers, seeds):
    """Every renderer once a round, each round in another order, so that other load hits all of them alike."""
    pictures, times = {r.name: [] for r in renderers}, {r.name: [] for r in renderers}
    for seed in range(seeds):
        for renderer in renderers[seed % len(renderers):] + renderers[:seed % len(renderers)]:
            picture, seconds = renderer.render(seed + 1)
            pictures[renderer.name].append(picture)
            times[renderer.name].append(seconds)
            print(f"  seed {seed + 1}: {renderer.name}: {seconds['core']:.2f} core-s, {seconds['wall']:.2f} s",
                  file=sys.stderr, flush=True)
    return pictures, times


def variances(pictures, keep, scale):
    """Mean over pixels and channels of the variance between seeds, plain and over mean^2 + 0.01."""
    variance = np.var(np.stack(pictures), axis=0, ddof=1)
    return {"variance": variance[keep].mean(), "relative_variance": (variance / scale)[keep].mean()}


def jackknife(values_without):
    """Standard error of a statistic from its values with one seed left out each."""
    n, mean = len(values_without), statistics.fmean(values_without)
    return float(np.sqrt((n - 1) / n * sum((v - mean) ** 2 for v in values_without)))


def ratio_for_same_noise(pictures, times, ours, theirs, measure, keep, scale):
    """core-seconds x variance, ours / theirs, and its standard error."""
    def cost(name, seeds):
        noise = variances([pictures[name][s] for s in seeds], keep, scale)[measure]
        return noise * statistics.fmean(times[name][s]["core"] for s in seeds)

    every = range(len(times[ours]))
    without = [[s for s in every if s != left_out] for left_out in every]
    return (cost(ours, every) / cost(theirs, every),
            jackknife([cost(ours, seeds) / cost(theirs, seeds) for seeds in without]))


def measured_renderer(renderer, pictures, times, keep, scale):
    return {"name": renderer.name, "sampler": renderer.sampler, "compile_seconds": renderer.compile_seconds,
            "wall_seconds": [t["wall"] for t in times], "core_seconds": [t["core"] for t in times],
            "mean": float(np.mean([p[keep].mean() for p in pictures])),
            **{key: float(value) for key, value in variances(pictures, keep, scale).items()}}


def compared(ours, theirs, pictures, times, keep, scale):
    pairs = [a["core"] / b["core"] for a, b in zip(times[ours], times[theirs])]
    result = {"ours": ours, "theirs": theirs, "time_ratio": statistics.median(pairs),
              "time_ratio_range": [min(pairs), max(pairs)]}
    for measure in MEASURES:
        noise = [variances(pictures[name], keep, scale)[measure] for name in (ours, theirs)]
        cost, error = ratio_for_same_noise(pictures, times, ours, theirs, measure, keep, scale)
        result[measure] = {"noise_ratio": float(noise[0] / noise[1]), "core_seconds_for_same_noise": float(cost),
                           "standard_error": error}
    return result


def measure_scene(folder, args):
    environment = folder / "environment.exr"
    inputs = (folder / f"{folder.name}.glb", environment if environment.exists() else None)
    keep = included_pixels(folder, args)
    dr.set_thread_count(max(2, os.cpu_count()))  # building a large scene with a single thread never ends in Dr.Jit 1.5
    print(f"{folder.name}: loading, compiling kernels", file=sys.stderr, flush=True)
    renderers = [Relumine(f"relumine {s}", *inputs, s, args) for s in args.samplers]
    peers = [Mitsuba(f"mitsuba {s}", *inputs, s, args) for s in args.peer_samplers]
    dr.set_thread_count(args.threads)
    pictures, times = interleaved(renderers + peers, args.seeds)
    mean = np.mean([p for name in pictures for p in pictures[name]], axis=0)
    scale = mean**2 + 0.01
    return {"scene": folder.name, "pixels_left_out": int((~keep).sum()),
            "renderers": [measured_renderer(r, pictures[r.name], times[r.name], keep, scale)
                          for r in renderers + peers],
            "comparisons": [compared(r.name, p.name, pictures, times, keep, scale)
                            for r, p in itertools.product(renderers, peers)]}


def renderer_rows(scenes):
    yield "| scene | renderer | core-s | wall s | variance | relative variance | mean | compile s |"
    yield "|---|---|--:|--:|--:|--:|--:|--:|"
    for scene, r in ((s["scene"], r) for s in scenes for r in s["renderers"]):
        yield (f"| {scene} | {r['name']} | {statistics.fmean(r['core_seconds']):.2f} "
               f"| {statistics.fmean(r['wall_seconds']):.2f} | {r['variance']:.4g} | {r['relative_variance']:.4g} "
               f"| {r['mean']:.5f} | {r['compile_seconds']:.1f} |")


def comparison_rows(scenes):
    yield "| scene | ours / theirs | core-s per render | variance | **core-s, same variance** " \
          "| relative variance | **core-s, same relative variance** |"
    yield "|---|---|--:|--:|--:|--:|--:|"
    for scene, c in ((s["scene"], c) for s in scenes for c in s["comparisons"]):
        low, high = c["time_ratio_range"]
        noise = [f"{c[m]['noise_ratio']:.3f} | **{c[m]['core_seconds_for_same_noise']:.2f}** ± "
                 f"{c[m]['standard_error']:.2f}" for m in MEASURES]
        yield (f"| {scene} | {c['ours']} / {c['theirs']} | {c['time_ratio']:.2f} ({low:.2f} … {high:.2f}) "
               f"| {noise[0]} | {noise[1]} |")


def cpu_model():
    try:
        lines = open("/proc/cpuinfo").read().splitlines()
        return next(line.split(":", 1)[1].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor() or "unknown"


def report(result):
    run = result["run"]
    lines = [f"Relumine {run['relumine']} against Mitsuba {run['mitsuba']}: {run['size']} x {run['size']} pixels, "
             f"{run['spp']} samples per pixel, {run['seeds']} seeds, {run['threads']} thread(s), "
             f"{run['max_depth']} scattering vertices; {run['cpu']}, load {run['load_before']:.1f} before.", "",
             *renderer_rows(result["scenes"]), "", *comparison_rows(result["scenes"])]
    return "\n".join(lines) + "\n"


def words(text):
    return [word for word in text.split(",") if word]


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=pathlib.Path,
                        help="holds NAME/NAME.glb, NAME/environment.exr, NAME/blocks-mean.pfm")
    parser.add_argument("--scene", action="append", help="NAME; may be repeated (default: all)")
    parser.add_argument("--relumine", default="build/release/relumine", help="the command (default: %(default)s)")
    parser.add_argument("--spp", type=int, default=64, help="samples per pixel (default: %(default)s)")
    parser.add_argument("--seeds", type=int, default=6, help="renders of each renderer, from 3 (default: %(default)s)")
    parser.add_argument("--threads", type=int, default=1, help="of each renderer (default: %(default)s)")
    parser.add_argument("--size", type=int, default=512, help="pixels a side (default: %(default)s)")
    parser.add_argument("--max-depth", type=int, default=7, help="scattering vertices (default: %(default)s)")
    parser.add_argument("--samplers", type=words, default=["sobol"], help="ours, with commas (default: sobol)")
    parser.add_argument("--peer-samplers", type=words, default=["independent", "multijitter"],
                        help="Mitsuba's, with commas (default: independent,multijitter)")
    parser.add_argument("--bsdf", choices=("python", "principled"), default="python",
                        help="metal in Mitsuba, see README.md")
    parser.add_argument("--exclude-above", type=float, default=3, help="radiance of blocks that show the light; "
                        "they and their neighbours are left out, unless there is an environment (default: %(default)s)")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("out/peers"),
                        help="folder (default: %(default)s)")
    args = parser.parse_args()
    if args.seeds < 3:
        parser.error(f"--seeds: expected at least 3, found {args.seeds}")
    return args


def main():
    args = parse_arguments()
    names = args.scene or sorted(p.parent.name for p in args.folder.glob("*/*.glb") if p.stem == p.parent.name)
    version = subprocess.run([args.relumine, "--version"], stdout=subprocess.PIPE, text=True, check=True).stdout
    run = {"relumine": version.split()[-1], "mitsuba": mi.__version__, "cpu": cpu_model(),
           "load_before": os.getloadavg()[0],
           **{key: getattr(args, key) for key in ("size", "spp", "seeds", "threads", "max_depth", "bsdf")}}
    with tempfile.TemporaryDirectory() as args.scratch:
        result = {"run": run, "scenes": [measure_scene(args.folder / name, args) for name in names]}
    args.out.mkdir(parents=True, exist_ok=True)
    (args.out / "against_mitsuba.json").write_text(json.dumps(result, indent=2) + "\n")
    (args.out / "against_mitsuba.md").write_text(report(result))
    print(report(result), end="")


if __name__ == "__main__":
    main()
