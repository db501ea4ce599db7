//! Tests of single parts. `tests/diffraction` compares whole responses with exact solutions.

use super::space::Space;
use super::string::HalfPlanes;
use super::ways::{Way, Ways};
use super::wedge::{Wedge, shadow_function};
use super::{DiffractedPath, Ends, Reflection, around, beside, intercepted, within_faces};
use crate::Scene;
use crate::bands::{self, Bands};
use crate::geometry::ExactScene;
use crate::sampling::Random;
use glam::DVec3;
use num_complex::Complex64;
use std::f64::consts::{PI, TAU};

const SPEED: f64 = 343.0;

/// A scene with these surfaces, between a source and a listener.
pub(super) fn exact(surfaces: &str, (source, listener): Ends) -> ExactScene {
    let [source, listener] =
        [source, listener].map(|end| format!("({}, {}, {})", end.x, end.y, end.z));
    let text = format!(
        "Scene(surfaces: [{surfaces}], source: Source(position: {source}), \
         listener: Listener(position: {listener}, radius: 0.1))"
    );
    let scene = Scene::from_ron(&text, "test").expect("a scene");
    ExactScene::new(&scene).expect("an exact scene")
}

fn degrees(angle: f64) -> f64 {
    angle.to_radians()
}

/// Protects the shadow function: its power series and its continued fraction agree where one gives way to the other.
#[test]
fn the_shadow_function_is_smooth() {
    let [below, above] = [2.999_999_999, 3.000_000_001].map(shadow_function);
    assert!((below - above).norm() < 2e-9, "{below} and {above}");
    assert_eq!(shadow_function(0.0), Complex64::ONE);
}

/// Protects levels behind a wedge of 270°: published values of the exact integral.
#[test]
fn levels_behind_a_corner_are_the_exact_ones() {
    let wedge = Wedge {
        air_angle: degrees(270.0),
        source_m: 2.0,
        source_angle: degrees(30.0),
        receiver_m: 3.0,
        receiver_angle: degrees(240.0),
        along_m: 0.0,
    };
    let exact_db = [
        -2.664, -4.387, -6.474, -8.856, -11.503, -14.347, -17.299, -20.293,
    ];
    for (exact, hz) in exact_db.into_iter().zip(crate::bands::BANDS_HZ) {
        let pressure = wedge.diffracted(2.0 * PI * hz / SPEED).sum([1.0; 2]);
        let level = 20.0 * pressure.norm().log10();
        assert!(
            (level - exact).abs() < 0.002,
            "{hz} Hz: {level} dB, exact {exact} dB"
        );
    }
}

/// Protects the shadow boundary: the sum of direct and diffracted sound is continuous there, and half the direct sound.
#[test]
fn sound_is_continuous_at_the_shadow_boundary() {
    let total = |off: f64| {
        let wedge = Wedge {
            air_angle: degrees(300.0),
            source_m: 1.5,
            source_angle: degrees(40.0),
            receiver_m: 4.0,
            receiver_angle: degrees(220.0) + off,
            along_m: 0.7,
        };
        let direct = if off < 0.0 { 1.0 } else { 0.0 };
        wedge.diffracted(20.0).direct + direct
    };
    let (lit, dark) = (total(-1e-7), total(1e-7));
    assert!((lit - dark).norm() < 1e-5, "{lit} and {dark}");
    assert!((dark.re - 0.5).abs() < 0.1, "{dark}");
}

/// Protects reciprocity: source and receiver may change places.
#[test]
fn source_and_receiver_may_change_places() {
    let wedge = Wedge {
        air_angle: degrees(290.0),
        source_m: 0.8,
        source_angle: degrees(20.0),
        receiver_m: 3.0,
        receiver_angle: degrees(270.0),
        along_m: 1.2,
    };
    let other = Wedge {
        source_m: wedge.receiver_m,
        source_angle: wedge.receiver_angle,
        receiver_m: wedge.source_m,
        receiver_angle: wedge.source_angle,
        ..wedge
    };
    for k in [1.0, 10.0, 100.0] {
        let [there, back] = [wedge, other].map(|wedge| wedge.diffracted(k).sum([1.0; 2]));
        assert!((there - back).norm() < 1e-9, "{there} and {back}");
    }
}

/// Protects the share that an obstacle intercepts: a quarter at its edge, nothing if it is much narrower than a
/// wavelength, all without a way around it, and within 1 dB of all in deep shadow, where little sound passes the edge.
#[test]
fn an_obstacle_intercepts_the_rest_of_the_front() {
    let near = |found: [f64; 8], expected: f64, error: f64| {
        let is_near = |share: f64| (share - expected).abs() < error;
        assert!(found.into_iter().all(is_near), "{found:?}");
    };
    near(intercepted(&[], SPEED), 1.0, 1e-12);
    near(intercepted(&[0.0], SPEED), 0.25, 1e-12);
    near(intercepted(&[0.0, 0.0], SPEED), 0.0, 1e-12);
    near(intercepted(&[20.0], SPEED), 1.0, 0.12);
    // The share rises from the edge to the first maximum of Fresnel's fringes.
    let rises: Vec<f64> = [0.0, 0.01, 0.03, 0.1]
        .map(|detour| intercepted(&[detour], SPEED)[4])
        .to_vec();
    assert!(rises.is_sorted_by(|a, b| a < b), "{rises:?}");
}

/// The errors in dB of levels behind a body, by frequency in Hz: the differences from its boundary-element values above
/// −35 dB, where it hides the source. `surfaces` takes the width of the body in metres.
fn errors_of_boundary_elements(body: &str, surfaces: impl Fn(f64) -> String) -> Vec<(f64, f64)> {
    let table = include_str!("../../../tests/diffraction/oracle/boundary_elements.tsv");
    let rows = table.lines().filter_map(|line| line.strip_prefix(body));
    let error = |row: &str| {
        let numbers = row.trim().split('\t').map(|number| number.parse());
        let numbers: Vec<f64> = numbers.collect::<Result<_, _>>().expect("numbers");
        let [width, hertz, sx, sy, lx, ly, re, im] = numbers[..] else {
            panic!("{row}");
        };
        let exact_db = 20.0 * re.hypot(im).log10();
        let ends = [DVec3::new(sx, sy, 0.0), DVec3::new(lx, ly, 0.0)];
        let level = hidden_level_db(&surfaces(width), ends, TAU * hertz / SPEED)?;
        (exact_db > -35.0).then_some((hertz, level - exact_db))
    };
    rows.filter_map(error).collect()
}

fn root_mean_square(errors: &[(f64, f64)]) -> f64 {
    let squares: f64 = errors.iter().map(|(_, error)| error * error).sum();
    (squares / errors.len() as f64).sqrt()
}

/// Protects levels behind thick bars, over two edges on both sides: the boundary-element values of a line source, at
/// single frequencies from 125 Hz to 4 kHz, within 1.5 dB (root mean square).
#[test]
fn levels_behind_bars_are_those_of_boundary_elements() {
    let bar = |width: f64| format!("Surface(shape: Box(size: ({width}, 2, 1000)))");
    let mut errors = errors_of_boundary_elements("bar", bar);
    errors.retain(|(hertz, _)| *hertz >= 125.0);
    assert!(errors.len() > 150, "{} values", errors.len());
    let rms = root_mean_square(&errors);
    assert!(rms < 1.5, "{rms} dB");
}

/// Protects levels beside a doorway, where its jamb hides the source: the boundary-element values of a line source, within
/// 1.5 dB (root mean square) at 250 and 500 Hz, and 2.7 dB from 1 to 4 kHz.
#[test]
fn levels_beside_a_doorway_are_those_of_boundary_elements() {
    let walls = |width: f64| {
        let middle = 0.5 * width + 500.0;
        let wall =
            |y: f64| format!("Surface(shape: Box(size: (0.1, 1000, 2000)), position: (0, {y}, 0))");
        format!("{}, {}", wall(middle), wall(-middle))
    };
    let errors = errors_of_boundary_elements("doorway", walls);
    let (low, high): (Vec<_>, Vec<_>) = errors.into_iter().partition(|(hertz, _)| *hertz < 1e3);
    assert!(low.len() >= 10 && high.len() >= 15, "{low:?}, {high:?}");
    let [low, high] = [low, high].map(|errors| root_mean_square(&errors));
    assert!(low < 1.5 && high < 2.7, "{low} dB, {high} dB");
}

/// Thickness and width of an opening in metres, places of source and listener, levels in dB.
type Opening = ([f64; 2], [f64; 2], [f64; 2], [f64; 5]);

/// Levels in dB of a line source 2 or 3 m in front of an endless rigid wall, behind an opening whose jamb hides it, relative
/// to the open: means of octave bands from 63 Hz to 1 kHz by `pressures` of scripts/references/doorway.py with this
/// `THICKNESS` and `WIDTH`. Places are the distances from the axis and from the middle of the wall.
const BEHIND_OPENINGS: [Opening; 9] = [
    (
        [0.3, 0.9],
        [1.2, -2.0],
        [-0.40, 2.0],
        [-5.7, -4.9, -3.6, -3.6, -5.1],
    ),
    (
        [0.3, 0.9],
        [1.2, -2.0],
        [-0.16, 2.0],
        [-5.7, -5.0, -4.2, -6.1, -6.0],
    ),
    (
        [0.3, 0.9],
        [1.2, -2.0],
        [0.08, 2.0],
        [-5.8, -5.2, -5.2, -8.7, -7.8],
    ),
    (
        [0.3, 0.9],
        [0.0, -2.0],
        [0.84, 2.0],
        [-5.4, -4.7, -3.7, -4.4, -4.4],
    ),
    (
        [0.3, 0.9],
        [0.0, -2.0],
        [1.08, 2.0],
        [-5.6, -5.0, -4.5, -6.8, -6.3],
    ),
    (
        [0.3, 0.9],
        [0.0, -2.0],
        [1.32, 2.0],
        [-5.9, -5.3, -5.3, -8.9, -7.9],
    ),
    (
        [0.2, 0.7],
        [0.3, -3.0],
        [0.41, 1.2],
        [-6.0, -5.6, -4.7, -4.3, -7.0],
    ),
    (
        [0.2, 0.7],
        [0.3, -3.0],
        [0.65, 1.2],
        [-6.3, -6.1, -5.8, -7.7, -8.9],
    ),
    (
        [0.2, 0.7],
        [0.3, -3.0],
        [0.89, 1.2],
        [-6.7, -6.7, -6.9, -10.7, -11.0],
    ),
];

/// Protects the sum of ways behind a jamb, where the other jamb reflects: levels in octave bands are within 1 dB (root mean
/// square) of those that the modes of the opening give. Reflections at the other jamb add as energies.
#[test]
fn levels_behind_a_jamb_are_those_of_the_modes_of_the_opening() {
    let mut errors = Vec::new();
    for ([thick, width], source, listener, exact_db) in BEHIND_OPENINGS {
        let wall = |side: f64| {
            let x = side * (0.5 * width + 5.0);
            format!("Surface(shape: Box(size: (10, 1000, {thick})), position: ({x}, 0, 0))")
        };
        let ends = [source, listener].map(|[aside, from]| DVec3::new(aside, 0.0, from));
        let exact = exact(&format!("{}, {}", wall(1.0), wall(-1.0)), ends.into());
        let paths = around(&exact, ends.into(), SPEED, |_, _| [1.0; 8]);
        let energy = bands::sum(paths.iter().map(|path| &path.energy));
        let open = 4.0 * PI * ends[0].distance_squared(ends[1]);
        for (band, exact_db) in exact_db.into_iter().enumerate() {
            errors.push((0.0, 10.0 * (energy[band] * open).log10() - exact_db));
        }
    }
    let rms = root_mean_square(&errors);
    assert!(rms < 1.0, "{rms} dB: {errors:?}");
}

/// Levels in dB of a line source at the height `e` in metres above the top of a rigid bar, 3 m on one side of its middle, at
/// the same height 3 m on the other side, relative to the open: means of octave bands from 125 Hz to 2 kHz by
/// `pressures(k, bar(k, width), …)` of scripts/references/boundary_elements.py. Width of the bar, `e`, levels.
const ABOVE_BARS: [(f64, f64, [f64; 5]); 6] = [
    (0.1, 0.005, [-7.65, -3.98, -5.95, -5.22, -5.49]),
    (0.2, 0.005, [-7.5, -4.11, -5.87, -5.01, -5.65]),
    (0.2, 0.05, [-6.74, -3.98, -5.11, -4.13, -4.4]),
    (0.2, 0.5, [-1.44, -1.82, -0.36, 0.69, 0.78]),
    (0.5, 0.005, [-6.87, -4.27, -5.55, -5.0, -5.48]),
    (0.5, 0.2, [-3.95, -3.6, -2.59, -2.01, -1.11]),
];

/// Protects levels along the top of a wall, which hides nothing and hardly reflects: direct sound and reflection together
/// are within 1.5 dB of the boundary-element values.
#[test]
fn levels_above_bars_are_those_of_boundary_elements() {
    for (width, above_m, exact_db) in ABOVE_BARS {
        let ends = [-3.0, 3.0].map(|x| DVec3::new(x, 1.0 + above_m, 0.0));
        let bar = format!("Surface(shape: Box(size: ({width}, 2, 1000)))");
        let exact = exact(&bar, ends.into());
        let way_m = 3.0_f64.hypot(above_m);
        let reflection = Reflection {
            point: DVec3::Y,
            away: DVec3::new(3.0, above_m, 0.0) / way_m,
            normal: DVec3::Y,
            before_m: way_m,
            after_m: way_m,
        };
        let direct = beside(&exact, ends.into(), SPEED, |_, _| [1.0; 8]).energy;
        let reflected = within_faces(&exact, &[reflection], SPEED);
        for (band, exact_db) in (1..).zip(exact_db) {
            let energy = direct[band] + reflected[band] * (3.0 / way_m).powi(2);
            let level = 10.0 * energy.log10();
            assert!(
                (level - exact_db).abs() < 1.5,
                "{width} m, {above_m} m above, band {band}: {level} dB, exact {exact_db} dB"
            );
        }
    }
}

/// The level of a single frequency around what hides a source, relative to the open; `None` in the light.
fn hidden_level_db(surfaces: &str, [source, listener]: [DVec3; 2], k: f64) -> Option<f64> {
    let exact = exact(surfaces, (9.0 * DVec3::NEG_X, 9.0 * DVec3::X));
    if exact.is_free(source, listener) {
        return None;
    }
    let ways = Ways::around(&exact, &HalfPlanes::between(source, listener)?);
    let (sounds, reflected) = ways.sounds(&exact, k, &ways.rigid());
    let sum: Complex64 = sounds.iter().map(|sound| sound.pressure).sum();
    Some(10.0 * (sum.norm_sqr() + reflected).log10())
}

/// Protects ways across the rim of a short cylinder, whose two edges cross each other: all energies are numbers.
#[test]
fn energies_over_edges_that_cross_are_numbers() {
    let ends = (
        DVec3::new(-0.683, 1.656, 3.769),
        DVec3::new(-1.638, 1.432, -5.857),
    );
    let exact = exact(
        "Surface(shape: Cylinder(radius: 1.339, height: 4.464))",
        ends,
    );
    let paths = around(&exact, ends, SPEED, |_, _| [1.0; 8]);
    assert!(!paths.is_empty());
    for path in paths {
        for energy in path.energy {
            assert!(energy.is_finite() && energy > 0.0, "{path:?}");
        }
    }
}

/// Protects thin plates seen edge-on, whose edge lies on the line between source and listener: no panic, and sound.
#[test]
fn a_thin_plate_seen_edge_on_leaves_sound() {
    for width in [1e-9, 1e-6, 1e-4, 1e-3] {
        let ends = (DVec3::new(0.0, 0.0, -4.0), DVec3::new(0.0, 0.0, 4.0));
        let exact = exact(&format!("Surface(shape: Box(size: ({width}, 1, 1)))"), ends);
        if exact.is_free(ends.0, ends.1) {
            continue;
        }
        let paths = around(&exact, ends, SPEED, |_, _| [1.0; 8]);
        assert!(!paths.is_empty(), "{width} m");
    }
}

/// Protects a listener at the height of a wall's top: the string along the top has no turns on it.
#[test]
fn levels_along_the_top_of_a_wall_are_those_just_below() {
    let wall = "Surface(shape: Box(size: (0.2, 100, 1000)), position: (0, -50, 0))";
    let ends = |height: f64| (DVec3::new(-5.0, -2.0, 0.0), DVec3::new(6.0, height, 1.0));
    let exact = exact(wall, ends(0.0));
    let levels = |height: f64| {
        let ends = ends(height);
        let paths = around(&exact, ends, SPEED, |_, _| [1.0; 8]);
        bands::sum(paths.iter().map(|path| &path.energy))
    };
    for (along, below) in levels(0.0).into_iter().zip(levels(-1e-3)) {
        let step_db = 10.0 * (along / below).log10();
        assert!(step_db.abs() < 0.2, "{step_db} dB");
    }
}

/// Protects a wall of 0.1 mm, whose two edges are nearer to each other than curvature can be measured: they are edges at
/// every height of the listener.
#[test]
fn levels_behind_a_thin_wall_change_slowly() {
    let wall = "Surface(shape: Box(size: (0.0001, 2000, 2000)), position: (0, -1000, 0))";
    let ends = |height: f64| (DVec3::new(-3.0, -1.0, 0.0), DVec3::new(4.0, height, 0.0));
    let exact = exact(wall, ends(0.0));
    let levels = |step: usize| {
        let ends = ends(-0.5 + 0.001 * step as f64);
        let paths = around(&exact, ends, SPEED, |_, _| [1.0; 8]);
        bands::sum(paths.iter().map(|path| &path.energy))
    };
    let all: Vec<_> = (0..300).map(levels).collect();
    for two in all.windows(2) {
        for (before, after) in two[0].into_iter().zip(two[1]) {
            let step_db = 10.0 * (after / before).log10();
            assert!(step_db.abs() < 0.05, "{step_db} dB");
        }
    }
}

/// Protects the choice of ways on one side of a ball, as of those that are reflected at a mirror: each side is kept or left
/// out on its own, whichever is shorter, and has a sound.
#[test]
fn ways_around_a_ball_are_kept_by_side() {
    let ends = (DVec3::new(-3.0, 0.1, 0.0), DVec3::new(2.5, 0.1, 0.0));
    let exact = exact("Surface(shape: Sphere(radius: 1))", ends);
    let planes = HalfPlanes::between(ends.0, ends.1).expect("two points");
    for side in [1.0, -1.0] {
        let mut ways = Ways::around(&exact, &planes);
        assert_eq!(ways.bends.iter().flat_map(Way::heard).count(), 2);
        ways.retain(|point| side * point.y > 0.0);
        let heard: Vec<_> = ways.bends.iter().flat_map(Way::heard).collect();
        assert_eq!(heard.len(), 1, "side {side}");
        assert!(side * heard[0].turns[0].middle.y > 0.0);
        let (sounds, _) = ways.sounds(&exact, 10.0, &ways.rigid());
        assert_eq!(sounds.len(), 1);
        assert_eq!(sounds[0].length_m, heard[0].length_m);
        assert!(sounds[0].pressure.norm() > 0.0);
    }
}

/// Protects levels among round bodies on or near a floor: a path that bends around them is at most 6 dB louder than in
/// the open, as much as a focus counts. A way between a body and its image has strings over the other one beside it.
#[test]
fn no_way_around_a_body_on_the_floor_is_louder_than_in_the_open() {
    let mut random = Random::new(5);
    let mut between = |low: f64, high: f64| {
        low + (high - low) * random.below(1 << 20) as f64 / f64::from(1 << 20)
    };
    let mut heard = 0;
    for number in 0..240 {
        let radius = between(0.3, 0.9);
        let gap = between(0.0, 0.15);
        let (shape, height) = match number % 3 {
            0 => (format!("Sphere(radius: {radius})"), radius),
            1 => (
                format!("Capsule(radius: {radius}, height: 1)"),
                radius + 0.5,
            ),
            _ => (
                format!("Ellipsoid(radii: ({}, {radius}, {radius}))", 2.0 * radius),
                radius,
            ),
        };
        let turn = between(0.0, 180.0);
        let body = format!(
            "Surface(shape: {shape}, position: (0, {}, 0), rotation: (0, {turn}, 0))",
            height + gap
        );
        let mut end = |side: f64| {
            DVec3::new(
                side * between(2.0, 6.0),
                between(0.3, 2.2),
                between(-0.5, 0.5),
            )
        };
        let ends = (end(-1.0), end(1.0));
        let scene = exact(&format!("Surface(shape: Plane), {body}"), ends);
        let mirror = super::mirrored::Mirror {
            surface: 1,
            point: DVec3::ZERO,
            normal: DVec3::Y,
        };
        let rigid = |_, _| [1.0; 8];
        let mut paths = around(&scene, ends, SPEED, rigid);
        paths.extend(super::around_mirrored(&scene, mirror, ends, SPEED, rigid));
        heard += paths.len();
        for path in paths {
            let open = 1.0 / (4.0 * PI * path.length_m.powi(2));
            assert!(path.energy.iter().all(|energy| energy.is_finite()));
            let most = path.energy.into_iter().fold(0.0, f64::max);
            let level_db = 10.0 * (most / open).log10();
            assert!(level_db < 6.0, "{level_db} dB, {number}: {body}, {ends:?}");
        }
    }
    assert!(heard > 100, "{heard}");
}

/// Protects the way round the corner of a narrow corridor from floor to ceiling: only tents close to the corner are free.
#[test]
fn a_way_leads_round_the_corner_of_a_narrow_corridor() {
    for (width, apart) in [(2.0, 3.0), (2.0, 1.5), (1.2, 4.0), (0.6, 2.0)] {
        let half = 0.5 * width;
        let ends = (DVec3::new(-8.0, 1.5, -half), DVec3::new(half, 1.5, apart));
        let rooms = format!(
            "Surface(shape: Rooms(of: [(from: (-12, 0, -{width}), to: ({width}, 2.5, 0)), \
             (from: (0, 0, 0), to: ({width}, 2.5, 10))]))"
        );
        let corner = DVec3::new(0.0, 1.5, 0.0);
        let length_m = ends.0.distance(corner) + ends.1.distance(corner);
        let paths = around(&exact(&rooms, ends), ends, SPEED, |_, _| [1.0; 8]);
        let is_there = |path: &DiffractedPath| (path.length_m - length_m).abs() < 1e-4;
        assert!(paths.iter().any(is_there), "{width} m: {paths:?}");
    }
}

/// The energies of the direct sound, relative to the open, in sight and hidden. `coefficients` are the pressure reflection
/// coefficients of a surface.
pub(super) fn direct(
    exact: &ExactScene,
    ends: Ends,
    coefficients: fn(u32, DVec3) -> Bands,
) -> Bands {
    let paths = around(exact, ends, SPEED, coefficients);
    if paths.is_empty() {
        return beside(exact, ends, SPEED, coefficients).energy;
    }
    let open = 4.0 * PI * ends.0.distance_squared(ends.1);
    bands::sum(paths.iter().map(|path| &path.energy)).map(|all| all * open)
}

/// Protects levels behind and beside openings in walls of 10 to 30 cm, where the inner face of the far jamb reflects: octave
/// bands from 125 Hz to 4 kHz against the modes of the opening, in sight and behind a jamb.
#[test]
fn levels_behind_doorways_are_those_of_the_modes_of_the_opening() {
    const OCTAVES: usize = 6;
    let table = include_str!("../../../tests/diffraction/oracle/doorways.tsv");
    let mut errors: [[Vec<(f64, f64)>; OCTAVES]; 2] = Default::default();
    for row in table.lines().filter(|line| !line.starts_with('#')) {
        let numbers = row.split('\t').map(|number| number.parse());
        let numbers: Vec<f64> = numbers.collect::<Result<_, _>>().expect("numbers");
        let [thick, width, sx, sy, lx, ly, ref exact_db @ ..] = numbers[..] else {
            panic!("{row}");
        };
        let wall = |side: f64| {
            let y = side * (0.5 * width + 500.0);
            format!("Surface(shape: Box(size: ({thick}, 1000, 2000)), position: (0, {y}, 0))")
        };
        let ends = (DVec3::new(sx, sy, 0.0), DVec3::new(lx, ly, 0.0));
        let exact = exact(&format!("{}, {}", wall(1.0), wall(-1.0)), ends);
        let is_hidden = !exact.is_free(ends.0, ends.1);
        let energy = direct(&exact, ends, |_, _| [1.0; 8]);
        for (octave, exact_db) in exact_db.iter().enumerate() {
            let error = 10.0 * energy[octave + 1].log10() - exact_db;
            errors[usize::from(is_hidden)][octave].push((0.0, error));
        }
    }
    let [in_sight, hidden] = errors.map(|octaves| octaves.map(|errors| root_mean_square(&errors)));
    assert!(in_sight.iter().all(|rms| *rms < 1.0), "{in_sight:?}");
    let bounds = [1.0, 1.0, 1.0, 1.3, 1.6, 2.2];
    let is_near = hidden.iter().zip(bounds).all(|(rms, bound)| *rms < bound);
    assert!(is_near, "{hidden:?}");
}
