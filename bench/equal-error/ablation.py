#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What are the parts of `cache` worth? Scenes with one part after the other left out, as tables of Markdown.

References are those of equal_error.py in its --out, two passes of them where there are none yet; their own error is
part of the errors measured.
"""
import argparse
import dataclasses
import pathlib
import statistics
import sys

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "bench" / "common"))
import metrics  # noqa: E402  (after the path)
from command import Options, Relumine, View  # noqa: E402

import cells  # noqa: E402
from curves import Bound, geometric_mean  # noqa: E402
from measure import Lab, Plan, cost, log  # noqa: E402
from tables import number, percent, table  # noqa: E402

SCENES = ["shadow", "still-life", "window", "blinds", "gloss", "room"]
REFERENCE_RAYS = 4096  # per pixel and pass, as in equal_error.py

WHOLE = "all of it"
VARIANTS: dict[str, Options] = {  # what differs from WHOLE
    WHOLE: {},
    "maps from their own records alone": {"without": "reprojection"},
    "blocks never divided": {"without": "splits"},
    "one map per pixel, none blended": {"without": "blending"},
    "sharp lobes left to the maps": {"without": "sharp-lobes"},
    "as many rays for each pixel": {"residual-rays": 8, "light-samples": 16},
    "the same, four times as many": {"residual-rays": 32, "light-samples": 64},
    "no residual rays": {"residual-rays": 0},
    "no light samples": {"light-samples": 0},
    "what rays find is not filtered": {"filter-residual": "off"},
    "exact, nothing filtered": {"unbiased": ""},
    "`block-gather`": {"method": "block-gather"},
}


@dataclasses.dataclass(frozen=True)
class Outcome:
    """Of one scene and variant; the mean over the seeds, the median of the times."""
    seconds: float
    rays: float
    l1: float
    rms: float
    blocks: float  # L1 of 16 x 16-pixel means


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--relumine", type=pathlib.Path, default=ROOT / "build" / "release" / "relumine")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "out" / "equal-error")
    parser.add_argument("--scenes", default=",".join(SCENES), help="separated by commas (default: %(default)s)")
    parser.add_argument("--error", default="0.02", help="(default: %(default)s)")
    parser.add_argument("--size", default="128x128", help="(default: %(default)s)")
    parser.add_argument("--repeats", type=int, default=3, help="renders of each kind (default: %(default)s)")
    parser.add_argument("--threads", type=int, default=1)
    return parser.parse_args()


def options_of(variant: str, error: str) -> Options:
    return {"method": "cache", "error": error, **VARIANTS[variant]}


def measured(lab: Lab, view: View, options: Options, start_up: float, reference: np.ndarray, keep: np.ndarray) -> Outcome:
    runs = [lab.relumine.render(view, options, seed, lab.plan.threads) for seed in range(1, lab.plan.repeats + 1)]
    costs = [cost(run, start_up) for run in runs]
    error = metrics.average([metrics.errors(run.picture, reference, keep) for run in runs])
    return Outcome(statistics.median(c["cpu_seconds"] for c in costs), statistics.median(c["rays"] for c in costs),
                   error.l1, error.rms, statistics.fmean(metrics.block_error(run.picture, reference, keep) for run in runs))


def table_of_scene(name: str, own: float, outcomes: dict[str, Outcome]) -> list[str]:
    rows = [[variant, number(o.seconds), number(o.rays / 1e6), percent(o.l1), percent(o.rms), percent(o.blocks)]
            for variant, o in outcomes.items()]
    return table([f"{name} (reference: {percent(own)})", "CPU s", "M rays", "L1", "rms", "16 × 16 means"], rows)


def table_of_all(names: list[str], scenes: list[dict[str, Outcome]]) -> list[str]:
    """L1 and CPU seconds."""
    rows = [[variant, *(f"{percent(o[variant].l1)}, {number(o[variant].seconds)} s" for o in scenes)] for variant in VARIANTS]
    return table(["L1, CPU time", *names], rows)


def table_of_means(scenes: list[dict[str, Outcome]]) -> list[str]:
    """Geometric means over the scenes of what each variant has over the whole."""
    rows = [[variant, *(f"{mean_ratio(scenes, variant, field):.2f}" for field in ("seconds", "l1", "rms", "blocks"))]
            for variant in VARIANTS]
    return table(["against all of it", "CPU s", "L1", "rms", "16 × 16 means"], rows)


def mean_ratio(scenes: list[dict[str, Outcome]], variant: str, field: str) -> float:
    return geometric_mean(Bound(getattr(o[variant], field) / getattr(o[WHOLE], field)) for o in scenes).value


def main() -> None:
    args = arguments()
    width, height = map(int, args.size.split("x"))
    folder = args.out / "ablation"
    folder.mkdir(parents=True, exist_ok=True)
    made, white, missing = cells.make_cells(args.out / "scenes", args.scenes.split(","), ROOT / "models" / "dragon.ply.gz", None)
    for text in missing:
        log(text)
    relumine = Relumine(args.relumine, folder)
    references = cells.references(relumine, args.out, REFERENCE_RAYS, 2, log)
    lab = Lab(relumine, references, white, folder, Plan(width, height, 1, args.threads, args.repeats, [], False, 0, 0, 0, False))
    scenes = []
    for cell in made:
        view = cell.view(width, height, spp=1)
        reference, keep, start_up = references.get(view), relumine.surfaces(view, white), lab.start_up(view)
        scenes.append({})
        for variant in VARIANTS:
            log(f"{cell.name}: {variant}")
            scenes[-1][variant] = measured(lab, view, options_of(variant, args.error), start_up, reference.picture, keep)
        print("\n".join(table_of_scene(cell.name, reference.error(keep).l1, scenes[-1])), flush=True)
    print("\n".join(table_of_all([cell.name for cell in made], scenes) + table_of_means(scenes)))


if __name__ == "__main__":
    main()
