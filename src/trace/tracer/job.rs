//! What one frame needs: its input, checked, and what follows from it.

use super::super::budget::Budget;
use super::super::waves::{STATUS_DEAD, STATUS_STARTED};
use super::super::{Grid, Profile, Settings};
use super::EVALUATIONS_PER_DRAW;
use crate::gpu::Program;
use crate::scene::Scene;
use crate::scene::glsl::{Placed, Placement};
use glam::Vec4;
use std::rc::Rc;
use std::time::Instant;

/// Rows that are drawn before anything is known of their time.
const FIRST_ROWS: u32 = 8;

/// Seconds that these may take, where that can be foreseen: no more than a picture.
const FIRST_SECONDS: f64 = 0.03;

/// Steps to the next surface, as a rule.
const USUAL_STEPS: f64 = 20.0;

/// One frame's input, checked, with what follows from it.
pub(super) struct Job<'a> {
    pub scene: &'a Scene,
    pub settings: &'a Settings,
    pub budget: Budget,
    pub placement: Placement,
    pub placed: Placed,
    pub march: Rc<Program>,
    pub initialise: Rc<Program>,
    pub pan: Rc<Program>,
    pub began: Instant,
}

impl Job<'_> {
    /// Uniforms that a program does not have are passed over.
    pub fn set_uniforms(&self, grid: Grid) {
        let (program, settings) = (&self.march, self.settings);
        set_grid(program, grid);
        program.set_vec4_array("uSurfaces", &self.placed.uniform_values());
        program.set_vec4("uListener", self.listener());
        program.set_f32("uMinDistance", settings.min_distance);
        program.set_f32("uMaxDistance", settings.max_distance);
        program.set_f32("uStartOffset", settings.start_offset);
        program.set_f32("uNormalStep", settings.normal_step);
        program.set_f32("uLipschitz", settings.lipschitz);
        program.set_f32("uDistanceFactor", settings.distance_factor);
        program.set_i32("uStepBound", self.budget.steps as i32);
        program.set_i32("uFieldSteps", self.budget.field_steps as i32);
    }

    /// Evaluations of one surface that a wave may take in so many iterations.
    pub fn evaluations(&self, iterations: u32) -> u64 {
        u64::from(iterations) * self.budget.evaluations
    }

    /// How many evaluations of a usual surface one of the scene's takes the time of: of users'
    /// fields that was measured.
    pub fn weight(&self) -> u64 {
        let slowest = self.scene.evaluation_seconds().unwrap_or_default();
        ((slowest * EVALUATIONS_PER_DRAW as f64) as u64).max(1)
    }

    /// Rows of so many waves that are drawn before anything is known of their time: fewer of
    /// what is foreseen to take long.
    pub fn first_rows(&self, width: u32, iterations: u32) -> u32 {
        let Some(seconds) = self.scene.evaluation_seconds() else {
            return FIRST_ROWS;
        };
        let evaluations = f64::from(width) * f64::from(iterations) * USUAL_STEPS;
        ((FIRST_SECONDS / (seconds * evaluations)) as u32).clamp(1, FIRST_ROWS)
    }

    pub fn listener(&self) -> Vec4 {
        let listener = &self.scene.listener;
        self.placement
            .place(listener.position)
            .extend(listener.radius)
    }

    /// The thesis marches waves even out of a solid; elsewhere a source in a solid sends
    /// none.
    pub fn start_status(&self) -> f32 {
        let nearest = self.scene.surface_distance(self.scene.source.position);
        let is_buried = -nearest.distance > self.placed.slack(nearest.object);
        match self.settings.profile {
            Profile::March | Profile::Hybrid if is_buried => STATUS_DEAD,
            _ => STATUS_STARTED,
        }
    }
}

pub(super) fn set_grid(program: &Program, grid: Grid) {
    program.set_u32("uWaveCount", grid.waves);
    program.set_u32("uGridWidth", grid.width);
}
