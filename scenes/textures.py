# SPDX-License-Identifier: CC0-1.0
"""Small pictures for the demo scene, as palette PNGs that repeat without a seam."""

import math
import random

from glb import png


def wood():
    """1024 × 128 for 1.6 m × 0.16 m of oak, the grain along x."""
    width, height = 1024, 128
    broad, warp, fine = Noise(1, 4, 8), Noise(2, 8, 4), Noise(3, 64, 128)
    pixels = []
    for y in range(height):
        for x in range(width):
            u, v = x / width, y / height
            rings = 0.5 + 0.5 * math.sin(2 * math.pi * (5 * v + 1.6 * warp(u, v) + 1.5 * broad(u, v)))
            tone = 0.50 + 0.22 * (rings ** 1.5 - 0.4) + 0.22 * (broad(u, v) - 0.5) + 0.34 * (fine(u, v) - 0.5)
            pixels.append(tone)
    return graded(width, height, pixels, (92, 56, 30), (208, 158, 106), 40)


def linen():
    """256 × 32: pale weave with three blue stripes along y at either side."""
    width, height = 256, 32
    chance = random.Random(5)
    stripes = [(0.06, 0.085), (0.10, 0.16), (0.175, 0.2)]
    pixels = []
    for _ in range(height):
        for x in range(width):
            side = min(x + 0.5, width - x - 0.5) / width
            blue = any(low < side < high for low, high in stripes)
            pixels.append(8 * blue + chance.randrange(8))
    shades = [0.90 + 0.10 * i / 7 for i in range(8)]
    palette = [
        tuple(round(c * s) for c in colour) for colour in ((224, 216, 200), (58, 82, 122)) for s in shades
    ]
    return png(width, height, pixels, palette)


def lemon():
    """96 × 96: a cut lemon, ten segments; its rim is at 0.475 of the width."""
    size, segments = 96, 10
    chance = random.Random(4)
    peel, pith, flesh = (232, 184, 30), (252, 242, 205), (246, 206, 84)
    palette = [tuple(round(mix(a, b, i / 15)) for a, b in zip(flesh, pith)) for i in range(16)] + [peel]
    pixels = []
    for y in range(size):
        for x in range(size):
            dx, dy = (x + 0.5) / size - 0.5, (y + 0.5) / size - 0.5
            radius = math.hypot(dx, dy) / 0.475
            sector = math.atan2(dy, dx) / (2 * math.pi) * segments % 1
            wall = min(sector,
                       1 - sector) * 2 * math.pi / segments * radius  # to the nearest wall between segments
            pithy = 1 - ease(
                max(0.0, min(1.0, min(wall / 0.05, (0.86 - radius) / 0.06, (radius - 0.07) / 0.05))))
            tone = max(pithy, 0.35 * chance.random())
            pixels.append(16 if radius > 0.95 else round(15 * tone))
    return png(size, size, pixels, palette)


def pages():
    """64 × 1: the edges of a book's pages."""
    chance = random.Random(9)
    return graded(64, 1, [chance.random() for _ in range(64)], (176, 160, 130), (232, 222, 200), 16)


class Noise:
    """Smooth random values in [0, 1] on a periodic lattice of columns × rows over the unit square."""

    def __init__(self, seed, columns, rows):
        chance = random.Random(seed)
        self.columns, self.rows = columns, rows
        self.lattice = [[chance.random() for _ in range(columns)] for _ in range(rows)]

    def __call__(self, u, v):
        x, y = u * self.columns, v * self.rows
        column, row = int(x), int(y)
        s, t = ease(x - column), ease(y - row)
        low, high = self.lattice[row % self.rows], self.lattice[(row + 1) % self.rows]
        left, right = column % self.columns, (column + 1) % self.columns
        return mix(mix(low[left], low[right], s), mix(high[left], high[right], s), t)


def graded(width, height, tones, dark, light, steps):
    """A PNG of tones in [0, 1], from one colour to another."""
    palette = [tuple(round(mix(a, b, i / (steps - 1))) for a, b in zip(dark, light)) for i in range(steps)]
    return png(width, height, [max(0, min(steps - 1, int(tone * steps))) for tone in tones], palette)


def ease(t):
    return t * t * (3 - 2 * t)


def mix(a, b, t):
    return a + (b - a) * t
