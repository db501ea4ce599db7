//! Compares responses of scenes with image sources and closed forms.

use echomarch::bands::{BAND_COUNT, Bands};
use echomarch::geometry::ShoeboxEnergies;
use echomarch::glam::Vec3;
use echomarch::response::{BandFigures, Figures};
use echomarch::response::{Response, ResponseSettings};
use echomarch::scene::shape::{Cuboid, Sphere};
use echomarch::{Listener, Scene, Settings, Source, Surface};
use std::f64::consts::PI;

use crate::common::tracer;

const SPEED: f64 = 343.0;

/// A room whose walls absorb differently, and more in higher bands.
struct Shoebox {
    size: Vec3,
    source: Vec3,
    listener: Vec3,
    absorption: [Bands; 6],
}

impl Shoebox {
    /// Each wall absorbs a different multiple of `mean`, and more in each band than in the band below.
    fn new(size: Vec3, source: Vec3, listener: Vec3, mean: f64) -> Shoebox {
        let of_wall = [0.6, 1.3, 1.5, 0.7, 1.1, 0.8];
        let of_band = |band: usize| 0.8 + 0.06 * band as f64;
        let absorption =
            of_wall.map(|wall| std::array::from_fn(|band| (mean * wall * of_band(band)).min(0.95)));
        Shoebox {
            size,
            source,
            listener,
            absorption,
        }
    }

    fn scene(&self) -> Scene {
        let (source, listener) = (Source::at(self.source), Listener::at(self.listener, 0.3));
        Scene::shoebox(self.size, &self.absorption, source, listener)
    }

    /// The exact figures, by image sources.
    fn truth(&self, seconds: f64) -> Figures {
        let [size, source, listener] =
            [self.size, self.source, self.listener].map(|v| v.as_dvec3());
        let exact = ShoeboxEnergies::new(size, source, listener, &self.absorption).unwrap();
        Figures::of_image_sources(&exact, SPEED, seconds).unwrap()
    }
}

/// The largest error of a figure over all bands, relative or in the unit of the figure. At least half of the bands must
/// have the figure.
fn worst(
    truth: &Figures,
    found: &Figures,
    relative: bool,
    figure: impl Fn(&BandFigures) -> Option<f64>,
) -> f64 {
    let of_band = |band: usize| {
        let truth = figure(&truth.bands[band])?;
        let off = (figure(&found.bands[band])? - truth).abs();
        Some(if relative { off / truth } else { off })
    };
    let all: Vec<f64> = (0..BAND_COUNT).filter_map(of_band).collect();
    assert!(all.len() >= BAND_COUNT / 2, "{truth:?} {found:?}");
    all.into_iter().fold(0.0, f64::max)
}

/// Protects the documented accuracy with 262,144 waves, from the scene to the figures. T30 and EDT are within 3 % of
/// those of image sources, C80 is within 0.3 dB and G within 0.15 dB, in a live and in a dry room.
#[test]
fn a_shoebox_answers_as_its_image_sources_do() {
    let mut tracer = tracer();
    let live = Shoebox::new(
        Vec3::new(8.0, 3.0, 5.0),
        Vec3::new(-2.0, 0.1, -1.5),
        Vec3::new(2.0, -0.3, 1.5),
        0.15,
    );
    let dry = Shoebox::new(
        Vec3::new(6.0, 4.0, 7.0),
        Vec3::new(1.5, -0.7, 2.0),
        Vec3::new(-1.0, 0.4, -1.9),
        0.4,
    );
    // The room in which pyroomacoustics was measured (docs/acoustics.md).
    let mut peers = Shoebox::new(
        Vec3::new(8.0, 3.0, 5.0),
        Vec3::new(-2.0, 0.0, -1.5),
        Vec3::new(2.0, -0.3, 1.5),
        0.2,
    );
    peers.absorption = [[0.2; BAND_COUNT]; 6];
    for room in [live, dry, peers] {
        let settings =
            ResponseSettings::default().with_trace(Settings::default().with_waves(1 << 18));
        let response = Response::trace(&mut tracer, &room.scene(), &settings).unwrap();
        let (truth, found) = (room.truth(response.seconds), &response.figures);
        let times = [
            worst(&truth, found, true, |f| f.t30_s),
            worst(&truth, found, true, |f| f.edt_s),
        ];
        let c80_db = worst(&truth, found, false, |f| {
            f.c80_db.filter(|c80_db| *c80_db < 20.0)
        });
        let g_db = worst(&truth, found, false, |f| f.g_db);
        println!("T30, EDT {times:.4?}, C80 {c80_db:.3} dB, G {g_db:.3} dB");
        assert!(times.iter().all(|time| *time < 0.03), "{times:?}");
        assert!(c80_db < 0.3 && g_db < 0.15, "C80 {c80_db} dB, G {g_db} dB");
    }
}

/// Protects the end of an uneven decay, in which sound is reflected between two hard walls after the other walls have
/// absorbed the rest. Each band's T30 is reported and correct.
#[test]
fn the_end_of_an_uneven_decay_is_told() {
    let mut tracer = tracer();
    let mut room = Shoebox::new(
        Vec3::new(9.4, 7.2, 12.1),
        Vec3::new(-3.0, 1.1, 2.5),
        Vec3::new(2.0, -1.3, -4.0),
        0.0,
    );
    let [hard, soft] = [0.1, 0.6].map(|mean: f64| -> Bands {
        std::array::from_fn(|band| mean * (0.8 + 0.06 * band as f64))
    });
    room.absorption = [soft, soft, soft, soft, hard, hard];
    let settings = ResponseSettings::default().with_trace(Settings::default().with_waves(1 << 18));
    let response = Response::trace(&mut tracer, &room.scene(), &settings).unwrap();
    let (truth, found) = (room.truth(response.seconds), &response.figures);
    for band in 0..BAND_COUNT {
        let truth = truth.bands[band].t30_s.expect("the decay is long enough");
        let (t30_s, error) = found.bands[band]
            .t30_s
            .zip(found.errors[band].t30_s)
            .unwrap_or_else(|| panic!("band {band} has no T30: {truth} s"));
        let off = (t30_s - truth).abs();
        assert!(
            off < 0.03 * truth && off < 4.0 * error,
            "{t30_s} ± {error}, {truth}"
        );
    }
}

/// Protects the level in an anechoic room: there is the direct sound alone, whose level is exact, and no wave can be
/// missed.
#[test]
fn walls_that_absorb_all_leave_the_direct_sound() {
    let scene = Scene::shoebox(
        [8.0, 6.0, 8.0],
        &[[1.0; BAND_COUNT]; 6],
        Source::at([-2.0, 0.0, 0.0]),
        Listener::at([2.0, 0.0, 0.0], 0.2),
    );
    let settings = ResponseSettings::default().with_trace(Settings::default().with_waves(1 << 14));
    let response = Response::trace(&mut tracer(), &scene, &settings).unwrap();
    let exact_db = 20.0 - 20.0 * 4.0_f64.log10();
    let bands = response.figures.bands.iter().zip(&response.figures.errors);
    for (figures, errors) in bands {
        let g_db = figures.g_db.expect("a level");
        assert!((g_db - exact_db).abs() < 1e-3, "{g_db}");
        // The mean over the listener's sphere differs by 0.004 dB.
        assert!(errors.g_db.is_some_and(|error| error < 0.005), "{errors:?}");
    }
}

/// Protects early paths: all image sources of up to three reflections in a room are found, with their delays, levels by
/// band and directions.
#[test]
fn early_paths_are_the_image_sources() {
    let mut tracer = tracer();
    let room = Shoebox::new(
        Vec3::new(8.0, 3.0, 5.0),
        Vec3::new(-2.0, 0.1, -1.5),
        Vec3::new(2.0, -0.3, 1.5),
        0.3,
    );
    let settings = ResponseSettings::default()
        .with_trace(Settings::default().with_waves(1 << 14))
        .with_seconds(0.2)
        .with_order(3);
    let response = Response::trace(&mut tracer, &room.scene(), &settings).unwrap();
    let [size, source, listener] = [room.size, room.source, room.listener].map(|v| v.as_dvec3());
    let images = ShoeboxEnergies::new(size, source, listener, &room.absorption)
        .unwrap()
        .images(3)
        .unwrap();
    assert_eq!(response.paths.len(), 63);
    // The additional search directions find the paths that only few waves find.
    let missed = response.missed.energy_share().unwrap();
    assert!(missed < 0.01, "{missed}");
    assert_eq!(images.len(), 63);
    for image in &images {
        let near = |path: &&echomarch::response::HeardPath| {
            let same_way = path.path.arrival_direction.distance(image.direction) < 1e-6;
            same_way && (path.delay_s - image.length_m / SPEED).abs() < 1e-6
        };
        let path = response.paths.iter().find(near).unwrap();
        for band in 0..BAND_COUNT {
            let off_db = 10.0 * (path.energy[band] / image.energy[band]).log10();
            assert!(off_db.abs() < 0.01, "{off_db} dB");
        }
    }
}

/// Protects the energy of paths that waves miss: a small number of waves misses most paths of up to 16 reflections, and
/// other paths supply their energy.
#[test]
fn paths_that_few_waves_find_take_no_energy_away() {
    let mut tracer = tracer();
    let room = Shoebox::new(
        Vec3::new(18.0, 3.0, 3.6),
        Vec3::new(4.1, 0.3, 0.4),
        Vec3::new(-5.7, -0.6, 0.9),
        0.05,
    );
    const TIMES: u32 = 8;
    let mut g_db = [0.0; BAND_COUNT];
    let mut seconds = 0.0;
    for seed in 0..TIMES {
        let trace = Settings::default().with_waves(1 << 13).with_seed(seed);
        let settings = ResponseSettings::default().with_trace(trace).with_order(16);
        let response = Response::trace(&mut tracer, &room.scene(), &settings).unwrap();
        seconds = response.seconds;
        for (sum, figures) in g_db.iter_mut().zip(&response.figures.bands) {
            *sum += figures.g_db.unwrap() / f64::from(TIMES);
        }
    }
    let truth = room.truth(seconds);
    for (found, truth) in g_db.iter().zip(&truth.bands) {
        let off_db = found - truth.g_db.unwrap();
        println!("{off_db:.3} dB");
        assert!(off_db.abs() < 0.05, "{off_db} dB");
    }
}

/// Protects bands from each other: bands without scattering agree with image sources, for any scattering in the other
/// bands.
#[test]
fn mirrored_bands_are_exact_beside_bands_that_scatter() {
    let room = Shoebox::new(
        Vec3::new(8.0, 3.0, 5.0),
        Vec3::new(-2.0, 0.1, -1.5),
        Vec3::new(2.0, -0.3, 1.5),
        0.2,
    );
    let mut scene = room.scene();
    for material in scene.materials.values_mut() {
        material.scattering = [0.0, 0.0, 0.1, 0.1, 0.5, 0.5, 1.0, 1.0];
    }
    let settings = ResponseSettings::default().with_trace(Settings::default().with_waves(1 << 15));
    let response = Response::trace(&mut tracer(), &scene, &settings).unwrap();
    let (found, truth) = (&response.figures, room.truth(response.seconds));
    for band in 0..2 {
        let (found, truth) = (&found.bands[band], &truth.bands[band]);
        let decay_off = found.t30_s.unwrap() / truth.t30_s.unwrap() - 1.0;
        assert!(decay_off.abs() < 0.03, "{band}: {decay_off}");
        let level_off = found.g_db.unwrap() - truth.g_db.unwrap();
        assert!(level_off.abs() < 0.05, "{band}: {level_off} dB");
    }
}

/// Protects a source in an edge or corner of a hollow box: each wall reflects the waves that fly towards it, and no
/// wave is lost.
#[test]
fn a_source_in_the_edge_of_a_hollow_box_loses_nothing() {
    let mut tracer = tracer();
    let half = Vec3::new(4.0, 1.5, 2.5);
    for corner in [
        Vec3::new(-4.0, -1.5, 0.3),
        Vec3::new(4.0, 0.2, 2.5),
        Vec3::new(-4.0, -1.5, -2.5),
    ] {
        let mut room = Shoebox::new(2.0 * half, corner, Vec3::new(2.0, -0.3, 1.5), 0.2);
        room.absorption = [[0.2; BAND_COUNT]; 6];
        let mut scene = room.scene();
        let hollow = echomarch::Shape::from(Cuboid { size: room.size }).complement();
        scene.surfaces = vec![Surface::new(hollow)];
        scene.surfaces[0].material = Some("wall 0".to_owned());
        for order in [0, 8] {
            let settings = ResponseSettings::default().with_order(order);
            let response = Response::trace(&mut tracer, &scene, &settings).unwrap();
            let truth = room.truth(response.seconds).bands[0].g_db.unwrap();
            let found = response.figures.bands[0].g_db.unwrap();
            let error = response.figures.errors[0].g_db.unwrap();
            println!("{corner} order {order}: {found} ± {error} dB, {truth} dB");
            assert!(error < 0.15, "{corner} {order}: {error} dB");
            assert!(
                (found - truth).abs() < 4.0 * error,
                "{corner} {order}: {found} ± {error} dB, {truth} dB"
            );
        }
    }
}

/// Protects a source on an edge or at a corner of a box: its level does not depend on the order of exact paths.
#[test]
fn a_source_on_an_edge_of_a_box_is_as_loud_with_any_order() {
    let mut tracer = tracer();
    for source in [
        Vec3::new(-0.5, -1.2, 0.5),
        Vec3::new(-0.5, -0.5, 0.5),
        Vec3::new(-0.5, -1.5, 0.5),
    ] {
        let room = Shoebox::new(
            Vec3::new(8.0, 3.0, 5.0),
            source,
            Vec3::new(2.0, -0.3, 1.5),
            0.2,
        );
        let mut scene = room.scene();
        let mut block = Surface::new(Cuboid { size: Vec3::ONE }).at(Vec3::NEG_Y);
        block.material = Some("wall 0".to_owned());
        scene.surfaces.push(block);
        let g_db = [0, 4, 8].map(|order| {
            let settings = ResponseSettings::default()
                .with_trace(Settings::default().with_waves(1 << 17))
                .with_order(order);
            let response = Response::trace(&mut tracer, &scene, &settings).unwrap();
            let (figures, errors) = (&response.figures.bands[0], &response.figures.errors[0]);
            (figures.g_db.unwrap(), errors.g_db.unwrap())
        });
        println!("{source}: {g_db:.3?}");
        assert!(g_db.iter().all(|(_, error)| *error < 0.2), "{g_db:?}");
        let (of_waves, error_of_waves) = g_db[0];
        for (found, error) in &g_db[1..] {
            let off_db = (found - of_waves).abs();
            assert!(off_db < 4.0 * error.hypot(error_of_waves), "{g_db:?}");
        }
    }
}

/// Protects live sound with time for only few late waves: exact paths stay the same bit for bit, and the level stays
/// correct, also in a hollow ball, which focuses sound.
#[test]
fn fewer_late_waves_bring_the_same_energy() {
    let mut tracer = tracer();
    let shoebox = Shoebox::new(
        Vec3::new(8.0, 3.0, 5.0),
        Vec3::new(-2.0, 0.1, -1.5),
        Vec3::new(2.0, -0.3, 1.5),
        0.2,
    );
    let mut ball = shoebox.scene();
    ball.surfaces = vec![Surface::new(
        echomarch::Shape::from(Sphere { radius: 5.0 }).complement(),
    )];
    ball.surfaces[0].material = Some("wall 0".to_owned());
    for scene in [shoebox.scene(), ball] {
        let all = ResponseSettings::default().with_seconds(2.0).with_order(2);
        let few = all.clone().with_late_waves(1 << 13);
        let [all, few] = [all, few].map(|settings| Response::trace(&mut tracer, &scene, &settings));
        let (all, few) = (all.unwrap(), few.unwrap());
        assert!(few.counts.waves <= 1 << 13 && all.counts.waves > 1 << 15);
        let paths = |response: &Response| {
            response
                .paths
                .iter()
                .map(|path| path.energy)
                .collect::<Vec<_>>()
        };
        assert_eq!(paths(&all), paths(&few));
        for band in 0..BAND_COUNT {
            let g_db = |response: &Response| response.figures.bands[band].g_db.unwrap();
            let errors = [&all, &few].map(|response| response.figures.errors[band].g_db.unwrap());
            let off_db = (g_db(&all) - g_db(&few)).abs();
            assert!(
                off_db < 4.0 * errors[0].hypot(errors[1]),
                "{band}: {off_db} dB, {errors:?}"
            );
            // In the ball both errors include the difference between exact paths and the waves that they replace, 0.4
            // dB.
            assert!(errors[1] < errors[0] + 0.2 && errors[0] < 0.6, "{errors:?}");
        }
    }
}

/// Protects the open field: there is only the direct sound, 1/r², and silence behind a wall that absorbs everything.
#[test]
fn in_the_open_there_is_the_direct_sound_alone() {
    let mut tracer = tracer();
    // A scene needs a surface. No wave hits this one.
    let speck = Surface::new(Sphere { radius: 1e-3 }).at(Vec3::Y * -1000.0);
    let scene = Scene::new(
        "open",
        vec![speck],
        Source::at(Vec3::X * 10.0),
        Listener::at(Vec3::ZERO, 0.3),
    );
    let settings = ResponseSettings::default().with_trace(Settings::default().with_waves(4096));
    let response = Response::trace(&mut tracer, &scene, &settings).unwrap();
    assert_eq!(response.paths.len(), 1);
    let expected = 1.0 / (4.0 * PI * 100.0);
    for (energy, figures) in response.energy().iter().zip(&response.figures.bands) {
        assert!((energy / expected - 1.0).abs() < 1e-9);
        assert!(figures.g_db.unwrap().abs() < 1e-6);
        assert_eq!(figures.t30_s, None);
    }
    assert!((response.direct().unwrap().azimuth.to_degrees() - 90.0).abs() < 1e-6);
}
