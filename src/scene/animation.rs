//! Node animation: translation, rotation and scale sampled over time.

use glam::{DQuat, DVec3};

use super::{Local, Node};

/// Channels of all of a file's animations, played together from time 0, over and over.
#[derive(Debug, Clone, Default)]
pub struct Animation {
    channels: Vec<Channel>,
    duration: f64,
}

/// Keyframes of one property of one node.
#[derive(Debug, Clone)]
pub struct Channel {
    /// Its `local` is a [`Local::Trs`].
    pub node: u32,
    /// Seconds, increasing, at least one.
    pub times: Vec<f64>,
    pub interpolation: Interpolation,
    pub keys: Keys,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Interpolation {
    Step,
    Linear,
    /// Three keys for each time: incoming tangent, value, outgoing tangent; tangents per second.
    CubicSpline,
}

#[derive(Debug, Clone)]
pub enum Keys {
    Translation(Vec<DVec3>),
    Rotation(Vec<DQuat>),
    Scale(Vec<DVec3>),
}

impl Channel {
    pub(super) fn drives_the_same_as(&self, other: &Channel) -> bool {
        self.node == other.node && std::mem::discriminant(&self.keys) == std::mem::discriminant(&other.keys)
    }

    fn apply(&self, time: f64, local: &mut Local) {
        let Local::Trs { translation, rotation, scale } = local else { return };
        let span = Span::find(&self.times, time);
        match &self.keys {
            Keys::Translation(keys) => *translation = span.blend(self.interpolation, keys, |a, b, t| a.lerp(b, t)),
            Keys::Scale(keys) => *scale = span.blend(self.interpolation, keys, |a, b, t| a.lerp(b, t)),
            Keys::Rotation(keys) => {
                let slerp = |a: DQuat, b: DQuat, t| unit(a).slerp(unit(b), t);
                *rotation = unit(span.blend(self.interpolation, keys, slerp));
            }
        }
    }
}

fn unit(rotation: DQuat) -> DQuat {
    if rotation.length_squared() > f64::MIN_POSITIVE { rotation.normalize() } else { DQuat::IDENTITY }
}

/// Where a time lies among keyframes.
struct Span {
    /// Keyframe before; the one after is the next, or the same at both ends.
    before: usize,
    after: usize,
    /// Part of the way from one to the other, 0..=1.
    fraction: f64,
    /// Seconds between them.
    length: f64,
}

impl Span {
    fn find(times: &[f64], time: f64) -> Self {
        let after = times.partition_point(|&key| key <= time);
        if after == 0 || after == times.len() {
            let end = after.saturating_sub(1);
            return Self { before: end, after: end, fraction: 0.0, length: 0.0 };
        }
        let length = times[after] - times[after - 1];
        Self { before: after - 1, after, fraction: (time - times[after - 1]) / length, length }
    }

    /// glTF 2.0, appendix C.
    fn blend<T>(&self, interpolation: Interpolation, keys: &[T], linear: impl Fn(T, T, f64) -> T) -> T
    where
        T: Copy + std::ops::Mul<f64, Output = T> + std::ops::Add<Output = T>,
    {
        match interpolation {
            Interpolation::Step => keys[self.before],
            Interpolation::Linear if self.before == self.after => keys[self.before],
            Interpolation::Linear => linear(keys[self.before], keys[self.after], self.fraction),
            Interpolation::CubicSpline => {
                let (t, t2, t3) = (self.fraction, self.fraction.powi(2), self.fraction.powi(3));
                let (value, outgoing) = (keys[3 * self.before + 1], keys[3 * self.before + 2]);
                let (incoming, next_value) = (keys[3 * self.after], keys[3 * self.after + 1]);
                value * (2.0 * t3 - 3.0 * t2 + 1.0)
                    + outgoing * (self.length * (t3 - 2.0 * t2 + t))
                    + next_value * (3.0 * t2 - 2.0 * t3)
                    + incoming * (self.length * (t3 - t2))
            }
        }
    }
}

impl Animation {
    pub fn new(channels: Vec<Channel>) -> Self {
        let duration = channels.iter().filter_map(|channel| channel.times.last().copied()).fold(0.0, f64::max);
        Self { channels, duration }
    }

    pub fn is_empty(&self) -> bool {
        self.channels.is_empty()
    }

    /// Seconds until the last keyframe; the animation starts anew after it.
    pub fn duration(&self) -> f64 {
        self.duration
    }

    /// Local transform of each node at `time`, in seconds.
    pub fn sample(&self, nodes: &[Node], time: f64) -> Vec<Local> {
        let mut locals: Vec<Local> = nodes.iter().map(|node| node.local).collect();
        self.sample_into(nodes, time, &mut locals);
        locals
    }

    /// As [`Animation::sample`], into `locals`, which is as long as `nodes`, without allocating.
    pub fn sample_into(&self, nodes: &[Node], time: f64, locals: &mut [Local]) {
        let time = self.wrap(time);
        for channel in &self.channels {
            locals[channel.node as usize] = nodes[channel.node as usize].local;
        }
        for channel in &self.channels {
            channel.apply(time, &mut locals[channel.node as usize]);
        }
    }

    /// The end itself still shows the last keyframe.
    fn wrap(&self, time: f64) -> f64 {
        let beyond = !(0.0..=self.duration).contains(&time);
        if beyond && self.duration > 0.0 && time.is_finite() { time.rem_euclid(self.duration) } else { time }
    }

    /// Nodes that have a channel, ascending.
    pub fn animated_nodes(&self) -> Vec<u32> {
        let mut nodes: Vec<u32> = self.channels.iter().map(|channel| channel.node).collect();
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    }

    /// For each node, whether it or one above it is animated: the camera, light or mesh that it places moves.
    pub fn moving_nodes(&self, nodes: &[Node]) -> Vec<bool> {
        let mut moving = vec![false; nodes.len()];
        self.channels.iter().for_each(|channel| moving[channel.node as usize] = true);
        for (i, node) in nodes.iter().enumerate() {
            moving[i] |= node.parent.is_some_and(|parent| moving[parent as usize]);
        }
        moving
    }
}
