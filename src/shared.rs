//! Structs and constants that shaders share: generated from shaders_glsl/shared/ when built, scalar layout, checked against the
//! compiled modules.

include!(concat!(env!("OUT_DIR"), "/shared.rs"));
