//! The hard cases: `hybrid` and `march` pass all of them, and `thesis` fails in the known cases.

use echomarch::gl::{Api, Context, ContextOptions};
use echomarch::{Profile, Tracer};
use echomarch_lab::experiment::verify::{self, Case, VerifyReport};

/// Runs cases on a context of the given API, in a separate thread.
fn report(api: Api, cases: Vec<Case>) -> VerifyReport {
    let run = move || {
        let context =
            Context::headless(&ContextOptions::new(api)).unwrap_or_else(|e| panic!("{e}"));
        let mut tracer = Tracer::new(&context).unwrap();
        verify::run(&mut tracer, &cases, &mut |_, _| ()).unwrap()
    };
    std::thread::Builder::new()
        .name(api.to_string())
        .spawn(run)
        .unwrap()
        .join()
        .unwrap_or_else(|_| panic!("failed with the API {api}"))
}

fn assert_right(report: &VerifyReport) {
    for case in &report.cases {
        for profile in [Profile::Hybrid, Profile::March] {
            let result = case.of(profile).expect("every profile is run");
            let verdict = result.verdict();
            assert!(result.passed, "{}, {profile}: {verdict}", case.name);
        }
    }
}

/// Known faults of the thesis' algorithm, as expected failures: the name of the case, and the reason for the failure.
const THESIS_FAILS: [(&str, &str); 17] = [
    ("normal-incidence", "waves are caught in the wall they met"),
    ("grazing-89.9", "the wave is given up after 300 of 573 m"),
    ("grazing-89.99", "the wave is given up at 300 m"),
    ("grazing-89.999", "the wave is given up at 300 m"),
    ("concave-vertex", "normals of two walls at once"),
    ("convex-edge", "normals of two faces at once"),
    ("thin-wall-0.05", "no hit lies on the surface"),
    (
        "gap-0.05",
        "differences across the gap are 0: the normal is a NaN",
    ),
    (
        "gap-0.001",
        "differences across the gap are 0: the normal is a NaN",
    ),
    ("tangent-sphere", "the ball is 0.1 m too thick"),
    (
        "source-on-wall",
        "waves are caught in the wall they start on",
    ),
    ("source-in-wall", "waves sound within a solid"),
    (
        "corner-times-1e-3",
        "the minimum distance is larger than the scene",
    ),
    ("corner-times-1e2", "walls are beyond the maximum distance"),
    ("shoebox-200", "waves are caught in walls"),
    (
        "horizon",
        "dead waves are marched again from the world's origin",
    ),
    ("open-field", "hits lie 0.1 m early"),
];

/// Checks the share of heard waves in cases in which it is known without a reference: it is 0 behind a wall, however
/// thin, and 1 for a source inside the listener's sphere.
fn assert_heard(report: &VerifyReport) {
    for case in &report.cases {
        let through_a_wall = case.name.starts_with("thin-wall");
        let within = case.name == "source-in-listener";
        for result in case.results.iter().filter(|_| through_a_wall || within) {
            let known = if within { result.waves } else { 0 };
            assert_eq!(result.heard_exactly, known, "{}", case.name);
        }
    }
}

/// Protects a promise of the crate: the two profiles recommended to users give the right answers in all hard cases.
/// Also protects the port: `thesis` must fail in the cases that the thesis' algorithm gets wrong.
#[test]
fn hybrid_and_march_pass_every_hard_case() {
    let report = report(Api::Gl, verify::all());
    assert_right(&report);
    assert_heard(&report);
    for (name, reason) in THESIS_FAILS {
        let case = report.cases.iter().find(|case| case.name == name);
        let case = case.unwrap_or_else(|| panic!("no case {name}"));
        let result = case.of(Profile::Thesis).expect("every profile is run");
        assert!(!result.passed, "{name} passes, although {reason}");
    }
}

/// Protects the other APIs, with cases whose result depends on a single rounding.
#[test]
fn the_other_apis_pass_hard_cases_too() {
    let prefixes = [
        "grazing",
        "con",
        "flush",
        "gap",
        "tangent",
        "source",
        "corner-moved-1e5",
        "obstacles-times-1e",
        "not-finite",
    ];
    for api in [Api::Gles, Api::OsMesa] {
        let mut cases = verify::all();
        cases.retain(|case| prefixes.iter().any(|p| case.name.starts_with(p)));
        assert!(cases.len() > 20, "{}", cases.len());
        assert_right(&report(api, cases));
    }
}
