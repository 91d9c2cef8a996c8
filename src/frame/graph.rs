//! Passes that declare what they read and write. Barriers, labels, GPU time per pass and a look at any pass's output follow from that.
//!
//! A frame is declared once and recorded often: pipelines, descriptor sets and barriers are settled when it is built, so that a
//! frame costs the host a few calls per pass and no memory.

use super::globals::Globals;
use crate::gpu::{Commands, ComputePipeline, DescriptorSet, Gpu, GpuError, Image, ImageInfo, SetLayout, Timer, load_shader, vk};
use shader_compiler::{Binding, BindingKind, Precision};
use std::collections::HashSet;
use std::ffi::CString;
use std::sync::Arc;

/// An image of the frame under construction.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct ImageHandle(usize);

/// Declares images and passes, in the order of the frame.
pub struct FrameBuilder<'a> {
    gpu: &'a Gpu,
    globals: Arc<SetLayout>,
    structure: &'a str,
    precision: Precision,
    constants: Vec<(u32, u32)>,
    extent: [u32; 2],
    images: Vec<(&'static str, Image)>,
    passes: Vec<Pass>,
    /// What has been touched since the last barrier.
    read: HashSet<ImageHandle>,
    written: HashSet<ImageHandle>,
}

struct Pass {
    name: &'static str,
    label: CString,
    pipeline: ComputePipeline,
    set: DescriptorSet,
    /// Workgroups.
    groups: [u32; 3],
    barrier: bool,
    traffic: Traffic,
}

/// Bytes that a pass moves by its declaration: each value of each image once.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Traffic {
    pub read: u64,
    pub written: u64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Access {
    Read,
    Write,
    Update,
}

impl<'a> FrameBuilder<'a> {
    /// `structure`: stem of the acceleration structure that rays are traced in; `precision`: of colour images;
    /// `constants`: specialization of every pass; `extent`: of the picture, pixels.
    pub fn new(
        gpu: &'a Gpu,
        globals: &Globals,
        structure: &'a str,
        precision: Precision,
        constants: Vec<(u32, u32)>,
        extent: [u32; 2],
    ) -> Self {
        Self {
            gpu,
            globals: globals.layout().clone(),
            structure,
            precision,
            constants,
            extent,
            images: Vec::new(),
            passes: Vec::new(),
            read: HashSet::new(),
            written: HashSet::new(),
        }
    }

    pub fn gpu(&self) -> &Gpu {
        self.gpu
    }

    /// Of the picture, pixels.
    pub fn extent(&self) -> [u32; 2] {
        self.extent
    }

    /// An image of the picture's size, zero at first. Its name is that of its AOV.
    pub fn image(&mut self, name: &'static str, format: vk::Format) -> Result<ImageHandle, GpuError> {
        self.images.push((name, self.gpu.create_image(name, ImageInfo::storage(format, self.extent))?));
        Ok(ImageHandle(self.images.len() - 1))
    }

    /// An image of radiance, or of anything else that the frame's precision is enough for, declared `COLOR_FORMAT` in shaders. What a
    /// kernel stores there must go through lib/storage.glsl.
    pub fn color_image(&mut self, name: &'static str) -> Result<ImageHandle, GpuError> {
        let format = match self.precision {
            Precision::Fp32 => vk::Format::R32G32B32A32_SFLOAT,
            Precision::Fp16 => vk::Format::R16G16B16A16_SFLOAT,
        };
        self.image(name, format)
    }

    /// The next pass: a kernel by its stem below shaders_glsl/, over every pixel.
    pub fn pass(&mut self, name: &'static str, shader: &'static str) -> PassBuilder<'_, 'a> {
        PassBuilder { name, shader, uses: Vec::new(), constants: self.constants.clone(), groups: None, frame: self }
    }

    pub fn build(self) -> FrameGraph {
        FrameGraph { images: self.images, passes: self.passes }
    }

    fn traffic(&self, uses: &[(&str, ImageHandle, Access)]) -> Traffic {
        uses.iter().fold(Traffic::default(), |sum, &(_, image, access)| {
            let bytes = self.images[image.0].1.byte_size();
            let counted = |counts: bool| if counts { bytes } else { 0 };
            Traffic { read: sum.read + counted(access != Access::Write), written: sum.written + counted(access != Access::Read) }
        })
    }

    /// Whether a pass with these uses must wait for the ones before it.
    fn needs_barrier(&mut self, uses: &[(&str, ImageHandle, Access)]) -> bool {
        let conflicts = |&(_, image, access): &(&str, ImageHandle, Access)| {
            self.written.contains(&image) || (access != Access::Read && self.read.contains(&image))
        };
        let barrier = uses.iter().any(conflicts);
        if barrier {
            self.read.clear();
            self.written.clear();
        }
        for &(_, image, access) in uses {
            if access == Access::Read {
                self.read.insert(image)
            } else {
                self.written.insert(image)
            };
        }
        barrier
    }
}

/// One pass under construction; each use names the shader's variable.
pub struct PassBuilder<'b, 'a> {
    frame: &'b mut FrameBuilder<'a>,
    name: &'static str,
    shader: &'static str,
    uses: Vec<(&'static str, ImageHandle, Access)>,
    constants: Vec<(u32, u32)>,
    groups: Option<u32>,
}

impl PassBuilder<'_, '_> {
    pub fn reads(mut self, variable: &'static str, image: ImageHandle) -> Self {
        self.uses.push((variable, image, Access::Read));
        self
    }

    pub fn writes(mut self, variable: &'static str, image: ImageHandle) -> Self {
        self.uses.push((variable, image, Access::Write));
        self
    }

    /// Reads and writes each pixel's own value.
    pub fn updates(mut self, variable: &'static str, image: ImageHandle) -> Self {
        self.uses.push((variable, image, Access::Update));
        self
    }

    /// A specialization constant of this pass's own.
    pub fn constant(mut self, id: u32, value: u32) -> Self {
        self.constants.push((id, value));
        self
    }

    /// So many workgroups instead of one invocation per pixel.
    pub fn groups(mut self, count: u32) -> Self {
        self.groups = Some(count);
        self
    }

    /// # Errors
    /// The declaration differs from the shader's: a variable without an image, an image without a variable, other access or format.
    pub fn add(self) -> Result<(), GpuError> {
        let frame = self.frame;
        let spirv = load_shader(self.shader, frame.structure, frame.precision)?;
        let pipeline = ComputePipeline::new(frame.gpu, self.name, &spirv, &frame.globals, &self.constants)?;
        let set = DescriptorSet::new(pipeline.own_layout())?;
        let bindings: Vec<&Binding> = pipeline.reflection().bindings.iter().filter(|b| b.set == 1).collect();
        check(&bindings, &self.uses).map_err(|message| GpuError::Interface { shader: self.shader.to_owned(), message })?;
        for binding in bindings {
            let (_, handle, _) = self.uses.iter().find(|(variable, ..)| *variable == binding.name).expect("checked");
            let image = &frame.images[handle.0].1;
            check_format(binding, image).map_err(|message| GpuError::Interface { shader: self.shader.to_owned(), message })?;
            set.write_storage_image(binding.binding, image);
        }
        let barrier = frame.needs_barrier(&self.uses);
        let label = CString::new(self.name).expect("pass names have no zeros");
        let [width, height] = frame.extent;
        let groups = self.groups.map_or_else(|| pipeline.groups([width, height, 1]), |count| [count, 1, 1]);
        let traffic = frame.traffic(&self.uses);
        frame.passes.push(Pass { name: self.name, label, pipeline, set, groups, barrier, traffic });
        Ok(())
    }
}

/// The shader's variables against what the pass declares.
fn check(bindings: &[&Binding], uses: &[(&'static str, ImageHandle, Access)]) -> Result<(), String> {
    for binding in bindings {
        let Some((.., access)) = uses.iter().find(|(variable, ..)| *variable == binding.name) else {
            return Err(format!("the pass declares nothing for '{}'", binding.name));
        };
        let declared = (*access != Access::Write, *access != Access::Read);
        if binding.kind != BindingKind::StorageImage || (binding.readable, binding.writable) != declared {
            return Err(format!("'{}' is declared for another use: {access:?}", binding.name));
        }
    }
    match uses.iter().find(|(variable, ..)| !bindings.iter().any(|b| b.name == *variable)) {
        Some((variable, ..)) => Err(format!("it has no '{variable}'")),
        None => Ok(()),
    }
}

fn check_format(binding: &Binding, image: &Image) -> Result<(), String> {
    match image.format_qualifier() {
        qualifier if qualifier == binding.format => Ok(()),
        qualifier => Err(format!("'{}' is declared {}, its image is {qualifier}", binding.name, binding.format)),
    }
}

/// A frame that is ready to be recorded.
pub struct FrameGraph {
    images: Vec<(&'static str, Image)>,
    passes: Vec<Pass>,
}

impl FrameGraph {
    pub fn pass_names(&self) -> impl Iterator<Item = &'static str> {
        self.passes.iter().map(|pass| pass.name)
    }

    /// Of each pass.
    pub fn traffic(&self) -> impl Iterator<Item = Traffic> {
        self.passes.iter().map(|pass| pass.traffic)
    }

    /// Marks that [`Self::record`] makes on a timer.
    pub fn marks(&self) -> u32 {
        self.passes.len() as u32 + 1
    }

    /// Everything that a pass puts out, by name.
    pub fn images(&self) -> impl Iterator<Item = (&'static str, &Image)> {
        self.images.iter().map(|(name, image)| (*name, image))
    }

    pub fn image_of(&self, handle: ImageHandle) -> &Image {
        &self.images[handle.0].1
    }

    pub fn image(&self, name: &str) -> Option<&Image> {
        self.images().find(|(n, _)| *n == name).map(|(_, image)| image)
    }

    /// All passes in order; the first waits for whatever was recorded or submitted before, builds of acceleration structures included.
    pub fn record(&self, commands: &Commands, globals: &DescriptorSet, timer: &mut Timer) {
        let compute = vk::PipelineStageFlags::COMPUTE_SHADER;
        timer.reset(commands);
        commands.barrier(vk::PipelineStageFlags::ALL_COMMANDS, compute);
        timer.mark(commands, 0);
        for (index, pass) in (1..).zip(&self.passes) {
            commands.begin_label(&pass.label);
            if pass.barrier {
                commands.barrier(compute, compute);
            }
            commands.dispatch(&pass.pipeline, &[globals, &pass.set], &[], pass.groups);
            commands.end_label();
            timer.mark(commands, index);
        }
    }
}
