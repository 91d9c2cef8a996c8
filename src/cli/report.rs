//! `pathspace report`: results of measurements, as one folder for a browser.

use super::{Outcome, output};
use crate::bench::log;
use crate::bench::report::{self, Measured};
use std::path::{Path, PathBuf};

/// Make a report of measurements that opens in a browser, without a network
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Folders with a results.jsonl each; of several measurements of one point, the newest counts
    #[arg(required = true, value_name = "DIR")]
    results: Vec<PathBuf>,
    /// Folder to make, or an earlier report to replace [default: report, in the first DIR]
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
}

pub fn run(args: &Args) -> anyhow::Result<Outcome> {
    let out = args.output.clone().unwrap_or_else(|| args.results[0].join("report"));
    write(&args.results, &out)?;
    output::print_result(&out.join("index.html").display().to_string())?;
    Ok(Outcome::Done)
}

/// One report of the results in these folders.
pub fn write(results: &[PathBuf], out: &Path) -> anyhow::Result<()> {
    let mut measured = Vec::new();
    for folder in results {
        let records = log::read(&folder.join(log::FILE_NAME))?;
        measured.extend(records.into_iter().map(|record| Measured { record, folder: folder.clone() }));
    }
    Ok(report::write(&measured, out)?)
}
