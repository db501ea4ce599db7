//! Tests of lines: bounds of fields along lines, with which a march takes longer steps than with values; and lines
//! exactly parallel to faces, for which a closed form could divide by 0.

use super::field_shaders::{Asked, gradient, points, unit};
use super::{has_marched_fields, parts_of};
use crate::Surface;
use crate::geometry::ExactScene;
use crate::gl::{Api, Context};
use crate::sampling::median;
use crate::scene::Shape;
use crate::scene::shape::tests::table::{Entry, on_cpu, scene_of, surfaces, to_world};
use crate::scene::shape::{CappedCylinder, Capsule, Cone, Cuboid, HalfSpace, Prism};
use crate::shader::Lists;
use crate::shader::text::field::is_bounded;
use crate::shader::text::{ListenerText, closed_form_parts, directed_parts};
use crate::test_common::{Random, context};
use glam::{DVec3, Vec2, Vec3};

/// Number of lines from each point.
const LINES: usize = 4;

/// Number of points on each line at which the field is evaluated. The points are denser towards the end of the line.
const PLACES: usize = 64;

/// Maximum depth in the solid on a line that should be free, in units of the position. The depth is due to the rounding
/// errors of the line's start and of the bound.
const SOLID_ULPS: f64 = 64.0;

/// A shader for the free length of a line from p along d past all fields, as the march computes it.
const FREE: &str = "
vec4 answer(int which, vec3 p, vec3 d) {
    findChords(p, d, ROUNDING * largest(p));
    Ahead ahead = fieldsAhead(0.0, p, d, -1.0, ROUNDING * largest(p));
    return vec4(min(ahead.free, ahead.others));
}
";

/// Distances from the surface at which further lines begin, as shares of the surface's reach. Bounds matter most next
/// to surfaces.
const NEAR: [f64; 2] = [1e-4, 1e-2];

/// Lines through the air, from points near and far. Some have random directions, and some point to the surface.
fn lines(entry: &Entry, surface: &Surface) -> Vec<(DVec3, DVec3)> {
    let mut random = Random(29);
    let mut all = Vec::new();
    let far = points(entry, &mut Random(31));
    let near = |p: &DVec3| NEAR.map(|share| towards(entry, *p, share * entry.reach()));
    let near: Vec<DVec3> = far.iter().flat_map(near).collect();
    for p in [far, near].concat() {
        for _ in 0..LINES {
            let aim = entry.reach() * random.unit() * random.direction();
            let direction = [random.direction(), (aim - p).normalize_or(DVec3::X)];
            all.push((p, direction[all.len() % 2]));
        }
    }
    let air = |p: DVec3| entry.distance(p) > 4.0 * unit(entry, surface, to_world(surface, p));
    all.retain(|(p, _)| air(*p));
    all
}

/// Newton steps from p to a point at which the field has the given value.
fn towards(entry: &Entry, mut p: DVec3, value: f64) -> DVec3 {
    for _ in 0..6 {
        p += gradient(entry, p) * (value - entry.distance(p));
    }
    p
}

/// The distance along a line to the first tested point in the solid, within the length that should be free.
fn solid_within(
    entry: &Entry,
    (from, direction): (DVec3, DVec3),
    free: f64,
    bound: f64,
) -> Option<f64> {
    let place = |index: usize| {
        let share = (index as f64 + 0.5) / PLACES as f64;
        // Most wrong bounds are first wrong at the end of the free length.
        free * share * (2.0 - share)
    };
    (0..PLACES)
        .map(place)
        .find(|t| entry.distance(from + *t * direction) < -bound)
}

/// Checks the lines of one entry. For each line that begins next to the surface, the ratio of the free length to the
/// value is added to `worth`.
fn check(
    context: &Context,
    entry: &Entry,
    surface: &Surface,
    worth: &mut Vec<f64>,
) -> Result<(), String> {
    let scene = scene_of(vec![surface.clone()]);
    let parts = parts_of(&scene, Lists::Overlapping, |text| {
        directed_parts(text, ListenerText::Solid)
    });
    let asked = Asked::new(context, &scene, parts, FREE.to_owned());
    let lines = lines(entry, surface);
    let turn = surface.rotation.as_dquat();
    let starts: Vec<Vec3> = lines.iter().map(|(p, _)| to_world(surface, *p)).collect();
    let directions: Vec<Vec3> = lines
        .iter()
        .map(|(_, d)| (turn * *d).as_vec3().normalize())
        .collect();
    let answers = asked.ask(0, &starts, &directions);
    for ((line, start), [free, ..]) in lines.into_iter().zip(starts).zip(answers) {
        let (p, d) = line;
        if free.is_nan() || free < 0.0 {
            return Err(format!("free for {free} m at {p}: {}", entry.name));
        }
        // Limits the length to the extent of the field.
        let free = f64::from(free).min(p.length() + 2.0 * entry.reach());
        let bound = SOLID_ULPS * unit(entry, surface, start);
        let value = entry.distance(p);
        if value < 2.0 * NEAR[1] * entry.reach() {
            worth.push(free / value);
        }
        if let Some(t) = solid_within(entry, line, free, bound) {
            let value = entry.distance(p + t * d);
            return Err(format!(
                "free for {free} m, but {value} after {t} m from {p} along {d}: {}",
                entry.name
            ));
        }
    }
    Ok(())
}

/// All entries that the CPU can evaluate, and their complements, because bounds in the air and in the solid have
/// separate texts.
fn both_sides() -> Vec<Entry> {
    let other = |entry: &Entry| Entry {
        name: format!("complement of {}", entry.name),
        field: entry.field.clone().complement(),
        truth: None,
    };
    let entries = on_cpu();
    let others: Vec<Entry> = entries.iter().map(other).collect();
    entries.into_iter().chain(others).collect()
}

/// Protects waves from passing through surfaces: no free length reaches into the solid. Also protects the benefit of
/// bounds: for nearly all fields, half of the lines next to a surface have a free length that exceeds the value by at
/// least a fifth.
#[test]
fn lines_are_free_as_far_as_bounds_say() {
    let context = context(Api::Gl);
    let mut failures = Vec::new();
    let (mut bounded, mut worthwhile) = (0, 0);
    for entry in both_sides().iter().filter(|entry| is_bounded(&entry.field)) {
        let mut worth = Vec::new();
        for surface in surfaces(entry) {
            failures.extend(check(&context, entry, &surface, &mut worth).err());
        }
        let times = median(worth);
        println!("{times:.2} {}", entry.name);
        bounded += 1;
        worthwhile += usize::from(times > 1.2);
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
    assert!(bounded > 120, "{bounded}");
    assert!(100 * worthwhile > 85 * bounded, "{worthwhile} of {bounded}");
}

const ASK: &str = "
vec4 answer(int which, vec3 p, vec3 d) {
    float object;
    float t = closestHit(p, d, -1.0, NO_HIT, object);
    return vec4(t, object, 0.0, 0.0);
}
";

/// Maximum distance in metres between a hit and the reference in f64.
const CLOSE: f64 = 1e-5;

/// Shapes of 2 m with faces or an axis along the coordinate axes.
fn shapes() -> Vec<Shape> {
    let right_angle = [
        Vec2::new(-1.0, -1.0),
        Vec2::new(1.0, -1.0),
        Vec2::new(-1.0, 1.0),
    ];
    vec![
        Shape::from(Prism {
            corners: right_angle,
            depth: 2.0,
        }),
        Shape::union([Shape::from(Cuboid {
            size: Vec3::splat(2.0),
        })]),
        Shape::from(CappedCylinder {
            radius: 1.0,
            height: 2.0,
        }),
        Shape::from(Capsule {
            radius: 0.5,
            height: 1.0,
        }),
        Shape::from(Cone {
            radius: 1.0,
            height: 2.0,
        }),
        Shape::from(HalfSpace {
            normal: Vec3::Y,
            offset: -1.0,
        }),
    ]
}

/// Lines along both directions of every axis. They start on a grid, so that no line touches a face or grazes a curved
/// side.
fn parallel_lines() -> Vec<(Vec3, Vec3)> {
    const AT: [f32; 6] = [-2.3, -1.1, -0.4, 0.35, 0.9, 1.7];
    let axes = Vec3::AXES.into_iter().flat_map(|axis| [axis, -axis]);
    let mut all = Vec::new();
    for d in axes {
        for x in AT {
            for y in AT {
                all.extend(AT.map(|z| (Vec3::new(x, y, z), d)));
            }
        }
    }
    all
}

/// Protects misses: a line parallel to a face and beside it misses, and a line parallel to a face and within it has the
/// hit of the reference.
#[test]
fn lines_parallel_to_faces_meet_what_they_should() {
    let context = context(Api::Gl);
    for shape in shapes() {
        let scene = scene_of(vec![Surface::new(shape.clone())]);
        assert!(!has_marched_fields(&scene), "{shape:?}");
        let exact = ExactScene::new(&scene).unwrap();
        let parts = parts_of(&scene, Lists::Lines, |text| {
            closed_form_parts(text, ListenerText::Solid)
        });
        let asked = Asked::new(&context, &scene, parts, ASK.to_owned());
        let in_air = |(p, _): &(Vec3, Vec3)| shape.value(p.as_dvec3()) > 1e-3;
        let (starts, directions): (Vec<Vec3>, Vec<Vec3>) =
            parallel_lines().into_iter().filter(in_air).unzip();
        let answers = asked.ask(0, &starts, &directions);
        let mut met = 0;
        for ((from, d), [t, object, ..]) in starts.iter().zip(&directions).zip(answers) {
            let there = (object == 1.0).then_some(f64::from(t));
            let hit = exact.closest_hit(from.as_dvec3(), DVec3::from(*d));
            let here = hit.filter(|hit| hit.object == 1).map(|hit| hit.t);
            let same = match (here, there) {
                (None, None) => true,
                (Some(here), Some(there)) => (here - there).abs() < CLOSE,
                _ => false,
            };
            assert!(
                same,
                "{here:?}, by the shader {there:?}, from {from} along {d}: {shape:?}"
            );
            met += usize::from(here.is_some());
        }
        assert!(
            met > 40 && met < starts.len() - 40,
            "{met} of {}: {shape:?}",
            starts.len()
        );
    }
}
