# SPDX-License-Identifier: Apache-2.0
"""Writes what was measured: report.md, runs.csv, ratios.csv, and a chart (SVG) for every scene."""
import csv
import math
import pathlib
import statistics

import methods
import plots
from curves import AT_MOST, Bound, cheapest, cost_at, frontier, geometric_mean, ratio

GOAL_RANGE = 0.005, 0.015  # relative L1 at which the goals must hold
GOALS = (  # ours, rival (None: the best of the path type), least geometric mean, least on every scene
    ("cache", None, 5.0, 2.5),
    ("cache-unbiased", None, 2.0, 1.0),
    ("cache", methods.BLOCK_RIVAL, 1.3, None),
)
ERRORS = {"l1": "relative L1", "rms": "relative rms", "blocks": "L1 of 16 × 16-pixel means"}
COSTS = {"cpu_seconds": "CPU seconds", "rays": "rays"}


def write_all(data: dict, targets: list[float], folder: pathlib.Path) -> list[pathlib.Path]:
    """All files; returns them. Scenes whose measurement was interrupted are left out."""
    scenes = {name: summed_up(scene) for name, scene in data["scenes"].items() if scene.get("done")}
    charts = [write_chart(name, scene, folder) for name, scene in scenes.items()]
    together = [write_chart_of_all(scenes, error, folder) for error in ERRORS] if scenes else []
    written = [*charts, *together, write_runs(data, folder), write_ratios(scenes, targets, folder)]
    report = folder / "report.md"
    report.write_text("\n".join(markdown(data, scenes, targets, charts)) + "\n", encoding="utf-8")
    return [*written, report]


def summed_up(scene: dict) -> dict:
    """The scene with `points`: method to settings, each the median cost and mean errors of its repeats."""
    groups: dict[tuple[str, int], list[dict]] = {}
    for run in scene["runs"].values():
        groups.setdefault((run["method"], run["turn"]), []).append(run)
    points: dict[str, list[dict]] = {}
    for (name, _), runs in sorted(groups.items(), key=lambda item: (list(methods.WORDS).index(item[0][0]), item[0][1])):
        errors = {key: statistics.fmean(run["errors"][key] for run in runs) for key in ("l1", "signed", "blocks")}
        errors["rms"] = math.sqrt(statistics.fmean(run["errors"]["rms"]**2 for run in runs))
        points.setdefault(name, []).append({
            "options": runs[0]["options"], "rays": statistics.median(run["rays"] for run in runs),
            "cpu_seconds": statistics.median(run["cpu_seconds"] for run in runs), **errors})
    return {**scene, "points": points}


# --- costs at equal error ---


def line(scene: dict, method: str, cost: str, error: str) -> list[tuple[float, float]]:
    return [(p[cost], p[error]) for p in scene["points"].get(method, []) if p[error] > 0]


def costs_at(scene: dict, target: float, cost: str = "cpu_seconds", error: str = "l1") -> dict[str, Bound | None]:
    return {name: cost_at(line(scene, name, cost, error), target) for name in scene["points"]}


def best_path_type(costs: dict[str, Bound | None]) -> tuple[str, Bound] | None:
    return cheapest({name: costs.get(name) for name in methods.PATH_TYPE})


def gain(scene: dict, ours: str, rival: str | None, target: float, cost: str = "cpu_seconds",
         error: str = "l1") -> Bound | None:
    """The rival's cost over ours at this error; rival None: the best of the path type."""
    costs = costs_at(scene, target, cost, error)
    best = best_path_type(costs) if rival is None else ("", costs.get(rival))
    return ratio(best[1] if best else None, costs.get(ours))


# --- text ---


def percent(x: float, digits: int = 2) -> str:
    return f"{100 * x:.{digits}f} %"


def number(x: float) -> str:
    return f"{x:,.0f}" if abs(x) >= 1000 else f"{x:.3g}"


def text(bound: Bound | None) -> str:
    return str(bound) if bound else "–"


def table(header: list[str], rows: list[list[str]], texts: int = 1) -> list[str]:
    """A Markdown table; all columns but the first `texts` are right-aligned."""
    alignment = ["---"] * texts + ["--:"] * (len(header) - texts)
    return [f"| {' | '.join(row)} |" for row in (header, alignment, *rows)] + [""]


def markdown(data: dict, scenes: dict[str, dict], targets: list[float], charts: list[pathlib.Path]) -> list[str]:
    return ["# Error against time", "", *about_run(data["run"]), *about_scenes(data, scenes), *goals(scenes, targets),
            *table_of_gains(scenes, targets), *table_of_best(scenes, targets), *table_of_references(data, scenes),
            *table_of_runs(scenes), "## Charts", "", *(f"![{file.stem}]({file.name})" for file in charts)]


def about_run(run: dict) -> list[str]:
    width, height = run["size"]
    camera = "one camera sample through the middle of each pixel" if run["spp"] == 1 else \
        f"{run['spp']} camera samples per pixel"
    lines = [f"{run['relumine']}; {run['cpu']}, {run['cores']} cores, load {run['load_before']:.1f} before"
             + (f", {run['load_after']:.1f} after" if "load_after" in run else "")
             + f". {width} × {height} pixels, {camera}, {run['threads']} thread(s), {run['repeats']} render(s) of each kind.", ""]
    if run["quick"]:
        lines += ["**A quick run: it shows that everything runs, its numbers mean little.**", ""]
    if run.get("resumed"):
        lines += ["Resumed: not all was measured in one go.", ""]
    return lines


def about_scenes(data: dict, scenes: dict[str, dict]) -> list[str]:
    lines = [f"- **{name}**: {scene['about']}." for name, scene in scenes.items()]
    lines += [f"- Not there: {reason}." for reason in data["run"]["missing"]]
    used = dict.fromkeys(name for scene in scenes.values() for name in (*scene["points"], *scene["refused"]))
    refused = {name: why for scene in scenes.values() for name, why in scene["refused"].items()}
    lines += ["", "Methods:", ""]
    lines += [f"- `{name}`: {methods.WORDS[name]}." + (f" **Refused:** {refused[name]}" if name in refused else "")
              for name in used]
    failed = [f"- **Failed** on {name}: `{options}`: {why}." for name, scene in scenes.items()
              for options, why in scene["failed"].items()]
    return ["## Scenes", "", *lines, *failed, ""]


def goals(scenes: dict[str, dict], targets: list[float]) -> list[str]:
    """Mean gains over the targets in the goals' range, and whether they suffice."""
    at = [t for t in targets if GOAL_RANGE[0] <= t <= GOAL_RANGE[1]]
    lines = []
    for ours, rival, least_mean, least in GOALS:
        if not at or not any(ours in scene["points"] for scene in scenes.values()):
            continue
        means = {name: mean_gain(scene, ours, rival, at) for name, scene in scenes.items()}
        unknown = [name for name, value in means.items() if value is None]
        over_all = geometric_mean(means.values())
        worst = min((value.value, name) for name, value in means.items() if value) if len(unknown) < len(means) else None
        met = not unknown and reaches(over_all, least_mean) and (
            least is None or all(reaches(value, least) for value in means.values()))
        wanted = f"wanted {least_mean:g}" + (f", {least:g} on every scene" if least else "")
        against = f"`{rival}`" if rival else "the best of the path type"
        lines.append(f"- {'met' if met else '**not met**'}: `{ours}` against {against}: geometric mean {text(over_all)} ({wanted})"
                     + (f"; least {worst[0]:.3g} ({worst[1]})" if worst else "")
                     + (f"; not comparable: {', '.join(unknown)}" if unknown else ""))
    where = ", ".join(percent(t, 1) for t in at)
    return ["## Goals", "", f"Ratios of CPU seconds at equal relative L1, geometric means over {where}.", "", *lines,
            ""] if lines else []


def mean_gain(scene: dict, ours: str, rival: str | None, at: list[float]) -> Bound | None:
    """None unless there is a gain at each of the targets."""
    gains = [gain(scene, ours, rival, t) for t in at]
    return geometric_mean(gains) if all(gains) else None


def reaches(bound: Bound | None, least: float) -> bool:
    """Whether it is at least so much for certain."""
    return bound is not None and bound.kind != AT_MOST and bound.value >= least


def table_of_gains(scenes: dict[str, dict], targets: list[float]) -> list[str]:
    lines = ["## Costs at equal error", "",
             "Cost of the rival over the cost of ours; above 1 ours is cheaper. Curves are interpolated in log cost and log error "
             "and never extrapolated: `>` the rival did not reach the error, or ours was better at its cheapest; `≤` the rival "
             "was better at its cheapest; `–` ours did not reach the error, or nothing can be said.", ""]
    pairs = [(ours, None) for ours in (*methods.OURS, methods.BLOCK_RIVAL, "irradiance-cache", "radiance-cache", "reproject",
                                             "reproject-mc")]
    pairs += [("cache", methods.BLOCK_RIVAL), ("cache", "cache-even")]
    for ours, rival in pairs:
        if not any({ours, rival or ours} <= set(scene["points"]) for scene in scenes.values()):
            continue
        against = f"`{rival}`" if rival else "the best of the path type"
        lines += [f"### `{ours}` against {against}", ""]
        for error, at in (("l1", targets), ("rms", [2 * t for t in targets])):
            rows = [[name, *(text(gain(scene, ours, rival, t, cost, error)) for cost in COSTS for t in at)]
                    for name, scene in scenes.items()]
            rows.append(["**geometric mean**", *(mean_of_known([gain(scene, ours, rival, t, cost, error)
                                                                for scene in scenes.values()])
                                                 for cost in COSTS for t in at)])
            lines += table([f"at equal {ERRORS[error]}", *(f"{COSTS[cost]}, {percent(t, 1)}" for cost in COSTS for t in at)],
                           rows)
    return lines


def mean_of_known(gains: list[Bound | None]) -> str:
    known = [g for g in gains if g]
    return f"{text(geometric_mean(known))} ({len(known)} of {len(gains)})"


def table_of_best(scenes: dict[str, dict], targets: list[float]) -> list[str]:
    rows = []
    for name, scene in scenes.items():
        best = [best_path_type(costs_at(scene, t)) for t in targets]
        rows.append([name, *(f"`{b[0]}` {b[1]} s" if b else "–" for b in best)])
    return ["The best of the path type at equal relative L1, and its CPU seconds:", "",
            *table(["scene", *(percent(t, 1) for t in targets)], rows)]


def table_of_references(data: dict, scenes: dict[str, dict]) -> list[str]:
    rows = []
    for name, scene in scenes.items():
        r = scene["reference"]
        rows.append([name, number(r["rays_per_pixel"]), *(f"{percent(r[e], 3)} ({number(r['smallest'][e] / r[e])})"
                                                           for e in ERRORS), "yes" if r["reached"] else "**no**"])
    return ["## References", "",
            "Passes of `gather` with samples of the bright light in two independent halves; their mean is off by half of what they "
            f"differ by. In brackets: how many times smaller than the smallest error measured. Wanted for L1 and rms: "
            f"{data['run']['reference_ratio']:g}.", "",
            *table(["scene", "rays per pixel", *ERRORS.values(), "good enough"], rows)]


def table_of_runs(scenes: dict[str, dict]) -> list[str]:
    lines = ["## Everything measured", "",
             "CPU seconds beyond loading and building; errors relative to the reference's mean. Gain: CPU seconds of the best of "
             "the path type at the very L1 or rms of the row, over the row's.", ""]
    for name, scene in scenes.items():
        rows = [[f"`{p['options'].replace('--method ', '')}`", number(p["cpu_seconds"]), number(p["rays"] / 1e6),
                 percent(p["l1"]), percent(p["rms"]), percent(p["blocks"], 3), f"{100 * p['signed']:+.3f} %",
                 *(text(own_gain(scene, p, error)) if method not in methods.PATH_TYPE else "" for error in ("l1", "rms"))]
                for method, several in scene["points"].items() for p in several]
        lines += [f"### {name}", "", *table(["method", "CPU s", "M rays", "L1", "rms", "16 × 16 means", "signed mean",
                                             "gain, L1", "gain, rms"], rows)]
    return lines


def own_gain(scene: dict, point: dict, error: str) -> Bound | None:
    """The best path type's cost at the error of this one setting, over the setting's cost."""
    best = best_path_type(costs_at(scene, point[error], "cpu_seconds", error))
    return ratio(best[1] if best else None, Bound(point["cpu_seconds"]))


# --- files ---


def write_runs(data: dict, folder: pathlib.Path) -> pathlib.Path:
    columns = ["scene", "method", "options", "seed", "cpu_seconds", "wall_seconds", "rays", "l1", "rms", "blocks", "signed",
               "maximum"]
    rows = [{"scene": name, **run, **run["errors"]} for name, scene in data["scenes"].items() if scene.get("done")
            for run in scene["runs"].values()]
    return write_csv(folder / "runs.csv", columns, rows)


def write_ratios(scenes: dict[str, dict], targets: list[float], folder: pathlib.Path) -> pathlib.Path:
    """Every method's cost at every target, and the best path type's over it."""
    columns = ["scene", "error", "target", "cost", "method", "cost_kind", "value", "ratio_kind", "best_path_type_over_it"]
    rows = []
    for name, scene in scenes.items():
        for error, at in (("l1", targets), ("rms", [2 * t for t in targets])):
            for cost in COSTS:
                for target in at:
                    for method, value in costs_at(scene, target, cost, error).items():
                        g = gain(scene, method, None, target, cost, error)
                        rows.append({"scene": name, "error": error, "target": f"{target:g}", "cost": cost, "method": method,
                                     "cost_kind": value.kind if value else "", "value": value.value if value else "",
                                     "ratio_kind": g.kind if g else "", "best_path_type_over_it": g.value if g else ""})
    return write_csv(folder / "ratios.csv", columns, rows)


def write_csv(file: pathlib.Path, columns: list[str], rows: list[dict]) -> pathlib.Path:
    with open(file, "w", newline="", encoding="utf-8") as out:
        writer = csv.DictWriter(out, columns, extrasaction="ignore", lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    return file


def panel(name: str, scene: dict, cost: str, error: str) -> plots.Panel:
    """Frontiers of all methods."""
    return plots.Panel(name, "million rays" if cost == "rays" else COSTS[cost], f"{ERRORS[error]}, %",
                       {method: [(c / (1e6 if cost == "rays" else 1), 100 * e)
                                 for c, e in frontier(line(scene, method, cost, error))] for method in scene["points"]})


def write_chart(name: str, scene: dict, folder: pathlib.Path) -> pathlib.Path:
    """Three errors over CPU seconds, L1 over rays."""
    file = folder / f"{name}.svg"
    panels = [*(panel(name, scene, "cpu_seconds", error) for error in ERRORS), panel(name, scene, "rays", "l1")]
    file.write_text(plots.chart(panels), encoding="utf-8")
    return file


def write_chart_of_all(scenes: dict[str, dict], error: str, folder: pathlib.Path) -> pathlib.Path:
    """One error over CPU seconds, a panel for each scene; level, what the reference itself is off by."""
    panels = []
    for name, scene in scenes.items():
        panels.append(panel(name, scene, "cpu_seconds", error))
        costs = [cost for points in panels[-1].lines.values() for cost, _ in points]
        own = 100 * scene["reference"][error]
        panels[-1].lines["the reference's own error"] = [(min(costs), own), (max(costs), own)]
    file = folder / f"all-{error}.svg"
    file.write_text(plots.chart(panels, columns=3), encoding="utf-8")
    return file
