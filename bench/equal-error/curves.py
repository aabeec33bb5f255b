# SPDX-License-Identifier: Apache-2.0
"""Cost at equal error: frontiers of measured points, interpolated in log error - log cost, and their ratios."""
import dataclasses
import math
from collections.abc import Iterable

Point = tuple[float, float]  # cost, error; both above 0

EXACT, AT_MOST, MORE_THAN = "=", "<=", ">"


@dataclasses.dataclass(frozen=True)
class Bound:
    """A cost or a ratio of costs, or what it lies below or above."""
    value: float
    kind: str = EXACT

    def __str__(self) -> str:
        sign = {EXACT: "", AT_MOST: "≤ ", MORE_THAN: "> "}[self.kind]
        return f"{sign}{self.value:.3g}"


def frontier(points: Iterable[Point]) -> list[Point]:
    """The points that no other undercuts in both cost and error: rising cost, falling error."""
    best: list[Point] = []
    for cost, error in sorted(points):
        if not best or error < best[-1][1]:
            best.append((cost, error))
    return best


def cost_at(points: Iterable[Point], error: float) -> Bound | None:
    """What it costs to reach `error`; straight lines between the frontier's points in log-log; None without points.

    Nothing is extrapolated: coarser than the cheapest point gives at most its cost, finer than the best more than its.
    """
    line = frontier(points)
    if not line:
        return None
    if error >= line[0][1]:
        return Bound(line[0][0], EXACT if error == line[0][1] else AT_MOST)
    if error < line[-1][1]:
        return Bound(line[-1][0], MORE_THAN)
    for (cost_a, error_a), (cost_b, error_b) in zip(line, line[1:]):
        if error >= error_b:
            t = math.log(error_a / error) / math.log(error_a / error_b)
            return Bound(math.exp((1 - t) * math.log(cost_a) + t * math.log(cost_b)))
    raise AssertionError("a frontier's errors fall")


def cheapest(costs: dict[str, Bound | None]) -> tuple[str, Bound] | None:
    """The method that costs least. Where none reaches the error, the least that all of them exceed."""
    there = {name: cost for name, cost in costs.items() if cost}
    reached = {name: cost for name, cost in there.items() if cost.kind != MORE_THAN}
    if not there:
        return None
    return min((reached or there).items(), key=lambda item: item[1].value)


def ratio(rival: Bound | None, ours: Bound | None) -> Bound | None:
    """Rival's cost over ours. None where ours is unknown, does not reach the error, or the two bounds contradict."""
    if not rival or not ours or ours.kind == MORE_THAN:
        return None
    upper = rival.kind == AT_MOST  # the true ratio is at most this
    lower = rival.kind == MORE_THAN or ours.kind == AT_MOST  # at least this
    if upper and lower:
        return None
    kind = AT_MOST if upper else MORE_THAN if lower else EXACT
    return Bound(rival.value / ours.value, kind)


def geometric_mean(ratios: Iterable[Bound | None]) -> Bound | None:
    """Of those that are known; a bound as soon as one of them is; None if bounds contradict or nothing is known."""
    known = [r for r in ratios if r]
    kinds = {r.kind for r in known} - {EXACT}
    if not known or len(kinds) > 1:
        return None
    value = math.exp(sum(math.log(r.value) for r in known) / len(known))
    return Bound(value, kinds.pop() if kinds else EXACT)
