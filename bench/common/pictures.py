# SPDX-License-Identifier: Apache-2.0
"""Pictures as arrays: PFM in and out, PNG out, tone mapping, signed errors in colour, sheets with captions.

A picture is height x width x 3, top row first, linear radiance unless said otherwise. Needs numpy alone.
"""
import pathlib
import struct
import zlib

import numpy as np

CAPTION_HEIGHT = 14  # pixels of a line of text
WHITE, PAPER, INK = 255, 250, 20  # 8-bit sRGB grey

# A 5 x 7 font: five columns per character, bit 0 is the top row.
GLYPHS = {
    " ": "0000000000", "%": "2313086462", "(": "001c224100", ")": "0041221c00", "+": "08083e0808",
    ",": "0050300000", "-": "0808080808", ".": "0060600000", "/": "2010080402", ":": "0036360000",
    "=": "1414141414", "^": "0402010204", "_": "4040404040", "0": "3e5149453e", "1": "00427f4000",
    "2": "4261514946", "3": "2141454b31", "4": "1814127f10", "5": "2745454539", "6": "3c4a494930",
    "7": "0171090503", "8": "3649494936", "9": "064949291e", "a": "2054545478", "b": "7f48444438",
    "c": "3844444420", "d": "384444487f", "e": "3854545418", "f": "087e090102", "g": "0c5252523e",
    "h": "7f08040478", "i": "00447d4000", "j": "2040443d00", "k": "7f10284400", "l": "00417f4000",
    "m": "7c04180478", "n": "7c08040478", "o": "3844444438", "p": "7c14141408", "q": "081414187c",
    "r": "7c08040408", "s": "4854545420", "t": "043f444020", "u": "3c4040207c", "v": "1c2040201c",
    "w": "3c4030403c", "x": "4428102844", "y": "0c5050503c", "z": "4464544c44",
}


def read_pfm(path: pathlib.Path) -> np.ndarray:
    """A colour or grey PFM as float64; a grey one gets three equal channels."""
    with open(path, "rb") as file:
        kind = file.readline().strip()
        if kind not in (b"PF", b"Pf"):
            raise ValueError(f"{path}: expected a PFM, found {kind!r}")
        width, height = map(int, file.readline().split())
        order = "<f4" if float(file.readline()) < 0 else ">f4"
        channels = 3 if kind == b"PF" else 1
        data = np.frombuffer(file.read(), order)
    if data.size != width * height * channels:
        raise ValueError(f"{path}: expected {width * height * channels} numbers, found {data.size}")
    rows = data.reshape(height, width, channels)[::-1].astype(np.float64)
    return np.repeat(rows, 3, axis=2) if channels == 1 else rows


def write_pfm(path: pathlib.Path, picture: np.ndarray) -> None:
    """A colour PFM, 32-bit little-endian; the file itself runs upwards."""
    height, width, _ = picture.shape
    with open(path, "wb") as file:
        file.write(f"PF\n{width} {height}\n-1.0\n".encode())
        file.write(np.ascontiguousarray(picture[::-1], dtype="<f4").tobytes())


def write_png(path: pathlib.Path, pixels: np.ndarray) -> None:
    """8-bit sRGB: height x width x 3, uint8."""
    height, width, _ = pixels.shape
    rows = np.zeros((height, 1 + 3 * width), np.uint8)  # a leading 0 on each row: no filter
    rows[:, 1:] = pixels.reshape(height, -1)
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    chunks = ((b"IHDR", header), (b"IDAT", zlib.compress(rows.tobytes(), 9)), (b"IEND", b""))
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n")
        for kind, data in chunks:
            file.write(struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data)))


def to_srgb(picture: np.ndarray, exposure: float = 0.0) -> np.ndarray:
    """8-bit sRGB after `exposure` stops; brighter than white is clipped, as in the paper's pictures."""
    linear = np.clip(picture * 2.0**exposure, 0, 1)
    encoded = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear**(1 / 2.4) - 0.055)
    return np.round(255 * encoded).astype(np.uint8)


def exposure_for(picture: np.ndarray, percentile: float = 97.0) -> float:
    """Stops that bring this percentile of the luminance to 0.8 of white."""
    luminance = picture @ (0.2126, 0.7152, 0.0722)
    return float(np.log2(0.8 / max(np.percentile(luminance, percentile), 1e-9)))


def signed_error(picture: np.ndarray, reference: np.ndarray, keep: np.ndarray, full_scale: float) -> np.ndarray:
    """8-bit picture of (L - R) / mean R: white 0, red too bright, blue too dark; saturated at +-full_scale."""
    error = (picture - reference).mean(axis=2) / reference[keep].mean()
    amount = np.clip(error / full_scale, -1, 1) * keep
    fade = 1 - np.abs(amount)
    red, blue = np.where(amount < 0, fade, 1.0), np.where(amount > 0, fade, 1.0)
    return np.round(255 * np.stack([red, fade, blue], axis=2)).astype(np.uint8)


def caption(text: str, width: int) -> np.ndarray:
    """A line of text, CAPTION_HEIGHT x width x 3, 8-bit; characters without a glyph stay blank."""
    line = np.full((CAPTION_HEIGHT, width, 3), PAPER, np.uint8)
    for i, character in enumerate(text.lower()):
        left = 3 + 6 * i
        if left + 5 > width:
            break
        for column, bits in enumerate(bytes.fromhex(GLYPHS.get(character, GLYPHS[" "]))):
            for row in range(7):
                if bits >> row & 1:
                    line[4 + row, left + column] = INK
    return line


def enlarged(picture: np.ndarray, least: int = 384) -> np.ndarray:
    """The picture with each pixel repeated so often that it is at least so wide, and captions fit."""
    times = -(-least // picture.shape[1])
    return picture.repeat(times, axis=0).repeat(times, axis=1)


def sheet(rows: list[list[tuple[str, np.ndarray]]], gap: int = 4) -> np.ndarray:
    """Pictures (8-bit, all of one size) in rows, each under its caption."""
    height, width, _ = rows[0][0][1].shape
    columns = max(len(row) for row in rows)
    cell_height, cell_width = height + CAPTION_HEIGHT + gap, width + gap
    page = np.full((len(rows) * cell_height + gap, columns * cell_width + gap, 3), PAPER, np.uint8)
    for y, row in enumerate(rows):
        for x, (text, picture) in enumerate(row):
            top, left = gap + y * cell_height, gap + x * cell_width
            page[top:top + CAPTION_HEIGHT, left:left + width] = caption(text, width)
            page[top + CAPTION_HEIGHT:top + CAPTION_HEIGHT + height, left:left + width] = picture
    return page
