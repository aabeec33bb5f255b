# SPDX-License-Identifier: Apache-2.0
"""What the command bears: makes large scenes, loads and renders each, and tells time, memory and whether it went well.

    cmake --preset release && cmake --build --preset release
    python3 bench/load/load.py
"""
import argparse
import dataclasses
import json
import os
import pathlib
import subprocess
import sys
import time

import load_scenes as make

ROOT = pathlib.Path(__file__).resolve().parents[2]
SKY = ["--environment", str(ROOT / "scenes/sky.exr")]
FRAME = ["--size", "512x512", "--spp", "4"]
LARGE = ["--size", "7680x4320", "--spp", "1"]
PATH, CACHE = ["--method", "path"], ["--method", "cache"]
SMALL = FRAME + PATH


@dataclasses.dataclass(frozen=True)
class Case:
    """`scene` is a file, or makes one at the path it gets; `options` are the command's."""
    name: str
    scene: object
    options: list

    def file(self, path: pathlib.Path) -> pathlib.Path:
        """Made in a process of its own: its peak of memory would count for the command that this one begins."""
        if isinstance(self.scene, pathlib.Path):
            return self.scene
        child = os.fork()
        if child == 0:
            self.scene(path)
            os._exit(0)
        if os.waitpid(child, 0)[1] != 0:
            raise SystemExit(f"{self.name}: the scene was not made")
        return path


def cases(shrink: int) -> list:
    million = 1_000_000 // shrink
    cornell = ROOT / "scenes/cornell.glb"
    lamps = lambda path: make.lamps(path, 10_000 // shrink)
    textures = lambda path: make.textures(path, 500 // shrink, 1024)
    return [
        Case("10 million triangles, one mesh", lambda path: make.triangles(path, 10 * million), SKY + SMALL),
        Case("10 million, 100 placements", lambda path: make.instances(path, 100, million // 10), SKY + SMALL),
        Case("10 million, 10,000 placements", lambda path: make.instances(path, 10_000, million // 1000), SKY + SMALL),
        Case("2,000 materials", lambda path: make.materials(path, 2_000 // shrink), SKY + SMALL),
        Case("500 textures of 1024²", textures, SKY + SMALL),
        Case("500 textures, --texture-limit 256M", textures, SKY + SMALL + ["--texture-limit", "256M"]),
        Case("500 textures, --memory-limit 1G", textures, SKY + SMALL + ["--memory-limit", "1G"]),
        Case("10,000 lamps, path", lamps, SMALL),
        Case("10,000 lamps, cache", lamps, FRAME + CACHE),
        Case("picture of 7680 × 4320, path", cornell, LARGE + PATH),
        Case("picture of 7680 × 4320, cache", cornell, LARGE + CACHE),
        Case("picture of 7680 × 4320, all layers", cornell, LARGE + PATH + ["--aov",
                                                            "albedo,normal,position,depth,material_id,variance"]),
    ]


def run(case: Case, program: pathlib.Path, folder: pathlib.Path) -> dict:
    """Renders in a process of its own, whose peak is the case's alone."""
    begin = time.monotonic()
    scene = case.file(folder / "scene.glb")
    made = time.monotonic() - begin
    stats = folder / "stats.json"
    command = ["render", str(scene), "-o", str(folder / "picture.exr"), "--quiet", "--stats", str(stats), *case.options]
    begin = time.monotonic()
    child = subprocess.Popen([str(program), *command], stderr=subprocess.PIPE, text=True)
    message = child.stderr.read()
    _, status, usage = os.wait4(child.pid, 0)
    wall = time.monotonic() - begin
    row = {"name": case.name, "command": command, "exit_code": os.waitstatus_to_exitcode(status), "made": made,
           "wall": wall, "cpu": usage.ru_utime + usage.ru_stime, "peak": usage.ru_maxrss * 1024, "file": scene.stat().st_size, "message": message.strip()}
    if row["exit_code"] == 0:
        row["stats"] = json.loads(stats.read_text())
    return row


def seconds_of(row: dict) -> tuple:
    """Loading (with what comes before and after the render), building, rendering."""
    stages = row["stats"]["stage_seconds"]
    build = stages.get("build", 0) + stages.get("lights", 0)
    return row["wall"] - row["stats"]["total_seconds"], build, row["stats"]["total_seconds"] - build


def table(rows: list) -> str:
    lines = ["| | file, MB | load and write, s | build, s | render, s | CPU, s | peak, MB |",
             "|---|---|---|---|---|---|---|"]
    for row in rows:
        size = f"{row['file'] / 1e6:.1f}"
        if row["exit_code"] != 0:
            lines.append(f"| {row['name']} | {size} | exit code {row['exit_code']}: {row['message']} | | | "
                         f"{row['cpu']:.1f} | {row['peak'] / 1e6:.0f} |")
            continue
        times = " | ".join(f"{seconds:.2f}" for seconds in seconds_of(row))
        lines.append(f"| {row['name']} | {size} | {times} | {row['cpu']:.1f} | {row['peak'] / 1e6:.0f} |")
    return "\n".join(lines) + "\n"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=pathlib.Path, default=ROOT / "build/release/relumine")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "out/load")
    parser.add_argument("--shrink", type=int, default=1, help="scenes smaller by this factor, to see that all runs")
    parser.add_argument("--only", default="", help="cases whose name holds this")
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    rows = []
    for case in cases(arguments.shrink):
        if arguments.only not in case.name:
            continue
        rows.append(run(case, arguments.program, arguments.out))
        print(table(rows[-1:]).splitlines()[-1], flush=True)
    (arguments.out / "load.json").write_text(json.dumps(rows, indent=2))
    (arguments.out / "load.md").write_text(table(rows))
    return 0 if all(row["exit_code"] == 0 for row in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
