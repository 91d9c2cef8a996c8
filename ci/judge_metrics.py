"""Holds the metrics of `pathspace diff` against packages of other hands: judge_metrics.py PATHSPACE DIRECTORY_OF_EXR_FILES"""

import json
import pathlib
import subprocess
import sys
import tempfile

import flip_evaluator
import numpy as np
import OpenEXR
from skimage.metrics import mean_squared_error, peak_signal_noise_ratio, structural_similarity

TOLERANCE = 1e-4


def write(path, pixels):
    header = {"compression": OpenEXR.NO_COMPRESSION, "type": OpenEXR.scanlineimage}
    OpenEXR.File(header, {"RGB": np.ascontiguousarray(pixels, np.float32)}).write(str(path))


def read(path):
    return OpenEXR.File(str(path)).channels()["RGB"].pixels[..., :3].astype(np.float32)


def displayed(radiance):
    """Narkowicz's curve, without the 0.6 that flip-evaluator's own tonemapper has."""
    x = radiance.astype(np.float64)
    return np.clip(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), 0, 1)


def encoded(linear):
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * np.maximum(linear, 1e-9) ** (1 / 2.4) - 0.055)


def flip(image, reference, dynamic_range):
    arrays = [np.ascontiguousarray(a, np.float32) for a in (reference, image)]
    errors = flip_evaluator.evaluate(*arrays, dynamic_range, inputsRGB=True, applyMagma=False)[0][..., 0].astype(np.float64)
    tiles = [errors[y : y + 16, x : x + 16].mean() for y in range(0, errors.shape[0], 16) for x in range(0, errors.shape[1], 16)]
    return {"": errors.mean(), "_p99": np.quantile(errors, 0.99), "_worst_tile": max(tiles)}


def judged(image, reference):
    shown = [displayed(image), displayed(reference)]
    taken = [encoded(a) for a in shown]
    luma = [a @ [0.2126, 0.7152, 0.0722] for a in taken]
    radiance = [a.astype(np.float64) for a in (image, reference)]
    result = {
        "mse": mean_squared_error(*radiance),
        "relmse": ((radiance[0] - radiance[1]) ** 2 / (radiance[1] ** 2 + 0.01)).mean(),
        "rmse_tonemapped": np.sqrt(mean_squared_error(*shown)),
        "psnr": peak_signal_noise_ratio(taken[1], taken[0], data_range=1),
        "ssim": structural_similarity(*luma, data_range=1, gaussian_weights=True, sigma=1.5, use_sample_covariance=False),
        "mean_ratio": radiance[0].mean() / radiance[1].mean(),
    }
    result |= {"flip" + key: value for key, value in flip(*taken, "LDR").items()}
    return result | {"hdr_flip" + key: value for key, value in flip(image, reference, "HDR").items()}


def noisy(radiance, sigma, rng):
    """As a path tracer errs: more where it is bright, skewed, with the right mean."""
    return radiance * rng.lognormal(-0.5 * sigma * sigma, sigma, radiance.shape)


def pictures(directory, rng):
    """(name, picture, reference)"""
    for height, width, spread in [(33, 47, 0.5), (64, 64, 1.0), (72, 128, 2.5)]:
        reference = np.exp(rng.normal(-1, spread, (height, width, 3)))
        yield f"random {width}x{height}, spread {spread}", noisy(reference, 0.3, rng), reference
    for path in sorted(directory.glob("*.exr")):
        reference = read(path)
        if np.ptp(reference) > 0:
            yield f"{path.stem}, noisy", noisy(reference, 0.5, rng), reference
            yield f"{path.stem}, shifted and darker", 0.9 * np.roll(reference, 1, axis=1), reference


def main(pathspace, directory):
    rng = np.random.default_rng(1)
    worst = {}
    with tempfile.TemporaryDirectory() as scratch:
        files = [pathlib.Path(scratch) / name for name in ("a.exr", "b.exr")]
        for name, image, reference in pictures(pathlib.Path(directory), rng):
            image, reference = (np.asarray(a, np.float32) for a in (image, reference))
            for file, pixels in zip(files, (image, reference)):
                write(file, pixels)
            output = subprocess.run([pathspace, "-q", "diff", "--json", *files], check=True, capture_output=True, text=True).stdout
            ours = json.loads(output)["metrics"]
            for key, theirs in judged(image, reference).items():
                # Relative to the value where that is large, as mean squared errors and decibels are.
                difference = abs(ours[key] - theirs) / max(1.0, abs(theirs))
                worst[key] = max(worst.get(key, (0.0, "", 0.0, 0.0)), (difference, name, ours[key], theirs))
    for key, (difference, name, ours, theirs) in worst.items():
        verdict = "agrees" if difference <= TOLERANCE else "DIFFERS"
        print(f"{key:22}{verdict}  at most {difference:.1e}, ours {ours:.7g}, theirs {theirs:.7g}: {name}")
    return 0 if all(difference <= TOLERANCE for difference, *_ in worst.values()) else 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
