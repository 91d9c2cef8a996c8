// The mean over all frames since the first, and the variance of that mean.
//
// Sum: Kahan's ("Further Remarks on Reducing Truncation Errors", CACM 8(1), 1965) with Knuth's TwoSum ("The Art of Computer Programming",
// volume 2, 4.2.2, theorem B) for the error, which needs no order of magnitudes: what an addition has lost, and what storing the sum at
// frame.precision has lost, goes into the next, so 10^6 frames lose no more than the last frame's own rounding. accumulate.sum plain
// drops it. Variance: Welford's recurrence (Technometrics 4(3), 1962) over frames as batches (batch means): each frame's mean of its
// samples is one observation, so the figure also holds for samples that are not independent within a frame.
#include "shared/bindings.glsl"
#include "lib/storage.glsl"

layout(local_size_x = 8, local_size_y = 4) in;

layout(set = 1, binding = 0, COLOR_FORMAT) readonly uniform image2D radiance;
/// rgb: rounded sum.
layout(set = 1, binding = 1, COLOR_FORMAT) uniform image2D sum_high;
/// rgb: what the rounding lost; left alone by a plain sum.
layout(set = 1, binding = 2, COLOR_FORMAT) uniform image2D sum_low;
/// rgb: sum of squared deviations from the mean.
layout(set = 1, binding = 3, COLOR_FORMAT) uniform image2D deviations;
layout(set = 1, binding = 4, COLOR_FORMAT) writeonly uniform image2D mean;
/// Of the mean; 0 after one frame.
layout(set = 1, binding = 5, COLOR_FORMAT) writeonly uniform image2D variance;

const uint SUM_PLAIN = 1u;

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(uvec2(pixel), frame.extent))) {
        return;
    }
    bool first = frame.frame == 0u;
    vec3 high = first ? vec3(0.0) : imageLoad(sum_high, pixel).rgb;
    vec3 low = first || SUM == SUM_PLAIN ? vec3(0.0) : imageLoad(sum_low, pixel).rgb;
    vec3 squares = first ? vec3(0.0) : imageLoad(deviations, pixel).rgb;
    vec3 x = imageLoad(radiance, pixel).rgb;

    float before = float(frame.frame);
    float count = before + 1.0;
    vec3 mean_before = (high + low) / max(before, 1.0);
    precise vec3 addend = x + low;
    precise vec3 rounded = high + addend;
    precise vec3 of_addend = rounded - high;
    precise vec3 lost = (high - (rounded - of_addend)) + (addend - of_addend);
    precise vec3 sum = stored(rounded);
    low = SUM == SUM_PLAIN ? vec3(0.0) : lost + (rounded - sum);
    vec3 mean_after = (sum + low) / count;
    squares += first ? vec3(0.0) : (x - mean_before) * (x - mean_after);

    imageStore(sum_high, pixel, vec4(sum, 0.0));
    if (SUM != SUM_PLAIN) {
        imageStore(sum_low, pixel, storable(vec4(low, 0.0)));
    }
    imageStore(deviations, pixel, storable(vec4(squares, 0.0)));
    imageStore(mean, pixel, storable(vec4(mean_after, 1.0)));
    imageStore(variance, pixel, storable(vec4(squares / (count * max(count - 1.0, 1.0)), 0.0)));
}
