//! Everything that is said about the accuracy of pictures of independent seeds, at once.

use super::estimate::Estimate;
use super::flip::{flip_of_each, hdr::hdr_flip_of_each};
use super::relmse::{WORST_TRIMMED, weight};
use super::split::{Weighting, split};
use super::{ErrorMap, Faults, MetricError, Pair, mean_ratio, mse, psnr, relmse, rmse_tonemapped, ssim, temporal};
use crate::display::{Image, ToneMapping};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// What one seed made.
#[derive(Debug, Clone, Copy)]
pub struct Shot<'a> {
    /// Radiance; may hold what is not finite.
    pub last: &'a Image,
    /// The frame before the last, for the temporal error.
    pub before: Option<&'a Image>,
}

/// What all should have made: finite radiance.
#[derive(Debug, Clone, Copy)]
pub struct Reference<'a> {
    pub mean: &'a Image,
    /// Of `mean`, for each pixel; without it the reference is taken as exact.
    pub variance: Option<&'a Image>,
    /// Of the frame before the last, where anything moves; without it the temporal error takes any change for one.
    pub before: Option<&'a Image>,
}

impl Reference<'_> {
    /// Over pixels and channels, with the interval that its own noise leaves. A pixel's channels come from the same paths: their errors add up.
    fn mean_radiance(&self) -> Estimate {
        let count = self.mean.pixels.len() as f64;
        let over_channels = |pixel: &[f32; 3], of: fn(f64) -> f64| pixel.iter().map(|&value| of(f64::from(value))).sum::<f64>() / 3.0;
        let radiance = self.mean.pixels.iter().map(|pixel| over_channels(pixel, |radiance| radiance)).sum::<f64>() / count;
        let variances = self.variance.iter().flat_map(|variance| &variance.pixels);
        // Rounding may leave a variance of nearly 0 below it.
        let deviation = |variance: f64| variance.max(0.0).sqrt();
        let variance = variances.map(|pixel| over_channels(pixel, deviation).powi(2)).sum::<f64>() / count.powi(2);
        Estimate::exact(radiance).widened(variance.sqrt())
    }
}

/// By the keys of the groups Error, Split, Temporal, Fault and Reference of `bench::figure::FIGURES`.
pub type Figures = BTreeMap<&'static str, Estimate>;

/// Means over seeds with their intervals; faults are totals.
///
/// Channels that are not finite are counted as faults, then become 0. Missing is what cannot be measured or is not finite: SSIM of
/// pictures below 11x11 pixels, PSNR where one seed is perfect, energy over a black reference, bias2 and variance of one seed, the
/// temporal error where a seed has no frame before its last.
pub fn accuracy(shots: &[Shot], reference: &Reference, mapping: &ToneMapping) -> Result<Figures, MetricError> {
    if shots.is_empty() {
        return Err(MetricError::TooFewPictures { given: 0, needed: 1 });
    }
    let repaired: Vec<Image> = shots.iter().map(|shot| shot.last.with_zeros()).collect();
    let images: Vec<&Image> = repaired.iter().collect();
    let pairs = images.iter().map(|image| Pair::new(image, reference.mean)).collect::<Result<Vec<_>, _>>()?;
    let mut samples = Samples::default();
    samples.add_radiance(&pairs);
    samples.add_displayed(&images, reference.mean, mapping)?;
    samples.add_map(["hdr_flip", "hdr_flip_p99", "hdr_flip_worst_tile"], &hdr_flip_of_each(&images, reference.mean));
    samples.add_temporal(shots, reference, mapping)?;
    samples.add_reference_ratio(&pairs, reference)?;
    let mut figures = samples.figures();
    figures.extend(faults(shots));
    figures.insert("reference_radiance", reference.mean_radiance());
    if images.len() > 1 {
        let parts = split(&images, reference.mean, reference.variance, Weighting::Relative)?;
        figures.extend([("bias2", parts.bias2), ("variance", parts.variance)]);
    }
    Ok(figures)
}

/// One value per seed for each key.
#[derive(Default)]
struct Samples(BTreeMap<&'static str, Vec<f64>>);

impl Samples {
    fn add<'a>(&mut self, key: &'static str, pairs: &[Pair<'a>], figure: impl Fn(&Pair<'a>) -> f64 + Send + Sync) {
        self.0.insert(key, pairs.par_iter().map(figure).collect());
    }

    fn add_radiance(&mut self, radiance: &[Pair]) {
        self.add("mse", radiance, mse);
        self.add("relmse", radiance, |pair| relmse(pair, 0.0));
        self.add("relmse_trimmed", radiance, |pair| relmse(pair, WORST_TRIMMED));
        self.add("energy", radiance, mean_ratio);
    }

    fn add_displayed(&mut self, images: &[&Image], reference: &Image, mapping: &ToneMapping) -> Result<(), MetricError> {
        let [displayed, encoded] = [ToneMapping::displayed, ToneMapping::encoded]
            .map(|mapped| (images.iter().map(|image| mapped(mapping, image)).collect::<Vec<_>>(), mapped(mapping, reference)));
        self.add("rmse_tonemapped", &pairs_with(&displayed.0, &displayed.1)?, rmse_tonemapped);
        let pairs = pairs_with(&encoded.0, &encoded.1)?;
        self.add("psnr", &pairs, psnr);
        // Pictures too small for it leave NaN, which no figure is made of.
        self.add("ssim", &pairs, |pair| ssim(pair).unwrap_or(f64::NAN));
        let maps = flip_of_each(&encoded.0.iter().collect::<Vec<_>>(), &encoded.1);
        self.add_map(["flip", "flip_p99", "flip_worst_tile"], &maps);
        Ok(())
    }

    fn add_map(&mut self, keys: [&'static str; 3], maps: &[ErrorMap]) {
        let sums: [fn(&ErrorMap) -> f64; 3] = [ErrorMap::mean, ErrorMap::percentile_99, ErrorMap::worst_tile];
        self.0.extend(keys.into_iter().zip(sums).map(|(key, sum)| (key, maps.iter().map(sum).collect())));
    }

    fn add_temporal(&mut self, shots: &[Shot], reference: &Reference, mapping: &ToneMapping) -> Result<(), MetricError> {
        let shown = |image: &Image| mapping.displayed(&image.with_zeros());
        let references = reference.before.map(|before| [before, reference.mean].map(shown));
        let error = |shot: &Shot| {
            let frames = [shot.before?, shot.last].map(shown);
            Some(temporal(frames.each_ref(), references.as_ref().map(<[Image; 2]>::each_ref)))
        };
        if let Some(errors) = shots.iter().map(error).collect::<Option<Vec<_>>>() {
            self.0.insert("temporal", errors.into_iter().collect::<Result<_, _>>()?);
        }
        Ok(())
    }

    /// Root of relMSE over the reference's standard error, relative in the same way.
    fn add_reference_ratio(&mut self, radiance: &[Pair], reference: &Reference) -> Result<(), MetricError> {
        let Some(variance) = reference.variance else { return Ok(()) };
        let variances = Pair::new(variance, reference.mean)?.pixel_errors(|variance, mean| variance * weight(mean));
        let own = variances.iter().sum::<f64>() / variances.len() as f64;
        self.add("reference_ratio", radiance, |pair| (relmse(pair, 0.0) / own).sqrt());
        Ok(())
    }

    fn figures(self) -> Figures {
        self.0.into_iter().filter_map(|(key, samples)| Some((key, Estimate::mean(samples).ok()?))).collect()
    }
}

fn pairs_with<'a>(images: &'a [Image], reference: &'a Image) -> Result<Vec<Pair<'a>>, MetricError> {
    images.iter().map(|image| Pair::new(image, reference)).collect()
}

fn faults(shots: &[Shot]) -> [(&'static str, Estimate); 3] {
    let faults: Vec<Faults> = shots.iter().map(|shot| Faults::of(shot.last)).collect();
    let total = |count: fn(&Faults) -> usize| {
        let samples: Vec<f64> = faults.iter().map(|faults| count(faults) as f64).collect();
        Estimate { samples: samples.clone(), ..Estimate::exact(samples.iter().sum()) }
    };
    [("nan", total(|faults| faults.nan)), ("infinite", total(|faults| faults.infinite)), ("negative", total(|faults| faults.negative))]
}
