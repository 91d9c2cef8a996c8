//! Debian's libshaderc leaves glslang's and SPIRV-Tools' symbols to separate archives. Where they are present they are
//! linked whole, since a static archive named before its user would otherwise be skipped by the linker; elsewhere
//! shaderc-sys builds its own copy from source, which needs nothing from here.
use std::path::Path;

const ARCHIVES: [&str; 8] =
    ["glslang", "MachineIndependent", "GenericCodeGen", "OGLCompiler", "OSDependent", "SPIRV", "SPIRV-Tools-opt", "SPIRV-Tools"];

fn main() {
    println!("cargo:rerun-if-env-changed=SHADERC_LIB_DIR");
    let Some(dir) = std::env::var_os("SHADERC_LIB_DIR") else { return };
    let dir = Path::new(&dir);
    if !dir.join("libshaderc.a").exists() && !dir.join("libshaderc_combined.a").exists() {
        return;
    }
    println!("cargo:rustc-link-search=native={}", dir.display());
    for archive in ARCHIVES {
        if dir.join(format!("lib{archive}.a")).exists() {
            println!("cargo:rustc-link-lib=static:-bundle,+whole-archive={archive}");
        }
    }
    println!("cargo:rustc-link-lib=dylib=stdc++");
}
