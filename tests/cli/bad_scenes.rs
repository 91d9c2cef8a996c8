//! Files that are wrong, through the whole program: refused before anything is written, or rendered.

use super::{assert_refused, files, run};
use crate::glb::{Glb, png};
use serde_json::{Value, json};
use std::path::Path;

type Bend = fn(&mut Glb);

fn positions(glb: &mut Glb, value: f32) {
    let positions = glb.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, value, 0.0, 0.0, 1.0, 0.0]);
    *glb.primitive() = json!({ "attributes": { "POSITION": positions } });
}

/// A triangle, bent; what the message must hold beside the file's name.
const BENT: [(&str, Bend, &[&str]); 12] = [
    ("indices.glb", |glb| glb.bin[72..78].fill(9), &["mesh 'shape', primitive 0", "vertex 2313 of 3"]),
    ("nan.glb", |glb| positions(glb, f32::NAN), &["mesh 'shape', primitive 0", "vertex 1", "finite"]),
    ("infinite.glb", |glb| positions(glb, f32::INFINITY), &["mesh 'shape', primitive 0", "vertex 1", "finite"]),
    ("flat.glb", |glb| glb.json["nodes"][0]["scale"] = json!([0, 0, 0]), &["nothing to render", "scale of zero"]),
    ("empty.glb", |glb| *glb = Glb::empty(), &["nothing to render"]),
    ("no_scene.glb", |glb| glb.json["scenes"] = json!([]), &["scene"]),
    ("cycle.glb", |glb| glb.json["nodes"][0]["children"] = json!([0]), &["node 'root'", "its own ancestor"]),
    ("texture.glb", texture_without_texels, &["image 0", "size of 0"]),
    ("vertices.glb", |glb| glb.json["accessors"][0]["count"] = json!(350_000_000), &["accessors[0]", "claims 350000000 elements"]),
    ("buffer.glb", |glb| glb.json["buffers"][0]["byteLength"] = json!(4u64 << 30), &["buffers[0]", "claims 4294967296 bytes"]),
    ("missing_buffer.glb", |glb| glb.json["buffers"][0]["uri"] = json!("none.bin"), &["buffers[0]", "'none.bin'"]),
    ("extension.glb", |glb| glb.json["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]), &["KHR_draco_mesh_compression"]),
];

fn texture_without_texels(glb: &mut Glb) {
    let mut image = png(1, 1, &[255; 4]);
    image[16..20].fill(0);
    let texture = glb.texture(&image, "image/png");
    glb.push("materials", json!({ "pbrMetallicRoughness": { "baseColorTexture": { "index": texture } } }));
    glb.primitive()["material"] = json!(0);
}

fn render_refused(directory: &Path, arguments: &[&str], hints: &[&str]) {
    assert_refused(directory, &[&["render", "-o", "a.png", "-o", "a.exr", "--timings", "t.json"], arguments].concat(), hints);
}

#[test]
fn scenes_that_cannot_be_rendered_are_refused_with_file_and_place() {
    let directory = tempfile::tempdir().unwrap();
    for (name, bend, hints) in BENT {
        let mut glb = Glb::triangle();
        bend(&mut glb);
        std::fs::write(directory.path().join(name), glb.bytes()).unwrap();
        render_refused(directory.path(), &[name], &[&[name], hints].concat());
    }
}

#[test]
fn files_that_are_cut_or_garbage_are_refused_with_their_name() {
    let directory = tempfile::tempdir().unwrap();
    let (whole, json) = (Glb::triangle().bytes(), Glb::triangle().json.to_string());
    let half = |bytes: &[u8]| bytes[..bytes.len() / 2].to_vec();
    for (name, bytes) in [
        ("cut.glb", half(&whole)),
        ("cut.gltf", half(json.as_bytes())),
        ("garbage.glb", vec![0xa5; 999]),
        ("garbage.gltf", vec![0xa5; 999]),
        ("nothing.gltf", Vec::new()),
        ("nested.gltf", vec![b'['; 1_000_000]),
        ("no_buffer.gltf", json.into_bytes()),
    ] {
        std::fs::write(directory.path().join(name), bytes).unwrap();
        render_refused(directory.path(), &[name], &[name]);
    }
    render_refused(directory.path(), &["missing.gltf"], &["missing.gltf"]);
}

#[test]
fn environments_that_cannot_be_read_are_refused_with_their_name() {
    let directory = tempfile::tempdir().unwrap();
    for (name, bytes) in [
        ("garbage.hdr", &b"garbage"[..]),
        ("cut.hdr", b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 64 +X 128\n\x02\x02"),
        ("empty.hdr", b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 0 +X 0\n"),
        ("huge.hdr", b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2000000000 +X 2000000000\n"),
        ("png.hdr", b"\x89PNG\r\n\x1a\n"),
        ("garbage.exr", b"garbage"),
    ] {
        std::fs::write(directory.path().join(name), bytes).unwrap();
        render_refused(directory.path(), &["--environment", name], &[name]);
    }
}

#[test]
fn a_tree_of_a_hundred_thousand_levels_renders() {
    let directory = tempfile::tempdir().unwrap();
    let mut glb = Glb::triangle();
    let mut nodes: Vec<Value> = (1..100_000).map(|child| json!({ "translation": [0, 0, 0.5], "children": [child] })).collect();
    nodes.push(json!({ "mesh": 0 }));
    glb.json["nodes"] = json!(nodes);
    std::fs::write(directory.path().join("deep.glb"), glb.bytes()).unwrap();
    let rendered = run(directory.path(), &["render", "deep.glb", "-o", "a.png", "--size", "8x8", "--frames", "1"]);
    assert_eq!((rendered.code, rendered.stderr.as_str()), (Some(0), ""));
    assert_eq!(files(directory.path()), ["a.png", "deep.glb"]);
}
