//! From a suite to the points that it measures, in the order of the runs, and their share in a shard.

use super::record::{Moves, Point, Switch};
use super::suite::{SceneRow, Suite, SuiteError, SwitchRow, TechniqueRow, Values};
use crate::technique::{self, Parameters, Technique};
use std::collections::{BTreeMap, HashSet};

/// A point and what it is part of.
#[derive(Debug, Clone, PartialEq)]
pub struct Planned {
    /// [`key_of`] the point.
    pub key: String,
    pub point: Point,
    /// Index into the suite's scenes.
    pub scene: usize,
}

impl Planned {
    /// Samples that all seeds take: what the point will cost, but for the scene.
    pub fn samples(&self, seeds: u32) -> u64 {
        let [width, height] = self.point.size.map(u64::from);
        width * height * u64::from(self.point.spp) * u64::from(self.point.frames) * u64::from(seeds)
    }
}

/// One part of a suite that runs by itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    /// From 1 to `of`.
    pub index: u32,
    pub of: u32,
}

impl std::str::FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts = text.split_once('/').and_then(|(index, of)| Some(Shard { index: index.parse().ok()?, of: of.parse().ok()? }));
        parts.filter(|shard| (1..=shard.of).contains(&shard.index)).ok_or_else(|| "expected K/N with K from 1 to N, such as 2/8".to_owned())
    }
}

/// The same for equal points, whatever the program's version.
pub fn key_of(point: &Point) -> String {
    let text = serde_json::to_vec(point).expect("a point is plain data");
    blake3::hash(&text).to_hex()[..16].to_owned()
}

/// Every point of the suite once; those of one scene and size together, so that they share a reference.
///
/// # Errors
/// A size, technique, parameter or value that there is not.
pub fn plan(suite: &Suite) -> Result<Vec<Planned>, SuiteError> {
    let mut points = Vec::new();
    for (index, scene) in suite.scenes.iter().enumerate() {
        for size in &suite.sizes {
            let size = parse_size(size).ok_or_else(|| wrong(suite, "sizes", format!("'{size}' is no WIDTHxHEIGHT")))?;
            let place = Place { suite, scene, size };
            for row in suite.techniques.iter().filter(|row| applies(&row.scenes, &scene.name, true)) {
                points.extend(place.techniques(row)?.into_iter().map(|point| (index, point)));
            }
            for row in suite.switches.iter().filter(|row| applies(&row.scenes, &scene.name, scene.moves == Moves::Nothing)) {
                points.extend(place.switches(row)?.into_iter().map(|point| (index, point)));
            }
        }
    }
    let mut seen = HashSet::new();
    let planned = points.into_iter().map(|(scene, point)| Planned { key: key_of(&point), point, scene });
    Ok(planned.filter(|planned| seen.insert(planned.key.clone())).collect())
}

/// A contiguous part of about the same cost as every other shard's: neighbours share references.
pub fn shard(points: Vec<Planned>, shard: Shard) -> Vec<Planned> {
    let cost = |planned: &Planned| planned.samples(1) as f64;
    let total: f64 = points.iter().map(cost).sum();
    let mut before = 0.0;
    let part = |planned: &Planned| {
        let middle = before + 0.5 * cost(planned);
        before += cost(planned);
        (middle / total * f64::from(shard.of)) as u32 + 1
    };
    let parts: Vec<u32> = points.iter().map(part).collect();
    points.into_iter().zip(parts).filter(|(_, part)| *part == shard.index).map(|(planned, _)| planned).collect()
}

fn applies(scenes: &Option<Vec<String>>, name: &str, otherwise: bool) -> bool {
    scenes.as_ref().map_or(otherwise, |names| names.iter().any(|known| known == name))
}

fn wrong(suite: &Suite, place: &str, reason: String) -> SuiteError {
    SuiteError::Wrong { suite: suite.name.clone(), place: place.to_owned(), reason }
}

fn parse_size(text: &str) -> Option<[u32; 2]> {
    let (width, height) = text.split_once('x')?;
    let side = |text: &str| text.parse().ok().filter(|side| (1..=16384).contains(side));
    Some([side(width)?, side(height)?])
}

/// Where points are made.
struct Place<'a> {
    suite: &'a Suite,
    scene: &'a SceneRow,
    size: [u32; 2],
}

impl Place<'_> {
    fn techniques(&self, row: &TechniqueRow) -> Result<Vec<Point>, SuiteError> {
        let chosen: Vec<&Technique> = match row.name.as_str() {
            "*" => technique::REGISTRY.iter().collect(),
            name => vec![self.technique(name)?],
        };
        let mut points = Vec::new();
        for technique in chosen {
            for settings in combinations(&row.settings, &row.grid) {
                self.check(technique, &settings)?;
                for &spp in &row.spp {
                    for frames in self.frames(technique, &row.frames) {
                        points.push(self.point(technique, spp, frames, settings.clone()));
                    }
                }
            }
        }
        Ok(points)
    }

    /// The base point, then each value.
    fn switches(&self, row: &SwitchRow) -> Result<Vec<Point>, SuiteError> {
        let technique = self.technique(&row.technique)?;
        self.check(technique, &row.settings)?;
        let frames = if self.scene.moves == Moves::Nothing { row.frames } else { self.frames(technique, &[]).last().copied().unwrap_or(1) };
        let mut base = self.point(technique, row.spp, frames, row.settings.clone());
        base.trace = row.trace.clone().unwrap_or(base.trace);
        let (base_key, base_value) = (key_of(&base), self.base_value(technique, row)?);
        let mut points = vec![base.clone()];
        for value in row.values.iter().filter(|value| **value != base_value) {
            let mut point = base.clone();
            if row.key == "effects" {
                point.all_effects = value == "all";
            } else {
                point.settings.insert(row.key.clone(), value.clone());
                self.check(technique, &point.settings)?;
            }
            point.switch =
                Some(Switch { key: row.key.clone(), value: value.clone(), base_value: base_value.clone(), base: base_key.clone() });
            points.push(point);
        }
        Ok(points)
    }

    fn base_value(&self, technique: &Technique, row: &SwitchRow) -> Result<String, SuiteError> {
        if row.key == "effects" {
            return Ok("auto".to_owned());
        }
        let parameters = self.check(technique, &row.settings)?;
        let parameter = Parameters::table().iter().find(|parameter| parameter.key == row.key);
        let unknown = || wrong(self.suite, "switches", format!("there is no parameter '{}'", row.key));
        Ok(parameters.value(parameter.ok_or_else(unknown)?))
    }

    fn technique(&self, name: &str) -> Result<&'static Technique, SuiteError> {
        let known = || technique::REGISTRY.iter().map(|technique| technique.name).collect::<Vec<_>>().join(", ");
        technique::find(name)
            .ok_or_else(|| wrong(self.suite, "techniques", format!("there is no technique '{name}'; there are {} and *", known())))
    }

    /// The settings as parameters.
    fn check(&self, technique: &Technique, settings: &Values) -> Result<Parameters, SuiteError> {
        let set = || {
            settings.iter().try_fold(technique.parameters(), |mut parameters, (key, value)| parameters.set(key, value).map(|()| parameters))
        };
        set().map_err(|error| wrong(self.suite, "settings", error.to_string()))
    }

    /// Frames that accumulate are one frame with more samples; where something moves, the whole sequence is shown.
    fn frames(&self, technique: &Technique, asked: &[u32]) -> Vec<u32> {
        match self.scene.moves {
            _ if technique.accumulates => vec![1],
            Moves::Nothing => asked.to_vec(),
            _ => vec![self.scene.frames],
        }
    }

    fn point(&self, technique: &Technique, spp: u32, frames: u32, settings: Values) -> Point {
        Point {
            scene: self.scene.name.clone(),
            source: self.scene.source.clone(),
            moves: self.scene.moves,
            size: self.size,
            technique: technique.name.to_owned(),
            spp,
            frames,
            trace: self.suite.trace.clone(),
            settings,
            all_effects: false,
            switch: None,
        }
    }
}

/// `settings` with every combination of the grid's values.
fn combinations(settings: &Values, grid: &BTreeMap<String, Vec<String>>) -> Vec<Values> {
    grid.iter().fold(vec![settings.clone()], |combinations, (key, values)| {
        let with = |base: &Values, value: &String| {
            let mut values = base.clone();
            values.insert(key.clone(), value.clone());
            values
        };
        combinations.iter().flat_map(|base| values.iter().map(move |value| with(base, value))).collect()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn standard() -> Vec<Planned> {
        plan(&Suite::load(None).unwrap()).unwrap()
    }

    #[test]
    fn the_suites_that_ship_are_of_registered_techniques_and_parameters() {
        let points = standard();
        for technique in &technique::REGISTRY {
            assert!(points.iter().any(|planned| planned.point.technique == technique.name), "{}", technique.name);
        }
        let quick = plan(&Suite::load(None).unwrap().quick()).unwrap();
        assert!(!quick.is_empty() && quick.len() < points.len() / 4);
        let papers = plan(&Suite::load(Some(std::path::Path::new("assets/suites/papers.toml"))).unwrap()).unwrap();
        assert!(papers.iter().any(|planned| planned.point.technique == "anhpsf"));
    }

    #[test]
    fn every_point_is_there_once_and_every_switch_has_its_base() {
        let points = standard();
        let keys: HashSet<&str> = points.iter().map(|planned| planned.key.as_str()).collect();
        assert_eq!(keys.len(), points.len());
        let switches: Vec<&Switch> = points.iter().filter_map(|planned| planned.point.switch.as_ref()).collect();
        assert!(switches.len() > 50 && switches.iter().all(|switch| keys.contains(switch.base.as_str())));
        assert!(switches.iter().all(|switch| switch.value != switch.base_value));
    }

    #[test]
    fn shards_share_nothing_and_leave_nothing_out() {
        let points = standard();
        for of in [1, 2, 7, 1000] {
            let parts: Vec<Planned> = (1..=of).flat_map(|index| shard(points.clone(), Shard { index, of })).collect();
            assert_eq!(parts, points, "{of}");
        }
        assert!("0/3".parse::<Shard>().is_err() && "4/3".parse::<Shard>().is_err() && "1".parse::<Shard>().is_err());
    }

    /// Results of two versions of the program are compared by it.
    #[test]
    fn the_key_of_a_point_stays_what_it_was() {
        let point = Point {
            scene: "a".to_owned(),
            source: "cornell".to_owned(),
            moves: Moves::Nothing,
            size: [2, 1],
            technique: "reference".to_owned(),
            spp: 1,
            frames: 1,
            trace: "auto".to_owned(),
            settings: Values::new(),
            all_effects: false,
            switch: None,
        };
        assert_eq!(key_of(&point), "c03b5bb52a17057e");
        assert_ne!(key_of(&point), key_of(&Point { spp: 2, ..point.clone() }));
    }

    #[test]
    fn grids_are_combined() {
        let grid = [("a", vec!["1", "2"]), ("b", vec!["3", "4", "5"])];
        let grid = grid.map(|(key, values)| (key.to_owned(), values.into_iter().map(str::to_owned).collect())).into();
        let base = Values::from([("c".to_owned(), "0".to_owned())]);
        let all = combinations(&base, &grid);
        assert_eq!(all.len(), 6);
        assert!(all.iter().all(|values| values.len() == 3));
    }
}
