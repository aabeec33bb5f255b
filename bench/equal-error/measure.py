# SPDX-License-Identifier: Apache-2.0
"""Runs every method at its budgets on one scene and tells time, rays and errors. Returns plain data for JSON."""
import dataclasses
import pathlib
import statistics
import sys
from collections.abc import Callable

import numpy as np

import methods
import metrics
import pictures
from cells import Cell
from command import Failed, Options, Refused, Relumine, Run, View
from reference import Reference, References

LEAST_SECONDS = 1e-3  # below this a time is noise


def log(text: str) -> None:
    print(text, file=sys.stderr, flush=True)


@dataclasses.dataclass(frozen=True)
class Plan:
    """What is the same for all scenes."""
    width: int
    height: int
    spp: int
    threads: int
    repeats: int
    methods: list[str]
    quick: bool
    stop_at: float  # relative L1: a method that has reached it is not given more
    most_seconds: float  # of CPU time: nor one that has taken so many
    reference_ratio: float  # smallest error over the reference's own
    keep_pictures: bool


class Lab:
    def __init__(self, relumine: Relumine, references: References, white: pathlib.Path, folder: pathlib.Path, plan: Plan):
        self.relumine, self.references, self.white, self.folder, self.plan = relumine, references, white, folder, plan
        folder.mkdir(parents=True, exist_ok=True)

    def start_up(self, view: View) -> float:
        """CPU seconds of loading and building: a picture of 8 x 8 pixels without scattering, median of three."""
        tiny = dataclasses.replace(view, width=8, height=8)
        options: Options = {"method": "path", "max-depth": 0, "spp": 1}
        runs = [self.relumine.render(tiny, options, seed=0, threads=self.plan.threads) for _ in range(3)]
        return statistics.median(run.stats["cpu_seconds"] for run in runs)

    def picture_file(self, cell: Cell, key: str) -> pathlib.Path:
        return self.folder / f"{cell.name}-{key}.pfm"


def measure(lab: Lab, cell: Cell, state: dict, save: Callable[[], None]) -> None:
    """Fills `state`, whose runs of an earlier, interrupted attempt are used if their pictures are there."""
    plan, view = lab.plan, cell.view(lab.plan.width, lab.plan.height, lab.plan.spp)
    keep = lab.relumine.surfaces(view, lab.white)
    rough = lab.references.get(view)
    state.setdefault("about", cell.about)
    state.setdefault("start_up_seconds", lab.start_up(view))
    runs = state.setdefault("runs", {})
    state.setdefault("refused", {})
    state["failed"] = {}
    render_all(lab, cell, view, keep, rough, state, save)
    found = list(runs.values())
    if not found:
        return
    state["reference"] = judge(lab, cell, view, keep, found)
    state["surface_pixels"] = int(keep.sum())
    state["done"] = True
    save()
    if not plan.keep_pictures:
        for key in runs:
            lab.picture_file(cell, key).unlink(missing_ok=True)


def render_all(lab: Lab, cell: Cell, view: View, keep: np.ndarray, rough: Reference, state: dict,
               save: Callable[[], None]) -> None:
    """Methods take turns, cheap budgets first; one that has had enough or was refused drops out."""
    plan, runs = lab.plan, state["runs"]
    wanted = {name: options for name, options in methods.budgets(cell.path_depth, plan.spp, plan.quick).items()
              if name in plan.methods}
    active = set(wanted) - set(state["refused"])
    for turn in range(max(len(several) for several in wanted.values())):
        for name in wanted:
            if name not in active or turn >= len(wanted[name]):
                continue
            best, dearest = np.inf, 0.0
            for seed in range(1, plan.repeats + 1):
                key = f"{name}-{turn}-{seed}"
                file = lab.picture_file(cell, key)
                if key not in runs or not file.exists():
                    try:
                        run = lab.relumine.render(view, wanted[name][turn], seed=seed, threads=plan.threads)
                    except Refused as reason:
                        log(f"    skipped: {name}: {reason}")
                        state["refused"][name] = str(reason)
                        active.discard(name)
                        break
                    except Failed as reason:
                        log(f"    FAILED: {reason}")
                        state["failed"][f"{name} {methods.words(wanted[name][turn])}"] = str(reason).splitlines()[-1]
                        break
                    pictures.write_pfm(file, run.picture)
                    runs[key] = {"method": name, "turn": turn, "seed": seed, **cost(run, state["start_up_seconds"]),
                                 "options": methods.words(wanted[name][turn])}
                    save()
                runs[key]["rough"] = metrics.errors(pictures.read_pfm(file), rough.picture, keep).l1
                log(f"    {name} {runs[key]['options']}: {runs[key]['cpu_seconds']:.2f} CPU s, "
                    f"L1 about {runs[key]['rough']:.2%}")
                best, dearest = min(best, runs[key]["rough"]), max(dearest, runs[key]["cpu_seconds"])
            if best < plan.stop_at or dearest > plan.most_seconds:
                active.discard(name)


def cost(run: Run, start_up: float) -> dict:
    """CPU seconds beyond loading and building, and rays."""
    stats = run.stats
    return {"cpu_seconds": max(stats["cpu_seconds"] - start_up, LEAST_SECONDS), "wall_seconds": run.wall,
            "rays": stats["total_rays"], "rays_by_purpose": stats["rays"], "command": stats["command"]}


def judge(lab: Lab, cell: Cell, view: View, keep: np.ndarray, runs: list[dict]) -> dict:
    """Adds errors to the runs, against a reference good enough for the best of them; tells the reference's own."""
    reference = lab.references.get(view)
    while True:
        for key, run in ((f"{r['method']}-{r['turn']}-{r['seed']}", r) for r in runs):
            picture = pictures.read_pfm(lab.picture_file(cell, key))
            run["errors"] = {**dataclasses.asdict(metrics.errors(picture, reference.picture, keep)),
                             "blocks": metrics.block_error(picture, reference.picture, keep)}
        smallest = {name: min(run["errors"][name] for run in runs) for name in ("l1", "rms", "blocks")}
        goal = metrics.Errors(smallest["l1"] / lab.plan.reference_ratio, smallest["rms"] / lab.plan.reference_ratio,
                              0, 0)
        passes = reference.passes
        reference, reached = lab.references.refine(view, keep, goal)
        if reference.passes == passes:
            break  # else a better reference shows smaller errors, which may want a better one still
    own = reference.error(keep)
    a, b = (half / (reference.passes / 2) for half in reference.halves)
    return {"l1": own.l1, "rms": own.rms, "blocks": metrics.block_error(a, b, keep) / 2, "passes": reference.passes,
            "rays_per_pixel": lab.references.rays_per_pixel(reference) * lab.plan.spp, "reached": reached,
            "smallest": smallest}
