# SPDX-License-Identifier: Apache-2.0
"""Runs `relumine render` and hands back the picture, the statistics and the times."""
import dataclasses
import json
import pathlib
import resource
import subprocess

import numpy as np

import pictures

NOT_MEASURED = ("build", "lights")  # stages before the first ray; every method has them alike
BAD_USAGE = 2  # exit code: an option or a method that this build does not have

Options = dict[str, str | int | float]  # an option without a value has ""


class Refused(Exception):
    """The command does not know a method or an option; the text is its own message."""


class Failed(SystemExit):
    """The command ended with any other exit code, or by a signal; ends the program unless it is caught."""


@dataclasses.dataclass(frozen=True)
class Run:
    """One render. Seconds; `cpu` is user + system of all threads."""
    picture: np.ndarray
    stats: dict
    process_cpu: float  # of the whole process, with loading the scene and writing the picture

    @property
    def wall(self) -> float:
        """Wall-clock time of all stages but those that build the scene."""
        stages = self.stats["stage_seconds"]
        return sum(seconds for stage, seconds in stages.items() if stage not in NOT_MEASURED)

    @property
    def cpu(self) -> float:
        """CPU time of the same stages: all stages share the render's CPU time by their wall-clock time."""
        return self.stats["cpu_seconds"] * self.wall / max(self.stats["total_seconds"], 1e-9)


@dataclasses.dataclass(frozen=True)
class View:
    """What is rendered: a scene under an environment (None: its own), turned by `env_rotate` degrees."""
    scene: pathlib.Path
    environment: pathlib.Path | None
    env_rotate: float
    width: int
    height: int
    extra: Options = dataclasses.field(default_factory=dict)  # what it needs beyond PAPER_SETTINGS
    bands: tuple[tuple[int, int], ...] = ()  # rows [first, last) that are looked at; none: all

    def rows(self) -> list[int]:
        """The rows of the bands, or all."""
        return [y for first, last in self.bands or ((0, self.height),) for y in range(first, last)]

    def whole(self) -> "View":
        """The same without bands."""
        return dataclasses.replace(self, bands=())

    def options(self) -> Options:
        lit: Options = {}
        if self.environment:
            lit = {"environment": str(self.environment), "env-rotate": self.env_rotate}
        return {**lit, "size": f"{self.width}x{self.height}", **self.extra}


# One ray through the middle of each pixel; a secondary ray brings back the environment, or black from a surface.
PAPER_SETTINGS: Options = {"spp": 1, "pixel-sampling": "center", "radiance": "emission"}


class Relumine:
    def __init__(self, program: pathlib.Path, scratch: pathlib.Path):
        self.program, self.scratch = program, scratch

    def version(self) -> str:
        return subprocess.run([self.program, "--version"], stdout=subprocess.PIPE, text=True, check=True).stdout.strip()

    def render(self, view: View, options: Options, seed: int, threads: int) -> Run:
        """Raises Refused where the command lacks what `options` ask for, Failed where it ends otherwise than well.

        Of a view with bands these alone, one below the other; statistics are then what the whole would come to.
        """
        if view.bands:
            crops = [{"crop": (0, first, view.width, last)} for first, last in view.bands]
            runs = [self._run(view.whole(), {**options, **crop}, seed, threads) for crop in crops]
            return stacked(runs, view.height / len(view.rows()))
        return self._run(view, options, seed, threads)

    def _run(self, view: View, options: dict, seed: int, threads: int) -> Run:
        picture, stats = self.scratch / "picture.pfm", self.scratch / "stats.json"
        every = {**PAPER_SETTINGS, **view.options(), **options, "seed": seed, "threads": threads, "stats": stats}
        command = [str(self.program), "render", str(view.scene), "-o", str(picture), "--quiet"]
        for key, value in every.items():
            values = value if isinstance(value, tuple) else (value,)
            command += [word for word in (f"--{key}", *map(str, values)) if word]
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        done = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        if done.returncode == BAD_USAGE:
            raise Refused(done.stderr.strip())
        if done.returncode != 0:
            raise Failed(f"{' '.join(command)}\n{done.stderr.strip()}\nexit code {done.returncode}")
        cpu = after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime
        return Run(pictures.read_pfm(picture), json.loads(stats.read_text()), cpu)

    def surfaces(self, view: View, white: pathlib.Path) -> np.ndarray:
        """True where a pixel's ray meets a surface: under a white sky, without scattering, the others show 1."""
        under_white = dataclasses.replace(view, environment=white, env_rotate=0.0)
        run = self.render(under_white, {"method": "path", "max-depth": 0, "radiance": "auto"}, seed=0, threads=0)
        return run.picture.max(axis=2) < 0.5


def stacked(runs: list[Run], scale: float) -> Run:
    """Bands of a picture as one run; times and counts are sums times `scale`."""
    stats = scaled_sum([run.stats for run in runs], scale)
    stats["peak_memory_bytes"] = max(run.stats["peak_memory_bytes"] for run in runs)
    return Run(np.concatenate([run.picture for run in runs]), stats, scale * sum(run.process_cpu for run in runs))


def scaled_sum(every: list[dict], scale: float) -> dict:
    """Of numbers under the same keys, which not all need to have; other values are the first's."""
    result: dict = {}
    for key in dict.fromkeys(key for one in every for key in one):
        values = [one[key] for one in every if key in one]
        if isinstance(values[0], dict):
            result[key] = scaled_sum(values, scale)
        elif isinstance(values[0], (int, float)) and not isinstance(values[0], bool):
            result[key] = scale * sum(values)
        else:
            result[key] = values[0]
    return result


def looked_up(stats: dict, name: str) -> float | None:
    """The number under a dotted name, or None where these statistics have none."""
    value: object = stats
    for key in name.split("."):
        if not isinstance(value, dict) or key not in value:
            return None
        value = value[key]
    return value if isinstance(value, (int, float)) else None
