//! The passes that trace arrivals: waves that pass a transparent listener.

use super::arrival_run::{Part, Run, start_energies};
use super::arrivals::{
    ArrivalCounts, ArrivalSettings, ArrivalTargets, Block, Detector, Followed, LISTED_AT_MOST,
    Listed, MOST_PASSAGES, Passage, Transmitting, WAVES_IN_BLOCK, WavesToFollow, kept, listed_rows,
    most_detectors, thinned,
};
use super::block_waves::Waves;
use super::start_order::Starts;
use super::targets::draw;
use super::{Grid, Settings, TraceError, Tracer};
use crate::arrival::Arrival;
use crate::error::Error;
use crate::gl::RenderTarget;
use crate::scene::{IntoPair, Pair};
use crate::shader::{self, Materials};
use glam::DVec3;
use std::ops::Range;

/// Waves are followed farther than the requested distance, by this share of it. The GPU sums distances in `f32`, which
/// rounds by 6e-8 in each of at most 4,095 chunks. Arrivals beyond the requested distance are left out on
/// the CPU.
const FARTHER: f64 = 3e-4;

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
            let materials = (materials, waves.count());
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
