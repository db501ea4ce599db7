//! Compares arrivals with exact waves, and with other divisions of the work into blocks, chunks and records, which must
//! not change the arrivals.

use crate::geometry::ExactScene;
use crate::gl::{Api, Context};
use crate::response::Arrival;
use crate::scene::Material;
use crate::scene::shape::{Cylinder, Room, Sphere, Torus};
use crate::test_common::{builtin, context, for_each_api};
use crate::tracer::arrivals::{Followed, WAVES_IN_BLOCK};
use crate::tracer::{ArrivalCounts, ArrivalSettings, Start, WavesToFollow};
use crate::{Listener, Node, Scene, Settings, Shape, Source, Surface, Tracer};
use glam::{DVec3, Vec3};

/// A crossing of the listener's sphere in the exact reference.
#[derive(Clone, Copy, Debug)]
struct Crossing {
    length: f64,
    chord: f64,
    direction: DVec3,
    reflections: u32,
    /// The sphere's radius minus the line's distance from its centre, in metres.
    depth: f64,
}

pub fn arrivals(
    tracer: &mut Tracer,
    scene: &Scene,
    settings: &Settings,
    how: &ArrivalSettings,
) -> (Vec<Arrival>, ArrivalCounts) {
    let mut all = Vec::new();
    let counts = tracer
        .arrivals(scene, settings, how, &mut |arrival| all.push(arrival))
        .unwrap();
    assert_eq!(all.len() as u64, counts.arrivals);
    // Arrivals are in the order of the chunks, and within a chunk in the order of the waves.
    all.sort_by_key(|arrival| arrival.wave);
    (all, counts)
}

/// The scene with the listener at a point that no wave reaches.
pub fn without_listener(scene: &Scene, nowhere: Vec3) -> ExactScene {
    let mut scene = scene.clone();
    scene.listeners[0] = Listener::at(nowhere, 1e-3);
    ExactScene::new(&scene).unwrap()
}

/// The crossings of one wave.
fn crossings(
    exact: &ExactScene,
    scene: &Scene,
    direction: DVec3,
    iterations: u32,
) -> Vec<Crossing> {
    let start = scene.sources[0].position.as_dvec3();
    let end = exact.trace(start, direction, iterations);
    let path = exact.trace_path(start, direction, iterations);
    let mut places: Vec<DVec3> = path.iter().map(|vertex| vertex.point).collect();
    places.insert(0, start);
    if end.status < 0 {
        places.push(end.point + 1e6 * end.direction);
    }
    let mut length = 0.0;
    let mut all = Vec::new();
    for (reflections, flight) in places.windows(2).enumerate() {
        let way = flight[1] - flight[0];
        let t = way.length();
        if let Some((enters, leaves, depth)) = through(&scene.listeners[0], flight[0], way / t, t) {
            all.push(Crossing {
                length: length + 0.5 * (enters + leaves),
                chord: leaves - enters,
                direction: way / t,
                reflections: reflections as u32,
                depth,
            });
        }
        length += t;
    }
    all
}

fn through(listener: &Listener, from: DVec3, d: DVec3, t: f64) -> Option<(f64, f64, f64)> {
    let (centre, radius) = (listener.position.as_dvec3(), f64::from(listener.radius));
    let along = (centre - from).dot(d);
    let aside = (from + along * d).distance(centre);
    let half = (radius * radius - aside * aside).max(0.0).sqrt();
    let (enters, leaves) = ((along - half).max(0.0), (along + half).min(t));
    (leaves > enters).then_some((enters, leaves, radius - aside))
}

pub fn start_directions(tracer: &mut Tracer, scene: &Scene, settings: &Settings) -> Vec<DVec3> {
    let settings = settings.clone().with_iterations(1);
    let (_, waves) = tracer.frame_with_waves(scene, &settings).unwrap();
    let starts = waves.iter().map(|wave| wave.start_direction.as_dvec3());
    starts.collect()
}

/// Allowed differences from exact arrivals.
struct Allowed {
    /// Allowed error of the length of a wave's path in metres, as a function of the number of reflections.
    off: fn(u32) -> f64,
    /// Allowed share of waves in which one crossing differs.
    parted: f64,
}

/// The maximum error of a chord 2 √(2 r e) whose depth e has an error of `off`: √(8 r) (√(e + off) − √e).
fn chord_error(radius: f64, depth: f64, off: f64) -> f64 {
    let depth = depth.max(0.0);
    (8.0 * radius).sqrt() * ((depth + 2.0 * off).sqrt() - (depth - 2.0 * off).max(0.0).sqrt())
        + 4.0 * off
}

fn is_same(
    arrival: &Arrival,
    exact: &Crossing,
    scene: &Scene,
    allowed: &Allowed,
    unit: f64,
) -> bool {
    let off = (allowed.off)(exact.reflections);
    let chord = arrival.energy[0] / unit;
    // A record rounds the chord to 2^-16 of four radii if a chunk has 64 iterations.
    let radius = f64::from(scene.listeners[0].radius);
    let chord_off = chord_error(radius, exact.depth, off) + radius * 2f64.powi(-14);
    (arrival.length_m - exact.length).abs() <= off + chord_off
        && (chord - exact.chord).abs() <= chord_off
        && arrival.direction.distance(exact.direction) <= 7e-4 + off
}

/// Compares every crossing of every wave with the reference, and every crossing of the reference with the waves.
/// Crossings that only graze the sphere may be missing.
fn compare(
    context: &Context,
    scene: &Scene,
    nowhere: Vec3,
    settings: &Settings,
    iterations: u32,
    allowed: &Allowed,
) {
    let mut tracer = Tracer::new(context).unwrap();
    let starts = start_directions(&mut tracer, scene, settings);
    let how = ArrivalSettings::new(1000.0).with_iterations(iterations);
    let (all, counts) = arrivals(&mut tracer, scene, settings, &how);
    assert_eq!(counts.step_limit_reached, 0);
    assert_eq!(counts.waves, u64::from(settings.waves));
    let unit = 1.0 / (counts.open_volume_m3 * f64::from(settings.waves));
    let exact = without_listener(scene, nowhere);
    let (mut parted, mut seen) = (0, 0);
    let mut of_wave = all.chunk_by(|a, b| a.wave == b.wave).peekable();
    for (wave, start) in starts.iter().enumerate() {
        let here = of_wave.next_if(|next| next[0].wave == wave as u32);
        let here = here.unwrap_or_default();
        let truth = crossings(&exact, scene, *start, iterations);
        seen += truth.len();
        let grazes = |c: &Crossing| c.depth < 2.0 * (allowed.off)(c.reflections) || c.chord < 1e-3;
        let met = |arrival: &Arrival| {
            let same = |c: &Crossing| is_same(arrival, c, scene, allowed, unit);
            truth.iter().any(same) || arrival.energy[0] / unit < 0.05
        };
        let found =
            |c: &Crossing| grazes(c) || here.iter().any(|a| is_same(a, c, scene, allowed, unit));
        let lengths = here.windows(2).all(|two| two[0].length_m < two[1].length_m);
        let is_right = here.iter().all(met) && truth.iter().all(found) && lengths;
        if !is_right && parted as f64 >= allowed.parted * f64::from(settings.waves) {
            panic!("wave {wave} of {}: {here:?}\nfor {truth:?}", scene.name);
        }
        parted += usize::from(!is_right);
    }
    assert!(of_wave.next().is_none());
    println!("{}: {seen} crossings, {parted} waves parted", scene.name);
    assert!(seen > 100);
}

/// Error of a path between flat walls, in metres. Positions of 15 m are rounded by 5e-7 m, as are a few sums and
/// products of them. At flat walls errors add up. (Measured in `shoebox`: 1.4e-5 m after 100 reflections.)
fn flat(reflections: u32) -> f64 {
    2e-6 * f64::from(1 + reflections)
}

/// Protects crossings, path lengths and chords over 100 reflections at flat walls.
#[test]
fn crossings_between_flat_walls_are_exact() {
    let allowed = Allowed {
        off: flat,
        parted: 0.0,
    };
    let corner = Allowed {
        off: flat,
        // At the block's edges rounding decides which side a wave hits. With 10 m of edges, one flight in 1e5 passes an
        // edge within 1e-4 m.
        parted: 0.01,
    };
    for_each_api(|context| {
        let settings = Settings::hybrid().with_waves(3000);
        let nowhere = Vec3::new(0.0, 0.0, 100.0);
        compare(
            context,
            &builtin("shoebox"),
            nowhere,
            &settings,
            101,
            &allowed,
        );
        compare(context, &builtin("corner"), nowhere, &settings, 60, &corner);
    });
    let context = context(Api::Gl);
    let march = Settings::march().with_waves(500);
    let nowhere = Vec3::new(0.0, 0.0, 100.0);
    compare(
        &context,
        &builtin("shoebox"),
        nowhere,
        &march,
        101,
        &allowed,
    );
    compare(&context, &builtin("corner"), nowhere, &march, 20, &corner);
}

fn scene(name: &str, more: Vec<Surface>) -> Scene {
    let size = Vec3::new(12.0, 6.0, 10.0);
    let mut surfaces = vec![Surface::new(Node::Room(Room { size }))];
    surfaces.extend(more);
    let source = Source::at(Vec3::new(-5.0, 0.5, 0.3));
    let listener = Listener::at(Vec3::new(4.0, 0.2, -1.0), 0.8);
    Scene::new(name, surfaces, source, listener)
}

fn curved() -> Vec<Scene> {
    let pillar = |x: f32, z: f32| {
        Surface::new(Node::Cylinder(Cylinder { radius: 0.5 })).at(Vec3::new(x, 0.0, z))
    };
    let balls = (0..24).map(|i| {
        let place = Vec3::new((i % 6) as f32 - 2.5, (i / 6) as f32 - 1.5, -3.0);
        Surface::new(Node::Sphere(Sphere { radius: 0.3 })).at(place)
    });
    let (ring, tube) = (1.0, 0.3);
    let torus = Surface::new(Shape::from(Node::Torus(Torus { ring, tube })));
    vec![
        scene("pillars", vec![pillar(0.0, 2.0), pillar(1.0, -2.0)]),
        scene("balls in cells", balls.collect()),
        scene("a marched field", vec![torus]),
    ]
}

/// Protects arrivals among all other kinds of surfaces. Curved surfaces multiply errors by about 2 × 10 m ÷ 0.3 m per
/// reflection.
#[test]
fn crossings_among_curved_surfaces_are_exact() {
    let allowed = Allowed {
        off: |reflections| 4e-6 * 60f64.powi(reflections.min(2) as i32),
        parted: 0.02,
    };
    let context = context(Api::Gl);
    let nowhere = Vec3::new(0.0, 0.0, 100.0);
    for scene in curved() {
        for settings in [Settings::hybrid(), Settings::march()] {
            let settings = settings.with_waves(8000);
            compare(&context, &scene, nowhere, &settings, 3, &allowed);
        }
    }
}

/// Protects the division of the work: chunks of any length and any number of records give the same arrivals, except for
/// the last bits of lengths, which are summed from different parts. In `march` starts are sorted.
#[test]
fn records_and_chunks_change_nothing() {
    for_each_api(|context| {
        for settings in [Settings::hybrid(), Settings::march()] {
            any_division_is_the_same(context, &settings.with_waves(2000));
        }
    });
}

fn any_division_is_the_same(context: &Context, settings: &Settings) {
    let mut tracer = Tracer::new(context).unwrap();
    // The walls of the shoebox reflect waves past the listener many times.
    let scene = builtin("shoebox");
    let mut traced = |records: u32, chunk: u32| {
        let how = ArrivalSettings {
            records,
            iterations_in_chunk: chunk,
            ..ArrivalSettings::new(0.5).with_iterations(130)
        };
        arrivals(&mut tracer, &scene, settings, &how)
    };
    let (expected, counts) = traced(4, 64);
    assert!(
        expected
            .chunk_by(|a, b| a.wave == b.wave)
            .any(|of| of.len() > 4)
    );
    let unit = 1.0 / (counts.open_volume_m3 * 2000.0);
    let (again, _) = traced(4, 64);
    assert_eq!(again, expected);
    let (by_one, same) = traced(1, 64);
    assert_eq!(by_one, expected);
    assert_eq!(same, counts);
    for chunk in [1, 7] {
        let (other, other_counts) = traced(4, chunk);
        assert_eq!(other.len(), expected.len());
        assert_eq!(other_counts.flown, counts.flown);
        for (a, b) in other.iter().zip(&expected) {
            assert_eq!((a.wave, a.is_early), (b.wave, b.is_early));
            assert!((a.length_m - b.length_m).abs() < 1e-4, "{a:?} {b:?}");
            assert!(a.direction.distance(b.direction) < 1e-9);
            // A chord is rounded to 2^-17 of four radii.
            let chords = (a.energy[0] - b.energy[0]).abs() / unit;
            assert!(chords < 1e-4, "{a:?} {b:?}");
        }
    }
}

/// Protects waves that are followed in parts, and waves with given starts: both give the same arrivals as all waves
/// together. A weight is the initial energy of a wave. In `march` starts are sorted block by block, and scattering
/// depends on the number of a wave.
#[test]
fn parts_and_given_starts_are_the_same_waves() {
    for_each_api(|context| {
        for settings in [Settings::hybrid(), Settings::march()] {
            parts_are_the_same(context, &settings.with_waves(3000));
        }
    });
}

fn parts_are_the_same(context: &Context, settings: &Settings) {
    let mut tracer = Tracer::new(context).unwrap();
    let mut scene = builtin("shoebox");
    let how = ArrivalSettings::new(0.3);
    let starts = tracer.start_directions(settings).unwrap();
    let half = Material::absorbing(0.1).scattering_by(0.5);
    for material in [Material::absorbing(0.0), Material::absorbing(0.3), half] {
        scene.materials.insert("wall".into(), material);
        for surface in &mut scene.surfaces {
            surface.material = Some("wall".to_owned());
        }
        let (all, counts) = arrivals(&mut tracer, &scene, settings, &how);
        let pair = scene.only_pair().unwrap();
        let mut of = |waves: &WavesToFollow| {
            let mut some = Vec::new();
            let mut take = |arrival: Arrival| some.push(arrival);
            let followed = tracer.arrivals_of(pair, settings, &how, waves, &mut take);
            some.sort_by_key(|arrival| arrival.wave);
            (some, followed.unwrap())
        };
        let [(first, few), (others, many)] =
            [0..700, 700..3000].map(|numbers| of(&WavesToFollow::Numbers(numbers)));
        assert_eq!([first, others].concat(), all);
        let together = few.and(many).counts();
        assert_eq!(
            (together.arrivals, together.flown),
            (counts.arrivals, counts.flown)
        );
        let mut weighted = |weight: f32| {
            let start = |direction: &Vec3| Start {
                direction: *direction,
                weight,
            };
            let give = |numbers: std::ops::Range<u32>| {
                let numbers = numbers.start as usize..numbers.end as usize;
                starts[numbers].iter().map(start).collect()
            };
            let (arrivals, followed) = of(&WavesToFollow::Starts {
                waves: settings.waves,
                of: &give,
            });
            (arrivals, followed.counts())
        };
        assert_eq!(weighted(1.0), (all.clone(), counts));
        let (twice, _) = weighted(2.0);
        assert_eq!(twice.len(), all.len());
        for (twice, once) in twice.iter().zip(&all) {
            assert_eq!(twice.energy, once.energy.map(|energy| 2.0 * energy));
            assert_eq!(twice.length_m, once.length_m);
        }
    }
}

/// Protects runs of several blocks: each block gets the starts of its waves.
#[test]
fn given_starts_go_on_from_block_to_block() {
    let context = context(Api::Gl);
    for settings in [Settings::hybrid(), Settings::march()] {
        blocks_go_on(&context, &settings.with_waves(WAVES_IN_BLOCK + 500));
    }
}

fn blocks_go_on(context: &Context, settings: &Settings) {
    let mut tracer = Tracer::new(context).unwrap();
    let scene = builtin("shoebox");
    let how = ArrivalSettings::new(0.05);
    let starts = tracer.start_directions(settings).unwrap();
    let (all, _) = arrivals(&mut tracer, &scene, settings, &how);
    let give = |numbers: std::ops::Range<u32>| {
        let start = |wave: u32| Start {
            direction: starts[wave as usize],
            weight: 1.0,
        };
        numbers.map(start).collect()
    };
    let waves = WavesToFollow::Starts {
        waves: settings.waves,
        of: &give,
    };
    let mut given = Vec::new();
    let mut take = |arrival: Arrival| given.push(arrival);
    tracer
        .arrivals_of(
            scene.only_pair().unwrap(),
            settings,
            &how,
            &waves,
            &mut take,
        )
        .unwrap();
    given.sort_by_key(|arrival| arrival.wave);
    assert!(all.iter().any(|arrival| arrival.wave >= WAVES_IN_BLOCK));
    assert_eq!(given, all);
}

/// Protects sums over arrivals, whose last bits depend on the order of the arrivals. With sorted starts too, the
/// arrivals of a chunk are in the order of the waves' numbers, including the arrivals of waves that are drawn again.
#[test]
fn sorted_waves_arrive_in_the_order_of_their_numbers() {
    for_each_api(|context| {
        let mut tracer = Tracer::new(context).unwrap();
        let scene = builtin("shoebox");
        // The textures of the first run are larger than those that the second run needs.
        for waves in [3001, 1999] {
            let settings = Settings::march().with_waves(waves);
            let how = ArrivalSettings {
                records: 1,
                ..ArrivalSettings::new(0.5).with_iterations(8)
            };
            let mut all = Vec::new();
            let mut take = |arrival: Arrival| all.push(arrival);
            tracer.arrivals(&scene, &settings, &how, &mut take).unwrap();
            assert!(all.is_sorted_by_key(|arrival| (arrival.wave, arrival.reflections)));
            assert!(all.array_windows().any(|[a, b]| a.wave == b.wave));
        }
    });
}

/// Protects the estimate of a decay: waves that are traced until their energy is gone give the same arrivals as waves
/// that are traced to the end, except for arrivals without energy.
#[test]
fn waves_are_followed_until_their_energy_is_gone() {
    let context = context(Api::Gl);
    let mut tracer = Tracer::new(&context).unwrap();
    let mut scene = builtin("shoebox");
    let settings = Settings::hybrid().with_waves(2000);
    let to_the_end = ArrivalSettings {
        iterations_in_chunk: 4,
        ..ArrivalSettings::new(10.0)
    };
    let until = to_the_end.clone().with_least_energy(1e-6);
    // Without absorption both settings trace waves to the end.
    let (all, counts) = arrivals(&mut tracer, &scene, &settings, &to_the_end);
    assert_eq!(
        arrivals(&mut tracer, &scene, &settings, &until),
        (all, counts)
    );
    for surface in &mut scene.surfaces {
        surface.material = Some("half".to_owned());
    }
    scene
        .materials
        .insert("half".into(), Material::absorbing(0.5));
    let (all, counts) = arrivals(&mut tracer, &scene, &settings, &to_the_end);
    let (most, fewer) = arrivals(&mut tracer, &scene, &settings, &until);
    assert!(
        2 * fewer.iterations < counts.iterations,
        "{fewer:?} {counts:?}"
    );
    assert!(fewer.energy_under_way.iter().all(|energy| *energy <= 1e-6));
    // No wave was cut off.
    assert_eq!((fewer.cut_off, fewer.flown), (0, counts.flown));
    assert_eq!(fewer.followed_m, f64::INFINITY);
    let energy = |of: &[Arrival]| of.iter().map(|arrival| arrival.energy[4]).sum::<f64>();
    assert!(energy(&most) < energy(&all), "waves have something left");
    // The listener's share of the remaining energy varies, because few of the 2,000 waves cross it.
    let left = (energy(&all) - energy(&most)) / energy(&all);
    assert!(left < 1e-5, "{left}");
}

/// Protects the report of waves that were cut off. If bands have separate waves, the band whose waves get least far
/// determines the report.
#[test]
fn the_band_that_comes_least_far_decides() {
    let followed = |waves: u64, cut_off_m: Vec<f64>| {
        let counts = ArrivalCounts {
            waves,
            cut_off: cut_off_m.len() as u64,
            ..ArrivalCounts::of_none()
        };
        Followed { counts, cut_off_m }
    };
    let whole = followed(10_000, Vec::new()).counts();
    let short = followed(10_000, vec![7.0; 80]).counts();
    let both = whole.and(short);
    assert_eq!(
        (both.waves, both.cut_off, both.followed_m),
        (20_000, 80, 7.0)
    );
    // Reports of waves with the same bands are combined before they are evaluated.
    let together = followed(10_000, Vec::new()).and(followed(70_000, vec![7.0; 80]));
    assert_eq!(together.counts().followed_m, f64::INFINITY);
}
