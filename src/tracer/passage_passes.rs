//! The passes that trace passages of waves through solids, generation by generation (`arrivals/passages.rs`).

use super::Tracer;
use super::arrival_run::Run;
use super::arrivals::{
    ArrivalCounts, LEAST_GENERATION, MOST_GENERATIONS, PASSAGE_SHARE, Passage, Transmitting,
    WAVES_IN_BLOCK, kept, kept_beside_waves, loudest, thinned,
};
use super::block_waves::Waves;
use crate::error::Error;
use crate::sampling::hash;
use rayon::prelude::*;

impl Run {
    /// The seed of random numbers for passages of a generation and a block. Waves with other numbers have other passages.
    pub fn passage_seed(&self, generation: u32, block: u32) -> u64 {
        let which = u64::from(generation) << 32 | u64::from(block);
        let seed = u64::from(self.first_wave) << 32 | u64::from(self.frame.settings.seed);
        hash(hash(which).wrapping_add(seed))
    }
}

impl Tracer {
    /// Follows passages of waves, then the passages of these passages, and so on, until the energy of a generation is
    /// negligible. `counts` are those of the waves from the source.
    pub(super) fn arrivals_of_passages(
        &mut self,
        run: &Run,
        (mut passages, counts): (Vec<Passage>, &ArrivalCounts),
        transmitting: Transmitting,
    ) -> Result<(), Error> {
        let Transmitting { through, take } = transmitting;
        let waves = (counts.waves as u32).max(1);
        let least = LEAST_GENERATION * f64::from(waves);
        for generation in 1..=MOST_GENERATIONS {
            let behind = passages.par_iter().filter_map(|one| one.behind(through));
            let mut behind: Vec<Passage> = behind.collect();
            let energy = loudest(&behind);
            if energy <= least {
                break;
            }
            if counts.arrivals > 0 {
                let most = kept_beside_waves(waves, generation, energy / f64::from(waves));
                behind = thinned(behind, most, !run.passage_seed(generation, 0));
            }
            let most = kept(waves, generation + 1);
            passages = Vec::new();
            let mut first = 0;
            for block in behind.chunks(waves.min(WAVES_IN_BLOCK) as usize) {
                let of_block = Waves::Passages(block, generation, first);
                let mut further = Vec::new();
                self.arrivals_of_block(run, of_block, &mut further, take)?;
                let most = most * block.len() / behind.len();
                let seed = run.passage_seed(generation + 1, first);
                passages.extend(thinned(further, most.max(1), seed));
                first += block.len() as u32;
            }
        }
        Ok(())
    }

    /// Sets the uniforms of passages. Each generation (0: the waves from the source) has its own random numbers.
    pub(super) fn set_passage_uniforms(&self, run: &Run, generation: u32) {
        let Some(events) = &run.replay.events else {
            return;
        };
        let (program, transmitting) = (&run.program, events.materials().transmitting());
        if transmitting.is_empty() {
            return;
        }
        let numbers = [transmitting.start, transmitting.end].map(|number| number as f32);
        program.set_vec2("uPassing", numbers.into());
        program.set_f32("uPassageShare", PASSAGE_SHARE as f32);
        program.set_u32("uPassageSeed", run.passage_seed(generation, 0) as u32);
        if generation > 0 {
            program.set_u32("uSeed", (run.passage_seed(generation, 0) >> 32) as u32);
        }
    }
}
