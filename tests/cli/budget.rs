//! `pathspace render --budget-ms`, `--target-flip`: what is chosen, and what it says of it. Times decide nothing here.

use super::{assert_refused, run};
use pathspace::display::exr_file::ExrFile;

#[test]
fn a_budget_chooses_a_technique_says_why_and_tells_how_it_went() {
    let directory = tempfile::tempdir().unwrap();
    let render = |extra: &[&str]| {
        let common = ["render", "cornell", "-o", "a.exr", "--size", "32x32", "--timings", "t.json", "--frames", "12"];
        let done = run(directory.path(), &[&common, extra].concat());
        assert_eq!(done.code, Some(0), "{}", done.stderr);
        done.stdout
    };
    let rich = render(&["--budget-ms", "50", "--calibrate"]);
    assert!(rich.starts_with("chosen for 50 ms: "), "{rich}");
    assert!(rich.contains(" samples per pixel, predicted ") && rich.contains("budget 50 ms, median "), "{rich}");
    let picture = ExrFile::read(std::fs::File::open(directory.path().join("a.exr")).unwrap()).unwrap();
    let technique = picture.attribute("technique").expect("it names its technique");
    assert!(rich.starts_with(&format!("chosen for 50 ms: {technique} at ")), "{technique}: {rich}");
    let poor = render(&["--budget-ms", "0.000001"]);
    assert!(poor.contains("nothing keeps to the budget; this is the cheapest"), "{poor}");
    let modest = render(&["--target-flip", "0.99"]);
    assert!(modest.contains("at 1.00 samples per pixel") && modest.contains("the cheapest that reaches the target"), "{modest}");
}

#[test]
fn budgets_that_are_none_are_refused() {
    let directory = tempfile::tempdir().unwrap();
    for (option, value) in [("--budget-ms", "0"), ("--budget-ms", "nan"), ("--target-flip", "-1"), ("--target-flip", "inf")] {
        assert_refused(directory.path(), &["render", "-o", "a.png", &format!("{option}={value}")], &["finite number above 0"]);
    }
    assert_refused(directory.path(), &["render", "-o", "a.png", "--budget-ms", "5", "--spp", "4"], &["--spp"]);
    assert_refused(directory.path(), &["render", "-o", "a.png", "--budget-ms", "5", "--technique", "reference"], &["--technique"]);
    assert_refused(directory.path(), &["render", "-o", "a.png", "--calibrate"], &["--budget-ms"]);
}
