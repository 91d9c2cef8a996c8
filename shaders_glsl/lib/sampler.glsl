// The numbers that a path is made of: sample `index` of a pixel is a point of a high-dimensional sequence, handed out in order, one or
// two dimensions at a time. Integers up to the last conversion: the same bits on every driver for the same pixel, index and seed.
//
// sobol: Burley, "Practical Hash-based Owen Scrambling", JCGT 9(4), 2020: each pair of dimensions is the (0,2)-sequence of Sobol with
//   its index shuffled (section 4, padding) and both coordinates Owen-scrambled (section 3, algorithm of section 3.3), seeded by pixel and pair.
// r2: Roberts, "The Unreasonable Effectiveness of Quasirandom Sequences", 2018, with a Cranley-Patterson rotation for each pixel and pair.
// independent: pcg3d of (pixel, index, dimension).
//
// Deviations and why: the Laine-Karras hash uses Vegdahl's constants (2021), which have fewer weak bits than Burley's. The second
// Sobol dimension is not a loop over 32 direction numbers: its matrix is Pascal's triangle modulo 2, the fivefold Kronecker power of
// (1 1; 0 1), so five shifts do it. R2 pairs are shuffled as Burley's are: rotated alone, every pair would be a copy of the first,
// and a path's dimensions would be correlated however many samples are taken.
#ifndef LIB_SAMPLER_GLSL
#define LIB_SAMPLER_GLSL

#include "shared/parameters.glsl"
#include "lib/rng.glsl"

const uint SAMPLER_SOBOL = 0u;
const uint SAMPLER_R2 = 1u;
const uint SAMPLER_INDEPENDENT = 2u;

struct Sampler {
    /// Hash of pixel and seed.
    uint scramble;
    uint index;
    /// Counts the calls: each takes the next dimension or pair.
    uint dimension;
};

Sampler sampler_begin(uvec2 pixel, uint sample_index, uint seed) {
    return Sampler(pcg3d(uvec3(pixel, seed)).x, sample_index, 0u);
}

const uint SCRAMBLE_TILE = 1u;

/// Pixels of a tile of 16x16 take turns in one sequence, in Morton order: the samples of each aligned square of 2^k pixels a side, and of all
/// its halves, are a net of the sequence, for nested scrambling keeps aligned powers of two together.
Sampler sampler_of_tile(uvec2 pixel, uint sample_index, uint seed) {
    uvec2 bits = pixel & 15u;
    bits = (bits | bits << 2) & 0x33u;
    bits = (bits | bits << 1) & 0x55u;
    return sampler_begin(pixel >> 4, sample_index * 256u + (bits.x | bits.y << 1), seed);
}

/// Owen scrambling of the reversed bits: bit i is flipped by a hash of the bits below it. Laine and Karras 2011, constants of Vegdahl.
uint laine_karras_permutation(uint bits, uint seed) {
    bits ^= bits * 0x3d20adeau;
    bits += seed;
    bits *= (seed >> 16) | 1u;
    bits ^= bits * 0x05526c56u;
    bits ^= bits * 0x53a22864u;
    return bits;
}

/// Owen scrambling: a permutation of the 32-bit fractions that keeps every elementary interval together.
uint owen_scramble(uint bits, uint seed) {
    return bitfieldReverse(laine_karras_permutation(bitfieldReverse(bits), seed));
}

/// Pascal's triangle modulo 2 times the bits of x: bitfieldReverse of it is Sobol's second dimension.
uint pascal_product(uint x) {
    x ^= (x >> 1) & 0x55555555u;
    x ^= (x >> 2) & 0x33333333u;
    x ^= (x >> 4) & 0x0f0f0f0fu;
    x ^= (x >> 8) & 0x00ff00ffu;
    return x ^ (x >> 16);
}

/// Two dimensions of Sobol's sequence as 32-bit fractions.
uvec2 sobol_2d(uint index) {
    return bitfieldReverse(uvec2(index, pascal_product(index)));
}

/// Point `index` of the R2 sequence as 32-bit fractions: 2^32 over the plastic number and over its square, rounded to odd integers.
uvec2 r2_2d(uint index) {
    return index * uvec2(0xc13fa9a9u, 0x91e10da5u);
}

/// The next pair of dimensions as 32-bit fractions.
uvec2 sampler_next(inout Sampler s) {
    uvec3 key = pcg3d(uvec3(s.scramble, s.dimension++, SAMPLER == SAMPLER_INDEPENDENT ? s.index : 0x9e3779b9u));
    if (SAMPLER == SAMPLER_INDEPENDENT) {
        return key.xy;
    }
    uint shuffled = owen_scramble(s.index, key.z);
    if (SAMPLER == SAMPLER_R2) {
        return r2_2d(shuffled) + key.xy;
    }
    uvec2 point = sobol_2d(shuffled);
    return uvec2(owen_scramble(point.x, key.x), owen_scramble(point.y, key.y));
}

/// In [0, 1).
float sample_1d(inout Sampler s) {
    return unit_float(sampler_next(s).x);
}

/// In [0, 1)^2.
vec2 sample_2d(inout Sampler s) {
    return unit_float(sampler_next(s));
}

#endif
