// Which paths are traced once more in the next frame: of each square of hpsf.retrace pixels a side one, drawn anew in every frame.
#ifndef PATHS_RETRACED_GLSL
#define PATHS_RETRACED_GLSL

#include "shared/bindings.glsl"
#include "lib/rng.glsl"

/// The first workgroup that retraces.
layout(constant_id = 203) const uint RETRACING_GROUP = 0xffffffffu;

/// Squares along both axes of the picture.
uvec2 retraced_extent() {
    return (frame.extent + parameters.hpsf_retrace - 1u) / parameters.hpsf_retrace;
}

/// Where a square's results are.
uint retraced_index(uvec2 square) {
    return square.y * retraced_extent().x + square.x;
}

/// The pixel of a square whose path `sample_index` is the one.
uvec2 retraced_pixel(uvec2 square, uint sample_index) {
    uvec2 first = square * parameters.hpsf_retrace;
    uvec2 size = min(uvec2(parameters.hpsf_retrace), frame.extent - first);
    return first + min(uvec2(unit_float(pcg3d(uvec3(square, sample_index ^ frame.seed)).xy) * vec2(size)), size - 1u);
}

/// A path of this frame as the next one needs it: what the filter vertex's diffuse lobe receives, what its other lobes send on where they are
/// filtered, and the vertex's view-plane distance, 0 where the path is of no use. `unfiltered`: a hash of what goes past all cells, such as
/// the light of a sole light; equal light has equal hashes.
struct Kept {
    vec3 diffuse;
    float distance;
    vec3 specular;
    uint unfiltered;
};

/// A path of the last frame, traced in this one.
struct Retraced {
    Kept now;
    /// Filter vertex, as images keep it (paths/write_terms.glsl).
    vec3 position;
    uint normal;
    uint incident;
    uint layer;
};

#endif
