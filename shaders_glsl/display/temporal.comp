// Pictures of earlier frames, moved to where their points are now, are averaged with this one: what the frames' sub-pixel offsets
// (frame.jitter) make of edges becomes their antialiasing, and noise that no filter has seen falls. Karis, "High Quality Temporal
// Supersampling", SIGGRAPH 2014 courses; Salvi, "An Excursion in Temporal Supersampling", GDC 2016 (variance clipping).
//
// Frame k of the N that a point has been seen in weighs 2k / (N (N + 1)): later ones are better where cells keep what they know, and an even
// mean would carry the first frames' error twice as long. Up to temporal.frames a still picture converges; then it is a moving average.
//
// Where lights or objects move, what a point looked like is no longer what it looks like: its history is clipped to what surrounds it now
// (temporal.clamp) and short (temporal.moving), shortest along edges that move, or they leave a trail, of lamps above all. Where nothing but
// the camera moves, history is right, and clipping would only take away light that few samples find: 8 % of the hall's, by 16 frames. Where
// paths of the last frame are traced again (filter/hpsf/changes.comp), they tell what has changed, and all else is as if nothing moved.
//
// Deviations and why: history counts where its depth is in the range of the depths around the pixel now, not where it is that of the
// pixel's one sample: at an edge the offset decides which surface the sample meets.
#include "display/history.glsl"
#include "lib/storage.glsl"

layout(local_size_x = 8, local_size_y = 4) in;

layout(set = 1, binding = 0, COLOR_FORMAT) readonly uniform image2D radiance;
layout(set = 1, binding = 5, COLOR_FORMAT) writeonly uniform image2D temporal;
layout(set = 1, binding = 6, r32f) writeonly uniform image2D temporal_depth;

/// Relative change of what a pixel's vertex sends, 0..1.
layout(set = 1, binding = 7, r32f) readonly uniform image2D change;
/// w: 0 where there is no vertex, and below it where what is seen is a light.
layout(set = 1, binding = 8, rgba32f) readonly uniform image2D vertices;

layout(constant_id = 234) const bool KNOWS_CHANGES = false;

/// Pixels per frame by which neighbours move apart where one passes in front of the other, and frames that count there.
const float APART = 0.1;
const float EDGE_FRAMES = 2.0;

/// What is seen around a pixel in this frame.
struct Surroundings {
    vec3 mean;
    vec3 deviation;
    float nearest;
    float farthest;
    /// Least and most motion, pixels.
    vec2 slowest;
    vec2 fastest;
    /// Something may look different from the last frame.
    bool changes;
};

/// What a pixel's sample says of it: a path that has met no vertex says nothing, unless it has left the scene or met a light at once.
const uint SAYS_NOTHING = 0u;
const uint SAYS_UNCHANGED = 1u;
const uint SAYS_CHANGED = 2u;

uint said_of_changes(ivec2 pixel, float depth) {
    if (depth != MISS && imageLoad(vertices, pixel).w == 0.0) {
        return SAYS_NOTHING;
    }
    return depth != MISS && imageLoad(change, pixel).x > 0.0 ? SAYS_CHANGED : SAYS_UNCHANGED;
}

Surroundings look_around(ivec2 pixel) {
    ivec2 low = max(pixel - 1, 0);
    ivec2 high = min(pixel + 1, ivec2(frame.extent) - 1);
    vec3 sum = vec3(0.0);
    vec3 squares = vec3(0.0);
    Surroundings around = Surroundings(vec3(0.0), vec3(0.0), MISS, -MISS, vec2(MISS), vec2(-MISS), EFFECT_OBJECT_ANIMATION);
    uint said = SAYS_NOTHING;
    for (int y = low.y; y <= high.y; y++) {
        for (int x = low.x; x <= high.x; x++) {
            vec3 value = imageLoad(radiance, ivec2(x, y)).rgb;
            float depth = depth_at(ivec2(x, y));
            vec2 moves = imageLoad(motion, ivec2(x, y)).xy;
            sum += value;
            squares += value * value;
            around.nearest = min(around.nearest, depth);
            around.farthest = max(around.farthest, depth);
            around.slowest = min(around.slowest, moves);
            around.fastest = max(around.fastest, moves);
            if (EFFECT_OBJECT_ANIMATION && KNOWS_CHANGES) {
                said = max(said, said_of_changes(ivec2(x, y), depth));
            }
        }
    }
    around.changes = around.changes && said != SAYS_UNCHANGED;
    ivec2 size = high - low + 1;
    float count = float(size.x * size.y);
    around.mean = sum / count;
    around.deviation = sqrt(max(squares / count - around.mean * around.mean, vec3(0.0)));
    return around;
}

/// Frames that count at most.
float most_frames(Surroundings around) {
    vec2 apart = around.fastest - around.slowest;
    if (EFFECT_OBJECT_ANIMATION && dot(apart, apart) > APART * APART) {
        return EDGE_FRAMES;
    }
    return around.changes ? parameters.temporal_moving : parameters.temporal_frames;
}

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(uvec2(pixel), frame.extent))) {
        return;
    }
    vec3 now = imageLoad(radiance, pixel).rgb;
    vec4 moved = imageLoad(motion, pixel);
    Surroundings around = look_around(pixel);
    vec4 before = history_of(pixel, moved, around.nearest, around.farthest);
    if (around.changes && parameters.temporal_clamp > 0.0) {
        vec3 allowed = parameters.temporal_clamp * around.deviation;
        before.rgb = clamp(before.rgb, around.mean - allowed, around.mean + allowed);
    }
    float count = min(before.w, most_frames(around) - 1.0) + 1.0;
    vec3 mean = before.w > 0.0 ? mix(before.rgb, now, 2.0 / (count + 1.0)) : now;
    imageStore(temporal, pixel, storable(vec4(mean, before.w > 0.0 ? count : 1.0)));
    imageStore(temporal_depth, pixel, vec4(depth_at(pixel)));
}
