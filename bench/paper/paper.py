#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The experiment of the paper on the high-frequency radiance cache, as one command; see README.md."""
import argparse
import json
import os
import pathlib
import platform
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "common"))
import environments  # noqa: E402  (after the path)
import experiment  # noqa: E402
import make_scenes  # noqa: E402
import report  # noqa: E402
from command import Relumine  # noqa: E402
from experiment import Cell, Lab, log  # noqa: E402
from reference import References, digest  # noqa: E402

PARTS = ("methods", "scaling", "sweeps", "convergence")
REPORTED = ("n", "size", "sweep_size", "bands", "repeats", "threads", "quick", "reference_ratio", "reference_rays",
            "reference_light_samples", "reference_passes")  # settings


def parse_arguments() -> argparse.Namespace:
    root = make_scenes.ROOT
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--relumine", type=pathlib.Path, default=root / "build/release/relumine",
                        help="the command (default: build/release/relumine)")
    parser.add_argument("--out", type=pathlib.Path, help="folder for all that is written (default: out/paper, "
                        "with --quick out/paper-quick)")
    parser.add_argument("--quick", action="store_true",
                        help="128 x 128 pixels, n = 32, one repeat, rough references: does it run?")
    parser.add_argument("--size", type=int, help="pixels a side (default: 512, as in the paper)")
    parser.add_argument("--sweep-size", type=int, help="the same for sweeps and convergence (default: 256)")
    parser.add_argument("--n", type=int,
                        help="n x n rays in gathers and records, but for sweeps (default: 64, as in the paper)")
    parser.add_argument("--repeats", type=int, help="renders of each kind; times are medians (default: 3)")
    parser.add_argument("--threads", type=int, default=1, help="for all but thread scaling (default: %(default)s)")
    parser.add_argument("--parts", type=words, default=list(PARTS), help=f"of {','.join(PARTS)} (default: all)")
    parser.add_argument("--methods", type=words, default=list(experiment.DEFAULT_METHODS),
                        help=f"of {','.join(experiment.METHODS)} (default: {','.join(experiment.DEFAULT_METHODS)})")
    parser.add_argument("--scenes", type=words, help="of shadow,dragon,armadillo (default: all)")
    parser.add_argument("--environments", type=words,
                        help="smooth, sun, or names from --environment-dir (default: all)")
    parser.add_argument("--environment-dir", type=pathlib.Path, help="more environments: .exr .hdr .pfm, lat-long")
    parser.add_argument("--dragon", type=pathlib.Path, default=root / "models/dragon.ply.gz",
                        help="the Stanford dragon (default: models/dragon.ply.gz, from scripts/fetch-models)")
    parser.add_argument("--armadillo", type=pathlib.Path,
                        help="closed OBJ, refined to 300,000 triangles or more; without it a shape of our own")
    parser.add_argument("--reference-rays", type=int, help="per pixel and pass (default: 4096)")
    parser.add_argument("--reference-light-samples", type=int, default=256, help="the same (default: %(default)s)")
    parser.add_argument("--reference-ratio", type=float,
                        help="the smallest error must be so many times the reference's own (default: 5)")
    parser.add_argument("--reference-passes", type=int, help="at most (default: 64)")
    parser.add_argument("--bands", type=int, default=0,
                        help="errors and references of so many bands of 4 rows, drawn once, instead of the whole "
                        "picture; gather is rendered and timed in these alone (part methods; 0: whole pictures)")
    parser.add_argument("--resume", action="store_true", help="keep what results.json holds of the same run")
    parser.add_argument("--report-only", action="store_true", help="write the reports anew from results.json")
    args = parser.parse_args()
    quick = {"n": 32, "size": 128, "sweep_size": 64, "repeats": 1, "reference_ratio": 2.0, "reference_passes": 8,
             "reference_rays": 1024}
    full = {"n": experiment.N, "size": 512, "sweep_size": 256, "repeats": 3, "reference_ratio": 5.0,
            "reference_passes": 64, "reference_rays": 4096}
    for name, value in (quick if args.quick else full).items():
        if getattr(args, name) is None:
            setattr(args, name, value)
    args.out = args.out or root / ("out/paper-quick" if args.quick else "out/paper")
    check_names(parser, "--parts", args.parts, PARTS)
    check_names(parser, "--methods", args.methods, experiment.METHODS)
    if not args.relumine.exists() and not args.report_only:
        parser.error(f"{args.relumine} does not exist: cmake --preset release && cmake --build --preset release")
    if args.armadillo and not args.armadillo.exists():
        parser.error(f"--armadillo: {args.armadillo} does not exist")
    if not 0 <= args.bands <= args.size // experiment.BAND_ROWS:
        parser.error(f"--bands: expected 0 ... {args.size // experiment.BAND_ROWS}, found {args.bands}")
    if args.repeats < 1:
        parser.error(f"--repeats: expected at least 1, found {args.repeats}")
    return args


def words(text: str) -> list[str]:
    return [word for word in text.split(",") if word]


def check_names(parser: argparse.ArgumentParser, option: str, names: list[str], known) -> None:
    for name in names:
        if name not in known:
            parser.error(f"{option}: expected some of {','.join(known)}, found {name}")


def chosen(skies: dict[str, pathlib.Path], names: list[str] | None) -> dict[str, pathlib.Path]:
    """Those that are named, all without names."""
    for name in names or ():
        if name not in skies:
            raise SystemExit(f"--environments: expected some of {','.join(skies)}, found {name}")
    return {name: file for name, file in skies.items() if names is None or name in names}


def make_cells(args: argparse.Namespace) -> tuple[list[Cell], pathlib.Path, list[str]]:
    """All scenes under all environments, the white environment, and what is missing."""
    log("making scenes and environments")
    skies = environments.write_environments(args.out / "scenes")
    white = skies.pop("white")
    if args.environment_dir:
        files = sorted(f for f in args.environment_dir.iterdir() if f.suffix.lower() in (".exr", ".hdr", ".pfm"))
        skies.update({file.stem: file for file in files})
    scenes, missing = make_scenes.make_all(args.out / "scenes", args.dragon, args.armadillo, args.scenes)
    for reason in missing:
        log(f"skipped: {reason}")
    skies = chosen(skies, args.environments)
    return [Cell(scene, name, file) for scene in scenes for name, file in skies.items()], white, missing


def fingerprint(args: argparse.Namespace) -> dict:
    """What must be the same for results to be kept by --resume."""
    return {"program": digest(args.relumine), "size": args.size, "sweep_size": args.sweep_size,
            "repeats": args.repeats, "threads": args.threads, "quick": args.quick, "methods": args.methods, "n": args.n,
            "bands": args.bands,
            "reference": [args.reference_rays, args.reference_light_samples, args.reference_ratio]}


def cpu_model() -> str:
    try:
        lines = pathlib.Path("/proc/cpuinfo").read_text().splitlines()
        return next(line.split(":", 1)[1].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor() or "unknown"


class Results:
    """results.json: written after every step, so that an interrupted experiment can be resumed."""

    def __init__(self, file: pathlib.Path, run: dict, resume: bool):
        self.file = file
        self.data = {"run": run, **{part: {} for part in PARTS}}
        if resume and file.exists():
            old = json.loads(file.read_text())
            if old["run"]["fingerprint"] == run["fingerprint"]:
                self.data = {**old, "run": {**old["run"], "resumed": True}}
            else:
                log("--resume: results.json is of another build or other settings; everything is measured anew")

    def step(self, part: str, cell: Cell, measure) -> None:
        """Measures unless it has been done."""
        if cell.name in self.data[part]:
            return
        log(f"{part}: {cell.name}")
        found = measure()
        if found is not None:
            self.data[part][cell.name] = found
            self.save()

    def save(self) -> None:
        beside = self.file.with_suffix(".new")
        beside.write_text(json.dumps(self.data, indent=1) + "\n")
        beside.replace(self.file)


def scaling_of(lab: Lab, cell: Cell, results: Results, args: argparse.Namespace) -> dict | None:
    """Thread scaling of a cell whose methods have been measured; nothing to do without the cache."""
    methods = results.data["methods"].get(cell.name, {}).get("methods", {})
    if any("cpu_seconds" not in methods.get(name, {}) for name in ("reproject", "gather")):
        log("    skipped: the times of reproject and gather are needed first (--parts methods)")
        return None
    seconds = [methods[name]["cpu_seconds"] for name in ("reproject", "gather")]
    return experiment.measure_scaling(lab, cell, experiment.methods_of(args.n), *seconds, args.size, args.repeats)


def measure(args: argparse.Namespace) -> dict:
    cells, white, missing = make_cells(args)
    with tempfile.TemporaryDirectory() as scratch:
        relumine = Relumine(args.relumine, pathlib.Path(scratch))
        references = References(relumine, args.out / "references", args.reference_rays, args.reference_light_samples,
                                args.reference_passes, log)
        lab = Lab(relumine, references, white, args.threads, args.reference_ratio, args.out / "pictures")
        run = {"relumine": relumine.version(), "cpu": cpu_model(), "cores": os.cpu_count(),
               "load_before": os.getloadavg()[0], "missing": missing, "fingerprint": fingerprint(args),
               "settings": {name: getattr(args, name) for name in REPORTED}}
        results = Results(args.out / "results.json", run, args.resume)
        methods = {name: options for name, options in experiment.methods_of(args.n).items() if name in args.methods}
        bands = experiment.bands_of(args.size, args.bands)
        steps = {
            "methods": lambda c: experiment.measure_methods(lab, c, methods, c.view(args.size, bands), args.repeats),
            "scaling": lambda c: scaling_of(lab, c, results, args),
            "sweeps": lambda c: experiment.measure_sweeps(lab, c, args.sweep_size, args.quick),
            "convergence": lambda c: experiment.measure_convergence(lab, c, args.sweep_size),
        }
        for part in (part for part in PARTS if part in args.parts):
            for cell in cells:
                results.step(part, cell, lambda: steps[part](cell))
        results.data["run"]["load_after"] = os.getloadavg()[0]
        results.save()
        return results.data


def main() -> int:
    args = parse_arguments()
    args.out.mkdir(parents=True, exist_ok=True)
    data = json.loads((args.out / "results.json").read_text()) if args.report_only else measure(args)
    for file in report.write_all(data, args.out):
        log(f"written: {file}")
    print((args.out / "report.md").read_text())
    return 0


if __name__ == "__main__":
    sys.exit(main())
