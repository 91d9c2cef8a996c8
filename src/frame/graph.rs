//! Passes that declare what they read and write. Barriers, labels, GPU time per pass and a look at any pass's output follow from that.
//!
//! A frame is declared once and recorded often: pipelines, descriptor sets and barriers are settled when it is built, so that a
//! frame costs the host a few calls per pass and no memory.

use super::globals::Globals;
use super::pass::{Access, Groups, Hazards, Pass, PassBuilder, Traffic, Use, Work, label};
use super::resources::{BufferHandle, History, ImageHandle, Parity, Resources};
use super::share::Share;
use crate::gpu::{Commands, ComputePipeline, DescriptorSet, Gpu, GpuError, Image, ImageInfo, SetLayout, Timer, load_shader, vk};
use shader_compiler::Precision;
use std::ops::Range;
use std::sync::Arc;

/// Declares images, buffers and passes, in the order of the frame.
pub struct FrameBuilder<'a> {
    pub(super) gpu: &'a Gpu,
    pub(super) globals: Arc<SetLayout>,
    pub(super) structure: &'a str,
    pub(super) precision: Precision,
    constants: Vec<(u32, u32)>,
    pub(super) extent: [u32; 2],
    pub(super) resources: Resources,
    passes: Vec<Pass>,
    sampling: Range<usize>,
    hazards: Hazards,
    pipelines: Vec<SharedPipeline>,
}

/// Passes that differ neither in kernel nor in specialization share one.
struct SharedPipeline {
    shader: &'static str,
    constants: Vec<(u32, u32)>,
    pipeline: Arc<ComputePipeline>,
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
            resources: Resources::default(),
            passes: Vec::new(),
            sampling: 0..0,
            hazards: Hazards::default(),
            pipelines: Vec::new(),
        }
    }

    pub fn gpu(&self) -> &Gpu {
        self.gpu
    }

    /// Of the picture, pixels.
    pub fn extent(&self) -> [u32; 2] {
        self.extent
    }

    /// Of the picture.
    pub fn pixels(&self) -> u32 {
        self.extent[0] * self.extent[1]
    }

    /// An image of the picture's size, zero at first. Its name is that of its AOV.
    pub fn image(&mut self, name: &'static str, format: vk::Format) -> Result<ImageHandle, GpuError> {
        self.resources.image(self.gpu, name, ImageInfo::storage(format, self.extent))
    }

    /// An image of the picture's size and that of the frame before. Its name is that of its AOV, which shows the current one.
    pub fn image_history(&mut self, name: &'static str, format: vk::Format) -> Result<History<ImageHandle>, GpuError> {
        self.resources.image_history(self.gpu, name, ImageInfo::storage(format, self.extent))
    }

    /// A storage buffer of `size` bytes; what it holds when a frame begins is undefined.
    ///
    /// # Errors
    /// More bytes than a kernel of this device can see of one buffer.
    pub fn buffer(&mut self, name: &str, size: u64) -> Result<BufferHandle, GpuError> {
        self.resources.buffer(self.gpu, name, size)
    }

    /// A storage buffer that passes update in place from frame to frame. Zero after a restart.
    ///
    /// # Errors
    /// As [`Self::buffer`].
    pub fn kept_buffer(&mut self, name: &str, size: u64) -> Result<BufferHandle, GpuError> {
        self.resources.kept_buffer(self.gpu, name, size)
    }

    /// A storage buffer of `size` bytes and that of the frame before.
    ///
    /// # Errors
    /// As [`Self::buffer`].
    pub fn buffer_history(&mut self, name: &str, size: u64) -> Result<History<BufferHandle>, GpuError> {
        self.resources.buffer_history(self.gpu, name, size)
    }

    /// An image of radiance, or of anything else that the frame's precision is enough for, declared `COLOR_FORMAT` in shaders. What a
    /// kernel stores there must go through lib/storage.glsl.
    pub fn color_image(&mut self, name: &'static str) -> Result<ImageHandle, GpuError> {
        self.image(name, self.color_format())
    }

    /// A colour image and that of the frame before. Its name is that of its AOV, which shows the current one.
    pub fn color_history(&mut self, name: &'static str) -> Result<History<ImageHandle>, GpuError> {
        self.image_history(name, self.color_format())
    }

    /// Of colour images and of filters' cells.
    pub fn precision(&self) -> Precision {
        self.precision
    }

    fn color_format(&self) -> vk::Format {
        match self.precision {
            Precision::Fp32 => vk::Format::R32G32B32A32_SFLOAT,
            Precision::Fp16 => vk::Format::R16G16B16A16_SFLOAT,
        }
    }

    /// The next pass: a kernel by its stem below shaders_glsl/, over every pixel.
    pub fn pass(&mut self, name: &'static str, shader: &'static str) -> PassBuilder<'_, 'a> {
        let constants = self.constants.clone();
        PassBuilder::new(self, name, shader, constants)
    }

    /// The next pass writes a word all over a buffer.
    pub fn fill(&mut self, name: &'static str, buffer: BufferHandle, word: u32) {
        let resource = buffer.into();
        let bytes = self.resources.byte_size(resource);
        let uses = [Use { variable: "", resource, access: Access::Write, bytes }];
        self.push(name, Work::Fill { buffer, word }, Traffic::of(&uses), &uses);
    }

    /// The place of the next pass, for [`Self::repeat_per_sample`] and [`Self::share_samples`].
    pub fn next_pass(&self) -> usize {
        self.passes.len()
    }

    /// The next pass is all passes from `first` on once more for each further sample per pixel that a frame takes.
    pub fn repeat_per_sample(&mut self, name: &'static str, first: usize) {
        self.passes.push(Pass { name, label: label(name), work: Work::Repeat { first }, barrier: false, traffic: Traffic::default() });
        self.share_samples(first);
    }

    /// The passes from `first` up to here take the frame's samples. Where a frame is submitted in shares of them ([`Share`]), each has these
    /// passes; those in front come with the first share, those behind with the last.
    pub fn share_samples(&mut self, first: usize) {
        self.sampling = first..self.passes.len();
    }

    pub(super) fn pipeline(&mut self, shader: &'static str, constants: &[(u32, u32)]) -> Result<Arc<ComputePipeline>, GpuError> {
        if let Some(known) = self.pipelines.iter().find(|known| known.shader == shader && known.constants == constants) {
            return Ok(known.pipeline.clone());
        }
        let spirv = load_shader(shader, self.structure, self.precision)?;
        let pipeline = Arc::new(ComputePipeline::new(self.gpu, shader, &spirv, &self.globals, constants)?);
        self.pipelines.push(SharedPipeline { shader, constants: constants.to_vec(), pipeline: pipeline.clone() });
        Ok(pipeline)
    }

    pub(super) fn push(&mut self, name: &'static str, work: Work, traffic: Traffic, uses: &[Use]) {
        let barrier = self.hazards.needs_barrier(uses);
        self.passes.push(Pass { name, label: label(name), work, barrier, traffic });
    }

    pub fn build(self) -> FrameGraph {
        let indirect = |pass: &Pass| matches!(pass.work, Work::Dispatch { groups: Groups::Indirect(..), .. });
        let reads = if self.passes.iter().any(indirect) { vk::PipelineStageFlags::DRAW_INDIRECT } else { vk::PipelineStageFlags::empty() };
        let Self { resources, passes, sampling, .. } = self;
        FrameGraph { resources, passes, sampling, waiting: STAGES | reads, parity: 0, reset: true }
    }
}

/// A frame that is ready to be recorded.
pub struct FrameGraph {
    resources: Resources,
    passes: Vec<Pass>,
    /// Those that every share of a frame has.
    sampling: Range<usize>,
    /// What waits at a barrier: sizes of dispatches, too, where passes take them from buffers.
    waiting: vk::PipelineStageFlags,
    /// Of the frame recorded last.
    parity: Parity,
    /// What is kept is made zero before the next frame.
    reset: bool,
}

/// Where passes do their work.
const STAGES: vk::PipelineStageFlags =
    vk::PipelineStageFlags::from_raw(vk::PipelineStageFlags::COMPUTE_SHADER.as_raw() | vk::PipelineStageFlags::TRANSFER.as_raw());

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

    /// Everything that a pass put out in the frame recorded last, by name.
    pub fn images(&self) -> impl Iterator<Item = (&'static str, &Image)> {
        self.resources.named().map(|(name, handle)| (name, self.image_of(handle)))
    }

    pub fn image_of(&self, handle: ImageHandle) -> &Image {
        self.resources.image_of(handle, self.parity)
    }

    pub fn image(&self, name: &str) -> Option<&Image> {
        self.images().find(|(n, _)| *n == name).map(|(_, image)| image)
    }

    /// The next frame sees nothing of those before it.
    pub fn reset(&mut self) {
        self.reset = true;
    }

    /// The share's passes in order; the first waits for whatever was recorded or submitted before, builds of acceleration structures included.
    pub fn record(&mut self, commands: &Commands, globals: &DescriptorSet, timer: &mut Timer, share: Share) {
        if share.begins() {
            self.parity ^= 1;
        }
        timer.reset(commands);
        commands.barrier(vk::PipelineStageFlags::ALL_COMMANDS, self.waiting);
        if std::mem::take(&mut self.reset) && self.resources.keeps_anything() {
            self.resources.reset(commands);
            commands.barrier(vk::PipelineStageFlags::TRANSFER, self.waiting);
        }
        timer.mark(commands, 0);
        for (index, pass) in self.passes.iter().enumerate() {
            match &pass.work {
                _ if !self.belongs_to(share, index) => {}
                Work::Repeat { first } => self.record_again(commands, globals, &self.passes[*first..index], share.samples()),
                _ => self.record_pass(commands, globals, pass),
            }
            timer.mark(commands, index as u32 + 1);
        }
    }

    fn belongs_to(&self, share: Share, pass: usize) -> bool {
        self.sampling.contains(&pass) || if pass < self.sampling.start { share.begins() } else { share.ends }
    }

    fn record_again(&self, commands: &Commands, globals: &DescriptorSet, passes: &[Pass], samples: u32) {
        for _ in 1..samples {
            // The first of them may write what the last ones have read.
            commands.barrier(STAGES, self.waiting);
            passes.iter().for_each(|pass| self.record_pass(commands, globals, pass));
        }
    }

    fn record_pass(&self, commands: &Commands, globals: &DescriptorSet, pass: &Pass) {
        commands.begin_label(&pass.label);
        if pass.barrier {
            commands.barrier(STAGES, self.waiting);
        }
        match &pass.work {
            Work::Dispatch { pipeline, sets, argument, groups } => {
                let (sets, words) = ([globals, &sets[self.parity % sets.len()]], bytemuck::bytes_of(argument));
                let push_constants = &words[..pipeline.reflection().push_constant_size as usize];
                match *groups {
                    Groups::Fixed(groups) => commands.dispatch(pipeline, &sets, push_constants, groups),
                    Groups::Indirect(buffer, offset) => {
                        let groups = (self.resources.buffer_of(buffer, self.parity), offset);
                        commands.dispatch_indirect(pipeline, &sets, push_constants, groups);
                    }
                }
            }
            Work::Fill { buffer, word } => commands.fill_buffer(self.resources.buffer_of(*buffer, self.parity), *word),
            Work::Repeat { .. } => {}
        }
        commands.end_label();
    }
}
