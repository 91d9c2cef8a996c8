//! Input that is wrong, extreme or hostile.

#[path = "../common/glb.rs"]
mod glb;

mod scene_bad_input;
mod scene_malformed;
