# SPDX-License-Identifier: Apache-2.0
"""Converged pictures, kept on disk: two independent halves of `gather` passes, so that they tell their own error."""
import dataclasses
import hashlib
import json
import pathlib
from collections.abc import Callable

import numpy as np

import metrics
from command import Options, Relumine, View

FIRST_SEED = 1_000_001  # far from the seeds of what is measured
SCHEME = 1  # to be raised when references on disk must not be used any more


def digest(path: pathlib.Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()[:16]


@dataclasses.dataclass
class Reference:
    """Sums of passes: even passes in half A, odd ones in half B; always as many in each."""
    halves: list[np.ndarray]
    passes: int

    @property
    def picture(self) -> np.ndarray:
        return sum(self.halves) / self.passes

    def error(self, keep: np.ndarray) -> metrics.Errors:
        """Estimated from what the halves differ by."""
        a, b = (half / (self.passes / 2) for half in self.halves)
        return metrics.error_of_mean(a, b, keep)


class References:
    """`gather` whose bright light is also sampled directly: the integrand of all methods."""

    def __init__(self, relumine: Relumine, folder: pathlib.Path, rays: int, light_samples: int, max_passes: int,
                 log: Callable[[str], None], sampler: str = "stratified"):
        self.relumine, self.folder, self.max_passes, self.log = relumine, folder, max_passes, log
        self.options: Options = {"method": "gather", "sampler": sampler, "gather-rays": rays,
                                 "light-samples": light_samples}
        folder.mkdir(parents=True, exist_ok=True)

    def rays_per_pixel(self, reference: Reference) -> int:
        return reference.passes * (int(self.options["gather-rays"]) + int(self.options["light-samples"]))

    def get(self, view: View) -> Reference:
        """What is on disk, or a first pass for each half."""
        file = self._file(view)
        if file.exists():
            with np.load(file) as stored:
                return Reference([stored["a"], stored["b"]], int(stored["passes"]))
        return self._with_another_pair(view, None)

    def refine(self, view: View, keep: np.ndarray, goal: metrics.Errors) -> tuple[Reference, bool]:
        """Adds passes until the estimated L1 and rms errors are at most `goal`; whether they are."""
        reference = self.get(view)
        while True:
            error = reference.error(keep)
            if error.l1 <= goal.l1 and error.rms <= goal.rms:
                return reference, True
            if reference.passes + 2 > self.max_passes:
                return reference, False
            self.log(f"    reference: L1 {error.l1:.3%} (goal {goal.l1:.3%}), rms {error.rms:.3%} "
                     f"(goal {goal.rms:.3%}) after {reference.passes} passes")
            reference = self._with_another_pair(view, reference)

    def _with_another_pair(self, view: View, reference: Reference | None) -> Reference:
        passes = reference.passes if reference else 0
        halves = []
        for half in range(2):
            picture = self.relumine.render(view, self.options, FIRST_SEED + passes + half, threads=0).picture
            halves.append(picture + reference.halves[half] if reference else picture)
        result = Reference(halves, passes + 2)
        file = self._file(view)
        beside = file.with_suffix(".new.npz")
        np.savez(beside, a=halves[0], b=halves[1], passes=result.passes)
        beside.replace(file)
        return result

    def _file(self, view: View) -> pathlib.Path:
        light = digest(view.environment) if view.environment else None
        size = view.width if view.width == view.height else f"{view.width}x{view.height}"
        parts = [view.bands] if view.bands else []
        what = [SCHEME, digest(view.scene), light, view.env_rotate, size, {**view.extra, **self.options}, *parts]
        key = hashlib.sha256(json.dumps(what, sort_keys=True).encode()).hexdigest()[:10]
        name = "-".join([view.scene.stem, *([view.environment.stem] if view.environment else [])])
        return self.folder / f"{name}-{size}-{key}.npz"
