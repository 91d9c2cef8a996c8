//! What only holds in the mean: sampling follows its densities, estimators agree with analytic answers. Every test has fixed
//! seeds and states how often it would fail by chance.

#[path = "../common/mod.rs"]
mod common;
#[path = "../common/random.rs"]
mod random;
#[path = "../common/surface.rs"]
mod surface;

mod bsdf_chi_square;
mod bsdf_parts;
mod furnace;
mod intervals;
mod lights;
mod split;
