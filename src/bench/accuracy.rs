//! A point's accuracy as figures of its record: what `metrics` makes of its pictures and the reference.

use super::figure;
use super::record::Figure;
use super::reference::Reference;
use super::runner::BenchError;
use super::shots::Shots;
use crate::display::{Image, ToneMapping};
use crate::metrics::accuracy::{self, Shot};
use crate::metrics::{self, ErrorMap, Estimate, MetricError, Pair, flip};
use std::collections::BTreeMap;

impl From<Estimate> for Figure {
    fn from(Estimate { value, low, high, samples }: Estimate) -> Self {
        Figure { value, low, high, samples, unit: String::new() }
    }
}

/// With its unit.
pub fn named(key: &str, estimate: Estimate) -> (String, Figure) {
    let unit = figure::find(key).map_or("", |kind| kind.unit).to_owned();
    (key.to_owned(), Figure { unit, ..estimate.into() })
}

/// Root of the pictures' mean squared relative error, the reference's own part taken out.
///
/// # Errors
/// Pictures of another size than the reference.
pub fn relative_error(pictures: &[Image], reference: &Reference) -> Result<f64, MetricError> {
    let error = |picture: &Image| Ok(metrics::relmse(&Pair::new(&picture.with_zeros(), &reference.mean)?, 0.0));
    let sum = pictures.iter().map(error).sum::<Result<f64, MetricError>>()?;
    Ok((sum / pictures.len() as f64 - reference.standard_error().powi(2)).max(0.0).sqrt())
}

/// Every figure of error, split, temporal error, faults and the reference. `before`: the reference of the frame before, where something moves.
///
/// # Errors
/// Pictures of another size than the reference.
pub fn figures(shots: &Shots, reference: &Reference, before: Option<&Reference>) -> Result<BTreeMap<String, Figure>, BenchError> {
    let mapping = ToneMapping::default();
    let truth =
        accuracy::Reference { mean: &reference.mean, variance: Some(&reference.variance), before: before.map(|reference| &reference.mean) };
    let last: Vec<Shot> = shots.last.iter().map(|last| Shot { last, before: None }).collect();
    let mut estimates = accuracy::accuracy(&last, &truth, &mapping)?;
    if let Some(temporal) = temporal(shots, before.map(|before| [before, reference]), &mapping)? {
        estimates.insert("temporal", temporal);
    }
    Ok(estimates.into_iter().map(|(key, estimate)| named(key, estimate)).collect())
}

fn temporal(shots: &Shots, references: Option<[&Reference; 2]>, mapping: &ToneMapping) -> Result<Option<Estimate>, MetricError> {
    let shown = |image: &Image| mapping.displayed(&image.with_zeros());
    let references = references.map(|pair| pair.map(|reference| shown(&reference.mean)));
    let error = |pair: &[Image; 2]| {
        let frames = pair.each_ref().map(shown);
        metrics::temporal(frames.each_ref(), references.as_ref().map(<[Image; 2]>::each_ref))
    };
    let errors = shots.pairs.iter().map(error).collect::<Result<Vec<_>, _>>()?;
    Ok(Estimate::mean(errors).ok())
}

/// Mean LDR-FLIP of the pictures as a screen shows them.
///
/// # Errors
/// Pictures of another size than the reference.
pub fn mean_flip(pictures: &[Image], reference: &Reference) -> Result<f64, MetricError> {
    let maps = pictures.iter().map(|picture| flip_map(picture, &reference.mean)).collect::<Result<Vec<_>, _>>()?;
    Ok(maps.iter().map(ErrorMap::mean).sum::<f64>() / maps.len() as f64)
}

/// LDR-FLIP of each pixel.
///
/// # Errors
/// Pictures of two sizes.
pub fn flip_map(picture: &Image, reference: &Image) -> Result<ErrorMap, MetricError> {
    let mapping = ToneMapping::default();
    let [picture, reference] = [&picture.with_zeros(), reference].map(|image| mapping.encoded(image));
    Ok(flip(&Pair::new(&picture, &reference)?))
}
