//! Which kernels there are, in which variants, and when one has changed.

use crate::CompileError;
use std::collections::BTreeSet;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};

/// A kernel that traces rays is compiled once per acceleration structure.
const TRACE_INCLUDE: &str = "accel/trace.glsl";
const STRUCTURES: &str = "accel/structures";
/// A kernel that declares images, or buffers of a filter's cells, in the frame's precision does so by these macros, and is compiled once per
/// precision.
const COLOR_FORMAT: &str = "COLOR_FORMAT";
const CELL_WORDS: &str = "CELL_WORDS";

/// Of the frame's images and histories.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Precision {
    Fp32,
    Fp16,
}

impl Precision {
    pub const ALL: [Precision; 2] = [Precision::Fp32, Precision::Fp16];

    pub fn name(self) -> &'static str {
        match self {
            Precision::Fp32 => "fp32",
            Precision::Fp16 => "fp16",
        }
    }

    /// GLSL's format qualifier.
    fn color_format(self) -> &'static str {
        match self {
            Precision::Fp32 => "rgba32f",
            Precision::Fp16 => "rgba16f",
        }
    }

    /// GLSL's type of a cell's words.
    fn cell_words(self) -> &'static str {
        match self {
            Precision::Fp32 => "uvec4",
            Precision::Fp16 => "uvec2",
        }
    }

    /// Bytes that filters keep per cell.
    pub fn cell_bytes(self) -> u64 {
        match self {
            Precision::Fp32 => 16,
            Precision::Fp16 => 8,
        }
    }

    fn defines(self) -> [(String, String); 2] {
        [(COLOR_FORMAT, self.color_format()), (CELL_WORDS, self.cell_words())].map(|(name, value)| (name.to_owned(), value.to_owned()))
    }
}

/// One compilation of one kernel.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Variant {
    /// Relative to the shader directory, for example `paths/megakernel.comp`.
    pub file: PathBuf,
    /// Without the extension: `paths/megakernel`.
    pub stem: String,
    /// File stem of the acceleration structure, for kernels that trace rays.
    pub structure: Option<String>,
    /// For kernels with images or cells in the frame's precision.
    pub precision: Option<Precision>,
}

impl Variant {
    /// For messages and file names: the stem, then what sets it apart, as in `paths/megakernel+bvh+fp16`.
    pub fn name(&self) -> String {
        let parts = [Some(self.stem.as_str()), self.structure.as_deref(), self.precision.map(Precision::name)];
        parts.into_iter().flatten().collect::<Vec<_>>().join("+")
    }

    pub fn defines(&self) -> Vec<(String, String)> {
        let structure = self.structure.as_deref().map(structure_defines).unwrap_or_default();
        structure.into_iter().chain(self.precision.into_iter().flat_map(Precision::defines)).collect()
    }
}

/// What selects an acceleration structure in `accel/trace.glsl`.
pub fn structure_defines(structure: &str) -> Vec<(String, String)> {
    vec![
        ("ACCEL_FILE".to_owned(), format!("\"{STRUCTURES}/{structure}.glsl\"")),
        (format!("ACCEL_{}", structure.to_uppercase()), "1".to_owned()),
    ]
}

/// Every variant of every `*.comp` below `root`, sorted by name.
pub fn find_variants(root: &Path) -> Result<Vec<Variant>, CompileError> {
    let structures: Vec<String> = files_below(&root.join(STRUCTURES), "glsl")?
        .iter()
        .filter_map(|path| path.file_stem().map(|stem| stem.to_string_lossy().into_owned()))
        .collect();
    let mut variants = Vec::new();
    for path in files_below(root, "comp")? {
        let file = path.strip_prefix(root).expect("found below root").to_owned();
        let stem = file.with_extension("").to_string_lossy().replace('\\', "/");
        let includes = transitive_includes(root, &path)?;
        let traces = includes.contains(Path::new(TRACE_INCLUDE));
        let structures = if traces { structures.iter().cloned().map(Some).collect() } else { vec![None] };
        let mut differs = depends_on_precision(&read(&path)?);
        for include in includes {
            differs |= depends_on_precision(&read(&root.join(include))?);
        }
        let precisions = if differs { Precision::ALL.map(Some).to_vec() } else { vec![None] };
        for structure in structures {
            let variant = |&precision| Variant { file: file.clone(), stem: stem.clone(), structure: structure.clone(), precision };
            variants.extend(precisions.iter().map(variant));
        }
    }
    variants.sort_by_key(Variant::name);
    Ok(variants)
}

fn depends_on_precision(source: &str) -> bool {
    let declares = |line: &str| [COLOR_FORMAT, CELL_WORDS].iter().any(|name| line.contains(name));
    source.lines().any(|line| line.starts_with("layout(") && declares(line))
}

/// Changes when the kernel, or anything that it includes, changes.
pub fn fingerprint(root: &Path, variant: &Variant) -> Result<u64, CompileError> {
    let mut hasher = DefaultHasher::new();
    crate::PREAMBLE.hash(&mut hasher);
    variant.defines().hash(&mut hasher);
    let path = root.join(&variant.file);
    read(&path)?.hash(&mut hasher);
    let mut includes = transitive_includes(root, &path)?;
    if let Some(structure) = &variant.structure {
        let file = PathBuf::from(format!("{STRUCTURES}/{structure}.glsl"));
        includes.extend(transitive_includes(root, &root.join(&file))?);
        includes.insert(file);
    }
    for include in includes {
        read(&root.join(include))?.hash(&mut hasher);
    }
    Ok(hasher.finish())
}

/// Files named by `#include "..."`, relative to `root`, followed through. Includes by the name of a define are left out.
fn transitive_includes(root: &Path, path: &Path) -> Result<BTreeSet<PathBuf>, CompileError> {
    let mut found = BTreeSet::new();
    let mut pending = vec![path.to_owned()];
    while let Some(path) = pending.pop() {
        for line in read(&path)?.lines() {
            let Some(name) = line.trim().strip_prefix("#include \"").and_then(|rest| rest.split('"').next()) else { continue };
            if name.ends_with(".glsl") && found.insert(PathBuf::from(name)) {
                pending.push(root.join(name));
            }
        }
    }
    Ok(found)
}

fn files_below(directory: &Path, extension: &str) -> Result<Vec<PathBuf>, CompileError> {
    let error = |source| CompileError::Read { path: directory.to_owned(), source };
    let mut files = Vec::new();
    if !directory.exists() {
        return Ok(files);
    }
    for entry in std::fs::read_dir(directory).map_err(error)? {
        let path = entry.map_err(error)?.path();
        if path.is_dir() {
            files.extend(files_below(&path, extension)?);
        } else if path.extension().is_some_and(|e| e == extension) {
            files.push(path);
        }
    }
    files.sort();
    Ok(files)
}

fn read(path: &Path) -> Result<String, CompileError> {
    std::fs::read_to_string(path).map_err(|source| CompileError::Read { path: path.to_owned(), source })
}
