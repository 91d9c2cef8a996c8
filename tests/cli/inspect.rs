//! `pathspace inspect`, and what it shares with render: where a scene comes from.

use super::{Run, assert_refused, run};

#[test]
fn inspect_prints_json_with_a_version_and_nothing_else() {
    let directory = tempfile::tempdir().unwrap();
    let Run { code, stdout, stderr } = run(directory.path(), &["inspect", "cornell", "--json"]);
    assert_eq!((code, stderr.as_str()), (Some(0), ""));
    let summary: serde_json::Value = serde_json::from_str(&stdout).expect("stdout is JSON alone");
    assert_eq!(summary["version"], 1);
    assert_eq!(summary["triangles"], 34);
}

#[test]
fn an_exported_scene_is_the_scene() {
    let directory = tempfile::tempdir().unwrap();
    assert_eq!(run(directory.path(), &["inspect", "cornell", "--export", "box.glb"]).code, Some(0));
    let triangles = |scene| {
        serde_json::from_str::<serde_json::Value>(&run(directory.path(), &["inspect", scene, "--json"]).stdout).unwrap()["triangles"]
            .clone()
    };
    assert_eq!(triangles("box.glb"), triangles("cornell"));
}

#[test]
fn an_export_that_is_no_glb_is_refused_before_anything_is_written() {
    let directory = tempfile::tempdir().unwrap();
    for name in ["box.obj", "box.gltf", "box", "glb"] {
        assert_refused(directory.path(), &["inspect", "cornell", "--export", name], &[name, ".glb"]);
    }
    assert_eq!(std::fs::read_dir(directory.path()).unwrap().count(), 0);
}

#[test]
fn scenes_that_cannot_be_read_are_refused() {
    let directory = tempfile::tempdir().unwrap();
    let path = |name: &str| directory.path().join(name);
    std::fs::write(path("empty.glb"), b"").unwrap();
    std::fs::write(path("garbage.glb"), [0xa5; 999]).unwrap();
    std::fs::write(path("garbage.gltf"), b"{\"asset\":").unwrap();
    assert_eq!(run(directory.path(), &["inspect", "cornell", "--export", "whole.glb"]).code, Some(0));
    let whole = std::fs::read(path("whole.glb")).unwrap();
    std::fs::write(path("truncated.glb"), &whole[..whole.len() / 2]).unwrap();
    for scene in ["missing.glb", "empty.glb", "garbage.glb", "garbage.gltf", "truncated.glb", "."] {
        assert_refused(directory.path(), &["inspect", scene], &[scene]);
    }
    assert_refused(directory.path(), &["inspect", "palace"], &["'palace'", "built in are", "cornell"]);
    assert_refused(directory.path(), &["inspect", "missing.glb", "--export", "a.glb"], &["no built-in scene"]);
    assert_refused(directory.path(), &["inspect", "cornell", "--export", "missing/a.glb"], &["missing/a.glb"]);
}
