# SPDX-License-Identifier: Apache-2.0
"""The measurements: errors and times, thread scaling, sweeps, convergence. Every one returns plain data for JSON."""
import dataclasses
import pathlib
import random
import statistics
import sys

import numpy as np

import metrics
import pictures
from command import Options, Refused, Relumine, Run, View, looked_up, scaled_sum
from make_scenes import Scene
from reference import Reference, References

N = 64  # the paper's: 64 x 64 rays
PARAMETERS: Options = {"record-size": N, "record-layers": 16, "gap-cell": 4, "record-spacing": 1,
                       "records-per-point": 3}


def methods_of(n: int) -> dict[str, Options]:
    """All methods with n x n rays."""
    gather: Options = {"method": "gather", "gather-rays": n * n}
    cache: Options = {**PARAMETERS, "record-size": n}
    return {
        "gather-single": {**gather, "gather-packets": "off"},
        "gather": gather,
        "reproject": {"method": "reproject", **cache},
        "reproject-mc": {"method": "reproject-mc", **cache, "gather-rays": n * n, "bsdf-share": 0.1},
        "reproject-mc-0": {"method": "reproject-mc", **cache, "gather-rays": n * n, "bsdf-share": 0},
    }


METHODS = methods_of(N)
DEFAULT_METHODS = ("gather-single", "gather", "reproject", "reproject-mc")
BASELINE = "gather"  # with packets: what the others are compared with
SWEEPS: dict[str, tuple[float, ...]] = {
    "record-size": (16, 32, 64, 128),
    "record-layers": (2, 4, 8, 16, 32),
    "gap-cell": (1, 2, 4, 8),
    "record-spacing": (0.25, 0.5, 1, 2, 4),
    "records-per-point": (1, 2, 3, 4),
}
CONVERGENCE = ({"record-spacing": 4, "record-size": 32}, {"record-spacing": 1, "record-size": 64},
               {"record-spacing": 0.25, "record-size": 128})  # each step: a quarter of the spacing, twice the n
STAGES = ("create", "lookup", "reproject", "shade", "gaps", "product")  # of cache.cpu_seconds


@dataclasses.dataclass(frozen=True)
class Cell:
    """A scene under an environment."""
    scene: Scene
    environment: str
    file: pathlib.Path

    @property
    def name(self) -> str:
        return f"{self.scene.name}, {self.environment}"

    def view(self, size: int, bands: tuple[tuple[int, int], ...] = ()) -> View:
        return View(self.scene.file, self.file, self.scene.env_rotate, size, size, bands=bands)


BAND_ROWS = 4


def bands_of(size: int, count: int) -> tuple[tuple[int, int], ...]:
    """`count` bands of BAND_ROWS rows, one at a place drawn within each of as many equal parts of the picture."""
    draw = random.Random(512)
    parts = [(i * size // count, (i + 1) * size // count) for i in range(count)]
    firsts = [draw.randrange(first, last - BAND_ROWS + 1) for first, last in parts]
    return tuple((first, first + BAND_ROWS) for first in firsts)


def log(text: str) -> None:
    print(text, file=sys.stderr, flush=True)


class Lab:
    """What all measurements share; remembers what the command refused, so that it is asked once."""

    def __init__(self, relumine: Relumine, references: References, white: pathlib.Path, threads: int,
                 reference_ratio: float, kept_pictures: pathlib.Path):
        self.relumine, self.references, self.white = relumine, references, white
        self.threads, self.reference_ratio, self.kept_pictures = threads, reference_ratio, kept_pictures
        self.refused: dict[str, str] = {}
        kept_pictures.mkdir(parents=True, exist_ok=True)

    def missing(self, name: str, options: Options, cell: Cell) -> str | None:
        """Why the command cannot do this, or None; tried on a tiny picture."""
        if name not in self.refused:
            try:
                self.relumine.render(cell.view(8), options, seed=0, threads=1)
                self.refused[name] = ""
            except Refused as reason:
                log(f"skipped: {name}: {reason}")
                self.refused[name] = str(reason)
        return self.refused[name] or None

    def surfaces(self, view: View) -> np.ndarray:
        return self.relumine.surfaces(view.whole(), self.white)[view.rows()]

    def converged(self, view: View, keep: np.ndarray, smallest: metrics.Errors) -> tuple[Reference, dict]:
        """A reference whose own error is below `smallest` / reference_ratio, if the passes allowed suffice."""
        goal = metrics.Errors(*(value / self.reference_ratio for value in dataclasses.astuple(smallest)))
        reference, reached = self.references.refine(view, keep, goal)
        own = reference.error(keep)
        if not reached:
            log(f"    reference: L1 {own.l1:.3%}, rms {own.rms:.3%} after all {reference.passes} passes allowed; "
                f"wanted {goal.l1:.3%}, {goal.rms:.3%}")
        return reference, {"l1": own.l1, "rms": own.rms, "passes": reference.passes, "reached": reached,
                           "rays_per_pixel": self.references.rays_per_pixel(reference)}

    def measured(self, view: View, runs: dict[str, list[Run]]) -> tuple[dict, dict]:
        """Errors of all runs against a reference that is good enough for the best of them; and the reference's own."""
        keep = self.surfaces(view)
        reference = self.references.get(view)
        for _ in range(3):  # a better reference shows smaller errors, which may want a better one still
            found = {name: metrics.average([metrics.errors(run.picture, reference.picture, keep) for run in several])
                     for name, several in runs.items()}
            smallest = metrics.Errors(l1=min(e.l1 for e in found.values()), rms=min(e.rms for e in found.values()),
                                      signed=0, maximum=0)
            passes = reference.passes
            reference, about = self.converged(view, keep, smallest)
            if reference.passes == passes:
                break
        about["surface_pixels"] = int(keep.sum())
        every = {name: [metrics.errors(run.picture, reference.picture, keep) for run in several]
                 for name, several in runs.items()}
        return {name: over_seeds(several) for name, several in every.items()}, about


def over_seeds(every: list[metrics.Errors]) -> dict:
    """Means, and how much one seed differs from the next where there are several."""
    spread = metrics.spread(every)
    return {**dataclasses.asdict(metrics.average(every)), **({"spread": dataclasses.asdict(spread)} if spread else {})}


def median(values: list[float]) -> float:
    return float(statistics.median(values))


def costs(runs: list[Run]) -> dict:
    """Medians over the repeats; seconds, counts, bytes."""
    stats = runs[0].stats
    result = {
        "cpu_seconds": median([run.cpu for run in runs]),
        "cpu_seconds_range": [min(run.cpu for run in runs), max(run.cpu for run in runs)],
        "render_cpu_seconds": median([run.stats["cpu_seconds"] for run in runs]),
        "process_cpu_seconds": median([run.process_cpu for run in runs]),
        "wall_seconds": median([run.wall for run in runs]),
        "rays": stats["rays"], "peak_memory_bytes": stats["peak_memory_bytes"], "command": stats["command"],
    }
    counts = ("records", "surfels", "record_bytes", "points", "reprojections", "gap_rays")
    cache = {key: looked_up(stats, f"cache.{key}") for key in counts}
    if cache["records"] is None:
        return result
    for stage in STAGES:
        seconds = [looked_up(run.stats, f"cache.cpu_seconds.{stage}") for run in runs]
        cache[f"{stage}_cpu_seconds"] = None if None in seconds else median(seconds)
    cache["surfels_per_record"] = ratio(cache["surfels"], cache["records"])
    cache["bytes_per_record"] = ratio(cache["record_bytes"], cache["records"])
    parts = [cache["reproject_cpu_seconds"], cache["shade_cpu_seconds"]]
    cache["reprojection_us_per_point"] = None if None in parts else ratio(1e6 * sum(parts), cache["points"])
    return {**result, "cache": cache}


def ratio(a: float | None, b: float | None) -> float | None:
    return a / b if a is not None and b else None


# --- errors and times ---


def measure_methods(lab: Lab, cell: Cell, methods: dict[str, Options], view: View, repeats: int) -> dict:
    """Every method once a repeat, in another order and with another seed each time.

    Where the view has bands, errors are theirs, and only `reproject` is rendered as a whole (see `render_once`).
    """
    size = view.height
    skipped = {name: lab.missing(name, options, cell) for name, options in methods.items()}
    present = [name for name in methods if not skipped[name]]
    if not present:
        raise SystemExit("none of the methods is there: " + "; ".join(str(reason) for reason in skipped.values()))
    runs: dict[str, list[Run]] = {name: [] for name in present}
    for repeat in range(repeats):
        turn = repeat % len(present)
        for name in present[turn:] + present[:turn]:
            run = render_once(lab, view, methods[name], repeat + 1)
            runs[name].append(run)
            log(f"    {name}, repeat {repeat + 1}: {run.cpu:.2f} CPU seconds")
    if view.bands:
        take_whole_times(runs)
        keep_whole_pictures(lab, cell, runs)
        runs = {name: [in_bands(run, view) for run in several] for name, several in runs.items()}
    errors, reference = lab.measured(view, runs)
    keep_pictures(lab, cell, view, runs)
    found = {name: {"errors": errors[name], **costs(runs[name])} for name in present}
    add_speed_ups(found)
    found.update({name: {"skipped": reason} for name, reason in skipped.items() if reason})
    return {"scene": cell.scene.name, "environment": cell.environment, "size": size, "repeats": repeats,
            "model": cell.scene.model, "env_rotate": cell.scene.env_rotate, "reference": reference,
            "methods": {name: found[name] for name in methods}}


def render_once(lab: Lab, view: View, options: Options, seed: int) -> Run:
    """The whole picture of `reproject`, whose records serve all of it; of other methods what the view shows."""
    seen = view.whole() if options["method"] == "reproject" else view
    return lab.relumine.render(seen, options, seed=seed, threads=lab.threads)


def take_whole_times(runs: dict[str, list[Run]]) -> None:
    """Bands of `reproject-mc` make records for nearly all of the picture each time: its time is that of `reproject`,
    which makes the same, and of its own rays."""
    for name in (name for name in runs if name.startswith("reproject-mc")):
        if "reproject" not in runs:
            raise SystemExit(f"--bands: {name} takes times of reproject, which --methods does not name")
        runs[name] = [dataclasses.replace(with_rays(whole, run), picture=run.picture)
                      for run, whole in zip(runs[name], runs["reproject"])]


def with_rays(whole: Run, mc: Run) -> Run:
    """`reproject` with the product rays of `reproject-mc` on top."""
    seconds = mc.stats["cache"]["cpu_seconds"]["product"]
    times = scaled_sum([{key: whole.stats[key] for key in ("cpu_seconds", "total_seconds", "stage_seconds")}],
                       1 + seconds / whole.cpu)
    cache = {**whole.stats["cache"],
             "cpu_seconds": {**whole.stats["cache"]["cpu_seconds"], "product": seconds}}
    stats = {**whole.stats, **times, "cache": cache, "command": mc.stats["command"]}
    return dataclasses.replace(whole, stats=stats, process_cpu=whole.process_cpu + seconds)


def in_bands(run: Run, view: View) -> Run:
    whole = run.picture.shape[0] == view.height
    return dataclasses.replace(run, picture=run.picture[view.rows()]) if whole else run


def keep_whole_pictures(lab: Lab, cell: Cell, runs: dict[str, list[Run]]) -> None:
    for name in (name for name in runs if name == "reproject"):
        file = lab.kept_pictures / f"{cell.scene.name}-{cell.environment}-{name}-whole.pfm"
        pictures.write_pfm(file, runs[name][0].picture)


def keep_pictures(lab: Lab, cell: Cell, view: View, runs: dict[str, list[Run]]) -> None:
    """For the picture sheet: the first repeat of each method, the reference, and where surfaces are."""
    base = f"{cell.scene.name}-{cell.environment}"
    everything = {name: several[0].picture for name, several in runs.items()}
    everything["reference"] = lab.references.get(view).picture
    everything["surfaces"] = np.repeat(lab.surfaces(view)[:, :, None].astype(float), 3, axis=2)
    for name, picture in everything.items():
        pictures.write_pfm(lab.kept_pictures / f"{base}-{name}.pfm", picture)


def add_speed_ups(found: dict) -> None:
    """Against `gather` with packets, and, as the paper has it, against single rays."""
    for name, one in found.items():
        for baseline in (BASELINE, "gather-single"):
            if baseline not in found or baseline == name:
                continue
            base = found[baseline]
            seconds = base["cpu_seconds"], one["cpu_seconds"]
            one.setdefault("speed_up", {})[baseline] = {
                "raw": metrics.raw_speed_up(*seconds),
                "equal_l1": metrics.equal_error_speed_up(*seconds, base["errors"]["l1"], one["errors"]["l1"]),
                "equal_rms": metrics.equal_error_speed_up(*seconds, base["errors"]["rms"], one["errors"]["rms"]),
                "table2": metrics.squared_error_ratio(base["errors"]["l1"], one["errors"]["l1"]),
            }


# --- thread scaling ---


def measure_scaling(lab: Lab, cell: Cell, methods: dict[str, Options], method_seconds: float, gather_seconds: float,
                    size: int, repeats: int) -> dict:
    """One thread against two, of the cache in both scopes and of `gather` with so few rays that it takes as long."""
    rays = metrics.control_rays(method_seconds, gather_seconds, int(methods["gather"]["gather-rays"]))
    contenders: dict[str, Options] = {"control": {"method": "gather", "gather-rays": rays}}
    for scope in ("image", "tile"):
        options = {**methods["reproject"], "cache-scope": scope}
        if not lab.missing(f"reproject, --cache-scope {scope}", options, cell):
            contenders[f"reproject, {scope}"] = options
    turns = [(name, threads) for name in contenders for threads in (1, 2)]
    times: dict[tuple[str, int], list[float]] = {turn: [] for turn in turns}
    for repeat in range(repeats):
        first = repeat % len(turns)
        for name, threads in turns[first:] + turns[:first]:
            run = lab.relumine.render(cell.view(size), contenders[name], seed=repeat + 1, threads=threads)
            times[name, threads].append(run.wall)
            log(f"    {name}, {threads} threads, repeat {repeat + 1}: {run.wall:.2f} s")
    rows = {}
    for name in contenders:
        every = [one / two for one, two in zip(times[name, 1], times[name, 2])]
        rows[name] = {"wall_1": median(times[name, 1]), "wall_2": median(times[name, 2]), "scaling": median(every),
                      "scaling_range": [min(every), max(every)]}
    for row in rows.values():
        row["of_control"] = row["scaling"] / rows["control"]["scaling"]
    return {"scene": cell.scene.name, "environment": cell.environment, "size": size, "repeats": repeats,
            "control_gather_rays": rays, "rows": rows}


# --- sweeps ---


def measure_sweeps(lab: Lab, cell: Cell, size: int, quick: bool) -> dict:
    """`reproject` with one parameter at a time changed; `quick`: only the ends of each range and the default."""
    if reason := lab.missing("reproject", METHODS["reproject"], cell):
        return {"scene": cell.scene.name, "environment": cell.environment, "size": size, "skipped": reason}
    wanted: dict[tuple[str, float], Options] = {}
    for parameter, values in SWEEPS.items():
        for value in {values[0], values[-1], PARAMETERS[parameter]} if quick else values:
            wanted[parameter, value] = {**METHODS["reproject"], parameter: value}
    rows = measure_settings(lab, cell, size, {f"{p} {v:g}": options for (p, v), options in wanted.items()})
    points = [{"parameter": p, "value": v, **rows[f"{p} {v:g}"]} for p, v in sorted(wanted)]
    return {"scene": cell.scene.name, "environment": cell.environment, "size": size, "points": points,
            "reference": rows["reference"]}


def measure_convergence(lab: Lab, cell: Cell, size: int) -> dict:
    """`reproject` with a quarter of the spacing and twice the n, twice."""
    if reason := lab.missing("reproject", METHODS["reproject"], cell):
        return {"scene": cell.scene.name, "environment": cell.environment, "size": size, "skipped": reason}
    settings = {f"step {i}": {**METHODS["reproject"], **change} for i, change in enumerate(CONVERGENCE)}
    rows = measure_settings(lab, cell, size, settings)
    steps = [{**change, **rows[f"step {i}"]} for i, change in enumerate(CONVERGENCE) if f"step {i}" in rows]
    by_size = {step["record-size"]: step["errors"] for step in steps if "errors" in step}
    ratios = {measure: by_size[128][measure] / by_size[64][measure] for measure in ("l1", "rms")
              if 64 in by_size and 128 in by_size}
    return {"scene": cell.scene.name, "environment": cell.environment, "size": size, "steps": steps,
            "error_ratio": ratios, "reference": rows["reference"]}


def measure_settings(lab: Lab, cell: Cell, size: int, settings: dict[str, Options]) -> dict[str, dict]:
    """One run each; settings that the command refuses are told and left as {"skipped": reason}."""
    runs: dict[str, list[Run]] = {}
    rows: dict[str, dict] = {}
    done: dict[str, str] = {}  # the same settings under another name are not rendered again
    for name, options in settings.items():
        key = repr(sorted(options.items()))
        if key in done:
            runs[name] = runs[done[key]]
            continue
        try:
            runs[name] = [lab.relumine.render(cell.view(size), options, seed=1, threads=lab.threads)]
            done[key] = name
            log(f"    {name}: {runs[name][0].cpu:.2f} CPU seconds")
        except Refused as reason:
            log(f"    skipped: {name}: {reason}")
            rows[name] = {"skipped": str(reason)}
    if not runs:
        return {**rows, "reference": {}}
    errors, reference = lab.measured(cell.view(size), runs)
    rows.update({name: {"errors": errors[name], **costs(several)} for name, several in runs.items()})
    return {**rows, "reference": reference}
