# SPDX-License-Identifier: Apache-2.0
"""Lat-long environments made by formula: a smooth sky, and the same with a sun; rows from +Y down, radiance."""
import pathlib

import numpy as np

import pictures

SUN_ELEVATION, SUN_AZIMUTH = 38.0, 215.0  # degrees; azimuth from +X over +Z
SUN_RADIUS = 1.0, 0.4  # degrees: half its value is reached here; width of the edge
SUN_RADIANCE = np.array([9000.0, 7800.0, 6200.0])  # irradiance about three times that of the sky


def directions(width: int, height: int) -> np.ndarray:
    """Unit vectors of the texels' centres, height x width x 3: u = atan2(z, x) / 2 pi + 1/2, v = acos(y) / pi."""
    phi = ((np.arange(width) + 0.5) / width - 0.5) * 2 * np.pi
    theta = (np.arange(height)[:, None] + 0.5) / height * np.pi
    ring = np.sin(theta)
    return np.stack(np.broadcast_arrays(ring * np.cos(phi), np.cos(theta), ring * np.sin(phi)), axis=2)


def towards_sun() -> np.ndarray:
    elevation, azimuth = np.radians([SUN_ELEVATION, SUN_AZIMUTH])
    return np.array([np.cos(elevation) * np.cos(azimuth), np.sin(elevation), np.cos(elevation) * np.sin(azimuth)])


def smooth_sky(d: np.ndarray) -> np.ndarray:
    """Radiance, 0.1 to 2.5: blue above, a bright horizon, brown below, a wide warm glow about the sun's place."""
    up = d[..., 1:2]
    height = np.clip(up, 0, 1)
    sky = (np.array([0.18, 0.36, 0.80]) * height**0.6 + np.array([0.95, 0.90, 0.80]) * (1 - height**0.6))
    ground = np.array([0.16, 0.13, 0.10])
    above = 1 / (1 + np.exp(-up / 0.03))
    glow = np.exp(6 * (d @ towards_sun() - 1))[..., None] * np.array([1.9, 1.5, 0.9])
    return above * (sky + glow) + (1 - above) * ground


def sun(d: np.ndarray) -> np.ndarray:
    """Radiance of a disc two degrees wide with a soft edge: the real one (half a degree) as lenses and haze show it."""
    angle = np.degrees(np.arccos(np.clip(d @ towards_sun(), -1, 1)))
    radius, edge = SUN_RADIUS
    return (SUN_RADIANCE * (0.5 - 0.5 * np.tanh((angle - radius) / edge))[..., None])


def write_environments(folder: pathlib.Path) -> dict[str, pathlib.Path]:
    """Writes smooth.pfm and sun.pfm where they are missing; names to files."""
    folder.mkdir(parents=True, exist_ok=True)
    files = {name: folder / f"{name}.pfm" for name in ("smooth", "sun", "white")}
    pictures.write_pfm(files["smooth"], smooth_sky(directions(512, 256)))
    d = directions(2048, 1024)
    pictures.write_pfm(files["sun"], smooth_sky(d) + sun(d))
    pictures.write_pfm(files["white"], np.ones((2, 4, 3)))
    return files
