//! The report: records in, one folder out that opens from disk in a browser, without a network.
//!
//! Everything that compares (merge, fronts, contests, prices) is computed here and goes into `data.js`; the scripts of assets/report
//! choose and draw.

mod contest;
mod folder;
mod loss;
mod merge;
mod page;
mod pictures;
mod points;
mod price;
mod views;
#[cfg(test)]
mod fixtures;

use super::figure::{FIGURES, FigureKind};
use super::record::Record;
use pictures::PictureSet;
use points::{PointData, Run};
use serde::Serialize;
use std::io;
use std::path::{Path, PathBuf};
use views::View;

/// A record, and the folder that its pictures' paths are relative to.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    pub record: Record,
    pub folder: PathBuf,
}

/// Why there is no report.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    #[error("there is nothing to report: no records")]
    NoRecords,
    #[error("the picture path '{path}' of {label} leads out of the folder of its results: it has to be relative, without '..'")]
    PictureOutside { path: String, label: String },
    #[error("cannot read the picture '{}' of {label}: copy the pictures along with results.jsonl", path.display())]
    Picture { path: PathBuf, label: String, source: io::Error },
    #[error("the picture '{}' of {label} is no PNG", path.display())]
    NotPng { path: PathBuf, label: String },
    #[error("'{}' exists and is no earlier report: name another folder with -o", .0.display())]
    Occupied(PathBuf),
    #[error("cannot write '{}'", path.display())]
    Write { path: PathBuf, source: io::Error },
}

/// What `data.js` holds.
#[derive(Serialize)]
struct Data<'a> {
    program: &'static str,
    figures: &'static [FigureKind],
    runs: Vec<Run<'a>>,
    points: Vec<PointData<'a>>,
    views: Vec<View<'a>>,
}

/// Makes the folder `out`, or replaces the report that is there, as a whole. After an error, `out` is as it was.
///
/// Of records with one key, measured by one commit on one device of one machine, the newest counts.
pub fn write(measured: &[Measured], out: &Path) -> Result<(), ReportError> {
    if measured.is_empty() {
        return Err(ReportError::NoRecords);
    }
    let merged = merge::newest(measured);
    let mut pictures = PictureSet::default();
    let (runs, points) = points::collect(&merged, &mut pictures)?;
    let records: Vec<&Record> = merged.iter().map(|measured| &measured.record).collect();
    let views = views::group(&records, &points);
    let data = Data { program: env!("CARGO_PKG_VERSION"), figures: FIGURES, runs, points, views };
    folder::replace(out, |new| {
        page::write(&data, new)?;
        pictures.write(new)
    })
}
