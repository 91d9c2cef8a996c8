//! Whole pictures: exact answers, estimators and structures that must agree, and independent renderers' images.

#[path = "../common/mod.rs"]
mod common;

mod agreement;
mod budgets;
mod denoised;
mod detail;
mod exact;
mod kernels;
mod motion;
mod references;
mod rounds;
mod shared_scenes;
mod switches;
mod surfaces;
mod temporal;
mod terms;
mod textures;
mod worlds;
