// A path that is continued from frame to frame, by one scattered ray and one shadow ray in each.
//
// Its chain is a list of filter vertices as paths/vertices.glsl has it: of its last two, or with anhpsf.transport = all of all of them.
#ifndef FILTER_ANHPSF_CHAIN_GLSL
#define FILTER_ANHPSF_CHAIN_GLSL

#include "shared/bindings.glsl"

const uint TRANSPORT_ALL = 1u;
/// Vertices on moving things leave their places: the last one is looked at in each frame, those before it are forgotten.
const bool WHOLE_CHAIN = ANHPSF_TRANSPORT == TRANSPORT_ALL && !EFFECT_OBJECT_ANIMATION;

/// Beside the state of its ray (paths/wavefront/records.glsl): 28 bytes.
struct Continued {
    /// Of the chain; 0 where there is none.
    uint vertices;
    /// The path goes on.
    uint grows;
    /// Frames that the path lives, if nothing ends it before.
    uint frames_left;
    /// Where the ray sets out from.
    uint instance;
    /// The frame's origin that its positions are relative to.
    ivec3 origin_steps;
};

#endif
