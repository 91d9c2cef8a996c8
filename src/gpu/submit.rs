//! Submitting: once with a wait, or in a ring of frames.

use super::command::Commands;
use super::device::Gpu;
use super::error::{Context, GpuError};
use ash::vk;

/// Command buffers and fences of the frames in flight.
pub struct FrameRing {
    gpu: Gpu,
    pool: vk::CommandPool,
    slots: Vec<Slot>,
    next: usize,
}

#[derive(Clone, Copy)]
struct Slot {
    commands: vk::CommandBuffer,
    done: vk::Fence,
}

impl FrameRing {
    /// `slots` frames may be in flight at a time.
    pub fn new(gpu: &Gpu, slots: usize) -> Result<Self, GpuError> {
        let info = vk::CommandPoolCreateInfo::default()
            .flags(vk::CommandPoolCreateFlags::RESET_COMMAND_BUFFER)
            .queue_family_index(gpu.0.queue_family);
        // SAFETY: plain creation; drop destroys what exists.
        let pool = unsafe { gpu.raw().create_command_pool(&info, None) }.context("create a command pool")?;
        let mut ring = Self { gpu: gpu.clone(), pool, slots: Vec::with_capacity(slots), next: 0 };
        let info = vk::CommandBufferAllocateInfo::default().command_pool(pool).command_buffer_count(slots as u32);
        // SAFETY: as above.
        let buffers = unsafe { gpu.raw().allocate_command_buffers(&info) }.context("allocate command buffers")?;
        for commands in buffers {
            let info = vk::FenceCreateInfo::default().flags(vk::FenceCreateFlags::SIGNALED);
            // SAFETY: as above.
            let done = unsafe { gpu.raw().create_fence(&info, None) }.context("create a fence")?;
            ring.slots.push(Slot { commands, done });
        }
        Ok(ring)
    }

    /// All slots, that of the earliest frame first.
    pub fn oldest_first(&self) -> impl Iterator<Item = usize> + use<> {
        let (next, count) = (self.next, self.slots.len());
        (0..count).map(move |i| (next + i) % count)
    }

    /// Waits for the next slot's last frame and returns the slot's number.
    pub fn acquire(&mut self) -> Result<usize, GpuError> {
        let slot = self.next;
        self.next = (slot + 1) % self.slots.len();
        self.wait_for(slot)?;
        Ok(slot)
    }

    /// Records and submits one frame in a slot that was acquired.
    pub fn submit(&mut self, slot: usize, record: impl FnOnce(&Commands)) -> Result<(), GpuError> {
        let Slot { commands, done } = self.slots[slot];
        let commands = Commands::new(&self.gpu, commands);
        commands.begin()?;
        record(&commands);
        // SAFETY: acquire has waited for the fence.
        unsafe { self.gpu.raw().reset_fences(&[done]) }.context("reset a fence")?;
        commands.submit(done)
    }

    /// Waits until every frame is done.
    pub fn wait(&self) -> Result<(), GpuError> {
        (0..self.slots.len()).try_for_each(|slot| self.wait_for(slot))
    }

    fn wait_for(&self, slot: usize) -> Result<(), GpuError> {
        // SAFETY: the fence is alive.
        let waited = unsafe { self.gpu.raw().wait_for_fences(&[self.slots[slot].done], true, u64::MAX) };
        self.gpu.lost(waited, "wait for a frame")
    }
}

impl Drop for FrameRing {
    fn drop(&mut self) {
        let _ = self.wait();
        // SAFETY: no frame is in flight.
        unsafe {
            for slot in &self.slots {
                self.gpu.raw().destroy_fence(slot.done, None);
            }
            self.gpu.raw().destroy_command_pool(self.pool, None);
        }
    }
}

impl Gpu {
    /// Records, submits and waits. What was recorded comes after everything submitted earlier, and is seen by everything later
    /// and by the host.
    pub fn submit_once<R>(&self, record: impl FnOnce(&Commands) -> R) -> Result<R, GpuError> {
        use vk::PipelineStageFlags as Stage;
        let mut ring = FrameRing::new(self, 1)?;
        let slot = ring.acquire()?;
        let mut result = None;
        ring.submit(slot, |commands| {
            commands.barrier(Stage::ALL_COMMANDS, Stage::ALL_COMMANDS);
            result = Some(record(commands));
            commands.barrier(Stage::ALL_COMMANDS, Stage::ALL_COMMANDS | Stage::HOST);
        })?;
        ring.wait()?;
        Ok(result.expect("submit has recorded"))
    }
}
