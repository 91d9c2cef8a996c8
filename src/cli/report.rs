//! `pathspace report`: results of measurements, as one folder for a browser.

use super::{Outcome, output};
use crate::bench::record::{self, Record};
use crate::bench::report::{self, Measured};
use anyhow::{Context, bail};
use std::path::{Path, PathBuf};

/// In each folder of results.
const LOG: &str = "results.jsonl";

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
        let records = read_log(&folder.join(LOG))?;
        measured.extend(records.into_iter().map(|record| Measured { record, folder: folder.clone() }));
    }
    Ok(report::write(&measured, out)?)
}

fn read_log(path: &Path) -> anyhow::Result<Vec<Record>> {
    let text = std::fs::read_to_string(path).with_context(|| format!("cannot read the results '{}'", path.display()))?;
    let lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
    lines.map(|(index, line)| parse(line).with_context(|| format!("line {} of '{}' is no record", index + 1, path.display()))).collect()
}

fn parse(line: &str) -> anyhow::Result<Record> {
    let record: Record = serde_json::from_str(line)?;
    if record.version != record::VERSION {
        bail!("it has version {}, and this program reads {}", record.version, record::VERSION);
    }
    Ok(record)
}
