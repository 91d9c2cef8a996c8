//! The node tree: checked to be a forest, flattened so that parents come first, without recursion.

use glam::{DMat4, DQuat, DVec3};
use gltf::json::Root;

use super::{
    document::{Document, NodeTransform, label},
    warnings::Warnings,
};
use crate::scene::{Local, Node, Problem};

/// The nodes that the scene reaches.
pub(super) struct Tree {
    pub nodes: Vec<Node>,
    /// The file's index of each of `nodes`.
    pub sources: Vec<usize>,
    /// Index into `nodes` of each of the file's nodes.
    pub indices: Vec<Option<u32>>,
}

/// Flattens the default scene, or the first, or where there is none every tree of the file.
pub(super) fn flatten(document: &Document, warnings: &mut Warnings) -> Result<Tree, Problem> {
    let root = &document.root;
    let parents = parents(root)?;
    check_acyclic(root, &parents)?;
    let scene = root.scene.map_or(0, |scene| scene.value());
    let roots: Vec<usize> = match root.scenes.get(scene) {
        Some(scene) => scene.nodes.iter().map(|node| node.value()).collect(),
        None => (0..root.nodes.len()).filter(|&node| parents[node].is_none()).collect(),
    };
    let mut tree = Tree { nodes: Vec::new(), sources: Vec::new(), indices: vec![None; root.nodes.len()] };
    for &start in &roots {
        if parents[start].is_some() || tree.indices[start].is_some() {
            let what = "is listed as a root of the scene, but has a parent or is listed twice";
            return Err(Problem::invalid(node_label(root, start), what));
        }
        for index in preorder(root, start) {
            let parent = parents[index].and_then(|parent| tree.indices[parent]);
            let name = root.nodes[index].name.clone().unwrap_or_default();
            let local = local(&document.transforms[index], warnings).map_err(|what| Problem::invalid(node_label(root, index), what))?;
            tree.indices[index] = Some(tree.nodes.len() as u32);
            tree.nodes.push(Node { name, parent, local });
            tree.sources.push(index);
        }
    }
    Ok(tree)
}

pub(super) fn node_label(root: &Root, index: usize) -> String {
    label("node", gltf::json::Index::<Node>::new(index as u32), &root.nodes[index].name)
}

fn children(root: &Root, index: usize) -> impl DoubleEndedIterator<Item = usize> {
    root.nodes[index].children.iter().flatten().map(|child| child.value())
}

fn parents(root: &Root) -> Result<Vec<Option<usize>>, Problem> {
    let mut parents = vec![None; root.nodes.len()];
    for parent in 0..root.nodes.len() {
        for child in children(root, parent) {
            if let Some(other) = parents[child].replace(parent) {
                let what = format!("has two parents, nodes {other} and {parent}; nodes must form trees");
                return Err(Problem::invalid(node_label(root, child), what));
            }
        }
    }
    Ok(parents)
}

/// With one parent each at most, what no root reaches is on a cycle or below one.
fn check_acyclic(root: &Root, parents: &[Option<usize>]) -> Result<(), Problem> {
    let mut reached = vec![false; parents.len()];
    for start in (0..parents.len()).filter(|&node| parents[node].is_none()) {
        preorder(root, start).for_each(|node| reached[node] = true);
    }
    match reached.iter().position(|reached| !reached) {
        Some(node) => Err(Problem::invalid(node_label(root, node), "is its own ancestor; nodes must form trees")),
        None => Ok(()),
    }
}

fn preorder(root: &Root, start: usize) -> impl Iterator<Item = usize> {
    let mut stack = vec![start];
    std::iter::from_fn(move || {
        let node = stack.pop()?;
        stack.extend(children(root, node).rev());
        Some(node)
    })
}

fn local(transform: &NodeTransform, warnings: &mut Warnings) -> Result<Local, String> {
    if let Some(matrix) = transform.matrix {
        let matrix = DMat4::from_cols_array(&matrix);
        let affine = matrix.row(3).abs_diff_eq(glam::DVec4::W, 1e-6);
        return if affine && matrix.is_finite() {
            Ok(Local::Matrix(matrix))
        } else {
            Err("its matrix is not a finite affine transform".into())
        };
    }
    let translation = DVec3::from(transform.translation.unwrap_or_default());
    let scale = DVec3::from(transform.scale.unwrap_or([1.0; 3]));
    let rotation = DQuat::from_array(transform.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]));
    if !(translation.is_finite() && scale.is_finite() && rotation.is_finite()) {
        return Err("its transform is not finite".into());
    }
    Ok(Local::Trs { translation, rotation: unit_rotation(rotation, warnings), scale })
}

fn unit_rotation(rotation: DQuat, warnings: &mut Warnings) -> DQuat {
    if rotation.length_squared() > f64::MIN_POSITIVE {
        return rotation.normalize();
    }
    warnings.add("rotations of length zero replaced by no rotation");
    DQuat::IDENTITY
}
