//! Slots that are given in a fixed order (filter/hpsf/propose.glsl): by the keys alone, in whatever order they come.

use crate::common::{self, kernel::KernelOptions};
use pathspace::shared::Parameters;
use rand::seq::SliceRandom;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg32;
use std::collections::HashSet;

const SLOTS: usize = 64;
const PROBES: usize = 4;
/// More than slots, some of them twice, as pixels with one key.
const PROPOSALS: usize = 96;
const ORDERS: usize = 32;

const KERNEL: &str = r#"
#include "shared/bindings.glsl"
struct In { uint held[64]; uvec2 proposals[96]; };
struct Out { uint at[64]; };
layout(buffer_reference, scalar) buffer Table { uint at[]; };
Table keys;
#include "filter/hpsf/propose.glsl"
bool is_there(uvec2 key) {
    for (uint i = 0u; i < parameters.hpsf_probes; i++) {
        if ((keys.at[probe(key.x, i)] & KEY_MASK) == (key.y | i)) {
            return true;
        }
    }
    return false;
}
void kernel(uint i) {
    uvec2 address = uvec2(push.out_buffer);
    uint low = address.x + 256u * i;
    keys = Table(uvec2(low, address.y + (low < address.x ? 1u : 0u)));
    for (uint slot = 0u; slot < 64u; slot++) {
        keys.at[slot] = inputs[i].held[slot];
    }
    for (uint k = 0u; k < 96u; k++) {
        uvec2 key = inputs[i].proposals[k];
        if (!is_there(key)) {
            propose(key.x, key.y);
        }
    }
    for (uint k = 0u; k < 96u; k++) {
        uvec2 key = inputs[i].proposals[k];
        if (EVICT && !is_there(key)) {
            evict_for(key.x, key.y);
        }
    }
}
"#;

#[repr(C)]
#[derive(Debug, Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Case {
    held: [u32; SLOTS],
    /// Home, and word there.
    proposals: [[u32; 2]; PROPOSALS],
}

/// The same keys in many orders, some slots taken by old cells of some priority.
fn cases() -> Vec<Case> {
    let mut rng = Pcg32::seed_from_u64(5);
    let mut word = || rng.random_range(1..1 << 20) << 6;
    let mut held = [0; SLOTS].map(|_| word());
    let mut proposals = [[0; 2]; PROPOSALS].map(|_| [0, word()]);
    held.iter_mut().for_each(|word| *word = if rng.random_bool(0.4) { *word | rng.random_range(0..16) << 26 | 1 << 30 } else { 0 });
    proposals.iter_mut().for_each(|key| key[0] = rng.random_range(0..SLOTS as u32));
    proposals.copy_within(0..24, 72);
    let case = |_| {
        proposals.shuffle(&mut rng);
        Case { held, proposals }
    };
    (0..ORDERS).map(case).collect()
}

fn tables(cases: &[Case], evict: bool) -> Vec<[u32; SLOTS]> {
    let options = KernelOptions {
        defines: vec![("EVICT".to_owned(), evict.to_string())],
        constants: vec![(221, SLOTS as u32), (139, 1)],
        parameters: Parameters { hpsf_probes: PROBES as u32, ..Default::default() },
        ..Default::default()
    };
    common::run_kernel_with(&common::gpu(), KERNEL, cases, &options)
}

/// Home and word there, of the keys in a table, without the old ones.
fn new_keys(table: &[u32; SLOTS]) -> Vec<[u32; 2]> {
    let new = table.iter().enumerate().filter(|(_, word)| **word != 0 && *word >> 30 != 1);
    new.map(|(slot, word)| [(slot as u32 + 64 - (word & 63)) % 64, word & 0x03ff_ffc0]).collect()
}

#[test]
fn a_full_table_is_the_same_in_whatever_order_its_keys_come() {
    let cases = cases();
    for evict in [false, true] {
        let tables = tables(&cases, evict);
        assert!(tables.iter().all(|table| table == &tables[0]), "evict: {evict}");
        let placed = new_keys(&tables[0]);
        assert_eq!(placed.iter().collect::<HashSet<_>>().len(), placed.len(), "no key has two slots");
        assert!(placed.iter().all(|key| cases[0].proposals.contains(key)));
        assert!(placed.len() > SLOTS / 4 && placed.len() < 72, "{} of 72 keys", placed.len());
    }
}

/// A key is further from home than it need be only because larger words are in all slots before; with no slot, in all of its probes.
#[test]
fn no_key_could_take_a_slot_that_it_prefers() {
    let cases = cases();
    let table = tables(&cases, false)[0];
    for [home, word] in cases[0].proposals {
        for distance in 0..PROBES as u32 {
            let held = table[(home + distance) as usize % SLOTS];
            if held == word | distance {
                break;
            }
            assert!(held > word | distance, "{word:x} of {home} at {distance}: {held:x}");
        }
    }
    // Old cells that a sample has touched, or that are not to give way, are where they were.
    assert!((0..SLOTS).all(|slot| cases[0].held[slot] == 0 || cases[0].held[slot] == table[slot]));
}

/// Of the old cells that a key without a slot could take the place of, those that remain have the higher priority.
#[test]
fn the_lowest_priority_gives_way() {
    let cases = cases();
    let [before, after] = [false, true].map(|evict| tables(&cases, evict)[0]);
    let priority = |word: u32| word >> 26 & 15;
    let evicted: Vec<usize> = (0..SLOTS).filter(|&slot| before[slot] != after[slot]).collect();
    assert!(evicted.len() > 5 && evicted.iter().all(|&slot| before[slot] >> 30 == 1 && after[slot] >> 30 == 2));
    for slot in evicted {
        let word = after[slot];
        let home = slot + SLOTS - (word & 63) as usize;
        for distance in 0..PROBES {
            let other = after[(home + distance) % SLOTS];
            assert!(other >> 30 != 1 || priority(other) >= priority(word), "an old cell of less priority stays");
        }
    }
    let placed = new_keys(&after);
    for [home, word] in cases[0].proposals {
        let could = (0..PROBES).any(|distance| after[(home as usize + distance) % SLOTS] >> 30 == 1);
        assert!(placed.contains(&[home, word]) || !could, "a key without a slot, and an old cell that it could evict");
    }
}
