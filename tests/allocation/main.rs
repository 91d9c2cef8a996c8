//! A frame allocates nothing, neither on the host nor on the device: a test binary of its own, for its allocator counts.

#[path = "../common/mod.rs"]
mod common;

use common::render::{builtin, set, settings};
use pathspace::technique::{REGISTRY, Renderer, Settings};
use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicU64, Ordering};

/// Allocations of all threads since the start.
static ALLOCATIONS: AtomicU64 = AtomicU64::new(0);

struct Counting;

// SAFETY: everything is passed on to the system's allocator as it comes.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
        // SAFETY: the caller keeps GlobalAlloc's contract.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: as above.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Frames until every buffer that is reused has its size.
const WARM_UP: u32 = 4;
const FRAMES: u32 = 32;

/// The hall has something that moves: instances, lights and the top level change from frame to frame where the technique shows it.
#[test]
fn a_frame_allocates_nothing_on_host_and_device() {
    let gpu = common::gpu();
    let structures = pathspace::accel::REGISTRY.iter().filter(|entry| (entry.available)(gpu.capabilities()).is_ok());
    let techniques = || REGISTRY.iter().map(|technique| (technique, "megakernel")).chain([(&REGISTRY[0], "wavefront")]);
    for (structure, (technique, kernel)) in structures.flat_map(|structure| techniques().map(move |technique| (structure.name, technique)))
    {
        let mut settings = Settings { technique, parameters: technique.parameters(), trace: structure.to_owned(), ..settings(16, 9) };
        // In as many submissions.
        settings.spp = 2;
        set(&mut settings, &[("paths.kernel", kernel), ("paths.per_submission", "1")]);
        let mut renderer = Renderer::new(&gpu, builtin("hall:10000"), settings).unwrap();
        (0..WARM_UP).for_each(|_| renderer.render_frame().unwrap());
        let before = (ALLOCATIONS.load(Ordering::Relaxed), gpu.allocated_bytes());
        (0..FRAMES).for_each(|_| renderer.render_frame().unwrap());
        let after = (ALLOCATIONS.load(Ordering::Relaxed), gpu.allocated_bytes());
        assert_eq!(before, after, "allocations and device bytes, {} by {structure}, {kernel}", technique.name);
    }
}
