//! What the frames cost: medians over the frames after the first, which compiles and warms up.

use crate::frame::{FrameGraph, Traffic};
use crate::gpu::Capabilities;
use crate::metrics::statistics::quantile;
use serde::Serialize;
use std::time::Instant;

/// Room that is made at the beginning, so that frames allocate nothing: 18 minutes at 60 Hz, 512 KiB per pass, of which only what is
/// written takes memory.
const FRAMES_WITHOUT_ALLOCATION: usize = 1 << 16;

/// Gathers figures frame by frame.
#[derive(Debug, Default)]
pub struct Recorder {
    /// Of passes, each once.
    names: Vec<&'static str>,
    /// Of each pass, that of its name.
    places: Vec<usize>,
    /// Milliseconds of each name's passes, one vector per name.
    passes: Vec<Vec<f64>>,
    frames: Vec<f64>,
    cpu: Vec<f64>,
    /// Of the frame of which not all submissions are known yet: each name's, zero before the first one.
    partial: Vec<f64>,
}

/// `--timings`. Times are milliseconds.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Timings {
    pub version: u32,
    pub device: String,
    pub driver: String,
    /// Acceleration structure.
    pub trace: String,
    /// Frames that the medians are taken over.
    pub frames: usize,
    pub frame_ms_median: f64,
    pub passes: Vec<PassTime>,
    /// Recording and submitting one frame, without waiting.
    pub cpu_ms_median: f64,
    /// Of each frame.
    #[serde(skip)]
    pub frame_ms: Vec<f64>,
    /// GPU time of the first frame, where drivers may compile.
    pub first_frame_ms: f64,
    pub build_ms: BuildTimes,
    pub rays: RayCounts,
    pub memory_bytes: MemoryUse,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PassTime {
    pub name: &'static str,
    pub median_ms: f64,
    pub p95_ms: f64,
    /// Of images and buffers, as the pass declares them; scene, textures and acceleration structure not counted.
    pub bytes_read: u64,
    pub bytes_written: u64,
    pub traces_rays: bool,
    /// Of each frame.
    #[serde(skip)]
    pub samples_ms: Vec<f64>,
}

/// What came before the first frame.
#[derive(Debug, Clone, Copy, Default, Serialize)]
pub struct BuildTimes {
    /// Spatial order: the trees of all meshes.
    pub order: f64,
    pub upload: f64,
    pub structure: f64,
    pub pipelines: f64,
}

/// Of one frame.
#[derive(Debug, Clone, Copy, Default, Serialize)]
pub struct RayCounts {
    /// Primary rays among them.
    pub scattered: u64,
    pub shadow: u64,
    pub per_pixel: f64,
    pub mrays_per_second: f64,
}

#[derive(Debug, Clone, Copy, Default, Serialize)]
pub struct MemoryUse {
    /// Vertices, triangles, materials, instances, lights.
    pub scene: u64,
    pub textures: u64,
    pub structure: u64,
    pub images: u64,
    pub total: u64,
    /// The most at any time since the scene was prepared, staging included.
    pub peak: u64,
    pub triangles: u64,
    /// Scene and structure, without textures.
    pub per_triangle: f64,
}

impl MemoryUse {
    pub(super) fn per_triangle(self) -> Self {
        Self { per_triangle: (self.scene + self.structure) as f64 / self.triangles.max(1) as f64, ..self }
    }
}

impl Recorder {
    /// Passes of one name are one figure.
    pub fn new(passes: impl Iterator<Item = &'static str>) -> Self {
        let mut names = Vec::new();
        let place = |name| {
            let known = names.iter().position(|&known| known == name);
            known.unwrap_or_else(|| {
                names.push(name);
                names.len() - 1
            })
        };
        let places = passes.map(place).collect();
        let room = || Vec::with_capacity(FRAMES_WITHOUT_ALLOCATION);
        let (passes, partial) = (names.iter().map(|_| room()).collect(), vec![0.0; names.len()]);
        Self { passes, partial, names, places, frames: room(), cpu: room() }
    }

    /// GPU times of one submission, one per pass, or none where the device has no timestamps; `ends`: it was its frame's last.
    pub fn add_gpu(&mut self, milliseconds: impl Iterator<Item = f64>, ends: bool) {
        let mut any = false;
        for (&place, ms) in self.places.iter().zip(milliseconds) {
            self.partial[place] += ms;
            any = true;
        }
        if any && ends {
            self.frames.push(self.partial.iter().sum());
            self.passes.iter_mut().zip(&mut self.partial).for_each(|(pass, ms)| pass.push(std::mem::take(ms)));
        }
    }

    pub fn last_frame_ms(&self) -> Option<f64> {
        self.frames.last().copied()
    }

    pub fn frames(&self) -> usize {
        self.cpu.len()
    }

    pub fn gpu_frames(&self) -> usize {
        self.frames.len()
    }

    pub fn add_cpu(&mut self, milliseconds: f64) {
        self.cpu.push(milliseconds);
    }

    /// The report; rays and memory are filled in by the renderer.
    pub fn report(&self, capabilities: &Capabilities, trace: &str, graph: &FrameGraph) -> Timings {
        let mut traffic = vec![Traffic::default(); self.names.len()];
        for (&place, of_pass) in self.places.iter().zip(graph.traffic()) {
            traffic[place] += of_pass;
        }
        let pass = |((name, times), traffic): ((&&'static str, &Vec<f64>), Traffic)| PassTime {
            name,
            median_ms: quantile(warm(times), 0.5),
            p95_ms: quantile(warm(times), 0.95),
            bytes_read: traffic.read,
            bytes_written: traffic.written,
            traces_rays: traffic.traces,
            samples_ms: warm(times),
        };
        Timings {
            version: 1,
            device: capabilities.name.clone(),
            driver: capabilities.driver.clone(),
            trace: trace.to_owned(),
            frames: warm(&self.frames).len(),
            frame_ms_median: quantile(warm(&self.frames), 0.5),
            frame_ms: warm(&self.frames),
            passes: self.names.iter().zip(&self.passes).zip(traffic).map(pass).collect(),
            cpu_ms_median: quantile(warm(&self.cpu), 0.5),
            first_frame_ms: self.frames.first().copied().unwrap_or(f64::NAN),
            build_ms: BuildTimes::default(),
            rays: RayCounts::default(),
            memory_bytes: MemoryUse::default(),
        }
    }
}

/// Milliseconds between laps.
pub(super) struct Clock(Instant);

impl Clock {
    pub fn start() -> Self {
        Self(Instant::now())
    }

    pub fn lap(&mut self) -> f64 {
        let before = std::mem::replace(&mut self.0, Instant::now());
        (self.0 - before).as_secs_f64() * 1e3
    }
}

/// A table of milliseconds per pass, for people.
impl std::fmt::Display for Timings {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        writeln!(f, "{} ({}), rays traced by {}, {} frames", self.device, self.driver, self.trace, self.frames)?;
        writeln!(f, "  {:<20} {:>10} {:>10}", "pass", "median ms", "p95 ms")?;
        for pass in &self.passes {
            writeln!(f, "  {:<20} {:>10.2} {:>10.2}", pass.name, pass.median_ms, pass.p95_ms)?;
        }
        writeln!(f, "  {:<20} {:>10.2}", "frame", self.frame_ms_median)?;
        writeln!(f, "  {:<20} {:>10.2}", "first frame", self.first_frame_ms)?;
        writeln!(f, "  {:<20} {:>10.2}", "host", self.cpu_ms_median)?;
        let RayCounts { per_pixel, mrays_per_second, .. } = self.rays;
        write!(f, "  {per_pixel:.1} rays per pixel, {mrays_per_second:.2} Mray/s, {:.1} MB", self.memory_bytes.total as f64 * 1e-6)
    }
}

/// Without the first frame, where there are more.
fn warm(times: &[f64]) -> Vec<f64> {
    times[usize::from(times.len() > 1)..].to_vec()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passes_of_one_name_add_up() {
        let mut recorder = Recorder::new(["trace", "shade", "trace"].into_iter());
        recorder.add_gpu([].into_iter(), true);
        recorder.add_gpu([1.0, 2.0, 4.0].into_iter(), true);
        assert_eq!((recorder.names, recorder.passes, recorder.frames), (vec!["trace", "shade"], vec![vec![5.0], vec![2.0]], vec![7.0]));
    }

    #[test]
    fn submissions_of_a_frame_add_up() {
        let mut recorder = Recorder::new(["trace", "write"].into_iter());
        recorder.add_gpu([1.0, 0.0].into_iter(), false);
        assert_eq!(recorder.last_frame_ms(), None);
        recorder.add_gpu([2.0, 4.0].into_iter(), true);
        recorder.add_gpu([8.0, 1.0].into_iter(), true);
        assert_eq!((recorder.passes, recorder.frames), (vec![vec![3.0, 8.0], vec![4.0, 1.0]], vec![7.0, 9.0]));
    }

    #[test]
    fn the_first_frame_does_not_count() {
        assert_eq!(warm(&[100.0, 1.0, 2.0]), [1.0, 2.0]);
        assert_eq!(warm(&[100.0]), [100.0]);
        assert!(warm(&[]).is_empty());
    }
}
