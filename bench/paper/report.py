# SPDX-License-Identifier: Apache-2.0
"""Writes what was measured: report.md, CSV tables, picture sheets (PNG), plots of sweeps and convergence (SVG)."""
import csv
import pathlib
from collections.abc import Iterable

import numpy as np

import pictures
import plots
from experiment import STAGES, SWEEPS
from pictures import read_pfm

# The paper's tables 1 and 2: seconds (four cores of 2008) and L1 error; speed-ups.
PUBLISHED = {
    "shadow": {"gather": (950.9, 0.047), "reproject": (44.0, 0.034), "reproject-mc": (961.4, 0.019)},
    "dragon": {"gather": (310.3, 0.026), "reproject": (51.7, 0.032), "reproject-mc": (362.9, 0.018)},
    "armadillo": {"gather": (348.8, 0.025), "reproject": (58.1, 0.033), "reproject-mc": (411.3, 0.018)},
}
SHEET_ROWS = ("gather", "reproject", "reproject-mc", "reproject-mc-0")
GOALS = {"reprojection": 20.0, "speed_up": 3.5, "scaling": 0.97, "convergence": 0.70}
WORDS = {
    "gather-single": "n² rays ∝ BSDF, traced one by one (the paper's baseline)",
    "gather": "the same in packets (our baseline)",
    "reproject": "reprojection, records of n² rays",
    "reproject-mc": "reprojection, then n² rays from its product, 10 % of them ∝ BSDF",
    "reproject-mc-0": "the same without the defensive 10 %: the paper's",
}


def write_all(data: dict, folder: pathlib.Path) -> list[pathlib.Path]:
    """All files; returns them."""
    written = [*write_tables(data, folder), *write_sheets(data, folder), *write_plots(data, folder)]
    report = folder / "report.md"
    report.write_text("\n".join(markdown(data, written)) + "\n")
    return [*written, report]


# --- numbers as text ---


def percent(x: float | None, digits: int = 2) -> str:
    return "–" if x is None else f"{100 * x:.{digits}f} %"


def number(x: float | None, digits: int = 3) -> str:
    """Three significant digits, thousands in full."""
    if x is None:
        return "–"
    return f"{x:,.0f}" if abs(x) >= 1000 else f"{x:.{digits}g}"


def signed_percent(x: float) -> str:
    return f"{100 * x:+.3f} %"


def with_spread(form, errors: dict, measure: str) -> str:
    """The mean over seeds and, if there were several, how much one differs from the next."""
    text = form(errors[measure])
    return text if "spread" not in errors else f"{text} ± {form(errors['spread'][measure]).lstrip('+')}"


def table(header: list[str], rows: Iterable[list[str]], texts: int = 1) -> list[str]:
    """A Markdown table; all columns but the first `texts` are right-aligned."""
    alignment = ["---"] * texts + ["--:"] * (len(header) - texts)
    return [f"| {' | '.join(line)} |" for line in (header, alignment, *rows)] + [""]


def done(part: dict) -> list[dict]:
    """Cells of a part that were not skipped."""
    return [cell for cell in part.values() if "skipped" not in cell]


def label(cell: dict) -> str:
    return f"{cell['scene']}, {cell['environment']}"


# --- Markdown ---


def markdown(data: dict, written: list[pathlib.Path]) -> list[str]:
    lines = ["# The paper's experiment", "", *about_run(data["run"]), *about_scenes(data)]
    if data["methods"]:
        lines += [*about_methods(data), *table_of_errors(data), *table_of_speed_ups(data), *table_of_paper(data),
                  *table_of_cache(data)]
    lines += [*table_of_scaling(data), *table_of_sweeps(data), *table_of_convergence(data), *goals(data)]
    shown = [file for file in written if file.suffix in (".png", ".svg")]
    lines += ["## Pictures", ""] if shown else []
    for file in shown:
        lines += [f"![{file.stem}]({file.name})", ""]
    return lines


def about_run(run: dict) -> list[str]:
    s = run["settings"]
    lines = [f"{run['relumine']}; {run['cpu']}, {run['cores']} cores, load {run['load_before']:.1f} before"
             + (f", {run['load_after']:.1f} after" if "load_after" in run else "")
             + f". n = {s['n']}; {s['size']} × {s['size']} pixels (sweeps {s['sweep_size']} × {s['sweep_size']}), one centred ray per "
             f"pixel, {s['threads']} thread(s), {s['repeats']} repeat(s), each with another seed; secondary radiance: the "
             "environment on a miss, black on a hit.", ""]
    if s.get("bands"):
        lines += [f"Errors of {s['bands']} bands of 4 rows, drawn once for all methods, and of the whole picture's records; the "
                  "times of `gather` and of `reproject-mc`'s rays are those of the bands, scaled to the whole picture.", ""]
    if s["quick"]:
        lines += ["**A quick run: it shows that everything runs, its numbers mean nothing.**", ""]
    if run.get("resumed"):
        lines += ["Resumed: not all was measured in one go.", ""]
    return lines


def about_scenes(data: dict) -> list[str]:
    models = {cell["scene"]: cell["model"] for cell in data["methods"].values()}
    lines = [f"- **{scene}**: {model}." for scene, model in models.items()]
    lines += [f"- Not there: {reason}." for reason in data["run"]["missing"]]
    return ["## Scenes", "", *lines, ""] if lines else []


def about_methods(data: dict) -> list[str]:
    cells = list(data["methods"].values())
    names = list(dict.fromkeys(name for cell in cells for name in cell["methods"]))
    lines = ["## Methods", ""]
    for name in names:
        reason = next((c["methods"][name]["skipped"] for c in cells if "skipped" in c["methods"].get(name, {})), None)
        lines.append(f"- `{name}`: {WORDS.get(name, '')}." + (f" **Skipped:** {reason}" if reason else ""))
    return [*lines, ""]


def table_of_errors(data: dict) -> list[str]:
    lines = ["## Time and error", "",
             "CPU s: user + system of rendering, without loading and building; median. In all: of the whole process. "
             "L1 = Σ|L − R| / ΣR (the paper's), rms = √mean(L − R)² / mean R, signed = Σ(L − R) / ΣR, max = max|L − R| / "
             "mean R; pixels that see the environment alone are left out. Errors are means over the repeats; behind ± the standard "
             "deviation from one to the next.", ""]
    rows = []
    for cell in data["methods"].values():
        for name, m in cell["methods"].items():
            if "skipped" in m:
                continue
            e = m["errors"]
            rows.append([label(cell), f"`{name}`", number(m["cpu_seconds"]), number(m["process_cpu_seconds"]),
                         with_spread(percent, e, "l1"), with_spread(percent, e, "rms"), with_spread(signed_percent, e, "signed"),
                         with_spread(number, e, "maximum")])
    lines += table(["scene, environment", "method", "CPU s", "in all", "L1", "rms", "signed", "max"], rows, texts=2)
    return [*lines, *about_references(data)]


def about_references(data: dict) -> list[str]:
    """How good each reference is, by its own estimate."""
    wanted = data["run"]["settings"]["reference_ratio"]
    lines = ["References: `gather` with samples of the bright light and seeds of its own, in two independent halves; the error "
             f"of their mean is half of what they differ by. Wanted: the smallest error of the table, over {wanted:g}.", ""]
    rows = []
    for cell in data["methods"].values():
        r = cell["reference"]
        smallest = [min(m["errors"][k] for m in cell["methods"].values() if "errors" in m) for k in ("l1", "rms")]
        rows.append([label(cell), number(r["rays_per_pixel"]), percent(r["l1"], 3), number(smallest[0] / r["l1"]),
                     percent(r["rms"], 3), number(smallest[1] / r["rms"]), "yes" if r["reached"] else "**no**"])
    return lines + table(["reference of", "rays per pixel", "its L1", "times smaller than the smallest", "its rms",
                          "times smaller", "good enough"], rows)


def table_of_speed_ups(data: dict) -> list[str]:
    rows = []
    for cell in data["methods"].values():
        for name, m in cell["methods"].items():
            for baseline, s in m.get("speed_up", {}).items():
                if baseline == "gather-single" and name == "gather":
                    continue
                rows.append([label(cell), f"`{name}`", f"`{baseline}`", number(s["raw"]), number(s["equal_l1"]),
                             number(s["equal_rms"]), number(s["table2"])])
    if not rows:
        return []
    return ["## Speed-ups", "",
            "Raw: ratio of CPU seconds. At equal error: × (error ratio)², for a baseline that converges as 1/√time. Table 2's "
            "own formula for the unbiased method is (L1 ratio)² alone, as if times were equal.", "",
            *table(["scene, environment", "method", "against", "raw", "equal L1", "equal rms", "(L1 ratio)² alone"], rows,
                   texts=3)]


def table_of_paper(data: dict) -> list[str]:
    """Published numbers beside ours."""
    rows = []
    for cell in data["methods"].values():
        for name, (seconds, l1) in PUBLISHED.get(cell["scene"], {}).items():
            base_seconds, base_l1 = PUBLISHED[cell["scene"]]["gather"]
            ours = cell["methods"].get(name, {})
            base = cell["methods"].get("gather-single", {})
            if "errors" not in ours:
                continue
            has_base = "errors" in base and name != "gather"
            rows.append([label(cell), f"`{name}`", percent(l1, 1), percent(ours["errors"]["l1"]),
                         number(base_seconds / seconds) if name != "gather" else "1",
                         number(base["cpu_seconds"] / ours["cpu_seconds"]) if has_base else "–",
                         number((base_l1 / l1)**2) if name != "gather" else "1",
                         number((base["errors"]["l1"] / ours["errors"]["l1"])**2) if has_base else "–"])
    if not rows:
        return []
    return ["## Beside the paper's tables", "",
            "Speed-ups here are against single rays, as in the paper; its scenes, environments and machine are not ours.", "",
            *table(["scene, environment", "method", "paper: L1", "ours", "paper: time ratio", "ours", "paper: (L1 ratio)²",
                    "ours"], rows, texts=2)]


def table_of_cache(data: dict) -> list[str]:
    rows, times = [], []
    for cell in data["methods"].values():
        for name, m in cell["methods"].items():
            if "cache" not in m:
                continue
            c, points = m["cache"], m["cache"]["points"]
            rows.append([label(cell), f"`{name}`", number(c["records"]), number(c["surfels_per_record"]),
                         number(c["bytes_per_record"]), number(c["record_bytes"] and c["record_bytes"] / 2**20),
                         number(points), number(c["reprojections"] and points and c["reprojections"] / points),
                         number(c["gap_rays"] is not None and points and c["gap_rays"] / points)])
            stages = [c[f"{stage}_cpu_seconds"] for stage in STAGES]
            times.append([label(cell), f"`{name}`", *(number(s and points and 1e6 * s / points) for s in stages),
                          number(c["reprojection_us_per_point"])])
    if not rows:
        return []
    return ["## The cache", "",
            *table(["scene, environment", "method", "records", "surfels per record", "bytes per record", "MiB", "points",
                    "reprojections per point", "gap rays per point"], rows, texts=2),
            "CPU µs per shading point, by stage; reprojection alone = reproject + shade.", "",
            *table(["scene, environment", "method", *STAGES, "reprojection alone"], times, texts=2), *table_of_rays(data)]


def table_of_rays(data: dict) -> list[str]:
    purposes = list(dict.fromkeys(purpose for cell in data["methods"].values() for m in cell["methods"].values()
                                  for purpose, count in m.get("rays", {}).items() if count))
    rows = [[label(cell), f"`{name}`", *(number(m["rays"].get(purpose, 0) / 1e6) for purpose in purposes)]
            for cell in data["methods"].values() for name, m in cell["methods"].items() if "rays" in m]
    return ["Rays by purpose, in millions.", "", *table(["scene, environment", "method", *purposes], rows, texts=2)]


def table_of_scaling(data: dict) -> list[str]:
    rows = [[label(cell), name if name != "control" else f"control: `gather`, {cell['control_gather_rays']} rays",
             number(r["wall_1"]), number(r["wall_2"]),
             f"{r['scaling']:.3f} ({r['scaling_range'][0]:.3f} … {r['scaling_range'][1]:.3f})", f"{r['of_control']:.3f}"]
            for cell in done(data["scaling"]) for name, r in cell["rows"].items()]
    if not rows:
        return []
    return ["## Threads 1 → 2", "",
            "Wall-clock seconds of rendering; medians of interleaved repeats. The control's pixels share nothing, and its rays "
            "are as many as take equally long.", "",
            *table(["scene, environment", "method", "1 thread", "2 threads", "ratio (range)", "of the control's"], rows,
                   texts=2)]


def table_of_sweeps(data: dict) -> list[str]:
    cells = done(data["sweeps"])
    if not cells:
        return []
    lines = ["## Sweeps", "", "`reproject`, one parameter at a time; L1 / CPU seconds.", ""]
    for parameter in SWEEPS:
        values = sorted({p["value"] for cell in cells for p in cell["points"] if p["parameter"] == parameter})
        rows = []
        for cell in cells:
            found = {p["value"]: p for p in cell["points"] if p["parameter"] == parameter and "errors" in p}
            rows.append([label(cell), *(f"{percent(found[v]['errors']['l1'])} / {number(found[v]['cpu_seconds'])}"
                                        if v in found else "–" for v in values)])
        lines += table([f"`--{parameter}`", *(f"{v:g}" for v in values)], rows)
    return lines


def table_of_convergence(data: dict) -> list[str]:
    cells = done(data["convergence"])
    if not cells:
        return []
    lines = ["## Convergence", "", "`reproject` with a quarter of the spacing and twice the n, together: L1 / CPU seconds.", ""]
    header = [f"spacing {s['record-spacing']:g}, n = {s['record-size']}" for s in cells[0]["steps"]]
    rows = [[label(cell), *(f"{percent(s['errors']['l1'])} / {number(s['cpu_seconds'])}" if "errors" in s else "–"
                            for s in cell["steps"]),
             number(cell["error_ratio"].get("l1")), number(cell["error_ratio"].get("rms"))] for cell in cells]
    return lines + table(["scene, environment", *header, "L1 ratio, last step", "rms ratio"], rows)


def goals(data: dict) -> list[str]:
    """What the method must hold, and whether it does."""
    lines = []

    def judge(text: str, values: dict[str, float | None], good) -> None:
        for name, value in values.items():
            if value is not None:
                lines.append(f"- {'met' if good(value) else '**not met**'}: {text}; {name}: {value:.3g}")

    methods = {label(c): c["methods"].get("reproject", {}) for c in data["methods"].values()}
    judge(f"reprojection alone at most {GOALS['reprojection']:g} µs per point",
          {name: m.get("cache", {}).get("reprojection_us_per_point") for name, m in methods.items()
           if name.startswith("dragon")}, lambda x: x <= GOALS["reprojection"])
    judge(f"`reproject` at least {GOALS['speed_up']:g} times as fast as `gather` with packets",
          {name: m.get("speed_up", {}).get("gather", {}).get("raw") for name, m in methods.items()},
          lambda x: x >= GOALS["speed_up"])
    judge(f"scaling 1 → 2 threads at least {GOALS['scaling']:g} of the control's",
          {f"{label(c)}, {name}": r["of_control"] for c in done(data["scaling"]) for name, r in c["rows"].items()
           if name != "control"}, lambda x: x >= GOALS["scaling"])
    judge(f"L1 falls to at most {GOALS['convergence']:g} with spacing / 4 and 2n",
          {label(c): c["error_ratio"].get("l1") for c in done(data["convergence"])}, lambda x: x <= GOALS["convergence"])
    return ["## Goals", "", *lines, ""] if lines else []


# --- CSV ---


def flat(values: dict, prefix: str = "") -> dict[str, object]:
    """Nested keys joined by dots; lists left out."""
    result: dict[str, object] = {}
    for key, value in values.items():
        if isinstance(value, dict):
            result.update(flat(value, f"{prefix}{key}."))
        elif not isinstance(value, list):
            result[f"{prefix}{key}"] = value
    return result


def write_tables(data: dict, folder: pathlib.Path) -> list[pathlib.Path]:
    tables = {
        "methods": [{"method": name, **flat(m)} for c in data["methods"].values() for name, m in c["methods"].items()],
        "scaling": [{"method": name, **flat(r)} for c in done(data["scaling"]) for name, r in c["rows"].items()],
        "sweeps": [flat(p) for c in done(data["sweeps"]) for p in c["points"]],
        "convergence": [flat(s) for c in done(data["convergence"]) for s in c["steps"]],
    }
    owners = {
        "methods": [c for c in data["methods"].values() for _ in c["methods"]],
        "scaling": [c for c in done(data["scaling"]) for _ in c["rows"]],
        "sweeps": [c for c in done(data["sweeps"]) for _ in c["points"]],
        "convergence": [c for c in done(data["convergence"]) for _ in c["steps"]],
    }
    written = []
    for name, rows in tables.items():
        if not rows:
            continue
        rows = [{"scene": owner["scene"], "environment": owner["environment"], "size": owner["size"], **row}
                for owner, row in zip(owners[name], rows)]
        columns = list(dict.fromkeys(key for row in rows for key in row if key != "command"))
        with open(folder / f"{name}.csv", "w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, columns, extrasaction="ignore", lineterminator="\n")
            writer.writeheader()
            writer.writerows(rows)
        written.append(folder / f"{name}.csv")
    return written


# --- pictures ---


def write_sheets(data: dict, folder: pathlib.Path) -> list[pathlib.Path]:
    """One sheet per environment, after the paper's figure 2: a row per method, then a row per method of its errors."""
    written: list[pathlib.Path] = []
    if data["run"]["settings"].get("bands"):
        return written  # there are no whole pictures to show
    for environment in dict.fromkeys(cell["environment"] for cell in data["methods"].values()):
        cells = [cell for cell in data["methods"].values() if cell["environment"] == environment]
        names = [name for name in SHEET_ROWS if all("errors" in cell["methods"].get(name, {}) for cell in cells)]
        if not names:
            continue
        columns = [sheet_column(cell, names, folder / "pictures") for cell in cells]
        file = folder / f"sheet-{environment}.png"
        pictures.write_png(file, pictures.sheet([list(row) for row in zip(*columns)]))
        written.append(file)
    return written


def sheet_column(cell: dict, names: list[str], folder: pathlib.Path) -> list[tuple[str, np.ndarray]]:
    base = f"{cell['scene']}-{cell['environment']}"
    reference, surfaces = read_pfm(folder / f"{base}-reference.pfm"), read_pfm(folder / f"{base}-surfaces.pfm")
    keep = surfaces[:, :, 0] > 0.5
    exposure = pictures.exposure_for(reference, 92)
    worst = max(cell["methods"][name]["errors"]["l1"] for name in names)
    full_scale = 0.01 * max(1, round(300 * worst))
    shown, wrong = [], []
    for name in names:
        picture = read_pfm(folder / f"{base}-{name}.pfm")
        e = cell["methods"][name]["errors"]
        shown.append((f"{cell['scene']}, {name}: L1 {100 * e['l1']:.2f} %", pictures.enlarged(pictures.to_srgb(picture, exposure))))
        wrong.append((f"{name}: red/blue = +-{100 * full_scale:.0f} %, mean {100 * e['signed']:+.2f} %",
                      pictures.enlarged(pictures.signed_error(picture, reference, keep, full_scale))))
    return [*shown, *wrong]


# --- plots ---


def write_plots(data: dict, folder: pathlib.Path) -> list[pathlib.Path]:
    written = []
    cells = done(data["sweeps"])
    for parameter in SWEEPS if cells else ():
        panels = [plots.Panel(title, f"--{parameter}", unit, {label(cell): sweep_line(cell, parameter, value)
                                                              for cell in cells})
                  for title, unit, value in (("error", "relative L1, %", lambda p: 100 * p["errors"]["l1"]),
                                             ("time", "CPU seconds", lambda p: p["cpu_seconds"]))]
        written.append(write_chart(folder / f"sweep-{parameter}.svg", panels))
    cells = done(data["convergence"])
    if cells:
        lines = {label(cell): [(s["record-size"], 100 * s["errors"]["l1"]) for s in cell["steps"] if "errors" in s]
                 for cell in cells}
        panel = plots.Panel("spacing 4, 1, 1/4", "n", "relative L1, %", lines)
        written.append(write_chart(folder / "convergence.svg", [panel]))
    return written


def sweep_line(cell: dict, parameter: str, value) -> list[tuple[float, float]]:
    found = [(p["value"], value(p)) for p in cell["points"] if p["parameter"] == parameter and "errors" in p]
    return sorted(point for point in found if min(point) > 0)


def write_chart(file: pathlib.Path, panels: list[plots.Panel]) -> pathlib.Path:
    file.write_text(plots.chart(panels))
    return file
