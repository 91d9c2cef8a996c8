//! `hpsf+`: hpsf with everything that makes its picture better, at the price of some more passes.

use super::{Technique, hpsf};

pub(super) const TECHNIQUE: Technique = Technique {
    name: "hpsf+",
    help: "hpsf at the finest cells that have enough samples, smoothed over the screen and antialiased over frames",
    defaults: &[
        ("paths.scramble", "tile"),
        ("frame.jitter", "on"),
        ("hpsf.temporal", "on"),
        ("hpsf.smooth", "2"),
        ("hpsf.lookups", "8"),
        ("hpsf.width", "6"),
        ("hpsf.jitter", "0.4"),
        ("hpsf.few", "24"),
        ("hpsf.normal_bits", "8"),
    ],
    ..hpsf::TECHNIQUE
};
