//! A camera that winds along the nave, close to the columns: what is behind them comes into view, and goes out of it, all the time.
//!
//! 2 m/s: at 30 frames per second and 144 pixels of height, what is 3 m away moves by 3 pixels per frame. After 7 s it begins anew.

use super::super::document::{Document, look_rotation};
use glam::{Vec3, vec3};
use std::f32::consts::TAU;

/// Metres.
const LENGTH: f32 = 14.0;
const HEIGHT: f32 = 1.65;
const FIRST_Z: f32 = -1.0;
/// Of the bends: sideways, from the nave's axis, and from bend to bend. Passes the sculpture, left of the axis, on its right.
const SWAY: f32 = 1.3;
const BEND: f32 = 10.13;
/// The camera looks at where it will be so many metres further on.
const LOOK_AHEAD: f32 = 3.5;
const SPEED: f32 = 2.0;
const KEYS_PER_SECOND: f32 = 4.0;

pub fn add_camera(document: &mut Document, yfov: f32) {
    let last_key = (LENGTH / SPEED * KEYS_PER_SECOND) as u32;
    let times: Vec<f32> = (0..=last_key).map(|key| key as f32 / KEYS_PER_SECOND).collect();
    let rotation = |along: f32| look_rotation(place(along + LOOK_AHEAD) - place(along));
    let places: Vec<Vec<f32>> = times.iter().map(|time| place(SPEED * time).to_array().to_vec()).collect();
    let rotations: Vec<Vec<f32>> = times.iter().map(|time| rotation(SPEED * time).to_array().to_vec()).collect();
    let camera = document.add_camera(place(0.0), place(LOOK_AHEAD), yfov);
    document.animate(camera, "translation", &times, &places);
    document.animate(camera, "rotation", &times, &rotations);
}

/// `along` metres of the nave from the start.
fn place(along: f32) -> Vec3 {
    vec3(-SWAY * (along / BEND * TAU).sin(), HEIGHT, FIRST_Z - along)
}
