// Unit vectors in 32 bits. src/scene/packing.rs is the other half, and picks the best of the four nearest codes.
//
// Cigolle et al., "A Survey of Efficient Representations for Independent Unit Vectors", JCGT 3(2), 2014: octahedral, section 3.2 and
// listing 1 (decoding), listing 2 ("oct32P", precise encoding).
#ifndef LIB_PACKING_GLSL
#define LIB_PACKING_GLSL

vec2 sign_not_zero(vec2 v) {
    return vec2(v.x >= 0.0 ? 1.0 : -1.0, v.y >= 0.0 ? 1.0 : -1.0);
}

/// A unit vector to the square [-1, 1]^2.
vec2 octahedral_encode(vec3 n) {
    vec2 p = n.xy / (abs(n.x) + abs(n.y) + abs(n.z));
    return n.z >= 0.0 ? p : (1.0 - abs(p.yx)) * sign_not_zero(p);
}

/// The unit vector of a point of [-1, 1]^2.
vec3 octahedral_decode(vec2 p) {
    vec3 n = vec3(p, 1.0 - abs(p.x) - abs(p.y));
    if (n.z < 0.0) {
        n.xy = (1.0 - abs(n.yx)) * sign_not_zero(n.xy);
    }
    return normalize(n);
}

/// snorm 16 x 2, to within 0.004 degrees.
uint pack_normal(vec3 n) {
    return packSnorm2x16(octahedral_encode(n));
}

vec3 unpack_normal(uint bits) {
    return octahedral_decode(unpackSnorm2x16(bits));
}

/// VertexAttributes.tangent: snorm 16 below, snorm 15 above it, bit 31 set where the handedness is positive. 0 is no tangent.
/// Returns the unit tangent and the handedness, +1 or -1.
vec4 unpack_tangent(uint bits) {
    vec2 p = vec2(bitfieldExtract(int(bits), 0, 16), bitfieldExtract(int(bits), 16, 15)) / vec2(32767.0, 16383.0);
    return vec4(octahedral_decode(max(p, -1.0)), (bits & 0x80000000u) != 0u ? 1.0 : -1.0);
}

#endif
