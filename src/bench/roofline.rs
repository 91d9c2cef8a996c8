//! What a frame would take at least on GPUs by name, from the bytes that its passes declare and the rays that it traces: the roofline of
//! Williams et al. 2009 with rays in place of operations.
//!
//! A prediction, never a measurement: a pass takes the longer of bytes / bandwidth and rays / ray rate. Shading, divergence,
//! the scene's own bytes, launches and synchronisation are not counted, so real frames are slower; only what a large cache keeps from
//! memory can make a pass bound by bytes faster.

use super::record::Figure;
use crate::technique::Timings;
use std::collections::BTreeMap;

/// A GPU by its vendor's published figures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gpu {
    pub name: &'static str,
    /// 1e9 bytes per second.
    pub bandwidth_gb_per_second: f64,
    /// 1e9 rays per second; none where the vendor has not published it, so that bytes alone bound the prediction.
    pub grays_per_second: Option<f64>,
}

const fn gpu(name: &'static str, bandwidth_gb_per_second: f64, grays_per_second: Option<f64>) -> Gpu {
    Gpu { name, bandwidth_gb_per_second, grays_per_second }
}

pub static GPUS: &[Gpu] = &[
    // NVIDIA's announcement of the GeForce RTX 20 series, August 2018: 448, 448 and 616 GB/s; 6, 8 and 10 Gray/s.
    gpu("rtx-2070", 448.0, Some(6.0)),
    gpu("rtx-2080", 448.0, Some(8.0)),
    gpu("rtx-2080-ti", 616.0, Some(10.0)),
    // NVIDIA Ampere GA102 GPU Architecture whitepaper (2020), table of GeForce RTX 3080 and 3090: 760 GB/s; no rate of rays.
    gpu("rtx-3080", 760.0, None),
    // NVIDIA Ada GPU Architecture whitepaper (2022), table of GeForce RTX 4090: 1008 GB/s; no rate of rays.
    gpu("rtx-4090", 1008.0, None),
    // AMD's product page of the Radeon RX 7900 XTX: 960 GB/s; no rate of rays.
    gpu("rx-7900-xtx", 960.0, None),
    // Intel's product page of the Arc A770 with 16 GB: 560 GB/s; no rate of rays.
    gpu("arc-a770", 560.0, None),
];

const FULL_HD_PIXELS: f64 = 1920.0 * 1080.0;

/// For every GPU of [`GPUS`], `predicted_ms:GPU` at the size of `timings`, and `predicted_ms_1080p:GPU` with all cost in proportion to
/// pixels. Milliseconds. In no table of what was measured: these keys are not among [`FIGURES`](super::figure::FIGURES).
pub fn figures(timings: &Timings, size: [u32; 2]) -> BTreeMap<String, Figure> {
    let pixels = f64::from(size[0]) * f64::from(size[1]);
    let passes: Vec<_> = timings.passes.iter().map(|pass| (pass.traces_rays, (pass.bytes_read + pass.bytes_written) as f64)).collect();
    let both = |gpu: &Gpu| {
        let predicted = frame_ms(&passes, timings.rays.per_pixel * pixels, gpu);
        [("predicted_ms", predicted), ("predicted_ms_1080p", predicted * FULL_HD_PIXELS / pixels)]
            .map(|(key, value)| (format!("{key}:{}", gpu.name), figure(value)))
    };
    GPUS.iter().flat_map(both).collect()
}

fn figure(value: f64) -> Figure {
    Figure { value, low: value, high: value, unit: "ms".to_owned(), samples: Vec::new() }
}

/// Of passes: whether they trace, and bytes. They run one after the other; those that trace count as one, since the count of a frame's rays
/// does not tell them apart, and so the sum is a bound however the rays are shared among them.
fn frame_ms(passes: &[(bool, f64)], rays: f64, gpu: &Gpu) -> f64 {
    let bytes = |tracing: bool| -> f64 { passes.iter().filter(|(traces, _)| *traces == tracing).map(|pass| pass.1).sum() };
    // 1 GB/s is 1e6 bytes per millisecond, 1 Gray/s 1e6 rays.
    let bytes_ms = |bytes: f64| bytes / (gpu.bandwidth_gb_per_second * 1e6);
    let rays_ms = gpu.grays_per_second.map_or(0.0, |rate| rays / (rate * 1e6));
    bytes_ms(bytes(true)).max(rays_ms) + bytes_ms(bytes(false))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::technique::{PassTime, RayCounts};

    const RTX_2070: &Gpu = &gpu("rtx-2070", 448.0, Some(6.0));

    #[test]
    fn the_longer_of_bytes_and_rays_counts_where_rays_are_traced() {
        // 448e6 bytes take 1 ms, 12e6 rays 2 ms.
        let ms = |rays| frame_ms(&[(true, 448e6), (false, 896e6)], rays, RTX_2070);
        assert!((ms(12e6) - (2.0 + 2.0)).abs() < 1e-12, "bound by rays");
        assert!((ms(3e6) - (1.0 + 2.0)).abs() < 1e-12, "bound by bytes");
    }

    #[test]
    fn without_a_published_rate_bytes_alone_bound() {
        let gpu = Gpu { grays_per_second: None, ..*RTX_2070 };
        assert!((frame_ms(&[(true, 448e6)], 1e12, &gpu) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn passes_that_trace_share_their_rays() {
        let ms = |rays| frame_ms(&[(true, 448e6), (true, 448e6)], rays, RTX_2070);
        assert!((ms(12e6) - 2.0).abs() < 1e-12);
        assert!((ms(18e6) - 3.0).abs() < 1e-12);
    }

    /// 960x540 is a quarter of 1920x1080: 518,400 pixels, 10 rays each, are 5.184e6 rays, 0.648 ms at 8 Gray/s.
    #[test]
    fn predictions_scale_by_pixels() {
        let pass = PassTime {
            name: "megakernel",
            median_ms: 0.0,
            p95_ms: 0.0,
            bytes_read: 0,
            bytes_written: 1,
            traces_rays: true,
            samples_ms: Vec::new(),
        };
        let timings = Timings { passes: vec![pass], rays: RayCounts { per_pixel: 10.0, ..Default::default() }, ..Default::default() };
        let figures = figures(&timings, [960, 540]);
        assert!((figures["predicted_ms:rtx-2080"].value - 0.648).abs() < 1e-12);
        assert!((figures["predicted_ms_1080p:rtx-2080"].value - 4.0 * 0.648).abs() < 1e-12);
        assert_eq!(figures.len(), 2 * GPUS.len());
    }
}
