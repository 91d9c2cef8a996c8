//! GLSL to SPIR-V with shaderc, and what the host needs to know about the result.
pub use shaderc;
