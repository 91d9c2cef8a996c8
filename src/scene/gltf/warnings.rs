//! Collects what loading repaired or skipped.

use crate::scene::Warning;

/// Warnings in order of first appearance; equal messages add their counts.
#[derive(Debug, Default)]
pub(super) struct Warnings(Vec<Warning>);

impl Warnings {
    pub fn add(&mut self, message: impl Into<String>) {
        self.add_count(message, 1);
    }

    /// Adds nothing where `count` is 0.
    pub fn add_count(&mut self, message: impl Into<String>, count: usize) {
        let (message, count) = (message.into(), count as u64);
        match self.0.iter_mut().find(|known| known.message == message) {
            Some(known) => known.count += count,
            None if count > 0 => self.0.push(Warning { message, count }),
            None => {}
        }
    }

    pub fn append(&mut self, other: Warnings) {
        other.0.into_iter().for_each(|warning| self.add_count(warning.message, warning.count as usize));
    }

    pub fn into_vec(self) -> Vec<Warning> {
        self.0
    }

    /// "; 3 x points skipped, ..." for the end of an error message, or nothing.
    pub fn summary(&self) -> String {
        let lines: Vec<String> = self.0.iter().map(|warning| format!("{} ({} x)", warning.message, warning.count)).collect();
        if lines.is_empty() { String::new() } else { format!("; {}", lines.join(", ")) }
    }
}
