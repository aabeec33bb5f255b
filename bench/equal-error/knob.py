#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Is `cache --error E` kept, and does the layer `error` know? A row of Markdown for each scene and E.

References are those of equal_error.py in its --out, two passes of them where there are none yet. Their own error is
part of the measured one and makes the coverage look worse than it is.
"""
import argparse
import pathlib
import sys

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "bench" / "common"))
import pictures  # noqa: E402  (after the path)
from command import Options, Relumine  # noqa: E402

import cells  # noqa: E402
from measure import log  # noqa: E402

SCENES = ["window", "still-life", "shadow", "blinds", "gloss", "foliage", "room"]
REFERENCE_RAYS = 4096  # per pixel and pass, as in equal_error.py


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--relumine", type=pathlib.Path, default=ROOT / "build" / "release" / "relumine")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "out" / "equal-error")
    parser.add_argument("--scenes", default=",".join(SCENES), help="separated by commas (default: %(default)s)")
    parser.add_argument("--errors", default="0.05,0.02,0.01,0.005", help="(default: %(default)s)")
    parser.add_argument("--size", default="128x128", help="(default: %(default)s)")
    parser.add_argument("--unbiased", action="store_true")
    parser.add_argument("--threads", type=int, default=1)
    return parser.parse_args()


def row(name: str, error: str, stats: dict, own: float) -> str:
    found = stats["reference"]
    covered = found["coverage"]
    return (f"| {name} | {error} | {found['relative_l1']:.2%} | {stats['predicted_error']:.2%} | {own:.2%} "
            f"| {covered['one_sigma']:.0%}, {covered['two_sigma']:.0%} | {stats['cpu_seconds']:.2f} |")


def main() -> None:
    args = arguments()
    width, height = map(int, args.size.split("x"))
    folder = args.out / "knob"
    folder.mkdir(parents=True, exist_ok=True)
    relumine = Relumine(args.relumine, folder)
    references = cells.references(relumine, args.out, REFERENCE_RAYS, 2, log)
    made, _, missing = cells.make_cells(args.out / "scenes", args.scenes.split(","), ROOT / "models" / "dragon.ply.gz", None)
    for text in missing:
        log(text)
    print("| scene | `--error` | relative L1 | predicted | the reference's own | within one, two sigma | CPU s |")
    print("|---|--:|--:|--:|--:|--:|--:|")
    for cell in made:
        view = cell.view(width, height, spp=1)
        reference = references.get(view)
        own = reference.error(np.ones((height, width), bool)).l1
        mean = folder / f"{cell.name}-{args.size}.pfm"
        pictures.write_pfm(mean, reference.picture)
        for error in args.errors.split(","):
            options: Options = {"method": "cache", "error": error, "aov": "error", "reference": str(mean)}
            if args.unbiased:
                options["unbiased"] = ""
            run = relumine.render(view, options, seed=1, threads=args.threads)
            print(row(cell.name, error, run.stats, own), flush=True)


if __name__ == "__main__":
    main()
