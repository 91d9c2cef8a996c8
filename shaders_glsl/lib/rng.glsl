// Integer hashes of the PCG family, and random floats made of them. Integers only: every driver returns the same bits.
//
// Jarzynski and Olano, "Hash Functions for GPU Rendering", JCGT 9(3), 2020: pcg (section 4.1), pcg2d, pcg3d, pcg4d (listings in the
// appendix). One dimension is O'Neill's PCG-RXS-M-XS-32.
#ifndef LIB_RNG_GLSL
#define LIB_RNG_GLSL

/// A uniform number in [0, 1): multiples of 2^-24, the largest being the largest float below 1.
float unit_float(uint bits) {
    return float(bits >> 8) * (1.0 / 16777216.0);
}

vec2 unit_float(uvec2 bits) {
    return vec2(bits >> 8) * (1.0 / 16777216.0);
}

/// A permutation of the 32-bit integers.
uint pcg_hash(uint value) {
    uint state = value * 747796405u + 2891336453u;
    uint word = ((state >> ((state >> 28) + 4u)) ^ state) * 277803737u;
    return (word >> 22) ^ word;
}

uvec2 pcg2d(uvec2 v) {
    v = v * 1664525u + 1013904223u;
    v.x += v.y * 1664525u;
    v.y += v.x * 1664525u;
    v ^= v >> 16;
    v.x += v.y * 1664525u;
    v.y += v.x * 1664525u;
    return v ^ (v >> 16);
}

uvec3 pcg3d(uvec3 v) {
    v = v * 1664525u + 1013904223u;
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v ^= v >> 16;
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    return v;
}

uvec4 pcg4d(uvec4 v) {
    v = v * 1664525u + 1013904223u;
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    v ^= v >> 16;
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    return v;
}

/// A sequence of independent numbers, for what needs no stratification.
struct Rng {
    uint state;
};

Rng rng_begin(uint seed) {
    return Rng(pcg_hash(seed));
}

uint rng_next(inout Rng rng) {
    rng.state = rng.state * 747796405u + 2891336453u;
    uint word = ((rng.state >> ((rng.state >> 28) + 4u)) ^ rng.state) * 277803737u;
    return (word >> 22) ^ word;
}

float rng_float(inout Rng rng) {
    return unit_float(rng_next(rng));
}

#endif
