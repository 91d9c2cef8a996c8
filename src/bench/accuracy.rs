//! STUB
use super::record::Figure;
use super::reference::Reference;
use super::shots::Shots;
use crate::display::{Image, ToneMapping};
use crate::metrics::{self, Pair};
use std::collections::BTreeMap;

pub fn relative_error(pictures: &[Image], reference: &Reference) -> f64 {
    let clean: Vec<Image> = pictures.iter().map(|p| p.made_finite("a picture").into_owned()).collect();
    let sum: f64 = clean.iter().map(|p| metrics::relmse(&Pair::new(p, &reference.mean).unwrap(), 0.0)).sum();
    (sum / clean.len() as f64 - reference.standard_error().powi(2)).max(0.0).sqrt()
}
pub fn median_figure(samples: Vec<f64>) -> Figure {
    let v = metrics::statistics::quantile(samples.clone(), 0.5);
    Figure { value: v, low: v, high: v, unit: String::new(), samples }
}
pub fn figures(shots: &Shots, reference: &Reference, _before: Option<&Reference>, ratio: f64) -> BTreeMap<String, Figure> {
    let mapping = ToneMapping::default();
    let mut m: BTreeMap<String, Vec<f64>> = BTreeMap::new();
    for p in &shots.last {
        let p = p.made_finite("a picture");
        let pair = Pair::new(&p, &reference.mean).unwrap();
        m.entry("relmse".into()).or_default().push(metrics::relmse(&pair, 0.0));
        m.entry("energy".into()).or_default().push(metrics::mean_ratio(&pair));
        let (a, b) = (mapping.encoded(&p), mapping.encoded(&reference.mean));
        m.entry("flip".into()).or_default().push(metrics::flip(&Pair::new(&a, &b).unwrap()).mean);
    }
    let mut out: BTreeMap<String, Figure> = m.into_iter().map(|(k, s)| (k, median_figure(s))).collect();
    out.insert("reference_ratio".into(), Figure { value: ratio, low: ratio, high: ratio, unit: String::new(), samples: vec![] });
    out
}
pub fn heatmap(picture: &Image, reference: &Image, mapping: &ToneMapping) -> Vec<u8> {
    let (a, b) = (mapping.encoded(picture), mapping.encoded(reference));
    let e = metrics::flip(&Pair::new(&a, &b).unwrap()).heatmap();
    let mut v = Vec::new();
    image::write_buffer_with_format(
        &mut std::io::Cursor::new(&mut v),
        &e,
        picture.width,
        picture.height,
        image::ExtendedColorType::Rgb8,
        image::ImageFormat::Png,
    )
    .unwrap();
    v
}

/// Mean LDR-FLIP of the pictures as a screen shows them.
pub fn mean_flip(pictures: &[Image], reference: &Reference) -> f64 {
    let mapping = ToneMapping::default();
    let b = mapping.encoded(&reference.mean);
    let flip = |p: &Image| metrics::flip(&Pair::new(&mapping.encoded(&p.made_finite("a picture")), &b).unwrap()).mean;
    pictures.iter().map(flip).sum::<f64>() / pictures.len() as f64
}
