//! `render --budget-ms` and `--target-flip`: technique and samples from the measured front of this device, kept to frame by frame.

use super::progress::Progress;
use crate::bench::calibrate::Calibration;
use crate::bench::front::{Choice, Wish};
use crate::gpu::Gpu;
use crate::scene::Scene;
use crate::technique::{self, Governor, Renderer, Settings, Timings};
use anyhow::Context;

/// A budget for frames, and who keeps it.
pub struct Budget {
    wish: Wish,
    choice: Choice,
    governor: Option<Governor>,
    /// Frames whose time the governor knows.
    observed: usize,
}

impl Budget {
    /// Calibrates where no calibration is kept, or `anew`; returns the settings that were chosen.
    pub fn plan(gpu: &Gpu, scene: &Scene, settings: Settings, wish: Wish, anew: bool) -> anyhow::Result<(Self, Settings)> {
        let calibration = Calibration { gpu, scene, settings: &settings };
        let mut bar = None;
        let front = calibration.front(anew, |done, of| {
            let bar = bar.get_or_insert_with(|| Progress::new("calibrating", of as u64, "candidates"));
            bar.reach(done as u64);
        })?;
        drop(bar);
        let [width, height] = settings.extent.map(u64::from);
        let choice = front.choose(&wish, width * height).context("nothing could be measured on this device")?;
        let technique = technique::find(&choice.candidate.technique).context("the calibration names a technique that there is not")?;
        let parameters = settings.parameters.changed_from(&settings.technique.parameters(), technique.parameters());
        let governor = wish.budget_ms.map(|ms| Governor::new(ms, choice.samples, f64::from(technique.most_at_once())));
        let settings = Settings { technique, parameters, spp: choice.samples.max(1.0) as u32, ..settings };
        Ok((Self { wish, choice, governor, observed: 0 }, settings))
    }

    /// What was chosen and why, for people.
    pub fn explain(&self) -> String {
        let Choice { candidate, samples, predicted_ms, predicted_flip, reason } = &self.choice;
        // As they were typed.
        let asked =
            [self.wish.budget_ms.map(|ms| format!("{} ms", ms as f32)), self.wish.target_flip.map(|flip| format!("FLIP {}", flip as f32))];
        format!(
            "chosen for {}: {} at {samples:.2} samples per pixel, predicted {predicted_ms:.2} ms and FLIP {predicted_flip:.3}: {reason}",
            asked.into_iter().flatten().collect::<Vec<_>>().join(" and "),
            candidate.technique,
        )
    }

    /// Before each frame.
    pub fn steer(&mut self, renderer: &mut Renderer) {
        let Some(governor) = &mut self.governor else { return };
        let timed = renderer.gpu_frames();
        // The first frame compiles, and says nothing about the others.
        if timed > self.observed
            && timed > 1
            && let Some(ms) = renderer.last_frame_ms()
        {
            governor.observe(ms);
        }
        self.observed = timed;
        renderer.set_samples(governor.samples());
    }

    /// How well the frames kept to it.
    pub fn outcome(&self, timings: &Timings) -> Option<String> {
        let budget = self.wish.budget_ms?;
        let median = timings.frame_ms_median;
        Some(format!(
            "budget {} ms, median {median:.2} ms over {} frames: {:+.1} %",
            budget as f32,
            timings.frames,
            100.0 * (median / budget - 1.0)
        ))
    }
}
