//! Runs a target on corrupted files. Every test program that includes this module reads the environment variables
//! described in `main.rs`.

use super::mutate::Mutator;
use super::target::Target;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};

/// Number of inputs per target in a run without `ECHOMARCH_FUZZ_RUNS`.
const SHORT_RUN: u64 = 400;

/// Maximum time for an input of a few kilobytes. It is long enough for a machine with other load.
const LONGEST: Duration = Duration::from_secs(20);

/// Time between progress messages in a long run.
const BETWEEN_LINES: Duration = Duration::from_secs(10);

fn from_environment(name: &str, otherwise: u64) -> u64 {
    match std::env::var(name) {
        Ok(value) => value
            .parse()
            .unwrap_or_else(|_| panic!("{name} must be a whole number, not {value:?}")),
        Err(_) => otherwise,
    }
}

/// Runs a target on corrupted files. A file that causes a failure is written to the folder for temporary files.
pub fn fuzz(target: &Target) {
    let seed = from_environment("ECHOMARCH_FUZZ_SEED", 1);
    let first = from_environment("ECHOMARCH_FUZZ_FIRST", 0);
    let runs = from_environment("ECHOMARCH_FUZZ_RUNS", SHORT_RUN);
    for file in &target.corpus {
        (target.one)(file);
    }
    let mut told = Instant::now();
    for index in first..first + runs {
        let data = Mutator::new(seed, index).spoilt(&target.corpus, target.tokens);
        let began = Instant::now();
        let outcome = catch_unwind(AssertUnwindSafe(|| (target.one)(&data)));
        let (name, took) = (target.name, began.elapsed());
        // The time is checked only in long runs, which are started manually on an otherwise idle machine.
        if outcome.is_err() || (runs > SHORT_RUN && took > LONGEST) {
            let path = std::env::temp_dir().join(format!("echomarch-fuzz-{name}-{seed}-{index}"));
            let kept = std::fs::write(&path, &data);
            panic!(
                "{name}: input {index} of seed {seed} ({} bytes, {took:?}); kept as {}: {kept:?}",
                data.len(),
                path.display()
            );
        }
        if told.elapsed() > BETWEEN_LINES {
            told = Instant::now();
            println!("{name}: {} of {runs}", index + 1 - first);
        }
    }
}
