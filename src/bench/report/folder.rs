//! A folder that appears as a whole, or not at all.

use super::ReportError;
use std::io;
use std::path::{Path, PathBuf};

/// Files that tell an earlier report, which may be replaced, from a folder of somebody's.
const MARKS: [&str; 2] = ["index.html", "data.js"];

/// `fill` gets an empty folder beside `out`, which becomes `out` once it has succeeded.
pub fn replace(out: &Path, fill: impl FnOnce(&Path) -> Result<(), ReportError>) -> Result<(), ReportError> {
    let failed = |source: io::Error| ReportError::Write { path: out.to_owned(), source };
    if !is_replaceable(out).map_err(failed)? {
        return Err(ReportError::Occupied(out.to_owned()));
    }
    let parent = match out.parent() {
        Some(parent) if parent != Path::new("") => parent,
        _ => Path::new("."),
    };
    std::fs::create_dir_all(parent).map_err(failed)?;
    let new = temporary(parent).map_err(failed)?;
    fill(new.path())?;
    swap(out, parent, new).map_err(failed)
}

fn is_replaceable(out: &Path) -> io::Result<bool> {
    match std::fs::read_dir(out) {
        Ok(mut entries) => Ok(MARKS.iter().all(|mark| out.join(mark).is_file()) || entries.next().is_none()),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(true),
        Err(error) if error.kind() == io::ErrorKind::NotADirectory => Ok(false),
        Err(error) => Err(error),
    }
}

fn temporary(parent: &Path) -> io::Result<tempfile::TempDir> {
    let mut builder = tempfile::Builder::new();
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o777));
    builder.prefix(".pathspace-report-").tempdir_in(parent)
}

/// Folders cannot be renamed onto each other: the old one steps aside, and comes back if the new one cannot take its place.
fn swap(out: &Path, parent: &Path, new: tempfile::TempDir) -> io::Result<()> {
    let aside = temporary(parent)?;
    let old: PathBuf = aside.path().join("old");
    let had_old = out.exists();
    if had_old {
        std::fs::rename(out, &old)?;
    }
    std::fs::rename(new.path(), out).inspect_err(|_| {
        if had_old {
            std::fs::rename(&old, out).ok();
        }
    })?;
    // Its place is taken: nothing is left to remove.
    let _ = new.keep();
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    fn report(folder: &Path, text: &str) -> Result<(), ReportError> {
        MARKS.iter().for_each(|mark| std::fs::write(folder.join(mark), text).unwrap());
        Ok(())
    }

    #[test]
    fn a_report_replaces_a_report_and_leaves_nothing_beside_it() {
        let directory = tempfile::tempdir().unwrap();
        let out = directory.path().join("deep/report");
        replace(&out, |new| report(new, "old")).unwrap();
        std::fs::write(out.join("left"), "").unwrap();
        replace(&out, |new| report(new, "new")).unwrap();
        assert_eq!(names(&out), ["data.js", "index.html"]);
        assert_eq!(std::fs::read_to_string(out.join("data.js")).unwrap(), "new");
        assert_eq!(names(out.parent().unwrap()), ["report"]);
    }

    #[test]
    fn a_failure_leaves_the_old_report() {
        let directory = tempfile::tempdir().unwrap();
        let out = directory.path().join("report");
        replace(&out, |new| report(new, "old")).unwrap();
        let failed = replace(&out, |new| report(new, "new").and(Err(ReportError::NoRecords)));
        assert!(matches!(failed, Err(ReportError::NoRecords)));
        assert_eq!(std::fs::read_to_string(out.join("data.js")).unwrap(), "old");
        assert_eq!(names(directory.path()), ["report"]);
    }

    #[test]
    fn a_folder_of_somebody_is_not_replaced() {
        let directory = tempfile::tempdir().unwrap();
        let out = directory.path().join("photos");
        std::fs::create_dir(&out).unwrap();
        replace(&out, |new| report(new, "in an empty folder")).unwrap();
        std::fs::remove_file(out.join("data.js")).unwrap();
        assert!(matches!(replace(&out, |new| report(new, "new")), Err(ReportError::Occupied(_))));
        assert!(matches!(replace(&out.join("index.html"), |new| report(new, "new")), Err(ReportError::Occupied(_))));
        assert_eq!(names(&out), ["index.html"]);
    }
}
