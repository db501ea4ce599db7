//! Users' fields, which are checked before they are used.
//!
//! Each field is compiled separately, so that errors are reported for its own file and line. Its values are sampled on
//! a grid of 65 points per side, from which the CPU knows the solid. They are also sampled at 16,384 stars of nine
//! points in the box (`stars.rs`) and at 8,192 stars on the surface. The samples are tested for values that are not
//! finite (`finite.rs`), for growth beyond the stated limit (`growth.rs`), and for more than the stated bend
//! (`bend.rs`). Only growth between two points counts, because it proves that the limit is exceeded. (The length of a
//! gradient from differences proves nothing at a ridge.) Details narrower than the distance between points may still be
//! missed. A gradient that the text states is compared with differences (`gradient.rs`). For a text without a stated
//! gradient the derivative is compared with differences. If the derivative deviates, gradients are computed from
//! differences. A function on the CPU that the caller adds is compared with the samples (`cpu.rs`).
//!
//! # Region that is checked
//! Waves are in the air, where the value is positive. A step of a march that is proven to be free never passes a
//! surface. A relaxed step may end in the solid and is then taken back, for every negative value (a value that is not
//! finite counts as solid, see `glsl/user/value.glsl`). Gradients from differences reach a little into the solid, by at
//! most [`DEPTH`]. The field is therefore checked in the air and in the solid to that depth. Deeper in the solid, steep
//! places, jumps and values that are not finite are accepted. If the field is under an operator whose air includes
//! solid of the field ([`WaveDomain::BothSides`]), the whole box is checked.
//!
//! # Cost
//! The check runs once for each context and field. It takes one short program and about 500,000 evaluations. A field
//! that takes too long in the first pass is rejected. The check of a Menger sponge of five levels takes a tenth of a
//! second with Mesa's llvmpipe on two cores, and a few milliseconds on a graphics card. The check of a gradient takes
//! at most one more program, and another 100,000 evaluations. If the fields of a frame are already checked, the frame
//! only compares pointers.

mod bend;
mod cpu;
#[cfg(test)]
mod derivative_tests;
mod finite;
mod gradient;
mod growth;
mod stars;

use super::programs::{first_line, without_prefixes};
use super::{TraceError, field_trial};
use crate::error::Error;
use crate::gl::{
    Context, DataTexture, GpuError, Program, RenderTarget, Texture, full_screen_pass_rows,
    log_errors,
};
use crate::platform::Instant;
use crate::scene::{Scene, UserField, UserSamples, WaveDomain, halton};
use crate::shader::{self, CheckedGradient, Structure, USER_FILE};
use glam::{Vec3, Vec4};
use std::sync::Arc;

/// Samples along each side of the box.
const SIDE: usize = 65;

/// Depth of the solid that is checked like the air, as a share of the box's longest side. The differences for a
/// gradient (`glsl/user/differences.glsl`) reach 4/1024 of a power of 2 next to the largest coordinate, which is at
/// most √2 · 1/2 of that side.
const DEPTH: f32 = 1.0 / 256.0;

/// The rounding error of a value, as a share of the largest value that is possible in its box.
const ROUNDING: f32 = 1e-6;

/// Points in a row of a texture.
const ROW: usize = 1024;

/// Rows in one draw call.
const ROWS_PER_DRAW: u32 = 64;

/// Number of points for which an evaluation is timed: one row.
const TIMED: usize = ROW;

/// Steps of regula falsi that move points to the surface. The points are then within a micrometre of the surface if the
/// value is nearly that of a plane.
const CLOSER_TO_SURFACE: usize = 3;

/// Minimum number of timings. The shortest time counts, because other work on the machine can only lengthen a time.
const TIMINGS: u32 = 8;

/// Maximum seconds for the timings. A field that seems too slow is timed during this whole time.
const TIMING: f64 = 1.0;

/// Maximum seconds per evaluation, with many evaluations in parallel. This is twenty times the time of a Menger sponge.
/// At this limit a frame of 65,536 waves and eight iterations takes a minute.
const SLOWEST: f64 = 5e-6;

/// Number of remembered fields in addition to those of the scene. The number is limited because an editor makes a new
/// field with each change, and the samples of each text take one MiB.
const KNOWN: usize = 16;

/// The fields that a context has checked, each with the region in which it was checked.
#[derive(Default)]
pub struct UserFields {
    checked: Vec<(Arc<UserField>, WaveDomain)>,
}

impl UserFields {
    /// Checks the fields of the scene that are not known yet, and provides the samples of all its fields. Before the
    /// check, the fields and the `program` that will contain them are tried, as [`FieldTrial`](super::FieldTrial)
    /// states.
    ///
    /// # Errors
    /// [`Error::Trace`] for a field that cannot be used; [`Error::Gpu`] when the renderer fails.
    pub fn check(
        &mut self,
        context: &Context,
        scene: &Scene,
        structure: &Structure,
        program: impl Fn() -> String,
    ) -> Result<(), Error> {
        let fields = scene.user_domains();
        if fields
            .iter()
            .all(|(field, waves)| self.is_known(field, *waves))
        {
            return Ok(());
        }
        for (field, _) in &fields {
            TraceError::check_text(field)?;
        }
        structure.check(scene)?;
        field_trial::ensure(scene, &[&program()])?;
        let known = self.checked.len();
        let checked = self.check_new(context, &fields);
        if checked.is_ok() {
            // The program is the same as before, unless a derivative deviates from the values.
            field_trial::ensure(scene, &[&program()])?;
        }
        if self.checked.len() > known {
            self.forget_old(scene);
        }
        checked
    }

    fn is_known(&self, field: &Arc<UserField>, waves: WaveDomain) -> bool {
        let mut checked = self.checked.iter();
        checked.any(|(known, where_)| Arc::ptr_eq(known, field) && *where_ == waves)
    }

    fn check_new(
        &mut self,
        context: &Context,
        fields: &[(&Arc<UserField>, WaveDomain)],
    ) -> Result<(), Error> {
        for &(field, waves) in fields {
            if self.is_known(field, waves) {
                continue;
            }
            let alike =
                |(known, where_): &&(Arc<UserField>, _)| **known == **field && *where_ == waves;
            match self.checked.iter().find(alike) {
                // A scene that was read again has the same text, and one set of samples is enough.
                Some((known, _)) => {
                    if let (Some(samples), Some(seconds)) =
                        (known.samples(), known.evaluation_seconds())
                    {
                        field.set_passed(waves, Arc::clone(samples), seconds);
                    }
                    if let Some(agrees) = known.derivative_agrees() {
                        field.set_derivative_agrees(agrees);
                    }
                }
                // A child process has supplied the samples, so the field's own program is not needed.
                None if field.has_passed(waves) && field_trial::has_passed(field, waves) => (),
                None => check(context, field, waves)?,
            }
            cpu::compare(field, waves)?;
            self.checked.push((Arc::clone(field), waves));
        }
        Ok(())
    }

    /// Forgets the oldest fields that are not in the scene.
    fn forget_old(&mut self, scene: &Scene) {
        let is_here = |(field, _): &(Arc<UserField>, WaveDomain)| {
            scene.user_fields().any(|f| Arc::ptr_eq(f, field))
        };
        let (here, mut others): (Vec<_>, Vec<_>) = self.checked.drain(..).partition(is_here);
        let excess = others.len().saturating_sub(KNOWN);
        others.drain(..excess);
        self.checked = others;
        self.checked.extend(here);
    }
}

/// Compiles a field separately, samples it and tests it.
pub(super) fn check(context: &Context, field: &UserField, waves: WaveDomain) -> Result<(), Error> {
    let refuse = |line, message| TraceError::FieldDoesNotCompile {
        file: field.file.display().to_string(),
        line,
        message,
    };
    TraceError::check_text(field)?;
    let label = field.file.display().to_string();
    let text = shader::join(&shader::user_sources(field, CheckedGradient::Stated));
    let program = match Program::fragment(context, &label, &text) {
        Ok(program) => program,
        Err(GpuError::Compile { log, .. } | GpuError::Link { log, .. }) => {
            let (line, message) = first_error(&log);
            return Err(refuse(line, message).into());
        }
        Err(error) => return Err(error.into()),
    };
    if field.has_passed(waves) {
        return Ok(());
    }
    let probe = Probe {
        context,
        program,
        field,
        waves,
    };
    let anywhere = probe.time_anywhere()?;
    let mut grid = probe.grid()?;
    probe.check_finite_grid(&grid)?;
    probe.fill(&mut grid)?;
    let surface = probe.surface_points(&grid)?;
    let at_surface = probe.time_at_surface(&surface)?;
    let stars = probe.stars(&surface)?;
    probe.check_finite_stars(&stars, &grid)?;
    probe.check_growth(&grid, &stars)?;
    probe.check_bend(&stars)?;
    probe.check_gradient(&surface)?;
    if field.is_differentiated() {
        field.set_derivative_agrees(derivative_agrees(context, field, waves, &surface)?);
    }
    let samples = UserSamples {
        side: SIDE,
        values: grid.values,
    };
    field.set_passed(waves, Arc::new(samples), anywhere.max(at_surface));
    Ok(())
}

/// Whether the derivative of the text compiles, and agrees with differences of the values.
fn derivative_agrees(
    context: &Context,
    field: &UserField,
    waves: WaveDomain,
    surface: &[Vec3],
) -> Result<bool, Error> {
    let label = format!("the derivative of {}", field.file.display());
    let text = shader::join(&shader::user_sources(field, CheckedGradient::Derived));
    let program = match Program::fragment(context, &label, &text) {
        Ok(program) => program,
        Err(GpuError::Compile { .. } | GpuError::Link { .. }) => return Ok(false),
        Err(error) => return Err(error.into()),
    };
    let probe = Probe {
        context,
        program,
        field,
        waves,
    };
    Ok(probe.worst_gradient(surface)?.is_none())
}

/// The line and the message of the first error in the user's text, from a compiler log.
fn first_error(log: &str) -> (Option<u32>, String) {
    let errors = log_errors(log);
    // In the expansion of a macro, Mesa loses the file number but keeps the line number.
    let is_users = |file: u32| file == USER_FILE || file == 0;
    if let Some(error) = errors.iter().find(|error| is_users(error.file)) {
        return (Some(error.line), without_prefixes(&error.message));
    }
    match errors.first() {
        Some(error) => {
            let message = without_prefixes(&error.message);
            (None, format!("after its end: {message}"))
        }
        None => (None, first_line(log)),
    }
}

/// A field's program, which evaluates its values.
struct Probe<'a> {
    context: &'a Context,
    program: Program,
    field: &'a UserField,
    waves: WaveDomain,
}

/// Samples on a regular grid over the box, in the order of [`UserSamples`].
struct Grid {
    points: Vec<Vec3>,
    values: Vec<f32>,
}

impl Probe<'_> {
    /// The values on the grid.
    fn grid(&self) -> Result<Grid, Error> {
        let points: Vec<Vec3> = (0..SIDE * SIDE * SIDE).map(|i| self.place(i)).collect();
        let values = self.values(&points)?;
        Ok(Grid { points, values })
    }

    /// The depth in metres to which the solid is checked like the air.
    fn depth(&self) -> f32 {
        DEPTH * self.field.size.max_element()
    }

    /// The difference that rounding can cause between two equal values, for a field with this Lipschitz constant.
    fn rounding(&self, lipschitz: f32) -> f32 {
        ROUNDING * lipschitz * self.field.size.max_element()
    }

    /// Typical seconds per evaluation at points in the whole box. A field that is too slow is rejected here, before
    /// many evaluations are requested.
    fn time_anywhere(&self) -> Result<f64, Error> {
        let half = 0.5 * self.field.size;
        let points: Vec<Vec3> = (1..=TIMED)
            .map(|index| half * (2.0 * halton(index).as_vec3() - 1.0))
            .collect();
        // A first pass is not timed, because a driver may complete the compilation only then.
        self.values(&points[..1])?;
        self.time_at(&points)
    }

    /// Seconds per evaluation at the surface, where waves take most of their steps. The result is 0 without a surface.
    fn time_at_surface(&self, surface: &[Vec3]) -> Result<f64, Error> {
        if surface.is_empty() {
            return Ok(0.0);
        }
        let points: Vec<Vec3> = surface.iter().copied().cycle().take(TIMED).collect();
        self.time_at(&points)
    }

    /// At most [`TIMED`] points on or next to the surface, distributed over the surface.
    fn surface_points(&self, grid: &Grid) -> Result<Vec<Vec3>, Error> {
        let Grid { points, values } = grid;
        let crosses = |&(from, to): &(usize, usize)| (values[from] > 0.0) != (values[to] > 0.0);
        let mut ends: Vec<_> = neighbours().filter(crosses).collect();
        let every = ends.len().div_ceil(TIMED).max(1);
        ends = ends.into_iter().step_by(every).collect();
        if ends.is_empty() {
            return Ok(Vec::new());
        }
        let mut ways: Vec<[(Vec3, f32); 2]> = ends
            .iter()
            .map(|&(from, to)| [from, to].map(|i| (points[i], values[i])))
            .collect();
        let crossing = |[from, to]: &[(Vec3, f32); 2]| {
            let share = (from.1 / (from.1 - to.1)).clamp(0.0, 1.0);
            from.0.lerp(to.0, share)
        };
        let mut points: Vec<Vec3> = ways.iter().map(crossing).collect();
        for _ in 0..CLOSER_TO_SURFACE {
            for ((way, point), value) in ways.iter_mut().zip(&points).zip(self.values(&points)?) {
                if !value.is_finite() {
                    continue;
                }
                let side = usize::from((way[0].1 > 0.0) != (value > 0.0));
                way[side] = (*point, value);
            }
            points = ways.iter().map(crossing).collect();
        }
        Ok(points)
    }

    /// Seconds per evaluation at these points, evaluated in parallel.
    fn time_at(&self, points: &[Vec3]) -> Result<f64, Error> {
        let (mut least, mut whole, mut taken) = (f64::INFINITY, 0.0, 0);
        while whole < TIMING && (taken < TIMINGS || least > SLOWEST) {
            let began = Instant::now();
            self.values(points)?;
            let took = began.elapsed().as_secs_f64();
            least = least.min(took / points.len() as f64);
            whole += took;
            taken += 1;
        }
        // Fields of built-in scenes are known to be fast. If such a field seems slow, the machine is busy.
        if least <= SLOWEST || self.field.is_own() {
            return Ok(least.min(SLOWEST));
        }
        Err(TraceError::FieldTooSlow {
            file: self.field.file.display().to_string(),
            seconds: least,
            limit: SLOWEST,
        }
        .into())
    }

    /// The position of a sample.
    fn place(&self, index: usize) -> Vec3 {
        let along = [index % SIDE, index / SIDE % SIDE, index / (SIDE * SIDE)];
        let share = Vec3::from(along.map(|a| a as f32 / (SIDE - 1) as f32));
        self.field.size * (share - 0.5)
    }

    /// The values at these points. A value in the solid may be not finite.
    fn values(&self, points: &[Vec3]) -> Result<Vec<f32>, Error> {
        let texels = self.texels(points)?;
        Ok(texels.chunks(4).take(points.len()).map(|t| t[0]).collect())
    }

    /// Value and gradient at each point. The rest of the last row has arbitrary values.
    fn texels(&self, points: &[Vec3]) -> Result<Vec<f32>, Error> {
        if points.is_empty() {
            return Ok(Vec::new());
        }
        let width = points.len().min(ROW) as u32;
        let rows = points.len().div_ceil(ROW) as u32;
        let vectors: Vec<Vec4> = points.iter().map(|p| p.extend(0.0)).collect();
        let mut list = DataTexture::new(self.context, ROW)?;
        list.set(&vectors)?;
        let values = Texture::new(self.context, width, rows)?;
        let target = RenderTarget::new(self.context, &[&values])?;
        self.program.set_texture("uPoints", 0, list.texture());
        for start in (0..rows).step_by(ROWS_PER_DRAW as usize) {
            let band = start..start + ROWS_PER_DRAW;
            full_screen_pass_rows(self.context, &self.program, &target, width, rows, band)?;
        }
        Ok(target.read(0)?)
    }
}

/// Pairs of neighbouring samples along each axis.
fn neighbours() -> impl Iterator<Item = (usize, usize)> {
    let along = |stride: usize| {
        // The last sample of a row has no neighbour.
        (0..SIDE * SIDE * SIDE - stride)
            .filter(move |index| index / stride % SIDE < SIDE - 1)
            .map(move |index| (index, index + stride))
    };
    [1, SIDE, SIDE * SIDE].into_iter().flat_map(along)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gl::ContextOptions;
    use crate::shader::Lists;

    /// Protects long runs and edits: a field that is read again shares its samples, old fields are forgotten, and all
    /// fields of the scene are kept, regardless of their number.
    #[test]
    fn fields_of_old_scenes_are_forgotten() {
        let context = Context::headless(&ContextOptions::default()).unwrap();
        let mut fields = UserFields::default();
        let again = || Scene::load("menger").unwrap();
        let count = again().user_fields().count();
        assert!(count > 0);
        let first = again();
        let check = |fields: &mut UserFields, scene: &Scene| {
            let structure = Structure::of(scene, Lists::Lines);
            fields
                .check(&context, scene, &structure, String::new)
                .unwrap();
        };
        check(&mut fields, &first);
        let mut last = first.clone();
        for _ in 0..2 * KNOWN {
            last = again();
            check(&mut fields, &last);
        }
        assert_eq!(fields.checked.len(), KNOWN + count);
        let samples = |scene: &Scene| scene.user_fields().next().unwrap().samples().cloned();
        let (old, new) = (samples(&first).unwrap(), samples(&last).unwrap());
        assert!(Arc::ptr_eq(&old, &new));
        let known = fields.checked.clone();
        check(&mut fields, &last);
        assert!(
            known
                .iter()
                .zip(&fields.checked)
                .all(|(a, b)| Arc::ptr_eq(&a.0, &b.0))
        );
    }
}
