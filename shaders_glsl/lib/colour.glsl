// Linear Rec. 709 colours.
#ifndef LIB_COLOUR_GLSL
#define LIB_COLOUR_GLSL

/// Relative luminance, ITU-R BT.709.
float luminance(vec3 colour) {
    return dot(colour, vec3(0.2126, 0.7152, 0.0722));
}

/// Mean of the channels' squares.
float mean_square(vec3 v) {
    return dot(v, v) / 3.0;
}

float max_component(vec3 v) {
    return max(v.x, max(v.y, v.z));
}

/// Neither infinite nor NaN in any channel. By its bits: a driver may assume that NaN does not exist and fold comparisons.
bool all_finite(vec3 v) {
    uvec3 exponent = floatBitsToUint(v) & 0x7f800000u;
    return all(notEqual(exponent, uvec3(0x7f800000u)));
}

#endif
