//! `hpsf+`: hpsf with everything that makes its picture better, at the price of some more passes.

use super::{Technique, hpsf};

pub(super) const TECHNIQUE: Technique = Technique {
    name: "hpsf+",
    help: "hpsf at fine cells, direct and indirect light apart, paths short where nothing moves, smoothed over the screen as far as noise goes, and antialiased over frames",
    defaults: &[
        ("paths.scramble", "tile"),
        ("lights.sole", "apart"),
        // Where lamps are many: what better choices save in noise, more samples would cost more for.
        ("lights.candidates", "32"),
        // One sample of a caustic is a spot on the picture for as long as its cell remembers.
        ("paths.regularize", "0.45"),
        ("frame.jitter", "on"),
        // Frames at several offsets are sharper than one: half a level finer, as antialiasing over frames allows.
        ("textures.lod_bias", "-0.5"),
        ("hpsf.temporal", "on"),
        ("hpsf.split", "on"),
        ("hpsf.smooth", "4"),
        ("hpsf.smooth_indirect", "5"),
        ("hpsf.smooth_specular", "3"),
        ("hpsf.lookups", "0"),
        ("hpsf.levels", "1"),
        ("hpsf.width", "3"),
        // Fine cells are many: with room for them all, which pixel fails to get one is left to chance no more.
        ("hpsf.cells", "2"),
        // What jitter would hide of fine cells' borders, smoothing does with less noise.
        ("hpsf.jitter", "0.1"),
        ("hpsf.normal_bits", "6"),
        ("hpsf.second", "cells"),
        ("nhpsf.vertices", "3"),
        ("nhpsf.wider", "1"),
        ("hpsf.time", "hybrid"),
        // Cells of second vertices, and the light that comes from them, get better with every frame.
        ("hpsf.recency", "1"),
        ("hpsf.adapt", "2"),
        ("temporal.clamp", "1"),
    ],
    ..hpsf::TECHNIQUE
};
