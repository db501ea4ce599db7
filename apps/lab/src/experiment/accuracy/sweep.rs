//! The settings to run.
//!
//! The quick sweep changes one setting at a time from each profile's defaults. The full sweep combines all settings
//! that change the result. At the default numbers of waves and iterations, it also combines the settings that should
//! change only the speed. The short sweep is a part of the quick sweep, for scenes with a slow exact reference.

use super::report::CaseReport;
use echomarch::scene::Scene;
use echomarch::tracer::{Algorithm, Budget, Directions, Profile, Settings};

/// Minimum distances in metres.
pub const MIN_DISTANCES: [f32; 6] = [1e-4, 1e-3, 1e-2, 0.03, 0.1, 0.3];

/// Minimum distance in metres with which the thesis' algorithm traces most waves correctly.
pub const CAREFUL: f32 = 1e-3;

/// Numbers of iterations, with the default in the middle.
pub const ITERATIONS: [u32; 3] = [4, 8, 16];

/// Number of waves in each profile's defaults, and in rows that change another setting.
pub const BASE_WAVES: u32 = 65_536;

/// Number of waves in the defaults of the quick sweep. With 16 seeds per row, more waves would take too long.
pub const QUICK_WAVES: u32 = 32_768;

/// Number of waves in the defaults of the short sweep.
pub const SHORT_WAVES: u32 = 16_384;

/// Number of waves of `thesis` in the short sweep of a scene with surfaces in cells.
const SHORT_THESIS_WAVES: u32 = 1024;

/// Settings with a name.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// The difference from the profile's defaults, as text.
    pub label: String,
    /// The settings.
    pub settings: Settings,
}

impl Case {
    fn new(label: &str, settings: Settings) -> Case {
        Case {
            label: format!("{} {label}", settings.profile()),
            settings,
        }
    }

    /// Returns a copy of the case with one change.
    fn but(&self, label: &str, change: impl FnOnce(&mut Settings)) -> Case {
        let mut settings = self.settings.clone();
        change(&mut settings);
        let label = match self.label.as_str() {
            of if of.ends_with(" default") => of.replace("default", label),
            of => format!("{of}, {label}"),
        };
        Case { label, settings }
    }

    /// The description of the case in the report of a scene.
    pub fn report(&self, scene: &Scene) -> CaseReport {
        let settings = &self.settings;
        let min_distance = match &settings.algorithm {
            Algorithm::Hybrid | Algorithm::March => None,
            Algorithm::Thesis(thesis) => Some(thesis.min_distance),
        };
        CaseReport {
            profile: settings.profile().to_string(),
            min_distance,
            iterations: settings.iterations,
            waves: settings.waves,
            directions: settings.directions.to_string(),
            fused: Budget::of(scene, settings).iterations_per_pass >= settings.iterations,
            sum_on_gpu: settings.sum_on_gpu,
        }
    }
}

/// Normalises settings: settings with the same computation become equal.
fn computed(settings: &Settings) -> Settings {
    let mut computed = settings.clone();
    computed.iterations_per_pass = settings.iterations_per_pass.min(settings.iterations);
    computed
}

/// Changes one setting at a time.
pub fn quick() -> Vec<Case> {
    let mut cases = Vec::new();
    for profile in Profile::ALL {
        let default = Case::new("default", Settings::new(profile).with_waves(BASE_WAVES));
        let iterations = default.settings.iterations;
        let with = |waves| resized(&default, waves, iterations);
        cases.extend([BASE_WAVES, 4096, 262_144].map(with));
        let base = with(QUICK_WAVES);
        cases.extend(ITERATIONS.map(|iterations| resized(&base, QUICK_WAVES, iterations)));
        if profile == Profile::Thesis {
            cases.extend(min_distances(&base));
        }
        cases.extend(options(&base));
        if profile == Profile::Hybrid {
            let lattice = turned(&base, Directions::Fibonacci);
            let waves = [1024, 4096, 16_384, BASE_WAVES, 262_144, 524_288];
            cases.extend(waves.map(|waves| resized(&lattice, waves, iterations)));
            let summed = every(&base);
            let waves = [4096, QUICK_WAVES, 262_144];
            cases.extend(waves.map(|waves| resized(&summed, waves, iterations)));
        }
    }
    named(cases)
}

/// Changes one setting at a time, only among the settings that affect marched fields or cells in particular. If
/// surfaces are in cells, a wave of `thesis` takes about thirty times as long as a wave of `hybrid`. `thesis` therefore
/// runs only with its defaults and few waves.
pub fn short(in_cells: bool) -> Vec<Case> {
    let mut cases = Vec::new();
    for profile in Profile::ALL {
        let base = Case::new("default", Settings::new(profile).with_waves(SHORT_WAVES));
        let iterations = base.settings.iterations;
        match profile {
            Profile::Hybrid => {
                cases.push(base.clone());
                cases.push(resized(&base, SHORT_WAVES, 4));
                cases.push(other_passes(&base));
                let lattice = turned(&base, Directions::Fibonacci);
                let waves = [1024, 4096, 16_384];
                cases.extend(waves.map(|waves| resized(&lattice, waves, iterations)));
            }
            Profile::March => cases.push(base),
            Profile::Thesis if in_cells => {
                cases.push(resized(&base, SHORT_THESIS_WAVES, iterations));
            }
            Profile::Thesis => cases.extend([base.clone(), at_distance(&base, CAREFUL)]),
        }
    }
    named(cases)
}

/// All combinations of settings, including the options.
pub fn full() -> Vec<Case> {
    let mut cases = quick();
    for profile in Profile::ALL {
        let base = Case::new("default", Settings::new(profile).with_waves(BASE_WAVES));
        let mut distances = vec![base.clone()];
        if profile == Profile::Thesis {
            distances.extend(min_distances(&base));
        }
        for case in &distances {
            for directions in [Directions::Random, Directions::Fibonacci] {
                let case = &turned(case, directions);
                cases.extend(ITERATIONS.iter().flat_map(|&iterations| {
                    [4096, BASE_WAVES, 262_144].map(|waves| resized(case, waves, iterations))
                }));
                cases.extend(options_together(case));
            }
        }
        for directions in [Directions::Random, Directions::Fibonacci] {
            cases.push(turned(&base, directions).but("", |s| s.waves = 1_048_576));
        }
    }
    named(cases)
}

/// Completes the labels, and removes cases that repeat an earlier computation.
fn named(cases: Vec<Case>) -> Vec<Case> {
    let mut kept: Vec<Case> = Vec::new();
    for mut case in cases {
        let profile = case.settings.profile().to_string();
        let changes = case.label.strip_prefix(&profile).unwrap_or(&case.label);
        let changes: Vec<&str> = changes.split(',').map(str::trim).collect();
        let changes: Vec<&str> = changes.into_iter().filter(|it| !it.is_empty()).collect();
        case.label = match changes.is_empty() {
            true => format!("{profile} default"),
            false => format!("{profile} {}", changes.join(", ")),
        };
        let computes = computed(&case.settings);
        if kept.iter().all(|it| computed(&it.settings) != computes) {
            kept.push(case);
        }
    }
    kept
}

fn min_distances(base: &Case) -> Vec<Case> {
    let distance = |&metres: &f32| at_distance(base, metres);
    MIN_DISTANCES.iter().map(distance).collect()
}

fn at_distance(base: &Case, metres: f32) -> Case {
    base.but(&format!("{metres} m"), |s| match &mut s.algorithm {
        Algorithm::Hybrid | Algorithm::March => (),
        Algorithm::Thesis(thesis) => thesis.min_distance = metres,
    })
}

fn resized(case: &Case, waves: u32, iterations: u32) -> Case {
    case.but("", |s| {
        s.waves = waves;
        s.iterations = iterations;
    })
}

fn turned(case: &Case, directions: Directions) -> Case {
    match directions {
        Directions::Random => case.clone(),
        Directions::Fibonacci => case.but("fibonacci", |s| s.directions = directions),
    }
}

/// Cases that change one option each.
fn options(base: &Case) -> Vec<Case> {
    let mut cases = vec![
        base.but("fibonacci", |s| s.directions = Directions::Fibonacci),
        base.but("GPU sum", |s| s.sum_on_gpu = true),
        other_passes(base),
    ];
    if base.settings.profile() == Profile::March {
        cases.push(every(base));
    }
    cases
}

/// Every combination of the options.
fn options_together(base: &Case) -> Vec<Case> {
    let mut cases = vec![base.clone()];
    cases.extend(cases.clone().iter().map(other_passes));
    let sums: Vec<Case> = cases
        .iter()
        .map(|c| c.but("GPU sum", |s| s.sum_on_gpu = true))
        .collect();
    cases.extend(sums);
    cases
}

/// Switches to the alternative of the profile's default, which is either all iterations in one pass or one iteration
/// per pass.
fn other_passes(base: &Case) -> Case {
    match base.settings.iterations_per_pass {
        1 => base.but("fused", |s| {
            s.iterations_per_pass = Settings::MAX_ITERATIONS
        }),
        _ => base.but("one iteration per pass", |s| s.iterations_per_pass = 1),
    }
}

/// Sets every option that may make a profile's defaults faster or more accurate without a disadvantage.
fn every(base: &Case) -> Case {
    base.but("GPU sum, fibonacci", |s| {
        s.sum_on_gpu = true;
        s.directions = Directions::Fibonacci;
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use echomarch::scene::shape::Torus;
    use echomarch::scene::{Node, Surface};

    /// Protects the sweep from settings that cannot be traced, and from duplicate computations.
    #[test]
    fn every_case_is_valid_and_there_once() {
        for cases in [short(false), short(true), quick(), full()] {
            for (index, case) in cases.iter().enumerate() {
                assert!(case.settings.validate().is_ok(), "{}", case.label);
                let later = &cases[index + 1..];
                let computes = computed(&case.settings);
                let again = later.iter().find(|it| computed(&it.settings) == computes);
                assert!(again.is_none(), "{}: {again:?}", case.label);
                let profile = case.settings.profile().to_string() + " ";
                let changes = case.label.strip_prefix(&profile).unwrap();
                assert!(changes.starts_with(char::is_alphanumeric), "{}", case.label);
            }
        }
        let full = full();
        let quick = quick();
        assert!(quick.iter().all(|case| full.contains(case)));
        for short in [short(false), short(true)] {
            let is_known = |case: &Case| quick.iter().any(|it| it.label == case.label);
            assert!(short.iter().all(is_known) && short.len() < quick.len() / 2);
            for profile in Profile::ALL {
                assert!(short.iter().any(|case| case.settings.profile() == profile));
            }
        }
    }

    /// Protects the label "fused": it must agree with the tracer, which decides how many iterations fit into a pass of
    /// the scene.
    #[test]
    fn fused_is_what_runs_in_one_pass() {
        let corner = Scene::builtin("corner").unwrap();
        let fused = |scene: &Scene, profile, iterations, per_pass| {
            let mut settings = Settings::new(profile).with_iterations(iterations);
            settings.iterations_per_pass = per_pass;
            Case::new("", settings).report(scene).fused
        };
        for profile in [Profile::Thesis, Profile::March] {
            assert!(fused(&corner, profile, 8, Settings::MAX_ITERATIONS));
            assert!(!fused(&corner, profile, 64, Settings::MAX_ITERATIONS));
            assert!(!fused(&corner, profile, 4, 1));
        }
        assert!(fused(
            &corner,
            Profile::Hybrid,
            16,
            Settings::MAX_ITERATIONS
        ));
        assert!(!fused(&corner, Profile::Hybrid, 16, 8));
        let torus = Node::Torus(Torus {
            ring: 2.0,
            tube: 0.5,
        });
        let mut marched = corner;
        marched.surfaces.push(Surface::new(torus));
        assert!(fused(
            &marched,
            Profile::Hybrid,
            8,
            Settings::MAX_ITERATIONS
        ));
        assert!(!fused(
            &marched,
            Profile::Hybrid,
            64,
            Settings::MAX_ITERATIONS
        ));
    }
}
