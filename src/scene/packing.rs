//! Unit vectors in 32 bits: the encoding half of `shaders_glsl/lib/packing.glsl`.
//!
//! Octahedral, Cigolle et al., "A Survey of Efficient Representations for Independent Unit Vectors", JCGT 3(2), 2014, with the best of the
//! four codes around the exact place ("precise" encoding, listing 2).

use glam::{DVec2, DVec3};

/// A unit vector as snorm 16 x 2, x below, to within 0.004 degrees.
pub fn pack_normal(normal: [f32; 3]) -> u32 {
    let [x, y] = best_code(DVec3::from_array(normal.map(f64::from)), [32767.0, 32767.0]);
    (x as i16 as u16 as u32) | (y as i16 as u16 as u32) << 16
}

/// A unit tangent as snorm 16 below snorm 15, and bit 31 where the handedness w is positive. Never 0, which means none.
pub fn pack_tangent([x, y, z, handedness]: [f32; 4]) -> u32 {
    let [x, y] = best_code(DVec3::new(x.into(), y.into(), z.into()), [32767.0, 16383.0]);
    let sign = if handedness > 0.0 { 1 << 31 } else { 0 };
    let bits = (x as i16 as u16 as u32) | (y as u32 & 0x7fff) << 16 | sign;
    bits.max(1)
}

/// The code whose direction is nearest, of the four around `direction`.
fn best_code(direction: DVec3, scale: [f64; 2]) -> [i32; 2] {
    let place = encode(direction) * DVec2::from_array(scale);
    let codes = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)].map(|(right, up)| {
        let code = (place.floor() + DVec2::new(right, up)).to_array();
        [0, 1].map(|axis| code[axis].clamp(-scale[axis], scale[axis]))
    });
    let distance = |code: &[f64; 2]| (decode(DVec2::new(code[0] / scale[0], code[1] / scale[1])) - direction).length_squared();
    let nearest = codes.into_iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or_default();
    nearest.map(|coordinate| coordinate as i32)
}

fn sign_not_zero(v: f64) -> f64 {
    if v >= 0.0 { 1.0 } else { -1.0 }
}

fn encode(n: DVec3) -> DVec2 {
    let p = n.truncate() / (n.x.abs() + n.y.abs() + n.z.abs()).max(f64::MIN_POSITIVE);
    let fold = |along: f64, across: f64| (1.0 - across.abs()) * sign_not_zero(along);
    if n.z >= 0.0 { p } else { DVec2::new(fold(p.x, p.y), fold(p.y, p.x)) }
}

fn decode(p: DVec2) -> DVec3 {
    let z = 1.0 - p.x.abs() - p.y.abs();
    let fold = |along: f64, across: f64| if z < 0.0 { (1.0 - across.abs()) * sign_not_zero(along) } else { along };
    DVec3::new(fold(p.x, p.y), fold(p.y, p.x), z).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{Rng, SeedableRng};
    use rand_pcg::Pcg32;

    fn unpack(x: u32, y: i32, scale: f64) -> DVec3 {
        decode(DVec2::new(f64::from(x as u16 as i16) / 32767.0, f64::from(y) / scale))
    }

    #[test]
    fn packed_vectors_come_back_within_half_a_code() {
        let mut rng = Pcg32::seed_from_u64(2);
        for _ in 0..100_000 {
            let v = [0; 3].map(|_| rng.random_range(-1.0..1.0f64));
            let v = DVec3::from_array(v).normalize();
            let bits = pack_normal(v.as_vec3().to_array());
            let error = unpack(bits, i32::from((bits >> 16) as u16 as i16), 32767.0).angle_between(v).to_degrees();
            assert!(error < 0.004, "{v}: {error} degrees");
            let bits = pack_tangent(v.as_vec3().extend(-1.0).to_array());
            let error = unpack(bits, (bits << 1) as i32 >> 17, 16383.0).angle_between(v).to_degrees();
            assert!(error < 0.008 && bits >> 31 == 0, "{v}: {error} degrees");
        }
    }

    #[test]
    fn the_axes_are_exact_and_a_tangent_is_never_none() {
        for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
            for v in [axis, -axis] {
                let bits = pack_normal(v.as_vec3().to_array());
                assert!(unpack(bits, i32::from((bits >> 16) as u16 as i16), 32767.0).angle_between(v) < 1e-7, "{v}");
            }
        }
        assert_ne!(pack_tangent([0.0, 0.0, 1.0, -1.0]), 0);
    }
}
