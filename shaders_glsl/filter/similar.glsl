// How much the vertices of neighbouring pixels have to do with each other.
#ifndef FILTER_SIMILAR_GLSL
#define FILTER_SIMILAR_GLSL

/// 1 for equal normals, falling linearly with the cosine to 0 at the angle of `least_cosine`.
float alignment(vec3 a, vec3 b, float least_cosine) {
    return clamp((dot(a, b) - least_cosine) / (1.0 - least_cosine), 0.0, 1.0);
}

#endif
