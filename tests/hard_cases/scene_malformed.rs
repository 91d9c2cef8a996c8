//! Files of the Khronos glTF validator's own tests: each loads or is refused with a reason.

use std::{
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

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
    let mut reasons = 0;
    let start = Instant::now();
    for file in &files {
        // Most have no triangle at all.
        if let Err(error) = scene::gltf::load(file) {
            let message = error.to_string();
            let reason = message.strip_prefix(&*file.to_string_lossy()).expect("names the file");
            assert!(reason.len() > 20, "{message}");
            reasons += 1;
        }
    }
    println!("{reasons} of {} refused, in {:.0?}", files.len(), start.elapsed());
    assert!(start.elapsed() < Duration::from_secs(10));
}
