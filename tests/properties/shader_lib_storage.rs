//! lib/storage.glsl: what images in half precision can keep.

use crate::common::{self, KernelOptions, run_kernel_with};
use half::f16;
use pathspace::technique::Parameters;

const SOURCE: &str = r#"
#include "lib/storage.glsl"
struct In { float value; };
struct Out { float stored; float storable; };
void kernel(uint i) {
    outputs[i].stored = stored(vec3(inputs[i].value)).x;
    outputs[i].storable = storable(vec4(inputs[i].value)).x;
}
"#;

/// Both signs of every magnitude that halves have, between them and at their ends.
fn values() -> Vec<f32> {
    let halves = (0..0x7c00u16).step_by(7).map(|bits| f16::from_bits(bits).to_f32());
    let around = |half: f32| [half, half * 1.0001, half * (1.0 + 1.0 / 2048.0), half * 1.0008, half + 3e-8];
    let magnitudes = halves.flat_map(around).chain([65504.0, 65519.0, 65520.0, 1e6, 3e38]);
    magnitudes.flat_map(|value| [value, -value]).collect()
}

#[test]
fn what_is_stored_in_half_precision_is_the_nearest_half_and_finite() {
    let gpu = common::gpu();
    let values = values();
    let mut parameters = Parameters::default();
    parameters.set("frame.precision", "fp16").unwrap();
    let half = KernelOptions { constants: parameters.constants(), ..Default::default() };
    let found: Vec<[f32; 2]> = run_kernel_with(&gpu, SOURCE, &values, &half);
    for (value, [stored, storable]) in values.iter().zip(found) {
        let nearest = f16::from_f32(value.clamp(-65504.0, 65504.0)).to_f32();
        assert_eq!(stored, nearest, "{value}");
        assert!(f16::from_f32(storable).is_finite(), "{value}");
    }
    let found: Vec<[f32; 2]> = run_kernel_with(&gpu, SOURCE, &values, &KernelOptions::default());
    assert!(values.iter().zip(found).all(|(value, found)| found == [*value; 2]));
}
