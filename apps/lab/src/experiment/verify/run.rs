//! Runs the hard cases with every profile.

use super::case::{Bound, Case, Check, EnergyCheck, WaveCheck};
use super::judge::Judge;
use super::report::{CaseReport, ProfileResult, VerifyReport};
use echomarch::Error;
use echomarch::scene::Scene;
use echomarch::tracer::{Profile, Settings, Tracer};

/// Runs the cases. `progress` receives the number of completed cases and the total.
///
/// # Errors
/// [`Error::Gpu`] if OpenGL fails. A failed case is not an error.
pub fn run(
    tracer: &mut Tracer,
    cases: &[Case],
    progress: &mut dyn FnMut(u64, u64),
) -> Result<VerifyReport, Error> {
    let mut reports = Vec::new();
    for case in cases {
        reports.push(run_case(tracer, case)?);
        progress(reports.len() as u64, cases.len() as u64);
    }
    Ok(VerifyReport {
        renderer: tracer.context().renderer().to_owned(),
        cases: reports,
    })
}

/// Runs one case.
///
/// # Errors
/// The errors of [`run`].
pub fn run_case(tracer: &mut Tracer, case: &Case) -> Result<CaseReport, Error> {
    let results = match &case.check {
        Check::Refused(inputs) => Profile::ALL.map(|p| refusals(tracer, p, inputs)).into(),
        Check::Energies(check) => {
            let mut results = Vec::new();
            for profile in Profile::ALL {
                results.push(energies(tracer, profile, check)?);
            }
            results
        }
        Check::Waves(waves) => {
            let truth = waves.truth.as_deref().unwrap_or(&waves.scene);
            let judge = Judge::new(truth, waves.iterations)?;
            let mut results = Vec::new();
            for profile in Profile::ALL {
                results.push(waves.by(tracer, profile, &judge)?);
            }
            results
        }
    };
    Ok(CaseReport {
        name: case.name.clone(),
        hard: case.hard.to_owned(),
        exact: case.exact.clone(),
        bound: in_words(&case.check),
        results,
    })
}

impl WaveCheck {
    fn by(
        &self,
        tracer: &mut Tracer,
        profile: Profile,
        judge: &Judge,
    ) -> Result<ProfileResult, Error> {
        let settings = Settings::new(profile).with_iterations(self.iterations);
        let states = tracer.trace_directions(&self.scene, &settings, &self.directions)?;
        let mut result = judge.judge(&states, &self.bound, profile);
        result.profile = profile.to_string();
        // The planted answers also check the reference.
        if let Bound::Planted { share, answers } = &self.bound {
            let reference = judge.exact_against(&self.directions, answers);
            if reference > *share {
                result.passed = false;
                result.note = format!("the reference itself has an error of {reference:e}");
            }
        }
        Ok(result)
    }
}

fn refusals(
    tracer: &mut Tracer,
    profile: Profile,
    inputs: &[(&'static str, Scene, Settings)],
) -> ProfileResult {
    let mut taken = Vec::new();
    let mut refused = 0;
    for (what, scene, settings) in inputs {
        if settings.profile() != profile {
            continue;
        }
        let outcome = tracer.frame(scene, settings);
        match outcome.is_err_and(|error| error.is_bad_input()) {
            true => refused += 1,
            false => taken.push(*what),
        }
    }
    let note = if taken.is_empty() {
        format!("{refused} of {refused} refused")
    } else {
        format!("taken: {}", taken.join(", "))
    };
    ProfileResult {
        profile: profile.to_string(),
        passed: taken.is_empty(),
        note,
        ..ProfileResult::default()
    }
}

fn energies(
    tracer: &mut Tracer,
    profile: Profile,
    check: &EnergyCheck,
) -> Result<ProfileResult, Error> {
    let (passed, note) = match profile {
        Profile::Thesis => (false, "carries no energy".to_owned()),
        _ => {
            let verdict = (check.judge)(tracer, &Settings::new(profile))?;
            (verdict.passed, verdict.note)
        }
    };
    Ok(ProfileResult {
        profile: profile.to_string(),
        passed,
        note,
        ..ProfileResult::default()
    })
}

fn in_words(check: &Check) -> String {
    let waves = match check {
        Check::Refused(_) => return "a typed error".to_owned(),
        Check::Energies(check) => return check.bound.to_owned(),
        Check::Waves(waves) => waves,
    };
    match &waves.bound {
        Bound::Spread { exceptions: 0.0 } => "spread".to_owned(),
        Bound::Spread { exceptions: 1.0 } => {
            "no bound on ends: no NaN, no solid, length 1, none lost, same number heard".to_owned()
        }
        Bound::Spread { exceptions } => format!("spread, except {} %", 100.0 * exceptions),
        Bound::Planted { share, .. } => format!("{share:.0e} of extent or path"),
    }
}
