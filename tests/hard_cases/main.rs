//! Input that is wrong, extreme or hostile.

#[path = "../common/mod.rs"]
mod common;
#[path = "../common/glb.rs"]
mod glb;

mod accel_extremes;
mod accel_ray_offset;
mod accel_watertight;
mod cli_no_ray_query;
mod gpu_limits;
mod scene_bad_input;
mod scene_malformed;
