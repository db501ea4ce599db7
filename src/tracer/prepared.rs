//! A frame that is ready to be drawn: its checked input, its programs, and the values of their uniforms.

use super::waves::{STATUS_DEAD, STATUS_STARTED, random_turn};
use super::{Algorithm, Grid, Settings};
use crate::gl::{Context, Program};
use crate::platform::Instant;
use crate::scene::Pair;
use crate::shader::{Budget, CompiledScene};
use glam::{Vec3, Vec4};
use std::rc::Rc;

/// Maximum evaluations of one surface in one draw call, if every march takes the maximum number of steps. These are
/// about 2^38 operations, which take about a second on the slowest card with OpenGL 3.3.
pub(super) const EVALUATIONS_PER_DRAW: u64 = 1 << 33;

/// Rows that are drawn first, before the time of a row is known.
const FIRST_ROWS: u32 = 8;

/// Maximum seconds for the first rows, if their time can be predicted: no more than one picture of a window takes.
const FIRST_SECONDS: f64 = 0.03;

/// Usual number of steps to the next surface.
const USUAL_STEPS: f64 = 20.0;

/// The checked input of one frame: its programs, and the values of their uniforms at the beginning of the frame.
pub(super) struct PreparedFrame {
    pub settings: Settings,
    pub grid: Grid,
    pub budget: Budget,
    pub programs: FramePrograms,
    pub began: Instant,
    /// World position of the shaders' origin in metres.
    pub origin: Vec3,
    uniforms: Uniforms,
    /// Seconds per evaluation of the slowest user's field, if there is one.
    evaluation_seconds: Option<f64>,
}

/// The programs of a frame.
pub(super) enum FramePrograms {
    /// One program per pass. Between passes the waves are in texture pairs.
    Passes {
        initialise: Rc<Program>,
        march: Rc<Program>,
        pan: Rc<Program>,
    },
    /// All passes in one program. The waves are in no texture.
    WholeFrame {
        frame: Rc<Program>,
        /// Rearranges the contributions into the order of the waves, if starts are sorted.
        in_order: Option<Rc<Program>>,
    },
}

impl FramePrograms {
    /// The program that traces waves through iterations.
    pub fn march(&self) -> &Rc<Program> {
        match self {
            FramePrograms::Passes { march, .. } => march,
            FramePrograms::WholeFrame { frame, .. } => frame,
        }
    }

    /// Whether all passes are drawn as one.
    pub fn are_one(&self) -> bool {
        matches!(self, FramePrograms::WholeFrame { .. })
    }
}

/// Source and listener in the shaders' coordinates, as the programs read them.
struct Uniforms {
    source: Vec3,
    start_status: f32,
    /// Position, and radius in the last component.
    listener: Vec4,
    listener_right: Vec3,
}

impl PreparedFrame {
    /// A frame of a pair whose scene is compiled in its current state.
    pub fn new(
        pair: Pair,
        settings: &Settings,
        compiled: &CompiledScene,
        budget: Budget,
        programs: FramePrograms,
        began: Instant,
    ) -> PreparedFrame {
        let listener = pair.listener;
        let uniforms = Uniforms {
            source: compiled.local(pair.source.position),
            start_status: start_status(pair, settings, compiled),
            listener: compiled.local(listener.position).extend(listener.radius),
            listener_right: listener.right(),
        };
        PreparedFrame {
            settings: settings.clone(),
            grid: Grid::new(settings.waves),
            budget,
            programs,
            began,
            origin: compiled.origin(),
            uniforms,
            evaluation_seconds: pair.scene.evaluation_seconds(),
        }
    }

    /// Sets the uniforms of a program that starts the waves.
    pub fn set_start_uniforms(&self, program: &Program) {
        set_direction_uniforms(program, &self.settings, self.grid);
        program.set_vec3("uSource", self.uniforms.source);
        program.set_f32("uStartStatus", self.uniforms.start_status);
    }

    /// Sets the uniforms of the march that are the same for all iterations. Uniforms that the program lacks are
    /// skipped.
    pub fn set_march_uniforms(&self) {
        let (program, settings) = (self.programs.march(), &self.settings);
        if self.programs.are_one() {
            self.set_start_uniforms(program);
            self.set_pan_uniforms(program);
        }
        set_grid(program, self.grid);
        program.set_vec4("uListener", self.uniforms.listener);
        program.set_f32("uMaxDistance", settings.max_distance);
        program.set_i32("uStepLimit", self.budget.steps as i32);
        program.set_i32("uFieldSteps", self.budget.field_steps as i32);
        program.set_i32("uCopySteps", self.budget.copy_steps as i32);
        match &settings.algorithm {
            Algorithm::Hybrid | Algorithm::March => (),
            Algorithm::Thesis(thesis) => {
                program.set_f32("uMinDistance", thesis.min_distance);
                program.set_f32("uStartOffset", thesis.start_offset);
                program.set_f32("uNormalStep", thesis.normal_step);
            }
        }
    }

    /// Sets the uniforms of a program that pans.
    pub fn set_pan_uniforms(&self, program: &Program) {
        program.set_vec4("uListener", self.uniforms.listener);
        program.set_vec3("uListenerRight", self.uniforms.listener_right);
    }

    /// The texel of a wave at its start: position, and status in the last component.
    pub fn start(&self) -> [f32; 4] {
        let Uniforms {
            source,
            start_status,
            ..
        } = self.uniforms;
        source.extend(start_status).to_array()
    }

    /// Maximum evaluations of one surface by a wave in these iterations. On a graphics card, whose watchdog limits the
    /// time of a draw, slow evaluations count as several usual ones.
    pub fn evaluations(&self, context: &Context, iterations: u32) -> u64 {
        let evaluations = u64::from(iterations) * self.budget.evaluations;
        match context.is_software() {
            true => evaluations,
            false => evaluations.saturating_mul(self.weight()),
        }
    }

    /// The time of an evaluation of the scene's slowest surface, as a multiple of a usual evaluation. The time is known
    /// for users' fields, because it was measured.
    fn weight(&self) -> u64 {
        let slowest = self.evaluation_seconds.unwrap_or_default();
        ((slowest * EVALUATIONS_PER_DRAW as f64) as u64).max(1)
    }

    /// Rows that are drawn first, before the time of a row is known. Their number is lower if evaluations are known to
    /// be slow.
    pub fn first_rows(&self, iterations: u32) -> u32 {
        let Some(seconds) = self.evaluation_seconds else {
            return FIRST_ROWS;
        };
        let evaluations = f64::from(self.grid.width) * f64::from(iterations) * USUAL_STEPS;
        ((FIRST_SECONDS / (seconds * evaluations)) as u32).clamp(1, FIRST_ROWS)
    }
}

/// In `thesis` waves march even out of a solid. In the other profiles a source inside a solid emits no waves.
fn start_status(pair: Pair, settings: &Settings, compiled: &CompiledScene) -> f32 {
    if matches!(settings.algorithm, Algorithm::Thesis(_)) {
        return STATUS_STARTED;
    }
    let nearest = pair.scene.surface_distance(pair.source.position);
    match -nearest.distance > compiled.error_bound(nearest.object) {
        true => STATUS_DEAD,
        false => STATUS_STARTED,
    }
}

/// Sets the uniforms for the start directions.
pub(super) fn set_direction_uniforms(program: &Program, settings: &Settings, grid: Grid) {
    set_grid(program, grid);
    program.set_u32("uSeed", settings.seed);
    program.set_vec4("uTurn", Vec4::from(random_turn(settings.seed)));
}

fn set_grid(program: &Program, grid: Grid) {
    program.set_u32("uWaveCount", grid.waves);
    program.set_u32("uGridWidth", grid.width);
}
