//! The kernels: embedded when built, or compiled from `PATHSPACE_SHADER_DIR`.

use super::error::GpuError;
use shader_compiler::{Precision, Variant};
use std::path::{Path, PathBuf};

struct Shader {
    stem: &'static str,
    structure: Option<&'static str>,
    precision: Option<Precision>,
    spirv: &'static [u8],
}

static EMBEDDED: &[Shader] = include!(concat!(env!("OUT_DIR"), "/shaders.rs"));

/// Every kernel, by its path below shaders_glsl/ without extension; one that traces rays once per structure.
pub fn shader_stems() -> impl Iterator<Item = (&'static str, Option<&'static str>)> {
    EMBEDDED.iter().map(|shader| (shader.stem, shader.structure))
}

/// Whether a kernel traces rays.
pub fn traces_rays(stem: &str) -> bool {
    EMBEDDED.iter().any(|shader| shader.stem == stem && shader.structure.is_some())
}

/// A kernel's SPIR-V. `structure` is the stem of an acceleration structure's file, and matters to kernels that trace rays only;
/// `precision` matters to those with images or cells in the frame's precision.
///
/// # Errors
/// No such kernel, or one on disk that does not compile.
pub fn load_shader(stem: &str, structure: &str, precision: Precision) -> Result<Vec<u32>, GpuError> {
    let fits = |shader: &Shader| shader.structure.is_none_or(|s| s == structure) && shader.precision.is_none_or(|p| p == precision);
    let matches = |shader: &&Shader| shader.stem == stem && fits(shader);
    let shader = EMBEDDED.iter().find(matches).ok_or_else(|| GpuError::UnknownShader(stem.to_owned()))?;
    if let Some(directory) = std::env::var_os("PATHSPACE_SHADER_DIR") {
        let file = PathBuf::from(format!("{stem}.comp"));
        let structure = shader.structure.map(str::to_owned);
        let variant = Variant { file, stem: stem.to_owned(), structure, precision: shader.precision };
        return Ok(shader_compiler::compile_variant(Path::new(&directory), &variant)?);
    }
    Ok(bytemuck::pod_collect_to_vec(shader.spirv))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kernels_that_include_a_structure_trace() {
        assert!(["paths/gbuffer", "paths/megakernel", "paths/wavefront/extend", "paths/wavefront/connect"].into_iter().all(traces_rays));
        assert!(!["display/composite", "paths/wavefront/write"].into_iter().any(traces_rays));
    }
}
