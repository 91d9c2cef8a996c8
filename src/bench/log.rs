//! The results of a run, `results.jsonl`: one [`Record`] a line, appended as soon as it is measured, so that a run may end at any moment
//! and lose at most the point that it was at.
//!
//! A record is whole when its newline is: it is written in one piece and synced before [`Log::append`] returns. What a killed writer left
//! of a line is cut off when the file is opened again. One lock makes two runners of one folder impossible.

use super::record::{Record, VERSION};
use std::borrow::Cow;
use std::collections::BTreeSet;
use std::fs::{File, OpenOptions};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

pub const FILE_NAME: &str = "results.jsonl";
/// Folders beside which a folder's shards keep their own files.
const SHARD_PREFIX: &str = "shard-";

/// A file of results that cannot be used: which one, and why.
#[derive(Debug, thiserror::Error)]
#[error("{}: {problem}", file.display())]
pub struct LogError {
    pub file: PathBuf,
    pub problem: Problem,
}

#[derive(Debug, thiserror::Error)]
pub enum Problem {
    #[error("cannot be read or written ({0}); check the path, its permissions and the space left")]
    Io(#[from] std::io::Error),
    #[error("another run is writing to it: wait for it, or choose another folder")]
    Locked,
    #[error("holds no {FILE_NAME}, neither by itself nor in folders {SHARD_PREFIX}*: give a folder that `pathspace bench` wrote")]
    NoResults,
    #[error("line {line} is not a record of results ({reason}); remove the line, or restore the file")]
    Corrupt { line: usize, reason: String },
    #[error("line {line} is a record of version {version}, this program knows version {VERSION}: use the program that wrote it")]
    UnknownVersion { line: usize, version: u32 },
    #[error("{what} of {scene}, {technique} is not finite, and would not survive in the file")]
    NotFinite { what: String, scene: String, technique: String },
}

impl Problem {
    fn in_file(self, file: &Path) -> LogError {
        LogError { file: file.to_owned(), problem: self }
    }
}

/// A file of results, open for one writer.
#[derive(Debug)]
pub struct Log {
    path: PathBuf,
    /// Locked for as long as it is open.
    file: File,
    finished: BTreeSet<String>,
}

impl Log {
    /// Creates or continues `directory/results.jsonl`, and the directory. An incomplete last line is cut off with a warning.
    pub fn open(directory: &Path) -> Result<Self, LogError> {
        let path = directory.join(FILE_NAME);
        Self::open_file(directory, &path).map_err(|problem| problem.in_file(&path))
    }

    fn open_file(directory: &Path, path: &Path) -> Result<Self, Problem> {
        std::fs::create_dir_all(directory)?;
        let mut file = OpenOptions::new().read(true).append(true).create(true).open(path)?;
        match fs4::FileExt::try_lock(&file) {
            Err(fs4::TryLockError::WouldBlock) => return Err(Problem::Locked),
            Err(fs4::TryLockError::Error(error)) => return Err(error.into()),
            Ok(()) => {}
        }
        // A new file's name is part of its directory, which needs a sync of its own.
        #[cfg(unix)]
        File::open(directory)?.sync_all()?;
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes)?;
        let Contents { records, whole } = parse(&bytes)?;
        if whole < bytes.len() {
            warn_of_cut(path, bytes.len() - whole);
            file.set_len(whole as u64)?;
        } else if bytes.last().is_some_and(|byte| *byte != b'\n') {
            file.write_all(b"\n")?;
        }
        file.sync_all()?;
        Ok(Log { path: path.to_owned(), file, finished: records.into_iter().map(|record| record.key).collect() })
    }

    /// Keys of all records in the file: what `--resume` need not measure again.
    pub fn finished(&self) -> &BTreeSet<String> {
        &self.finished
    }

    /// Adds a record, which is on the disk when this returns. After an error the file is as before.
    ///
    /// Numbers that are not finite have no JSON. A figure with one is left out with a warning, since the point's other figures are good;
    /// any other place is an error.
    pub fn append(&mut self, record: &Record) -> Result<(), LogError> {
        self.append_finite(&without_broken_figures(record)).map_err(|problem| problem.in_file(&self.path))
    }

    fn append_finite(&mut self, record: &Record) -> Result<(), Problem> {
        if let Some(what) = not_finite(record) {
            let (scene, technique) = (record.point.scene.clone(), record.point.technique.clone());
            return Err(Problem::NotFinite { what, scene, technique });
        }
        let mut line = serde_json::to_vec(record).map_err(std::io::Error::from)?;
        line.push(b'\n');
        let length = self.file.metadata()?.len();
        if let Err(error) = self.file.write_all(&line).and_then(|()| self.file.sync_data()) {
            self.file.set_len(length)?;
            return Err(error.into());
        }
        self.finished.insert(record.key.clone());
        Ok(())
    }
}

/// All records of a file, or of a folder: its own file and those of its shards, `shard-*/results.jsonl`. In their order; a key may come
/// several times. An incomplete last line, which a run may still be writing, is left out with a warning.
pub fn read(path: &Path) -> Result<Vec<Record>, LogError> {
    let files = if path.is_dir() { files_of(path).map_err(|error| Problem::Io(error).in_file(path))? } else { vec![path.to_owned()] };
    if files.is_empty() {
        return Err(Problem::NoResults.in_file(path));
    }
    let records: Result<Vec<_>, _> = files.iter().map(|file| read_file(file).map_err(|problem| problem.in_file(file))).collect();
    Ok(records?.concat())
}

fn read_file(path: &Path) -> Result<Vec<Record>, Problem> {
    let bytes = std::fs::read(path)?;
    let Contents { records, whole } = parse(&bytes)?;
    if whole < bytes.len() {
        warn_of_cut(path, bytes.len() - whole);
    }
    Ok(records)
}

/// The newest record of each key, in the order in which the keys first came. Times are RFC 3339 in UTC, whose order is the text's.
pub fn newest(records: Vec<Record>) -> Vec<Record> {
    let mut newest: Vec<Record> = Vec::new();
    for record in records {
        match newest.iter_mut().find(|known| known.key == record.key) {
            Some(known) if known.provenance.time <= record.provenance.time => *known = record,
            Some(_) => {}
            None => newest.push(record),
        }
    }
    newest
}

fn files_of(directory: &Path) -> std::io::Result<Vec<PathBuf>> {
    let mut files = vec![directory.join(FILE_NAME)];
    for entry in std::fs::read_dir(directory)? {
        let entry = entry?;
        if entry.file_name().to_string_lossy().starts_with(SHARD_PREFIX) {
            files.push(entry.path().join(FILE_NAME));
        }
    }
    files[1..].sort();
    files.retain(|file| file.is_file());
    Ok(files)
}

struct Contents {
    records: Vec<Record>,
    /// Bytes up to the end of the last whole record.
    whole: usize,
}

fn parse(bytes: &[u8]) -> Result<Contents, Problem> {
    let mut contents = Contents { records: Vec::new(), whole: 0 };
    for (index, line) in bytes.split_inclusive(|byte| *byte == b'\n').enumerate() {
        let end = contents.whole + line.len();
        match parse_line(line, index + 1) {
            Ok(record) => contents.records.push(record),
            Err(LineError::Torn(_)) if end == bytes.len() => return Ok(contents),
            Err(LineError::Torn(reason)) => return Err(Problem::Corrupt { line: index + 1, reason }),
            Err(LineError::Wrong(problem)) => return Err(problem),
        }
        contents.whole = end;
    }
    Ok(contents)
}

enum LineError {
    /// No JSON: what a killed writer leaves at the end of the file.
    Torn(String),
    /// JSON, but no record: nothing that cutting it off would mend.
    Wrong(Problem),
}

#[derive(serde::Deserialize)]
struct Versioned {
    version: u32,
}

fn parse_line(text: &[u8], line: usize) -> Result<Record, LineError> {
    let refuse = |error: serde_json::Error| {
        // The parser sees one line alone; its number would contradict the file's.
        let reason = error.to_string().replace(" at line 1 column ", " at column ");
        match error.is_data() {
            true => LineError::Wrong(Problem::Corrupt { line, reason }),
            false => LineError::Torn(reason),
        }
    };
    match serde_json::from_slice(text).map_err(refuse)? {
        Versioned { version: VERSION } => serde_json::from_slice(text).map_err(refuse),
        Versioned { version } => Err(LineError::Wrong(Problem::UnknownVersion { line, version })),
    }
}

fn warn_of_cut(path: &Path, bytes: usize) {
    tracing::warn!(
        "{}: the last line is incomplete ({bytes} bytes), as a run leaves it that was killed; it does not count",
        path.display()
    );
}

fn without_broken_figures(record: &Record) -> Cow<'_, Record> {
    if record.figures.values().all(super::Figure::is_finite) {
        return Cow::Borrowed(record);
    }
    let mut record = record.clone();
    record.figures.retain(|key, figure| {
        let finite = figure.is_finite();
        if !finite {
            tracing::warn!("{key} of {}, {} is not finite and left out", record.point.scene, record.point.technique);
        }
        finite
    });
    Cow::Owned(record)
}

/// The first number outside of figures that JSON cannot hold.
fn not_finite(record: &Record) -> Option<String> {
    let reference = [("standard error", record.reference.standard_error), ("ratio", record.reference.ratio)];
    let reference = reference.into_iter().map(|(name, value)| (format!("the reference's {name}"), value));
    let passes = record.passes.iter().flat_map(|pass| {
        let times = [("median", pass.median_ms), ("95th percentile", pass.p95_ms), ("spread", pass.spread_ms)];
        times.map(|(name, value)| (format!("the {name} of pass {}", pass.name), value))
    });
    reference.chain(passes).find(|(_, value)| !value.is_finite()).map(|(what, _)| what)
}
