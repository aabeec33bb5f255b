# SPDX-License-Identifier: Apache-2.0
"""Line charts as SVG, written by hand: log-log panels in rows with one legend."""
import dataclasses
import math
from xml.sax.saxutils import escape

COLOURS = ("#1f77b4", "#d95f02", "#1b9e77", "#c2185b", "#7570b3", "#8a6d00", "#444444", "#00838f",
           "#e6ab02", "#999999", "#6d4c41", "#64dd17")
WIDTH, HEIGHT = 380, 260  # of a panel, pixels
LEFT, RIGHT, TOP, BOTTOM = 62, 14, 30, 44
LEGEND_LINE = 18
MOST_VALUES = 8  # along x; if there are more, round numbers stand there instead


@dataclasses.dataclass
class Panel:
    title: str
    x_label: str
    y_label: str
    lines: dict[str, list[tuple[float, float]]]  # name -> points; all numbers above 0


def chart(panels: list[Panel], columns: int = 4) -> str:
    names = list(dict.fromkeys(name for panel in panels for name in panel.lines))
    colours = {name: COLOURS[i % len(COLOURS)] for i, name in enumerate(names)}
    below = HEIGHT * -(-len(panels) // columns)
    width, height = WIDTH * min(len(panels), columns), below + LEGEND_LINE * ((len(names) + 2) // 3) + 10
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" '
             f'viewBox="0 0 {width} {height}" font-family="sans-serif" font-size="11">',
             f'<rect width="{width}" height="{height}" fill="white"/>']
    for i, panel in enumerate(panels):
        parts += [f'<g transform="translate({i % columns * WIDTH} {i // columns * HEIGHT})">', *_panel(panel, colours), "</g>"]
    for i, name in enumerate(names):
        x, y = LEFT + (i % 3) * (width - LEFT) / 3, below + 12 + LEGEND_LINE * (i // 3)
        parts.append(f'<line x1="{x:.1f}" y1="{y - 4}" x2="{x + 18:.1f}" y2="{y - 4}" stroke="{colours[name]}" '
                     f'stroke-width="2"/><text x="{x + 24:.1f}" y="{y}">{escape(name)}</text>')
    return "\n".join([*parts, "</svg>"]) + "\n"


def _panel(panel: Panel, colours: dict[str, str]) -> list[str]:
    points = [p for line in panel.lines.values() for p in line]
    (x_low, x_high), (y_low, y_high) = (_padded([p[axis] for p in points]) for axis in range(2))

    def x_at(x: float) -> float:
        return LEFT + (WIDTH - LEFT - RIGHT) * (math.log(x) - x_low) / (x_high - x_low)

    def y_at(y: float) -> float:
        return HEIGHT - BOTTOM - (HEIGHT - TOP - BOTTOM) * (math.log(y) - y_low) / (y_high - y_low)

    parts = [f'<text x="{LEFT}" y="18" font-size="13">{escape(panel.title)}</text>',
             f'<text x="{(LEFT + WIDTH) / 2}" y="{HEIGHT - 8}" text-anchor="middle">{escape(panel.x_label)}</text>',
             f'<text transform="translate(14 {HEIGHT / 2}) rotate(-90)" text-anchor="middle">'
             f'{escape(panel.y_label)}</text>',
             f'<rect x="{LEFT}" y="{TOP}" width="{WIDTH - LEFT - RIGHT}" height="{HEIGHT - TOP - BOTTOM}" fill="none" '
             'stroke="#999"/>']
    at = sorted({p[0] for p in points})
    for x in at if len(at) <= MOST_VALUES else _ticks(x_low, x_high):
        parts.append(f'<text x="{x_at(x):.1f}" y="{HEIGHT - BOTTOM + 14}" text-anchor="middle">{x:g}</text>')
    for y in _ticks(y_low, y_high):
        parts.append(f'<line x1="{LEFT}" x2="{WIDTH - RIGHT}" y1="{y_at(y):.1f}" y2="{y_at(y):.1f}" stroke="#ddd"/>'
                     f'<text x="{LEFT - 5}" y="{y_at(y) + 4:.1f}" text-anchor="end">{y:g}</text>')
    for name, line in panel.lines.items():
        path = " ".join(f"{x_at(x):.1f},{y_at(y):.1f}" for x, y in line)
        parts.append(f'<polyline points="{path}" fill="none" stroke="{colours[name]}" stroke-width="2"/>')
        parts += [f'<circle cx="{x_at(x):.1f}" cy="{y_at(y):.1f}" r="3" fill="{colours[name]}"/>' for x, y in line]
    return parts


def _padded(values: list[float]) -> tuple[float, float]:
    """Logarithms of a range that holds all values with some room."""
    low, high = math.log(min(values)), math.log(max(values))
    room = max(0.08 * (high - low), 0.15)
    return low - room, high + room


def _ticks(low: float, high: float) -> list[float]:
    """Round numbers between exp(low) and exp(high)."""
    first, last = math.floor(low / math.log(10)), math.ceil(high / math.log(10))
    wide = high - low > math.log(100)
    return [m * 10.0**e for e in range(first, last + 1) for m in ((1,) if wide else (1, 2, 3, 5, 7))
            if low <= math.log(m * 10.0**e) <= high]
