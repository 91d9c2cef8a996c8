//! Meshes that are placed once and never move become one mesh, so that rays need not enter many small structures that overlap.
//!
//! Its vertices are relative to the centre of all merged instances, which its node carries in double precision: a scene far away from zero
//! keeps its detail. Normals go through the inverse transpose, mirrored triangles change their winding, handedness of tangents theirs.

use super::transform::{flips_winding, world_transforms};
use super::{Instance, Local, Mesh, Node, Scene};
use glam::{DMat3, DMat4, DVec3};

/// Merges what can be; instances that move, and meshes placed more than once, stay as they are.
pub fn merge_static(scene: &mut Scene) {
    let world = world_transforms(&scene.nodes, &scene.animation.sample(&scene.nodes, 0.0));
    let moving = scene.animation.moving_nodes(&scene.nodes);
    let mut uses = vec![0; scene.meshes.len()];
    scene.instances.iter().for_each(|instance| uses[instance.mesh as usize] += 1);
    let merges = |instance: &Instance| uses[instance.mesh as usize] == 1 && !moving[instance.node as usize];
    let (merged, kept): (Vec<Instance>, Vec<Instance>) = scene.instances.iter().partition(|instance| merges(instance));
    if merged.len() < 2 {
        return;
    }
    let center = center(scene, &merged, &world);
    let parts: Vec<Mesh> = merged.iter().map(|instance| placed(scene, instance, &world, center)).collect();
    let node = scene.nodes.len() as u32;
    scene.nodes.push(Node { name: "static".to_owned(), parent: None, local: Local::Matrix(DMat4::from_translation(center)) });
    // Emptied instead of removed: indices of the other meshes stay.
    merged.iter().for_each(|instance| scene.meshes[instance.mesh as usize] = Mesh::default());
    scene.instances = kept;
    scene.instances.push(Instance { mesh: scene.meshes.len() as u32, node });
    scene.meshes.push(join(parts));
    remove_empty_meshes(scene);
}

fn center(scene: &Scene, instances: &[Instance], world: &[DMat4]) -> DVec3 {
    let corners = instances.iter().flat_map(|instance| {
        let (matrix, mesh) = (world[instance.node as usize], &scene.meshes[instance.mesh as usize]);
        mesh.positions.iter().map(move |&p| matrix.transform_point3(DVec3::from_array(p.map(f64::from))))
    });
    let bounds = corners.map(|p| (p, p)).reduce(|(low, high), (p, _)| (low.min(p), high.max(p)));
    bounds.map_or(DVec3::ZERO, |(low, high)| 0.5 * (low + high))
}

/// The instance's mesh with its vertices in the world, relative to `center`.
fn placed(scene: &Scene, instance: &Instance, world: &[DMat4], center: DVec3) -> Mesh {
    let matrix = DMat4::from_translation(-center) * world[instance.node as usize];
    let linear = DMat3::from_mat4(matrix);
    let for_normals = linear.inverse().transpose();
    let mirrored = flips_winding(&matrix);
    let vector = |matrix: &DMat3, v: [f32; 3]| (*matrix * DVec3::from_array(v.map(f64::from))).normalize_or_zero().as_vec3().to_array();
    let mut mesh = scene.meshes[instance.mesh as usize].clone();
    for position in &mut mesh.positions {
        *position = matrix.transform_point3(DVec3::from_array(position.map(f64::from))).as_vec3().to_array();
    }
    mesh.normals.iter_mut().for_each(|normal| *normal = vector(&for_normals, *normal));
    for [x, y, z, w] in &mut mesh.tangents {
        [*x, *y, *z] = vector(&linear, [*x, *y, *z]);
        *w = if mirrored { -*w } else { *w };
    }
    if mirrored {
        mesh.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
    }
    mesh
}

fn join(parts: Vec<Mesh>) -> Mesh {
    let any = |has: fn(&Mesh) -> bool| parts.iter().any(has);
    let (tangents, uv0) = (any(|m| !m.tangents.is_empty()), any(|m| !m.uv0.is_empty()));
    let (uv1, colors) = (any(|m| !m.uv1.is_empty()), any(|m| !m.colors.is_empty()));
    let mut whole = Mesh { name: "static".to_owned(), ..Mesh::default() };
    for part in parts {
        let (first, count) = (whole.positions.len() as u32, part.positions.len());
        whole.positions.extend(part.positions);
        whole.normals.extend(part.normals);
        append(&mut whole.tangents, part.tangents, count, tangents, [0.0; 4]);
        append(&mut whole.uv0, part.uv0, count, uv0, [0.0; 2]);
        append(&mut whole.uv1, part.uv1, count, uv1, [0.0; 2]);
        append(&mut whole.colors, part.colors, count, colors, [1.0; 4]);
        whole.triangles.extend(part.triangles.iter().map(|triangle| triangle.map(|corner| corner + first)));
        whole.triangle_materials.extend(part.triangle_materials);
    }
    whole
}

/// One vertex attribute of one part; `otherwise` where the part lacks what some other part has.
fn append<T: Copy>(whole: &mut Vec<T>, part: Vec<T>, count: usize, wanted: bool, otherwise: T) {
    match (wanted, part.is_empty()) {
        (true, true) => whole.extend(std::iter::repeat_n(otherwise, count)),
        (true, false) => whole.extend(part),
        (false, _) => {}
    }
}

fn remove_empty_meshes(scene: &mut Scene) {
    let mut next = 0..;
    let places: Vec<Option<u32>> = scene.meshes.iter().map(|m| if m.triangles.is_empty() { None } else { next.next() }).collect();
    scene.meshes.retain(|mesh| !mesh.triangles.is_empty());
    scene.instances.retain_mut(|instance| match places[instance.mesh as usize] {
        Some(place) => {
            instance.mesh = place;
            true
        }
        None => false,
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangle() -> Mesh {
        Mesh {
            positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            normals: vec![[0.0, 0.0, 1.0]; 3],
            triangles: vec![[0, 1, 2]],
            triangle_materials: vec![0],
            ..Mesh::default()
        }
    }

    fn scene(places: &[(u32, DMat4)]) -> Scene {
        let node = |&(_, matrix): &(u32, DMat4)| Node { name: String::new(), parent: None, local: Local::Matrix(matrix) };
        let count = places.iter().map(|&(mesh, _)| mesh + 1).max().unwrap();
        Scene {
            meshes: vec![triangle(); count as usize],
            nodes: places.iter().map(node).collect(),
            instances: (0..).zip(places).map(|(node, &(mesh, _))| Instance { mesh, node }).collect(),
            ..Scene::default()
        }
    }

    #[test]
    fn single_uses_merge_and_shared_meshes_stay() {
        let at = |x: f64| DMat4::from_translation(DVec3::new(x, 0.0, 0.0));
        let mut scene = scene(&[(0, at(1.0)), (1, at(2.0)), (2, at(3.0)), (2, at(4.0))]);
        merge_static(&mut scene);
        assert_eq!(scene.meshes.iter().map(|mesh| mesh.triangles.len()).collect::<Vec<_>>(), [1, 2]);
        assert_eq!(scene.instances.iter().map(|instance| instance.mesh).collect::<Vec<_>>(), [0, 0, 1]);
    }

    #[test]
    fn a_mirrored_part_keeps_its_front_and_a_far_one_its_detail() {
        let far = DVec3::new(1e7, 0.0, 0.0);
        let mirror = DMat4::from_translation(far) * DMat4::from_scale(DVec3::new(-1.0, 1.0, 1.0));
        let mut scene = scene(&[(0, mirror), (1, DMat4::from_translation(far + DVec3::new(0.001, 0.0, 0.0)))]);
        merge_static(&mut scene);
        let mesh = &scene.meshes[0];
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|corner| glam::Vec3::from(mesh.positions[corner as usize]));
            assert!((b - a).cross(c - a).z > 0.0, "counter-clockwise around its normal");
        }
        let gap = mesh.positions[3][0] - mesh.positions[0][0];
        assert!((gap - 0.001).abs() < 1e-6, "{gap}");
    }
}
