//! What GPU tests share: a device with validation on, and kernels around functions of shaders_glsl/lib.
//!
//! Each test binary uses its own part of this.
#![allow(dead_code, unused_imports)]

pub mod floor;
pub mod kernel;
pub mod rays;
pub mod render;

pub use kernel::{KernelOptions, run_kernel, run_kernel_with};

use pathspace::gpu::{DeviceOptions, Gpu};
use std::ops::Deref;

/// A device with core and synchronization validation; any message fails the test that holds it when it is dropped.
pub struct TestGpu(Gpu);

/// The best device of this machine; `ray_query` false hides its ray query.
pub fn gpu_with(ray_query: bool) -> TestGpu {
    let options = DeviceOptions { validation: true, ray_query, ..Default::default() };
    TestGpu(Gpu::open(&options).expect("tests need a Vulkan device and the validation layer: run ci/setup"))
}

pub fn gpu() -> TestGpu {
    gpu_with(true)
}

impl Deref for TestGpu {
    type Target = Gpu;

    fn deref(&self) -> &Gpu {
        &self.0
    }
}

impl Drop for TestGpu {
    fn drop(&mut self) {
        let messages = self.0.validation_messages();
        if !messages.is_empty() && !std::thread::panicking() {
            panic!("the validation layer has {} messages:\n{}", messages.len(), messages.join("\n"));
        }
    }
}
