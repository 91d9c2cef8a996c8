// Sums that many small steps do not stall: Croci et al., "Stochastic rounding: implementation, error analysis and applications", Royal Society
// Open Science 9, 2022, section 2.
#ifndef LIB_ROUNDING_GLSL
#define LIB_ROUNDING_GLSL

/// a + b, finite, rounded to one of the two floats around it, the nearer the likelier, so that the result's mean is exact. `number`: uniform in [0, 1).
float add_rounding_at_random(float a, float b, float number) {
    precise float sum = a + b;
    // Knuth's two-sum: what rounding has lost, exactly.
    precise float from_b = sum - a;
    precise float from_a = sum - from_b;
    precise float lost_b = b - from_b;
    precise float lost_a = a - from_a;
    precise float lost = lost_a + lost_b;
    // In the order of magnitudes: away from zero, or towards it.
    bool away = (lost > 0.0) == (sum > 0.0);
    float other = lost == 0.0 || sum == 0.0 ? sum : uintBitsToFloat(floatBitsToUint(sum) + (away ? 1u : ~0u));
    return number * abs(other - sum) < abs(lost) ? other : sum;
}

#endif
