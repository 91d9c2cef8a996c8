//! Lights and cameras, which nodes place.

use std::f32::consts::{FRAC_PI_2, PI};

use gltf::json::{
    Root,
    camera::Camera as JsonCamera,
    extensions::scene::khr_lights_punctual::{Light as JsonLight, Type},
};
use serde::Deserialize;

use super::{nodes::Tree, warnings::Warnings};
use crate::scene::{Camera, Light, LightKind, Projection};

#[derive(Default, Deserialize)]
#[serde(default)]
struct LightExtras {
    radius: Option<f32>,
}

pub(super) fn lights(root: &Root, tree: &Tree, warnings: &mut Warnings) -> Vec<Light> {
    let definitions = root.extensions.as_ref().and_then(|extensions| extensions.khr_lights_punctual.as_ref());
    let Some(definitions) = definitions.map(|extension| &extension.lights) else { return Vec::new() };
    let placed = tree.sources.iter().enumerate().filter_map(|(node, &source)| {
        let extension = root.nodes[source].extensions.as_ref()?.khr_lights_punctual.as_ref()?;
        Some((node as u32, &definitions[extension.light.value()]))
    });
    placed.map(|(node, json)| light(node, json, warnings)).collect()
}

fn light(node: u32, json: &JsonLight, warnings: &mut Warnings) -> Light {
    let color = json.color.map(|channel| channel * json.intensity);
    let valid = color.iter().all(|channel| channel.is_finite() && *channel >= 0.0);
    warnings.add_count("lights whose colour or intensity is negative or infinite turned off", usize::from(!valid));
    let range = json.range.filter(|range| range.is_finite() && *range > 0.0);
    warnings.add_count("light ranges that are not positive ignored", usize::from(json.range.is_some() && range.is_none()));
    Light {
        name: json.name.clone().unwrap_or_default(),
        node,
        color: if valid { color } else { [0.0; 3] },
        kind: kind(json, warnings),
        range,
    }
}

fn kind(json: &JsonLight, warnings: &mut Warnings) -> LightKind {
    match json.type_.as_ref().unwrap() {
        Type::Directional => LightKind::Directional,
        Type::Point => match radius(json, warnings) {
            Some(radius) => LightKind::Sphere { radius },
            None => LightKind::Point,
        },
        Type::Spot => {
            let spot = json.spot.clone().unwrap_or_default();
            let (inner, outer) = (spot.inner_cone_angle, spot.outer_cone_angle);
            if inner >= 0.0 && inner < outer && outer <= FRAC_PI_2 + 1e-6 {
                return LightKind::Spot { inner_cone_angle: inner, outer_cone_angle: outer };
            }
            warnings.add("spot light angles outside 0 <= inner < outer <= pi/2 clamped");
            let outer = if outer > 0.0 { outer.min(FRAC_PI_2) } else { PI / 4.0 };
            LightKind::Spot { inner_cone_angle: inner.clamp(0.0, outer * 0.999), outer_cone_angle: outer }
        }
    }
}

/// `extras.radius`, metres, where it is a positive number.
fn radius(json: &JsonLight, warnings: &mut Warnings) -> Option<f32> {
    let extras = json.extras.as_ref()?;
    let radius = serde_json::from_str::<LightExtras>(extras.get()).unwrap_or_default().radius?;
    let valid = radius.is_finite() && radius >= 0.0;
    warnings.add_count("light radii that are negative or infinite ignored", usize::from(!valid));
    (valid && radius > 0.0).then_some(radius)
}

pub(super) fn cameras(root: &Root, tree: &Tree, warnings: &mut Warnings) -> Vec<Camera> {
    let mut cameras = Vec::new();
    for (node, &source) in tree.sources.iter().enumerate() {
        let Some(index) = root.nodes[source].camera else { continue };
        let json = &root.cameras[index.value()];
        let name = json.name.clone().or_else(|| root.nodes[source].name.clone()).unwrap_or_default();
        match projection(json) {
            Some(projection) => cameras.push(Camera { name, node: node as u32, projection }),
            None => warnings.add("cameras without a usable field of view or magnification skipped"),
        }
    }
    cameras
}

fn projection(json: &JsonCamera) -> Option<Projection> {
    match (&json.perspective, &json.orthographic) {
        (Some(perspective), _) if perspective.yfov > 0.0 && perspective.yfov < PI => {
            Some(Projection::Perspective { yfov: perspective.yfov })
        }
        (None, Some(orthographic)) if orthographic.ymag.is_finite() && orthographic.ymag != 0.0 => {
            Some(Projection::Orthographic { ymag: orthographic.ymag.abs() })
        }
        _ => None,
    }
}
