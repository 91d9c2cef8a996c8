//! Files of the Khronos glTF validator's own tests: each loads or is refused with a reason.

use std::path::{Path, PathBuf};

use pathspace::scene;

const FILES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../shared/scenes/malformed_khronos_validator");

fn gltf_files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            gltf_files(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "gltf" || extension == "glb") {
            found.push(path);
        }
    }
}

#[test]
fn every_file_of_the_khronos_validator_loads_or_is_refused_with_a_reason() {
    let mut files = Vec::new();
    gltf_files(Path::new(FILES), &mut files);
    if files.is_empty() {
        println!("skipped: {FILES} is missing");
        return;
    }
    let mut loaded = 0;
    for file in &files {
        match scene::gltf::load(file) {
            Ok(_) => loaded += 1,
            Err(error) => println!("{}", error.to_string().replace(FILES, "")),
        }
    }
    println!("{loaded} of {} loaded", files.len());
}
