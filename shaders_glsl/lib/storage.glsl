// What images in the frame's precision (frame.precision, COLOR_FORMAT) can keep.
#ifndef LIB_STORAGE_GLSL
#define LIB_STORAGE_GLSL

#include "shared/parameters.glsl"

const uint PRECISION_FP16 = 1u;
/// Larger values would become infinite in a half.
const float LARGEST_HALF = 65504.0;

/// What to store: every finite value stays finite.
vec4 storable(vec4 value) {
    return PRECISION == PRECISION_FP16 ? clamp(value, -LARGEST_HALF, LARGEST_HALF) : value;
}

/// The nearest halves, ties to even. In integers, since compilers may drop unpackHalf2x16(packHalf2x16(x)) as if it were x.
vec3 round_to_half(vec3 value) {
    // A half has 13 bits of mantissa less; below 2^-14 it counts in steps of 2^-24.
    uvec3 bits = floatBitsToUint(value);
    vec3 normal = uintBitsToFloat((bits + 0xfffu + ((bits >> 13) & 1u)) & ~0x1fffu);
    const float steps = 16777216.0;
    return mix(normal, roundEven(value * steps) / steps, lessThan(abs(value), vec3(1.0 / 16384.0)));
}

/// What an image gives back after `value` was stored, where it stores the nearest.
vec3 stored(vec3 value) {
    return PRECISION == PRECISION_FP16 ? round_to_half(clamp(value, -LARGEST_HALF, LARGEST_HALF)) : value;
}

#endif
