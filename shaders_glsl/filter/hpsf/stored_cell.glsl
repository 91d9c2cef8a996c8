// How cells are stored: buffers of CELL_WORDS, which is uvec4 or uvec2, as frame.precision says.
//
//   fp32  16 bytes: three floats; count (24 bits) and, above, age (8)
//   fp16   8 bytes: from the lowest bits, red (15), green (15), blue (15), count (11), age (8)
//
// fp16: radiance is not negative, so a half has 15 bits; it is clamped at 65504. The count is a float with 6 bits of mantissa, exact up to 128. In
// the last word it lies between what all copies of a frame have in common, so that an atomicMin of words is one of counts
// (filter/hpsf/forget.comp).
//
// Both are rounded at random (lib/rounding.glsl). A frame that differs by d from the mean of n frames moves it by d / n: rounded to the nearest,
// nothing once n > 2 d / u, u its last digit. At random a mean keeps its expectation, and as a step far below u is taken with the chance of its
// share of u, noise does not pile up either: with s the standard deviation of a frame's mean, rounding adds the variance sum over k of
// (k / n)^2 u s / k = u s / 2, for any n. Where s is a tenth of the mean, that is 0.5 to 0.7 % of it; where s is a hundredth, 0.2 %.
// The count's noise weighs frames a little unevenly, and does not know what is in them.
// The numbers that round are hashed from the cell's content, which does not depend on its slot: a picture is the same in every run.
//
// Measured (cornell, 128x72, 16 frames, three seeds, fp32 and fp16): FLIP 0.1084 and 0.1084 with hpsf, 0.0323 and 0.0330 with hpsf+; relMSE 0.0149
// and 0.0149, 0.00068 and 0.00069, all of the difference from images (with cells in fp32, 0.0331 and 0.00069). Device memory 2.15 and 1.41 MB, 8.71
// and 6.28 (with cells in fp32, 1.56 and 7.16); bytes that the table's passes move 4.0 and 3.2 MB a frame, 16.4 and 12.8. On a CPU that saves no
// time, since merge rounds: 0.13 and 0.14 ms, 1.2 and 1.5, of some 15 and 25.
#ifndef FILTER_HPSF_STORED_CELL_GLSL
#define FILTER_HPSF_STORED_CELL_GLSL

#include "filter/hpsf/table.glsl"
#include "lib/rng.glsl"
#include "lib/rounding.glsl"
#include "lib/storage.glsl"
#include "shared/bindings.glsl"

const bool NARROW = PRECISION == PRECISION_FP16;
/// Of a cell: the one with count and age.
const uint LAST_WORD = CELL_WORDS(0u).length() - 1u;
const uint AGE_SHIFT = 24u;
const uint COUNT_SHIFT = NARROW ? 13u : 0u;
const uint COUNT_MASK = (NARROW ? 0x7ffu : MOST_SAMPLES) << COUNT_SHIFT;
const ShortFloat COUNTS = ShortFloat(6u, 6);

uint pack_count(uint count, float number) {
    return (NARROW ? short_rounding_at_random(float(count), COUNTS, number) : count) << COUNT_SHIFT;
}

uint unpack_count(uint last_word) {
    uint bits = (last_word & COUNT_MASK) >> COUNT_SHIFT;
    return NARROW ? min(uint(from_short(bits, COUNTS)), MOST_SAMPLES) : bits;
}

uint unpack_age(uint last_word) {
    return last_word >> AGE_SHIFT;
}

/// A last word with another count, the nearest, by which words are in the order of their counts.
uint with_count(uint last_word, uint count) {
    return last_word & ~COUNT_MASK | pack_count(count, 0.5);
}

Cell unpack_cell(uvec4 words) {
    return Cell(uintBitsToFloat(words.xyz), unpack_count(words.w), unpack_age(words.w));
}

Cell unpack_cell(uvec2 words) {
    uint blue = words.x >> 30 | (words.y & 0x1fffu) << 2;
    vec3 mean = vec3(from_short(words.x & 0x7fffu, HALF), from_short(words.x >> 15 & 0x7fffu, HALF), from_short(blue, HALF));
    return Cell(mean, unpack_count(words.y), unpack_age(words.y));
}

uvec4 pack_wide(Cell cell) {
    return uvec4(floatBitsToUint(cell.mean), pack_count(cell.count, 0.0) | cell.age << AGE_SHIFT);
}

uvec2 pack_narrow(Cell cell) {
    uvec4 hash = pcg4d(uvec4(floatBitsToUint(cell.mean), cell.count ^ frame.frame));
    vec3 mean = clamp(cell.mean, vec3(0.0), vec3(LARGEST_HALF));
    uvec3 bits;
    for (uint channel = 0u; channel < 3u; channel++) {
        bits[channel] = short_rounding_at_random(mean[channel], HALF, unit_float(hash[channel]));
    }
    uint count_and_age = pack_count(cell.count, unit_float(hash.w)) | cell.age << AGE_SHIFT;
    return uvec2(bits.r | bits.g << 15 | bits.b << 30, bits.b >> 2 | count_and_age);
}

CELL_WORDS pack_cell(Cell cell) {
    return NARROW ? CELL_WORDS(uvec4(pack_narrow(cell), 0u, 0u)) : CELL_WORDS(pack_wide(cell));
}

#endif
