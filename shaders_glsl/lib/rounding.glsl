// Sums that many small steps do not stall, and floats of few digits that keep their mean: Croci et al., "Stochastic rounding: implementation,
// error analysis and applications", Royal Society Open Science 9, 2022, section 2.
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

/// A format of floats without a sign, in the order of what they stand for: an exponent above `digits` bits of mantissa. From 0 to 2^`least` they are
/// as far apart as they are from there to twice that. Halves: 10 digits, and -14.
struct ShortFloat {
    uint digits;
    int least;
};

const ShortFloat HALF = ShortFloat(10u, -14);

/// The bits of one of the two short floats around `value`, finite and not negative, the nearer the likelier, so that their mean is exact; what has a
/// short float stays as it is. `number`: uniform in [0, 1), or 0.5 for the nearest.
uint short_rounding_at_random(float value, ShortFloat format, float number) {
    if (value < ldexp(1.0, format.least)) {
        float units = ldexp(value, int(format.digits) - format.least);
        return uint(units) + (number < fract(units) ? 1u : 0u);
    }
    // Where what is added carries over, the mantissa rounds up, and into the exponent.
    uint dropped = 23u - format.digits;
    uint bits = floatBitsToUint(value) + uint(number * float(1u << dropped));
    return (bits >> dropped) - (uint(126 + format.least) << format.digits);
}

float from_short(uint bits, ShortFloat format) {
    if (bits < 1u << format.digits) {
        return ldexp(float(bits), format.least - int(format.digits));
    }
    return uintBitsToFloat(bits + (uint(126 + format.least) << format.digits) << (23u - format.digits));
}

#endif
