//! The sound at the listener: the medium between source and listener, the reflectance of the surfaces along an exact
//! path, the sound along such a path, and summaries of a source's sound.

use super::Response;
use crate::bands::{self, BAND_COUNT, Bands};
use crate::response::exact_paths::SpecularPath;
use crate::response::{Arrival, Echogram, Figures, Tap};
use crate::scene::{Listener, Material, Pair, Scene};
use crate::shader::common_scattering;
use glam::{DVec3, Vec3};
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;
use std::ops::Range;

/// The properties of the sound's way between source and listener, without the surfaces.
pub(super) struct Medium {
    /// Speed of sound in metres per second.
    pub speed: f64,
    /// Attenuation of energy by band, in 1/m.
    pub air: Bands,
    /// The source's level as a factor of energy.
    pub level: f64,
    /// Arrival time of the direct sound if unobstructed, in seconds.
    pub direct_s: f64,
}

impl Medium {
    pub fn of(pair: Pair) -> Medium {
        let speed = pair.scene.speed_of_sound();
        let apart = pair.source.position.as_dvec3() - pair.listener.position.as_dvec3();
        Medium {
            speed,
            air: pair.scene.air_attenuation(),
            level: 10_f64.powf(f64::from(pair.source.level_db) / 10.0),
            direct_s: apart.length() / speed,
        }
    }

    /// The energy of an arrival, with the source's level and the loss in the air.
    pub fn heard(&self, arrival: &Arrival) -> Bands {
        let emitted = arrival.energy.map(|energy| energy * self.level);
        bands::through_air(&emitted, &self.air, arrival.length_m)
    }

    /// Adds an arrival, with the source's level and the loss in the air. Ignores an arrival with invalid numbers, which
    /// a faulty driver can cause.
    pub fn add(&self, echogram: &mut Echogram, arrival: &Arrival) {
        let mut arrival = *arrival;
        arrival.energy = arrival.energy.map(|energy| energy * self.level);
        // Only invalid numbers cause an error.
        let _ = echogram.add_arrival(&arrival, self.speed, &self.air);
    }
}

/// The energy that leaves along a path, relative to an omnidirectional source, times the share that all surfaces of the
/// path reflect specularly, by band.
pub(super) fn radiated_along(pair: Pair, path: &SpecularPath) -> Bands {
    let at: Vec<(u32, Option<u8>)> = reflections(path).collect();
    let (radiated, reflected) = (
        pair.source.factor(path.departure),
        reflectance(pair.scene, &at),
    );
    std::array::from_fn(|band| radiated[band] * reflected[band])
}

/// The share of the energy that these surfaces and walls reflect specularly, by band.
pub(super) fn reflectance(scene: &Scene, at: &[(u32, Option<u8>)]) -> Bands {
    along(scene, at.iter().copied(), |material, band| {
        (1.0 - material.absorption[band]) * (1.0 - material.scattering[band])
    })
}

/// The surfaces and walls that reflect a path.
pub(super) fn reflections(path: &SpecularPath) -> impl Iterator<Item = (u32, Option<u8>)> {
    path.surfaces
        .iter()
        .copied()
        .zip(path.walls.iter().copied())
}

/// The share of waves of early arrivals not scattered at these surfaces and walls, averaged over the bands; `groups` are
/// their groups of bands. The waves of a group scatter with the common share of the group.
pub(super) fn mirrored_share(
    scene: &Scene,
    groups: &[Range<usize>],
    at: impl Iterator<Item = (u32, Option<u8>)>,
) -> f64 {
    let mirrored = |material: &Material, band: usize| {
        let group = groups.iter().find(|group| group.contains(&band));
        let scattered = group.map(|group| common_scattering(material, group));
        1.0 - scattered.unwrap_or(material.scattering[band])
    };
    bands::mean(&along(scene, at, mirrored))
}

/// Expected number of waves of early arrivals, out of `waves` in each of the groups of bands, that cross a listener of
/// this radius along a path.
pub(super) fn passing(
    scene: &Scene,
    groups: &[Range<usize>],
    path: &SpecularPath,
    (radius_m, waves): (f64, u32),
) -> f64 {
    let mirrored = path.spreading * mirrored_share(scene, groups, reflections(path));
    crossing(mirrored, radius_m, waves)
}

/// Expected number of waves, out of `waves`, that cross a listener of this radius at a place where all waves together
/// have the energy density `spreading`.
pub(super) fn crossing(spreading: f64, radius_m: f64, waves: u32) -> f64 {
    f64::from(waves) * PI * radius_m * radius_m * spreading
}

/// The product of a property over the materials of these surfaces and walls, by band.
fn along(
    scene: &Scene,
    at: impl Iterator<Item = (u32, Option<u8>)>,
    left: impl Fn(&Material, usize) -> f64,
) -> Bands {
    let mut all = [1.0; BAND_COUNT];
    for (surface, wall) in at {
        let index = surface as usize - 1;
        let Some(material) = scene.material(index, wall.map(usize::from)) else {
            continue;
        };
        for (band, all) in all.iter_mut().enumerate() {
            *all *= left(&material, band);
        }
    }
    all
}

/// The way in which a path leads from the source to the listener.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum PathKind {
    /// In a straight line through the air.
    Direct,
    /// Over reflections.
    Mirrored,
    /// Around obstacles: the path's points lie on their edges, and on the faces at which it is also reflected.
    Diffracted,
    /// In a straight line through solids: the path's points are those at which it enters them.
    Transmitted,
    /// Along the strongest other path, or in a straight line if there is none. The energy is not computed from the
    /// scene, but raises the source to the least level ([`ResponseSettings::least_level_db`]).
    ///
    /// [`ResponseSettings::least_level_db`]: super::ResponseSettings::least_level_db
    Added,
}

impl PathKind {
    /// All kinds.
    pub const ALL: [PathKind; 5] = [
        PathKind::Direct,
        PathKind::Mirrored,
        PathKind::Diffracted,
        PathKind::Transmitted,
        PathKind::Added,
    ];

    /// The name of the kind in lower case, as serialised.
    pub fn name(self) -> &'static str {
        match self {
            PathKind::Direct => "direct",
            PathKind::Mirrored => "mirrored",
            PathKind::Diffracted => "diffracted",
            PathKind::Transmitted => "transmitted",
            PathKind::Added => "added",
        }
    }
}

/// An exact path from source to listener, and the sound along it.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[non_exhaustive]
pub struct HeardPath {
    /// Whether the path is straight, mirrored, diffracted or transmitted.
    pub kind: PathKind,
    /// The path's geometry.
    pub path: SpecularPath,
    /// Indices of the path's points at which it is reflected. At the other points it bends, or enters a solid.
    #[serde(default)]
    pub reflections: Vec<usize>,
    /// Seconds from the source's impulse to its arrival.
    pub delay_s: f64,
    /// Energy density at the listener by band, in 1/m² for a source of power 1, including the
    /// losses at the surfaces and in the air, and the source's level and directivity.
    pub energy: Bands,
    /// Energy of the path's samples in an impulse response, as a multiple of `energy`, by band. It is 1 except for
    /// diffracted paths around the same obstacle. Their energies contain their interference, which their samples add
    /// again by their delays.
    #[serde(default = "as_energy")]
    pub in_samples: Bands,
    /// Half-widths in decibels, by band, of the intervals that contain 95 % of the errors of a level that edges
    /// change, as measured on wedges, round bodies, bars and a doorway. 0 for other paths, whose energies are exact in the
    /// model.
    #[serde(default)]
    pub errors_db: Bands,
    /// Azimuth of the direction that the sound comes from, to the right of the listener's viewing direction, in radians
    /// from −π to π.
    pub azimuth: f64,
    /// Elevation of the direction that the sound comes from, above the plane of the listener's ears, in radians.
    pub elevation: f64,
}

impl HeardPath {
    /// Whether this path is the direct sound.
    pub fn is_direct(&self) -> bool {
        self.kind == PathKind::Direct
    }

    /// The path as a tap of an impulse response.
    pub fn tap(&self) -> Tap {
        Tap {
            energy: std::array::from_fn(|band| self.energy[band] * self.in_samples[band]),
            ..self.tap_of_energy()
        }
    }

    /// The path as a tap of an echogram, for figures.
    pub(crate) fn tap_of_energy(&self) -> Tap {
        Tap {
            seconds: self.delay_s,
            energy: self.energy,
            direction: self.path.arrival_direction,
        }
    }
}

/// The default of [`HeardPath::in_samples`].
fn as_energy() -> Bands {
    [1.0; BAND_COUNT]
}

/// Azimuth and elevation of a direction in radians: azimuth to the right of the viewing direction. 0 for the zero
/// vector.
pub(super) fn comes_from(listener: &Listener, towards: DVec3) -> (f64, f64) {
    let along = |axis: Vec3| axis.as_dvec3().dot(towards);
    let (right, up, ahead) = (
        along(listener.right()),
        along(listener.up()),
        along(listener.forward()),
    );
    (right.atan2(ahead), up.atan2(right.hypot(ahead)))
}

/// A summary of a source's sound at the listener: level, delay and mean direction.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[non_exhaustive]
pub struct Level {
    /// Strength *G* of all energy, averaged over the bands, in decibels relative to the same source at 10 m in the
    /// open, without its `level_db`.
    pub g_db: f64,
    /// Arrival time of the first sound, in seconds after the source's impulse: exact if it arrives along an exact path,
    /// otherwise accurate to a bin of the echogram.
    pub delay_s: f64,
    /// Azimuth of the mean direction that the energy comes from, to the right of the listener's viewing direction, in
    /// radians from −π to π. The mean direction is the sum of energy × direction over all arrivals.
    pub azimuth: f64,
    /// Elevation of the mean direction above the plane of the listener's ears, in radians.
    pub elevation: f64,
    /// Directionality of the sound, 0 to 1: the length of the sum of energy × direction, divided by the total energy. 1
    /// means that all sound comes from one direction, 0 that no direction is preferred.
    pub one_sided: f64,
}

impl Response {
    /// Level, delay and direction of the source's sound at `listener`, which must be the traced listener; `None`
    /// without arrivals.
    pub fn level(&self, listener: &Listener) -> Option<Level> {
        let g_db = Figures::strength_db(bands::mean(&self.energy()))?;
        let delay_s = self.figures.begins_s?;
        let flow = self.flow();
        let (azimuth, elevation) = comes_from(listener, -flow);
        let energy: f64 = self.energy().iter().sum();
        Some(Level {
            g_db,
            delay_s,
            azimuth,
            elevation,
            one_sided: (flow.length() / energy).min(1.0),
        })
    }

    /// Energy × direction of flight, summed over all arrivals and bands, in 1/m².
    fn flow(&self) -> DVec3 {
        let paths = self.paths.iter();
        let exact: DVec3 = paths
            .map(|path| path.path.arrival_direction * path.energy.iter().sum::<f64>())
            .sum();
        let bins = 0..self.echogram.bins();
        let late: DVec3 = bins.flat_map(|bin| self.echogram.flow(bin)).sum();
        exact + late
    }
}
