//! The report in a browser: Chromium without a window, by its command line. `drive.js` plays the reader within the page.

use super::{command, results};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Debian's name, Ubuntu's, and the vendor's.
const BROWSERS: [&str; 3] = ["chromium", "chromium-browser", "google-chrome"];
const DRIVE: &str = include_str!("drive.js");

struct Page {
    dom: String,
    /// What scripts wrote there, and errors.
    console: Vec<String>,
}

fn browser() -> PathBuf {
    let path = std::env::var_os("PATH").unwrap_or_default();
    let found = BROWSERS.iter().find_map(|name| std::env::split_paths(&path).map(|folder| folder.join(name)).find(|file| file.is_file()));
    found.unwrap_or_else(|| panic!("none of {BROWSERS:?} is on the PATH: ./ci/setup installs one"))
}

/// Opens `page` from disk until its scripts are idle.
fn open(page: &Path, options: &[&str]) -> Page {
    let profile = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).unwrap();
    let output = Command::new(browser())
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking"])
        .args(["--disable-component-update", "--disable-sync", "--disable-dev-shm-usage", "--hide-scrollbars", "--enable-logging=stderr"])
        .args(["--virtual-time-budget=60000", "--dump-dom"])
        .arg(format!("--user-data-dir={}", profile.path().display()))
        .args(options)
        .arg(format!("file://{}", page.display()))
        .output()
        .unwrap();
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{stderr}");
    let console = stderr.lines().filter(|line| line.contains("CONSOLE")).map(str::to_owned).collect();
    Page { dom: String::from_utf8(output.stdout).unwrap(), console }
}

/// The report of made-up results under target/, where it can be looked at after the test.
fn make_report(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::remove_dir_all(&folder).ok();
    results::write(&folder.join("results"));
    let output = command::report(&folder, &["results", "-o", "report"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    folder
}

/// What `drive.js` found: each check's name and, if it failed, what was there instead.
fn findings(dom: &str) -> Vec<(String, Option<String>)> {
    let json = dom.split_once("<pre id=\"findings\">").and_then(|(_, rest)| rest.split_once("</pre>")).map(|(json, _)| json);
    let json = json.unwrap_or_else(|| panic!("drive.js did not come to its end: {dom}"));
    serde_json::from_str(&json.replace("&lt;", "<").replace("&gt;", ">").replace("&amp;", "&")).unwrap()
}

#[test]
fn a_reader_switches_views_looks_at_pictures_and_meets_no_error() {
    let folder = make_report("report-driven");
    let index = std::fs::read_to_string(folder.join("report/index.html")).unwrap();
    let driven = folder.join("report/driven.html");
    std::fs::write(folder.join("report/drive.js"), DRIVE).unwrap();
    std::fs::write(&driven, index.replace("</body>", "<script src=\"drive.js\"></script></body>")).unwrap();
    let page = open(&driven, &["--window-size=1280,900"]);
    assert!(page.console.is_empty(), "{:#?}", page.console);
    let findings = findings(&page.dom);
    let failed: Vec<_> = findings.iter().filter(|(_, instead)| instead.is_some()).collect();
    assert!(failed.is_empty(), "{failed:#?}");
    assert!(findings.len() >= 20, "only {} checks", findings.len());
}

#[test]
fn the_report_draws_in_light_and_dark() {
    let folder = make_report("report-drawn");
    let means = [("light", 1), ("dark", 0)].map(|(name, scheme)| {
        let screenshot = folder.join(format!("{name}.png"));
        let options = [format!("--screenshot={}", screenshot.display()), format!("--blink-settings=preferredColorScheme={scheme}")];
        let page = open(&folder.join("report/index.html"), &[&options[0], &options[1], "--window-size=1280,5200"]);
        assert!(page.console.is_empty(), "{:#?}", page.console);
        let picture = image::open(&screenshot).unwrap().to_luma8();
        picture.pixels().map(|pixel| f64::from(pixel.0[0])).sum::<f64>() / f64::from(picture.width() * picture.height())
    });
    assert!(means[0] > 200.0 && means[1] < 80.0, "mean of the page in light and dark: {means:?} of 255");
}

/// Width of A4 in CSS pixels.
const SHEET: u32 = 794;

#[test]
fn no_table_is_wider_than_a_printed_sheet() {
    let folder = make_report("report-printed").join("report");
    let style = std::fs::read_to_string(folder.join("style.css")).unwrap();
    assert!(style.contains("@media print"));
    std::fs::write(folder.join("printed.css"), style.replace("@media print", "@media all")).unwrap();
    let index = std::fs::read_to_string(folder.join("index.html")).unwrap();
    let measure = r#"<script>
        const width = ({ id, scrollWidth }) => [id, scrollWidth <= innerWidth ? null : `${scrollWidth} pixels`];
        const found = [...document.querySelectorAll(".scroll, figure")].map(width);
        document.body.append(Object.assign(document.createElement("pre"), { id: "findings", textContent: JSON.stringify(found) }));
    </script></body>"#;
    let printed = folder.join("printed.html");
    std::fs::write(&printed, index.replace("style.css", "printed.css").replace("</body>", measure)).unwrap();
    let findings = findings(&open(&printed, &[&format!("--window-size={SHEET},1123")]).dom);
    let wide: Vec<_> = findings.iter().filter(|(_, instead)| instead.is_some()).collect();
    assert!(wide.is_empty(), "{wide:?}");
    assert!(findings.iter().any(|(id, _)| id == "point-table"), "{findings:?}");
}
