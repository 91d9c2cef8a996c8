//! What `--set key=value` can change. The table is generated from shaders_glsl/shared/parameters.glsl when built.

use crate::shared;
use shader_compiler::Precision;

/// One switch or number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameter {
    pub key: &'static str,
    /// Effect on the picture; cost.
    pub help: &'static str,
    pub unit: &'static str,
    pub range: Range,
    /// A choice's index, or the number.
    pub default: f64,
    place: Place,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Range {
    Integer {
        min: u32,
        max: u32,
    },
    Real {
        min: f32,
        max: f32,
    },
    /// Value i is stored as i.
    Choice(&'static [&'static str]),
}

/// Where shaders find it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Place {
    /// Specialization constant: a change compiles new pipelines.
    Constant { id: u32 },
    /// Offset in bytes in [`shared::Parameters`].
    Field { offset: u32 },
}

static TABLE: &[Parameter] = include!(concat!(env!("OUT_DIR"), "/parameters.rs"));

/// Several values under one name.
pub struct Preset {
    pub key: &'static str,
    pub value: &'static str,
    pub help: &'static str,
    pub sets: &'static [(&'static str, &'static str)],
}

/// Presets come before the values that a user sets one by one.
pub static PRESETS: [Preset; 1] = [Preset {
    key: "rays.budget",
    value: "q2rtx",
    help: "7 rays per pixel after the primary one, as Quake II RTX: 3 scattered and 4 shadow rays, two of these at the primary hit",
    sets: &[("paths.max_bounces", "2"), ("rays.first_shadow_rays", "2")],
}];

#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ParameterError {
    #[error("there is no parameter '{key}'; there are:\n{known}")]
    Unknown { key: String, known: String },
    #[error("'{value}' is no value for '{key}': it takes {takes}")]
    Value { key: String, value: String, takes: String },
}

/// A value for every parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameters(Vec<f64>);

impl Default for Parameters {
    fn default() -> Self {
        Self(TABLE.iter().map(|parameter| parameter.default).collect())
    }
}

impl Parameters {
    pub fn table() -> &'static [Parameter] {
        TABLE
    }

    /// Sets a parameter or a preset from text.
    ///
    /// # Errors
    /// An unknown key (the message lists all), or a value that is not of its range.
    pub fn set(&mut self, key: &str, value: &str) -> Result<(), ParameterError> {
        if let Some(preset) = PRESETS.iter().find(|preset| preset.key == key) {
            let error = || ParameterError::Value { key: key.to_owned(), value: value.to_owned(), takes: preset.value.to_owned() };
            let chosen = PRESETS.iter().find(|p| p.key == key && p.value == value).ok_or_else(error)?;
            return chosen.sets.iter().try_for_each(|(key, value)| self.set(key, value));
        }
        let unknown = || ParameterError::Unknown { key: key.to_owned(), known: describe_all() };
        let index = TABLE.iter().position(|parameter| parameter.key == key).ok_or_else(unknown)?;
        let range = TABLE[index].range;
        let error = || ParameterError::Value { key: key.to_owned(), value: value.to_owned(), takes: range.to_string() };
        self.0[index] = range.parse(value).ok_or_else(error)?;
        Ok(())
    }

    /// `onto`, with the values that differ here from `base`.
    pub fn changed_from(&self, base: &Self, mut onto: Self) -> Self {
        for ((value, base), onto) in self.0.iter().zip(&base.0).zip(&mut onto.0) {
            if value != base {
                *onto = *value;
            }
        }
        onto
    }

    /// A number, or a choice's index.
    ///
    /// # Panics
    /// Where there is no such parameter.
    pub fn number(&self, key: &str) -> f64 {
        self.0[TABLE.iter().position(|parameter| parameter.key == key).expect("the program asks for parameters of the table")]
    }

    /// The value as a user would write it.
    pub fn value(&self, parameter: &Parameter) -> String {
        let index = TABLE.iter().position(|p| p.key == parameter.key).expect("parameters come from the table");
        match parameter.range {
            Range::Choice(choices) => choices[self.0[index] as usize].to_owned(),
            _ => self.0[index].to_string(),
        }
    }

    /// Of the frame's images: `frame.precision`.
    pub fn precision(&self) -> Precision {
        let index = TABLE.iter().position(|parameter| parameter.key == "frame.precision").expect("it is in the table");
        Precision::ALL[self.0[index] as usize]
    }

    /// Ids and words of those that are specialization constants.
    pub fn constants(&self) -> Vec<(u32, u32)> {
        let constant = |(parameter, &value): (&Parameter, &f64)| match parameter.place {
            Place::Constant { id } => Some((id, parameter.range.word(value))),
            Place::Field { .. } => None,
        };
        TABLE.iter().zip(&self.0).filter_map(constant).collect()
    }

    /// Those that shaders read at run time.
    pub fn fields(&self) -> shared::Parameters {
        let mut fields = shared::Parameters::default();
        let bytes = bytemuck::bytes_of_mut(&mut fields);
        for (parameter, &value) in TABLE.iter().zip(&self.0) {
            if let Place::Field { offset } = parameter.place {
                bytes[offset as usize..][..4].copy_from_slice(&parameter.range.word(value).to_ne_bytes());
            }
        }
        fields
    }
}

impl Range {
    fn parse(self, text: &str) -> Option<f64> {
        match self {
            Range::Integer { min, max } => text.parse().ok().filter(|value| (min..=max).contains(value)).map(f64::from),
            // Compared as shaders see it, kept as it was written.
            Range::Real { min, max } => text.parse().ok().filter(|&value: &f64| (min..=max).contains(&(value as f32))),
            Range::Choice(choices) => choices.iter().position(|choice| *choice == text).map(|index| index as f64),
        }
    }

    /// The 32 bits that a shader sees.
    fn word(self, value: f64) -> u32 {
        match self {
            Range::Real { .. } => (value as f32).to_bits(),
            _ => value as u32,
        }
    }
}

impl std::fmt::Display for Range {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        match self {
            Range::Integer { min, max } => write!(f, "a whole number from {min} to {max}"),
            Range::Real { min, max } => write!(f, "a number from {min} to {max}"),
            Range::Choice(choices) => write!(f, "{}", choices.join(" or ")),
        }
    }
}

/// One line per parameter and preset.
pub fn describe_all() -> String {
    let defaults = Parameters::default();
    let parameter = |p: &Parameter| {
        let unit = if p.unit.is_empty() { String::new() } else { format!(" {}", p.unit) };
        format!("  {} = {}{unit} ({}): {}", p.key, defaults.value(p), p.range, p.help)
    };
    let preset = |p: &Preset| format!("  {} = {}: {}", p.key, p.value, p.help);
    TABLE.iter().map(parameter).chain(PRESETS.iter().map(preset)).collect::<Vec<_>>().join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_parameter_takes_its_default_and_lands_in_its_place() {
        let mut parameters = Parameters::default();
        for parameter in TABLE {
            let value = parameters.value(parameter);
            parameters.set(parameter.key, &value).unwrap();
        }
        assert_eq!(parameters, Parameters::default());
        assert_eq!(parameters.fields().max_bounces, 8);
        parameters.set("textures.lod_bias", "-1.5").unwrap();
        assert_eq!(parameters.fields().lod_bias, -1.5);
        parameters.set("hpsf.cells", "0.001").unwrap();
        assert_eq!((parameters.number("hpsf.cells"), parameters.fields().hpsf_cells), (0.001, 0.001));
        parameters.set("paths.direct", "bsdf").unwrap();
        assert!(parameters.constants().contains(&(103, 2)));
    }

    #[test]
    fn every_precision_is_a_choice_by_its_name() {
        for precision in Precision::ALL {
            let mut parameters = Parameters::default();
            parameters.set("frame.precision", precision.name()).unwrap();
            assert_eq!(parameters.precision(), precision);
        }
    }

    #[test]
    fn a_preset_sets_several_values() {
        let mut parameters = Parameters::default();
        parameters.set("rays.budget", "q2rtx").unwrap();
        assert_eq!((parameters.fields().max_bounces, parameters.fields().first_shadow_rays), (2, 2));
    }

    #[test]
    fn changes_carry_over_to_other_defaults() {
        let base = Parameters::default();
        let (mut mine, mut other) = (base.clone(), base.clone());
        mine.set("paths.max_bounces", "3").unwrap();
        other.set("textures.level", "zero").unwrap();
        let both = mine.changed_from(&base, other.clone());
        other.set("paths.max_bounces", "3").unwrap();
        assert_eq!(both, other);
    }

    #[test]
    fn what_is_wrong_is_said() {
        let mut parameters = Parameters::default();
        assert!(parameters.set("no.such", "1").unwrap_err().to_string().contains("paths.max_bounces"));
        for (key, value) in [("paths.max_bounces", "65"), ("paths.clamp", "nan"), ("paths.direct", "all"), ("rays.budget", "rich")] {
            assert!(matches!(parameters.set(key, value), Err(ParameterError::Value { .. })), "{key}={value}");
        }
    }
}
