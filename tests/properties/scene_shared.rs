//! Scenes that nobody here wrote load, and hold what their table says.

use std::{fs, path::Path, time::Instant};

use pathspace::scene::{self, Scene};

const SCENES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../shared/scenes");

/// Triangles that instances place, each counted where it is placed.
fn placed_triangles(scene: &Scene) -> usize {
    scene.instances.iter().map(|instance| scene.meshes[instance.mesh as usize].triangles.len()).sum()
}

/// Degenerate triangles that loading skipped, in all meshes; a mesh may be placed several times.
fn degenerate(scene: &Scene) -> u64 {
    scene.warnings.iter().filter(|warning| warning.message.starts_with("degenerate")).map(|warning| warning.count).sum()
}

/// (folder, file, triangles) of the table in its README.
fn table() -> Vec<(String, String, usize)> {
    let Ok(readme) = fs::read_to_string(format!("{SCENES}/README.md")) else { return Vec::new() };
    let row = |line: &str| {
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        Some((cells.get(1)?.to_string(), cells.get(2)?.to_string(), cells.get(4)?.parse().ok()?))
    };
    readme.lines().filter_map(row).collect()
}

#[test]
fn every_scene_of_the_table_loads_with_its_triangles() {
    let table = table();
    if table.is_empty() {
        println!("skipped: {SCENES} is missing");
        return;
    }
    for (folder, file, triangles) in table {
        let path = format!("{SCENES}/{folder}/{file}");
        let start = Instant::now();
        let scene = scene::gltf::load(Path::new(&path)).unwrap_or_else(|error| panic!("{error}"));
        let (placed, skipped) = (placed_triangles(&scene), degenerate(&scene) as usize);
        println!("{folder}: {placed} triangles, {} textures, {:.0?}; {:?}", scene.textures.len(), start.elapsed(), scene.warnings);
        assert!(placed <= triangles && (placed == triangles || skipped > 0), "{folder}: {placed} of {triangles} triangles");
    }
}
