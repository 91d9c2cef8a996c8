// How far back a cell may remember where light changes: Binder, section 3.4.1.
//
// alpha, the weight of the past, is the smaller of N_old / (N_old + N_new) and 1 - w, where w is the weight of what is new that its change
// calls for. That is a limit to N_old.
//
// w: let light change by d a frame, and a frame's mean over a cell have the variance v. An average with weight w for what is new lags
// behind by d (1 - w) / w and has variance v w / (2 - w). For small w the sum of the squared lag and the variance is least where
// w^3 = 4 d^2 / v. A path-traced sample has a standard deviation of one or two times its mean m; with m / hpsf.adapt for it,
// v = (m / hpsf.adapt)^2 / N_new, and with the relative change r = d / m
//
//   w = min(1, (2 r hpsf.adapt sqrt(N_new))^(2/3)).
//
// Deviations and why: the paper says what alpha is at either end, and leaves open what blends. Schied et al. blend by w = r, which for
// light that changes steadily is late by its whole change: d (1 - r) / r is near m, whatever r.
#ifndef FILTER_HPSF_FORGETTING_GLSL
#define FILTER_HPSF_FORGETTING_GLSL

#include "filter/hpsf/table.glsl"
#include "shared/bindings.glsl"

/// Samples of the past that may count beside `samples` new ones.
uint past_samples(float relative_change, uint samples) {
    float weight = min(pow(2.0 * relative_change * parameters.hpsf_adapt * sqrt(float(samples)), 2.0 / 3.0), 1.0);
    return weight > 0.0 ? uint(min(float(samples) * (1.0 - weight) / weight, float(MOST_SAMPLES))) : MOST_SAMPLES;
}

/// Of all channels together, so that a dark one does not count for more than its light; 0..1.
float relative_difference(vec3 a, vec3 b) {
    vec3 most = max(a, b);
    float all = most.r + most.g + most.b;
    vec3 difference = abs(a - b);
    return all > 0.0 ? (difference.r + difference.g + difference.b) / all : 0.0;
}

#endif
