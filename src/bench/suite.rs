//! What to measure, as a TOML file says it: scenes x techniques x parameters x sizes x frames, and switches, each alone.

use super::record::Moves;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The suite that ships.
pub const STANDARD: &str = include_str!("../../assets/suites/standard.toml");
/// Of suite files.
const VERSION: u32 = 1;

/// Parameter to value, as `--set` takes them.
pub type Values = BTreeMap<String, String>;

/// A suite file. README.md describes its keys.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Suite {
    pub version: u32,
    pub name: String,
    /// Pixels, `WIDTHxHEIGHT`.
    pub sizes: Vec<String>,
    /// Independent repetitions of each point.
    pub seeds: u32,
    /// Acceleration structure, or `auto`.
    #[serde(default = "auto")]
    pub trace: String,
    pub reference: ReferenceRule,
    pub scenes: Vec<SceneRow>,
    pub techniques: Vec<TechniqueRow>,
    #[serde(default)]
    pub switches: Vec<SwitchRow>,
    /// What `--quick` replaces.
    #[serde(default)]
    pub quick: Quick,
    /// Scenes' files are relative to it.
    #[serde(skip)]
    pub folder: PathBuf,
}

/// How the pictures that errors are measured against are made.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ReferenceRule {
    /// Accumulated until its standard error is so many times below the error that is measured ...
    pub ratio: f64,
    /// ... or so many samples per pixel are taken.
    pub most_samples: u64,
    /// Parameters that differ from the default.
    #[serde(default)]
    pub settings: Values,
}

#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SceneRow {
    pub name: String,
    /// A built-in scene, or a file relative to the suite's.
    pub source: String,
    /// Left out, with a warning, where its file is missing.
    #[serde(default)]
    pub optional: bool,
    #[serde(default = "nothing")]
    pub moves: Moves,
    /// Frames of the sequence of a scene that moves; the last one is measured.
    #[serde(default = "one")]
    pub frames: u32,
    pub background: Option<[f32; 3]>,
    pub environment: Option<String>,
    pub camera: Option<String>,
    pub eye: Option<[f64; 3]>,
    pub target: Option<[f64; 3]>,
    /// Degrees.
    pub vfov: Option<f32>,
}

/// A technique with all combinations of its lists. `*` is every registered technique, those to come included.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TechniqueRow {
    pub name: String,
    /// Samples per pixel and frame; those that a technique does not take are left out.
    #[serde(default = "ones")]
    pub spp: Vec<u32>,
    /// For techniques that do not accumulate, on scenes that stand still.
    #[serde(default = "ones")]
    pub frames: Vec<u32>,
    #[serde(default)]
    pub settings: Values,
    /// Every combination of the values.
    #[serde(default)]
    pub grid: BTreeMap<String, Vec<String>>,
    /// Names; all where nothing is said.
    pub scenes: Option<Vec<String>>,
}

/// An accuracy switch: each of its values against the default.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SwitchRow {
    /// A parameter, or `effects`.
    pub key: String,
    pub values: Vec<String>,
    pub technique: String,
    #[serde(default = "one")]
    pub spp: u32,
    /// On scenes that stand still; those of a technique that accumulates make one picture, whose time is that of all of them.
    #[serde(default = "one")]
    pub frames: u32,
    /// Beside the switch itself, at the base point too.
    #[serde(default)]
    pub settings: Values,
    pub trace: Option<String>,
    /// Names; all that stand still where nothing is said.
    pub scenes: Option<Vec<String>>,
}

/// What differs in a quick run.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Quick {
    pub sizes: Option<Vec<String>>,
    pub seeds: Option<u32>,
    pub scenes: Option<Vec<String>>,
    /// Techniques take at most so many samples per pixel.
    pub most_spp: Option<u32>,
    /// Sequences are at most so long.
    pub most_frames: Option<u32>,
    pub most_samples: Option<u64>,
    /// Switches take at most so many frames: what more of them accumulate would want a better reference.
    pub most_switch_frames: Option<u32>,
    /// Scenes of the switches.
    pub switch_scenes: Option<Vec<String>>,
}

fn auto() -> String {
    "auto".to_owned()
}

fn nothing() -> Moves {
    Moves::Nothing
}

fn one() -> u32 {
    1
}

fn ones() -> Vec<u32> {
    vec![1]
}

/// What is wrong with a suite.
#[derive(Debug, thiserror::Error)]
pub enum SuiteError {
    #[error("cannot read the suite '{}': {source}", path.display())]
    Unreadable { path: PathBuf, source: std::io::Error },
    #[error("the suite '{name}' is not what one should be: {reason}")]
    Malformed { name: String, reason: String },
    #[error("suite '{suite}': {place}: {reason}")]
    Wrong { suite: String, place: String, reason: String },
}

impl Suite {
    /// The suite in this file, or the standard one.
    ///
    /// # Errors
    /// It cannot be read, or says what no suite can say.
    pub fn load(path: Option<&Path>) -> Result<Self, SuiteError> {
        let Some(path) = path else { return Self::parse("standard", STANDARD, Path::new("")) };
        let text = std::fs::read_to_string(path).map_err(|source| SuiteError::Unreadable { path: path.to_owned(), source })?;
        Self::parse(&path.display().to_string(), &text, path.parent().unwrap_or(Path::new("")))
    }

    fn parse(name: &str, text: &str, folder: &Path) -> Result<Self, SuiteError> {
        let malformed = |reason: String| SuiteError::Malformed { name: name.to_owned(), reason };
        let suite: Suite = toml::from_str(text).map_err(|error| malformed(error.to_string()))?;
        if suite.version != VERSION {
            return Err(malformed(format!("version {} is unknown; this program reads version {VERSION}", suite.version)));
        }
        if suite.seeds == 0 || suite.reference.ratio.is_nan() || suite.reference.ratio <= 0.0 || suite.reference.most_samples == 0 {
            return Err(malformed("seeds, reference.ratio and reference.most_samples must be above 0".to_owned()));
        }
        if let Some(name) = suite.named_scenes().find(|name| !suite.scenes.iter().any(|scene| scene.name == **name)) {
            let known: Vec<&str> = suite.scenes.iter().map(|scene| scene.name.as_str()).collect();
            return Err(malformed(format!("there is no scene '{name}'; there are {}", known.join(", "))));
        }
        Ok(Self { folder: folder.to_owned(), ..suite }.without_missing_scenes())
    }

    fn without_missing_scenes(mut self) -> Self {
        let is_there = |scene: &SceneRow| {
            !scene.optional || Path::new(&scene.source).extension().is_none() || self.folder.join(&scene.source).exists()
        };
        let (there, missing): (Vec<_>, Vec<_>) = std::mem::take(&mut self.scenes).into_iter().partition(is_there);
        self.scenes = there;
        for SceneRow { name, source, .. } in &missing {
            tracing::warn!("'{name}' is left out, since there is no '{}'", self.folder.join(source).display());
        }
        self
    }

    /// Scenes that rows are limited to: a name that no scene has would silently measure nothing.
    fn named_scenes(&self) -> impl Iterator<Item = &String> {
        let rows = self.techniques.iter().map(|row| &row.scenes).chain(self.switches.iter().map(|row| &row.scenes));
        rows.chain([&self.quick.scenes, &self.quick.switch_scenes]).flatten().flatten()
    }

    /// The same suite, cut down to what takes minutes.
    pub fn quick(mut self) -> Self {
        let Quick { sizes, seeds, scenes, most_spp, most_frames, most_samples, most_switch_frames, switch_scenes } =
            std::mem::take(&mut self.quick);
        self.sizes = sizes.unwrap_or(self.sizes);
        self.seeds = seeds.unwrap_or(self.seeds);
        self.reference.most_samples = most_samples.unwrap_or(self.reference.most_samples);
        if let Some(names) = scenes {
            self.scenes.retain(|scene| names.contains(&scene.name));
        }
        let (most_spp, most_frames) = (most_spp.unwrap_or(u32::MAX), most_frames.unwrap_or(u32::MAX));
        self.scenes.iter_mut().for_each(|scene| scene.frames = scene.frames.min(most_frames));
        for technique in &mut self.techniques {
            technique.spp.retain(|&spp| spp <= most_spp);
            technique.frames.retain(|&frames| frames <= most_frames);
        }
        for switch in &mut self.switches {
            switch.frames = switch.frames.min(most_switch_frames.unwrap_or(u32::MAX));
        }
        if let Some(names) = switch_scenes {
            self.switches.iter_mut().for_each(|switch| switch.scenes = Some(names.clone()));
        }
        self
    }

    /// A built-in scene's name, or the path of a file.
    pub fn path_of(&self, file: &str) -> String {
        let path = self.folder.join(file);
        if path.exists() && Path::new(file).extension().is_some() { path.to_string_lossy().into_owned() } else { file.to_owned() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error(from: &str, to: &str) -> String {
        assert!(STANDARD.contains(from), "{from}");
        Suite::parse("test", &STANDARD.replacen(from, to, 1), Path::new("")).unwrap_err().to_string()
    }

    #[test]
    fn what_no_suite_can_say_is_refused_with_its_place() {
        assert!(error("version = 1", "version = 2").contains("version 2 is unknown"));
        assert!(error("seeds = 8", "seeds = 0").contains("seeds"));
        assert!(error("seeds = 8", "sneeds = 8").contains("sneeds"));
        assert!(error("switch_scenes = [\"cornell\"]", "switch_scenes = [\"kitchen\"]").contains("no scene 'kitchen'; there are cornell"));
        assert!(Suite::load(Some(Path::new("missing.toml"))).unwrap_err().to_string().contains("missing.toml"));
    }

    #[test]
    fn an_optional_scene_is_left_out_where_its_file_is_missing() {
        let row = "[[scenes]]\nname = \"kitchen\"\noptional = true\nsource = \"SOURCE\"\n\n[[techniques]]\nscenes = [\"kitchen\"]";
        let suite = |source: &str| {
            let text = STANDARD.replacen("[[techniques]]", &row.replace("SOURCE", source), 1);
            Suite::parse("test", &text, Path::new(env!("CARGO_MANIFEST_DIR"))).unwrap()
        };
        let has_kitchen = |suite: &Suite| suite.scenes.iter().any(|scene| scene.name == "kitchen");
        assert!(!has_kitchen(&suite("missing.glb")) && has_kitchen(&suite("Cargo.toml")) && has_kitchen(&suite("cornell")));
    }

    #[test]
    fn a_quick_suite_is_smaller_in_every_respect() {
        let (whole, quick) = (Suite::load(None).unwrap(), Suite::load(None).unwrap().quick());
        assert!(quick.scenes.len() < whole.scenes.len() && quick.seeds < whole.seeds);
        let samples = |suite: &Suite| suite.techniques.iter().map(|row| row.spp.len()).sum::<usize>();
        assert!(samples(&quick) < samples(&whole));
        let frames = |suite: &Suite| suite.switches.iter().map(|row| row.frames).max();
        assert!(frames(&quick) < frames(&whole));
    }
}
