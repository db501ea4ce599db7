//! One frame after the other on one context.

use super::frame::in_milliseconds;
use super::programs::Programs;
use super::waves::unpack_counters;
use super::{Counts, Frame, Grid, Milliseconds, Panning, Settings, TraceError, Wave, panning};
use crate::error::Error;
use crate::gpu::{
    Clock, Context, GpuError, PingPong, Program, RenderTarget, Target, Texture,
    full_screen_pass_rows,
};
use crate::scene::{Scene, glsl};
use glam::{Vec3, Vec4};
use std::rc::Rc;
use std::time::Instant;

/// Waves in one draw call at the most: a frame of more is drawn in bands, so that
/// a graphics card's watchdog does not take a long pass for a hang.
const WAVES_PER_DRAW: u32 = 1 << 20;

/// Uniform vectors that the shaders need beside those of the surfaces.
const OWN_UNIFORM_VECTORS: usize = 16;

/// Traces frames. Programs and textures are kept from frame to frame: a frame that
/// only moves things compiles nothing and allocates nothing on the GPU.
pub struct Tracer {
    context: Context,
    clock: Clock,
    programs: Programs,
    targets: Option<Targets>,
    contributions: Vec<f32>,
}

/// The textures for one count of waves: the two pairs, and the panning texture.
struct Targets {
    grid: Grid,
    pairs: PingPong,
    pan: (Texture, RenderTarget),
}

impl Tracer {
    /// A tracer on `context`.
    ///
    /// # Errors
    /// [`Error::Gpu`] when a shader does not compile on this renderer.
    pub fn new(context: &Context) -> Result<Tracer, Error> {
        Ok(Tracer {
            context: context.clone(),
            clock: Clock::for_context(context)?,
            programs: Programs::new(context)?,
            targets: None,
            contributions: Vec::new(),
        })
    }

    /// The context that the frames run on.
    pub fn context(&self) -> &Context {
        &self.context
    }

    /// How the times of passes are taken.
    pub fn clock_name(&self) -> &'static str {
        self.clock.name()
    }

    /// Programs compiled since the tracer was made.
    pub fn programs_compiled(&self) -> usize {
        self.programs.compiled()
    }

    /// Traces one frame of the scene as it stands.
    ///
    /// The first frame of a scene's structure compiles a program; its time is in
    /// `total`. Everything else is the same for every frame.
    ///
    /// # Errors
    /// [`Error::Scene`] and [`Error::Trace`] for input that cannot be traced,
    /// [`Error::Gpu`] when the renderer fails.
    pub fn frame(&mut self, scene: &Scene, settings: &Settings) -> Result<Frame, Error> {
        let began = Instant::now();
        let march = self.prepare(scene, settings)?;
        let initialise = self.initialise(scene, settings)?;
        let march = self.iterate(&march, settings)?;
        self.finish(scene, began, initialise, march)
    }

    /// Traces one frame and reads back every wave, in order.
    ///
    /// # Errors
    /// As [`Tracer::frame`].
    pub fn frame_with_waves(
        &mut self,
        scene: &Scene,
        settings: &Settings,
    ) -> Result<(Frame, Vec<Wave>), Error> {
        let began = Instant::now();
        let march = self.prepare(scene, settings)?;
        let initialise = self.initialise(scene, settings)?;
        let starts = self.read_pair()?;
        let march = self.iterate(&march, settings)?;
        let ends = self.read_pair()?;
        let frame = self.finish(scene, began, initialise, march)?;
        Ok((frame, waves(&starts, &ends)))
    }

    /// Follows every wave: its state after the start and after each iteration.
    ///
    /// The outer list has `settings.iterations + 1` entries, the inner ones a wave
    /// each. Meant for pictures and tests of few waves.
    ///
    /// # Errors
    /// As [`Tracer::frame`].
    pub fn paths(&mut self, scene: &Scene, settings: &Settings) -> Result<Vec<Vec<Wave>>, Error> {
        let march = self.prepare(scene, settings)?;
        self.initialise(scene, settings)?;
        let starts = self.read_pair()?;
        let mut states = vec![waves(&starts, &starts)];
        for _ in 0..settings.iterations {
            self.march(&march)?;
            states.push(waves(&starts, &self.read_pair()?));
        }
        Ok(states)
    }
}

/// The parts of a frame, in order.
impl Tracer {
    /// Checks the input, gets the program and the textures, and sets every uniform
    /// of the march: the same for all iterations.
    fn prepare(&mut self, scene: &Scene, settings: &Settings) -> Result<Rc<Program>, Error> {
        scene.validate()?;
        settings.validate()?;
        let grid = Grid::new(settings.waves);
        self.check_limits(scene, grid)?;
        if self.targets.as_ref().is_none_or(|t| t.grid != grid) {
            // The old textures go before the new ones come.
            self.targets = None;
            self.targets = Some(Targets::new(&self.context, grid)?);
        }
        let march = self
            .programs
            .march(&self.context, scene, settings.profile)?;
        set_march_uniforms(&march, scene, settings, grid);
        Ok(march)
    }

    /// Waves that do not fit in a texture and surfaces that do not fit in the
    /// uniforms are told before anything is allocated.
    fn check_limits(&self, scene: &Scene, grid: Grid) -> Result<(), TraceError> {
        let limits = self.context.limits();
        let renderer = || self.context.renderer().to_owned();
        let limit = limits.max_texture_size;
        if grid.width > limit {
            return Err(TraceError::TooManyWaves {
                waves: grid.waves,
                side: grid.width,
                limit,
                most: u64::from(limit) * u64::from(limit),
                renderer: renderer(),
            });
        }
        let needed = glsl::uniform_values(scene).len() + OWN_UNIFORM_VECTORS;
        let limit = limits.max_fragment_uniform_vectors as usize;
        if needed > limit {
            return Err(TraceError::TooManySurfaces {
                surfaces: scene.surfaces.len(),
                needed,
                limit,
                renderer: renderer(),
            });
        }
        Ok(())
    }

    fn initialise(&self, scene: &Scene, settings: &Settings) -> Result<f64, Error> {
        let targets = self.targets()?;
        let program = &self.programs.initialise;
        set_grid(program, targets.grid);
        program.set_vec3("uSource", scene.source.position);
        program.set_u32("uSeed", settings.seed);
        self.pass(program, targets.grid, targets.pairs.current())
    }

    fn iterate(&mut self, program: &Program, settings: &Settings) -> Result<f64, Error> {
        let mut time = 0.0;
        for _ in 0..settings.iterations {
            time += self.march(program)?;
        }
        Ok(time)
    }

    fn march(&mut self, program: &Program) -> Result<f64, Error> {
        let targets = self.targets()?;
        let current = targets.pairs.current();
        program.set_texture("uOrigins", 0, &current.first);
        program.set_texture("uDirections", 1, &current.second);
        let time = self.pass(program, targets.grid, targets.pairs.next())?;
        if let Some(targets) = &mut self.targets {
            targets.pairs.flip();
        }
        Ok(time)
    }

    fn finish(
        &mut self,
        scene: &Scene,
        began: Instant,
        initialise: f64,
        march: f64,
    ) -> Result<Frame, Error> {
        let pan = self.pan(scene)?;
        let reading = Instant::now();
        let (panning, counts) = self.read_back()?;
        Ok(Frame {
            panning,
            counts,
            milliseconds: Milliseconds {
                initialise,
                march,
                pan,
                read_back: in_milliseconds(reading.elapsed()),
                total: in_milliseconds(began.elapsed()),
            },
        })
    }

    fn pan(&self, scene: &Scene) -> Result<f64, Error> {
        let targets = self.targets()?;
        let program = &self.programs.pan;
        let current = targets.pairs.current();
        program.set_texture("uOrigins", 0, &current.first);
        program.set_texture("uDirections", 1, &current.second);
        program.set_vec4("uListener", listener_uniform(scene));
        program.set_vec3("uListenerRight", scene.listener.right());
        self.pass(program, targets.grid, &targets.pan.1)
    }

    fn read_back(&mut self) -> Result<(Panning, Counts), Error> {
        let Some(targets) = &self.targets else {
            return Err(TraceError::NothingTraced.into());
        };
        let Grid {
            waves,
            width,
            height,
        } = targets.grid;
        let target = &targets.pan.1;
        target.read_into(0, width, height, &mut self.contributions)?;
        Ok(panning::sum(&self.contributions[..4 * waves as usize]))
    }

    /// Both textures of the current pair, the texels beyond the last wave left out.
    fn read_pair(&self) -> Result<[Vec<f32>; 2], Error> {
        let targets = self.targets()?;
        let length = 4 * targets.grid.waves as usize;
        let target = &targets.pairs.current().target;
        let mut origins = target.read(0)?;
        let mut directions = target.read(1)?;
        origins.truncate(length);
        directions.truncate(length);
        Ok([origins, directions])
    }

    /// Draws one pass in bands of at most [`WAVES_PER_DRAW`] waves and takes its
    /// time in milliseconds.
    fn pass(&self, program: &Program, grid: Grid, target: &impl Target) -> Result<f64, Error> {
        let rows = (WAVES_PER_DRAW / grid.width).max(1);
        let draw = || {
            for start in (0..grid.height).step_by(rows as usize) {
                let band = start..start + rows;
                let (width, height) = (grid.width, grid.height);
                full_screen_pass_rows(&self.context, program, target, width, height, band)?;
            }
            Ok::<(), Error>(())
        };
        let (drawn, time) = self.clock.measure(draw)?;
        drawn?;
        Ok(in_milliseconds(time))
    }

    fn targets(&self) -> Result<&Targets, TraceError> {
        self.targets.as_ref().ok_or(TraceError::NothingTraced)
    }
}

impl Targets {
    fn new(context: &Context, grid: Grid) -> Result<Targets, GpuError> {
        let pan = Texture::new(context, grid.width, grid.height)?;
        let pan_target = RenderTarget::new(context, &[&pan])?;
        Ok(Targets {
            grid,
            pairs: PingPong::new(context, grid.width, grid.height)?,
            pan: (pan, pan_target),
        })
    }
}

fn set_march_uniforms(program: &Program, scene: &Scene, settings: &Settings, grid: Grid) {
    set_grid(program, grid);
    program.set_vec4_array("uSurfaces", &glsl::uniform_values(scene));
    program.set_vec4("uListener", listener_uniform(scene));
    program.set_f32("uMinDistance", settings.min_distance);
    program.set_f32("uMaxDistance", settings.max_distance);
    program.set_f32("uStartOffset", settings.start_offset);
    program.set_f32("uNormalStep", settings.normal_step);
    program.set_i32("uStepBound", settings.step_bound() as i32);
}

fn set_grid(program: &Program, grid: Grid) {
    program.set_u32("uWaveCount", grid.waves);
    program.set_u32("uGridWidth", grid.width);
}

fn listener_uniform(scene: &Scene) -> Vec4 {
    scene.listener.position.extend(scene.listener.radius)
}

/// Pairs up what was read back after the start and at the end.
fn waves(starts: &[Vec<f32>; 2], ends: &[Vec<f32>; 2]) -> Vec<Wave> {
    let texels = |texture: &[f32]| texture.as_chunks::<4>().0.to_vec();
    let starts = texels(&starts[1]);
    let ends = texels(&ends[0]).into_iter().zip(texels(&ends[1]));
    let wave = |(start, (origin, direction)): ([f32; 4], ([f32; 4], [f32; 4]))| {
        let (zero_length_passes, guard_hits) = unpack_counters(direction[3]);
        Wave {
            start_direction: xyz(start),
            position: xyz(origin),
            direction: xyz(direction),
            status: origin[3],
            zero_length_passes,
            guard_hits,
        }
    };
    starts.into_iter().zip(ends).map(wave).collect()
}

fn xyz(texel: [f32; 4]) -> Vec3 {
    Vec3::new(texel[0], texel[1], texel[2])
}
