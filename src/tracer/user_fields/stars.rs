//! Stars: points around a centre, at which growth and bend are measured.
//!
//! A star has its centre, two ends along each axis, and two ends along the gradient.

use super::{Error, Probe, WaveDomain};
use crate::scene::halton;
use glam::Vec3;

/// Number of stars in the whole box.
const SPREAD: usize = 16_384;

/// Number of stars on the surface, if there is one.
const ON_SURFACE: usize = 8192;

/// Width of the narrowest star, as a share of the box's shortest side.
const NARROWEST: f32 = 1e-4;

/// Width of the widest star, in multiples of the narrowest.
const WIDEST: f32 = 100.0;

/// Width of the narrowest star on the surface, as a share of the box's shortest side. Over any shorter distance the
/// surface of a fractal is steep. Only few stars of the box are so narrow and so near the surface that they detect
/// this.
const NARROWEST_ON_SURFACE: f32 = 1e-3;

/// Number of different widths.
const WIDTHS: usize = 64;

/// Number of points of a star: its centre, and its ends in pairs.
pub(super) const POINTS: usize = 9;

/// Number of pairs of ends.
pub(super) const PAIRS: usize = POINTS / 2;

/// The values of a star that are checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scope {
    /// All values: waves can be in the whole box, or the whole star is next to the air.
    Whole,
    /// Only positive values.
    Air,
    /// No value, because no point of the star is in the air.
    Nowhere,
}

/// The points and values of stars, star by star.
#[derive(Default)]
pub(super) struct Stars {
    pub points: Vec<Vec3>,
    pub values: Vec<f32>,
}

/// One star.
#[derive(Clone, Copy)]
pub(super) struct Star<'a> {
    pub points: &'a [Vec3],
    pub values: &'a [f32],
}

impl Stars {
    pub fn each(&self) -> impl Iterator<Item = Star<'_>> {
        let chunks = self.points.chunks_exact(POINTS);
        let all = chunks.zip(self.values.chunks_exact(POINTS));
        all.map(|(points, values)| Star { points, values })
    }
}

impl Star<'_> {
    /// Distance between the ends of the first pair, in metres.
    fn length(self) -> f32 {
        self.points[1].distance(self.points[2])
    }
}

impl Probe<'_> {
    /// The stars of the box, and the stars at these points on the surface.
    pub(super) fn stars(&self, surface: &[Vec3]) -> Result<Stars, Error> {
        let half = 0.5 * self.field.size;
        let least = self.field.size.min_element();
        let width_from = |narrowest: f32, widest: f32, index: usize| {
            let share = (index % WIDTHS) as f32 / (WIDTHS - 1) as f32;
            narrowest * (widest / narrowest).powf(share)
        };
        let width = |index| width_from(NARROWEST * least, NARROWEST * WIDEST * least, index);
        let narrowest = NARROWEST_ON_SURFACE * least;
        let widest = narrowest.max(0.5 * self.depth());
        let spread = (1..=SPREAD).map(|index| {
            let width = width(index);
            let inside = half - 2.0 * width;
            (inside * (2.0 * halton(index).as_vec3() - 1.0), width)
        });
        let on_surface = surface.iter().cycle().enumerate().take(ON_SURFACE);
        let on_surface = on_surface.map(|(index, &place)| {
            // If points are used again, their stars have another width.
            let width = width_from(narrowest, widest, index + index / surface.len());
            let aside = width * (2.0 * halton(index + 1).as_vec3() - 1.0);
            let inside = half - 2.0 * width;
            ((place + aside).clamp(-inside, inside), width)
        });
        let centres: Vec<(Vec3, f32)> = spread.chain(on_surface).collect();
        self.around(&centres)
    }

    /// The stars with these centres and widths.
    fn around(&self, centres: &[(Vec3, f32)]) -> Result<Stars, Error> {
        const FIRST: usize = POINTS - 2;
        let mut points = Vec::with_capacity(FIRST * centres.len());
        for &(centre, width) in centres {
            points.push(centre);
            for axis in Vec3::AXES {
                points.extend([centre - width * axis, centre + width * axis]);
            }
        }
        let values = self.values(&points)?;
        let ends: Vec<Vec3> = centres
            .iter()
            .zip(values.chunks(FIRST))
            .flat_map(|(&(centre, width), of)| {
                let gradient = Vec3::new(of[2] - of[1], of[4] - of[3], of[6] - of[5]);
                let way = gradient.normalize_or_zero() * width;
                [centre - way, centre + way]
            })
            .collect();
        let at_ends = self.values(&ends)?;
        let mut stars = Stars::default();
        for index in 0..centres.len() {
            let (first, last) = (FIRST * index..FIRST * (index + 1), 2 * index..2 * index + 2);
            stars.points.extend(&points[first.clone()]);
            stars.points.extend(&ends[last.clone()]);
            stars.values.extend(&values[first]);
            stars.values.extend(&at_ends[last]);
        }
        Ok(stars)
    }

    /// The values of a star that are checked.
    pub(super) fn scope(&self, star: Star) -> Scope {
        if self.waves == WaveDomain::BothSides {
            return Scope::Whole;
        }
        if !star.values.iter().any(|value| *value > 0.0) {
            return Scope::Nowhere;
        }
        match star.length() <= self.depth() {
            true => Scope::Whole,
            false => Scope::Air,
        }
    }
}
