//! What must hold whatever the input, each property named by its test.

#[path = "../common/mod.rs"]
mod common;
#[path = "../common/glb.rs"]
mod glb;

#[path = "../common/random.rs"]
mod random;
#[path = "../common/records.rs"]
mod records;
#[path = "../common/surface.rs"]
mod surface;

mod accel_parity;
mod assets;
mod bench_compare;
mod builtin;
mod effects;
mod filter_anhpsf;
mod filter_energy;
mod filter_hash_key;
mod filter_hpsf;
mod filter_hpsf_changes;
mod filter_hpsf_glossy;
mod filter_hpsf_history;
mod filter_hpsf_iterations;
mod filter_hpsf_order;
mod filter_hpsf_precision;
mod filter_hpsf_table;
mod filter_hpsf_time;
mod filter_nhpsf;
mod gpu_kernel;
mod metrics;
mod results_log;
mod scene_animation;
mod scene_materials;
mod scene_meshes;
mod scene_nodes;
mod scene_shared;
mod shader_lib_bsdf;
mod shader_lib_functions;
mod shader_lib_sampler;
mod shader_lib_storage;
