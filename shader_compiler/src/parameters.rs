//! The table of parameters, from the annotations of `shaders_glsl/shared/parameters.glsl`: `//@ key default range [unit]`,
//! `/// help`, then the field or the specialization constant itself.

/// One switch or number that a user can set.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// `paths.max_bounces`
    pub key: String,
    pub help: String,
    pub unit: String,
    pub range: Range,
    /// As a number; an enumeration's index.
    pub default: f64,
    pub place: Place,
}

#[derive(Debug, Clone, PartialEq)]
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
    Choice(Vec<String>),
}

/// Where the shader finds it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Place {
    /// Specialization constant.
    Constant { id: u32 },
    /// Offset in bytes in `Parameters`.
    Field { offset: u32 },
}

/// Reads the annotated lines; the error names the line.
pub fn parse(text: &str) -> Result<Vec<Parameter>, String> {
    let mut parameters = Vec::new();
    let mut offset = 0;
    let mut lines = text.lines().map(str::trim).skip_while(|line| !line.starts_with("//@")).peekable();
    while let Some(line) = lines.next() {
        let Some(annotation) = line.strip_prefix("//@ ") else { continue };
        let mut help = String::new();
        while let Some(doc) = lines.next_if(|line| line.starts_with("///")) {
            help = format!("{help} {}", doc.trim_start_matches("///").trim()).trim().to_owned();
        }
        let declaration = lines.next().ok_or_else(|| format!("nothing is declared after '{line}'"))?;
        let place = parse_place(declaration, &mut offset);
        parameters.push(
            parse_annotation(annotation, help, place, declaration.starts_with("float")).ok_or_else(|| format!("cannot read '{line}'"))?,
        );
    }
    Ok(parameters)
}

fn parse_place(declaration: &str, offset: &mut u32) -> Place {
    match declaration.split_once("constant_id = ").and_then(|(_, rest)| rest.split(')').next()?.parse().ok()) {
        Some(id) => Place::Constant { id },
        None => {
            *offset += 4;
            Place::Field { offset: *offset - 4 }
        }
    }
}

fn parse_annotation(annotation: &str, help: String, place: Place, real: bool) -> Option<Parameter> {
    let mut words = annotation.split_whitespace();
    let (key, default, range) = (words.next()?, words.next()?, words.next()?);
    let (range, default) = match range.split_once("..") {
        Some((min, max)) if real => (Range::Real { min: min.parse().ok()?, max: max.parse().ok()? }, default.parse().ok()?),
        Some((min, max)) => (Range::Integer { min: min.parse().ok()?, max: max.parse().ok()? }, default.parse().ok()?),
        None => {
            let choices: Vec<String> = range.split('|').map(str::to_owned).collect();
            let index = choices.iter().position(|choice| choice == default)?;
            (Range::Choice(choices), index as f64)
        }
    };
    Some(Parameter { key: key.to_owned(), help, unit: words.collect::<Vec<_>>().join(" "), range, default, place })
}

/// A Rust expression that makes the table again: `&[Parameter { .. }, ..]` of the host's own `Parameter` type with static strings.
pub fn host_source(parameters: &[Parameter]) -> String {
    let range = |range: &Range| match range {
        Range::Integer { min, max } => format!("Range::Integer {{ min: {min}, max: {max} }}"),
        Range::Real { min, max } => format!("Range::Real {{ min: {min:?}, max: {max:?} }}"),
        Range::Choice(choices) => format!("Range::Choice(&{choices:?})"),
    };
    let rows = parameters.iter().map(|p| {
        format!(
            "    Parameter {{ key: {:?}, help: {:?}, unit: {:?}, range: {}, default: {:?}, place: Place::{:?} }},\n",
            p.key,
            p.help,
            p.unit,
            range(&p.range),
            p.default,
            p.place
        )
    });
    format!("&[\n{}]", rows.collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn choices_numbers_and_places_are_read() {
        let text = "//@ a.b two one|two\n/// Help.\nlayout(constant_id = 7) const uint A = 1;\nstruct P {\n//@ c 3 0..9 rays\nuint c;\n//@ d 0.5 0..1\nfloat d;\n};";
        let parameters = parse(text).unwrap();
        assert_eq!(parameters[0].default, 1.0);
        assert_eq!(parameters[0].place, Place::Constant { id: 7 });
        assert_eq!(parameters[1].unit, "rays");
        assert_eq!(parameters[2].place, Place::Field { offset: 4 });
        assert_eq!(parameters[2].range, Range::Real { min: 0.0, max: 1.0 });
    }

    #[test]
    fn a_default_outside_the_choices_names_the_line() {
        assert!(parse("//@ a.b three one|two\nuint a;").unwrap_err().contains("a.b three"));
    }
}
