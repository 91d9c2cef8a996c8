//! The colour spaces of FLIP, from linear sRGB under D65.

use glam::{DMat3, DVec3};
use std::sync::LazyLock;

/// CIE xy of D65 for the 2 degree observer, to the digits of FLIP's white point.
const D65: [f64; 2] = [0.312_71, 0.329_02];
/// CIE xy of sRGB's red, green and blue (IEC 61966-2-1).
const PRIMARIES: [[f64; 2]; 3] = [[0.64, 0.33], [0.30, 0.60], [0.15, 0.06]];

/// XYZ of the white point, Y = 1.
static WHITE: LazyLock<DVec3> = LazyLock::new(|| xyz_of(D65));
/// Linear sRGB to XYZ over that of white.
static TO_RELATIVE_XYZ: LazyLock<DMat3> = LazyLock::new(|| {
    let [red, green, blue] = PRIMARIES.map(xyz_of);
    let primaries = DMat3::from_cols(red, green, blue);
    DMat3::from_diagonal(WHITE.recip()) * primaries * DMat3::from_diagonal(primaries.inverse() * *WHITE)
});
static FROM_RELATIVE_XYZ: LazyLock<DMat3> = LazyLock::new(|| TO_RELATIVE_XYZ.inverse());

fn xyz_of([x, y]: [f64; 2]) -> DVec3 {
    DVec3::new(x, y, 1.0 - x - y) / y
}

/// YCxCz, L*a*b* without its nonlinearity: a luminance and two opponent chrominances, in which the eye's contrast sensitivity is
/// known (Zhang and Wandell 1997).
pub fn linear_to_opponent(rgb: [f64; 3]) -> [f64; 3] {
    let xyz = *TO_RELATIVE_XYZ * DVec3::from(rgb);
    [116.0 * xyz.y - 16.0, 500.0 * (xyz.x - xyz.y), 200.0 * (xyz.y - xyz.z)]
}

pub fn opponent_to_linear([y, cx, cz]: [f64; 3]) -> [f64; 3] {
    let y = (y + 16.0) / 116.0;
    (*FROM_RELATIVE_XYZ * DVec3::new(y + cx / 500.0, y, y - cz / 200.0)).to_array()
}

/// CIE 1976 L*a*b*, its chrominance scaled by the lightness after Hunt: colours look richer where it is bright (section 4.1.2).
pub fn huntlab(rgb: [f64; 3]) -> [f64; 3] {
    let [x, y, z] = (*TO_RELATIVE_XYZ * DVec3::from(rgb)).to_array().map(lightness_response);
    let lightness = 116.0 * y - 16.0;
    [lightness, 0.01 * lightness * 500.0 * (x - y), 0.01 * lightness * 200.0 * (y - z)]
}

/// CIE 15: a cube root, and its tangent near 0.
fn lightness_response(t: f64) -> f64 {
    const DELTA: f64 = 6.0 / 29.0;
    match t > DELTA * DELTA * DELTA {
        true => t.cbrt(),
        false => t / (3.0 * DELTA * DELTA) + 4.0 / 29.0,
    }
}

/// Abasi et al. 2020: large differences of lightness and of chrominance add up.
pub fn hyab(a: [f64; 3], b: [f64; 3]) -> f64 {
    (a[0] - b[0]).abs() + (a[1] - b[1]).hypot(a[2] - b[2])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Green: L* = 87.73, a* = -86.18, b* = 83.18 (tabulated for sRGB under D65).
    #[test]
    fn the_green_primary_has_its_tabulated_lab() {
        let [l, a, b] = huntlab([0.0, 1.0, 0.0]);
        let unscaled = [l, a / (0.01 * l), b / (0.01 * l)];
        for (ours, tabulated) in unscaled.iter().zip([87.73, -86.18, 83.18]) {
            assert!((ours - tabulated).abs() < 0.02, "{unscaled:?}");
        }
    }

    #[test]
    fn opponent_colours_come_back_and_grey_has_none() {
        let [r, g, b] = opponent_to_linear(linear_to_opponent([0.1, 0.7, 0.3]));
        assert!((r - 0.1).abs() < 1e-12 && (g - 0.7).abs() < 1e-12 && (b - 0.3).abs() < 1e-12);
        let [_, cx, cz] = linear_to_opponent([0.4; 3]);
        assert!(cx.abs() < 1e-10 && cz.abs() < 1e-10);
    }
}
