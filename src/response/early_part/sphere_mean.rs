//! The mean energy of exact paths over the listener's sphere.
//!
//! Paths lead to the listener's centre, while waves give means over its sphere. An obstacle may hide a part of the
//! sphere from a path, and near a source the energy density varies over the sphere. The mean is computed without waves,
//! at points spread evenly over the sphere, so it depends neither on the number of waves nor on the seed. Over planes,
//! an unobstructed line from such a point towards the image of the source leads back to the source, for every order of
//! the planes. Over curved surfaces the path to the point is found by Newton's method.

use super::length_m;
use crate::bands::{self, Bands};
use crate::response::Tap;
use crate::response::exact_paths::{Candidates, EarlyPaths, Ends, Found, SpecularPath, Vertex};
use crate::response::source_sound::{HeardPath, Medium, radiated_along, reflectance};
use crate::sampling::lattice;
use crate::scene::{Pair, Scene};
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::collections::HashSet;
use std::f64::consts::PI;

/// Number of points in the sphere, enough to estimate the share of the sphere that a path reaches to within about 0.1.
/// It is also enough for the mean over the many paths behind an edge.
const PLACES: usize = 32;

/// Maximum number of images searched for from each point, nearest first: as many as a room has up to eight reflections.
/// A thousand images take about 0.1 s of one core for all points. Further images are assumed to reach the whole sphere.
const MOST_IMAGES: usize = 2048;

/// Maximum number of images if a field without closed form is marched, which takes a thousand times as long.
const MOST_IMAGES_MARCHED: usize = 8;

/// Maximum number of paths over curved surfaces that are computed for each point, the shortest first: a hundred take
/// about 0.1 s.
const MOST_CURVED: usize = 128;

/// Maximum number of such paths if a field without closed form is marched.
const MOST_CURVED_MARCHED: usize = 4;

/// Maximum number of surfaces and bounding boxes tested from each point. A test takes about ten nanoseconds. Images
/// beyond this limit are assumed to reach the whole sphere.
const MOST_ASKED: u64 = 1 << 22;

/// Distance in metres below which images count as one. It is not a multiple of a short binary fraction, so that an
/// image with round coordinates never lies between two cells of this size.
const SAME_IMAGE_M: f64 = 1.00431e-5;

/// Maximum distance in metres at which a line followed back passes the source. Directions are rounded to `f32`, which
/// moves the end of a line by 1e-7 of its length.
const BESIDE_SOURCE_M: f64 = 1e-3;

/// An image of the source in planes.
struct Image {
    place: DVec3,
    /// The surfaces and walls of the reflections, in order.
    at: Vec<(u32, Option<u8>)>,
    /// Index of the exact path from the image to the listener's centre; `None` if the image only reaches other points.
    path: Option<usize>,
    /// Direction in which the sound leaves the source: a vector of any length, 0 if unknown.
    departure: DVec3,
}

/// The exact paths, evaluated at points of the listener's sphere away from its centre, and the images that reach only
/// such points.
pub(super) struct Replaced {
    early: EarlyPaths,
    ends: Ends,
    images: Vec<Image>,
    /// Paths over curved surfaces: their indices, and their surfaces in the same order.
    curved: Vec<usize>,
    sequences: Candidates,
    /// All other paths, by index.
    others: Vec<usize>,
    /// Maximum number of images and of curved paths.
    most: (usize, usize),
}

impl Replaced {
    /// Selects from `paths`, which are sorted by length. `vertices` returns the reflection points of a wave that found
    /// the path with this index. `beside` has the vertices of waves that passed beside the centre and whose sound is in
    /// no statistic.
    pub fn new<'a>(
        scene: &Scene,
        early: EarlyPaths,
        ends: Ends,
        paths: &[SpecularPath],
        vertices: impl Fn(usize) -> Option<&'a [Vertex]>,
        beside: impl Iterator<Item = &'a [Vertex]>,
    ) -> Replaced {
        let is_marched = !scene
            .surfaces
            .iter()
            .all(|surface| surface.shape.is_basic());
        let mut replaced = Replaced {
            most: match is_marched {
                true => (MOST_IMAGES_MARCHED, MOST_CURVED_MARCHED),
                false => (MOST_IMAGES, MOST_CURVED),
            },
            early,
            ends,
            images: Vec::new(),
            curved: Vec::new(),
            sequences: Candidates::new(MOST_CURVED),
            others: Vec::new(),
        };
        for (index, path) in paths.iter().enumerate() {
            let vertices = match path.surfaces.is_empty() {
                true => Some(&[][..]),
                false => vertices(index),
            };
            if !vertices.is_some_and(|vertices| replaced.add(index, vertices)) {
                replaced.others.push(index);
            }
        }
        replaced.add_beside(beside);
        replaced
    }

    /// Adds a path, unless the limit of its kind is reached.
    fn add(&mut self, path: usize, vertices: &[Vertex]) -> bool {
        if !self.early.are_flat(vertices) {
            if self.curved.len() >= self.most.1 {
                return false;
            }
            self.sequences.add(self.curved.len() as u32, vertices);
            self.curved.push(path);
            return true;
        }
        if self.images.len() >= self.most.0 {
            return false;
        }
        let image = self.image(vertices, Some(path));
        self.images.push(image);
        true
    }

    fn image(&self, vertices: &[Vertex], path: Option<usize>) -> Image {
        let surfaces = vertices.iter().map(|vertex| vertex.surface);
        Image {
            place: self.early.image(&self.ends, vertices),
            at: surfaces.zip(self.early.walls(vertices)).collect(),
            path,
            departure: vertices
                .first()
                .map_or(self.ends.listener, |vertex| vertex.point)
                - self.ends.source,
        }
    }

    /// Adds the nearest images that are not yet included.
    fn add_beside<'a>(&mut self, vertices: impl Iterator<Item = &'a [Vertex]>) {
        let rounded = |image: &Image| (image.place / SAME_IMAGE_M).round().as_i64vec3();
        let mut known: HashSet<_> = self.images.iter().map(rounded).collect();
        let mut beside = Vec::new();
        for vertices in vertices.filter(|vertices| self.early.are_flat(vertices)) {
            let image = self.image(vertices, None);
            if known.insert(rounded(&image)) {
                beside.push(image);
            }
        }
        let from_centre = |image: &Image| image.place.distance(self.ends.listener);
        beside.sort_by(|a, b| from_centre(a).total_cmp(&from_centre(b)));
        beside.truncate(self.most.0 - self.images.len());
        self.images.append(&mut beside);
    }

    /// The mean energy of the paths and images over the unobstructed part of the sphere, as taps at the times of paths
    /// to its centre. `heard` contains all exact paths, with the `changes` of their energies by edges. The taps leave out
    /// paths for which `is_left_out` holds.
    pub fn mean_taps(
        &self,
        pair: Pair,
        medium: &Medium,
        (heard, changes): (&[HeardPath], &[Bands]),
        is_left_out: &dyn Fn(&SpecularPath) -> bool,
    ) -> Vec<Tap> {
        let mut places = places(&self.ends);
        places.retain(|place| self.early.is_open(*place));
        let spreadings = |place: &DVec3| {
            (
                self.spreadings_of_images(*place),
                self.spreadings_curved(*place),
            )
        };
        let found: Vec<(Vec<f64>, Vec<f64>)> = places.par_iter().map(spreadings).collect();
        let share = medium.level / places.len().max(1) as f64;
        let tap = |length_m: f64, radiated: Bands, spreading: f64| Tap {
            seconds: length_m / medium.speed,
            energy: bands::through_air(
                &radiated.map(|left| left * spreading * share),
                &medium.air,
                length_m,
            ),
            direction: DVec3::ZERO,
        };
        let is_kept = |path: usize| {
            heard
                .get(path)
                .is_some_and(|heard| !is_left_out(&heard.path))
        };
        let mut taps = Vec::new();
        for (index, image) in self.images.iter().enumerate() {
            if image.path.is_none_or(is_kept) {
                let spreading = found.iter().map(|(of_images, _)| of_images[index]).sum();
                let length_m = image.place.distance(self.ends.listener);
                let radiated = pair.source.factor(image.departure);
                let reflected = reflectance(pair.scene, &image.at);
                let change = image.path.map_or(bands::ALL, |path| changes[path]);
                let energy =
                    std::array::from_fn(|band| radiated[band] * reflected[band] * change[band]);
                taps.push(tap(length_m, energy, spreading));
            }
        }
        for (index, path) in self
            .curved
            .iter()
            .enumerate()
            .filter(|(_, path)| is_kept(**path))
        {
            let spreading = found.iter().map(|(_, curved)| curved[index]).sum();
            let (change, path) = (changes[*path], &heard[*path].path);
            let radiated = radiated_along(pair, path);
            let energy = std::array::from_fn(|band| radiated[band] * change[band]);
            taps.push(tap(path.length_m, energy, spreading));
        }
        let others = self.others.iter().filter(|path| is_kept(**path));
        taps.extend(others.map(|path| heard[*path].tap_of_energy()));
        taps
    }

    /// The energy density at a point from each image in 1/m², for a source of power 1; 0 if obstructed.
    fn spreadings_of_images(&self, place: DVec3) -> Vec<f64> {
        let back = Ends {
            source: place,
            listener: self.ends.source,
            ..self.ends
        };
        let towards = |image: &Image| (image.place - place).as_vec3();
        let directions: Vec<Vec3> = self.images.iter().map(towards).collect();
        let order = self.images.iter().map(|image| image.at.len()).max();
        let order = order.unwrap_or(0) as u32;
        let early = &self.early;
        let followed =
            early.candidates_within(&back, &directions, order, BESIDE_SOURCE_M, MOST_ASKED);
        let most_caught = 3.0 / (2.0 * PI * self.ends.radius_m.powi(2));
        let spreading = |image: &Image| {
            let distance_squared = place.distance_squared(image.place);
            (1.0 / (4.0 * PI * distance_squared)).min(most_caught)
        };
        let mut spreadings = vec![0.0; self.images.len()];
        for index in followed.left_out() {
            let index = *index as usize;
            spreadings[index] = spreading(&self.images[index]);
        }
        for line in followed.iter() {
            let image = &self.images[line.wave as usize];
            let distance = place.distance(image.place);
            let is_as_long = (length_m(&back, line.vertices) - distance).abs() <= BESIDE_SOURCE_M;
            // If the source lies on a wall, the line back has no reflection there.
            if line.vertices.len() <= image.at.len() && is_as_long {
                spreadings[line.wave as usize] = spreading(image);
            }
        }
        spreadings
    }

    /// The energy density at a point from each path over curved surfaces.
    fn spreadings_curved(&self, place: DVec3) -> Vec<f64> {
        let mut spreadings = vec![0.0; self.curved.len()];
        if self.curved.is_empty() {
            return spreadings;
        }
        let ends = Ends {
            listener: place,
            ..self.ends
        };
        let Found {
            paths, outcomes, ..
        } = self.early.find(&ends, &self.sequences);
        let mut is_taken = vec![false; paths.len()];
        for (spreading, outcome) in spreadings.iter_mut().zip(outcomes) {
            if let Ok(path) = outcome
                && !std::mem::replace(&mut is_taken[path], true)
            {
                *spreading = paths[path].spreading;
            }
        }
        spreadings
    }
}

/// Points spread evenly over the listener's sphere: directions of a lattice, at radii of shells of equal volume.
fn places(ends: &Ends) -> Vec<DVec3> {
    /// Step of the enclosed volume: irrational, and independent of the lattice's golden ratio.
    const STEP: f64 = std::f64::consts::SQRT_2;
    let place = |(index, direction): (usize, DVec3)| {
        let volume = ((index as f64 + 0.5) * STEP).fract();
        ends.listener + direction * (ends.radius_m * volume.cbrt())
    };
    lattice(PLACES as u64).enumerate().map(place).collect()
}

/// The energy of exact paths in an unobstructed sphere of `radius_m` metres, as taps at the times of the paths, without
/// the paths for which `is_left_out` holds.
pub(super) fn unhidden_taps(
    paths: &[HeardPath],
    radius_m: f64,
    is_left_out: &dyn Fn(&SpecularPath) -> bool,
) -> Vec<Tap> {
    let kept = paths.iter().filter(|heard| !is_left_out(&heard.path));
    let mean = |heard: &HeardPath| {
        let share = mean_over_sphere(radius_m / heard.path.length_m);
        let energy = heard.energy.map(|energy| energy * share);
        Tap {
            energy,
            ..heard.tap_of_energy()
        }
    };
    kept.map(mean).collect()
}

/// The mean of 1/r² over a sphere whose centre is at distance 1/`share` radii, times the square of the centre's
/// distance.
fn mean_over_sphere(share: f64) -> f64 {
    /// Below this share the first two terms of the series are used, because the logarithm loses digits.
    const SMALL: f64 = 1e-3;
    let square = share * share;
    if share < SMALL {
        return 1.0 + square / 5.0;
    }
    let outside = match share == 1.0 {
        true => 0.0,
        false => (square - 1.0) / (2.0 * share) * ((share + 1.0) / (share - 1.0).abs()).ln(),
    };
    1.5 / square * (1.0 + outside)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects near sources from a false difference: the mean of 1/r² over a sphere equals sums over shells.
    #[test]
    fn the_mean_over_a_sphere_is_that_of_its_shells() {
        for share in [1e-4, 0.01, 0.3, 0.9, 1.5, 3.0] {
            let shells = 200_000;
            // Over a shell of radius s around a point at distance 1 the mean is ln((1 + s)/|1 − s|)/2s.
            let of_shell = |shell: u32| {
                let s = share * (f64::from(shell) + 0.5) / f64::from(shells);
                s * 0.5 * ((1.0 + s) / (1.0 - s).abs()).ln()
            };
            let sum: f64 = (0..shells).map(of_shell).sum();
            let mean = sum * 3.0 / (share * share * f64::from(shells));
            let found = mean_over_sphere(share);
            assert!(
                (found / mean - 1.0).abs() < 1e-4,
                "{share}: {found}, {mean}"
            );
        }
        assert_eq!(mean_over_sphere(1.0), 1.5);
    }
}
