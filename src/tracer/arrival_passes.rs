//! The passes that trace arrivals: waves that pass a transparent listener.

use super::arrivals::{
    ArrivalCounts, ArrivalSettings, ArrivalTargets, Block, Detector, DetectorDensity, EventTable,
    Followed, ITERATIONS_BEFORE_RESAMPLING, LISTED_AT_MOST, Listed, MOST_LIMITS, MOST_PASSAGES,
    OpenVolumes, Passage, Replay, Start, Transmitting, WAVES_IN_BLOCK, WavesToFollow,
    compiled_detectors, kept, listed_rows, most_detectors, thinned,
};
use super::block_waves::Waves;
use super::gpu_scene::check_uniforms;
use super::prepared::{FramePrograms, PreparedFrame};
use super::programs::{ScenePass, loops_asked, start_order};
use super::start_order::Starts;
use super::targets::draw;
use super::{Algorithm, Grid, Profile, Settings, TraceError, Tracer};
use crate::arrival::Arrival;
use crate::bands::{self, BAND_COUNT, Bands};
use crate::error::Error;
use crate::gl::{Context, Program, RenderTarget};
use crate::platform::Instant;
use crate::sampling::{hash, unit_interval};
use crate::scene::{IntoPair, Pair, Scene, Source, Surface};
use crate::shader::{self, ArrivalsText, LoopsAsked, Materials, StartOrderText, Structure};
use glam::{DVec3, Vec3, Vec4};
use rayon::prelude::*;
use std::ops::Range;
use std::rc::Rc;

/// Waves are followed farther than the requested distance, by this share of it. The GPU sums distances in `f32`, which
/// rounds by 6e-8 in each of at most 4,095 chunks. Arrivals beyond the requested distance are left out on
/// the CPU.
const FARTHER: f64 = 3e-4;

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
    order: StartOrderText,
    /// The values of `uMaterials`.
    materials: Vec<Vec4>,
    /// The detectors' centres relative to the shaders' origin, and their radii.
    detectors: Vec<Vec4>,
    /// The planes that limit the detectors.
    limits: Vec<Vec4>,
    /// Radii of the inner spheres in metres; 0 without one.
    inner_radii_m: Vec<f32>,
    /// The open volume of the first detector's sphere.
    open_volume_m3: f64,
    /// Maximum iterations of a wave.
    iterations: u32,
    /// Iterations of a chunk.
    iterations_in_chunk: u32,
    /// Whether waves of a block are replaced by waves of about equal energy.
    resamples: bool,
    /// Bands that the waves carry.
    bands: Range<usize>,
    /// A block of waves is followed while its waves have more than this share of their initial energy.
    least_energy: f64,
}

/// A chunk to be drawn.
struct Part {
    first_wave: u32,
    /// Whether the starts of the waves have been uploaded to the textures that the first chunk reads.
    is_uploaded: bool,
    /// Whether each wave continues the wave of its original's texel.
    is_resampled: bool,
    first_iteration: u32,
    iterations: u32,
    rows: Range<u32>,
}

impl Run {
    /// A random number, 0 … 1, for resampling a block before an iteration.
    fn random(&self, first_wave: u32, iteration: u32) -> f64 {
        let numbers = [self.frame.settings.seed, first_wave, iteration];
        let mixed = numbers
            .iter()
            .fold(0, |mixed, number| hash(mixed ^ u64::from(*number)));
        unit_interval(mixed)
    }
}

impl Part {
    /// The next chunk, if waves in some rows must still be followed.
    fn next(&self, run: &Run, rows: Range<u32>) -> Option<Part> {
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
    /// Follows waves past the listener, which does not stop them, and passes every crossing of the listener's sphere to
    /// `take`. The crossings are in the order of the waves, for 262,144 waves and a number of iterations at a time. The
    /// same input gives the same arrivals, bit for bit on one renderer. If bands scatter differently, the waves are
    /// followed once for each group of bands that scatter alike. The energies of all other bands are then 0. No wave
    /// passes a solid.
    ///
    /// From `settings`, only the algorithm, the waves, the seed, the directions and the maximum distance are used.
    /// `how` determines the distance for which waves are followed. `take` must not call OpenGL.
    ///
    /// ```
    /// use echomarch::gl::Context;
    /// use echomarch::tracer::ArrivalSettings;
    /// use echomarch::{Scene, Settings, Tracer};
    ///
    /// let mut tracer = Tracer::new(&Context::headless(&Default::default())?)?;
    /// let scene = Scene::builtin("shoebox")?;
    /// let settings = Settings::default().with_waves(4096);
    /// let mut energy = 0.0;
    /// let counts = tracer.arrivals(&scene, &settings, &ArrivalSettings::new(0.2), &mut |arrival| {
    ///     energy += arrival.energy[4]; // at 1 kHz
    /// })?;
    /// assert!(counts.arrivals > 0 && energy > 0.0);
    /// # Ok::<(), echomarch::Error>(())
    /// ```
    ///
    /// # Errors
    /// The errors of [`Tracer::frame`]; [`TraceError::NoArrivals`] in the profile `thesis`; [`TraceError::BadSetting`]
    /// for numbers of `how` out of their range.
    pub fn arrivals<'a>(
        &mut self,
        pair: impl IntoPair<'a>,
        settings: &Settings,
        how: &ArrivalSettings,
        take: &mut dyn FnMut(Arrival),
    ) -> Result<ArrivalCounts, Error> {
        let pair = pair.chosen()?;
        let all = WavesToFollow::Numbers(0..settings.waves);
        let mut counts = ArrivalCounts::of_none();
        for bands in shader::band_groups(pair.scene, shader::Spread::OfDecay) {
            let how = how.clone().with_bands(bands);
            let followed = self.arrivals_of(pair, settings, &how, &all, take)?;
            counts = counts.and(followed.counts());
        }
        Ok(counts)
    }

    /// Follows a part of the waves, or waves with given starts. All of them carry `how.bands`.
    pub(crate) fn arrivals_of(
        &mut self,
        pair: Pair,
        settings: &Settings,
        how: &ArrivalSettings,
        waves: &WavesToFollow,
        take: &mut dyn FnMut(Arrival),
    ) -> Result<Followed, Error> {
        let own = [Detector::of(pair.listener)];
        self.arrivals_through((pair, &own), settings, how, waves, take, None)
    }

    /// Maximum number of detectors that share the waves of a source.
    pub(crate) fn most_detectors(&self) -> usize {
        most_detectors(self.context.limits().max_fragment_uniform_vectors)
    }

    /// Follows waves like [`arrivals_of`](Self::arrivals_of) past all `detectors`, at most [`Self::most_detectors`], and
    /// then the parts of their energy that pass solids. The pair's listener is the origin of the shaders' coordinates. The
    /// counts are those of the waves from the source.
    pub(crate) fn arrivals_through(
        &mut self,
        (pair, detectors): (Pair, &[Detector]),
        settings: &Settings,
        how: &ArrivalSettings,
        waves: &WavesToFollow,
        take: &mut dyn FnMut(Arrival),
        transmitting: Option<Transmitting>,
    ) -> Result<Followed, Error> {
        let settings = match waves {
            WavesToFollow::Numbers(_) => settings.clone(),
            WavesToFollow::Starts { waves, .. } => settings.clone().with_waves(*waves),
        };
        // Waves with given starts need no directions from the settings.
        let directed = match waves {
            WavesToFollow::Numbers(_) if !pair.source.directivity.is_omnidirectional() => {
                Some(self.start_directions(&settings)?)
            }
            _ => None,
        };
        let _entered = self.context.enter()?;
        self.aside(|tracer| {
            let materials = match &transmitting {
                None => Materials::of(pair.scene, how.bands.clone()),
                Some(_) => Materials::with_transmission(pair.scene, how.bands.clone()),
            };
            let mut run = tracer.prepare_arrivals((pair, detectors), &settings, how, materials)?;
            run.first_wave = waves.first();
            let mut counts = ArrivalCounts {
                open_volume_m3: run.open_volume_m3,
                ..ArrivalCounts::default()
            };
            let (mut cut_off_m, mut passages) = (Vec::new(), Vec::new());
            for numbers in waves.blocks(WAVES_IN_BLOCK) {
                let starts = waves.starts(&numbers);
                let starts = starts.as_deref();
                let of_block = numbers.start as usize..numbers.end as usize;
                let directed = directed.as_ref().map(|all| &all[of_block]);
                let energies = start_energies(&run, pair.source, (starts, directed), numbers.len());
                let waves = Waves::FromSource(numbers.clone(), starts, energies);
                let mut of_block = Vec::new();
                let (block, arrivals) =
                    tracer.arrivals_of_block(&run, waves, &mut of_block, take)?;
                block.count(&mut counts);
                counts.arrivals += arrivals;
                cut_off_m.extend(block.cut_off_m());
                let most = kept(numbers.len() as u32, 1);
                passages.extend(thinned(of_block, most, run.passage_seed(1, numbers.start)));
            }
            if let Some(transmitting) = transmitting {
                tracer.arrivals_of_passages(&run, (passages, &counts), transmitting)?;
            }
            let waves = counts.waves.max(1) as f64;
            counts.energy_under_way = counts.energy_under_way.map(|energy| energy / waves);
            Ok(Followed { counts, cut_off_m })
        })
    }

    fn prepare_arrivals(
        &mut self,
        (pair, detectors): (Pair, &[Detector]),
        settings: &Settings,
        how: &ArrivalSettings,
        materials: Materials,
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
        self.provide_arrival_targets(&settings, &text)?;
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

    /// Creates the textures, unless existing ones match these waves.
    fn provide_arrival_targets(
        &mut self,
        settings: &Settings,
        text: &ArrivalsText,
    ) -> Result<(), Error> {
        let grid = Grid::new(settings.waves.min(WAVES_IN_BLOCK));
        let will_do = |known: &ArrivalTargets| known.grid.waves >= grid.waves && known.is_for(text);
        if !self.arrival_targets.as_ref().is_some_and(will_do) {
            // The old textures are dropped before the new ones are created.
            self.arrival_targets = None;
            let targets = ArrivalTargets::new(&self.context, grid, text.clone())?;
            self.arrival_targets = Some(targets);
        }
        Ok(())
    }

    /// Follows the waves of a block through all their chunks, and returns the number of their arrivals. While one chunk
    /// is drawn, the previous chunk is summed.
    pub(super) fn arrivals_of_block(
        &mut self,
        run: &Run,
        waves: Waves,
        passages: &mut Vec<Passage>,
        take: &mut dyn FnMut(Arrival),
    ) -> Result<(Block, u64), Error> {
        let Some(mut targets) = self.arrival_targets.take() else {
            return Err(TraceError::NothingTraced.into());
        };
        let grid = Grid {
            waves: waves.count(),
            ..targets.grid
        };
        let mut block = self.start_block(run, &mut targets, grid, &waves)?;
        let mut part = Part {
            first_wave: waves.first(),
            is_uploaded: waves.are_uploaded(),
            is_resampled: false,
            first_iteration: 0,
            iterations: run.iterations_in_chunk.min(run.iterations),
            rows: 0..grid.waves.div_ceil(grid.width),
        };
        self.set_arrival_uniforms(run, grid);
        self.set_passage_uniforms(run, waves.generation());
        self.draw_chunk(run, &targets, &part)?;
        let mut arrivals = 0;
        loop {
            targets.read(part.rows.end)?;
            block.rows = part.rows.clone();
            let list = block.list(targets.tally(), targets.text.records);
            let listed = self.draw_lists(run, &targets, &part, &list)?;
            let mut next = part.next(run, block.rows_travelling(targets.tally()));
            targets.flip();
            if let Some(next) = next.as_ref().filter(|_| !run.resamples) {
                self.draw_chunk(run, &targets, next)?;
            }
            let chunk = targets.chunk(&listed, part.iterations);
            arrivals += block.replay(&run.replay, &chunk, passages, take);
            // Resampling needs the energies at the end of this chunk, so the next chunk waits for them.
            if let Some(next) = next.as_mut().filter(|_| run.resamples) {
                let random = run.random(waves.first(), next.first_iteration);
                if let Some(originals) = block.resample(random, &mut next.rows) {
                    targets.upload_originals(&originals)?;
                    next.is_resampled = true;
                }
                self.draw_chunk(run, &targets, next)?;
            }
            if passages.len() > MOST_PASSAGES {
                let seed = run.passage_seed(waves.generation(), block.iterations);
                *passages = thinned(std::mem::take(passages), MOST_PASSAGES / 2, seed);
            }
            match next {
                // If no energy is left, the chunk that is being drawn is not read.
                Some(next) if block.has_energy(run.least_energy) => part = next,
                Some(_) => {
                    block.end_flights();
                    break;
                }
                None => break,
            }
        }
        self.arrival_targets = Some(targets);
        Ok((block, arrivals))
    }

    /// Sorts and uploads the starts of a block.
    fn start_block(
        &self,
        run: &Run,
        targets: &mut ArrivalTargets,
        grid: Grid,
        waves: &Waves,
    ) -> Result<Block, Error> {
        let Settings {
            directions,
            seed,
            waves: of,
            ..
        } = run.frame.settings;
        let (context, grid_and_order) = (&self.context, (grid, run.order));
        let (numbers, given) = waves.starts();
        let of_settings = Starts::new(directions, seed, of, numbers);
        let order =
            targets.sort_starts(context, grid_and_order, (of_settings, given.as_deref()))?;
        match waves {
            Waves::FromSource(numbers, starts, energies) => {
                if let Some(starts) = starts {
                    targets.upload_starts(run.frame.start(), starts)?;
                }
                Ok(Block::new(numbers.start, (grid, order), energies.clone()))
            }
            Waves::Passages(passages, ..) => {
                let local = |point: DVec3| (point - run.replay.origin).as_vec3();
                targets.upload_passages(passages, local)?;
                Ok(Block::of_passages((grid, order), passages))
            }
        }
    }

    fn set_arrival_uniforms(&self, run: &Run, grid: Grid) {
        run.frame.set_march_uniforms();
        self.scene.set_uniforms(&run.program);
        let limit = run.replay.length_limit * (1.0 + FARTHER);
        run.program.set_u32("uGridWidth", grid.width);
        run.program.set_f32("uLengthLimit", limit as f32);
        let scale = 1.0 / run.replay.chord_unit;
        run.program.set_f32("uChordScale", scale as f32);
        run.program.set_vec4_array("uDetectors", &run.detectors);
        run.program
            .set_i32("uDetectorCount", run.detectors.len() as i32);
        run.program.set_vec4_array("uLimits", &run.limits);
        run.program.set_f32_array("uInnerRadii", &run.inner_radii_m);
        run.program.set_vec4_array("uMaterials", &run.materials);
        if let Some(events) = &run.replay.events {
            let count = events.materials().count();
            run.program.set_f32("uMaterialCount", count as f32);
        }
    }

    fn draw_chunk(&self, run: &Run, targets: &ArrivalTargets, part: &Part) -> Result<(), Error> {
        let program = &run.program;
        program.set_i32("uIsListed", 0);
        program.set_texture("uList", 3, &targets.current()[0]);
        self.draw_part(
            run,
            targets,
            part,
            targets.next(),
            targets.grid,
            part.rows.clone(),
        )
    }

    /// Draws the listed waves again, and reads their records back.
    fn draw_lists(
        &self,
        run: &Run,
        targets: &ArrivalTargets,
        part: &Part,
        list: &[Listed],
    ) -> Result<Vec<Vec<f32>>, Error> {
        let mut records = vec![Vec::new(); targets.text.records as usize];
        let (width, height) = targets.list.size();
        let grid = Grid {
            waves: width * height,
            width,
            height,
        };
        for piece in list.chunks(LISTED_AT_MOST) {
            targets.list.upload(piece)?;
            let program = &run.program;
            program.set_i32("uIsListed", 1);
            program.set_texture("uList", 3, &targets.list.waves);
            let rows = 0..listed_rows(piece.len());
            self.draw_part(run, targets, part, &targets.list.target, grid, rows)?;
            targets.list.read(piece.len(), &mut records)?;
        }
        Ok(records)
    }

    fn draw_part(
        &self,
        run: &Run,
        targets: &ArrivalTargets,
        part: &Part,
        target: &RenderTarget,
        grid: Grid,
        rows: Range<u32>,
    ) -> Result<(), Error> {
        let program = &run.program;
        let [origins, directions] = targets.current();
        program.set_texture("uOrigins", 0, origins);
        program.set_texture("uDirections", 1, directions);
        targets.bind_order(program);
        program.set_texture("uOriginals", 5, targets.originals());
        program.set_i32("uIsResampled", i32::from(part.is_resampled));
        self.scene.bind(program, 2);
        let is_start = part.first_iteration == 0 && !part.is_uploaded;
        program.set_i32("uIsStart", i32::from(is_start));
        program.set_u32("uStartIteration", part.first_iteration);
        program.set_u32("uIterationsBefore", part.first_iteration);
        program.set_u32("uFirstWave", part.first_wave);
        program.set_i32("uIterationsInChunk", part.iterations as i32);
        let evaluations = run.frame.evaluations(&self.context, part.iterations);
        draw(&self.context, program, grid, target, evaluations, rows)
    }
}

/// The energies of waves at the source, with its directivity. `directed` has the directions of waves without given
/// starts if the source has a directivity. The result is empty if all energies are 1 and no reflection changes them.
fn start_energies(
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
