//! Everything that is measured at a point, defined once: key, unit, which way is better, what it means. Runner, comparison and report
//! iterate [`FIGURES`].

use serde::Serialize;

/// Which way a figure should go.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Better {
    Less,
    More,
    /// The nearer to 1 the better.
    One,
    /// What a change of the program must leave as it is.
    Same,
    /// A fact, neither good nor bad.
    Neither,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Group {
    Time,
    Memory,
    /// Of pictures against the reference.
    Error,
    /// Bias and variance apart, over seeds.
    Split,
    /// Between subsequent frames.
    Temporal,
    /// Of a hash table, where the technique has one.
    Table,
    /// Must be 0.
    Fault,
    /// What errors are measured against.
    Reference,
}

/// One thing that is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct FigureKind {
    pub key: &'static str,
    /// For headings.
    pub name: &'static str,
    /// Empty for pure numbers.
    pub unit: &'static str,
    pub better: Better,
    pub group: Group,
    /// One line: definition and source.
    pub help: &'static str,
}

const fn kind(group: Group, key: &'static str, name: &'static str, unit: &'static str, better: Better, help: &'static str) -> FigureKind {
    FigureKind { key, name, unit, better, group, help }
}

use Better::{Less, More, Neither, One, Same};
use Group::{Error, Fault, Memory, Reference, Split, Table, Temporal, Time};

/// In the order of tables.
pub static FIGURES: &[FigureKind] = &[
    kind(Time, "frame_ms", "frame", "ms", Less, "GPU time of a frame, or of all that a picture accumulates: median over frames, warm"),
    kind(Time, "frame_ms_p95", "frame, 95 %", "ms", Less, "GPU time that 95 % of the frames stay below"),
    kind(Time, "cpu_ms", "host", "ms", Less, "CPU time to record and submit a frame: median over frames"),
    kind(Time, "first_frame_ms", "first frame", "ms", Less, "GPU time of the first frame, where drivers may compile"),
    kind(Time, "load_ms", "load", "ms", Less, "reading the scene"),
    kind(Time, "build_ms", "build", "ms", Less, "order, upload, acceleration structure, pipelines"),
    kind(Time, "rays_per_pixel", "rays per pixel", "", Less, "scattered and shadow rays of the last frame"),
    kind(Time, "mrays_per_second", "ray rate", "Mray/s", More, "all rays over all passes' time"),
    kind(Memory, "memory_bytes", "device memory", "B", Less, "peak of everything allocated on the device"),
    kind(Memory, "bytes_read", "bytes read", "B", Less, "per frame, as passes declare it"),
    kind(Memory, "bytes_written", "bytes written", "B", Less, "per frame, as passes declare it"),
    kind(Memory, "bandwidth", "bandwidth", "GB/s", Neither, "declared bytes over the frame's time"),
    kind(Error, "mse", "MSE", "", Less, "mean squared error of radiance"),
    kind(Error, "relmse", "relMSE", "", Less, "squared error over squared reference + 0.01"),
    kind(Error, "relmse_trimmed", "relMSE, trimmed", "", Less, "without the worst 0.1 % of the pixels"),
    kind(Error, "psnr", "PSNR", "dB", More, "of what a screen shows"),
    kind(Error, "rmse_tonemapped", "RMSE, tonemapped", "", Less, "tonemapped without gamma (Voorhuis 2018, chapter 7)"),
    kind(Error, "ssim", "SSIM", "", More, "tonemapped and gamma-corrected (Wang et al. 2004; Voorhuis 2018, Nilsson 2018)"),
    kind(Error, "flip", "FLIP", "", Less, "LDR-FLIP, mean (Andersson et al. 2020)"),
    kind(Error, "flip_p99", "FLIP, 99 %", "", Less, "LDR-FLIP that 99 % of the pixels stay below"),
    kind(Error, "flip_worst_tile", "FLIP, worst tile", "", Less, "LDR-FLIP, mean over the worst tile of 16x16 pixels"),
    kind(Error, "hdr_flip", "HDR-FLIP", "", Less, "over all exposures, mean (Andersson et al. 2021)"),
    kind(Error, "hdr_flip_p99", "HDR-FLIP, 99 %", "", Less, "HDR-FLIP that 99 % of the pixels stay below"),
    kind(Error, "hdr_flip_worst_tile", "HDR-FLIP, worst tile", "", Less, "HDR-FLIP, mean over the worst tile of 16x16 pixels"),
    kind(Error, "energy", "energy", "", One, "mean radiance over the reference's"),
    kind(Split, "bias2", "bias^2", "", Less, "relative squared bias, corrected for the noise of seeds and reference"),
    kind(Split, "variance", "variance", "", Less, "relative variance over seeds"),
    kind(
        Temporal,
        "temporal",
        "temporal error",
        "",
        Less,
        "mean tonemapped luminance difference of subsequent frames, beyond the reference's own (Voorhuis 2018, 7.1)",
    ),
    kind(Table, "occupancy", "occupancy", "", Neither, "taken slots over all slots, after the last frame"),
    kind(Table, "probes", "probes", "slots", Less, "slots looked at for a sample's key, mean: 1 where it is at home"),
    kind(Table, "probes_p99", "probes, 99 %", "slots", Less, "slots looked at for a sample's key that 99 % of the samples stay within"),
    kind(Table, "failed_insertions", "failed", "", Less, "insertions that found no slot over all insertions of the last frame"),
    kind(Table, "collisions", "collisions", "", Less, "insertions into another key's slot over all of the last frame: whole keys compared"),
    kind(Fault, "nan", "NaN", "pixels", Less, "pixels that hold a NaN"),
    kind(Fault, "infinite", "infinite", "pixels", Less, "pixels that hold an infinity"),
    kind(Fault, "negative", "negative", "pixels", Less, "pixels that hold a negative value"),
    kind(
        Reference,
        "reference_ratio",
        "reference quality",
        "",
        More,
        "error measured over the reference's own standard error: 10 and more is good",
    ),
    kind(Reference, "reference_radiance", "radiance of the reference", "W/(sr m^2)", Same, "mean over pixels and channels"),
];

/// The figure of this key.
pub fn find(key: &str) -> Option<&'static FigureKind> {
    FIGURES.iter().find(|figure| figure.key == key)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_unique() {
        for figure in FIGURES {
            assert_eq!(FIGURES.iter().filter(|other| other.key == figure.key).count(), 1, "{}", figure.key);
        }
    }
}
