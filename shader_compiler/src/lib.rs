//! GLSL to SPIR-V with shaderc, and what the host needs to know about the result: bindings, parameters, struct layouts.
//!
//! build.rs compiles every kernel with it and embeds the result; the program itself uses it only to reflect modules and, where
//! `PATHSPACE_SHADER_DIR` is set, to compile from disk. Sources carry no `#version`: [`PREAMBLE`] goes in front.

pub mod layout;
pub mod parameters;
pub mod reflect;
mod source;

pub use reflect::{Binding, BindingKind, Reflection};
pub use source::{Precision, Variant, find_variants, fingerprint, structure_defines};

use std::path::{Path, PathBuf};

/// In front of every kernel.
pub const PREAMBLE: &str = "#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_buffer_reference_uvec2 : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_nonuniform_qualifier : require
#extension GL_EXT_control_flow_attributes : require
";

#[derive(Debug, thiserror::Error)]
pub enum CompileError {
    #[error("shaderc cannot be initialised: {0}")]
    Unavailable(String),
    #[error("shader '{name}' does not compile:\n{message}")]
    Source { name: String, message: String },
    #[error("cannot read shader source '{}': {source}", path.display())]
    Read { path: PathBuf, source: std::io::Error },
    #[error("shader '{name}' is not what the host expects: {message}")]
    Layout { name: String, message: String },
}

/// Compiles one kernel. `name` is for messages, includes are relative to `root`, `defines` come before the source; an include of a
/// define's name includes the file that it names (glslang does not expand macros there).
pub fn compile(root: &Path, name: &str, source: &str, defines: &[(String, String)]) -> Result<Vec<u32>, CompileError> {
    let unavailable = |error: shaderc::Error| CompileError::Unavailable(error.to_string());
    let compiler = shaderc::Compiler::new().map_err(unavailable)?;
    let mut options = shaderc::CompileOptions::new().map_err(unavailable)?;
    options.set_target_env(shaderc::TargetEnv::Vulkan, shaderc::EnvVersion::Vulkan1_2 as u32);
    options.set_target_spirv(shaderc::SpirvVersion::V1_5);
    // Names are needed for reflection, and drivers optimise themselves.
    options.set_optimization_level(shaderc::OptimizationLevel::Zero);
    for (key, value) in defines {
        options.add_macro_definition(key, Some(value));
    }
    options.set_include_callback(|requested, _, _, _| {
        let named = defines.iter().find(|(key, _)| key == requested).map(|(_, value)| value.trim_matches('"'));
        let path = root.join(named.unwrap_or(requested));
        let content = std::fs::read_to_string(&path).map_err(|e| format!("cannot read '{}': {e}", path.display()))?;
        Ok(shaderc::ResolvedInclude { resolved_name: requested.to_owned(), content })
    });
    let text = format!("{PREAMBLE}{}#line 1\n{source}", ray_query_extensions(defines));
    compiler
        .compile_into_spirv(&text, shaderc::ShaderKind::Compute, name, "main", Some(&options))
        .map(|artifact| artifact.as_binary().to_vec())
        .map_err(|error| CompileError::Source { name: name.to_owned(), message: error.to_string() })
}

/// The one structure that needs a capability of the device asks for it only in its own variants.
fn ray_query_extensions(defines: &[(String, String)]) -> &'static str {
    match defines.iter().any(|(key, _)| key == "ACCEL_RAY_QUERY") {
        true => "#extension GL_EXT_ray_query : require\n",
        false => "",
    }
}

/// Compiles one variant from its file under `root`.
pub fn compile_variant(root: &Path, variant: &Variant) -> Result<Vec<u32>, CompileError> {
    let path = root.join(&variant.file);
    let source = std::fs::read_to_string(&path).map_err(|source| CompileError::Read { path, source })?;
    compile(root, &variant.name(), &source, &variant.defines())
}
