//! Runs a function of shaders_glsl on the GPU, one thread per input, so that it can be held against an oracle in Rust.

use bytemuck::Pod;
use pathspace::frame::{Globals, GlobalsInfo};
use pathspace::gpu::{ComputePipeline, DescriptorSet, Gpu, MemoryLocation, vk};
use pathspace::shared::{FrameData, Parameters};
use std::path::Path;

/// What a kernel may need beside its inputs.
#[derive(Default)]
pub struct KernelOptions<'a> {
    pub defines: Vec<(String, String)>,
    /// Specialization constants: id and word.
    pub constants: Vec<(u32, u32)>,
    pub frame: FrameData,
    pub parameters: Parameters,
    /// For kernels that trace by ray query.
    /// Writes an acceleration structure's descriptors into set 0.
    pub bind_structure: Option<&'a dyn Fn(&DescriptorSet)>,
}

const HEADER: &str = "
layout(local_size_x = 64) in;
layout(buffer_reference, scalar) readonly buffer KernelInputs { In at[]; };
layout(buffer_reference, scalar) writeonly buffer KernelOutputs { Out at[]; };
layout(push_constant, scalar) uniform KernelPush { KernelInputs in_buffer; KernelOutputs out_buffer; uint count; } push;
#define inputs push.in_buffer.at
#define outputs push.out_buffer.at
";

const MAIN: &str = "
void main() {
    if (gl_GlobalInvocationID.x < push.count) {
        kernel(gl_GlobalInvocationID.x);
    }
}
";

/// `source` includes what it tests, then defines `struct In`, `struct Out` (scalar layout, as the Rust types) and
/// `void kernel(uint i)`, which reads `inputs[i]` and writes `outputs[i]`.
pub fn run_kernel<I: Pod, O: Pod>(gpu: &Gpu, source: &str, inputs: &[I]) -> Vec<O> {
    run_kernel_with(gpu, source, inputs, &KernelOptions::default())
}

pub fn run_kernel_with<I: Pod, O: Pod>(gpu: &Gpu, source: &str, inputs: &[I], options: &KernelOptions<'_>) -> Vec<O> {
    let (head, body) = source.split_once("void kernel(").expect("the source defines `void kernel(uint i)`");
    // Helper functions between the structs and the kernel may use `inputs`, so the header goes right after the last struct.
    let structs_end = head.rfind("};").map_or(head.len(), |at| at + 2);
    let text = format!("{}{HEADER}{}void kernel({body}{MAIN}", &head[..structs_end], &head[structs_end..]);
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders_glsl");
    let spirv = shader_compiler::compile(&root, "test kernel", &text, &options.defines).unwrap_or_else(|error| panic!("{error}\n{text}"));
    let bind = |_: usize, set: &DescriptorSet| options.bind_structure.iter().for_each(|bind| bind(set));
    let mut globals = Globals::new(gpu, &GlobalsInfo { textures: &[], bind_structure: &bind, frames_in_flight: 1 }).unwrap();
    globals.write(0, &options.frame, &options.parameters);
    let pipeline = ComputePipeline::new(gpu, "test kernel", &spirv, globals.layout(), &options.constants).unwrap();
    let own = DescriptorSet::new(pipeline.own_layout()).unwrap();

    let in_buffer = gpu.upload("kernel inputs", inputs, vk::BufferUsageFlags::empty()).unwrap();
    let out_size = (size_of::<O>() * inputs.len()) as u64;
    let out_buffer = gpu.create_buffer("kernel outputs", out_size, vk::BufferUsageFlags::empty(), MemoryLocation::GpuOnly).unwrap();
    let count = inputs.len() as u32;
    let mut push = Vec::new();
    push.extend_from_slice(&in_buffer.address().to_ne_bytes());
    push.extend_from_slice(&out_buffer.address().to_ne_bytes());
    push.extend_from_slice(&count.to_ne_bytes());
    gpu.submit_once(|commands| commands.dispatch(&pipeline, &[globals.set(0), &own], &push, pipeline.groups([count, 1, 1]))).unwrap();
    gpu.download(&out_buffer).unwrap()
}
