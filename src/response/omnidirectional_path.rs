//! The sound along a path whose energy at the listener is known without the source's radiation and the loss in the air.

use super::diffraction::DiffractedPath;
use super::source_sound::{HeardPath, Medium, PathKind, comes_from, reflectance};
use crate::bands::{self, BAND_COUNT, Bands};
use crate::response::exact_paths::SpecularPath;
use crate::scene::{Pair, Scene};
use glam::DVec3;
use std::f64::consts::PI;

/// Energy density in 1/m² at a distance in metres from a source of power 1.
fn spreading(length_m: f64) -> f64 {
    1.0 / (4.0 * PI * length_m * length_m)
}

/// A path of an omnidirectional source of power 1, without the loss in the air.
pub(super) struct Path {
    pub kind: PathKind,
    pub points: Vec<DVec3>,
    pub surfaces: Vec<u32>,
    /// Indices of the points at which it is reflected.
    pub reflections: Vec<usize>,
    /// The walls of rooms at which it is reflected.
    pub walls: Vec<Option<u8>>,
    pub length_m: f64,
    pub departure: DVec3,
    pub arrival_direction: DVec3,
    /// Energy density at the listener by band, in 1/m².
    pub energy: Bands,
    pub errors_db: Bands,
}

impl From<DiffractedPath> for Path {
    fn from(path: DiffractedPath) -> Path {
        Path {
            kind: PathKind::Diffracted,
            walls: vec![None; path.surfaces.len()],
            reflections: path.reflections,
            points: path.points,
            surfaces: path.surfaces,
            length_m: path.length_m,
            departure: path.departure,
            arrival_direction: path.arrival_direction,
            energy: path.energy,
            errors_db: path.errors_db,
        }
    }
}

impl Path {
    /// The straight path between two points in the open; `None` if they coincide.
    pub fn straight(kind: PathKind, (source, listener): (DVec3, DVec3)) -> Option<Path> {
        let way = listener - source;
        let (direction, length_m) = (way.try_normalize()?, way.length());
        Some(Path {
            kind,
            points: Vec::new(),
            surfaces: Vec::new(),
            reflections: Vec::new(),
            walls: Vec::new(),
            length_m,
            departure: direction,
            arrival_direction: direction,
            energy: [spreading(length_m); BAND_COUNT],
            errors_db: [0.0; BAND_COUNT],
        })
    }

    /// A diffracted path with reflections at one face; `wall` is the face's wall of a room.
    pub fn reflected(path: DiffractedPath, scene: &Scene, wall: Option<u8>) -> Path {
        let mut path = Path::from(path);
        for &point in &path.reflections {
            path.walls[point] = wall;
            let reflected = reflectance(scene, &[(path.surfaces[point], wall)]);
            path.energy = std::array::from_fn(|band| path.energy[band] * reflected[band]);
        }
        path
    }

    /// The sound along the path, with the source's level and directivity, and the loss in the air.
    pub fn heard(self, pair: Pair, medium: &Medium) -> HeardPath {
        let radiated = pair.source.factor(self.departure);
        let emitted = std::array::from_fn(|band| self.energy[band] * radiated[band] * medium.level);
        let (azimuth, elevation) = comes_from(pair.listener, -self.arrival_direction);
        let length_m = self.length_m;
        HeardPath {
            kind: self.kind,
            reflections: self.reflections,
            path: SpecularPath {
                walls: self.walls,
                surfaces: self.surfaces,
                points: self.points,
                length_m,
                departure: self.departure,
                arrival_direction: self.arrival_direction,
                spreading: spreading(length_m),
                is_focus: false,
                found_by: 0,
                is_searched: true,
            },
            delay_s: length_m / medium.speed,
            energy: bands::through_air(&emitted, &medium.air, length_m),
            in_samples: [1.0; BAND_COUNT],
            errors_db: self.errors_db,
            azimuth,
            elevation,
        }
    }
}
