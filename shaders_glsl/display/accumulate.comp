// The mean over all frames since the first, and the variance of that mean.
//
// Sum: two-float accumulation, Knuth's TwoSum ("The Art of Computer Programming", volume 2, 4.2.2, theorem B): the rounding error of every
// addition is kept in a second word, so 10^6 frames lose no more than the last frame's own rounding. Variance: Welford's recurrence
// (Technometrics 4(3), 1962) over frames as batches (batch means): each frame's mean of its samples is one observation, so the
// figure also holds for samples that are not independent within a frame.
#include "shared/bindings.glsl"

layout(local_size_x = 8, local_size_y = 4) in;

layout(set = 1, binding = 0, rgba32f) readonly uniform image2D radiance;
/// rgb: rounded sum; w: frames summed.
layout(set = 1, binding = 1, rgba32f) uniform image2D sum_high;
/// rgb: what the rounding lost.
layout(set = 1, binding = 2, rgba32f) uniform image2D sum_low;
/// rgb: sum of squared deviations from the mean.
layout(set = 1, binding = 3, rgba32f) uniform image2D deviations;
layout(set = 1, binding = 4, rgba32f) writeonly uniform image2D mean;
/// Of the mean; 0 after one frame.
layout(set = 1, binding = 5, rgba32f) writeonly uniform image2D variance;

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(uvec2(pixel), frame.extent))) {
        return;
    }
    bool first = frame.frame == 0u;
    vec4 high = first ? vec4(0.0) : imageLoad(sum_high, pixel);
    vec3 low = first ? vec3(0.0) : imageLoad(sum_low, pixel).rgb;
    vec3 squares = first ? vec3(0.0) : imageLoad(deviations, pixel).rgb;
    vec3 x = imageLoad(radiance, pixel).rgb;

    float count = high.w + 1.0;
    vec3 mean_before = (high.rgb + low) / max(high.w, 1.0);
    precise vec3 sum = high.rgb + x;
    precise vec3 of_x = sum - high.rgb;
    precise vec3 lost = (high.rgb - (sum - of_x)) + (x - of_x);
    low += lost;
    vec3 mean_after = (sum + low) / count;
    squares += first ? vec3(0.0) : (x - mean_before) * (x - mean_after);

    imageStore(sum_high, pixel, vec4(sum, count));
    imageStore(sum_low, pixel, vec4(low, 0.0));
    imageStore(deviations, pixel, vec4(squares, 0.0));
    imageStore(mean, pixel, vec4(mean_after, 1.0));
    imageStore(variance, pixel, vec4(squares / (count * max(count - 1.0, 1.0)), 0.0));
}
