//! STUB
use super::record::Record;
use std::path::Path;
#[derive(Debug, thiserror::Error)]
pub enum LogError {
    #[error(transparent)]
    Io(#[from] std::io::Error),
}
pub struct Log {
    path: std::path::PathBuf,
    keys: std::collections::HashSet<String>,
}
impl Log {
    pub fn open(folder: &Path) -> Result<Self, LogError> {
        std::fs::create_dir_all(folder)?;
        let path = folder.join("results.jsonl");
        let keys = std::fs::read_to_string(&path)
            .unwrap_or_default()
            .lines()
            .filter_map(|l| serde_json::from_str::<Record>(l).ok())
            .map(|r| r.key)
            .collect();
        Ok(Self { path, keys })
    }
    pub fn append(&mut self, record: &Record) -> Result<(), LogError> {
        use std::io::Write;
        let mut f = std::fs::OpenOptions::new().append(true).create(true).open(&self.path)?;
        writeln!(f, "{}", serde_json::to_string(record).unwrap())?;
        Ok(())
    }
    pub fn finished(&self) -> &std::collections::HashSet<String> {
        &self.keys
    }
}
