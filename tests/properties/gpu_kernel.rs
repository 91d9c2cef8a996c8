//! The harness itself: a kernel sees its inputs, constants and the frame's data.

use crate::common::{self, KernelOptions};
use pathspace::shared::FrameData;

const SOURCE: &str = r#"
#include "shared/bindings.glsl"
struct In { vec3 a; uint b; };
struct Out { vec3 sum; uint product; };
void kernel(uint i) {
    outputs[i] = Out(inputs[i].a + 1.0, inputs[i].b * INTERSECTION + frame.seed);
}
"#;

#[test]
fn a_kernel_sees_its_inputs_constants_and_frame() {
    let gpu = common::gpu();
    let inputs: Vec<([f32; 3], u32)> = (0..1000).map(|i| ([i as f32, 2.0, 3.0], i)).collect();
    let words: Vec<[u32; 4]> = inputs.iter().map(|(a, b)| [a[0].to_bits(), a[1].to_bits(), a[2].to_bits(), *b]).collect();
    let frame = FrameData { seed: 7, ..Default::default() };
    let options = KernelOptions { constants: vec![(100, 3)], frame, ..Default::default() };
    let outputs: Vec<[u32; 4]> = common::run_kernel_with(&gpu, SOURCE, &words, &options);
    for (i, output) in outputs.iter().enumerate() {
        assert_eq!(f32::from_bits(output[0]), i as f32 + 1.0);
        assert_eq!(output[3], 3 * i as u32 + 7);
    }
}

#[test]
#[should_panic(expected = "validation layer")]
fn a_validation_message_fails_the_test() {
    let gpu = common::gpu();
    // A buffer of size 0 is invalid usage that drivers accept.
    let info = pathspace::gpu::vk::BufferCreateInfo::default().size(0).usage(pathspace::gpu::vk::BufferUsageFlags::STORAGE_BUFFER);
    // SAFETY: plain creation and destruction.
    unsafe {
        if let Ok(buffer) = gpu.raw().create_buffer(&info, None) {
            gpu.raw().destroy_buffer(buffer, None);
        }
    }
}
