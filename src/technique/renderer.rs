//! One scene, one technique, one device: frame after frame.

use super::PassOptions;
use super::prepared::PreparedScene;
use super::settings::{RenderError, Settings};
use super::timings::{Clock, MemoryUse, RayCounts, Recorder, Timings};
use super::work::{MOST_SHADOW_RAYS, Work};
use crate::display;
use crate::frame::{FrameBuilder, FrameGraph, Globals, GlobalsInfo, ImageHandle, Share, shares};
use crate::gpu::{DescriptorSet, FrameRing, Gpu, Image, Timer, vk};
use crate::paths::gbuffer;
use crate::scene::Scene;
use crate::shared::{self, FrameData};

/// Frames that the host may be ahead of the device.
const FRAMES_IN_FLIGHT: usize = 2;

/// Everything that rendering one scene takes. Fields are dropped in order, users before what they use.
pub struct Renderer {
    ring: FrameRing,
    timers: Vec<Timer>,
    /// Of each slot's last submission: it was the last one of its frame.
    ends: [bool; FRAMES_IN_FLIGHT],
    graph: FrameGraph,
    picture: ImageHandle,
    globals: Globals,
    prepared: PreparedScene,
    settings: Settings,
    parameters: shared::Parameters,
    recorder: Recorder,
    /// Since the start, or since the last restart.
    frame: u32,
    /// Rounds likewise: what shaders take for frames.
    round: u32,
    /// Frame of the animation that frame 0 shows.
    first_frame: u32,
    /// Per pixel of the frame to come; at least 1.
    samples: f64,
    /// `rays.first_shadow_rays` of the last round.
    previous_first_rays: u32,
    /// Samples per pixel that earlier frames have taken of the sequence.
    first_sample: u32,
    gpu: Gpu,
}

impl Renderer {
    /// Prepares the scene and compiles the technique's passes.
    ///
    /// # Errors
    /// An unknown camera, structure or output; what the device refuses.
    pub fn new(gpu: &Gpu, scene: Scene, mut settings: Settings) -> Result<Self, RenderError> {
        let technique = settings.technique;
        technique.fix(&mut settings.parameters);
        let mut prepared = PreparedScene::new(gpu, scene, &settings, FRAMES_IN_FLIGHT)?;
        let (mut clock, before) = (Clock::start(), gpu.allocated_bytes());
        let bind_structure = |slot: usize, set: &DescriptorSet| prepared.structure.bind(slot, set);
        let textures = &prepared.buffers.textures;
        let info = GlobalsInfo { textures, bind_structure: &bind_structure, frames_in_flight: FRAMES_IN_FLIGHT };
        let globals = Globals::new(gpu, &info)?;
        let constants = [prepared.effects.specialization(), settings.parameters.constants(), prepared.structure.constants()].concat();
        let mut frame = FrameBuilder::new(gpu, &globals, prepared.entry.stem, settings.parameters.precision(), constants, settings.extent);
        let options =
            PassOptions { outputs: &settings.outputs, parameters: &settings.parameters, samples: settings.spp, effects: &prepared.effects };
        let picture = (technique.passes)(&mut frame, options)?;
        let graph = frame.build();
        check_outputs(&settings, &graph)?;
        prepared.build_ms.pipelines = clock.lap();
        prepared.memory.images = gpu.allocated_bytes() - before;
        Ok(Self {
            ring: FrameRing::new(gpu, FRAMES_IN_FLIGHT)?,
            timers: (0..FRAMES_IN_FLIGHT).map(|_| Timer::new(gpu, graph.marks())).collect::<Result<_, _>>()?,
            ends: [false; FRAMES_IN_FLIGHT],
            recorder: Recorder::new(graph.pass_names()),
            parameters: settings.parameters.fields(),
            frame: 0,
            round: 0,
            first_frame: 0,
            samples: f64::from(settings.spp),
            previous_first_rays: settings.parameters.fields().first_shadow_rays,
            first_sample: 0,
            gpu: gpu.clone(),
            graph,
            picture,
            globals,
            prepared,
            settings,
        })
    }

    /// Records and submits the next frame; waits only for the submission before the last.
    ///
    /// # Errors
    /// The device is lost.
    pub fn render_frame(&mut self) -> Result<(), RenderError> {
        self.render_frame_telling(|_| {})
    }

    /// The same. A frame of many samples takes several submissions (`paths.per_submission`): `progress` is told after each of them what part of
    /// the frame has been submitted, up to 1.
    ///
    /// # Errors
    /// The device is lost.
    pub fn render_frame_telling(&mut self, mut progress: impl FnMut(f64)) -> Result<(), RenderError> {
        let mut cpu_ms = 0.0;
        let (rounds, samples) = (self.rounds(), self.samples_at_once().ceil());
        for round in 0..rounds {
            for share in shares(self.samples_at_once(), self.most_samples_at_once()) {
                let slot = self.ring.acquire()?;
                self.collect(slot);
                let mut clock = Clock::start();
                if share.begins() && (self.frame > 0 || round > 0) && self.moves() {
                    self.advance_pose()?;
                }
                self.ends[slot] = share.ends && round + 1 == rounds;
                self.submit(slot, share, round)?;
                cpu_ms += clock.lap();
                progress((f64::from(round) + f64::from(share.end) / samples) / f64::from(rounds));
            }
            self.first_sample = self.first_sample.wrapping_add(samples as u32);
            self.previous_first_rays = self.parameters.first_shadow_rays;
            self.round += 1;
        }
        self.recorder.add_cpu(cpu_ms);
        self.frame += 1;
        Ok(())
    }

    /// Of a frame.
    fn rounds(&self) -> u32 {
        if self.settings.technique.rounds { self.samples as u32 } else { 1 }
    }

    /// Per pixel of a round.
    fn samples_at_once(&self) -> f64 {
        if self.settings.technique.rounds { 1.0 } else { self.samples }
    }

    fn most_samples_at_once(&self) -> u32 {
        let [width, height] = self.settings.extent;
        (u64::from(self.parameters.paths_per_submission) / (u64::from(width) * u64::from(height))).max(1) as u32
    }

    fn submit(&mut self, slot: usize, share: Share, round: u32) -> Result<(), RenderError> {
        let PreparedScene { placed, pose, scene, .. } = &mut self.prepared;
        placed.write(slot, scene, pose);
        self.globals.write(slot, &self.frame_data(slot, share, round), &self.parameters);
        let PreparedScene { structure, pose, .. } = &mut self.prepared;
        let (instances, graph, set, timer) = (pose.instances(), &mut self.graph, self.globals.set(slot), &mut self.timers[slot]);
        Ok(self.ring.submit(slot, |commands| {
            structure.update(commands, slot, instances);
            graph.record(commands, set, timer, share);
        })?)
    }

    /// Begins anew with other random numbers, at frame `first_frame` of the animation: no frame before it has any effect on the pictures
    /// to come. Nothing is compiled or built again; the timings go on.
    ///
    /// # Errors
    /// A camera that is not there; the device is lost.
    pub fn restart(&mut self, seed: u32, first_frame: u32) -> Result<(), RenderError> {
        self.finish()?;
        self.graph.reset();
        (self.settings.seed, self.first_frame, self.frame, self.round, self.first_sample) = (seed, first_frame, 0, 0, 0);
        if !self.prepared.scene.animation.is_empty() {
            // Twice, so that nothing seems to have moved.
            self.advance_pose()?;
            self.advance_pose()?;
        }
        Ok(())
    }

    /// What frames to come do. Samples per pixel, at least 1: of a fraction, so many pixels take one more; where they go in rounds, whole ones,
    /// and no more than the settings say. Shadow rays: the wavefront sends those that the settings say.
    pub fn set_work(&mut self, work: Work) {
        let Settings { technique, spp, parameters, .. } = &self.settings;
        let most = if technique.rounds { f64::from(*spp) } else { f64::INFINITY };
        self.samples = work.samples.clamp(1.0, most);
        if parameters.number("paths.kernel") == 0.0 {
            self.parameters.first_shadow_rays = work.first_shadow_rays.clamp(1, MOST_SHADOW_RAYS);
        }
    }

    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Per pixel, of the frame to come.
    pub fn samples(&self) -> f64 {
        self.samples
    }

    /// Waits for all frames.
    pub fn finish(&mut self) -> Result<(), RenderError> {
        self.ring.wait()?;
        for slot in self.ring.oldest_first() {
            self.collect(slot);
        }
        Ok(())
    }

    /// GPU milliseconds of the last frame that is known to be done.
    pub fn last_frame_ms(&self) -> Option<f64> {
        self.recorder.last_frame_ms()
    }

    /// Frames recorded, over all restarts.
    pub fn frames_timed(&self) -> usize {
        self.recorder.frames()
    }

    /// Frames whose GPU time is known, over all restarts.
    pub fn gpu_frames(&self) -> usize {
        self.recorder.gpu_frames()
    }

    /// Frames rendered since the last restart.
    pub fn frame(&self) -> u32 {
        self.frame
    }

    /// The technique's picture after the last frame; waits for it.
    pub fn picture(&self) -> Result<display::Image, RenderError> {
        self.read_image(self.graph.image_of(self.picture))
    }

    /// What a pass put out last, by the name of its image; `None` for an unknown name. Integers come as their values.
    pub fn output(&self, name: &str) -> Result<Option<display::Image>, RenderError> {
        self.graph.image(name).map(|image| self.read_image(image)).transpose()
    }

    /// Standard error of the picture's mean over its mean, where the technique keeps a variance.
    ///
    /// # Errors
    /// The device is lost.
    pub fn relative_error(&self) -> Result<Option<f64>, RenderError> {
        let Some(variance) = self.output("variance")?.filter(|_| self.frame > 1) else { return Ok(None) };
        let sum = |image: &display::Image| image.pixels.iter().flatten().map(|&channel| f64::from(channel)).sum::<f64>();
        let mean = sum(&self.picture()?);
        Ok((mean > 0.0).then(|| sum(&variance).max(0.0).sqrt() / mean))
    }

    /// What the frames so far cost.
    ///
    /// # Errors
    /// The device is lost.
    pub fn timings(&mut self) -> Result<Timings, RenderError> {
        self.finish()?;
        let mut timings = self.recorder.report(self.gpu.capabilities(), self.prepared.entry.name, &self.graph);
        timings.build_ms = self.prepared.build_ms;
        timings.rays = self.count_rays(timings.frame_ms_median)?;
        timings.memory_bytes =
            MemoryUse { total: self.gpu.allocated_bytes(), peak: self.gpu.peak_bytes(), ..self.prepared.memory }.per_triangle();
        Ok(timings)
    }

    /// Something is at another place in the next frame. Frames that become one picture all show the first one's time.
    fn moves(&self) -> bool {
        !self.settings.technique.accumulates && !self.prepared.scene.animation.is_empty()
    }

    fn advance_pose(&mut self) -> Result<(), RenderError> {
        let time = (f64::from(self.first_frame) + f64::from(self.frame)) / f64::from(self.settings.fps);
        let PreparedScene { pose, scene, .. } = &mut self.prepared;
        Ok(pose.advance(scene, time, |world| self.settings.view.at(scene, world))?)
    }

    fn frame_data(&self, slot: usize, share: Share, round: u32) -> FrameData {
        let [camera, previous_camera] = self.prepared.pose.cameras(self.settings.extent);
        let (origin_steps, log2_origin_step) = self.prepared.pose.origin_steps();
        let mut data = FrameData {
            frame: self.round,
            round,
            camera,
            previous_camera,
            extent: self.settings.extent,
            seed: self.settings.seed,
            first_sample: self.first_sample,
            jitter: self.jitter(self.round),
            previous_jitter: self.jitter(self.round.saturating_sub(1)),
            samples: self.samples_at_once() as u32,
            more_samples: self.samples_at_once().fract() as f32,
            previous_first_rays: self.previous_first_rays,
            share_begin: share.begin,
            share_end: share.end,
            log2_origin_step,
            origin_steps,
            ..Default::default()
        };
        self.prepared.describe(slot, &mut data);
        data
    }

    /// Where in their pixels the primary rays of a frame go through, where all share one place.
    fn jitter(&self, frame: u32) -> [f32; 2] {
        if self.settings.parameters.number("frame.jitter") == 1.0 { sub_pixel(frame) } else { [0.0; 2] }
    }

    fn collect(&mut self, slot: usize) {
        self.recorder.add_gpu(self.timers[slot].take(), self.ends[slot]);
    }

    fn read_image(&self, image: &Image) -> Result<display::Image, RenderError> {
        let [width, height] = image.info().extent;
        let pixels = match image.info().format {
            vk::Format::R32_UINT => self.gpu.download_image::<u32>(image)?.into_iter().map(|v| [v as f32; 3]).collect(),
            vk::Format::R32_SFLOAT => self.gpu.download_image::<f32>(image)?.into_iter().map(|v| [v; 3]).collect(),
            vk::Format::R16G16B16A16_SFLOAT => {
                let texels: Vec<[half::f16; 4]> = self.gpu.download_image(image)?;
                texels.into_iter().map(|[r, g, b, _]| [r, g, b].map(half::f16::to_f32)).collect()
            }
            vk::Format::R32G32B32A32_UINT => {
                let texels: Vec<[u32; 4]> = self.gpu.download_image(image)?;
                texels.into_iter().map(|[x, y, z, _]| [x as f32, y as f32, z as f32]).collect()
            }
            _ => self.gpu.download_image::<[f32; 4]>(image)?.into_iter().map(|[r, g, b, _]| [r, g, b]).collect(),
        };
        Ok(display::Image::new(width, height, pixels))
    }

    /// Of the last frame.
    fn count_rays(&self, frame_ms: f64) -> Result<RayCounts, RenderError> {
        let mut counts: Vec<u32> = Vec::new();
        for image in ["ray_count", "retraced_ray_count"].into_iter().filter_map(|name| self.graph.image(name)) {
            counts.extend(self.gpu.download_image::<u32>(image)?);
        }
        let sum = |part: fn(u32) -> u32| counts.iter().map(|&count| u64::from(part(count))).sum::<u64>();
        let (scattered, shadow) = (sum(|count| count & 0xffff), sum(|count| count >> 16));
        let rays = (scattered + shadow) as f64;
        let pixels = f64::from(self.settings.extent[0]) * f64::from(self.settings.extent[1]);
        Ok(RayCounts { scattered, shadow, per_pixel: rays / pixels, mrays_per_second: rays / frame_ms * 1e-3 })
    }
}

/// Offset of a frame's primary rays from the pixel's centre, -1/2..1/2: Sobol's sequence (lib/sampler.glsl), its fractions read as signed, so
/// that it begins at the centre, the best place for one frame alone, and 2^k frames fill the pixel in as many strata.
fn sub_pixel(frame: u32) -> [f32; 2] {
    let pascal = [(1, 0x5555_5555), (2, 0x3333_3333), (4, 0x0f0f_0f0f), (8, 0x00ff_00ff), (16, 0xffff)];
    let second = pascal.into_iter().fold(frame, |x, (shift, mask)| x ^ ((x >> shift) & mask));
    [frame, second].map(|index| index.reverse_bits() as i32 as f32 / 4_294_967_296.0)
}

fn check_outputs(settings: &Settings, graph: &FrameGraph) -> Result<(), RenderError> {
    let Some(name) = settings.outputs.iter().find(|name| graph.image(name).is_none()) else { return Ok(()) };
    let extra = gbuffer::OUTPUTS.iter().chain(settings.technique.extra_outputs).copied();
    let mut known: Vec<&str> = graph.images().map(|(name, _)| name).chain(extra).collect();
    known.sort_unstable();
    known.dedup();
    Err(RenderError::UnknownOutput { technique: settings.technique.name, name: name.clone(), known: known.join(", ") })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sub_pixel_offsets_begin_at_the_centre_and_fill_the_pixel_evenly() {
        assert_eq!(sub_pixel(0), [0.0; 2]);
        let mut parts = [0; 16];
        for [x, y] in (0..160).map(sub_pixel) {
            assert!((-0.5..0.5).contains(&x) && (-0.5..0.5).contains(&y));
            parts[(4.0 * (x + 0.5)) as usize + 4 * (4.0 * (y + 0.5)) as usize] += 1;
        }
        assert_eq!(parts, [10; 16]);
    }
}
