//! Axis-aligned boxes.

use glam::{DMat4, DVec3, Vec3A};

/// Contains every point between `min` and `max`, both included. Empty where `min` exceeds `max`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Aabb {
    pub min: Vec3A,
    pub max: Vec3A,
}

impl Default for Aabb {
    fn default() -> Self {
        Self::EMPTY
    }
}

impl Aabb {
    pub const EMPTY: Self = Self { min: Vec3A::INFINITY, max: Vec3A::NEG_INFINITY };

    pub fn of_points(points: impl IntoIterator<Item = [f32; 3]>) -> Self {
        points.into_iter().fold(Self::EMPTY, |bounds, point| bounds.with_point(Vec3A::from(point)))
    }

    #[inline]
    pub fn with_point(self, point: Vec3A) -> Self {
        Self { min: self.min.min(point), max: self.max.max(point) }
    }

    #[inline]
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    pub fn is_empty(&self) -> bool {
        self.min.cmpgt(self.max).any()
    }

    #[inline]
    pub fn extent(&self) -> Vec3A {
        self.max - self.min
    }

    /// Halves before it adds, so that the largest finite boxes do not overflow.
    #[inline]
    pub fn centre(&self) -> Vec3A {
        self.min * 0.5 + self.max * 0.5
    }

    pub fn half_area(&self) -> f32 {
        let edge = self.extent().max(Vec3A::ZERO);
        edge.dot(Vec3A::new(edge.y, edge.z, edge.x))
    }

    /// Largest absolute coordinate; 0 where empty.
    pub fn largest_coordinate(&self) -> f32 {
        if self.is_empty() { 0.0 } else { self.min.abs().max(self.max.abs()).max_element() }
    }

    /// Bounds of the transformed box, grown by `margin`, rounded outwards to single precision.
    pub fn transformed(&self, matrix: &DMat4, margin: f64) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        let (min, max) = (self.min.as_dvec3(), self.max.as_dvec3());
        let centre = matrix.transform_point3((min + max) * 0.5);
        let half = (max - min) * 0.5;
        let reach = matrix.x_axis.truncate().abs() * half.x
            + matrix.y_axis.truncate().abs() * half.y
            + matrix.z_axis.truncate().abs() * half.z
            + DVec3::splat(margin);
        Self { min: round(centre - reach, f32::next_down), max: round(centre + reach, f32::next_up) }
    }
}

/// To single precision and one step on, so that rounding to nearest never moves a bound inwards.
fn round(value: DVec3, step: fn(f32) -> f32) -> Vec3A {
    Vec3A::new(step(value.x as f32), step(value.y as f32), step(value.z as f32))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_transformed_box_contains_its_transformed_corners() {
        let bounds = Aabb { min: Vec3A::new(-1.0, 2.0, 1e5), max: Vec3A::new(3.0, 2.0, 1.1e5) };
        let matrix =
            DMat4::from_translation(DVec3::splat(0.1)) * DMat4::from_rotation_y(0.7) * DMat4::from_scale(DVec3::new(-3.0, 0.3, 1.0));
        let world = bounds.transformed(&matrix, 0.0);
        for corner in 0..8 {
            let pick = |axis: usize| (if corner >> axis & 1 == 0 { bounds.min } else { bounds.max })[axis] as f64;
            let point = matrix.transform_point3(DVec3::new(pick(0), pick(1), pick(2)));
            for axis in 0..3 {
                assert!(f64::from(world.min[axis]) <= point[axis] && point[axis] <= f64::from(world.max[axis]));
            }
        }
    }
}
