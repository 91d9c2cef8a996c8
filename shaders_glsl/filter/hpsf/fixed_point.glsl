// Sums in fixed point: 64 bits per channel as two words, so that the order of additions does not matter and a picture is the same
// from run to run.
//
// No overflow: a sample is at most 2^SAMPLE_BITS units, and a cell gets at most one sample per pixel and level in a frame
// (of retraced paths: fewer). The host sets
// SAMPLE_BITS = min(40, 64 - ceil(log2(pixels * levels + 1))), so a sum is at most (2^(64 - SAMPLE_BITS) - 1) 2^SAMPLE_BITS < 2^64.
// With 40 bits and hpsf.largest = 65536 a unit is 2^-24 W/(sr m^2). Values between units are rounded at random, up as often as their
// fraction says, so that darker samples keep their mean.
#ifndef FILTER_HPSF_FIXED_POINT_GLSL
#define FILTER_HPSF_FIXED_POINT_GLSL

#include "shared/bindings.glsl"

layout(constant_id = 222) const uint SAMPLE_BITS = 40;

const float WORD = 4294967296.0;

/// Units per W/(sr m^2).
float fixed_scale() {
    return exp2(float(SAMPLE_BITS)) / parameters.hpsf_largest;
}

/// Low and high word of a value of 0..hpsf.largest.
uvec2 to_fixed(float value, float dither) {
    float units = floor(value * fixed_scale() + dither);
    float high = floor(units / WORD);
    return uvec2(uint(units - high * WORD), uint(high));
}

float from_fixed(uint low, uint high) {
    return (float(high) * WORD + float(low)) / fixed_scale();
}

#endif
