//! GPU time between marks of a frame.

use super::command::Commands;
use super::device::Gpu;
use super::error::{Context, GpuError};
use ash::vk;

/// Timestamps of one frame in flight.
pub struct Timer {
    gpu: Gpu,
    pool: vk::QueryPool,
    /// Raw ticks, reused from frame to frame.
    ticks: Vec<u64>,
    recorded: bool,
}

impl Timer {
    /// `marks` points in time per frame.
    pub fn new(gpu: &Gpu, marks: u32) -> Result<Self, GpuError> {
        let info = vk::QueryPoolCreateInfo::default().query_type(vk::QueryType::TIMESTAMP).query_count(marks.max(1));
        // SAFETY: plain creation, destroyed in drop.
        let pool = unsafe { gpu.raw().create_query_pool(&info, None) }.context("create a timestamp query pool")?;
        Ok(Self { gpu: gpu.clone(), pool, ticks: vec![0; marks as usize], recorded: false })
    }

    /// Before the first mark of a frame.
    pub fn reset(&mut self, commands: &Commands) {
        // SAFETY: the last frame that used the pool is done.
        unsafe { self.gpu.raw().cmd_reset_query_pool(commands.raw(), self.pool, 0, self.ticks.len() as u32) };
        self.recorded = true;
    }

    /// The time when everything recorded before is done.
    pub fn mark(&self, commands: &Commands, index: u32) {
        // SAFETY: the pool was reset earlier in this command buffer.
        unsafe { self.gpu.raw().cmd_write_timestamp(commands.raw(), vk::PipelineStageFlags::BOTTOM_OF_PIPE, self.pool, index) };
    }

    /// Milliseconds between neighbouring marks of the last frame, which must be done; nothing where that has been taken already, and
    /// on devices without timestamps.
    pub fn take(&mut self) -> impl Iterator<Item = f64> + '_ {
        let period = f64::from(self.gpu.capabilities().timestamp_period) * 1e-6;
        let available = std::mem::take(&mut self.recorded) && self.gpu.capabilities().timestamps;
        // SAFETY: the results are as long as the pool; the frame is done, so they are there without waiting.
        let mut read = || unsafe { self.gpu.raw().get_query_pool_results(self.pool, 0, &mut self.ticks, vk::QueryResultFlags::TYPE_64) };
        let marks = if available && read().is_ok() { self.ticks.as_slice() } else { &[] };
        marks.windows(2).map(move |pair| pair[1].saturating_sub(pair[0]) as f64 * period)
    }
}

impl Drop for Timer {
    fn drop(&mut self) {
        // SAFETY: the owner has seen to it that no frame is in flight.
        unsafe { self.gpu.raw().destroy_query_pool(self.pool, None) };
    }
}
