#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Is `cache --error E` kept, and does the layer `error` know? A row of Markdown for each scene and E.

References are the mean of two pictures by `gather`, kept in --out; what they differ by is their own error, which is
part of the measured one and makes the coverage look worse than it is.
"""
import argparse
import pathlib
import sys

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "bench" / "common"))
import metrics  # noqa: E402  (after the path)
import pictures  # noqa: E402
from command import Options, Relumine, View  # noqa: E402

import cells  # noqa: E402

SCENES = ["window", "still-life", "shadow", "blinds", "gloss", "foliage", "room"]
REFERENCE: Options = {"method": "gather", "sampler": "sobol", "gather-rays": 4096, "light-samples": 1024}
REFERENCE_SEEDS = (1_000_001, 1_000_002)


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--relumine", type=pathlib.Path, default=ROOT / "build" / "release" / "relumine")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "out" / "knob")
    parser.add_argument("--scenes", default=",".join(SCENES), help="separated by commas (default: %(default)s)")
    parser.add_argument("--errors", default="0.05,0.02,0.01,0.005", help="(default: %(default)s)")
    parser.add_argument("--size", default="128x128", help="(default: %(default)s)")
    parser.add_argument("--unbiased", action="store_true")
    parser.add_argument("--threads", type=int, default=1)
    return parser.parse_args()


def reference(relumine: Relumine, view: View, name: str, folder: pathlib.Path) -> tuple[pathlib.Path, float]:
    """A file with the mean of the two pictures, and its own relative L1 error."""
    halves = []
    for seed in REFERENCE_SEEDS:
        file = folder / f"{name}-{view.width}x{view.height}-{seed}.pfm"
        if not file.exists():
            print(f"{file.name}: rendering", file=sys.stderr, flush=True)
            pictures.write_pfm(file, relumine.render(view, REFERENCE, seed, threads=0).picture)
        halves.append(pictures.read_pfm(file))
    mean = folder / f"{name}-{view.width}x{view.height}.pfm"
    pictures.write_pfm(mean, (halves[0] + halves[1]) / 2)
    return mean, metrics.error_of_mean(*halves, np.ones((view.height, view.width), bool)).l1


def row(name: str, error: str, stats: dict, own: float) -> str:
    found = stats["reference"]
    covered = found["coverage"]
    return (f"| {name} | {error} | {found['relative_l1']:.2%} | {stats['predicted_error']:.2%} | {own:.2%} "
            f"| {covered['one_sigma']:.0%}, {covered['two_sigma']:.0%} | {stats['cpu_seconds']:.2f} |")


def main() -> None:
    args = arguments()
    width, height = map(int, args.size.split("x"))
    args.out.mkdir(parents=True, exist_ok=True)
    relumine = Relumine(args.relumine, args.out)
    made, _, missing = cells.make_cells(args.out, args.scenes.split(","), ROOT / "models" / "dragon.ply.gz", None)
    for text in missing:
        print(text, file=sys.stderr)
    print("| scene | `--error` | relative L1 | predicted | the reference's own | within one, two sigma | CPU s |")
    print("|---|--:|--:|--:|--:|--:|--:|")
    for cell in made:
        view = cell.view(width, height, spp=1)
        mean, own = reference(relumine, view, cell.name, args.out)
        for error in args.errors.split(","):
            options: Options = {"method": "cache", "error": error, "aov": "error", "reference": str(mean)}
            if args.unbiased:
                options["unbiased"] = ""
            run = relumine.render(view, options, seed=1, threads=args.threads)
            print(row(cell.name, error, run.stats, own), flush=True)


if __name__ == "__main__":
    main()
