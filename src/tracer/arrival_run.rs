//! The constant data of a trace of arrivals, and the chunks in which it is drawn.

use super::arrivals::{
    ArrivalSettings, ArrivalTargets, Detector, DetectorDensity, EventTable,
    ITERATIONS_BEFORE_RESAMPLING, MOST_LIMITS, OpenVolumes, Replay, Start, WAVES_IN_BLOCK,
    compiled_detectors,
};
use super::gpu_scene::check_uniforms;
use super::prepared::{FramePrograms, PreparedFrame};
use super::programs::{ScenePass, loops_asked, start_order};
use super::{Algorithm, Grid, Profile, Settings, TraceError, Tracer};
use crate::bands::{self, BAND_COUNT, Bands};
use crate::error::Error;
use crate::gl::{Context, Program};
use crate::platform::Instant;
use crate::sampling::{hash, unit_interval};
use crate::scene::{Pair, Scene, Source, Surface};
use crate::shader::{ArrivalsText, LoopsAsked, Materials, StartOrderText, Structure};
use glam::{Vec3, Vec4};
use rayon::prelude::*;
use std::ops::Range;
use std::rc::Rc;

/// Maximum uniform vectors of the shader besides those of surfaces and materials.
const OWN_VECTORS: usize = 40;

/// The constant data of one call of [`Tracer::arrivals`].
pub(super) struct Run {
    pub frame: PreparedFrame,
    /// Number of the first wave from the source.
    pub first_wave: u32,
    pub program: Rc<Program>,
    pub replay: Replay,
    /// The wave that starts at a texel.
    pub order: StartOrderText,
    /// The values of `uMaterials`.
    pub materials: Vec<Vec4>,
    /// The detectors' centres relative to the shaders' origin, and their radii.
    pub detectors: Vec<Vec4>,
    /// The planes that limit the detectors.
    pub limits: Vec<Vec4>,
    /// Radii of the inner spheres in metres; 0 without one.
    pub inner_radii_m: Vec<f32>,
    /// The open volume of the first detector's sphere.
    pub open_volume_m3: f64,
    /// Maximum iterations of a wave.
    pub iterations: u32,
    /// Iterations of a chunk.
    pub iterations_in_chunk: u32,
    /// Whether waves of a block are replaced by waves of about equal energy.
    pub resamples: bool,
    /// Bands that the waves carry.
    pub bands: Range<usize>,
    /// A block of waves is followed while its waves have more than this share of their initial energy.
    pub least_energy: f64,
}

/// A chunk to be drawn.
pub(super) struct Part {
    pub first_wave: u32,
    /// Whether the starts of the waves have been uploaded to the textures that the first chunk reads.
    pub is_uploaded: bool,
    /// Whether each wave continues the wave of its original's texel.
    pub is_resampled: bool,
    pub first_iteration: u32,
    pub iterations: u32,
    pub rows: Range<u32>,
}

impl Run {
    /// A random number, 0 … 1, for resampling a block before an iteration.
    pub fn random(&self, first_wave: u32, iteration: u32) -> f64 {
        let numbers = [self.frame.settings.seed, first_wave, iteration];
        let mixed = numbers
            .iter()
            .fold(0, |mixed, number| hash(mixed ^ u64::from(*number)));
        unit_interval(mixed)
    }
}

impl Part {
    /// The next chunk, if waves in some rows must still be followed.
    pub fn next(&self, run: &Run, rows: Range<u32>) -> Option<Part> {
        let first_iteration = self.first_iteration + self.iterations;
        let left = run.iterations - first_iteration;
        (left > 0 && !rows.is_empty()).then(|| Part {
            first_wave: self.first_wave,
            is_uploaded: self.is_uploaded,
            is_resampled: false,
            first_iteration,
            iterations: left.min(run.iterations_in_chunk),
            rows,
        })
    }
}

impl Tracer {
    /// Compiles the program of arrivals, and provides its textures and constant data.
    pub(super) fn prepare_arrivals(
        &mut self,
        (pair, detectors): (Pair, &[Detector]),
        settings: &Settings,
        how: &ArrivalSettings,
        (materials, waves): (Materials, u32),
    ) -> Result<Run, Error> {
        let scene = pair.scene;
        let profile = settings.profile();
        if profile == Profile::Thesis {
            let profile = profile.to_string();
            return Err(TraceError::NoArrivals { profile }.into());
        }
        how.validate()?;
        let mut settings = settings.clone().with_count_evaluations(false);
        settings.algorithm = Algorithm::of(profile);
        let compiled_detectors = compiled_detectors(detectors.len());
        let asked = loops_asked(&settings);
        let outputs = self.context.limits().most_outputs().min(how.outputs);
        let order = start_order(scene, &settings);
        let march = (asked.algorithm, settings.directions, order);
        let text = ArrivalsText {
            has_inner_sphere: detectors.iter().any(|one| one.inner_radius.is_some()),
            detectors: compiled_detectors,
            // They depend on the surfaces, not on their positions: moving a surface compiles no shader.
            limits: match scene.surfaces.iter().any(Surface::is_obstacle) {
                true => MOST_LIMITS as u32,
                false => 0,
            },
            ..ArrivalsText::new(march, &materials, how.records, outputs)
        };
        let in_chunk = text.most_iterations().unwrap_or(Settings::MAX_ITERATIONS);
        settings.iterations_per_pass = in_chunk.min(how.iterations_in_chunk);
        if how.resamples && materials.scatter() {
            settings.iterations_per_pass = settings
                .iterations_per_pass
                .min(ITERATIONS_BEFORE_RESAMPLING);
        }
        let asked = LoopsAsked {
            detectors: compiled_detectors,
            ..loops_asked(&settings)
        };
        let structure = self.check_input(scene, &settings)?;
        let values = materials.uniform_values(&structure.layout.unrolled);
        let vectors = values.len() + text.detector_vectors();
        check_materials(&self.context, scene, &structure, (&materials, vectors))?;
        // Drops a frame in progress, because its scene data are replaced.
        self.give_up_marching();
        let rebasing = asked.algorithm.rebasing(pair.listener);
        self.scene.set(scene, rebasing, structure, &materials)?;
        let of_detector = |one: &Detector| one.open_volumes(scene);
        let volumes: Vec<OpenVolumes> = detectors.par_iter().map(of_detector).collect();
        // Without scattering the copies of a wave would stay together.
        let materials_scatter = materials.scatter();
        let compiled = &self.scene.compiled;
        let program = {
            let programs = &mut self.shared.borrow_mut().programs;
            let pass = ScenePass::Arrivals(text.clone());
            programs.of_scene(&self.context, (scene, &compiled.structure), pass)?
        };
        let programs = FramePrograms::WholeFrame {
            frame: Rc::clone(&program),
            in_order: None,
        };
        let (budget, now) = (compiled.budget(&asked), Instant::now());
        let frame = PreparedFrame::new(pair, &settings, compiled, budget, programs, now);
        let value = |one: &Detector| compiled.local(one.position).extend(one.radius);
        let detector_values = detectors.iter().map(value).collect();
        self.provide_arrival_targets(waves, &text)?;
        Ok(Run {
            first_wave: 0,
            iterations_in_chunk: iterations_in_chunk(&frame, &text),
            materials: values,
            order,
            replay: Replay {
                early_order: how.early_order,
                length_limit: how.seconds * scene.speed_of_sound(),
                chord_unit: 4.0
                    * detectors
                        .iter()
                        .map(|one| f64::from(one.radius))
                        .fold(0.0, f64::max),
                detectors: (volumes.iter())
                    .map(|volumes| DetectorDensity::of(volumes, settings.waves))
                    .collect(),
                has_inner_spheres: text.has_inner_sphere,
                events: EventTable::of(materials),
                origin: frame.origin.as_dvec3(),
            },
            detectors: detector_values,
            limits: detectors.iter().flat_map(|one| one.limits).collect(),
            inner_radii_m: (detectors.iter())
                .map(|one| one.inner_radius.unwrap_or(0.0))
                .collect(),
            open_volume_m3: volumes.first().map_or(0.0, |volumes| volumes.whole),
            iterations: how.iterations,
            resamples: how.resamples && materials_scatter,
            least_energy: how.least_energy,
            bands: how.bands.clone(),
            frame,
            program,
        })
    }

    /// Creates the textures, unless existing ones match this number of waves. Larger textures do not: the order of the
    /// waves that are resampled depends on the size, and the results would depend on earlier traces.
    fn provide_arrival_targets(&mut self, waves: u32, text: &ArrivalsText) -> Result<(), Error> {
        let grid = Grid::new(waves.clamp(1, WAVES_IN_BLOCK));
        let will_do = |known: &ArrivalTargets| known.grid == grid && known.is_for(text);
        if !self.arrival_targets.as_ref().is_some_and(will_do) {
            // The old textures are dropped before the new ones are created.
            self.arrival_targets = None;
            let targets = ArrivalTargets::new(&self.context, grid, text.clone())?;
            self.arrival_targets = Some(targets);
        }
        Ok(())
    }
}

/// The energies of waves at the source, with its directivity. `directed` has the directions of waves without given
/// starts if the source has a directivity. The result is empty if all energies are 1 and no reflection changes them.
pub(super) fn start_energies(
    run: &Run,
    source: &Source,
    (starts, directed): (Option<&[Start]>, Option<&[Vec3]>),
    waves: usize,
) -> Vec<Bands> {
    let traced = run.bands.clone();
    let in_bands = |energies: Bands| {
        std::array::from_fn(|band| match traced.contains(&band) {
            true => energies[band],
            false => 0.0,
        })
    };
    let factor = |direction: &Vec3| source.factor(direction.as_dvec3());
    if let Some(starts) = starts {
        let energy = |start: &Start| {
            let weight = f64::from(start.weight);
            in_bands(factor(&start.direction).map(|factor| weight * factor))
        };
        return starts.par_iter().map(energy).collect();
    }
    if let Some(directed) = directed {
        let energy = |direction: &Vec3| in_bands(factor(direction));
        return directed.par_iter().map(energy).collect();
    }
    let are_all_one = run.replay.events.is_none() && traced == (0..BAND_COUNT);
    match !are_all_one {
        true => vec![in_bands(bands::ALL); waves],
        false => Vec::new(),
    }
}

/// Iterations of a chunk. If the maximum number of loop turns determines this number, one iteration is left out to make
/// room for the loop over words, which takes fewer turns than an iteration does.
fn iterations_in_chunk(frame: &PreparedFrame, text: &ArrivalsText) -> u32 {
    let fit = frame.budget.iterations_per_pass;
    let is_limited = fit < frame.settings.iterations_per_pass && text.event_bits > 0;
    if is_limited { (fit - 1).max(1) } else { fit }
}

/// Rejects too many different materials, and materials that do not fit in the uniforms, before anything is compiled.
fn check_materials(
    context: &Context,
    scene: &Scene,
    structure: &Structure,
    (materials, vectors): (&Materials, usize),
) -> Result<(), TraceError> {
    let bits = materials.bits();
    if bits > Materials::MOST_BITS {
        return Err(TraceError::BadSetting {
            what: "materials of the scene",
            must: format!("at most {}", 1 << (Materials::MOST_BITS - 1)),
            value: materials.count().to_string(),
        });
    }
    check_uniforms(context, scene, structure, OWN_VECTORS + vectors)
}
