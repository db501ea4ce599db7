//! Measures the cost or saving of each option, with one option changed at a time.

use super::Bench;
use super::change::Change;
use super::pair::{Case, Timing, pair};
use echomarch::Error;
use echomarch::tracer::{MARCHES_PER_PASS, Profile, Settings, Tracer};
use serde::Serialize;

/// A row in which one setting is changed.
#[derive(Clone, Debug, Serialize)]
pub struct OptionRow {
    /// The change, in the form of the command-line option if there is one.
    pub name: String,
    /// The march time saved by the change.
    pub march: Timing,
    /// The time of the whole frame saved by the change.
    pub total: Timing,
    /// The audible change; `None` if no wave is heard before the change.
    pub change: Option<Change>,
    /// Whether the audible effect of another seed is at least as large.
    pub within_noise: bool,
}

/// Settings with one change.
pub(super) struct Variant {
    name: String,
    settings: Settings,
}

/// The variants of the requested settings. Invalid variants are excluded, and so are variants whose effect is below the
/// noise of a busy processor (docs/cost.md).
pub(super) fn variants(asked: &Settings) -> Vec<Variant> {
    let mut all = Vec::new();
    let mut add = |name: &str, settings: Settings| {
        if settings.validate().is_ok() && settings != *asked {
            all.push(Variant {
                name: name.to_owned(),
                settings,
            });
        }
    };
    let same = || asked.clone();
    for profile in Profile::ALL.into_iter().filter(|&p| p != asked.profile()) {
        add(
            &format!("--profile {profile}"),
            same().with_profile(profile),
        );
    }
    if asked.iterations > 1 {
        let per_pass = match asked.iterations_per_pass {
            1 => asked.iterations.min(MARCHES_PER_PASS),
            _ => 1,
        };
        let name = format!("--iterations-per-pass {per_pass}");
        add(&name, same().with_iterations_per_pass(per_pass));
    }
    add("half the waves", same().with_waves(asked.waves / 2));
    let half = asked.iterations / 2;
    add("half the iterations", same().with_iterations(half));
    all
}

/// Compares every variant with the requested settings.
pub(super) fn measure(
    tracer: &mut Tracer,
    bench: &Bench,
    variants: Vec<Variant>,
    step: &mut dyn FnMut(),
) -> Result<Vec<OptionRow>, Error> {
    let mut rows = Vec::new();
    for variant in variants {
        let changed = Case {
            scene: bench.base.scene,
            settings: &variant.settings,
        };
        let frames = pair(tracer, bench.base, changed, bench.runs)?;
        let change = Change::of(
            (&frames.base, bench.base.settings.waves),
            (&frames.changed, variant.settings.waves),
        );
        rows.push(OptionRow {
            name: variant.name,
            march: frames.march(bench.control_percent),
            total: frames.total(bench.control_total_percent),
            change,
            within_noise: change.is_some_and(|change| change.is_within(bench.noise)),
        });
        step();
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the rows: each variant differs from the requested settings, and can be traced.
    #[test]
    fn every_variant_is_another_and_valid() {
        for profile in Profile::ALL {
            let asked = Settings::new(profile)
                .with_waves(1000)
                .with_sum_on_gpu(true);
            let all = variants(&asked);
            assert_eq!(all.len(), 5, "{profile}");
            for variant in &all {
                assert!(variant.settings != asked, "{}", variant.name);
                assert!(variant.settings.validate().is_ok(), "{}", variant.name);
            }
        }
        let least = Settings::hybrid().with_waves(1).with_iterations(1);
        assert!(variants(&least).iter().all(|v| !v.name.contains("half")));
    }
}
