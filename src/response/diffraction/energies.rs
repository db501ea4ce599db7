//! The energies of the ways around an obstacle.
//!
//! # Theory
//! Pressures add: the energy behind an obstacle is that of the sum of all ways. Reflections that end at edges beside the
//! ways add as energies, as they do in the light. Each way has a share of the whole energy in proportion to the energy
//! that it would have alone. Where two ways are equally long, as on the axis of a pillar, both have the same share, so
//! that no level and no direction jumps when a listener walks across the axis.
//!
//! At the boundary of the shadow the shortest way becomes the direct sound, which has the whole energy. The other ways
//! therefore lose their shares to it there: with the least detour δ₀, a way with the detour δ counts by the factor
//! (δ₀/δ)^(1/(1 + kδ₀)), which is 1 for equal detours, and deep in the shadow for all.

use super::DiffractedPath;
use super::bend::Bend;
use super::interference::{self, band_mean};
use super::space::Space;
use super::ways::{Way, Ways};
use crate::bands::{BAND_COUNT, Bands};
use glam::DVec3;
use std::f64::consts::PI;

impl Ways {
    /// The paths along the ways; `coefficients` are the pressure reflection coefficients of a surface, by its number and
    /// by band.
    pub fn paths(
        &self,
        space: &impl Space,
        speed: f64,
        coefficients: impl Fn(u32, DVec3) -> Bands,
    ) -> Vec<DiffractedPath> {
        let heard: Vec<&Bend> = self.bends.iter().flat_map(Way::heard).collect();
        let energies = self.energies(space, speed, coefficients, &heard);
        let path = |(bend, energy): (&&Bend, &Bands)| {
            let mut path = DiffractedPath::along(bend, space)?;
            path.energy = *energy;
            path.errors_db = self.errors_db();
            Some(path)
        };
        let paths = heard.iter().zip(&energies);
        paths.filter_map(path).collect()
    }

    /// Energy density at the listener of each bend by band, in 1/m² for a source of power 1. The energies add up to the
    /// energy of the sum of the pressures.
    fn energies(
        &self,
        space: &impl Space,
        speed: f64,
        coefficients: impl Fn(u32, DVec3) -> Bands,
        heard: &[&Bend],
    ) -> Vec<Bands> {
        let faces = self.faces(space, coefficients);
        let mut of_bends = vec![[0.0; BAND_COUNT]; heard.len()];
        for band in 0..BAND_COUNT {
            let faces = Ways::in_band(&faces, band);
            let own = self.energies_in_band(space, (speed, band), &faces, heard);
            for (energies, energy) in of_bends.iter_mut().zip(&own) {
                energies[band] = energy / (4.0 * PI * self.apart_m * self.apart_m);
            }
        }
        of_bends
    }

    /// The energies of the bends in a band, relative to the open at the straight way.
    fn energies_in_band(
        &self,
        space: &impl Space,
        (speed, band): (f64, usize),
        faces: &[Vec<f64>],
        heard: &[&Bend],
    ) -> Vec<f64> {
        let detours: Vec<f64> = heard
            .iter()
            .map(|bend| (bend.length_m - self.apart_m).max(0.0))
            .collect();
        let least = detours.iter().copied().fold(f64::INFINITY, f64::min);
        let mut own = vec![0.0; heard.len()];
        let whole = band_mean(band, speed, |k| {
            let (sounds, reflected) = self.sounds(space, k, faces);
            for ((own, sound), detour) in own.iter_mut().zip(&sounds).zip(&detours) {
                *own += sound.pressure.norm_sqr() * nearness(k, least, *detour);
            }
            interference::energy(&sounds, k) + reflected
        });
        let mut all: f64 = own.iter().sum();
        if all == 0.0 {
            // Only the edges beside the ways are heard.
            own = vec![1.0; heard.len()];
            all = own.len() as f64;
        }
        own.into_iter().map(|own| own * whole / all).collect()
    }
}

/// How much a way counts whose detour is longer than the least one, in metres, for the wave number `k`: 1 if it is not,
/// 0 where the least is none.
pub(super) fn nearness(k: f64, least: f64, detour: f64) -> f64 {
    match detour > least {
        true => (least / detour).powf(1.0 / (1.0 + k * least)),
        false => 1.0,
    }
}
