# SPDX-License-Identifier: Apache-2.0
"""Errors of a picture against a reference, and the speed-ups that follow from times and errors."""
import dataclasses
import math
import statistics

import numpy as np


@dataclasses.dataclass(frozen=True)
class Errors:
    """Over the pixels kept and all three channels; relative to the reference's mean, so without a unit."""
    l1: float  # sum |L - R| / sum R: the paper's measure
    rms: float  # sqrt(mean (L - R)^2) / mean R
    signed: float  # sum (L - R) / sum R: above 0 too bright
    maximum: float  # max |L - R| / mean R


def errors(picture: np.ndarray, reference: np.ndarray, keep: np.ndarray) -> Errors:
    """`keep`: height x width, true where a pixel counts."""
    if picture.shape != reference.shape:
        raise ValueError(f"expected a picture of shape {reference.shape}, found {picture.shape}")
    wanted = reference[keep]
    difference = picture[keep] - wanted
    mean = wanted.mean()
    return Errors(l1=float(np.abs(difference).mean() / mean), rms=float(np.sqrt((difference**2).mean()) / mean),
                  signed=float(difference.mean() / mean), maximum=float(np.abs(difference).max() / mean))


def average(every: list[Errors]) -> Errors:
    """Means over seeds; of the root mean squares the root of the mean square."""
    return Errors(l1=statistics.fmean(e.l1 for e in every),
                  rms=math.sqrt(statistics.fmean(e.rms**2 for e in every)),
                  signed=statistics.fmean(e.signed for e in every),
                  maximum=statistics.fmean(e.maximum for e in every))


def spread(every: list[Errors]) -> Errors | None:
    """Standard deviations from seed to seed, of which there must be two or more."""
    if len(every) < 2:
        return None
    return Errors(*(statistics.stdev(values) for values in zip(*map(dataclasses.astuple, every))))


def error_of_mean(half_a: np.ndarray, half_b: np.ndarray, keep: np.ndarray) -> Errors:
    """What (A + B) / 2 is off by, from two independent, equally noisy halves: half of what A and B differ by.

    Holds for the L1 and the rms error: the noise of A - B has twice the standard deviation of that of (A + B) / 2.
    """
    mean = (half_a + half_b) / 2
    e = errors(half_a, half_b, keep)
    scale = half_b[keep].mean() / mean[keep].mean() / 2
    return Errors(*(scale * value for value in dataclasses.astuple(e)))


def block_error(picture: np.ndarray, reference: np.ndarray, keep: np.ndarray, side: int = 16) -> float:
    """Relative L1 of the means of side x side pixels, of those kept alone; blocks weigh as many pixels as they keep.

    Noise averages out in it, so it shows what does not: bias, and blotches as large as a block.
    """
    height, width = keep.shape
    rows, columns = np.arange(0, height, side), np.arange(0, width, side)
    kept = np.where(keep[:, :, None], picture - reference, 0.0)
    sums = np.add.reduceat(np.add.reduceat(kept, rows, axis=0), columns, axis=1)
    return float(np.abs(sums).sum() / reference[keep].sum())


def raw_speed_up(baseline_seconds: float, seconds: float) -> float:
    return baseline_seconds / seconds


def squared_error_ratio(baseline_error: float, error: float) -> float:
    """The paper's Table 2 for its unbiased method: (e_gather / e_mc)^2, as if both took the same time."""
    return (baseline_error / error)**2


def equal_error_speed_up(baseline_seconds: float, seconds: float, baseline_error: float, error: float) -> float:
    """Time ratio at equal error if the baseline's error falls as 1/sqrt(time), as that of Monte Carlo does."""
    return raw_speed_up(baseline_seconds, seconds) * squared_error_ratio(baseline_error, error)


def control_rays(seconds: float, gather_seconds: float, gather_rays: int) -> int:
    """Gather rays per pixel that take `seconds` if `gather_rays` take `gather_seconds`; a multiple of 16 (a packet)."""
    return max(16, 16 * round(gather_rays * seconds / gather_seconds / 16))
