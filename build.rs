//! Compiles every variant of every kernel in parallel, keeps what has not changed, and writes what the crate includes:
//! `shaders.rs` (embedded SPIR-V), `shared.rs` (structs of shaders_glsl/shared) and `parameters.rs`. Tells the crate what it was built from.

use rayon::prelude::*;
use shader_compiler::{CompileError, Variant, layout, parameters, reflect};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

const SHADER_DIR: &str = "shaders_glsl";
/// Folders of the host that a picture depends on.
const HOST_CODE: [&str; 4] = ["src/scene", "src/accel", "src/paths", "src/display"];
/// Files whose structs and constants both sides use.
const SHARED: [&str; 3] = ["shared/scene.glsl", "shared/bvh.glsl", "shared/parameters.glsl"];

fn main() {
    println!("cargo:rerun-if-changed={SHADER_DIR}");
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-changed=src");
    println!("cargo:rustc-env=PATHSPACE_COMMIT={}", commit());
    println!("cargo:rustc-env=PATHSPACE_HOST_CODE={:016x}", host_code());
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
    if let Err(error) = generate(Path::new(SHADER_DIR), &out) {
        eprintln!("{error}");
        std::process::exit(1);
    }
}

/// What measurements name as the program: the commit, `+` where the tree differs from it, or `unknown` outside a repository.
fn commit() -> String {
    let git = |arguments: &[&str]| {
        let output = Command::new("git").args(arguments).output().ok().filter(|output| output.status.success())?;
        Some(String::from_utf8_lossy(&output.stdout).trim().to_owned())
    };
    let Some(commit) = git(&["rev-parse", "--short=12", "HEAD"]) else { return "unknown".to_owned() };
    if let Some(log) = git(&["rev-parse", "--git-path", "logs/HEAD"]) {
        println!("cargo:rerun-if-changed={log}");
    }
    let clean = git(&["status", "--porcelain", "--untracked-files=no", "--", "src", SHADER_DIR, "build.rs"]).is_some_and(|s| s.is_empty());
    format!("{commit}{}", if clean { "" } else { "+" })
}

/// Changes with the host's part of the integrator, so that pictures of another one are not taken for its own.
fn host_code() -> u64 {
    let mut files: Vec<PathBuf> = HOST_CODE.iter().flat_map(|folder| rust_files(Path::new(folder))).collect();
    files.sort();
    let mut hasher = DefaultHasher::new();
    files.iter().for_each(|file| fs::read(file).unwrap_or_default().hash(&mut hasher));
    hasher.finish()
}

fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    entries.flat_map(|path| if path.is_dir() { rust_files(&path) } else { vec![path] }).collect()
}

fn generate(root: &Path, out: &Path) -> Result<(), CompileError> {
    let variants = shader_compiler::find_variants(root)?;
    let modules: Vec<(PathBuf, Vec<u32>)> =
        variants.par_iter().map(|variant| compile_if_changed(root, out, variant)).collect::<Result<_, _>>()?;
    let rows = variants.iter().zip(&modules).map(|(variant, (path, _))| {
        let Variant { stem, structure, precision, .. } = variant;
        let precision = precision.map_or("None".to_owned(), |precision| format!("Some(Precision::{precision:?})"));
        format!("    Shader {{ stem: {stem:?}, structure: {structure:?}, precision: {precision}, spirv: include_bytes!({path:?}) }},\n")
    });
    write(&out.join("shaders.rs"), format!("&[\n{}]", rows.collect::<String>()).as_bytes())?;
    write_shared(root, out, modules.iter().map(|(_, spirv)| spirv.as_slice()))?;
    let path = root.join("shared/parameters.glsl");
    let table = parameters::parse(&read(&path)?).map_err(|message| layout_error(&path, message))?;
    write(&out.join("parameters.rs"), parameters::host_source(&table).as_bytes())
}

fn compile_if_changed(root: &Path, out: &Path, variant: &Variant) -> Result<(PathBuf, Vec<u32>), CompileError> {
    let stem = variant.name().replace('/', ".");
    let path = out.join(format!("{stem}-{:016x}.spv", shader_compiler::fingerprint(root, variant)?));
    if let Ok(bytes) = fs::read(&path) {
        return Ok((path, words(&bytes)));
    }
    let spirv = shader_compiler::compile_variant(root, variant)?;
    write(&path, &spirv.iter().flat_map(|word| word.to_le_bytes()).collect::<Vec<u8>>())?;
    Ok((path, spirv))
}

fn write_shared<'a>(root: &Path, out: &Path, modules: impl Iterator<Item = &'a [u32]>) -> Result<(), CompileError> {
    let (mut structs, mut constants) = (Vec::new(), Vec::new());
    for file in SHARED {
        let (s, c) = layout::parse(&read(&root.join(file))?);
        structs.extend(s);
        constants.extend(c);
    }
    let mut source = String::new();
    let mut offsets = reflect::StructOffsets::new();
    for spirv in modules {
        offsets.extend(reflect::struct_offsets(spirv).map_err(|message| layout_error(root, message))?);
    }
    source += &layout::host_source(&structs, &constants, &offsets).map_err(|message| layout_error(&root.join("shared"), message))?;
    write(&out.join("shared.rs"), source.as_bytes())
}

fn words(bytes: &[u8]) -> Vec<u32> {
    bytes.chunks_exact(4).map(|c| u32::from_le_bytes(c.try_into().expect("four bytes"))).collect()
}

fn layout_error(path: &Path, message: String) -> CompileError {
    CompileError::Layout { name: path.display().to_string(), message }
}

fn read(path: &Path) -> Result<String, CompileError> {
    fs::read_to_string(path).map_err(|source| CompileError::Read { path: path.to_owned(), source })
}

fn write(path: &Path, content: &[u8]) -> Result<(), CompileError> {
    fs::write(path, content).map_err(|source| CompileError::Read { path: path.to_owned(), source })
}
