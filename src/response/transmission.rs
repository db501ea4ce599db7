//! Sound that passes through solids, on the straight way from the source to the listener and along the waves of the
//! late part.
//!
//! # Method
//! The line from the source to the listener is cut into its parts in solids, on the distances of the scene
//! (`geometry/chords.rs`). Solids in contact form a leaf. The length of the line in a leaf times the cosine of its
//! angle to the normal is the thickness, which for a plate does not depend on the angle. Materials in a leaf share the
//! thickness in proportion to the length of the line in each. A mesh whose faces have several materials is half of the
//! material where the line enters, and half of that where it leaves. A share τ of the energy passes a leaf:
//!
//! - With a density ρ and a thickness h, the mass per area is m″ = ρ h. The masses of all materials of a leaf are
//!   added. The mass law for random incidence is τ = 1 / (1 + (π f m″ / 1.8 ρ₀c₀)²).
//! - With a critical frequency f_c, sound above f_c passes by τ = 1 / ((π f m″ / ρ₀c₀)² · 2η f / (π f_c)), and R is
//!   interpolated on log f between f_c/2 and f_c (B. H. Sharp, *Prediction methods for the sound transmission of
//!   building elements*, Noise Control Engineering 11, 1978). The loss factor η is that of EN 12354-1:2000, annex C.
//! - A stated sound reduction index R gives τ = 10^(−R/10), with R increased by 20 lg(h / stated thickness).
//!
//! The shares of leaves with air between them are multiplied, which is valid above the resonance of the two masses on
//! the air.
//!
//! # Deviations
//! The thesis has no transmission. R is for random incidence at every angle. The line is not refracted.

use super::ResponseSettings;
use crate::bands::{BAND_COUNT, BANDS_HZ, Bands};
use crate::error::Error;
use crate::geometry::{Chord, ExactScene, SolidsAhead};
use crate::scene::{Exactness, Material, Pair, Scene, Transmission};
use crate::shader::Materials;
use crate::tracer::{FarEnd, SolidHit};
use glam::DVec3;
use std::f64::consts::PI;

/// Characteristic impedance of air in kg/(m² s), at 20 °C.
const IMPEDANCE: f64 = 415.0;

/// Ratio of the mass that gives the same reduction for random and for normal incidence (Sharp 1978): 5.1 dB.
const RANDOM_INCIDENCE: f64 = 1.8;

/// Internal loss factor of common building materials (EN 12354-1:2000, annex B).
const INTERNAL_LOSS: f64 = 0.01;

/// Loss at the edges of a wall, as loss factor × √Hz per kg/m² (EN 12354-1:2000, annex C: m″ / (485 √f)).
const EDGE_LOSS: f64 = 1.0 / 485.0;

/// Width of an air gap up to which solids are in contact, as a share of the length of the line. Coordinates are `f32`,
/// with errors of 6e-8 of their size.
const CONTACT: f64 = 1e-6;

/// Maximum ratio of a line's length in an irregular solid and the thickness. Where the surface is uneven, a line can
/// meet it at grazing angles on both sides of a solid that it passes upright. Solids of planes, and solids with exact
/// distances, are regular.
const MOST_OBLIQUE: f64 = 1.5;

/// Share of the energy below which a path through solids is left out: −100 dB. The paths around obstacles and over
/// reflections in a scene are louder.
const LEAST_SHARE: f64 = 1e-10;

/// Share of the energy in every band below which no wave of the late part passes a leaf: −40 dB.
const LEAST_LATE_SHARE: f64 = 1e-4;

/// The sound that passes straight through solids.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Transmitted {
    /// The share of the energy that passes, by band.
    pub share: Bands,
    /// The surfaces that the sound passes, in order, from 1.
    pub surfaces: Vec<u32>,
    /// The points at which it enters them, in world metres.
    pub points: Vec<DVec3>,
}

/// The sound that passes the solids between two points in the air. `None` without solids, if a solid transmits
/// nothing, or if the share of every band is less than `LEAST_SHARE`.
pub(super) fn through(
    scene: &Scene,
    exact: &ExactScene,
    ends: (DVec3, DVec3),
) -> Option<Transmitted> {
    let (source, listener) = ends;
    let (direction, length) = (listener - source).normalize_and_length();
    let chords = exact.chords(source, listener)?;
    let mut share = [1.0; BAND_COUNT];
    for leaf in leaves(&chords, CONTACT * length) {
        let passing = Leaf::of(scene, leaf)?.share();
        share = std::array::from_fn(|band| share[band] * passing[band]);
    }
    let is_heard = share.iter().any(|share| *share >= LEAST_SHARE);
    let enters = |chord: &Chord| source + direction * chord.enters_m;
    (is_heard && !chords.is_empty()).then(|| Transmitted {
        share,
        surfaces: chords.iter().map(|chord| chord.surface).collect(),
        points: chords.iter().map(enters).collect(),
    })
}

/// The solids that waves of the late part may pass; `None` without transmission, or if no solid of the scene transmits.
pub(super) fn solids(pair: Pair, settings: &ResponseSettings) -> Result<Option<ExactScene>, Error> {
    let any_transmits = || Materials::with_transmission(pair.scene, 0..BAND_COUNT).transmit();
    match settings.transmits() && any_transmits() {
        true => Ok(Some(ExactScene::new(pair)?)),
        false => Ok(None),
    }
}

/// The far end of the leaf that a wave of the late part hits. `None` if the leaf has no far side, if a solid of the
/// leaf transmits nothing, or if the share of every band is less than `LEAST_LATE_SHARE`.
///
/// A plate radiates at the point opposite the hit, so the way through the leaf is normal to the surface that is hit.
/// All energy that enters one side of a plate then leaves the other side, also next to its edges. If the wave does not
/// point out of the leaf at the opposite point, the way through the leaf has the wave's direction.
///
/// The sound that leaves through a wall is part of the absorption of the wall's material. The share is therefore at
/// most the smaller absorption of the two sides. The leaf then creates no energy, and transmits the same share in both
/// directions.
pub(super) fn of_wave(scene: &Scene, exact: &ExactScene, hit: &SolidHit) -> Option<FarEnd> {
    let ahead = opposite(exact, hit).or_else(|| {
        let ahead = exact.solids_ahead(hit.point, hit.direction)?;
        Way::new(ahead, hit.direction)
    })?;
    let Way {
        chords,
        exit,
        point,
    } = ahead;
    let passing = Leaf::of(scene, &chords)?.share();
    let entry = chords.iter().find(|chord| chord.surface == hit.surface);
    let [entered, left] = [
        entry.and_then(|entry| materials(scene, entry)[0]),
        materials(scene, &exit)[1],
    ];
    let sides = [entered, left]
        .map(|material| material.map_or([0.0; BAND_COUNT], |material| material.absorption));
    let share = std::array::from_fn(|band| passing[band].min(sides[0][band]).min(sides[1][band]));
    let is_heard = share.iter().any(|share| *share >= LEAST_LATE_SHARE);
    is_heard.then(|| FarEnd {
        surface: exit.surface,
        point,
        length_m: hit.point.distance(point),
        share,
    })
}

/// A straight way through a leaf.
struct Way {
    chords: Vec<Chord>,
    /// The part that ends where it leaves the leaf.
    exit: Chord,
    /// The point at which it leaves the leaf.
    point: DVec3,
}

impl Way {
    /// `None` without solids.
    fn new(ahead: SolidsAhead, direction: DVec3) -> Option<Way> {
        let SolidsAhead { chords, start } = ahead;
        let later = |a: &&Chord, b: &&Chord| a.leaves_m.total_cmp(&b.leaves_m);
        let exit = *chords.iter().max_by(later)?;
        Some(Way {
            chords,
            exit,
            point: start + direction * exit.leaves_m,
        })
    }
}

/// The way through the leaf normal to the surface that is hit; `None` if the wave does not point out of the leaf at the
/// end of this way.
fn opposite(exact: &ExactScene, hit: &SolidHit) -> Option<Way> {
    let inward = -exact.outward(hit.surface, hit.point)?;
    let way = Way::new(exact.solids_ahead(hit.point, inward)?, inward)?;
    let outward = exact.outward(way.exit.surface, way.point)?;
    (outward.dot(hit.direction) > 0.0).then_some(way)
}

/// Groups parts of a line that are in contact, or overlap: gaps up to `contact_m` metres are closed. The parts are in
/// order of their starts.
fn leaves(chords: &[Chord], contact_m: f64) -> Vec<&[Chord]> {
    let mut leaves = Vec::new();
    let mut first = 0;
    let mut leaves_m = f64::NEG_INFINITY;
    for (index, chord) in chords.iter().enumerate() {
        if chord.enters_m > leaves_m + contact_m && index > 0 {
            leaves.push(&chords[first..index]);
            first = index;
        }
        leaves_m = leaves_m.max(chord.leaves_m);
    }
    if first < chords.len() {
        leaves.push(&chords[first..]);
    }
    leaves
}

/// The materials of the faces at which a line enters and leaves a solid.
fn materials(scene: &Scene, chord: &Chord) -> [Option<Material>; 2] {
    let index = chord.surface as usize - 1;
    chord.groups.map(|group| scene.material(index, group))
}

/// Solids in contact. If the materials where the line enters a solid and leaves it differ, and one of them has a stated
/// reduction, which is that of a whole wall, the reduction of the leaf is the mean of those with the one and with the
/// other material throughout the solid. Two materials with densities have half of its thickness each.
struct Leaf([Layers; 2]);

/// The thickness of each material of a leaf in metres.
#[derive(Default)]
struct Layers(Vec<(Transmission, f64)>);

impl Leaf {
    /// The materials of parts of a line in contact; `None` if one of them transmits nothing.
    fn of(scene: &Scene, chords: &[Chord]) -> Option<Leaf> {
        let thickness_per_length = thickness_per_length(scene, chords);
        let mut sides = [Layers::default(), Layers::default()];
        let mut until = f64::NEG_INFINITY;
        let is_stated = |of: &Transmission| matches!(of, Transmission::Reduction { .. });
        for chord in chords {
            // Two solids that overlap count once, as the first of them.
            let length_m = (chord.leaves_m - chord.enters_m.max(until)).max(0.0);
            until = until.max(chord.leaves_m);
            let thickness_m = length_m * thickness_per_length;
            let [entered, left] = materials(scene, chord);
            let faces = [entered?.transmission?, left?.transmission?];
            let are_layers = faces[0] == faces[1] || !faces.iter().any(is_stated);
            for (layers, face) in sides.iter_mut().zip(faces) {
                for half in if are_layers { faces } else { [face; 2] } {
                    layers.add(half, 0.5 * thickness_m);
                }
            }
        }
        Some(Leaf(sides))
    }

    /// The share of the energy that passes, by band.
    fn share(&self) -> Bands {
        let [one, other] = self.0.each_ref().map(Layers::reduction_db);
        std::array::from_fn(|band| 10_f64.powf(-0.05 * (one[band] + other[band])))
    }
}

impl Layers {
    fn add(&mut self, material: Transmission, thickness_m: f64) {
        match self.0.iter_mut().find(|(known, _)| *known == material) {
            Some((_, thickness)) => *thickness += thickness_m,
            None => self.0.push((material, thickness_m)),
        }
    }

    /// The reduction by band in decibels.
    fn reduction_db(&self) -> Bands {
        let mass = self.mass();
        std::array::from_fn(|band| mass.reduction_db(BANDS_HZ[band]) + self.stated_db(band))
    }

    /// The sum of the stated reductions in a band, in decibels.
    fn stated_db(&self, band: usize) -> f64 {
        let stated = |(transmission, thickness): &(Transmission, f64)| match transmission {
            Transmission::Reduction {
                index_db,
                thickness_m,
            } => (index_db[band] + 20.0 * (thickness / thickness_m).log10()).max(0.0),
            _ => 0.0,
        };
        self.0.iter().map(stated).sum()
    }

    /// All layers with a density as one plate. The heaviest layer determines the critical frequency.
    fn mass(&self) -> Plate {
        let mut plate = Plate {
            mass: 0.0,
            critical_hz: None,
        };
        let mut heaviest = 0.0;
        for (transmission, thickness_m) in &self.0 {
            let Transmission::Mass {
                density,
                coincidence,
            } = transmission
            else {
                continue;
            };
            let mass = density * thickness_m;
            plate.mass += mass;
            if mass > heaviest {
                heaviest = mass;
                plate.critical_hz = coincidence.map(|product| product / thickness_m);
            }
        }
        plate
    }
}

/// The thickness of a leaf per metre of the line in it: the greater cosine of the angles at which the line enters and
/// leaves the leaf, in an irregular solid at least 1 / `MOST_OBLIQUE`.
fn thickness_per_length(scene: &Scene, chords: &[Chord]) -> f64 {
    let enters = chords.first().map_or(1.0, |chord| chord.cosines[0]);
    let last = chords
        .iter()
        .max_by(|a, b| a.leaves_m.total_cmp(&b.leaves_m));
    let leaves = last.map_or(1.0, |chord| chord.cosines[1]);
    let is_regular = |chord: &Chord| {
        let shape = &scene.surfaces[chord.surface as usize - 1].shape;
        shape.has_planes_alone() || shape.properties().in_solid == Exactness::Exact
    };
    let least = match chords.iter().all(is_regular) {
        true => 0.0,
        false => 1.0 / MOST_OBLIQUE,
    };
    enters.max(leaves).max(least)
}

/// A plate that sound sets in motion.
struct Plate {
    /// Mass per area in kg/m².
    mass: f64,
    /// Critical frequency in hertz.
    critical_hz: Option<f64>,
}

impl Plate {
    /// Sound reduction index at a frequency, in decibels.
    fn reduction_db(&self, hertz: f64) -> f64 {
        let Some(critical_hz) = self.critical_hz else {
            return self.mass_law_db(hertz);
        };
        let low_hz = 0.5 * critical_hz;
        if hertz <= low_hz {
            return self.mass_law_db(hertz);
        }
        if hertz >= critical_hz {
            return self.above_critical_db(hertz, critical_hz);
        }
        let (low, high) = (
            self.mass_law_db(low_hz),
            self.above_critical_db(critical_hz, critical_hz),
        );
        low + (high - low) * (hertz / low_hz).log2()
    }

    /// The mass law for random incidence.
    fn mass_law_db(&self, hertz: f64) -> f64 {
        decibels(1.0 + (self.impedance_ratio(hertz) / RANDOM_INCIDENCE).powi(2))
    }

    /// The reduction at and above the critical frequency, at most that of the mass law for normal incidence.
    fn above_critical_db(&self, hertz: f64, critical_hz: f64) -> f64 {
        let loss = INTERNAL_LOSS + EDGE_LOSS * self.mass / hertz.sqrt();
        let resonant = (2.0 * loss * hertz / (PI * critical_hz)).min(1.0);
        decibels((self.impedance_ratio(hertz).powi(2) * resonant).max(1.0))
    }

    /// Half the ratio of the impedance of the mass and that of air.
    fn impedance_ratio(&self, hertz: f64) -> f64 {
        PI * hertz * self.mass / IMPEDANCE
    }
}

fn decibels(ratio: f64) -> f64 {
    10.0 * ratio.log10()
}

#[cfg(test)]
mod late_tests;
#[cfg(test)]
mod tests;
