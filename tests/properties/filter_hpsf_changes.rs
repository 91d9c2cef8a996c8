//! The table of what retraced paths say (filter/hpsf/changes.glsl): the same in whatever order threads come to it.

use crate::common::kernel::KernelOptions;
use crate::common::render::{builtin, render_frames, set, settings};
use crate::common::{self, run_kernel_with};
use pathspace::technique::Renderer;
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_pcg::Pcg32;

const SLOTS: usize = 64;
/// Of the keys that are looked up, 0 to 63, so many have been counted before.
const COUNTED: usize = 60;
const ORDERS: usize = 16;

const KERNEL: &str = r#"
#include "shared/bindings.glsl"
struct In { uint order[64]; };
struct Out { uint table[1024]; uint told[64]; };
layout(buffer_reference, scalar) buffer Table { uint at[]; };
Table changes;
bool claims;
#include "filter/hpsf/changes.glsl"
uint change_fingerprint(uint at, uint own) {
    if (claims && changes.at[at] == NO_FINGERPRINT) {
        changes.at[at] = own;
    }
    return changes.at[at];
}
CellKey key_number(uint number) {
    return CellKey(ivec3(number), 0, 0u, 0u);
}
void kernel(uint i) {
    uvec2 address = uvec2(push.out_buffer);
    uint low = address.x + 4352u * i;
    changes = Table(uvec2(low, address.y + (low < address.x ? 1u : 0u)));
    for (uint word = 0u; word < 1024u; word++) {
        changes.at[word] = 0u;
    }
    claims = true;
    for (uint k = 0u; k < 60u; k++) {
        uint number = inputs[i].order[k];
        changes.at[find_change(key_number(number)) + 1u] += 1u + number;
    }
    claims = false;
    for (uint number = 0u; number < 64u; number++) {
        uint slot = find_change(key_number(number));
        outputs[i].told[number] = slot == NO_SLOT ? 0u : changes.at[slot + 1u];
    }
}
"#;

#[repr(C)]
#[derive(Debug, Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Told {
    table: [[u32; 16]; SLOTS],
    told: [u32; SLOTS],
}

#[test]
fn every_key_has_a_slot_of_its_own_in_whatever_order_they_come() {
    let mut rng = Pcg32::seed_from_u64(3);
    let mut order: [u32; SLOTS] = std::array::from_fn(|number| number as u32);
    let shuffled = |_| {
        order[..COUNTED].shuffle(&mut rng);
        order
    };
    let orders: Vec<_> = (0..ORDERS).map(shuffled).collect();
    let options = KernelOptions { constants: vec![(225, SLOTS as u32)], ..Default::default() };
    let told: Vec<Told> = run_kernel_with(&common::gpu(), KERNEL, &orders, &options);
    let expected: [u32; SLOTS] = std::array::from_fn(|number| if number < COUNTED { 1 + number as u32 } else { 0 });
    assert!(told.iter().all(|one| one.told == expected));
    assert!(told.iter().any(|one| one.table != told[0].table), "no key has met another one's slot");
}

/// In a table with one slot for each key, 7 of 7 runs differed from the first: which of two keys had it was for the faster thread to say.
#[test]
fn a_moving_object_looks_the_same_in_every_run() {
    let gpu = common::gpu();
    let scene = builtin("cornell-object");
    let mut settings = settings(256, 144);
    // Many keys, each of which tells: as many paths as pixels, and one of them suffices.
    let paths = [("hpsf.retrace", "1"), ("hpsf.retraced_few", "1"), ("hpsf.levels", "2")];
    set(&mut settings, &paths);
    set(&mut settings, &[("hpsf.sums", "fixed"), ("hpsf.insertion", "ordered")]);
    let picture = |renderer: Renderer| renderer.picture().unwrap().pixels.into_iter().flatten().map(f32::to_bits).collect::<Vec<_>>();
    let [first, second] = [(); 2].map(|()| picture(render_frames(&gpu, &scene, &settings, "hpsf+", 3)));
    assert!(first == second, "pixels differ");
}
