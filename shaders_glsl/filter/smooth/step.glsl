// What cells leave as noise is smoothed over the screen: one step of an edge-avoiding a-trous filter. Dammertz, Sewtz, Hanika, Lensch,
// "Edge-Avoiding A-Trous Wavelet Transform for fast Global Illumination Filtering", HPG 2010, section 3: 5x5 taps of a B3 spline,
// STEP pixels apart. Binder, chapter 4, leaves this to complementary filters. Albedo is not part of what is smoothed.
//
// The variance of what is smoothed goes along, as in Schied et al., "Spatiotemporal Variance-Guided Filtering", HPG 2017, section 4.3: a
// step takes those taps for similar whose colour differs by no more than noise does, so that what cells know better over frames is
// smoothed less. The first step knows no variance yet but each pixel's own, from one sample: it takes all taps, and
// moves no pixel by more than noise explains. Weights by the colour of few samples would keep the very noise that is to go, so the
// blind steps after it allow for more, as much more as their FEW says. Measured (hpsf+, 256x144): direct light wants two such steps of 4
// samples, and what other lobes reflect 8, not 64 as indirect light, or shadows and reflections blur more than noise goes. FLIP of the first
// frame .176 for .182 in the hall, .151 for .155 on the staircase, .069 for .071 in Sponza, .048 on cornell either way; of the 16th .098 for
// .103, .075 for .078, .040 and .022 either way. With 12 samples of direct light first frames are better yet (.173, .148, .068), but shadows that
// are known already blur: cornell's 16th has 1.2 % more.
//
// A mean of taps that all lie on one side is that of a place beside the pixel: rims of walls, where light changes most, would take on the
// brightness of their middles. So a plane is fitted to the taps, and read where the pixel is (local linear regression: Cleveland 1979;
// Moon, Carr and Yoon 2014 for pictures). Between taps on all sides that is their mean. What the slope adds counts as far as it is more than
// its own standard error (James and Stein's estimate, its positive part), or the noise of few samples would be extrapolated. Measured (hpsf+ on
// cornell, 256x144, four seeds, hpsf.jitter=0.4 nhpsf.vertices=2): FLIP of the first frame 0.0508, of the 16th 0.0231; with means 0.0534 and
// 0.0260, in 0.92 of a frame's time; with planes and luminances 0.0510 and 0.0235.
//
// Two pixels are as similar one way as the other: the larger of their variances counts. By the centre's alone, as in the paper, a bright
// sample takes in its dark surroundings and they do not take it in, and 5 % of Sponza's light is lost in one frame.
//
// Layers that are apart, up to LAYERS of them, are smoothed side by side: they share the taps' places, normals and weights by these.
//
// Deviations and why: colours count, not luminances alone, or what walls lend each other is lost. Positions count by the distance from the
// tangent plane, so that a floor seen at a flat angle is smoothed like a wall.
// All weights are polynomials and need no exponential. The variance is not filtered by squared weights alone: each pixel's
// comes from one sample, so its weighted mean is taken first, and then what the weights leave of it. Taps of later steps share most of
// their samples, and leave a quarter of it at best (the spline's own variance grows fourfold with each step), which the root
// of the squared weights' sum comes near.
#include "filter/footprint.glsl"
#include "filter/similar.glsl"
#include "lib/colour.glsl"
#include "lib/packing.glsl"
#include "lib/storage.glsl"

layout(local_size_x = 8, local_size_y = 4) in;

/// Pixels between taps.
layout(constant_id = 224) const int STEP = 1;
/// Means over fewer samples than this do not tell how noisy they are, for each layer; 0: all do.
layout(constant_id = 232) const float FEW_0 = 0.0;
layout(constant_id = 233) const float FEW_1 = 0.0;
layout(constant_id = 236) const float FEW_2 = 0.0;

/// w: view-plane distance; 0 where there is no filter vertex.
layout(set = 1, binding = 0, rgba32f) readonly uniform image2D filter_position;
layout(set = 1, binding = 1, r32ui) readonly uniform uimage2D filter_normal;
/// w: variance, the mean of the channels'; below 0 where nothing is known.
layout(set = 1, binding = 2, COLOR_FORMAT) readonly uniform image2D noisy_0;
/// Samples that the noisy value is the mean of.
layout(set = 1, binding = 3, r32ui) readonly uniform uimage2D samples_0;
layout(set = 1, binding = 4, COLOR_FORMAT) writeonly uniform image2D smoothed_0;
#if LAYERS > 1
layout(set = 1, binding = 5, COLOR_FORMAT) readonly uniform image2D noisy_1;
layout(set = 1, binding = 6, r32ui) readonly uniform uimage2D samples_1;
layout(set = 1, binding = 7, COLOR_FORMAT) writeonly uniform image2D smoothed_1;
#endif
#if LAYERS > 2
layout(set = 1, binding = 8, COLOR_FORMAT) readonly uniform image2D noisy_2;
layout(set = 1, binding = 9, r32ui) readonly uniform uimage2D samples_2;
layout(set = 1, binding = 10, COLOR_FORMAT) writeonly uniform image2D smoothed_2;
#endif

vec4 noisy_at(int layer, ivec2 pixel) {
#if LAYERS > 2
    if (layer == 2) {
        return imageLoad(noisy_2, pixel);
    }
#endif
#if LAYERS > 1
    if (layer == 1) {
        return imageLoad(noisy_1, pixel);
    }
#endif
    return imageLoad(noisy_0, pixel);
}

uint samples_at(int layer, ivec2 pixel) {
#if LAYERS > 2
    if (layer == 2) {
        return imageLoad(samples_2, pixel).x;
    }
#endif
#if LAYERS > 1
    if (layer == 1) {
        return imageLoad(samples_1, pixel).x;
    }
#endif
    return imageLoad(samples_0, pixel).x;
}

void store(int layer, ivec2 pixel, vec4 value) {
#if LAYERS > 2
    if (layer == 2) {
        imageStore(smoothed_2, pixel, value);
        return;
    }
#endif
#if LAYERS > 1
    if (layer == 1) {
        imageStore(smoothed_1, pixel, value);
        return;
    }
#endif
    imageStore(smoothed_0, pixel, value);
}

/// By colour, too.
const bool GUIDED = STEP > 1;

const float SPLINE[3] = float[](0.375, 0.25, 0.0625);
/// Squared, relative: colours that differ by no more than rounding are alike.
const float ROUNDING = 1e-6;
const float LEAST = 1e-30;

/// Of the taps' spread, pixels of STEP squared, where they lie on a line or all in one place.
const float RIDGE = 0.05;

/// Weighted sums over taps.
struct Taps {
    float weights;
    float squared_weights;
    vec4 value;
    vec3 value_x;
    vec3 value_y;
    vec2 offset;
    /// xx, xy, yy.
    vec3 offsets;
};

void add_tap(inout Taps taps, float weight, vec2 offset, vec4 value) {
    taps.weights += weight;
    taps.squared_weights += weight * weight;
    taps.value += weight * value;
    taps.value_x += weight * offset.x * value.rgb;
    taps.value_y += weight * offset.y * value.rgb;
    taps.offset += weight * offset;
    taps.offsets += weight * vec3(offset.x * offset, offset.y * offset.y);
}

/// The value at the centre of a plane through the taps, as far as its slope is more than chance; w: mean of their variances. `left`: what
/// the weights leave of that, if taps are independent.
vec4 fitted(Taps taps, out float left) {
    vec4 mean = taps.value / taps.weights;
    left = taps.squared_weights / (taps.weights * taps.weights);
    vec2 middle = taps.offset / taps.weights;
    vec3 spread = taps.offsets / taps.weights - vec3(middle.x * middle, middle.y * middle.y) + RIDGE * vec3(1.0, 0.0, 1.0);
    vec2 lever = vec2(spread.z * middle.x - spread.y * middle.y, spread.x * middle.y - spread.y * middle.x);
    lever /= spread.x * spread.z - spread.y * spread.y;
    vec3 slope_x = taps.value_x / taps.weights - middle.x * mean.rgb;
    vec3 slope_y = taps.value_y / taps.weights - middle.y * mean.rgb;
    vec3 trend = lever.x * slope_x + lever.y * slope_y;
    float chance = left * dot(lever, middle);
    float share = max(1.0 - mean.w * chance / max(mean_square(trend), LEAST), 0.0);
    left += share * chance;
    return vec4(max(mean.rgb - share * trend, vec3(0.0)), mean.w);
}

/// A layer at a pixel, and around it.
struct Layer {
    vec4 own;
    /// In standard deviations, squared.
    float noise;
    float rounding;
    Taps taps;
};

/// Later steps have their variance from the more neighbours, and are the less blind.
float noise_at(int layer, ivec2 pixel) {
    float few = layer == 0 ? FEW_0 : layer == 1 ? FEW_1 : FEW_2;
    few = few > 0.0 ? few * 4.0 / (float(STEP * STEP) * float(max(samples_at(layer, pixel), 1u))) : 0.0;
    return parameters.hpsf_smooth_noise * parameters.hpsf_smooth_noise * (1.0 + few * few);
}

Layer layer_at(int layer, ivec2 pixel) {
    vec4 own = noisy_at(layer, pixel);
    Taps none = Taps(0.0, 0.0, vec4(0.0), vec3(0.0), vec3(0.0), vec2(0.0), vec3(0.0));
    return Layer(own, noise_at(layer, pixel), ROUNDING * mean_square(own.rgb) + LEAST, none);
}

/// `similar`: how much the tap's surface has to do with the pixel's; `share`: the spline's.
void weigh_tap(inout Layer layer, float similar, float share, vec2 tap, vec4 value) {
    float weight = similar;
    if (GUIDED && layer.own.w >= 0.0) {
        float noise = layer.noise * max(layer.own.w, value.w) + layer.rounding;
        weight *= max(1.0 - mean_square(value.rgb - layer.own.rgb) / noise, 0.0);
    }
    weight *= value.w >= 0.0 ? share : 0.0;
    add_tap(layer.taps, weight, tap, value);
}

vec4 smoothed(Layer layer) {
    if (!(layer.taps.weights > 0.0)) {
        return layer.own;
    }
    float left;
    vec4 mean = fitted(layer.taps, left);
    if (!GUIDED && layer.own.w >= 0.0) {
        float noise = layer.noise * max(mean.w, layer.own.w) + layer.rounding;
        float explained = noise / max(mean_square(mean.rgb - layer.own.rgb), LEAST);
        mean.rgb = mix(layer.own.rgb, mean.rgb, min(explained, 1.0));
    }
    return storable(vec4(mean.rgb, mean.w * (STEP == 1 ? left : sqrt(left))));
}

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    ivec2 extent = ivec2(frame.extent);
    if (any(greaterThanEqual(pixel, extent))) {
        return;
    }
    vec4 centre = imageLoad(filter_position, pixel);
    if (!(centre.w > 0.0)) {
        for (int i = 0; i < LAYERS; i++) {
            store(i, pixel, noisy_at(i, pixel));
        }
        return;
    }
    vec3 normal = unpack_normal(imageLoad(filter_normal, pixel).x);
    float reach = parameters.hpsf_smooth_reach * float(STEP) * pixel_footprint(centre.w);
    float least_cosine = cos(radians(parameters.hpsf_smooth_angle));
    Layer layers[LAYERS];
    for (int i = 0; i < LAYERS; i++) {
        layers[i] = layer_at(i, pixel);
    }
    for (int i = 0; i < 25; i++) {
        ivec2 tap = ivec2(i % 5, i / 5) - 2;
        ivec2 other = pixel + tap * STEP;
        if (any(lessThan(other, ivec2(0))) || any(greaterThanEqual(other, extent))) {
            continue;
        }
        vec4 position = imageLoad(filter_position, other);
        float similar = alignment(unpack_normal(imageLoad(filter_normal, other).x), normal, least_cosine);
        similar *= max(1.0 - abs(dot(position.xyz - centre.xyz, normal)) / reach, 0.0);
        float share = position.w > 0.0 ? SPLINE[abs(tap.x)] * SPLINE[abs(tap.y)] : 0.0;
        for (int j = 0; j < LAYERS; j++) {
            weigh_tap(layers[j], similar, share, vec2(tap), noisy_at(j, other));
        }
    }
    for (int i = 0; i < LAYERS; i++) {
        store(i, pixel, smoothed(layers[i]));
    }
}
