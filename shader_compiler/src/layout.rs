//! Rust structs from the GLSL structs of `shaders_glsl/shared/`: the GLSL text is the one definition, and the compiled module's
//! offsets are checked against it.
//!
//! The grammar is that of those files: one field or constant per line, `///` documentation above it, scalar layout.

use crate::reflect::StructOffsets;
use std::collections::HashMap;
use std::fmt::Write;

#[derive(Debug, Clone, PartialEq)]
pub struct Struct {
    pub name: String,
    pub docs: Vec<String>,
    pub fields: Vec<Field>,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Field {
    pub name: String,
    pub docs: Vec<String>,
    pub ty: String,
    /// Elements, where it is an array.
    pub count: Option<u32>,
}

/// `const uint NAME = value;`
#[derive(Debug, Clone, PartialEq)]
pub struct Constant {
    pub name: String,
    pub docs: Vec<String>,
    pub value: u32,
}

/// Structs and constants of one file, in order.
pub fn parse(text: &str) -> (Vec<Struct>, Vec<Constant>) {
    let (mut structs, mut constants) = (Vec::<Struct>::new(), Vec::new());
    let (mut docs, mut open) = (Vec::new(), false);
    for line in text.lines().map(str::trim) {
        if let Some(doc) = line.strip_prefix("///") {
            docs.push(doc.trim().to_owned());
        } else if let Some(name) = line.strip_prefix("struct ") {
            structs.push(Struct { name: name.trim_end_matches('{').trim().to_owned(), docs: std::mem::take(&mut docs), fields: vec![] });
            open = true;
        } else if line == "};" {
            open = false;
        } else if let Some(constant) = line.strip_prefix("const uint ").and_then(|rest| parse_constant(rest, &mut docs)) {
            constants.push(constant);
        } else if let (true, Some(field)) = (open, parse_field(line, &mut docs)) {
            structs.last_mut().expect("a struct is open").fields.push(field);
        } else if !line.starts_with("//@") {
            docs.clear();
        }
    }
    (structs, constants)
}

fn parse_constant(rest: &str, docs: &mut Vec<String>) -> Option<Constant> {
    let (name, value) = rest.split_once('=')?;
    let value = value.trim().trim_end_matches(';').trim_end_matches('u');
    let value = match value.strip_prefix("0x") {
        Some(hex) => u32::from_str_radix(hex, 16).ok()?,
        None => value.parse().ok()?,
    };
    Some(Constant { name: name.trim().to_owned(), docs: std::mem::take(docs), value })
}

fn parse_field(line: &str, docs: &mut Vec<String>) -> Option<Field> {
    let (ty, name) = line.strip_suffix(';')?.split_once(' ')?;
    let (name, count) = match name.strip_suffix(']') {
        Some(array) => array.split_once('[').map(|(name, count)| (name, count.parse().ok()))?,
        None => (name, None),
    };
    Some(Field { name: name.to_owned(), docs: std::mem::take(docs), ty: ty.to_owned(), count })
}

/// Rust type and size in bytes of a GLSL type.
fn host_type(ty: &str, sizes: &HashMap<String, u32>) -> Result<(String, u32), String> {
    let vector = |scalar: &str, n: u32| (format!("[{scalar}; {n}]"), 4 * n);
    Ok(match ty {
        "float" => ("f32".to_owned(), 4),
        "uint" => ("u32".to_owned(), 4),
        "int" => ("i32".to_owned(), 4),
        // A uvec2 in the shader, for devices without 64-bit integers.
        "Address" => ("u64".to_owned(), 8),
        "vec2" => vector("f32", 2),
        "vec3" => vector("f32", 3),
        "vec4" => vector("f32", 4),
        "uvec2" => vector("u32", 2),
        "uvec3" => vector("u32", 3),
        "uvec4" => vector("u32", 4),
        "ivec2" => vector("i32", 2),
        "ivec3" => vector("i32", 3),
        name => (name.to_owned(), *sizes.get(name).ok_or(format!("type '{name}' is not known to the host"))?),
    })
}

/// Rust source of the structs and constants; also checks `offsets` of the compiled modules, where a struct occurs in one.
pub fn host_source(structs: &[Struct], constants: &[Constant], offsets: &StructOffsets) -> Result<String, String> {
    let mut sizes = HashMap::new();
    let mut source = String::new();
    for constant in constants {
        write_docs(&mut source, "", &constant.docs);
        writeln!(source, "pub const {}: u32 = {};", constant.name, constant.value).expect("a string");
    }
    for structure in structs {
        write_docs(&mut source, "", &structure.docs);
        writeln!(source, "#[repr(C)]\n#[derive(Debug, Clone, Copy, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]")
            .expect("a string");
        writeln!(source, "pub struct {} {{", structure.name).expect("a string");
        let (mut offset, mut expected) = (0, Vec::new());
        for field in &structure.fields {
            let (ty, size) = host_type(&field.ty, &sizes)?;
            write_docs(&mut source, "    ", &field.docs);
            let ty = field.count.map_or(ty.clone(), |count| format!("[{ty}; {count}]"));
            writeln!(source, "    pub {}: {ty},", field.name).expect("a string");
            expected.push((field.name.clone(), offset));
            offset += size * field.count.unwrap_or(1);
        }
        writeln!(source, "}}\nconst _: () = assert!(size_of::<{}>() == {offset});", structure.name).expect("a string");
        if let Some(found) = offsets.get(&structure.name).filter(|found| **found != expected) {
            return Err(format!("struct '{}': the host expects {expected:?}, the module has {found:?}", structure.name));
        }
        sizes.insert(structure.name.clone(), offset);
    }
    Ok(source)
}

fn write_docs(source: &mut String, indent: &str, docs: &[String]) {
    for doc in docs {
        writeln!(source, "{indent}/// {doc}").expect("a string");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str =
        "/// A thing.\nstruct Thing {\n    /// Where.\n    vec3 position;\n    float weights[6];\n};\nconst uint FLAG = 2u;\n";

    #[test]
    fn fields_docs_and_constants_are_read() {
        let (structs, constants) = parse(TEXT);
        assert_eq!(structs[0].docs, ["A thing."]);
        assert_eq!(structs[0].fields[0].docs, ["Where."]);
        assert_eq!(structs[0].fields[1].count, Some(6));
        assert_eq!((constants[0].name.as_str(), constants[0].value), ("FLAG", 2));
    }

    #[test]
    fn an_offset_that_differs_is_an_error() {
        let (structs, constants) = parse(TEXT);
        let offsets =
            |weights| StructOffsets::from([("Thing".to_owned(), vec![("position".to_owned(), 0), ("weights".to_owned(), weights)])]);
        assert!(host_source(&structs, &constants, &offsets(12)).is_ok());
        assert!(host_source(&structs, &constants, &offsets(16)).unwrap_err().contains("Thing"));
    }
}
