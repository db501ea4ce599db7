//! The accuracy experiment with few waves: its files, and its figures compared with independent ones. These tests fail
//! without OpenGL.

use echomarch::geometry::ShoeboxImages;
use echomarch::gl::{Context, ContextOptions};
use echomarch::tracer::{Directions, FieldTrial};
use echomarch::{Profile, Scene, Settings, Tracer};
use echomarch_lab::experiment::accuracy::{
    self, AccuracyOptions, AccuracyReport, Case, GYROID, Plan, Row, quick,
};
use echomarch_lab::report::Report;
use glam::Vec3;

const WAVES: u32 = 65_536;

fn tracer() -> Tracer {
    FieldTrial::InThisProcess.set(); // The only text is the program's own.
    let context = Context::headless(&ContextOptions::default()).unwrap_or_else(|e| panic!("{e}"));
    Tracer::new(&context).unwrap()
}

/// A report with only a few frames, which is quickly computed.
fn report(scene: &str, settings: &[Settings]) -> AccuracyReport {
    let case = |settings: &Settings| Case {
        label: settings.profile().to_string(),
        settings: settings.clone(),
    };
    let plan = Plan {
        scene: match scene {
            GYROID => accuracy::gyroid(),
            name => Scene::builtin(name).unwrap(),
        },
        cases: settings.iter().map(case).collect(),
        limit_directions: 20_000,
        compared_waves: WAVES,
        twin_seeds: 2,
        chaos_pairs: 16_384,
        slope_waves: vec![256, 1024],
    };
    let options = AccuracyOptions {
        plans: vec![plan],
        seeds: 2,
        ..AccuracyOptions::quick(Vec::new())
    };
    let mut steps = (0, 0);
    let report = accuracy::run(&mut tracer(), &options, &mut |done, total| {
        assert_eq!(done, steps.0 + 1);
        steps = (done, total);
    });
    let report = report.unwrap();
    assert_eq!(steps.0, steps.1, "exactly all steps are reported");
    report
}

fn rows(report: &AccuracyReport) -> &[Row] {
    &report.scenes[0].rows
}

/// The hits by order in the experiment equal those of image sources, which the experiment does not use.
#[test]
fn hits_by_order_are_those_of_the_image_sources() {
    let settings = Settings::hybrid().with_waves(WAVES);
    let scene = Scene::builtin("shoebox").unwrap();
    let (_, waves) = tracer().frame_with_waves(&scene, &settings).unwrap();
    let starts: Vec<Vec3> = waves.iter().map(|wave| wave.start_direction).collect();
    let images = ShoeboxImages::new(&scene).unwrap();
    let expected = images.hits_by_order(&starts, settings.iterations).unwrap();
    let report = report("shoebox", &[settings]);
    let found = &rows(&report)[0].waves;
    assert_eq!(found.exact_hits, expected);
    assert!(found.largest_hit_difference() <= 2, "{found:?}");
}

/// The default profiles have the expected accuracy, and the thesis' profile does not.
#[test]
fn the_corner_is_right_but_for_the_thesis() {
    let settings = [Settings::hybrid(), Settings::march(), Settings::thesis()];
    let report = report("corner", &settings.map(|s| s.with_waves(WAVES)));
    let [hybrid, march, thesis] = rows(&report) else {
        panic!("three rows");
    };
    for (row, status) in [(hybrid, 5e-4), (march, 1e-3)] {
        let waves = &row.waves;
        assert!(waves.status_differs <= status, "{}: {waves:?}", row.label);
        assert!(waves.sequence_differs <= 2.0 * status);
        assert!(waves.end.median <= 1e-5 && waves.end.p99 <= 1e-2);
        assert_eq!((waves.not_finite, waves.compared), (0, u64::from(WAVES)));
        assert!(row.panning.twin_bias.abs() < 1e-3);
    }
    assert!(thesis.waves.status_differs > 0.1 && thesis.waves.end.median > 1.0);
    assert!(hybrid.panning.efficiency > 30.0 * thesis.panning.efficiency);
    assert_eq!(hybrid.speed.evaluations_per_flight, 0.0);
    assert!(thesis.speed.evaluations_per_flight > march.speed.evaluations_per_flight);
    let chaos = &report.scenes[0].chaos;
    assert_eq!((chaos.growth, chaos.horizon), (None, None));
}

/// Pillars make paths chaotic, so the report has a growth, a horizon, and waves beyond the horizon.
#[test]
fn obstacles_have_a_horizon() {
    let settings = Settings::hybrid().with_waves(4096).with_iterations(16);
    let report = report("obstacles", &[settings]);
    let chaos = &report.scenes[0].chaos;
    assert!(chaos.growth.unwrap() > 2.0, "{chaos:?}");
    let waves = &rows(&report)[0].waves;
    assert!(waves.beyond_horizon > 0.0 && waves.beyond_horizon < 0.5);
    assert!(waves.end_within_horizon.p99 <= waves.end.p99);
}

/// Marched fields, a user's field and surfaces in cells are as accurate as rooms. Each wave meets the same surfaces as
/// its exact twin, except where rounding decides. No wave is lost, and the report contains the evaluations of the
/// march.
#[test]
fn marched_fields_and_cells_are_right() {
    for (scene, marches) in [("cave", true), (GYROID, true), ("glasshouse", false)] {
        let settings = [Settings::hybrid(), Settings::march()];
        let settings = settings.map(|s| s.with_waves(8192).with_iterations(4));
        let report = report(scene, &settings);
        let surfaces = report.scenes[0].surfaces;
        assert_eq!(surfaces.marched > 0, marches, "{scene}: {surfaces:?}");
        assert!(!report.scenes[0].reference_is_sampled, "{scene}");
        assert_eq!(surfaces.in_cells > 0, !marches, "{scene}: {surfaces:?}");
        for row in rows(&report) {
            let waves = &row.waves;
            let told = format!("{scene}, {}: {waves:?}", row.label);
            assert!(waves.sequence_differs <= 5e-4, "{told}");
            assert!(waves.end.median <= 1e-5 && waves.not_finite == 0, "{told}");
            assert!(waves.hits.iter().sum::<u64>() > 30, "{told}");
            assert!(waves.largest_hit_difference() <= 2, "{told}");
            assert!(row.panning.twin_bias.abs() < 1e-3, "{told}");
        }
        let evaluations = rows(&report)[0].speed.evaluations_per_flight;
        assert_eq!(evaluations > 0.0, marches, "{scene}: {evaluations}");
    }
}

/// The CSV file has the stated columns and one line per row, the plot is an SVG, and each row states its options.
#[test]
fn a_report_becomes_csv_and_svg() {
    let summed = Settings::hybrid().with_waves(1024).with_sum_on_gpu(true);
    let report = report("corner", &[Settings::thesis().with_waves(1024), summed]);
    let mut csv = Vec::new();
    report.table().write_csv(&mut csv).unwrap();
    let csv = String::from_utf8(csv).unwrap();
    let lines: Vec<&str> = csv.lines().collect();
    assert_eq!(lines.len(), 3);
    assert_eq!(lines[0], report.table().names().join(","));
    assert!(lines[1].starts_with("corner,thesis,thesis,0.1,8,1024,random,false,false,"));
    assert!(lines[2].starts_with("corner,hybrid,hybrid,,8,1024,random,true,true,"));
    let svg = report.plot_svg().unwrap();
    assert!(svg.starts_with("<svg") && svg.contains("Pareto front"));
    let sum_errors = rows(&report).iter().map(|row| row.panning.sum_error);
    let sum_errors: Vec<Option<f64>> = sum_errors.collect();
    assert!(
        sum_errors[0].is_none() && sum_errors[1].unwrap() < 1e-5,
        "{sum_errors:?}"
    );
    let slopes = &report.scenes[0].slopes;
    assert_eq!(slopes.len(), 2);
    assert!(slopes.iter().all(|slope| slope.points.len() == 2));
}

/// The quick sweep varies each of its settings for every profile.
#[test]
fn the_sweep_varies_every_setting() {
    let cases = quick();
    let scene = Scene::builtin("corner").unwrap();
    for profile in Profile::ALL {
        let of = || {
            cases
                .iter()
                .map(|c| &c.settings)
                .filter(|s| s.profile() == profile)
        };
        let default = of().next().unwrap();
        assert!(of().any(|s| s.iterations != default.iterations));
        assert!(of().any(|s| s.waves < default.waves) && of().any(|s| s.waves > default.waves));
        assert!(of().any(|s| s.directions != default.directions));
        assert!(of().any(|s| s.sum_on_gpu) && of().any(|s| !s.sum_on_gpu));
        assert!(of().any(|s| s.iterations_per_pass == 1));
        assert!(of().any(|s| s.iterations_per_pass > 1));
        let reports: Vec<_> = cases.iter().map(|case| case.report(&scene)).collect();
        let of = || reports.iter().filter(|r| r.profile == profile.to_string());
        let default = of().next().unwrap();
        let distances = of().any(|r| r.min_distance != default.min_distance);
        assert_eq!(distances, profile == Profile::Thesis);
    }
    let ladder = cases.iter().filter(|case| {
        let lattice = Settings::hybrid()
            .with_waves(case.settings.waves)
            .with_directions(Directions::Fibonacci);
        case.label == "hybrid fibonacci" && case.settings == lattice
    });
    assert!(
        ladder.count() >= 6,
        "the fastest setting, at several numbers of waves"
    );
}
