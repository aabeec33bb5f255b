#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Renders scenes and holds them against the block means of an independent renderer; see README.md."""
import argparse
import json
import pathlib
import shlex
import subprocess
import sys
import tempfile


def run(command, accepted=(0,)):
    """stdout of a command; ends the program where its exit code is not among those accepted."""
    done = subprocess.run([str(word) for word in command], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    if done.returncode not in accepted:
        raise SystemExit(f"{shlex.join(done.args)}\n{done.stderr.strip()}\nexit code {done.returncode}")
    return done.stdout


def render(folder, picture, args):
    """Returns the seconds of CPU time that it took."""
    command = [args.relumine, "render", folder / f"{folder.name}.glb", "-o", picture, "--aov", "variance", "--quiet",
               "--stats", "-", "--size", args.size, "--spp", args.spp, "--sampler", args.sampler, "--seed", args.seed,
               "--max-depth", args.max_depth, "--masking", args.masking, "--threads", args.threads,
               "--method", args.method]
    if args.method == "gather":
        command += ["--gather-rays", args.gather_rays]
    environment = folder / "environment.exr"
    if environment.exists() and not args.own_rows:
        rows = picture.with_suffix(".pfm")
        run([args.resample, environment, rows])
        environment = rows
    if environment.exists():
        command += ["--environment", environment]
    return json.loads(run(command))["cpu_seconds"]


def compare(folder, picture, args):
    """The numbers of `relumine compare --json`. Exit code 1 is a verdict that we pass ourselves."""
    command = [args.relumine, "compare", picture, folder / "blocks-mean.pfm", "--reference-blocks", "--json",
               "--reference-se", folder / "blocks-se.pfm", "--sigmas", args.sigmas, "--relative", args.relative]
    if not (folder / "environment.exr").exists():  # else light comes from everywhere and no block is special
        command += ["--exclude-above", args.exclude_above]
    return json.loads(run(command, accepted=(0, 1)))


def validate(folder, args):
    with tempfile.TemporaryDirectory() as scratch:
        picture = pathlib.Path(scratch) / f"{folder.name}.exr"
        seconds = render(folder, picture, args)
        found = compare(folder, picture, args)
        if args.keep:
            args.keep.mkdir(parents=True, exist_ok=True)
            (args.keep / picture.name).write_bytes(picture.read_bytes())
    off = found["mean_ratio"] - 1
    passes = found["passes"] and abs(off) <= args.mean and found["non_finite_pixels"] == 0
    return {"scene": folder.name, "spp": args.spp, "cpu_seconds": seconds, "mean_off": off, "passes": passes, **{
        key: found[key] for key in ("included", "excluded", "failing", "worst_of_allowed", "worst_sigmas",
                                    "worst_column", "worst_row", "worst_channel", "mean_relative_difference",
                                    "non_finite_pixels")}}


def row(r):
    worst = f"{'RGB'[r['worst_channel']]} of {r['worst_column']},{r['worst_row']}"
    return (f"| {r['scene']} | {r['spp']} | {r['included']} | {r['failing']} | {r['worst_of_allowed']:.2f} ({worst}) "
            f"| {r['worst_sigmas']:.2f} | {100 * r['mean_relative_difference']:.3f} % | {100 * r['mean_off']:+.4f} % "
            f"| {'pass' if r['passes'] else '**FAIL**'} |")


def report(results, args):
    lines = [f"Limits: a block {args.sigmas:g} combined standard errors + {100 * args.relative:g} %, the mean "
             f"{100 * args.mean:g} %. Method {args.method}, sampler {args.sampler}, seed {args.seed}.", "",
             "| scene | spp | blocks | failing | worst, of its limit | its standard errors | blocks off by "
             "| mean off by | |", "|---|--:|--:|--:|--:|--:|--:|--:|---|", *map(row, results)]
    return "\n".join(lines) + "\n"


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__)
    add = parser.add_argument
    add("folder", type=pathlib.Path, help="holds NAME/NAME.glb, blocks-mean.pfm, blocks-se.pfm, environment.exr")
    add("--scene", action="append", help="NAME; may be repeated (default: all)")
    add("--relumine", default="build/release/relumine", help="the command (default: %(default)s)")
    add("--resample", default="build/release/bench/relumine_resample_environment",
        help="turns environments into what Mitsuba reads them as (default: %(default)s)")
    add("--own-rows", action="store_true", help="keep the environment as it is")
    add("--spp", type=int, default=256, help="samples per pixel (default: %(default)s)")
    add("--method", default="path", help="path or gather (default: %(default)s)")
    add("--gather-rays", type=int, default=64, help="for gather (default: %(default)s)")
    add("--sampler", default="auto", help="as of `relumine render` (default: %(default)s)")
    add("--masking", default="separable", help="as the reference's (default: %(default)s)")
    add("--size", default="512x512", help="as the reference's (default: %(default)s)")
    add("--max-depth", type=int, default=7, help="as the reference's (default: %(default)s)")
    add("--seed", type=int, default=1, help="(default: %(default)s)")
    add("--threads", type=int, default=0, help="0: all (default: %(default)s)")
    add("--sigmas", type=float, default=5.1, help="combined standard errors that a block may be off "
        "(default: %(default)s: a false alarm in about 1000 runs of 2048 blocks)")
    add("--relative", type=float, default=0.003, help="and in addition, of the reference (default: %(default)s)")
    add("--mean", type=float, default=0.0015, help="that the mean may be off, relative (default: %(default)s)")
    add("--exclude-above", type=float, default=3,
        help="radiance of blocks that show the light; they and their neighbours are left out, "
        "unless there is an environment (default: %(default)s)")
    add("--keep", type=pathlib.Path, help="folder for the pictures (default: they are dropped)")
    add("--json", type=pathlib.Path, help="also write the numbers here")
    return parser.parse_args()


def main():
    args = parse_arguments()
    names = args.scene or sorted(p.parent.name for p in args.folder.glob("*/blocks-mean.pfm"))
    if not names:
        raise SystemExit(f"{args.folder}: expected folders with blocks-mean.pfm, found none")
    results = [validate(args.folder / name, args) for name in names]
    if args.json:
        args.json.write_text(json.dumps(results, indent=2) + "\n")
    print(report(results, args), end="")
    return 0 if all(r["passes"] for r in results) else 1


if __name__ == "__main__":
    sys.exit(main())
