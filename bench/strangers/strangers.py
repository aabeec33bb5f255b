#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Worlds that no constant was chosen on: how far off is a method, and is it bias or noise? A row of Markdown for each.

References are two pictures by `path`, kept in --out; what they differ by is their own error. Each world is rendered
twice, with two seeds: what both renders have in common, less what the reference explains, is bias.
"""
import argparse
import dataclasses
import pathlib
import shlex
import sys
from collections.abc import Iterator

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "bench" / "common"))
import environments  # noqa: E402  (after the path)
import metrics  # noqa: E402
import pictures  # noqa: E402
from command import Options, Relumine, View  # noqa: E402

from worlds import WORLDS, World  # noqa: E402

SEEDS = (1, 2)
REFERENCE_SEEDS = (1_000_001, 1_000_002)
LEAST = 0.02  # against the mean of the picture: darker blocks count as if they were so bright
HEADER = """| world | mean | relative L1 | 95 % of blocks | blocks, rms | in common | noise | reference's own | worst, in common | CPU s |
|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|"""


def arguments() -> argparse.Namespace:
    names = [world.name for world in WORLDS]
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--relumine", type=pathlib.Path, default=ROOT / "build" / "release" / "relumine")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "out" / "strangers")
    parser.add_argument("--worlds", default=",".join(names), help="separated by commas (default: %(default)s)")
    parser.add_argument("--scene", type=pathlib.Path, help="a file instead of the worlds")
    parser.add_argument("--environment", type=pathlib.Path, help="that --scene is under (default: its own)")
    parser.add_argument("--method", default="cache", help="and further options; several separated by | are a row each "
                        "(default: %(default)s)")
    parser.add_argument("--size", type=size_of, default=(128, 128), metavar="N|WxH", help="pixels (default: 128)")
    parser.add_argument("--block", type=int, default=16, help="pixels along each side of one (default: %(default)s)")
    parser.add_argument("--spp", type=int, default=16, help="(default: %(default)s)")
    parser.add_argument("--reference-spp", type=int, default=2048, help="of each half (default: %(default)s)")
    parser.add_argument("--threads", type=int, default=0, help="0: all (default)")
    parser.add_argument("--pictures", action="store_true", help="writes reference, render and signed error as PNG")
    return parser.parse_args()


def size_of(text: str) -> tuple[int, int]:
    width, _, height = text.partition("x")
    return int(width), int(height or width)


def options_of(text: str) -> Options:
    """`cache --error 0.04` as options; a word that follows none is the value of the option before it."""
    found: Options = {}
    name = "method"
    for word in shlex.split(text):
        if word.startswith("--"):
            name = word[2:]
            found[name] = ""
        else:
            found[name] = word
    return found


@dataclasses.dataclass(frozen=True)
class Case:
    """One of the worlds, or the given scene."""
    name: str
    view: View
    noisy: int = 1


EXTRA: Options = {"pixel-sampling": "jitter", "radiance": "auto"}


def world_case(world: World, args: argparse.Namespace) -> Case:
    file, sky = args.out / f"{world.name}.glb", args.out / "sky.pfm"
    world.write(file)
    return Case(world.name, View(file, sky if world.sky else None, world.env_rotate, *args.size, EXTRA), world.noisy)


def scene_case(args: argparse.Namespace) -> Case:
    files = [args.scene] + ([args.environment] if args.environment else [])
    return Case("-".join(file.stem for file in files), View(args.scene, args.environment, 0, *args.size, EXTRA))


def cases(args: argparse.Namespace) -> Iterator[Case]:
    if args.scene:
        yield scene_case(args)
        return
    wanted = args.worlds.split(",")
    unknown = set(wanted) - {world.name for world in WORLDS}
    if unknown:
        raise SystemExit(f"--worlds: unknown {', '.join(sorted(unknown))}")
    pictures.write_pfm(args.out / "sky.pfm", environments.smooth_sky(environments.directions(512, 256)))
    yield from (world_case(world, args) for world in WORLDS if world.name in wanted)


def references(relumine: Relumine, case: Case, args: argparse.Namespace) -> list[np.ndarray]:
    """Two independent pictures."""
    halves, spp = [], case.noisy * args.reference_spp
    width, height = args.size
    size = f"{width}" if width == height else f"{width}x{height}"
    for seed in REFERENCE_SEEDS:
        file = args.out / f"{case.name}-{size}-{spp}-{seed}.pfm"
        if not file.exists():
            print(f"{file.name}: rendering", file=sys.stderr, flush=True)
            options: Options = {"method": "path", "spp": spp}
            pictures.write_pfm(file, relumine.render(case.view, options, seed, args.threads).picture)
        halves.append(pictures.read_pfm(file))
    return halves


def block_means(picture: np.ndarray, side: int) -> np.ndarray:
    """Of the three channels together, by block of side × side pixels."""
    rows, columns = picture.shape[0] // side, picture.shape[1] // side
    whole = picture[:rows * side, :columns * side].mean(axis=2)
    return whole.reshape(rows, side, columns, side).mean(axis=(1, 3))


@dataclasses.dataclass(frozen=True)
class BlockErrors:
    """Relative errors of block means, of two renders against the mean of two references."""
    each: np.ndarray  # by render, row, column
    reference: float  # rms of what the mean of the references is off by

    @property
    def common(self) -> np.ndarray:
        return self.each.mean(axis=0)

    @property
    def noise(self) -> float:
        """rms of what a single render adds to what both have in common."""
        return float(np.sqrt(np.square(self.each[0] - self.each[1]).mean() / 2))

    @property
    def bias(self) -> float:
        """rms of what both have in common, without the reference's part: the mean product of the two errors."""
        return float(np.sqrt(max(0.0, (self.each[0] * self.each[1]).mean() - self.reference**2)))


def block_errors(renders: list[np.ndarray], halves: list[np.ndarray], side: int) -> BlockErrors:
    half_a, half_b = (block_means(half, side) for half in halves)
    wanted = (half_a + half_b) / 2
    level = np.maximum(wanted, LEAST * wanted.mean())
    each = np.stack([(block_means(render, side) - wanted) / level for render in renders])
    return BlockErrors(each, float(np.sqrt(np.square((half_a - half_b) / 2 / level).mean())))


def row(name: str, renders: list[np.ndarray], halves: list[np.ndarray], side: int, cpu: float) -> str:
    wanted = (halves[0] + halves[1]) / 2
    keep = np.ones(wanted.shape[:2], bool)
    found = metrics.average([metrics.errors(render, wanted, keep) for render in renders])
    blocks = block_errors(renders, halves, side)
    y, x = np.unravel_index(np.abs(blocks.common).argmax(), blocks.common.shape)
    return (f"| {name} | {1 + found.signed:.3f} | {found.l1:.1%} | {np.quantile(np.abs(blocks.each), 0.95):.1%} "
            f"| {np.sqrt(np.square(blocks.each).mean()):.2%} | {blocks.bias:.2%} | {blocks.noise:.2%} "
            f"| {blocks.reference:.2%} | {blocks.common[y, x]:+.1%} at {x}, {y} | {cpu:.1f} |")


def write_pictures(folder: pathlib.Path, name: str, renders: list[np.ndarray], halves: list[np.ndarray]) -> None:
    wanted, mean = (halves[0] + halves[1]) / 2, sum(renders) / len(renders)
    stops = pictures.exposure_for(wanted)
    signed = (mean - wanted) / np.maximum(wanted, LEAST * wanted.mean()) * wanted.mean()
    keep = np.ones(wanted.shape[:2], bool)
    error = pictures.signed_error(wanted + signed, wanted, keep, full_scale=0.2)
    page = pictures.sheet([[(text, pictures.enlarged(picture)) for text, picture in
                            (("path", pictures.to_srgb(wanted, stops)), (name, pictures.to_srgb(mean, stops)),
                             ("relative, red too bright, +-20 %", error))]])
    pictures.write_png(folder / f"{name}.png", page)


def measure(relumine: Relumine, case: Case, args: argparse.Namespace) -> None:
    halves = references(relumine, case, args)
    methods = args.method.split("|")
    for method in methods:
        options = options_of(method) | {"spp": args.spp}
        runs = [relumine.render(case.view, options, seed, args.threads) for seed in SEEDS]
        renders = [run.picture for run in runs]
        cpu = sum(run.stats["cpu_seconds"] for run in runs) / len(runs)
        name = case.name if len(methods) == 1 else f"{case.name}: `{method.strip()}`"
        print(row(name, renders, halves, args.block, cpu), flush=True)
        if args.pictures:
            write_pictures(args.out, case.name, renders, halves)


def main() -> None:
    args = arguments()
    args.out.mkdir(parents=True, exist_ok=True)
    relumine = Relumine(args.relumine, args.out)
    print(HEADER)
    for case in cases(args):
        measure(relumine, case, args)


if __name__ == "__main__":
    main()
