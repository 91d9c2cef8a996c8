//! Files that are wrong: each is refused with an error that names the place, or repaired and counted. None may panic.

use std::time::{Duration, Instant};

use pathspace::scene::{Problem, Scene, gltf};
use serde_json::{Value, json};

use crate::glb::{FLOAT, Glb, UNSIGNED_BYTE, png};

fn refused(glb: &Glb, parts: &[&str]) {
    let error = glb.load().expect_err("the file must be refused");
    for part in parts {
        assert!(error.contains(part), "'{part}' is not in: {error}");
    }
}

fn warned(scene: &Scene, text: &str) -> u64 {
    scene.warnings.iter().filter(|warning| warning.message.contains(text)).map(|warning| warning.count).sum()
}

/// A triangle with the given positions.
fn positioned(positions: &[f32]) -> Glb {
    let mut glb = Glb::triangle();
    let positions = glb.floats("VEC3", positions);
    *glb.primitive() = json!({ "attributes": { "POSITION": positions } });
    glb
}

#[test]
fn a_file_that_is_missing_or_a_folder_is_refused_with_its_path() {
    let folder = tempfile::tempdir().unwrap();
    for path in [folder.path().join("missing.glb"), folder.path().to_owned()] {
        let error = gltf::load(&path).unwrap_err();
        assert!(matches!(error.problem, Problem::Unreadable(_)));
        assert!(error.to_string().contains(&*path.to_string_lossy()));
    }
}

#[test]
fn garbage_is_refused() {
    let garbage: [&[u8]; 6] = [b"", b"\0", b"hello", b"{}", b"[1, 2]", b"glTF\x02\0\0\0\0\0\0\0"];
    for bytes in garbage {
        let error = gltf::load_slice(bytes, None, "garbage").unwrap_err();
        assert!(matches!(error.problem, Problem::Malformed { .. }), "{error}");
    }
    let nested = "[".repeat(1_000_000);
    assert!(gltf::load_slice(nested.as_bytes(), None, "nested").is_err());
}

/// Cuts a file everywhere, and flips each of its bytes: it may load, but must not panic.
#[test]
fn no_cut_and_no_flipped_byte_makes_the_loader_panic() {
    let mut glb = Glb::triangle();
    let texture = glb.texture(&png(2, 2, &[200; 16]), "image/png");
    let uv = glb.floats("VEC2", &[0.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
    glb.push(
        "materials",
        json!({ "normalTexture": { "index": texture }, "pbrMetallicRoughness": { "baseColorTexture": { "index": texture } } }),
    );
    glb.primitive()["material"] = json!(0);
    glb.primitive()["attributes"]["TEXCOORD_0"] = json!(uv);
    let (times, values) = (glb.floats("SCALAR", &[0.0, 1.0]), glb.floats("VEC3", &[0.0; 6]));
    let channel = json!({ "sampler": 0, "target": { "node": 0, "path": "translation" } });
    glb.push("animations", json!({ "channels": [channel], "samplers": [{ "input": times, "output": values }] }));
    let bytes = glb.bytes();
    assert!(gltf::load_slice(&bytes, None, "whole").is_ok());
    for length in 0..bytes.len() {
        let _ = gltf::load_slice(&bytes[..length], None, "cut");
    }
    for i in 0..bytes.len() {
        for mask in [1, 0x10, 0xff] {
            let mut flipped = bytes.clone();
            flipped[i] ^= mask;
            let _ = gltf::load_slice(&flipped, None, "flipped");
        }
    }
}

/// Replaces each number of the JSON by extremes.
#[test]
fn no_extreme_number_makes_the_loader_panic_or_allocate_without_bound() {
    let mut glb = Glb::triangle();
    let indices = glb.view(&[0, 1]);
    glb.json["accessors"][0]["sparse"] = json!({ "count": 2, "indices": { "bufferView": indices, "componentType": UNSIGNED_BYTE, "byteOffset": 0 }, "values": { "bufferView": 0, "byteOffset": 0 } });
    glb.json["bufferViews"][0]["byteStride"] = json!(12);
    glb.json["nodes"][0]["scale"] = json!([1.0, 2.0, 3.0]);
    let numbers: Vec<String> = glb.json.to_string().match_indices(|c: char| c.is_ascii_digit()).map(|(i, _)| i.to_string()).collect();
    let start = Instant::now();
    for at in numbers {
        let at: usize = at.parse().unwrap();
        for extreme in ["0", "3", "255", "4294967295", "4294967296", "18446744073709551615", "-1", "1e300"] {
            let mut text = glb.json.to_string();
            text.replace_range(at..=at, extreme);
            let Ok(json) = serde_json::from_str::<Value>(&text) else { continue };
            let _ = Glb { json, bin: glb.bin.clone() }.load();
        }
    }
    assert!(start.elapsed() < Duration::from_secs(60));
}

#[test]
fn an_index_out_of_range_is_refused_with_its_mesh() {
    let mut glb = Glb::triangle();
    let indices = glb.accessor("SCALAR", UNSIGNED_BYTE, 3, &[0, 1, 7]);
    glb.primitive()["indices"] = json!(indices);
    refused(&glb, &["mesh 'shape', primitive 0", "index 2 refers to vertex 7 of 3"]);
}

#[test]
fn references_to_what_does_not_exist_are_refused_with_their_place() {
    let spoil = |pointer: &str, value: Value| {
        let mut glb = Glb::triangle();
        glb.json["materials"] = json!([{ "pbrMetallicRoughness": {} }]);
        glb.json["animations"] = json!([{ "channels": [], "samplers": [{ "input": 0, "output": 0 }] }]);
        let (parent, key) = pointer.rsplit_once('/').unwrap();
        glb.json.pointer_mut(parent).unwrap()[key] = value;
        glb
    };
    refused(&spoil("/scenes/0/nodes", json!([9])), &["scenes[0].nodes[0]"]);
    refused(&spoil("/nodes/0/mesh", json!(9)), &["nodes[0].mesh"]);
    refused(&spoil("/nodes/0/children", json!([9])), &["nodes[0].children[0]"]);
    refused(&spoil("/meshes/0/primitives/0/attributes/POSITION", json!(9)), &["meshes[0].primitives[0].attributes.POSITION"]);
    refused(&spoil("/meshes/0/primitives/0/attributes/NORMAL", json!(9)), &["meshes[0].primitives[0]"]);
    refused(&spoil("/meshes/0/primitives/0/indices", json!(9)), &["meshes[0].primitives[0].indices"]);
    refused(&spoil("/meshes/0/primitives/0/material", json!(9)), &["meshes[0].primitives[0].material"]);
    refused(&spoil("/accessors/0/bufferView", json!(9)), &["accessors[0].bufferView"]);
    refused(&spoil("/bufferViews/0/buffer", json!(9)), &["bufferViews[0].buffer"]);
    refused(&spoil("/materials/0/normalTexture", json!({ "index": 9 })), &["materials[0].normalTexture"]);
    let clearcoat = json!({ "KHR_materials_clearcoat": { "clearcoatTexture": { "index": 9 } } });
    refused(&spoil("/materials/0/extensions", clearcoat), &["material 0", "texture 9"]);
    let channel = json!([{ "sampler": 0, "target": { "node": 9, "path": "scale" } }]);
    refused(&spoil("/animations/0/channels", channel), &["animations[0].channels[0], target"]);
}

#[test]
fn positions_that_are_not_finite_are_refused_with_their_vertex() {
    for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        refused(&positioned(&[0.0, 0.0, 0.0, 1.0, value, 0.0, 0.0, 1.0, 0.0]), &["mesh 'shape', primitive 0", "vertex 1", "finite"]);
    }
}

#[test]
fn positions_near_the_largest_number_load() {
    let far = f32::MAX;
    let scene = positioned(&[far, 0.0, 0.0, -far, far, 0.0, 0.0, -far, 0.0]).load().unwrap();
    assert_eq!(scene.meshes[0].normals, [[0.0, 0.0, 1.0]; 3]);
}

#[test]
fn claims_of_gigabytes_are_refused_at_once() {
    let start = Instant::now();
    let mut glb = Glb::triangle();
    glb.json["accessors"][0]["count"] = json!(4_000_000_000u64);
    refused(&glb, &["accessors[0]", "claims 4000000000 elements"]);
    glb.json["accessors"][0] = json!({ "componentType": FLOAT, "type": "VEC3", "count": 350_000_000 });
    refused(&glb, &["accessors[0]", "claims 350000000 elements without a buffer view"]);
    let mut glb = Glb::triangle();
    glb.json["buffers"][0]["byteLength"] = json!(4u64 << 30);
    refused(&glb, &["buffers[0]", "claims 4294967296 bytes", "truncated"]);
    let mut glb = Glb::triangle();
    glb.json["bufferViews"][0]["byteLength"] = json!(u64::MAX);
    refused(&glb, &["bufferViews[0]", "outside buffer 0"]);
    assert!(start.elapsed() < Duration::from_secs(1));
}

#[test]
fn cycles_second_parents_and_doubled_roots_are_refused_with_their_node() {
    let with_nodes = |nodes: Value, roots: Value| {
        let mut glb = Glb::triangle();
        glb.json["nodes"] = nodes;
        glb.json["scenes"][0]["nodes"] = roots;
        glb
    };
    let below = |children: &[usize]| json!({ "mesh": 0, "children": children });
    refused(&with_nodes(json!([below(&[1]), below(&[0])]), json!([0])), &["node 0", "its own ancestor"]);
    refused(&with_nodes(json!([below(&[0])]), json!([0])), &["node 0", "its own ancestor"]);
    refused(&with_nodes(json!([below(&[2]), below(&[2]), below(&[])]), json!([0, 1])), &["node 2", "two parents"]);
    refused(&with_nodes(json!([below(&[])]), json!([0, 0])), &["node 0", "twice"]);
}

#[test]
fn a_tree_of_a_hundred_thousand_levels_loads() {
    let depth = 100_000;
    let mut glb = Glb::triangle();
    let node = |i: usize| json!({ "translation": [0.0, 0.0, 0.5], "children": [i + 1] });
    let mut nodes: Vec<Value> = (0..depth - 1).map(node).collect();
    nodes.push(json!({ "mesh": 0 }));
    glb.json["nodes"] = json!(nodes);
    let scene = glb.load().unwrap();
    let locals = scene.animation.sample(&scene.nodes, 0.0);
    let world = pathspace::scene::transform::world_transforms(&scene.nodes, &locals);
    assert_eq!(world[scene.instances[0].node as usize].w_axis.z, 0.5 * (depth - 1) as f64);
}

#[test]
fn a_node_of_zero_scale_is_skipped_and_counted() {
    for scale in [[0.0, 0.0, 0.0], [1.0, 0.0, 1.0], [1e-30, 1.0, 1.0]] {
        let mut glb = Glb::triangle();
        glb.json["nodes"] = json!([{ "mesh": 0 }, { "scale": scale, "children": [2] }, { "mesh": 0 }]);
        glb.json["scenes"][0]["nodes"] = json!([0, 1]);
        let scene = glb.load().unwrap();
        assert_eq!((scene.instances.len(), warned(&scene, "scale of zero")), (1, 1));
    }
}

#[test]
fn transforms_that_are_not_finite_or_affine_are_refused_with_their_node() {
    let mut glb = Glb::triangle();
    let mut matrix = [0.0; 16];
    matrix[3] = 1.0;
    glb.json["nodes"][0] = json!({ "name": "odd", "mesh": 0, "matrix": matrix });
    refused(&glb, &["node 'odd'", "matrix"]);
    // Finite as written, but not when composed.
    glb.json["nodes"] = json!([{ "scale": [1e200, 1e200, 1e200], "children": [1] }, { "scale": [1e200, 1e200, 1e200], "mesh": 0 }]);
    refused(&glb, &["nothing to render"]);
}

#[test]
fn a_scene_without_a_triangle_is_refused_and_says_what_was_skipped() {
    refused(&Glb::empty(), &["nothing to render"]);
    let mut lit = Glb::empty();
    lit.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [{ "type": "point" }] } });
    lit.json["nodes"][0]["extensions"] = json!({ "KHR_lights_punctual": { "light": 0 } });
    refused(&lit, &["nothing to render"]);
    let mut lines = Glb::triangle();
    lines.primitive()["mode"] = json!(1);
    refused(&lines, &["nothing to render", "points or lines skipped in mesh 'shape' (1 x)"]);
    refused(&positioned(&[0.0; 9]), &["nothing to render", "degenerate triangles"]);
}

#[test]
fn a_required_extension_that_is_unknown_is_refused_and_an_optional_one_counted() {
    let mut glb = Glb::triangle();
    glb.json["extensionsUsed"] = json!(["KHR_draco_mesh_compression"]);
    assert_eq!(warned(&glb.load().unwrap(), "KHR_draco_mesh_compression"), 1);
    glb.json["extensionsRequired"] = json!(["KHR_texture_transform", "KHR_draco_mesh_compression"]);
    refused(&glb, &["needs the extension KHR_draco_mesh_compression"]);
}

/// A textured triangle with the given image.
fn textured(image: &[u8]) -> Glb {
    let mut glb = Glb::triangle();
    let texture = glb.texture(image, "image/png");
    let normal = glb.texture(image, "image/png");
    glb.push(
        "materials",
        json!({ "pbrMetallicRoughness": { "baseColorTexture": { "index": texture } }, "normalTexture": { "index": normal } }),
    );
    glb.primitive()["material"] = json!(0);
    glb
}

#[test]
fn images_of_size_zero_are_refused_with_their_image() {
    refused(&textured(b""), &["image 0", "size of 0"]);
    let mut image = png(1, 1, &[255; 4]);
    image[16..20].fill(0);
    refused(&textured(&image), &["image 0", "size of 0"]);
}

#[test]
fn images_that_cannot_be_decoded_are_replaced_by_white_or_flat_and_counted() {
    let cut = &png(8, 8, &[7; 256])[..60];
    for image in [&b"GIF89a nonsense"[..], cut] {
        let scene = textured(image).load().unwrap();
        assert_eq!(scene.textures[0].mips, [vec![255; 4]]);
        assert_eq!(scene.textures[1].mips, [vec![128, 128, 255, 255]]);
        assert_eq!(warned(&scene, "replaced by a uniform one"), 2);
    }
    let mut glb = textured(&png(1, 1, &[9; 4]));
    glb.json["images"][0] = json!({ "uri": "not%20there.png" });
    assert_eq!(warned(&glb.load().unwrap(), "an in-memory scene has no folder"), 1);
    let scene = gltf::load_slice(&glb.bytes(), Some(std::path::Path::new("/nowhere")), "test").unwrap();
    assert_eq!(warned(&scene, "not there.png"), 1);
    glb.json["textures"][0] = json!({ "extensions": { "KHR_texture_basisu": { "source": 0 } } });
    assert_eq!(warned(&glb.load().unwrap(), "no source in a supported format"), 1);
}

/// 30000 x 30000 texels in a few bytes.
#[test]
fn an_image_that_claims_gigabytes_is_replaced_without_decoding() {
    let mut image = png(1, 1, &[255; 4]);
    image[16..20].copy_from_slice(&30_000u32.to_be_bytes());
    image[20..24].copy_from_slice(&30_000u32.to_be_bytes());
    let crc = crc32(&image[12..29]);
    image[29..33].copy_from_slice(&crc.to_be_bytes());
    let start = Instant::now();
    let result = textured(&image).load();
    assert!(start.elapsed() < Duration::from_secs(1));
    assert!(result.map_or_else(|error| error.contains("images"), |scene| warned(&scene, "replaced") == 2));
}

/// Of a PNG chunk.
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |crc, &byte| (0..8).fold(crc ^ u32::from(byte), |crc, _| (crc >> 1) ^ (0xedb8_8320 * (crc & 1))))
}

#[test]
fn buffers_that_are_missing_or_damaged_are_refused_with_their_buffer() {
    for (uri, reason) in [
        ("file.bin", "refers to the file 'file.bin', but an in-memory scene has no folder"),
        ("data:application/octet-stream;base64,!!!!", "damaged"),
        ("data:,plain", "base64"),
        ("data:application/octet-stream;base64,AAAA", "truncated"),
    ] {
        let mut glb = Glb::triangle();
        glb.json["buffers"][0]["uri"] = json!(uri);
        refused(&glb, &["buffers[0]", reason]);
    }
    let mut glb = Glb::triangle();
    glb.json["buffers"][0]["uri"] = json!("no%20such.bin");
    let folder = tempfile::tempdir().unwrap();
    let error = gltf::load_slice(&glb.bytes(), Some(folder.path()), "test").unwrap_err().to_string();
    assert!(error.contains("buffers[0]: cannot read the file 'no such.bin'"), "{error}");
}

#[test]
fn keyframes_that_contradict_themselves_are_refused_with_their_channel() {
    let animated = |times: &[f32], values: &[f32]| {
        let mut glb = Glb::triangle();
        let (times, values) = (glb.floats("SCALAR", times), glb.floats("VEC3", values));
        let channel = json!({ "sampler": 0, "target": { "node": 0, "path": "translation" } });
        glb.push("animations", json!({ "channels": [channel], "samplers": [{ "input": times, "output": values }] }));
        glb
    };
    assert!(animated(&[0.0, 1.0], &[0.0; 6]).load().is_ok());
    let place = "animations[0].channels[0]";
    refused(&animated(&[1.0, 1.0], &[0.0; 6]), &[place, "increasing"]);
    refused(&animated(&[-1.0, 1.0], &[0.0; 6]), &[place, "increasing"]);
    refused(&animated(&[0.0, f32::NAN], &[0.0; 6]), &[place, "finite"]);
    refused(&animated(&[0.0, 1.0], &[0.0; 9]), &[place, "3 values for 2 keyframes"]);
    refused(&animated(&[0.0, 1.0], &[f32::NAN; 6]), &[place, "not finite"]);
}

#[test]
fn attributes_of_the_wrong_type_or_length_are_refused_with_their_place() {
    let mut glb = Glb::triangle();
    let (pairs, short) = (glb.floats("VEC2", &[0.0; 6]), glb.floats("VEC3", &[0.0; 6]));
    glb.primitive()["attributes"]["NORMAL"] = json!(pairs);
    refused(&glb, &["mesh 'shape', primitive 0", "NORMAL must be of type [Vec3], not Vec2"]);
    glb.primitive()["attributes"]["NORMAL"] = json!(short);
    refused(&glb, &["NORMAL", "has 2 elements for 3 vertices"]);
    let mut glb = Glb::triangle();
    glb.primitive()["indices"] = json!(0);
    refused(&glb, &["indices", "unsigned integers"]);
}
