//! Where a picture is taken from.

use glam::{DMat4, DVec3, Vec3};

use super::{Projection, Scene};

/// A camera in world space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CameraView {
    pub position: DVec3,
    /// Unit length.
    pub forward: DVec3,
    /// Unit length, perpendicular to `forward`.
    pub up: DVec3,
    pub projection: Projection,
}

/// A camera that the scene does not have.
#[derive(Debug, thiserror::Error)]
#[error("scene '{scene}' has no camera '{name}'; it has {known}")]
pub struct UnknownCamera {
    pub scene: String,
    pub name: String,
    /// The names of those it has.
    pub known: String,
}

impl CameraView {
    /// Looks from `eye` to `target`, +y up, or +z where the view is vertical. `yfov` in radians.
    pub fn look_at(eye: DVec3, target: DVec3, yfov: f32) -> Self {
        let forward = (target - eye).try_normalize().unwrap_or(DVec3::NEG_Z);
        let vertical = forward.cross(DVec3::Y).length() < 1e-9;
        let right = forward.cross(if vertical { DVec3::Z } else { DVec3::Y }).normalize();
        Self { position: eye, forward, up: right.cross(forward), projection: Projection::Perspective { yfov } }
    }

    /// From a node's world matrix: along its -z, +y up, whatever its scale.
    fn from_node(world: &DMat4, projection: Projection) -> Self {
        let forward = (-world.z_axis.truncate()).try_normalize().unwrap_or(DVec3::NEG_Z);
        let right = forward.cross(world.y_axis.truncate()).try_normalize().unwrap_or_else(|| forward.any_orthonormal_vector());
        Self { position: world.w_axis.truncate(), forward, up: right.cross(forward), projection }
    }
}

impl Scene {
    /// The camera called `name`, or the first, or where there is none a view of the whole scene from the front, right and above.
    /// `world` holds the world matrix of each node.
    ///
    /// # Errors
    /// Where no camera is called `name`.
    pub fn default_camera_view(&self, name: Option<&str>, world: &[DMat4]) -> Result<CameraView, UnknownCamera> {
        let camera = match name {
            Some(name) => Some(self.cameras.iter().find(|camera| camera.name == name).ok_or_else(|| self.unknown_camera(name))?),
            None => self.cameras.first(),
        };
        Ok(match camera {
            Some(camera) => CameraView::from_node(&world[camera.node as usize], camera.projection),
            None => self.framed(world),
        })
    }

    fn unknown_camera(&self, name: &str) -> UnknownCamera {
        let names: Vec<String> = self.cameras.iter().map(|camera| format!("'{}'", camera.name)).collect();
        let known = if names.is_empty() { "none".into() } else { names.join(", ") };
        UnknownCamera { scene: self.name.clone(), name: name.into(), known }
    }

    /// The sphere around the bounds fills 45 degrees.
    fn framed(&self, world: &[DMat4]) -> CameraView {
        let (low, high) = self.bounds(world).unwrap_or((DVec3::NEG_ONE, DVec3::ONE));
        let (center, radius) = ((low + high) / 2.0, (high - low).length() / 2.0);
        let yfov = std::f32::consts::FRAC_PI_4;
        let distance = 0.95 * radius.max(f64::MIN_POSITIVE) / (f64::from(yfov) / 2.0).sin();
        CameraView::look_at(center + distance * DVec3::new(0.45, 0.35, 0.82), center, yfov)
    }

    /// Lowest and highest corner of all placed meshes in world space; none where nothing is placed.
    pub fn bounds(&self, world: &[DMat4]) -> Option<(DVec3, DVec3)> {
        let corners = self.instances.iter().flat_map(|instance| {
            let world = world[instance.node as usize];
            let positions = &self.meshes[instance.mesh as usize].positions;
            positions.iter().map(move |&position| world.transform_point3(Vec3::from(position).as_dvec3()))
        });
        corners.map(|corner| (corner, corner)).reduce(|(low, high), (corner, _)| (low.min(corner), high.max(corner)))
    }
}
