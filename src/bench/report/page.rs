//! The page: its parts are in the binary, `data.js` is made.

use super::{Data, ReportError};
use std::path::Path;

macro_rules! parts {
    ($($name:literal),* $(,)?) => {
        &[$(($name, include_bytes!(concat!("../../../assets/report/", $name)))),*]
    };
}

/// (path within the report, contents).
static PARTS: &[(&str, &[u8])] = parts![
    "index.html",
    "style.css",
    "scripts/core.js",
    "scripts/state.js",
    "scripts/error_plot.js",
    "scripts/contests.js",
    "scripts/prices.js",
    "scripts/costs.js",
    "scripts/points.js",
    "scripts/pictures.js",
    "scripts/viewer.js",
    "scripts/profile.js",
    "scripts/provenance.js",
    "scripts/main.js",
    "vendor/d3.min.js",
    "vendor/plot.umd.min.js",
    "vendor/LICENSES.txt",
];

/// Everything but the pictures, into the empty folder `report`.
pub fn write(data: &Data, report: &Path) -> Result<(), ReportError> {
    for (name, contents) in PARTS {
        put(report, name, contents)?;
    }
    let json = serde_json::to_string(data).map_err(|error| ReportError::Write { path: report.join("data.js"), source: error.into() })?;
    put(report, "data.js", format!("window.report = {{ data: {json} }};\n").as_bytes())
}

fn put(report: &Path, name: &str, contents: &[u8]) -> Result<(), ReportError> {
    let path = report.join(name);
    let folder = path.parent().unwrap_or(report);
    std::fs::create_dir_all(folder).and_then(|()| std::fs::write(&path, contents)).map_err(|source| ReportError::Write { path, source })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_names_each_of_its_parts_and_nothing_from_elsewhere() {
        let text = |name: &str| {
            let (_, contents) = PARTS.iter().find(|part| part.0 == name).unwrap();
            std::str::from_utf8(contents).unwrap()
        };
        let page = text("index.html");
        for (name, _) in PARTS.iter().filter(|part| part.0.ends_with(".js") || part.0.ends_with(".css")) {
            assert!(page.contains(&format!("\"{name}\"")), "index.html does not load {name}");
        }
        assert!(!page.contains("http") && !text("style.css").contains("url("));
        let total: usize = PARTS.iter().map(|(_, contents)| contents.len()).sum();
        assert!(total < 2_000_000, "{total} bytes");
    }
}
