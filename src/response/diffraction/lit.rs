//! The sound of a free way, with the edges beside it and the ways around the far side of what is beside it.

use super::Ends;
use super::OFF_THE_EDGE;
use super::energies::nearness;
use super::errors::GAP_ERRORS_DB;
use super::interference::{self, Sound, THIRDS, band_mean};
use super::narrow::wideness;
use super::rim::Rim;
use super::space::Space;
use super::string::HalfPlanes;
use super::touch::MOST_DETOUR_M;
use super::ways::Ways;
use crate::bands::{self, BAND_COUNT, Bands};
use glam::DVec3;
use num_complex::Complex64;

/// The edges and further ways beside a free way.
pub(super) struct Lit {
    /// Length of the way in metres.
    apart_m: f64,
    beside: Vec<Beside>,
}

/// The change of the sound of a free way by the edges beside it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::response) struct Change {
    /// The energy by band, relative to that in the open.
    pub energy: Bands,
    /// Half-widths in decibels of the intervals that contain 95 % of the errors of this energy, by band.
    pub errors_db: Bands,
}

impl Change {
    /// No edges.
    pub const NONE: Change = Change {
        energy: bands::ALL,
        errors_db: [0.0; BAND_COUNT],
    };
}

/// An edge beside a free way.
struct Beside {
    rim: Rim,
    /// The ways around the far side of its obstacle.
    far: Ways,
}

impl Lit {
    /// The edges and ways beside the straight way between two points in sight; `None` if the points coincide.
    pub fn between(space: &impl Space, (source, listener): Ends) -> Option<Lit> {
        let planes = HalfPlanes::between(source, listener)?.of_free_way(space);
        let mut rims = Rim::all(space, &planes, &[]);
        let touched = rims.iter().find(|rim| rim.touches_the_straight_way());
        let Some(touched) = touched else {
            return Some(Lit::of(space, &planes, rims));
        };
        // The half-planes of an edge on the line between source and listener are not defined.
        let moved = listener + touched.inwards() * (OFF_THE_EDGE[0] * planes.apart_m());
        let planes = HalfPlanes::between(source, moved)?.of_free_way(space);
        rims = Rim::all(space, &planes, &[]);
        Some(Lit::of(space, &planes, rims))
    }

    fn of(space: &impl Space, planes: &HalfPlanes, rims: Vec<Rim>) -> Lit {
        let beside = |rim: Rim| {
            let planes = planes.around_what_is_beside(rim.half_planes, MOST_DETOUR_M);
            Beside {
                far: Ways::around(space, &planes).behind(&rim),
                rim,
            }
        };
        Lit {
            apart_m: planes.apart_m(),
            beside: rims.into_iter().map(beside).collect(),
        }
    }

    /// The change of the energy at the listener. Includes the energy of reflections that end at the edges. `coefficients`
    /// are the pressure reflection coefficients of a surface, by its number and by band.
    pub fn change(
        &self,
        space: &impl Space,
        speed: f64,
        coefficients: impl Fn(u32, DVec3) -> Bands,
    ) -> Change {
        let faces = self.beside.iter().map(|beside| {
            let point = beside.rim.point();
            let face = coefficients(space.nearest(point), space.in_scene(point));
            (face, beside.far.faces(space, &coefficients))
        });
        let faces: Vec<(Bands, Vec<Vec<Bands>>)> = faces.collect();
        let mut change = Change::NONE;
        let errors_db = self.errors_of_added_db();
        for band in 0..BAND_COUNT {
            let of_band = |(face, far): &(Bands, Vec<Vec<Bands>>)| {
                let far = Ways::in_band(far, band);
                (face[band], far)
            };
            let faces: Vec<(f64, Vec<Vec<f64>>)> = faces.iter().map(of_band).collect();
            let mut added = 0.0;
            let energy = band_mean(band, speed, |k| {
                let (energy, of_edges) = self.energy_at(space, k, &faces);
                added += of_edges / THIRDS.len() as f64;
                energy
            });
            let share = (added / energy.max(f64::MIN_POSITIVE)).sqrt();
            let wrong = share * (10.0_f64.powf(errors_db[band] / 20.0) - 1.0);
            change.energy[band] = energy;
            change.errors_db[band] = 20.0 * (1.0 + wrong).log10();
        }
        change
    }

    /// Half-widths in decibels of the intervals that contain 95 % of the errors of what the edges add, by band.
    fn errors_of_added_db(&self) -> Bands {
        let of_rims = match &self.beside[..] {
            [] => [0.0; BAND_COUNT],
            [beside] => beside.rim.errors_db(),
            _ => GAP_ERRORS_DB,
        };
        let of_far = self.beside.iter().map(|beside| beside.far.errors_db());
        of_far.fold(of_rims, bands::greater)
    }

    /// The energy for the wave number `k`, and that of the sound which the edges add. `faces` has the pressure reflection
    /// coefficients at each edge, and at the turns of the ways around the far side of its obstacle.
    fn energy_at(&self, space: &impl Space, k: f64, faces: &[(f64, Vec<Vec<f64>>)]) -> (f64, f64) {
        let detours = self.beside.iter().map(|beside| beside.rim.detour_m());
        let least = detours.fold(f64::INFINITY, f64::min);
        let mut sounds = vec![Sound {
            pressure: Complex64::ONE,
            length_m: self.apart_m,
        }];
        let mut reflected = 0.0;
        for (Beside { rim, far }, (face, faces)) in self.beside.iter().zip(faces) {
            let wide = wideness(k * far.wide_m);
            let Some(added) = rim.added(space, k, (*face, wide)) else {
                continue;
            };
            reflected += added.reflected;
            sounds.push(Sound {
                pressure: added.direct,
                length_m: rim.length_m,
            });
            // At the boundary of a shadow the ways around another obstacle are not known.
            let near = rim.nearness() * nearness(k, least, rim.detour_m());
            let border = far.has_border().then(|| far.at_border(k, added.behind));
            let (around, far_reflected) = far.sounds(space, k, faces);
            reflected += far_reflected * near * near;
            let around = around.into_iter().chain(border);
            sounds.extend(around.map(|sound| sound.weighted(near)));
        }
        let energy = |sounds: &[Sound]| interference::energy(sounds, k) + reflected;
        (energy(&sounds), energy(&sounds[1..]))
    }
}
