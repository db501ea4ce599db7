//! Detectors: the spheres in which the crossings of waves are counted. All detectors of a source share its waves.

use super::volume::{Limits, NO_LIMITS, open_volume};
use crate::scene::{Listener, Scene};
use glam::Vec3;

/// Maximum number of detectors of a pass. Each has one to six vectors among the uniforms.
pub(crate) const MOST_DETECTORS: usize = 64;

/// Maximum number of detectors if the driver has no more than the 224 uniform vectors that OpenGL ES guarantees.
const FEW_DETECTORS: usize = 8;

/// Number of uniform vectors from which on a pass has [`MOST_DETECTORS`].
const ENOUGH_VECTORS: u32 = 1024;

/// A sphere in which crossings are counted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Detector {
    /// The centre in world metres.
    pub position: Vec3,
    /// Radius in metres.
    pub radius: f32,
    /// Radius in metres of a sphere about the same centre in which the energy is counted too
    /// ([`Arrival::inner`](crate::response::Arrival)).
    pub inner_radius: Option<f32>,
    /// Planes in front of which the crossings are counted. They keep the sphere from reaching behind obstacles.
    pub limits: Limits,
}

/// The open volumes of a detector's spheres, in m³.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OpenVolumes {
    pub whole: f64,
    /// The volume of the inner sphere, if there is one.
    pub inner: Option<f64>,
}

impl Detector {
    /// The listener's own sphere.
    pub fn of(listener: &Listener) -> Detector {
        Detector {
            position: listener.position,
            radius: listener.radius,
            inner_radius: None,
            limits: NO_LIMITS,
        }
    }

    /// The volumes of the spheres outside solids and in front of the limits.
    pub fn open_volumes(&self, scene: &Scene) -> OpenVolumes {
        let of = |radius| open_volume(scene, (self.position, &self.limits), radius);
        OpenVolumes {
            whole: of(self.radius),
            inner: self.inner_radius.map(of),
        }
    }
}

/// Maximum number of detectors of a pass with this number of uniform vectors.
pub(crate) fn most_detectors(uniform_vectors: u32) -> usize {
    match uniform_vectors >= ENOUGH_VECTORS {
        true => MOST_DETECTORS,
        false => FEW_DETECTORS,
    }
}

/// Maximum number of detectors of the program that a pass with this number of detectors uses.
pub(crate) fn compiled_detectors(detectors: usize) -> u32 {
    let compiled = match detectors {
        0 | 1 => 1,
        2..=FEW_DETECTORS => FEW_DETECTORS,
        _ => MOST_DETECTORS,
    };
    compiled as u32
}
