//! Random numbers that are identical on every machine.
#![allow(dead_code)] // Each test program uses only some of these.

use glam::{DVec3, Vec3};
use std::f64::consts::TAU;

/// The generator SplitMix64 (Steele et al. 2014).
pub struct Random(pub u64);

impl Random {
    /// 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        bits ^ (bits >> 31)
    }

    /// A number uniformly distributed in 0 to 1.
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 * (-53f64).exp2()
    }

    pub fn signed(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }

    /// A direction uniformly distributed over the unit sphere. Its height is uniformly distributed (Archimedes).
    pub fn direction(&mut self) -> DVec3 {
        let height = self.signed();
        let (sin, cos) = (TAU * self.unit()).sin_cos();
        let ring = (1.0 - height * height).sqrt();
        DVec3::new(ring * cos, height, ring * sin)
    }

    pub fn directions(&mut self, count: usize) -> Vec<Vec3> {
        (0..count).map(|_| self.direction().as_vec3()).collect()
    }

    /// A number from 10⁻³ to 10⁴ whose logarithm is uniformly distributed.
    pub fn scale(&mut self) -> f64 {
        10f64.powf(7.0 * self.unit() - 3.0)
    }
}
