//! `render --budget-ms` and `--target-flip`: technique and samples from the measured front of this device, kept to frame by frame.

use super::progress::Progress;
use crate::bench::calibrate::Calibration;
use crate::bench::front::{Choice, Wish};
use crate::gpu::Gpu;
use crate::scene::Scene;
use crate::technique::{self, Governor, Renderer, Scale, Settings, Timings, Work};
use anyhow::Context;

/// How many times the samples that were chosen a frame may take, where it takes less time than was predicted.
const HEADROOM: f64 = 1.5;

/// A budget for frames, and who keeps it.
pub struct Budget {
    wish: Wish,
    choice: Choice,
    /// The choice's, within what the renderer is prepared for.
    scale: Scale,
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
        let technique = technique::find(&choice.technique).context("the calibration names a technique that there is not")?;
        let parameters = settings.parameters.changed_from(&settings.technique.parameters(), technique.parameters());
        let most_samples = if technique.rounds { (choice.work.samples * HEADROOM).floor() } else { choice.scale.most_samples };
        let scale = Scale { most_samples, ..choice.scale };
        let effort = scale.effort(&choice.work);
        // What reaches the target is enough.
        let most = if wish.target_flip.is_some() { effort } else { scale.most_effort() };
        let governor = wish.budget_ms.map(|ms| Governor::new(ms, effort, most.max(1.0)));
        let spp = if technique.rounds && governor.is_some() { most_samples } else { choice.work.samples } as u32;
        let settings = Settings { technique, parameters, spp, ..settings };
        Ok((Self { wish, choice, scale, governor, observed: 0 }, settings))
    }

    /// What was chosen and why, for people.
    pub fn explain(&self) -> String {
        let Choice { technique, work: Work { samples, first_shadow_rays }, scale, predicted_ms, predicted_flip, reason } = &self.choice;
        let rays = if *first_shadow_rays == scale.first_shadow_rays {
            String::new()
        } else {
            format!(" with {first_shadow_rays} shadow rays at the primary hit")
        };
        // As they were typed.
        let asked =
            [self.wish.budget_ms.map(|ms| format!("{} ms", ms as f32)), self.wish.target_flip.map(|flip| format!("FLIP {}", flip as f32))];
        format!(
            "chosen for {}: {technique} at {samples:.2} samples per pixel{rays}, predicted {predicted_ms:.2} ms and FLIP {predicted_flip:.3}: {reason}",
            asked.into_iter().flatten().collect::<Vec<_>>().join(" and "),
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
        renderer.set_work(self.scale.work(governor.effort()));
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
