#!/usr/bin/env python3
"""Renders .glb files of this project with Mitsuba 3: mean radiance and the standard error of that mean, per pixel.

Usage: render.py OUT_FOLDER NAME=FILE.glb:SAMPLES ... (see make)

Writes NAME.exr with half-precision channels R, G, B (mean) and error.R, error.G, error.B (standard error of that mean, the root of
its variance, from independent batches), and NAME.json beside it.
"""

import argparse
import hashlib
import json
import pathlib
import time

import mitsuba as mi
import numpy as np

mi.set_variant("llvm_ad_rgb")

import scene as scenes

SIZE = (128, 72)
BOUNCES = 8
BATCHES = 64


def render(scene, samples):
    """Mean, and variance of the mean, over `samples` per pixel in BATCHES independent batches."""
    per_batch = -(-samples // BATCHES)
    batches = np.stack([np.array(mi.render(scene, spp=per_batch, seed=seed), np.float64) for seed in range(BATCHES)])
    return batches.mean(0), batches.var(0, ddof=1) / BATCHES, per_batch * BATCHES


def write(path, mean, variance):
    """Half precision rounds by at most 2^-11 of the value: less than the error of the mean. A root spans less than a variance would."""
    channels = np.concatenate([mean, np.sqrt(variance)], 2).astype(np.float16)
    assert np.isfinite(channels).all()
    names = ["R", "G", "B", "error.R", "error.G", "error.B"]
    mi.Bitmap(channels, mi.Bitmap.PixelFormat.MultiChannel, names).write(str(path))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("scenes", nargs="+", metavar="NAME=FILE.glb:SAMPLES")
    arguments = parser.parse_args()
    for item in arguments.scenes:
        name, rest = item.split("=", 1)
        file, samples = rest.rsplit(":", 1)
        start = time.time()
        mean, variance, samples = render(scenes.load(file, SIZE, BOUNCES), int(samples))
        write(arguments.out / f"{name}.exr", mean, variance)
        about = {
            "version": 1,
            "renderer": f"Mitsuba {mi.__version__}, {mi.variant()}, path, box filter, independent sampler",
            "command": f"ci/references/make {name}",
            "scene": pathlib.Path(file).name,
            "scene_sha256": hashlib.sha256(pathlib.Path(file).read_bytes()).hexdigest(),
            "size": list(SIZE),
            "max_bounces": BOUNCES,
            "samples_per_pixel": samples,
            "batches": BATCHES,
            "bsdf": "diffuse where specularFactor and metallicFactor are 0; dielectric, roughdielectric (GGX) where transmissive; else glTF 2.0 appendix B",
            "mean_radiance": mean.mean((0, 1)).round(6).tolist(),
        }
        (arguments.out / f"{name}.json").write_text(json.dumps(about, indent=2) + "\n")
        noise = np.sqrt(variance.mean()) / mean.mean()
        print(f"{name}: {samples} samples, {time.time() - start:.0f} s, mean {mean.mean():.5f}, RMS error {100 * noise:.2f} % of it")


if __name__ == "__main__":
    main()
