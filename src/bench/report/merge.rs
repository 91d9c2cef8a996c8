//! Which of several records of one point counts.

use super::Measured;
use crate::bench::record::Provenance;
use std::collections::HashMap;

/// What keeps results apart: figures of two devices, drivers or versions of the program are never mixed.
pub type RunKey<'a> = [&'a str; 4];

pub fn run_key(provenance: &Provenance) -> RunKey<'_> {
    [&provenance.machine, &provenance.device, &provenance.driver, &provenance.commit]
}

/// The newest record of each point and run, in the order of first appearance. Of equally old ones, the last.
pub fn newest(measured: &[Measured]) -> Vec<&Measured> {
    let mut places = HashMap::new();
    let mut kept: Vec<&Measured> = Vec::new();
    for candidate in measured {
        let record = &candidate.record;
        let place = *places.entry((record.key.as_str(), run_key(&record.provenance))).or_insert(kept.len());
        match kept.get_mut(place) {
            None => kept.push(candidate),
            // RFC 3339 in UTC sorts as text.
            Some(old) if old.record.provenance.time <= record.provenance.time => *old = candidate,
            Some(_) => {}
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::report::fixtures::measured;

    fn at(key: &str, time: &str, change: impl FnOnce(&mut Provenance)) -> Measured {
        let mut measured = measured(key, "reference", 1, 1.0, 0.1);
        measured.record.provenance.time = time.to_owned();
        change(&mut measured.record.provenance);
        measured
    }

    #[test]
    fn the_newest_record_of_a_point_counts_in_whatever_order_they_come() {
        let old = at("a", "2026-01-01T00:00:00Z", |_| ());
        let new = at("a", "2026-02-01T00:00:00Z", |_| ());
        let other = at("b", "2025-01-01T00:00:00Z", |_| ());
        assert_eq!(newest(&[old.clone(), other.clone(), new.clone()]), [&new, &other]);
        assert_eq!(newest(&[new.clone(), old, other.clone()]), [&new, &other]);
    }

    #[test]
    fn machines_devices_drivers_and_commits_are_kept_apart() {
        let time = "2026-01-01T00:00:00Z";
        let all = [
            at("a", time, |_| ()),
            at("a", time, |provenance| provenance.machine = "other".to_owned()),
            at("a", time, |provenance| provenance.device = "other".to_owned()),
            at("a", time, |provenance| provenance.driver = "other".to_owned()),
            at("a", time, |provenance| provenance.commit = "other".to_owned()),
        ];
        assert_eq!(newest(&all).len(), all.len());
    }
}
