#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Error against time for every method, and what each costs at equal error; see README.md."""
import argparse
import json
import math
import os
import pathlib
import platform
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "common"))
import cells  # noqa: E402  (after the path)
import make_scenes  # noqa: E402
import methods  # noqa: E402
import tables  # noqa: E402
from command import Relumine  # noqa: E402
from measure import Lab, Plan, log, measure  # noqa: E402
from reference import digest  # noqa: E402

TARGETS = (0.005, 0.01, 0.015, 0.02)  # relative L1
QUICK = {"size": (128, 128), "reference_rays": 512, "reference_passes": 8, "reference_ratio": 2.0}
FULL = {"size": (512, 512), "reference_rays": 4096, "reference_passes": 64, "reference_ratio": 3.0}


def parse_arguments() -> argparse.Namespace:
    root, names = make_scenes.ROOT, list(methods.WORDS)
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--relumine", type=pathlib.Path, default=root / "build/release/relumine",
                        help="the command (default: build/release/relumine)")
    parser.add_argument("--out", type=pathlib.Path, help="folder for all that is written (default: out/equal-error, "
                        "with --quick out/equal-error-quick)")
    parser.add_argument("--quick", action="store_true", help="128 x 128 pixels, few budgets, rough references: does it run?")
    parser.add_argument("--size", type=size_of, metavar="WxH", help="pixels (default: 512x512)")
    parser.add_argument("--spp", type=int, default=1, help="camera samples per pixel; 1: through its middle (default: 1)")
    parser.add_argument("--scenes", type=words, default=list(cells.NAMES), help=f"of {','.join(cells.NAMES)} (default: all)")
    parser.add_argument("--methods", type=words, default=names, help=f"of {','.join(names)} (default: all)")
    parser.add_argument("--repeats", type=int, default=1, help="renders of each kind, with seeds of their own (default: 1)")
    parser.add_argument("--threads", type=int, default=1, help="(default: 1)")
    parser.add_argument("--most-seconds", type=float, default=math.inf,
                        help="a method gets no larger budget on a scene where it has taken so much CPU time (default: none)")
    parser.add_argument("--targets", type=percents, default=list(TARGETS),
                        help="relative L1 at which costs are compared, in %% (default: 0.5,1,1.5,2)")
    parser.add_argument("--dragon", type=pathlib.Path, default=root / "models/dragon.ply.gz",
                        help="the Stanford dragon (default: models/dragon.ply.gz, from scripts/fetch-models)")
    parser.add_argument("--armadillo", type=pathlib.Path, help="closed OBJ; without it a shape of our own")
    parser.add_argument("--reference-rays", type=int, help="per pixel and pass (default: 4096)")
    parser.add_argument("--reference-passes", type=int, help="at most (default: 64)")
    parser.add_argument("--reference-ratio", type=float,
                        help="the smallest error must be so many times the reference's own (default: 3)")
    parser.add_argument("--keep-pictures", action="store_true", help="do not delete the renders of finished scenes")
    parser.add_argument("--resume", action="store_true", help="keep what results.json holds of the same run")
    parser.add_argument("--report-only", action="store_true", help="write the reports anew from results.json")
    args = parser.parse_args()
    for name, value in (QUICK if args.quick else FULL).items():
        if getattr(args, name) is None:
            setattr(args, name, value)
    args.out = args.out or root / ("out/equal-error-quick" if args.quick else "out/equal-error")
    for option, chosen, known in (("--scenes", args.scenes, cells.NAMES), ("--methods", args.methods, names)):
        if not chosen or not set(chosen) <= set(known):
            parser.error(f"{option}: expected some of {','.join(known)}, found {','.join(chosen)}")
    for option in ("spp", "repeats", "threads"):
        if getattr(args, option) < 1:
            parser.error(f"--{option}: expected at least 1, found {getattr(args, option)}")
    if not args.relumine.exists() and not args.report_only:
        parser.error(f"{args.relumine} does not exist: cmake --preset release && cmake --build --preset release")
    return args


def words(text: str) -> list[str]:
    return [word for word in text.split(",") if word]


def percents(text: str) -> list[float]:
    return sorted(float(word) / 100 for word in words(text))


def size_of(text: str) -> tuple[int, int]:
    width, height = (int(number) for number in text.split("x"))
    return width, height


def cpu_model() -> str:
    try:
        lines = pathlib.Path("/proc/cpuinfo").read_text().splitlines()
        return next(line.split(":", 1)[1].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor() or "unknown"


class Results:
    """results.json: written after every render, so that an interrupted run can be resumed."""

    def __init__(self, file: pathlib.Path, run: dict, resume: bool):
        self.file, self.data = file, {"run": run, "scenes": {}}
        if resume and file.exists():
            old = json.loads(file.read_text())
            if old["run"]["fingerprint"] == run["fingerprint"]:
                self.data["scenes"], run["resumed"] = old["scenes"], True
            else:
                log("--resume: results.json is of another build or other settings; everything is measured anew")

    def save(self) -> None:
        beside = self.file.with_suffix(".new")
        beside.write_text(json.dumps(self.data, indent=1) + "\n")
        beside.replace(self.file)


def fingerprint(args: argparse.Namespace) -> dict:
    """What must be the same for results to be kept by --resume."""
    return {"program": digest(args.relumine), "size": list(args.size), "spp": args.spp, "quick": args.quick,
            "repeats": args.repeats, "threads": args.threads, "methods": args.methods,
            "reference": ["sobol", args.reference_rays, args.reference_ratio]}


def run_all(args: argparse.Namespace) -> dict:
    log("making scenes and environments")
    chosen, white, missing = cells.make_cells(args.out / "scenes", args.scenes, args.dragon, args.armadillo)
    for reason in missing:
        log(f"skipped: {reason}")
    plan = Plan(*args.size, args.spp, args.threads, args.repeats, args.methods, args.quick,
                stop_at=0.6 * min(args.targets), most_seconds=args.most_seconds, reference_ratio=args.reference_ratio,
                keep_pictures=args.keep_pictures)
    with tempfile.TemporaryDirectory() as scratch:
        relumine = Relumine(args.relumine, pathlib.Path(scratch))
        rays = max(16, args.reference_rays // args.spp)
        references = cells.references(relumine, args.out, rays, args.reference_passes, log)
        run = {"relumine": relumine.version(), "cpu": cpu_model(), "cores": os.cpu_count(), "missing": missing,
               "load_before": os.getloadavg()[0], "fingerprint": fingerprint(args), "size": list(args.size),
               "spp": args.spp, "threads": args.threads, "repeats": args.repeats, "quick": args.quick,
               "reference_ratio": args.reference_ratio}
        results = Results(args.out / "results.json", run, args.resume)
        lab = Lab(relumine, references, white, args.out / "pictures", plan)
        for cell in chosen:
            state = results.data["scenes"].setdefault(cell.name, {})
            if state.get("done"):
                continue
            log(cell.name)
            measure(lab, cell, state, results.save)
        run["load_after"] = os.getloadavg()[0]
        results.save()
        return results.data


def main() -> int:
    args = parse_arguments()
    args.out.mkdir(parents=True, exist_ok=True)
    data = json.loads((args.out / "results.json").read_text()) if args.report_only else run_all(args)
    for file in tables.write_all(data, args.targets, args.out):
        log(f"written: {file}")
    print((args.out / "report.md").read_text())
    return 0


if __name__ == "__main__":
    sys.exit(main())
