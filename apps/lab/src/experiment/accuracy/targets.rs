//! The project's own targets, measured and compared with their bounds.

use super::measure::wave_errors;
use super::plan::ROOMS;
use super::recommend::{ITERATIONS, comparable};
use super::report::{Chaos, Row, SceneReport, Target, WaveErrors};
use super::sweep::{BASE_WAVES, CAREFUL};
use super::truth::Truth;
use crate::stats::median;
use echomarch::Error;
use echomarch::geometry::ShoeboxImages;
use echomarch::scene::Scene;
use echomarch::tracer::{Profile, Settings, ThesisOptions, Tracer};
use glam::Vec3;

/// Number of waves for the targets on single waves and on speed.
const WAVES: u32 = 262_144;

/// Number of waves for the target on hits by order.
const MANY_WAVES: u32 = 1 << 20;

/// Number of timed frames per profile.
const FRAMES: usize = 5;

/// Measures all targets in the thesis' rooms and the shoebox. The targets on efficiency use the default rows of
/// `scenes`.
///
/// # Errors
/// Errors of [`Tracer::frame`].
pub fn measure(tracer: &mut Tracer, scenes: &[SceneReport]) -> Result<Vec<Target>, Error> {
    let mut targets = vec![hits_by_order(tracer, MANY_WAVES)?];
    let corner = Scene::builtin("corner")?;
    targets.extend(single_waves(tracer, &corner)?);
    targets.extend(speeds(tracer, &corner)?);
    let room = |name: &&str| scenes.iter().find(|scene| scene.scene == *name);
    let rooms: Vec<&SceneReport> = ROOMS.iter().filter_map(room).collect();
    targets.extend(rooms.iter().filter_map(|room| efficiencies(room)));
    targets.extend(
        rooms
            .iter()
            .filter_map(|room| against_the_best_thesis(room)),
    );
    Ok(targets)
}

impl Target {
    fn at_most(what: impl Into<String>, measured: f64, bound: f64) -> Target {
        Target {
            what: what.into(),
            measured,
            bound: Some(bound),
            at_least: false,
            met: Some(measured <= bound),
        }
    }

    fn at_least(what: impl Into<String>, measured: f64, bound: f64) -> Target {
        Target {
            what: what.into(),
            measured,
            bound: Some(bound),
            at_least: true,
            met: Some(measured >= bound),
        }
    }
}

/// Compares the number of waves heard in each iteration with the image sources. Each frame has one iteration more than
/// the previous frame.
fn hits_by_order(tracer: &mut Tracer, waves: u32) -> Result<Target, Error> {
    let scene = Scene::builtin("shoebox")?;
    let settings = Settings::hybrid().with_waves(waves);
    let mut heard = vec![0];
    for iterations in 1..=ITERATIONS {
        let settings = settings.clone().with_iterations(iterations);
        heard.push(tracer.frame(&scene, &settings)?.counts.listener_hits);
    }
    let (_, starts) = tracer.frame_with_waves(&scene, &settings.with_iterations(1))?;
    let starts: Vec<Vec3> = starts.iter().map(|wave| wave.start_direction).collect();
    let images = ShoeboxImages::new(&scene);
    let exact = images.map(|images| images.hits_by_order(&starts, ITERATIONS));
    let exact = exact.transpose()?;
    let by_order = heard.windows(2).map(|pair| pair[1].abs_diff(pair[0]));
    let pairs = by_order.zip(exact.iter().flatten());
    let worst = pairs.map(|(hits, &images)| hits.abs_diff(images)).max();
    Ok(Target::at_most(
        format!(
            "hybrid, shoebox, {waves} waves: largest difference of hits from the image sources', over all orders"
        ),
        worst.map_or(f64::NAN, |worst| worst as f64),
        2.0,
    ))
}

fn single_waves(tracer: &mut Tracer, corner: &Scene) -> Result<Vec<Target>, Error> {
    let mut truth = Truth::new(corner, WAVES.into())?;
    let mut errors_of = |settings: Settings| -> Result<WaveErrors, Error> {
        let settings = settings.with_waves(WAVES).with_iterations(ITERATIONS);
        wave_errors(tracer, &mut truth, &Chaos::default(), &settings)
    };
    let hybrid = errors_of(Settings::hybrid())?;
    let march = errors_of(Settings::march())?;
    let not_finite = (hybrid.not_finite + march.not_finite) as f64;
    let bounds = [
        (
            "hybrid, corner: waves with a wrong final status, %",
            100.0 * hybrid.status_differs,
            0.05,
        ),
        (
            "hybrid, corner: median end-point error, m",
            hybrid.end.median,
            1e-5,
        ),
        (
            "hybrid, corner: p99 of the end-point error, m",
            hybrid.end.p99,
            1e-2,
        ),
        (
            "march, corner: waves with a wrong final status, %",
            100.0 * march.status_differs,
            0.1,
        ),
        (
            "march, corner: median end-point error, m",
            march.end.median,
            1e-5,
        ),
        (
            "hybrid and march, corner: waves without a finite end (NaN)",
            not_finite,
            0.0,
        ),
    ];
    let targets = bounds.map(|(what, measured, bound)| Target::at_most(what, measured, bound));
    Ok(targets.into())
}

/// Times whole frames, in turns with the thesis' algorithm at the minimum distance [`CAREFUL`].
fn speeds(tracer: &mut Tracer, corner: &Scene) -> Result<Vec<Target>, Error> {
    let careful = Settings::new(ThesisOptions::default().with_min_distance(CAREFUL));
    let runs = [Settings::hybrid(), Settings::march(), careful]
        .map(|settings| settings.with_waves(WAVES).with_iterations(ITERATIONS));
    for settings in &runs {
        tracer.frame(corner, settings)?;
    }
    let mut times: [Vec<f64>; 3] = Default::default();
    for _ in 0..FRAMES {
        for (settings, times) in runs.iter().zip(&mut times) {
            times.push(tracer.frame(corner, settings)?.milliseconds.total);
        }
    }
    let [hybrid, march, thesis] = times.map(median);
    let what = |profile: Profile| {
        format!("{profile}, corner: waves·iterations/s relative to thesis at {CAREFUL} m")
    };
    Ok(vec![
        Target::at_least(what(Profile::Hybrid), thesis / hybrid, 8.0),
        Target::at_least(what(Profile::March), thesis / march, 0.9),
    ])
}

fn default_row(scene: &SceneReport, profile: Profile) -> Option<&Row> {
    let label = format!("{profile} default");
    scene.rows.iter().find(|row| {
        let case = &row.case;
        row.label == label && (case.waves, case.iterations) == (BASE_WAVES, ITERATIONS)
    })
}

fn efficiencies(scene: &SceneReport) -> Option<Target> {
    let hybrid = default_row(scene, Profile::Hybrid)?.panning.efficiency;
    let thesis = default_row(scene, Profile::Thesis)?.panning.efficiency;
    Some(Target::at_least(
        format!("hybrid, {}: efficiency relative to thesis", scene.scene),
        hybrid / thesis,
        30.0,
    ))
}

/// The comparison with the thesis' algorithm at its best settings. This comparison has no bound.
fn against_the_best_thesis(scene: &SceneReport) -> Option<Target> {
    let hybrid = default_row(scene, Profile::Hybrid)?;
    let name = Profile::Thesis.to_string();
    let thesis = comparable(&scene.rows).filter(|row| row.case.profile == name);
    let by_efficiency = |a: &&Row, b: &&Row| a.panning.efficiency.total_cmp(&b.panning.efficiency);
    let best = thesis.max_by(by_efficiency)?;
    Some(Target {
        what: format!(
            "hybrid, {}: efficiency relative to the best of thesis ({}, {} waves)",
            scene.scene, best.label, best.case.waves
        ),
        measured: hybrid.panning.efficiency / best.panning.efficiency,
        bound: None,
        at_least: true,
        met: None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects `met`: it is true if and only if the value satisfies the bound.
    #[test]
    fn targets_are_held_against_their_bounds() {
        assert_eq!(Target::at_most("", 2.0, 2.0).met, Some(true));
        assert_eq!(Target::at_most("", 2.1, 2.0).met, Some(false));
        assert_eq!(Target::at_most("", f64::NAN, 2.0).met, Some(false));
        assert_eq!(Target::at_least("", 30.0, 30.0).met, Some(true));
        assert_eq!(Target::at_least("", 29.9, 30.0).met, Some(false));
    }
}
