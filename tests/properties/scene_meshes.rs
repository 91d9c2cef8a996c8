//! What the loader makes of meshes.

use pathspace::scene::{Mesh, Scene};
use serde_json::json;

use crate::glb::{FLOAT, Glb, UNSIGNED_BYTE, UNSIGNED_INT, UNSIGNED_SHORT, png};

fn mesh(glb: &Glb) -> Mesh {
    glb.load().unwrap().meshes.remove(0)
}

fn warned(scene: &Scene, text: &str) -> u64 {
    scene.warnings.iter().filter(|warning| warning.message.contains(text)).map(|warning| warning.count).sum()
}

/// A unit square in the xy plane: positions only.
fn square() -> Glb {
    let mut glb = Glb::triangle();
    let positions = glb.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0]);
    let indices = glb.accessor("SCALAR", UNSIGNED_BYTE, 6, &[0, 1, 2, 0, 2, 3]);
    *glb.primitive() = json!({ "attributes": { "POSITION": positions }, "indices": indices });
    glb
}

#[test]
fn a_triangle_is_what_its_file_says() {
    let mesh = mesh(&Glb::triangle());
    assert_eq!(mesh.positions, [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    assert_eq!(mesh.normals, [[0.0, 0.0, 1.0]; 3]);
    assert_eq!((mesh.triangles, mesh.triangle_materials), (vec![[0, 1, 2]], vec![0]));
    assert!(mesh.uv0.is_empty() && mesh.uv1.is_empty() && mesh.colors.is_empty() && mesh.tangents.is_empty());
}

#[test]
fn indices_of_every_width_and_none_give_the_same_triangles() {
    let mut glb = Glb::triangle();
    let byte = glb.accessor("SCALAR", UNSIGNED_BYTE, 3, &[0, 1, 2]);
    let int = glb.accessor("SCALAR", UNSIGNED_INT, 3, bytemuck::cast_slice(&[0u32, 1, 2]));
    for indices in [json!(byte), json!(int), json!(null)] {
        glb.primitive()["indices"] = indices;
        assert_eq!(mesh(&glb).triangles, [[0, 1, 2]]);
    }
}

#[test]
fn strips_and_fans_wind_as_lists_do() {
    let mut glb = Glb::triangle();
    let around = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0];
    let zigzag = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0];
    for (mode, positions) in [(6, around), (5, zigzag)] {
        let positions = glb.floats("VEC3", &positions);
        *glb.primitive() = json!({ "attributes": { "POSITION": positions }, "mode": mode });
        let mesh = mesh(&glb);
        assert_eq!(mesh.triangles.len(), 2);
        assert_eq!(mesh.normals, [[0.0, 0.0, 1.0]; 6], "mode {mode}");
    }
}

#[test]
fn interleaved_data_and_normalised_integers_are_read() {
    let mut glb = Glb::triangle();
    // Positions of three shorts, colours of four bytes, in 12 bytes a vertex (KHR_mesh_quantization).
    let vertex = |x: i16, y: i16, color: [u8; 4]| [&x.to_le_bytes()[..], &y.to_le_bytes(), &[0, 128, 0, 0], &color].concat();
    let data = [vertex(0, -32768, [255, 0, 51, 255]), vertex(32767, 0, [0; 4]), vertex(0, 32767, [255; 4])].concat();
    let view = glb.view(&data);
    glb.json["bufferViews"][view]["byteStride"] = json!(12);
    let accessor = |component: u32, kind: &str, offset: u32| json!({ "bufferView": view, "byteOffset": offset, "componentType": component, "normalized": true, "count": 3, "type": kind });
    let positions = glb.push("accessors", accessor(5122, "VEC3", 0));
    let colors = glb.push("accessors", accessor(UNSIGNED_BYTE, "VEC4", 8));
    *glb.primitive() = json!({ "attributes": { "POSITION": positions, "COLOR_0": colors } });
    glb.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    let mesh = mesh(&glb);
    let z = -1.0;
    assert_eq!(mesh.positions, [[0.0, -1.0, z], [1.0, 0.0, z], [0.0, 1.0, z]]);
    assert_eq!(mesh.colors, [[1.0, 0.0, 0.2, 1.0], [0.0; 4], [1.0; 4]]);
}

#[test]
fn sparse_accessors_replace_elements_with_and_without_a_base() {
    let mut glb = Glb::triangle();
    let indices = glb.view(&[1, 2]);
    let values = glb.view(bytemuck::cast_slice(&[2.0f32, 0.0, 0.0, 0.0, 3.0, 0.0]));
    let sparse =
        json!({ "count": 2, "indices": { "bufferView": indices, "componentType": UNSIGNED_BYTE }, "values": { "bufferView": values } });
    glb.json["accessors"][0]["sparse"] = sparse.clone();
    let replaced = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 3.0, 0.0]];
    assert_eq!(mesh(&glb).positions, replaced);
    glb.json["accessors"][0] = json!({ "componentType": FLOAT, "count": 3, "type": "VEC3", "sparse": sparse });
    assert_eq!(mesh(&glb).positions, replaced);
}

#[test]
fn missing_normals_become_flat_ones() {
    let mut glb = Glb::triangle();
    // Two triangles that share an edge at a right angle; tangents without normals are ignored.
    let positions = glb.floats("VEC3", &[0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
    let tangents = glb.floats("VEC4", &[1.0; 16]);
    let indices = glb.accessor("SCALAR", UNSIGNED_BYTE, 6, &[0, 2, 1, 0, 1, 3]);
    *glb.primitive() = json!({ "attributes": { "POSITION": positions, "TANGENT": tangents }, "indices": indices });
    let mesh = mesh(&glb);
    assert_eq!(mesh.positions.len(), 6);
    assert_eq!(mesh.normals, [[[0.0, 0.0, 1.0]; 3], [[1.0, 0.0, 0.0]; 3]].concat());
    assert!(mesh.tangents.is_empty());
}

#[test]
fn zero_and_nan_normals_are_repaired_from_the_triangles_and_counted() {
    let mut glb = Glb::triangle();
    let normals = glb.floats("VEC3", &[0.0, 0.0, 0.0, f32::NAN, 0.0, 0.0, 0.0, 0.0, 2e-30]);
    glb.primitive()["attributes"]["NORMAL"] = json!(normals);
    let scene = glb.load().unwrap();
    assert_eq!(scene.meshes[0].normals, [[0.0, 0.0, 1.0]; 3]);
    assert_eq!(warned(&scene, "normals repaired"), 2);
}

#[test]
fn degenerate_triangles_points_and_lines_are_skipped_and_counted() {
    let mut glb = square();
    let indices = glb.accessor("SCALAR", UNSIGNED_BYTE, 9, &[0, 1, 2, 1, 1, 2, 2, 3, 2]);
    glb.primitive()["indices"] = json!(indices);
    let primitive = glb.primitive().clone();
    for mode in [0, 1, 3] {
        let mut lines = primitive.clone();
        lines["mode"] = json!(mode);
        glb.json["meshes"][0]["primitives"].as_array_mut().unwrap().push(lines);
    }
    let scene = glb.load().unwrap();
    assert_eq!(scene.meshes[0].triangles.len(), 1);
    assert_eq!((warned(&scene, "degenerate"), warned(&scene, "points or lines")), (2, 3));
}

/// A square with a normal map; v points down in the texture, up on the square.
fn normal_mapped_square() -> Glb {
    let mut glb = square();
    let normals = glb.floats("VEC3", &[0.0, 0.0, 1.0].repeat(4));
    let uv = glb.floats("VEC2", &[0.0, 1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0]);
    let texture = glb.texture(&png(1, 1, &[128, 128, 255, 255]), "image/png");
    glb.push("materials", json!({ "normalTexture": { "index": texture } }));
    glb.primitive()["attributes"]["NORMAL"] = json!(normals);
    glb.primitive()["attributes"]["TEXCOORD_0"] = json!(uv);
    glb.primitive()["material"] = json!(0);
    glb
}

#[test]
fn tangents_are_made_only_for_normal_maps_and_follow_the_texture() {
    let mut glb = normal_mapped_square();
    let mesh_with_map = mesh(&glb);
    // The map's x is the square's x; its y, up in the image, is the square's y = cross(z, x) * w.
    assert_eq!(mesh_with_map.tangents, [[1.0, 0.0, 0.0, 1.0]; 4]);
    glb.json["materials"][0] = json!({});
    assert!(mesh(&glb).tangents.is_empty());
}

#[test]
fn tangents_turn_with_the_texture_transform_and_mirror_with_the_texture() {
    let mut glb = normal_mapped_square();
    let mirrored = json!({ "KHR_texture_transform": { "scale": [-1.0, 1.0] } });
    glb.json["materials"][0]["normalTexture"]["extensions"] = mirrored;
    assert_eq!(mesh(&glb).tangents, [[-1.0, 0.0, 0.0, -1.0]; 4]);
}

#[test]
fn a_seam_where_the_texture_mirrors_splits_its_vertices() {
    let mut glb = normal_mapped_square();
    // u runs up to the diagonal and back: both triangles share two vertices, with opposite handedness.
    let uv = glb.floats("VEC2", &[0.0, 1.0, 1.0, 1.0, 0.0, 0.0, 1.0, 1.0]);
    glb.primitive()["attributes"]["TEXCOORD_0"] = json!(uv);
    let mesh = mesh(&glb);
    assert_eq!(mesh.positions.len(), 6);
    for (triangle, handedness) in mesh.triangles.iter().zip([1.0, -1.0]) {
        assert!(triangle.iter().all(|&vertex| mesh.tangents[vertex as usize][3] == handedness));
    }
}

#[test]
fn a_fan_of_very_many_triangles_gets_tangents_without_exhausting_the_stack() {
    let mut glb = normal_mapped_square();
    let count = 200_000;
    let on_circle = |i: usize| (i as f32 / count as f32 * std::f32::consts::TAU).sin_cos();
    let ring: Vec<(f32, f32)> = std::iter::once((0.0, 0.0)).chain((0..count).map(on_circle)).collect();
    let positions = glb.floats("VEC3", &ring.iter().flat_map(|&(sin, cos)| [cos, sin, 0.0]).collect::<Vec<_>>());
    let normals = glb.floats("VEC3", &[0.0, 0.0, 1.0].repeat(ring.len()));
    let uv = glb.floats("VEC2", &ring.iter().flat_map(|&(sin, cos)| [cos, -sin]).collect::<Vec<_>>());
    *glb.primitive() = json!({ "mode": 6, "material": 0, "attributes": { "POSITION": positions, "NORMAL": normals, "TEXCOORD_0": uv } });
    let mesh = mesh(&glb);
    assert!(mesh.tangents.iter().all(|tangent| tangent[0] > 0.99 && tangent[3] == 1.0));
}

#[test]
fn primitives_join_into_one_mesh_with_neutral_values_for_what_one_lacks() {
    let mut glb = Glb::triangle();
    let uv = glb.floats("VEC2", &[0.5; 6]);
    let colors = glb.floats("VEC3", &[0.25; 9]);
    glb.push("materials", json!({ "name": "second" }));
    let mut second = glb.primitive().clone();
    second["attributes"]["TEXCOORD_0"] = json!(uv);
    second["attributes"]["COLOR_0"] = json!(colors);
    second["material"] = json!(0);
    glb.json["meshes"][0]["primitives"].as_array_mut().unwrap().push(second);
    let mesh = mesh(&glb);
    assert_eq!(mesh.triangles, [[0, 1, 2], [3, 4, 5]]);
    // The file's material, and the default one after it.
    assert_eq!(mesh.triangle_materials, [1, 0]);
    assert_eq!(mesh.uv0, [[[0.0; 2]; 3], [[0.5; 2]; 3]].concat());
    assert_eq!(mesh.colors, [[[1.0; 4]; 3], [[0.25, 0.25, 0.25, 1.0]; 3]].concat());
}

#[test]
fn vertices_that_no_triangle_uses_are_left_out() {
    let mut glb = square();
    let normals = glb.floats("VEC3", &[0.0, 0.0, 1.0].repeat(4));
    let indices = glb.accessor("SCALAR", UNSIGNED_SHORT, 3, bytemuck::cast_slice(&[3u16, 1, 2]));
    glb.primitive()["attributes"]["NORMAL"] = json!(normals);
    glb.primitive()["indices"] = json!(indices);
    let mesh = mesh(&glb);
    assert_eq!((mesh.positions.len(), mesh.triangles), (3, vec![[2, 0, 1]]));
}

#[test]
fn skins_and_morph_targets_leave_the_base_shape_and_are_counted() {
    let mut glb = Glb::triangle();
    glb.primitive()["targets"] = json!([{ "POSITION": 1 }]);
    glb.json["skins"] = json!([{ "joints": [0] }]);
    glb.json["nodes"][0]["skin"] = json!(0);
    let scene = glb.load().unwrap();
    assert_eq!(scene.meshes[0].positions, mesh(&Glb::triangle()).positions);
    assert_eq!((warned(&scene, "skins"), warned(&scene, "morph")), (1, 1));
}
