//! Every seed's pictures of a point, and what they cost.

use super::record::{Moves, Point};
use super::runner::BenchError;
use crate::display::Image;
use crate::gpu::Gpu;
use crate::scene::Scene;
use crate::technique::{Renderer, Settings, Timings};

/// Fewest frames that times are taken over.
const TIMED_FRAMES: usize = 16;
/// Turns a seed into one that no other picture of the point has.
const OTHER: u32 = 0x8000_0000;

pub struct Shots {
    /// One for each seed.
    pub last: Vec<Image>,
    /// Pairs of subsequent frames, the earlier first; independent of each other but for those of frames that stand alone.
    pub pairs: Vec<[Image; 2]>,
    pub timings: Timings,
}

impl Shots {
    /// `sequence`: frames of the scene's sequence.
    ///
    /// # Errors
    /// The device cannot render the point.
    pub fn take(gpu: &Gpu, scene: &Scene, settings: &Settings, point: &Point, sequence: u32, seeds: &[u32]) -> Result<Self, BenchError> {
        let renderer = Renderer::new(gpu, scene.clone(), settings.clone())?;
        let mut camera = Photographer { renderer, point, shown: point.frame_shown(sequence), alone: settings.technique.accumulates };
        // Drivers compile.
        camera.renderer.render_frame()?;
        let (mut last, mut pairs) = (Vec::new(), Vec::new());
        for &seed in seeds {
            let (picture, pair) = camera.shoot(seed)?;
            last.push(picture);
            pairs.extend(pair);
        }
        if pairs.is_empty() {
            pairs = last.windows(2).map(|pair| [pair[0].clone(), pair[1].clone()]).collect();
        }
        while camera.renderer.frames_timed() < TIMED_FRAMES {
            camera.renderer.render_frame()?;
        }
        Ok(Self { last, pairs, timings: camera.renderer.timings()? })
    }
}

struct Photographer<'a> {
    renderer: Renderer,
    point: &'a Point,
    /// Frame of the animation.
    shown: u32,
    /// Frames know nothing of each other.
    alone: bool,
}

impl Photographer<'_> {
    /// The point's picture, and two subsequent frames where seeds do not serve as such.
    fn shoot(&mut self, seed: u32) -> Result<(Image, Option<[Image; 2]>), BenchError> {
        let mut earlier = None;
        self.renderer.restart(seed, if self.alone { self.shown } else { 0 })?;
        for turn in 0..self.point.frames {
            self.renderer.render_frame()?;
            if turn + 2 == self.point.frames {
                earlier = Some(self.renderer.picture()?);
            }
        }
        let last = self.renderer.picture()?;
        let pair = match earlier {
            Some(earlier) => Some([earlier, last.clone()]),
            None if !self.alone => {
                self.renderer.render_frame()?;
                Some([last.clone(), self.renderer.picture()?])
            }
            None if self.point.moves != Moves::Nothing => {
                self.renderer.restart(seed ^ OTHER, self.shown.saturating_sub(1))?;
                self.renderer.render_frame()?;
                Some([self.renderer.picture()?, last.clone()])
            }
            None => None,
        };
        Ok((last, pair))
    }
}
