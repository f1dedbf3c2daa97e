#!/usr/bin/env python3
"""FLIP and SSIM of pictures given by formulas, for crates/karui/tests/image.rs.

    python3 -m venv /tmp/flip && /tmp/flip/bin/pip install flip-evaluator numpy scikit-image
    /tmp/flip/bin/python tools/image_metrics.py

FLIP is NVIDIA's own program, SSIM that of scikit-image. Prints a line a pair of
pictures: mean FLIP, FLIP at three pixels, SSIM, RMSE.
"""

import flip_evaluator
import numpy as np
from skimage.metrics import structural_similarity

PAIRS = ["shifted", "stripes", "blurred", "inverted"]
SIZES = [(64, 48), (96, 96)]


def pattern(x, y):
    """A disc, a grid and ramps."""
    disc = (x - 30) ** 2 + (y - 25) ** 2 < 300
    grid = (x % 8 < 1) | (y % 12 < 1)
    ramps = np.stack([x * 255 // 95, y * 255 // 95 % 256, (x * 3 + y * 5) % 256], -1)
    ramps[grid] = [250, 250, 240]
    ramps[disc] = [200, 40, 30]
    return ramps


def pair(name, width, height):
    y, x = np.mgrid[0:height, 0:width]
    a = pattern(x, y)
    if name == "shifted":
        return a, pattern(x + 1, y)
    if name == "stripes":
        return a, a + (x % 4 < 2)[..., None] * (255 - a) // 8
    if name == "blurred":
        return a, (pattern(x, y) + pattern(x + 1, y) + pattern(x, y + 1)) // 3
    if name == "dot":
        dot = (abs(x - 60) < 3) & (abs(y - 192) < 3)
        return a, np.where(dot[..., None], 255 - a, a)
    return a, 255 - a


def luma(rgb):
    return rgb @ np.array([0.299, 0.587, 0.114])


def ssim(a, b):
    return structural_similarity(
        luma(a), luma(b), data_range=255, gaussian_weights=True, sigma=1.5,
        use_sample_covariance=False,
    )


def flip(a, b, ppd):
    a, b = ((p / 255).astype(np.float32) for p in (a, b))
    error, mean, _ = flip_evaluator.evaluate(
        a, b, "LDR", applyMagma=False, parameters={"ppd": ppd}
    )
    return np.asarray(error).reshape(a.shape[0], a.shape[1], -1)[..., 0], mean


def report(name, width, height, ppd):
    a, b = pair(name, width, height)
    error, mean = flip(a, b, ppd)
    spots = [error[y, x] for x, y in [(0, 0), (30, 25), (width - 1, height - 3)]]
    rmse = np.sqrt(np.mean(((a - b) / 255) ** 2))
    numbers = ", ".join(f"{v:.6f}" for v in spots)
    print(f'("{name}", {width}, {height}, {ppd}, {mean:.6f}, [{numbers}], '
          f"{ssim(a, b):.6f}, {rmse:.6f}),")


for width, height in SIZES:
    for name in PAIRS:
        report(name, width, height, 67.0206)
report("shifted", 64, 48, 30.0)
report("shifted", 64, 48, 150.0)
report("dot", 64, 200, 67.0206)
black = np.zeros((30, 30, 3), int)
print(f"black to white: {flip(black, black + 255, 67.0206)[1]:.6f}")
