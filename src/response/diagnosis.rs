//! Diagnosis of figures: the reasons for missing figures, and flutter echoes that lengthen decays.
//!
//! A flutter echo between two parallel walls lasts longer than sound in a diffuse field. It is detected only in a scene
//! that consists of one [`Room`] or of the complement of one box, because the volume and the walls of other scenes are
//! unknown.

use crate::bands::BAND_COUNT;
use crate::response::figures::FIGURE_COUNT;
use crate::response::{BandFigures, Figures};
use crate::scene::shape::{Cuboid, Room};
use crate::scene::{Material, Node, Scene, Shape};
use glam::Vec3;
use std::f64::consts::LN_10;

/// Reason why figures of a band are missing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Gap {
    /// Nothing arrives in this band.
    Silence,
    /// The response ends before its sound has decayed.
    TooShort,
    /// Sound arrives only early, without reverberation, so there is no clarity figure.
    NoLateSound,
    /// Sound decays, but there are too few waves to estimate the decay.
    TooNoisy,
    /// Nothing arrives, because the source or the listener is in a solid. The space outside a room is solid too.
    InSolid,
}

impl Gap {
    /// All reasons, in the order of reporting.
    pub const ALL: [Gap; 5] = [
        Gap::Silence,
        Gap::TooShort,
        Gap::NoLateSound,
        Gap::TooNoisy,
        Gap::InSolid,
    ];

    /// The reason why figures of a band are missing or inexact; `None` if all its decay times are present. `is_heard`
    /// states whether any sound arrives in the band.
    pub fn of(figures: &Figures, band: usize, is_heard: bool) -> Option<Gap> {
        match is_heard {
            true => {
                let mut withheld = (0..FIGURE_COUNT).map(|figure| figures.withheld(band, figure));
                let is_withheld = withheld.any(|withheld| withheld.is_some());
                Gap::of_band(&figures.bands[band], figures.cut_off[band], is_withheld)
            }
            false => Some(Gap::Silence),
        }
    }

    fn of_band(figures: &BandFigures, cut_off: Option<f64>, is_withheld: bool) -> Option<Gap> {
        if cut_off.is_none_or(|share| share > Figures::most_cut_off()) {
            return Some(Gap::TooShort);
        }
        let times = [figures.edt_s, figures.t20_s, figures.t30_s];
        if times.iter().all(Option::is_some) && !is_withheld {
            return None;
        }
        match figures.c80_db {
            None if !is_withheld => Some(Gap::NoLateSound),
            _ => Some(Gap::TooNoisy),
        }
    }

    /// The reason in a few words.
    pub fn words(self) -> &'static str {
        match self {
            Gap::Silence => "nothing arrives",
            Gap::TooShort => "record too short",
            Gap::NoLateSound => "no late sound",
            Gap::TooNoisy => "too noisy",
            Gap::InSolid => "in a solid or outside the room",
        }
    }

    /// The code of the reason in tables: from 1 in the order of [`Gap::ALL`].
    pub fn code(self) -> u64 {
        Gap::ALL
            .iter()
            .position(|gap| *gap == self)
            .map_or(0, |at| at as u64 + 1)
    }

    /// The reason with this code; `None` for 0 and for unknown codes.
    pub fn of_code(code: u64) -> Option<Gap> {
        Gap::ALL.into_iter().find(|gap| gap.code() == code)
    }
}

/// A T30 above this multiple of Eyring's time is reported: uneven absorption alone lengthens T30 by only about ten per
/// cent.
const MOST_TIMES_EYRING: f64 = 1.5;

/// ln of 60 dB as a ratio of energies.
const LN_OF_60_DB: f64 = 6.0 * LN_10;

/// Two parallel walls with a flutter echo.
#[derive(Clone, Debug, PartialEq)]
pub struct Flutter {
    /// The numbers of the walls in the order of [`Room::WALL_NAMES`](crate::scene::shape::Room::WALL_NAMES).
    pub walls: [usize; 2],
    /// The bands whose decay the flutter echo determines.
    pub bands: Vec<FlutterBand>,
    /// Whether no wall of the room scatters in these bands.
    pub nothing_scatters: bool,
}

/// A band that decays more slowly than in a diffuse field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlutterBand {
    /// Number of the band, from 0.
    pub band: usize,
    /// T30 of the response, in seconds.
    pub t30_s: f64,
    /// The reverberation time by Eyring's formula, for a diffuse field, in seconds.
    pub eyring_s: f64,
}

/// The pairs of walls that cause T30 above `MOST_TIMES_EYRING` times Eyring's time. `t30_s` contains T30 by band, in
/// seconds.
pub fn flutters(scene: &Scene, t30_s: [Option<f64>; BAND_COUNT]) -> Vec<Flutter> {
    let Some(room) = EmptyRoom::of(scene) else {
        return Vec::new();
    };
    let mut found: Vec<Flutter> = Vec::new();
    for (band, t30_s) in t30_s.into_iter().enumerate() {
        let Some(t30_s) = t30_s else {
            continue;
        };
        let limit_s = MOST_TIMES_EYRING * room.eyring_s(band);
        let (axis, lasts_s) = room.longest_flutter(band);
        // A flutter echo that lasts no longer than the limit does not explain a long T30.
        if t30_s <= limit_s || lasts_s <= limit_s {
            continue;
        }
        let walls = [2 * axis, 2 * axis + 1];
        let nothing_scatters = room.nothing_scatters(band);
        let of_band = FlutterBand {
            band,
            t30_s,
            eyring_s: room.eyring_s(band),
        };
        let is_alike = |known: &&mut Flutter| {
            known.walls == walls && known.nothing_scatters == nothing_scatters
        };
        match found.iter_mut().find(is_alike) {
            Some(known) => known.bands.push(of_band),
            None => found.push(Flutter {
                walls,
                bands: vec![of_band],
                nothing_scatters,
            }),
        }
    }
    found
}

/// The full size in metres of a box, which may be moved and rotated; `None` for other shapes.
fn box_size(shape: &Shape) -> Option<Vec3> {
    match &shape.node {
        Node::Cuboid(Cuboid { size }) => Some(*size),
        Node::Translate(_) | Node::Rotate(_) => box_size(shape.children.first()?),
        _ => None,
    }
}

/// A scene that consists of one room: a `Room`, or the complement of a box.
struct EmptyRoom<'a> {
    scene: &'a Scene,
    /// Full size in metres.
    size: [f64; 3],
}

impl EmptyRoom<'_> {
    fn of(scene: &Scene) -> Option<EmptyRoom<'_>> {
        let [surface] = &scene.surfaces[..] else {
            return None;
        };
        let size = match &surface.shape.node {
            Node::Room(Room { size }) => *size,
            Node::Complement(_) => box_size(surface.shape.children.first()?)?,
            _ => return None,
        };
        let size = size.as_dvec3().to_array();
        Some(EmptyRoom { scene, size })
    }

    fn volume(&self) -> f64 {
        self.size.iter().product()
    }

    /// Area of a wall in square metres.
    fn area(&self, wall: usize) -> f64 {
        self.volume() / self.size[wall / 2]
    }

    /// A property of a wall's material in a band; 0 without a material.
    fn of_wall(&self, wall: usize, property: impl Fn(&Material) -> f64) -> f64 {
        self.scene
            .material(0, Some(wall))
            .map_or(0.0, |material| property(&material))
    }

    /// T = 24 ln 10 V / (c (4 m V − S ln(1 − ᾱ))) (Eyring 1930; Kuttruff, *Room Acoustics*,
    /// section 5.1).
    fn eyring_s(&self, band: usize) -> f64 {
        let walls = 0..6;
        let surface: f64 = walls.clone().map(|wall| self.area(wall)).sum();
        let absorbed =
            walls.map(|wall| self.area(wall) * self.of_wall(wall, |m| m.absorption[band]));
        let mean = absorbed.sum::<f64>() / surface;
        let air = self.scene.air_attenuation()[band];
        let lost = 4.0 * air * self.volume() - surface * (1.0 - mean).ln();
        4.0 * LN_OF_60_DB * self.volume() / (self.scene.speed_of_sound() * lost)
    }

    /// The axis along which a flutter echo lasts longest, and the time in which this echo decays by 60 dB. Each round
    /// trip multiplies the energy by the reflected shares of both walls.
    fn longest_flutter(&self, band: usize) -> (usize, f64) {
        let air = self.scene.air_attenuation()[band];
        let seconds = |axis: usize| {
            let lost = |wall: usize| {
                let absorbed = self.of_wall(wall, |m| m.absorption[band]);
                let mirrored = 1.0 - self.of_wall(wall, |m| m.scattering[band]);
                -((1.0 - absorbed) * mirrored).ln()
            };
            let way = 2.0 * self.size[axis];
            let lost = lost(2 * axis) + lost(2 * axis + 1) + way * air;
            LN_OF_60_DB * way / (self.scene.speed_of_sound() * lost)
        };
        let axes = (0..3).map(|axis| (axis, seconds(axis)));
        let longer = |a: (usize, f64), b: (usize, f64)| if b.1 > a.1 { b } else { a };
        axes.fold((0, 0.0), longer)
    }

    fn nothing_scatters(&self, band: usize) -> bool {
        (0..6).all(|wall| self.of_wall(wall, |m| m.scattering[band]) == 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Listener, Source, Surface};

    /// Protects the reasons: each follows from the missing figures, and complete figures have none.
    #[test]
    fn each_missing_figure_has_its_reason() {
        let whole = BandFigures {
            edt_s: Some(1.0),
            t20_s: Some(1.0),
            t30_s: Some(1.0),
            c80_db: Some(3.0),
            ..BandFigures::default()
        };
        let noisy = BandFigures {
            t30_s: None,
            ..whole
        };
        let dry = BandFigures::default();
        assert_eq!(Gap::of_band(&whole, Some(0.0), false), None);
        assert_eq!(Gap::of_band(&noisy, Some(0.0), false), Some(Gap::TooNoisy));
        assert_eq!(Gap::of_band(&dry, Some(0.0), false), Some(Gap::NoLateSound));
        assert_eq!(Gap::of_band(&dry, Some(0.0), true), Some(Gap::TooNoisy));
        // At −40 dB a record ends too early for T30, and early enough for all other figures.
        assert_eq!(Gap::of_band(&noisy, Some(1e-4), false), Some(Gap::TooShort));
        assert_eq!(Gap::of_band(&noisy, Some(1e-5), false), Some(Gap::TooNoisy));
        for figures in [whole, noisy, dry] {
            assert_eq!(Gap::of_band(&figures, None, false), Some(Gap::TooShort));
            assert_eq!(
                Gap::of_band(&figures, Some(0.002), false),
                Some(Gap::TooShort)
            );
        }
    }

    /// Protects tables: each code stands for one reason.
    #[test]
    fn codes_mean_reasons() {
        for gap in Gap::ALL {
            assert_eq!(Gap::of_code(gap.code()), Some(gap));
        }
        assert_eq!(Gap::ALL.map(Gap::code), [1, 2, 3, 4, 5]);
        assert_eq!((Gap::of_code(0), Gap::of_code(6)), (None, None));
    }

    fn room(scattering: f32) -> Scene {
        let room = Room {
            size: Vec3::new(6.0, 3.0, 5.0),
        };
        let surface = Surface::new(room)
            .with_material("soft")
            .with_wall_material(0, "hard")
            .and_then(|surface| surface.with_wall_material(1, "hard"))
            .expect("the walls of a room");
        let mut scene = Scene::new(
            "room",
            vec![surface],
            Source::at(Vec3::X),
            Listener::at(Vec3::ZERO, 0.2),
        );
        let mut add = |name: &str, share: f64| {
            let material = Material::absorbing(share).scattering_by(scattering);
            scene.materials.insert(name.to_owned(), material);
        };
        add("soft", 0.5);
        add("hard", 0.02);
        scene
    }

    /// Protects the detection of flutter echoes from a wrong formula: Eyring's time and the time between the hard
    /// walls, calculated by hand.
    #[test]
    fn times_are_those_of_the_formulas() {
        let scene = room(0.0);
        let room = EmptyRoom::of(&scene).unwrap();
        // 0.161 s/m V / (−S ln(1 − ᾱ)) with S = 126 m², ᾱ = (30 · 0.02 + 96 · 0.5) / 126.
        let eyring = 0.1611 * 90.0 / (126.0 * -(1.0_f64 - 48.6 / 126.0).ln());
        assert!((room.eyring_s(3) / eyring - 1.0).abs() < 1e-3);
        // 13.816 · 12 m / 343 m/s / (2 · 0.0202).
        let (axis, seconds) = room.longest_flutter(3);
        assert_eq!(axis, 0);
        assert!((seconds / 11.96 - 1.0).abs() < 1e-3, "{seconds}");
    }

    /// Protects from wrong detections: only a long decay with walls that explain it is a flutter echo.
    #[test]
    fn only_a_long_decay_between_hard_walls_is_a_flutter() {
        let scene = room(0.0);
        let eyring = EmptyRoom::of(&scene).unwrap().eyring_s(0);
        let found = flutters(&scene, [Some(1.6 * eyring); BAND_COUNT]);
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].walls, [0, 1]);
        assert!(found[0].nothing_scatters);
        assert_eq!(found[0].bands.len(), BAND_COUNT);
        assert!(flutters(&scene, [Some(1.4 * eyring); BAND_COUNT]).is_empty());
        let found = flutters(&room(0.1), [Some(1.6 * eyring); BAND_COUNT]);
        assert!(!found[0].nothing_scatters);
        assert!(flutters(&room(0.9), [Some(1.6 * eyring); BAND_COUNT]).is_empty());
        let hollow = room(0.0).surfaces.pop().map(|mut surface| {
            let air = Cuboid {
                size: Vec3::new(6.0, 3.0, 5.0),
            };
            surface.shape = Shape::from(air).translate(Vec3::X).complement();
            surface.walls = Default::default();
            surface.with_material("hard")
        });
        let hollow = Scene {
            surfaces: hollow.into_iter().collect(),
            ..scene.clone()
        };
        let eyring = EmptyRoom::of(&hollow).unwrap().eyring_s(0);
        let found = flutters(&hollow, [Some(1.6 * eyring); BAND_COUNT]);
        assert_eq!(found[0].bands[0].eyring_s, eyring);
        let mut furnished = scene.clone();
        furnished.surfaces.push(furnished.surfaces[0].clone());
        assert!(flutters(&furnished, [Some(9.0); BAND_COUNT]).is_empty());
        assert!(flutters(&scene, [None; BAND_COUNT]).is_empty());
    }
}
