//! Known energies of arrivals: without absorption the energy is conserved, and with full absorption none remains.

use super::super::case::{EnergyCheck, Verdict};
use super::super::{Case, Check};
use super::build::{block, room, scene};
use echomarch::Error;
use echomarch::bands::{BAND_COUNT, Bands};
use echomarch::response::{Arrival, Echogram};
use echomarch::scene::shape::{Plane, Sphere};
use echomarch::scene::{Listener, Material, Scene, Source, Surface};
use echomarch::tracer::{ArrivalCounts, ArrivalSettings, Settings, Tracer};
use glam::{DVec3, Vec3};
use std::f64::consts::PI;

/// Number of waves of each case.
const WAVES: u32 = 1 << 16;

/// Number of reflections over which energy must be conserved.
const CONSERVED: u32 = 200;

/// Maximum difference between two independent samples of waves, in standard deviations. Larger differences occur in one
/// of 16 000 cases.
const DEVIATIONS: f64 = 4.0;

type Judge = fn(&mut Tracer, &Settings) -> Result<Verdict, Error>;

pub fn cases() -> Vec<Case> {
    let case = |name: &str, hard, exact: &str, bound, judge: Judge| Case {
        name: name.to_owned(),
        hard,
        exact: exact.to_owned(),
        check: Check::Energies(EnergyCheck { bound, judge }),
    };
    vec![
        case(
            "energy-conserved-200",
            "nothing absorbs, half is scattered, over 200 reflections",
            "every wave is still travelling with all of its energy",
            "1e-9",
            conserved,
        ),
        case(
            "absorption-100",
            "every surface absorbs all energy",
            "only the direct sound arrives",
            "exact",
            silenced,
        ),
        case(
            "bands-independent",
            "absorption differs by band",
            "each band has the energy of a scene in which all bands equal it",
            "1e-9",
            independent,
        ),
        case(
            "listener-at-wall",
            "half of the listener's sphere is in the ground",
            "the mean density of the source and its image over the open half",
            "4 standard deviations",
            at_wall,
        ),
        case(
            "reciprocity",
            "source and listener are exchanged in a furnished room",
            "the same energy",
            "4 standard deviations",
            reciprocal,
        ),
        case(
            "surfaces-reordered",
            "the surfaces are listed in the other order",
            "the same energy by band",
            "1e-4",
            reordered,
        ),
    ]
}

/// The arrivals of a traced scene.
struct Heard {
    energy: Bands,
    /// Length of the longest path, in metres.
    longest_m: f64,
    /// The number of equal arrivals with the same noise.
    effective: f64,
    counts: ArrivalCounts,
}

fn heard(
    tracer: &mut Tracer,
    scene: &Scene,
    settings: &Settings,
    iterations: u32,
) -> Result<Heard, Error> {
    /// Length of the response in seconds, which is enough for all iterations.
    const SECONDS: f64 = 100.0;
    const BIN_S: f64 = 0.1;
    let how = ArrivalSettings::new(SECONDS).with_iterations(iterations);
    let mut echogram = Echogram::new(BIN_S, 1)?;
    let mut longest_m: f64 = 0.0;
    let mut added = Ok(());
    let mut take = |arrival: Arrival| {
        longest_m = longest_m.max(arrival.length_m);
        let speed = scene.speed_of_sound();
        let this = echogram.add_arrival(&arrival, speed, &[0.0; BAND_COUNT]);
        added = added.clone().and(this);
    };
    let counts = tracer.arrivals(scene, &settings.clone().with_waves(WAVES), &how, &mut take)?;
    added?;
    Ok(Heard {
        energy: echogram.total(),
        longest_m,
        effective: echogram.effective_arrivals(0, 0.0),
        counts,
    })
}

/// A room with a block and a ball, all with the same material.
fn furnished(material: Material) -> Scene {
    let ball = Surface::new(Sphere { radius: 1.0 }).at(Vec3::new(-2.0, -0.5, 2.0));
    let cabinet = block(1.0, 2.0, 1.5).at(Vec3::new(2.0, -1.0, -2.0));
    let surfaces = [room(12.0, 6.0, 10.0), cabinet, ball]
        .map(|surface| surface.with_material("all"))
        .into();
    let listener = Listener::at(Vec3::new(3.0, 0.5, 2.0), 0.5);
    let mut scene = scene("furnished", surfaces, Vec3::new(-4.0, 0.3, -3.0), listener);
    scene.materials.insert("all".to_owned(), material);
    scene
}

fn by_band() -> Material {
    let mut material = Material::absorbing(0.0);
    material.absorption = std::array::from_fn(|band| 0.05 + 0.1 * band as f64);
    material
}

fn verdict(off: f64, bound: f64) -> Verdict {
    Verdict {
        passed: off <= bound,
        note: format!("off by {off:.1e}"),
    }
}

/// The largest relative difference between two energies over all bands.
fn apart(found: &Bands, expected: &Bands) -> f64 {
    let shares = found.iter().zip(expected).map(|(a, b)| (a / b - 1.0).abs());
    shares.fold(0.0, f64::max)
}

fn conserved(tracer: &mut Tracer, settings: &Settings) -> Result<Verdict, Error> {
    let scene = furnished(Material::absorbing(0.0).scattering_by(0.5));
    let counts = heard(tracer, &scene, settings, CONSERVED)?.counts;
    let off = apart(&counts.energy_under_way, &[1.0; BAND_COUNT]);
    Ok(verdict(off, 1e-9))
}

fn silenced(tracer: &mut Tracer, settings: &Settings) -> Result<Verdict, Error> {
    let scene = furnished(Material::absorbing(1.0));
    let heard = heard(tracer, &scene, settings, CONSERVED)?;
    let Listener {
        position, radius, ..
    } = scene.listeners[0];
    let direct_m = f64::from(scene.sources[0].position.distance(position) + radius);
    let counts = &heard.counts;
    Ok(Verdict {
        passed: counts.arrivals > 0 && heard.longest_m <= direct_m,
        note: format!("{} arrivals, none later", counts.arrivals),
    })
}

fn independent(tracer: &mut Tracer, settings: &Settings) -> Result<Verdict, Error> {
    /// The bands that are each compared with a scene of their own.
    const HELD: [usize; 3] = [0, 3, 7];
    const ITERATIONS: u32 = 50;
    let all = heard(tracer, &furnished(by_band()), settings, ITERATIONS)?;
    let mut off: f64 = 0.0;
    for band in HELD {
        let alone = Material::absorbing(by_band().absorption[band]);
        let alone = heard(tracer, &furnished(alone), settings, ITERATIONS)?;
        off = off.max((all.energy[band] / alone.energy[band] - 1.0).abs());
    }
    Ok(verdict(off, 1e-9))
}

fn at_wall(tracer: &mut Tracer, settings: &Settings) -> Result<Verdict, Error> {
    let (source, radius) = (Vec3::new(1.0, 1.5, -1.0), 0.5_f32);
    let listener = Listener::at(Vec3::ZERO, radius);
    let scene = scene("ground", vec![Surface::new(Plane)], source, listener);
    let found = heard(tracer, &scene, settings, 2)?;
    let expected = mean_over_half(source.as_dvec3(), radius.into());
    let off = (found.energy[0] / expected - 1.0).abs();
    Ok(verdict(off, DEVIATIONS / found.effective.sqrt()))
}

/// The mean energy density of a source above a plane through the origin and of its mirror image, over the upper half of
/// a ball around the origin.
fn mean_over_half(source: DVec3, radius: f64) -> f64 {
    const STEPS: i32 = 40;
    let image = source * DVec3::new(1.0, -1.0, 1.0);
    let (mut sum, mut count) = (0.0, 0.0);
    for x in -STEPS..STEPS {
        for y in 0..STEPS {
            for z in -STEPS..STEPS {
                let middle = DVec3::new(x.into(), y.into(), z.into()) + 0.5;
                let point = middle * (radius / f64::from(STEPS));
                if point.length() < radius {
                    let from = [source, image].map(|from| point.distance_squared(from).recip());
                    sum += (from[0] + from[1]) / (4.0 * PI);
                    count += 1.0;
                }
            }
        }
    }
    sum / count
}

fn reciprocal(tracer: &mut Tracer, settings: &Settings) -> Result<Verdict, Error> {
    const ITERATIONS: u32 = 60;
    let there = furnished(Material::absorbing(0.3));
    let mut back = there.clone();
    back.sources = vec![Source::at(there.listeners[0].position)];
    let radius = there.listeners[0].radius;
    back.listeners = vec![Listener::at(there.sources[0].position, radius)];
    let there = heard(tracer, &there, settings, ITERATIONS)?;
    let back = heard(tracer, &back, settings, ITERATIONS)?;
    let deviation = (1.0 / there.effective + 1.0 / back.effective).sqrt();
    let off = (there.energy[0] / back.energy[0] - 1.0).abs();
    Ok(verdict(off, DEVIATIONS * deviation))
}

fn reordered(tracer: &mut Tracer, settings: &Settings) -> Result<Verdict, Error> {
    const ITERATIONS: u32 = 20;
    let listed = furnished(by_band());
    let mut reversed = listed.clone();
    reversed.surfaces.reverse();
    let listed = heard(tracer, &listed, settings, ITERATIONS)?;
    let reversed = heard(tracer, &reversed, settings, ITERATIONS)?;
    Ok(verdict(apart(&reversed.energy, &listed.energy), 1e-4))
}
