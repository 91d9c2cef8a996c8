//! Compute pipelines, laid out by reflection.

use super::descriptor::SetLayout;
use super::device::Gpu;
use super::error::{Context, GpuError};
use ash::vk;
use shader_compiler::Reflection;
use std::sync::Arc;

/// Values of specialization constants: id and 32-bit word. Ids that a kernel does not have are ignored.
pub type Specialization = [(u32, u32)];

pub struct ComputePipeline {
    gpu: Gpu,
    name: String,
    raw: vk::Pipeline,
    layout: vk::PipelineLayout,
    /// Set 0 is the one given, set 1 the kernel's own.
    set_layouts: [Arc<SetLayout>; 2],
    reflection: Reflection,
}

impl ComputePipeline {
    /// `globals` is the layout of set 0, which many kernels share; set 1 is laid out as the kernel declares it.
    ///
    /// # Errors
    /// A binding of set 0 that `globals` does not offer, or one of a set above 1; the driver's refusal.
    pub fn new(gpu: &Gpu, name: &str, spirv: &[u32], globals: &Arc<SetLayout>, constants: &Specialization) -> Result<Self, GpuError> {
        let interface = |message: String| GpuError::Interface { shader: name.to_owned(), message };
        let reflection = shader_compiler::reflect::reflect(spirv).map_err(interface)?;
        if let Some(binding) = reflection.bindings.iter().find(|b| b.set > 1 || (b.set == 0 && !globals.provides(b))) {
            return Err(interface(format!("nothing is bound to '{}' (set {}, binding {})", binding.name, binding.set, binding.binding)));
        }
        let own = SetLayout::reflected(gpu, reflection.bindings.iter().filter(|b| b.set == 1))?;
        let set_layouts = [globals.clone(), own];
        let raw_layouts = [set_layouts[0].raw(), set_layouts[1].raw()];
        let ranges = [vk::PushConstantRange { stage_flags: vk::ShaderStageFlags::COMPUTE, offset: 0, size: reflection.push_constant_size }];
        let ranges = if reflection.push_constant_size > 0 { &ranges[..] } else { &[] };
        let info = vk::PipelineLayoutCreateInfo::default().set_layouts(&raw_layouts).push_constant_ranges(ranges);
        // SAFETY: plain creation; drop destroys what exists, also where the next step fails.
        let layout = unsafe { gpu.raw().create_pipeline_layout(&info, None) }.context(&format!("lay out pipeline '{name}'"))?;
        let mut pipeline = Self { gpu: gpu.clone(), name: name.to_owned(), raw: vk::Pipeline::null(), layout, set_layouts, reflection };
        pipeline.raw = create(gpu, name, spirv, layout, constants)?;
        gpu.set_name(pipeline.raw, name);
        Ok(pipeline)
    }

    pub fn name(&self) -> &str {
        &self.name
    }

    pub fn raw(&self) -> vk::Pipeline {
        self.raw
    }

    pub fn layout(&self) -> vk::PipelineLayout {
        self.layout
    }

    pub fn reflection(&self) -> &Reflection {
        &self.reflection
    }

    /// Layout of set 1.
    pub fn own_layout(&self) -> &Arc<SetLayout> {
        &self.set_layouts[1]
    }

    /// Workgroups that cover `extent` invocations.
    pub fn groups(&self, extent: [u32; 3]) -> [u32; 3] {
        std::array::from_fn(|axis| extent[axis].div_ceil(self.reflection.local_size[axis]))
    }
}

fn create(gpu: &Gpu, name: &str, spirv: &[u32], layout: vk::PipelineLayout, constants: &Specialization) -> Result<vk::Pipeline, GpuError> {
    let what = format!("create pipeline '{name}'");
    let entry = |(index, &(id, _)): (u32, &(u32, u32))| vk::SpecializationMapEntry { constant_id: id, offset: 4 * index, size: 4 };
    let entries: Vec<_> = (0..).zip(constants).map(entry).collect();
    let values: Vec<u8> = constants.iter().flat_map(|(_, value)| value.to_ne_bytes()).collect();
    let specialization = vk::SpecializationInfo::default().map_entries(&entries).data(&values);
    // SAFETY: the module is valid SPIR-V from the compiler, and everything lives through the calls.
    unsafe {
        let module = gpu.raw().create_shader_module(&vk::ShaderModuleCreateInfo::default().code(spirv), None).context(&what)?;
        let stage = vk::PipelineShaderStageCreateInfo::default()
            .stage(vk::ShaderStageFlags::COMPUTE)
            .module(module)
            .name(c"main")
            .specialization_info(&specialization);
        let info = [vk::ComputePipelineCreateInfo::default().stage(stage).layout(layout)];
        let pipelines = gpu.raw().create_compute_pipelines(gpu.0.pipeline_cache.raw(), &info, None);
        gpu.raw().destroy_shader_module(module, None);
        pipelines.map(|pipelines| pipelines[0]).map_err(|(_, result)| result).context(&what)
    }
}

impl Drop for ComputePipeline {
    fn drop(&mut self) {
        // SAFETY: the owner has seen to it that the device no longer uses the pipeline. Null handles are ignored.
        unsafe {
            self.gpu.raw().destroy_pipeline(self.raw, None);
            self.gpu.raw().destroy_pipeline_layout(self.layout, None);
        }
    }
}
