// Per cell: this frame's sums become a mean, and that joins what earlier frames know (Binder, section 3.4.1).
//
// average: exponential moving average with weight hpsf.alpha for the past; adapts, and never converges. integrate: alpha =
// N_old / (N_old + N_new), the mean over all samples, N_old up to hpsf.samples. hpsf.recency makes N_old count for less: with r of it the
// weights of n frames grow as n^r (polynomial-decay averaging, Shamir and Zhang 2013), which forgets what the first ones knew
// as n^-(1 + r) and keeps the variance within (1 + r)^2 / (1 + 2 r) of the mean's. hybrid: the same, where filter/hpsf/forget.comp has
// lowered N_old. detect: the same, without a ray: N_old is lowered where this frame's mean is not by chance so far from the old one.
// frame: this frame alone. The step towards the new mean
// is what is added, so the count may stop at its limit without stalling the mean. Cells that no sample has touched for more than hpsf.age
// frames are evicted (section 3.4.3); with swapped tables, or frame, at once (Meijer, section 4.2.2).
#include "filter/hpsf/fixed_point.glsl"
#include "filter/hpsf/forgetting.glsl"
#include "filter/hpsf/ordered.glsl"
#include "filter/hpsf/stored_cell.glsl"
#include "lib/colour.glsl"
#include "lib/elements.glsl"
#include "lib/rng.glsl"
#include "lib/rounding.glsl"

layout(local_size_x = 64) in;

layout(constant_id = 223) const bool FLOAT_SUMS = false;

layout(set = 1, binding = 0, scalar) buffer Keys { uint at[]; } keys;
layout(set = 1, binding = 1, scalar) buffer Sums { uint at[]; } sums;
layout(set = 1, binding = 2, scalar) readonly buffer Seeds { CELL_WORDS at[]; } seeds;
layout(set = 1, binding = 3, scalar) buffer Cells { CELL_WORDS at[]; } cells;

/// This frame's samples of a slot; its sums are zero for the next one.
Cell take_sums(uint slot) {
    uint stride = FLOAT_SUMS ? 4u : 8u;
    uint words[7];
    for (uint i = 0u; i < 7u; i++) {
        words[i] = i < stride ? sums.at[stride * slot + i] : 0u;
    }
    for (uint i = 0u; i < min(stride, 7u); i++) {
        sums.at[stride * slot + i] = 0u;
    }
    if (FLOAT_SUMS) {
        float count = uintBitsToFloat(words[3]);
        return Cell(uintBitsToFloat(uvec3(words[0], words[1], words[2])) / max(count, 1.0), uint(count), 0u);
    }
    vec3 sum = vec3(from_fixed(words[0], words[1]), from_fixed(words[2], words[3]), from_fixed(words[4], words[5]));
    return Cell(sum / max(float(words[6]), 1.0), words[6], 0u);
}

/// Weight of the past.
float alpha_of(uint old_count, uint new_count) {
    if (TIME == TIME_FRAME || old_count == 0u) {
        return 0.0;
    }
    float known = float(old_count) / (1.0 + parameters.hpsf_recency);
    return TIME == TIME_AVERAGE ? parameters.hpsf_alpha : known / (known + float(new_count));
}

/// The old mean, a step nearer the new one. After millions of samples a step is less than a float's last digit: rounded to nearest, the mean
/// would stand still. The numbers that round it are hashed from the cell's content, which does not depend on its slot.
vec3 towards(Cell old, Cell new, float weight) {
    uvec4 bits = pcg4d(uvec4(floatBitsToUint(new.mean), old.count ^ frame.frame));
    vec3 numbers = vec3(unit_float(bits.xy), unit_float(bits.z));
    vec3 next;
    for (uint channel = 0u; channel < 3u; channel++) {
        float change = weight * (new.mean[channel] - old.mean[channel]);
        next[channel] = add_rounding_at_random(old.mean[channel], change, numbers[channel]);
    }
    return next;
}

void store(uint slot, Cell cell) {
    cells.at[slot] = pack_cell(cell);
    if (ORDERED) {
        keys.at[slot] = old_word(keys.at[slot], cell);
    }
}

/// How far this frame's mean is from that of `known` samples before, beyond what chance explains: one standard error of the difference,
/// where a sample's standard deviation is its mean over hpsf.adapt.
float significant_change(Cell old, uint known, Cell new) {
    float difference = relative_difference(old.mean, new.mean);
    float error2 = (1.0 / float(known) + 1.0 / float(new.count)) / (parameters.hpsf_adapt * parameters.hpsf_adapt);
    return sqrt(max(difference * difference - error2, 0.0));
}

void main() {
    uint slot = element_index();
    if (slot >= CAPACITY || keys.at[KEY_WORDS * slot] == NO_FINGERPRINT) {
        return;
    }
    Cell old = HPSF_TABLE == TABLE_PERSISTENT && TIME != TIME_FRAME ? unpack_cell(cells.at[slot]) : EMPTY_CELL;
    Cell new = take_sums(slot);
    if (new.count == 0u) {
        bool evicted = TIME == TIME_FRAME || old.age >= parameters.hpsf_age;
        old.age++;
        store(slot, evicted ? EMPTY_CELL : old);
        if (evicted) {
            for (uint word = 0u; word < KEY_WORDS; word++) {
                keys.at[KEY_WORDS * slot + word] = NO_FINGERPRINT;
            }
        }
        return;
    }
    if (old.count == 0u && TIME != TIME_FRAME) {
        old = unpack_cell(seeds.at[slot]);
    }
    uint known = min(old.count, parameters.hpsf_samples);
    if (TIME == TIME_DETECT && known > 0u) {
        known = min(known, past_samples(significant_change(old, known, new), new.count));
    }
    vec3 mean = towards(old, new, 1.0 - alpha_of(known, new.count));
    uint count = min((TIME == TIME_FRAME ? 0u : known) + new.count, MOST_SAMPLES);
    store(slot, Cell(all_finite(mean) ? mean : new.mean, count, 0u));
}
