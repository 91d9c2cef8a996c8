//! glTF 2.0 (.gltf, .glb) to [`Scene`]: the file's JSON is checked, its data read within bounds, its mistakes repaired and counted
//! or refused with a reason. Memory stays in proportion to what the file really holds.
//!
//! Source: Khronos, glTF 2.0 Specification; the extensions are those of [`document::SUPPORTED_EXTENSIONS`].

mod accessor;
mod animation;
mod buffers;
mod document;
mod geometry;
mod images;
mod material;
mod mesh;
mod nodes;
mod punctual;
mod tangents;
mod warnings;

use std::path::Path;

use gltf::json::Root;
use serde::Deserialize;

pub(in crate::scene) use self::buffers::read_file;
use self::{buffers::Buffers, document::Document, images::Textures, nodes::Tree, warnings::Warnings};
use super::{Animation, Environment, Instance, LoadError, Local, Mesh, Problem, Scene, transform};

/// Loads a .gltf or .glb file, with the buffers and images it refers to.
///
/// # Errors
/// Where the file, or a buffer of it, cannot be read, is damaged, contradicts itself, requires an extension that is not supported,
/// or places no triangle. What can be repaired or skipped is in [`Scene::warnings`] instead.
pub fn load(path: &Path) -> Result<Scene, LoadError> {
    let file = path.display().to_string();
    let name = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    let read = || read(&read_file(path)?, path.parent(), &name);
    read().map_err(|problem| problem.in_file(file))
}

/// Loads a .gltf or .glb file from memory. URIs are relative to `base_dir`; without one only data URIs and the BIN chunk can be read.
///
/// # Errors
/// As [`load`].
pub fn load_slice(bytes: &[u8], base_dir: Option<&Path>, name: &str) -> Result<Scene, LoadError> {
    read(bytes, base_dir, name).map_err(|problem| problem.in_file(name))
}

fn read(bytes: &[u8], base_dir: Option<&Path>, name: &str) -> Result<Scene, Problem> {
    let mut warnings = Warnings::default();
    let document = document::parse(bytes)?;
    let root = &document.root;
    warn_of_unsupported(root, &mut warnings);
    let buffers = Buffers::load(&document, base_dir)?;
    let mut tree = nodes::flatten(&document, &mut warnings)?;
    let animation = animation::read(root, &buffers, &mut tree, &mut warnings)?;
    let mut textures = Textures::default();
    let materials = material::Reader { root, textures: &mut textures, warnings: &mut warnings }.read_all()?;
    let (meshes, instances) = place_meshes(&document, &tree, &animation, mesh::Reader::new(root, &buffers, &materials), &mut warnings)?;
    if instances.is_empty() {
        return Err(Problem::NothingToRender { skipped: warnings.summary() });
    }
    let textures = textures.decode(root, &buffers, base_dir, &mut warnings)?;
    Ok(Scene {
        name: name.into(),
        lights: punctual::lights(root, &tree, &mut warnings),
        cameras: punctual::cameras(root, &tree, &mut warnings),
        meshes,
        materials,
        textures,
        nodes: tree.nodes,
        instances,
        animation,
        environment: environment(root),
        warnings: warnings.into_vec(),
    })
}

/// `extras.environment` of the scene, a constant radiance that core glTF cannot express; black without it.
fn environment(root: &Root) -> Environment {
    #[derive(Deserialize)]
    struct SceneExtras {
        environment: [f32; 3],
    }
    let scene = root.scenes.get(root.scene.map_or(0, |scene| scene.value()));
    let extras = scene.and_then(|scene| serde_json::from_str::<SceneExtras>(scene.extras.as_ref()?.get()).ok());
    let radiance =
        extras.map(|extras| extras.environment).filter(|radiance| radiance.iter().all(|&channel| (0.0..f32::MAX).contains(&channel)));
    radiance.map_or_else(Environment::default, Environment::Constant)
}

fn warn_of_unsupported(root: &Root, warnings: &mut Warnings) {
    for name in root.extensions_used.iter().filter(|name| !document::SUPPORTED_EXTENSIONS.contains(&name.as_str())) {
        warnings.add(format!("extension {name} is not supported and was ignored"));
    }
    let skinned = root.nodes.iter().filter(|node| node.skin.is_some()).count();
    warnings.add_count("skins ignored: meshes keep their rest pose", skinned);
}

/// Reads the meshes that nodes place with a size, and places them.
fn place_meshes(
    document: &Document,
    tree: &Tree,
    animation: &Animation,
    reader: mesh::Reader,
    warnings: &mut Warnings,
) -> Result<(Vec<Mesh>, Vec<Instance>), Problem> {
    let nodes = &document.root.nodes;
    let locals: Vec<Local> = tree.nodes.iter().map(|node| node.local).collect();
    let world = transform::world_transforms(&tree.nodes, &locals);
    let moving = animation.moving_nodes(&tree.nodes);
    let with_mesh = tree.sources.iter().enumerate().filter_map(|(node, source)| Some((node, nodes[*source].mesh?.value())));
    // An animation may well start at size zero.
    let (placed, flat): (Vec<_>, Vec<_>) = with_mesh.partition(|&(node, _)| moving[node] || transform::is_invertible(&world[node]));
    warnings.add_count("instances skipped because their node has a scale of zero", flat.len());
    let mut used: Vec<usize> = placed.iter().map(|&(_, mesh)| mesh).collect();
    used.sort_unstable();
    used.dedup();
    let mut meshes = reader.read_all(&used, warnings)?;
    let mut numbers = vec![None; meshes.len()];
    for (number, i) in (0..meshes.len()).filter(|&i| !meshes[i].triangles.is_empty()).enumerate() {
        numbers[i] = Some(number as u32);
    }
    meshes.retain(|mesh| !mesh.triangles.is_empty());
    let instance = |&(node, mesh): &(usize, usize)| {
        let mesh = numbers[used.binary_search(&mesh).ok()?]?;
        Some(Instance { mesh, node: node as u32 })
    };
    Ok((meshes, placed.iter().filter_map(instance).collect()))
}
