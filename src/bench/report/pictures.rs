//! Pictures of the report. Browsers do not let a page from disk read the pixels of pictures beside it, so that each picture is a
//! script that hands the page its PNG as a data URL; they are loaded when they are looked at.

use super::ReportError;
use crate::bench::record::Pictures;
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use image::ImageFormat;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};

const FOLDER: &str = "pictures";

/// Of one point; none where the record names no file.
#[derive(Serialize)]
pub struct PictureIds {
    picture: Option<usize>,
    reference: Option<usize>,
    heatmap: Option<usize>,
}

/// Every file once, whoever shows it.
#[derive(Default)]
pub struct PictureSet {
    files: BTreeMap<PathBuf, Listed>,
}

struct Listed {
    id: usize,
    /// Who named it first, for errors.
    label: String,
}

impl PictureSet {
    pub fn add(&mut self, pictures: &Pictures, folder: &Path, label: &str) -> Result<PictureIds, ReportError> {
        let mut id = |path: &str| self.id(path, folder, label);
        Ok(PictureIds { picture: id(&pictures.picture)?, reference: id(&pictures.reference)?, heatmap: id(&pictures.heatmap)? })
    }

    fn id(&mut self, path: &str, folder: &Path, label: &str) -> Result<Option<usize>, ReportError> {
        if path.is_empty() {
            return Ok(None);
        }
        if !Path::new(path).components().all(|component| matches!(component, Component::Normal(_) | Component::CurDir)) {
            return Err(ReportError::PictureOutside { path: path.to_owned(), label: label.to_owned() });
        }
        let next = self.files.len();
        let listed = self.files.entry(folder.join(path)).or_insert_with(|| Listed { id: next, label: label.to_owned() });
        Ok(Some(listed.id))
    }

    /// Writes `pictures/ID.js` into `report`.
    pub fn write(&self, report: &Path) -> Result<(), ReportError> {
        let folder = report.join(FOLDER);
        let failed = |path: &Path| {
            let path = path.to_owned();
            move |source| ReportError::Write { path, source }
        };
        std::fs::create_dir(&folder).map_err(failed(&folder))?;
        for (path, Listed { id, label }) in &self.files {
            let png = read_png(path, label)?;
            let script = format!("report.pictures.arrived({id}, \"data:image/png;base64,{}\");\n", BASE64_STANDARD.encode(png));
            let target = folder.join(format!("{id}.js"));
            std::fs::write(&target, script).map_err(failed(&target))?;
        }
        Ok(())
    }
}

fn read_png(path: &Path, label: &str) -> Result<Vec<u8>, ReportError> {
    let (path, label) = (path.to_owned(), label.to_owned());
    let bytes = match std::fs::read(&path) {
        Ok(bytes) => bytes,
        Err(source) => return Err(ReportError::Picture { path, label, source }),
    };
    match image::guess_format(&bytes) {
        Ok(ImageFormat::Png) => Ok(bytes),
        _ => Err(ReportError::NotPng { path, label }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_file_is_one_picture_and_no_name_is_none() {
        let mut set = PictureSet::default();
        let pictures = Pictures { picture: "a.png".to_owned(), reference: "r/a.png".to_owned(), heatmap: String::new() };
        let first = set.add(&pictures, Path::new("one"), "a").unwrap();
        assert_eq!((first.picture, first.reference, first.heatmap), (Some(0), Some(1), None));
        let again = set.add(&pictures, Path::new("one"), "b").unwrap();
        assert_eq!((again.picture, again.reference), (Some(0), Some(1)));
        assert_eq!(set.add(&pictures, Path::new("two"), "c").unwrap().picture, Some(2));
    }

    #[test]
    fn paths_stay_within_the_folder_of_the_results() {
        for path in ["../a.png", "/a.png", "b/../../a.png"] {
            let pictures = Pictures { picture: path.to_owned(), ..Pictures::default() };
            let refused = PictureSet::default().add(&pictures, Path::new("one"), "a");
            assert!(matches!(refused, Err(ReportError::PictureOutside { .. })), "{path}");
        }
    }
}
