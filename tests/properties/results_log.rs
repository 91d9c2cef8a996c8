//! results.jsonl: what was acknowledged stays, what was not finished goes, and nothing else does either.

use crate::records::{figure, record};
use pathspace::bench::log::{self, FILE_NAME, Log, Problem};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg32;
use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;
use tempfile::TempDir;

/// Where [`writer`] writes, if it is to.
const WRITER_FOLDER: &str = "PATHSPACE_TEST_WRITER";

/// A folder with the records a, b and c.
fn three_records() -> (TempDir, PathBuf) {
    let directory = tempfile::tempdir().unwrap();
    let mut log = Log::open(directory.path()).unwrap();
    for key in ["a", "b", "c"] {
        let mut record = record(key, "reference");
        record.figures.insert("frame_ms".to_owned(), figure(vec![0.1, 1.0 / 3.0, 1e-300]));
        log.append(&record).unwrap();
    }
    let file = directory.path().join(FILE_NAME);
    (directory, file)
}

fn keys(path: &Path) -> Vec<String> {
    log::read(path).unwrap().into_iter().map(|record| record.key).collect()
}

/// Not a test: the process that [`a_killed_writer_loses_nothing_that_it_acknowledged`] kills.
#[test]
#[ignore = "runs until it is killed"]
fn writer() {
    let Some(folder) = std::env::var_os(WRITER_FOLDER) else { return };
    let mut log = Log::open(Path::new(&folder)).unwrap();
    for i in log.finished().len().. {
        let mut record = record(&format!("key-{i}"), "reference");
        record.figures.insert("frame_ms".to_owned(), figure(vec![f64::from(i as u32); 200]));
        log.append(&record).unwrap();
        println!("acknowledged key-{i}");
        std::io::stdout().flush().unwrap();
    }
}

/// Appends in another process until killed after `life`; the keys that it acknowledged.
fn write_until_killed(folder: &Path, life: Duration) -> Vec<String> {
    let mut child = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "results_log::writer", "--ignored", "--nocapture"])
        .env(WRITER_FOLDER, folder)
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines().map_while(Result::ok);
    let acknowledged = |line: String| Some(line.split_once("acknowledged ")?.1.to_owned());
    // Its start takes as long as it likes; its life begins with the first record.
    let mut keys = vec![lines.by_ref().find_map(acknowledged).expect("the writer starts")];
    std::thread::sleep(life);
    child.kill().unwrap();
    child.wait().unwrap();
    keys.extend(lines.filter_map(acknowledged));
    keys
}

#[test]
fn a_killed_writer_loses_nothing_that_it_acknowledged() {
    let directory = tempfile::tempdir().unwrap();
    let mut rng = Pcg32::seed_from_u64(1);
    let mut acknowledged = Vec::new();
    for _ in 0..20 {
        acknowledged.extend(write_until_killed(directory.path(), Duration::from_micros(rng.random_range(0..30_000))));
        let log = Log::open(directory.path()).unwrap();
        for key in &acknowledged {
            assert!(log.finished().contains(key), "{key} is lost");
        }
        // At most the record that was being acknowledged when the writer died, each time.
        assert!(log.finished().len() <= acknowledged.len() + 20);
        assert_eq!(keys(directory.path()).len(), log.finished().len());
        acknowledged = log.finished().iter().cloned().collect();
    }
}

#[test]
fn records_come_back_as_they_went() {
    let (directory, _) = three_records();
    let samples = &log::read(directory.path()).unwrap()[0].figures["frame_ms"].samples;
    // serde_json reads numbers to the last place but one.
    assert!(samples.iter().zip([0.1, 1.0 / 3.0, 1e-300]).all(|(read, written)| (read / written - 1.0).abs() < 1e-15), "{samples:?}");
    assert_eq!(keys(directory.path()), ["a", "b", "c"]);
}

#[test]
fn a_last_line_cut_anywhere_goes_and_the_others_stay() {
    let (directory, file) = three_records();
    let whole = fs::read(&file).unwrap();
    let last = whole[..whole.len() - 1].iter().rposition(|byte| *byte == b'\n').unwrap() + 1;
    for end in last..whole.len() {
        fs::write(&file, &whole[..end]).unwrap();
        // Without its newline, the record is complete nevertheless.
        let expected: &[&str] = if end == whole.len() - 1 { &["a", "b", "c"] } else { &["a", "b"] };
        assert_eq!(keys(&file), expected, "{end}");
        assert_eq!(fs::read(&file).unwrap().len(), end, "reading changes nothing");
        let mut log = Log::open(directory.path()).unwrap();
        assert_eq!(log.finished().iter().collect::<Vec<_>>(), expected, "{end}");
        log.append(&record("d", "reference")).unwrap();
        assert_eq!(keys(&file), [expected, &["d"]].concat(), "{end}");
    }
}

#[test]
fn damage_elsewhere_is_an_error_and_nothing_is_touched() {
    let (directory, file) = three_records();
    let whole = fs::read_to_string(&file).unwrap();
    let lines: Vec<&str> = whole.lines().collect();
    let refused = |text: String, hint: &str| {
        fs::write(&file, &text).unwrap();
        let message = Log::open(directory.path()).unwrap_err().to_string();
        assert!(message.contains(hint) && message.contains(FILE_NAME), "{message}");
        assert!(log::read(directory.path()).unwrap_err().to_string().contains(hint));
        assert_eq!(fs::read_to_string(&file).unwrap(), text);
    };
    refused(format!("{}\n{}\n{}\n", lines[0], &lines[1][..99], lines[2]), "line 2 is not a record");
    refused(format!("{}\n{{\"version\":1}}\n", lines[0]), "line 2 is not a record");
    refused(format!("{}\n{}\n", lines[0], lines[1].replacen("\"version\":1", "\"version\":2", 1)), "line 2 is a record of version 2");
}

#[test]
fn one_file_has_one_writer() {
    let (directory, _) = three_records();
    let first = Log::open(directory.path()).unwrap();
    assert!(matches!(Log::open(directory.path()).unwrap_err().problem, Problem::Locked));
    drop(first);
    Log::open(directory.path()).unwrap();
}

#[test]
fn numbers_that_are_not_finite_stay_out() {
    let (directory, _) = three_records();
    let mut log = Log::open(directory.path()).unwrap();
    let mut broken = record("d", "reference");
    broken.reference.ratio = f64::INFINITY;
    assert!(log.append(&broken).unwrap_err().to_string().contains("the reference's ratio"));
    assert!(!log.finished().contains("d"));
    let mut partly = record("e", "reference");
    partly.figures.insert("mse".to_owned(), figure(vec![1.0, f64::NAN]));
    partly.figures.insert("flip".to_owned(), figure(vec![0.1, 0.2]));
    log.append(&partly).unwrap();
    let records = log::read(directory.path()).unwrap();
    assert_eq!(records.last().unwrap().figures.keys().collect::<Vec<_>>(), ["flip"]);
}

#[test]
fn a_folder_of_shards_reads_as_one_and_the_newest_record_counts() {
    let directory = tempfile::tempdir().unwrap();
    let mut older = record("a", "reference");
    older.provenance.time = "2025-01-01T00:00:00Z".to_owned();
    for (shard, record) in [("shard-1", record("a", "reference")), ("shard-2", older), ("shard-10", record("b", "reference"))] {
        Log::open(&directory.path().join(shard)).unwrap().append(&record).unwrap();
    }
    let records = log::read(directory.path()).unwrap();
    assert_eq!(records.len(), 3);
    let newest = log::newest(records);
    assert_eq!(newest.iter().map(|record| &record.key).collect::<Vec<_>>(), ["a", "b"]);
    assert!(newest[0].provenance.time.starts_with("2026"));
    assert!(matches!(log::read(tempfile::tempdir().unwrap().path()).unwrap_err().problem, Problem::NoResults));
}
