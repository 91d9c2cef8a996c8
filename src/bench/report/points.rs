//! Runs and points as the report shows them.

use super::merge::run_key;
use super::pictures::{PictureIds, PictureSet};
use super::{Measured, ReportError};
use crate::bench::record::{Figure, PassFigure, Point, Provenance, Record, ReferenceQuality};
use serde::Serialize;
use std::collections::BTreeMap;

/// Points that one commit measured on one device of one machine.
#[derive(Serialize)]
pub struct Run<'a> {
    /// Of its first point; only the time differs between points.
    pub provenance: &'a Provenance,
}

#[derive(Serialize)]
pub struct PointData<'a> {
    /// Index into the runs.
    pub run: usize,
    pub label: String,
    pub point: &'a Point,
    pub suite: &'a str,
    pub figures: BTreeMap<&'a str, Span>,
    pub passes: &'a [PassFigure],
    pub pictures: PictureIds,
    pub reference: &'a ReferenceQuality,
    pub command: &'a str,
    pub seeds: usize,
    pub time: &'a str,
}

/// A [`Figure`] without its samples.
#[derive(Serialize)]
pub struct Span {
    value: f64,
    low: f64,
    high: f64,
}

impl From<&Figure> for Span {
    fn from(&Figure { value, low, high, .. }: &Figure) -> Span {
        Span { value, low, high }
    }
}

/// In the order of `merged`. Pictures are read when the report is written, but must be there now.
pub fn collect<'a>(merged: &[&'a Measured], pictures: &mut PictureSet) -> Result<(Vec<Run<'a>>, Vec<PointData<'a>>), ReportError> {
    let mut runs: Vec<Run> = Vec::new();
    let mut points = Vec::new();
    let named = Named::of(merged);
    for Measured { record, folder } in merged {
        let known = runs.iter().position(|run| run_key(run.provenance) == run_key(&record.provenance));
        let run = known.unwrap_or_else(|| {
            runs.push(Run { provenance: &record.provenance });
            runs.len() - 1
        });
        let label = named.label(&record.point);
        let pictures = pictures.add(&record.pictures, folder, &format!("{} ({label})", record.point.scene))?;
        points.push(data(record, run, label, pictures));
    }
    Ok((runs, points))
}

fn data(record: &Record, run: usize, label: String, pictures: PictureIds) -> PointData<'_> {
    PointData {
        run,
        label,
        point: &record.point,
        suite: &record.suite,
        figures: record.figures.iter().map(|(key, figure)| (key.as_str(), figure.into())).collect(),
        passes: &record.passes,
        pictures,
        reference: &record.reference,
        command: &record.command,
        seeds: record.provenance.seeds.len(),
        time: &record.provenance.time,
    }
}

/// What labels have to name because it is not the same everywhere.
struct Named {
    frames: bool,
    trace: bool,
}

impl Named {
    fn of(merged: &[&Measured]) -> Named {
        let points = || merged.iter().map(|measured| &measured.record.point);
        let first = points().next();
        Named {
            frames: points().any(|point| Some(point.frames) != first.map(|first| first.frames)),
            trace: points().any(|point| Some(&point.trace) != first.map(|first| &first.trace)),
        }
    }

    /// What tells a point from the others of its scene and size, such as `unfiltered, 4 spp, 16 frames, clamp=8`.
    fn label(&self, point: &Point) -> String {
        let mut parts = vec![point.technique.clone(), format!("{} spp", point.spp)];
        if self.frames {
            parts.push(format!("{} frame{}", point.frames, if point.frames == 1 { "" } else { "s" }));
        }
        if self.trace {
            parts.push(point.trace.clone());
        }
        parts.extend(point.settings.iter().map(|(key, value)| format!("{key}={value}")));
        if point.all_effects {
            parts.push("all effects".to_owned());
        }
        if let Some(switch) = &point.switch
            && !point.settings.contains_key(&switch.key)
        {
            parts.push(format!("{}={}", switch.key, switch.value));
        }
        parts.join(", ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::report::fixtures::{measured, switched};

    #[test]
    fn labels_name_all_that_was_set_and_what_differs() {
        let mut base = measured("a", "unfiltered", 4, 1.0, 0.1);
        assert_eq!(Named::of(&[&base]).label(&base.record.point), "unfiltered, 4 spp");
        let other = base.clone();
        base.record.point.frames = 16;
        base.record.point.settings.insert("clamp".to_owned(), "8".to_owned());
        let mut switched = switched("b", &base, "mis", "0", 1.0, 0.1);
        assert_eq!(Named::of(&[&other, &switched]).label(&switched.record.point), "unfiltered, 4 spp, 16 frames, clamp=8, mis=0");
        switched.record.point.trace = "ray-query".to_owned();
        assert_eq!(Named::of(&[&base, &switched]).label(&switched.record.point), "unfiltered, 4 spp, ray-query, clamp=8, mis=0");
    }

    #[test]
    fn points_know_their_run() {
        let first = measured("a", "reference", 1, 1.0, 0.1);
        let mut second = measured("a", "reference", 1, 1.0, 0.1);
        second.record.provenance.commit = "other".to_owned();
        let (runs, points) = collect(&[&first, &second, &first], &mut PictureSet::default()).unwrap();
        assert_eq!(runs.len(), 2);
        assert_eq!(points.iter().map(|point| point.run).collect::<Vec<_>>(), [0, 1, 0]);
    }
}
