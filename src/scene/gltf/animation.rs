//! Animation channels: keyframes read and checked.

use glam::{DQuat, DVec3};
use gltf::json::{
    Root,
    accessor::Type,
    animation::{Channel as JsonChannel, Interpolation as JsonInterpolation, Property, Sampler},
    validation::Checked,
};

use super::{
    accessor::{Accessor, check_type},
    buffers::Buffers,
    nodes::Tree,
    warnings::Warnings,
};
use crate::scene::{
    Animation, Local, Problem,
    animation::{Channel, Interpolation, Keys},
};

/// Reads all animations as one; where two drive the same property of a node the first is kept.
/// Nodes that they move are taken apart into translation, rotation and scale.
pub(super) fn read(root: &Root, buffers: &Buffers, tree: &mut Tree, warnings: &mut Warnings) -> Result<Animation, Problem> {
    let mut channels: Vec<Channel> = Vec::new();
    for (index, animation) in root.animations.iter().enumerate() {
        for (i, json) in animation.channels.iter().enumerate() {
            let place = format!("animations[{index}].channels[{i}]");
            let sampler = &animation.samplers[json.sampler.value()];
            let Some(channel) = channel(root, buffers, tree, json, sampler, warnings).map_err(|problem| within(problem, &place))? else {
                continue;
            };
            if channels.iter().any(|other| other.drives_the_same_as(&channel)) {
                warnings.add("animation channels ignored: another drives the same property of the node");
                continue;
            }
            let local = &mut tree.nodes[channel.node as usize].local;
            if let Local::Matrix(matrix) = *local {
                let (scale, rotation, translation) = matrix.to_scale_rotation_translation();
                *local = Local::Trs { translation, rotation, scale };
            }
            channels.push(channel);
        }
    }
    Ok(Animation::new(channels))
}

fn within(problem: Problem, channel: &str) -> Problem {
    match problem {
        Problem::Invalid { place, what } => Problem::invalid(format!("{channel}, {place}"), what),
        other => other,
    }
}

/// None where the channel moves nothing that is in the scene.
fn channel(
    root: &Root,
    buffers: &Buffers,
    tree: &Tree,
    json: &JsonChannel,
    sampler: &Sampler,
    warnings: &mut Warnings,
) -> Result<Option<Channel>, Problem> {
    let Checked::Valid(property) = json.target.path else {
        warnings.add("animation channels of an unknown property ignored");
        return Ok(None);
    };
    if property == Property::MorphTargetWeights {
        warnings.add("animation of morph weights ignored: meshes keep their base shape");
        return Ok(None);
    }
    let node =
        tree.indices.get(json.target.node.value()).ok_or_else(|| Problem::invalid("target", "refers to a node that does not exist"))?;
    let Some(node) = *node else { return Ok(None) };
    let interpolation = match sampler.interpolation.as_ref().unwrap() {
        JsonInterpolation::Step => Interpolation::Step,
        JsonInterpolation::Linear => Interpolation::Linear,
        JsonInterpolation::CubicSpline => Interpolation::CubicSpline,
    };
    let times = times(root, buffers, sampler)?;
    let per_key = if interpolation == Interpolation::CubicSpline { 3 } else { 1 };
    let kind = if property == Property::Rotation { Type::Vec4 } else { Type::Vec3 };
    check_type(root, sampler.output, &[kind], "the sampler's output")?;
    let output = Accessor::new(root, buffers, sampler.output)?;
    if output.count != times.len() * per_key {
        return Err(Problem::invalid("output", format!("has {} values for {} keyframes", output.count, times.len())));
    }
    let values: Vec<[f32; 4]> = (0..output.count).map(|i| output.vector(i)).collect();
    if values.iter().flatten().any(|component| !component.is_finite()) {
        return Err(Problem::invalid("output", "has values that are not finite"));
    }
    Ok(Some(Channel { node, times, interpolation, keys: keys(property, &values) }))
}

fn keys(property: Property, values: &[[f32; 4]]) -> Keys {
    let vectors = || values.iter().map(|&[x, y, z, _]| DVec3::new(x.into(), y.into(), z.into())).collect();
    match property {
        Property::Rotation => Keys::Rotation(values.iter().map(|value| DQuat::from_array(value.map(f64::from))).collect()),
        Property::Scale => Keys::Scale(vectors()),
        _ => Keys::Translation(vectors()),
    }
}

/// Seconds of the keyframes: at least one, from 0 on, increasing.
fn times(root: &Root, buffers: &Buffers, sampler: &Sampler) -> Result<Vec<f64>, Problem> {
    check_type(root, sampler.input, &[Type::Scalar], "the sampler's input")?;
    let input = Accessor::new(root, buffers, sampler.input)?;
    let times: Vec<f64> = (0..input.count).map(|i| input.vector::<1>(i)[0].into()).collect();
    let valid = times.first().is_some_and(|first| *first >= 0.0) && times.iter().all(|time| time.is_finite());
    if valid && times.is_sorted_by(|earlier, later| earlier < later) {
        return Ok(times);
    }
    Err(Problem::invalid("input", "must hold one or more finite, increasing times from 0 on"))
}
