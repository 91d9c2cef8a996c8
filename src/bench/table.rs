//! How a technique's hash table fares, as figures of a record: how full it is, how far keys are from home, what found no slot or a wrong one.
//!
//! Looked at in a rendering of its own, because counting takes passes that timed frames must not have.

use super::accuracy::named;
use super::record::{Figure, Point};
use super::runner::BenchError;
use crate::filter::hpsf::STATISTICS;
use crate::gpu::Gpu;
use crate::metrics::Estimate;
use crate::metrics::statistics::quantile;
use crate::scene::Scene;
use crate::technique::{RenderError, Renderer, Settings};
use std::collections::BTreeMap;

/// Of the point's last frame, with the first seed; nothing for techniques without a table.
///
/// # Errors
/// The device cannot render the point.
pub fn figures(gpu: &Gpu, scene: &Scene, settings: &Settings, point: &Point) -> Result<BTreeMap<String, Figure>, BenchError> {
    if !STATISTICS.iter().all(|name| settings.technique.extra_outputs.contains(name)) {
        return Ok(BTreeMap::new());
    }
    let settings = Settings { outputs: STATISTICS.map(str::to_owned).to_vec(), ..settings.clone() };
    let levels = settings.parameters.number("hpsf.levels");
    let mut renderer = Renderer::new(gpu, scene.clone(), settings)?;
    (0..point.frames).try_for_each(|_| renderer.render_frame())?;
    Ok(of_frame(&renderer, levels)?.into_iter().map(|(key, value)| named(key, Estimate::exact(value))).collect())
}

/// `levels`: insertions of a sample.
fn of_frame(renderer: &Renderer, levels: f64) -> Result<Vec<(&'static str, f64)>, RenderError> {
    let values = |name| -> Result<Vec<f64>, RenderError> {
        let pixels = renderer.output(name)?.map_or_else(Vec::new, |image| image.pixels);
        Ok(pixels.into_iter().map(|pixel| f64::from(pixel[0])).collect())
    };
    let sum = |name| values(name).map(|values| values.into_iter().sum::<f64>());
    let mut figures = vec![("occupancy", sum("hpsf_taken")? / sum("hpsf_slots")?)];
    let probed: Vec<f64> = values("hpsf_probed")?.into_iter().filter(|&probed| probed > 0.0).collect();
    // A view of the sky alone has no samples to insert.
    if !probed.is_empty() {
        let (samples, insertions) = (probed.len() as f64, probed.len() as f64 * levels);
        figures.push(("probes", probed.iter().sum::<f64>() / samples));
        figures.push(("probes_p99", quantile(probed, 0.99)));
        figures.push(("failed_insertions", sum("hpsf_failed")? / insertions));
        figures.push(("collisions", sum("hpsf_collided")? / insertions));
    }
    Ok(figures)
}
