//! Scenes that nobody here wrote load, and hold what their table says.

use std::{
    collections::HashMap,
    fs,
    path::{Path, PathBuf},
    time::Instant,
};

use glam::Vec3;
use pathspace::scene::{self, Mesh, Scene};

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
        println!("{folder}: {placed} triangles, {} textures, {:.2?}; {:?}", scene.textures.len(), start.elapsed(), scene.warnings);
        assert!(placed <= triangles && (placed == triangles || skipped > 0), "{folder}: {placed} of {triangles} triangles");
    }
}

/// Files of one folder that the loader reads.
fn files(folder: &str) -> Vec<PathBuf> {
    let entries = fs::read_dir(format!("{SCENES}/{folder}")).into_iter().flatten().flatten().map(|entry| entry.path());
    let mut files: Vec<_> =
        entries.filter(|path| path.extension().is_some_and(|extension| extension == "gltf" || extension == "glb")).collect();
    files.sort();
    files
}

#[test]
fn every_variant_of_a_scene_loads() {
    for path in ["cornell", "huge_coords_cornell", "light_units", "gltf-rs_box_sparse"].into_iter().flat_map(files) {
        let scene = scene::gltf::load(&path).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(scene.warnings.iter().filter(|warning| !warning.message.contains("morph")).count(), 0, "{:?}", scene.warnings);
    }
}

/// The generator draws one square as points, lines, strips, fans and lists, with and without indices.
#[test]
fn every_primitive_mode_with_triangles_covers_the_same_square() {
    for path in files("primitive_modes_khronos_generator/Mesh_PrimitiveMode") {
        match scene::gltf::load(&path) {
            Ok(scene) => assert_eq!(area_along_z(&scene.meshes[0]), 1.0, "{}", path.display()),
            Err(error) => assert!(error.to_string().contains("points or lines skipped"), "{error}"),
        }
    }
}

/// Of the triangles that face +z, less those that face -z.
fn area_along_z(mesh: &Mesh) -> f32 {
    let area = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|vertex| Vec3::from(mesh.positions[vertex as usize]));
        (b - a).cross(c - a).z / 2.0
    };
    mesh.triangles.iter().map(area).sum()
}

/// (position, normal, texture coordinates) of each vertex, with its tangent.
fn tangents(scene: &Scene) -> HashMap<[u32; 8], Vec<[f32; 4]>> {
    let mut tangents: HashMap<_, Vec<_>> = HashMap::new();
    for mesh in &scene.meshes {
        for (i, tangent) in mesh.tangents.iter().enumerate() {
            let ([x, y, z], [nx, ny, nz], [u, v]) = (mesh.positions[i], mesh.normals[i], mesh.uv0[i]);
            tangents.entry([x, y, z, nx, ny, nz, u, v].map(f32::to_bits)).or_default().push(*tangent);
        }
    }
    tangents
}

/// The file's own tangents were baked by another program, also by mikktspace.
#[test]
fn generated_tangents_agree_with_those_that_the_flight_helmet_brings() {
    let folder = Path::new(SCENES).join("FlightHelmet");
    let Ok(text) = fs::read_to_string(folder.join("FlightHelmet.gltf")) else {
        println!("skipped: {} is missing", folder.display());
        return;
    };
    let load = |text: &str| tangents(&scene::gltf::load_slice(text.as_bytes(), Some(&folder), "FlightHelmet").unwrap());
    let (brought, generated) = (load(&text), load(&text.replace("\"TANGENT\"", "\"_UNUSED\"")));
    let same = |a: &[f32; 4], b: &[f32; 4]| a[3] == b[3] && Vec3::from_slice(a).dot(Vec3::from_slice(b)) > 0.95;
    let agrees = |(vertex, tangents): (&[u32; 8], &Vec<[f32; 4]>)| tangents.iter().all(|a| generated[vertex].iter().any(|b| same(a, b)));
    let share = brought.iter().filter(|entry| agrees(*entry)).count() as f64 / brought.len() as f64;
    println!("{:.2} % of {} vertices agree", 100.0 * share, brought.len());
    assert!(share > 0.98);
}
