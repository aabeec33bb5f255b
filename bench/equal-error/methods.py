# SPDX-License-Identifier: Apache-2.0
"""What is compared: each method with budgets from cheap to dear, as options of `relumine render`."""
from command import Options

PATH_TYPE = ("path", "gather-sobol", "gather")  # independent samples for every pixel: the rivals
BLOCK_RIVAL = "block-gather"
OURS = ("cache", "cache-unbiased")

WORDS = {
    "path": "MIS path sampling, Owen-scrambled Sobol points; a camera sample per path",
    "gather-sobol": "Sobol rays drawn from the BSDF, with and without samples of the bright part of the light (MIS)",
    "gather": "stratified rays drawn from the BSDF, in packets: the paper's baseline",
    "block-gather": "one traced map per block of 8 × 8 pixels, integrated per pixel; no reprojection",
    "irradiance-cache": "Ward's records with gradients for diffuse light; rays for lobes and bright light (docs/rivals.md)",
    "radiance-cache": "the same, and harmonics in records for surfaces with broad lobes",
    "reproject": "the paper's method: records of n² rays",
    "reproject-mc": "the paper's unbiased method",
    "cache": "maps for blocks whose size follows the error wanted, residual rays, filtered",
    "cache-even": "the same at `--error 0.02`, but as many rays for each pixel",
    "cache-unbiased": "as `cache`, exact in expectation, nothing filtered",
}


def budgets(path_depth: int, spp: int, quick: bool) -> dict[str, list[Options]]:
    """Names to options, cheap to dear. `path_depth`: scattering vertices that make `path` see what gather rays do.

    Numbers of rays are per pixel; with several camera samples each gets its part of them.
    """
    def each(total: int) -> int:
        return max(1, total // spp)

    def rays(*totals: int) -> list[int]:
        return sorted({each(n) for n in totals})

    path = [4**i for i in range(5 if quick else 7)]
    sobol = rays(4, 16, 64, 256) if quick else rays(4, 16, 64, 256, 1024)
    plain = rays(256) if quick else rays(256, 1024, 4096)
    errors = [0.08, 0.02, 0.005, 0.001] if quick else [0.08, 0.04, 0.02, 0.01, 0.005, 0.002, 0.001]
    sizes = [32] if quick else [32, 64, 128]
    even = rays(8, 32, 128) if quick else rays(4, 8, 16, 32, 64, 128, 256)
    residual = rays(4, 16, 64, 256) if quick else rays(4, 16, 64, 256, 1024)
    records = list(zip((16, 32, 32, 64, 64), (0.4, 0.3, 0.15, 0.15, 0.08), rays(16, 64, 256, 1024, 4096),
                       rays(4, 16, 64, 256, 1024)))[:4 if quick else 5]
    rival = [{"record-size": n, "accuracy": a, "glossy-rays": g, "light-samples": m} for n, a, g, m in records]
    return {
        "path": [{"method": "path", "max-depth": path_depth, "sampler": "sobol", "spp": n} for n in path],
        "gather-sobol": [{"method": "gather", "sampler": "sobol", "gather-rays": n, "light-samples": m}
                         for n in sobol for m in (0, max(1, n // 4))],
        "gather": [{"method": "gather", "gather-rays": n} for n in plain],
        "block-gather": [{"method": "block-gather", "error": e} for e in errors],
        "irradiance-cache": [{"method": "irradiance-cache", **options} for options in rival],
        "radiance-cache": [{"method": "radiance-cache", **options} for options in rival],
        "reproject": [{"method": "reproject", "record-size": n} for n in sizes],
        "reproject-mc": [{"method": "reproject-mc", "gather-rays": n} for n in plain],
        "cache": [{"method": "cache", "error": e} for e in errors],
        "cache-even": [{"method": "cache", "residual-rays": n, "light-samples": 2 * n} for n in even],
        "cache-unbiased": [{"method": "cache", "unbiased": "", "residual-rays": n, "light-samples": m}
                           for n in residual for m in (max(1, n // 4), n)],
    }


def words(options: Options) -> str:
    """As on the command line."""
    return " ".join(f"--{key} {value}".strip() for key, value in options.items())
