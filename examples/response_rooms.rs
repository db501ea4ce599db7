//! Compares figures of responses in random rectangular rooms with figures from image sources (docs/acoustics.md):
//! `response_rooms WAVES ROOMS SEED LEAST MOST`. The absorption coefficient of each wall in each band is a random
//! number from LEAST to MOST whose logarithm is uniformly distributed.

use echomarch::bands::{BAND_COUNT, Bands};
use echomarch::geometry::ShoeboxEnergies;
use echomarch::gl::{Context, ContextOptions};
use echomarch::glam::Vec3;
use echomarch::response::{BandFigures, Figures};
use echomarch::response::{Response, ResponseSettings};
use echomarch::{Listener, Scene, Settings, Source, Tracer};
use fastrand::Rng;

const SPEED: f64 = 343.0;

/// Radius of the listener, and minimum distance of source and listener from the walls, in metres.
const RADIUS: f32 = 0.3;
const FROM_WALLS: f32 = 0.5;

/// A figure, the method of its comparison, and the counts of the results.
struct Tally {
    name: &'static str,
    of: fn(&BandFigures) -> Option<f64>,
    /// Whether the error is relative to the true value, in per cent.
    is_relative: bool,
    /// Maximum acceptable error, in per cent or in the figure's unit.
    limit: f64,
    exist: u32,
    told: u32,
    within: u32,
    beyond: u32,
    worst: f64,
}

impl Tally {
    fn times(name: &'static str, of: fn(&BandFigures) -> Option<f64>) -> Tally {
        Tally::new(name, of, true, 3.0)
    }

    fn levels(name: &'static str, of: fn(&BandFigures) -> Option<f64>, limit: f64) -> Tally {
        Tally::new(name, of, false, limit)
    }

    fn new(
        name: &'static str,
        of: fn(&BandFigures) -> Option<f64>,
        is_relative: bool,
        limit: f64,
    ) -> Tally {
        let [exist, told, within, beyond] = [0; 4];
        Tally {
            name,
            of,
            is_relative,
            limit,
            exist,
            told,
            within,
            beyond,
            worst: 0.0,
        }
    }

    fn count(&mut self, found: &Figures, truth: &Figures) {
        for band in 0..BAND_COUNT {
            let Some(truth) = (self.of)(&truth.bands[band]) else {
                continue;
            };
            self.exist += 1;
            let told = (self.of)(&found.bands[band]).zip((self.of)(&found.errors[band]));
            let Some((found, error)) = told else {
                continue;
            };
            self.told += 1;
            let off = (found - truth).abs();
            self.within += u32::from(off <= 2.0 * error);
            let share = if self.is_relative { 100.0 / truth } else { 1.0 };
            self.beyond += u32::from(off * share > self.limit);
            self.worst = self.worst.max(off * share);
        }
    }
}

/// A room of 20 to 4,500 m³, the absorption of its walls, and the positions of source and listener.
struct Case {
    size: Vec3,
    source: Vec3,
    listener: Vec3,
    absorption: [Bands; 6],
}

impl Case {
    fn draw(random: &mut Rng, least: f64, most: f64) -> Case {
        let mut from_to = |least: f32, most: f32| least + (most - least) * random.f32();
        let size = Vec3::new(from_to(3.0, 25.0), from_to(2.5, 10.0), from_to(3.0, 18.0));
        let most_far = size / 2.0 - FROM_WALLS;
        let mut place = || {
            let [x, y, z] = most_far.to_array().map(|far| from_to(-far, far));
            Vec3::new(x, y, z)
        };
        let (source, listener) = (place(), place());
        let mut share = || least * (most / least).powf(random.f64());
        let absorption = std::array::from_fn(|_| std::array::from_fn(|_| share()));
        Case {
            size,
            source,
            listener,
            absorption,
        }
    }

    fn scene(&self) -> Scene {
        let (source, listener) = (Source::at(self.source), Listener::at(self.listener, RADIUS));
        Scene::shoebox(self.size, &self.absorption, source, listener)
    }

    fn truth(&self, seconds: f64) -> Option<Figures> {
        let [size, source, listener] =
            [self.size, self.source, self.listener].map(|v| v.as_dvec3());
        let exact = ShoeboxEnergies::new(size, source, listener, &self.absorption)?;
        Figures::of_image_sources(&exact, SPEED, seconds).ok()
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let number = |place: usize, otherwise: f64| match arguments.get(place) {
        Some(text) => text.parse(),
        None => Ok(otherwise),
    };
    let (waves, rooms) = (number(1, 262_144.0)? as u32, number(2, 14.0)? as u32);
    let (seed, least, most) = (number(3, 1.0)? as u64, number(4, 0.02)?, number(5, 0.9)?);
    let mut tracer = Tracer::new(&Context::headless(&ContextOptions::default())?)?;
    println!("renderer: {}", tracer.context().renderer());
    let mut random = Rng::with_seed(seed);
    let mut tallies = [
        Tally::times("T30", |figures| figures.t30_s),
        Tally::times("EDT", |figures| figures.edt_s),
        Tally::levels("C80", |figures| figures.c80_db, 0.3),
        Tally::levels("G", |figures| figures.g_db, 0.15),
    ];
    for room in 1..=rooms {
        let case = Case::draw(&mut random, least, most);
        let trace = Settings::default().with_waves(waves).with_seed(room);
        let settings = ResponseSettings::default().with_trace(trace);
        let response = Response::trace(&mut tracer, &case.scene(), &settings)?;
        let truth = case.truth(response.seconds).ok_or("no image sources")?;
        let before = tallies[0].told;
        for tally in &mut tallies {
            tally.count(&response.figures, &truth);
        }
        println!(
            "{room}: {:.1} m, {:.2} s, {:.0} ms, {} bands with T30",
            case.size,
            response.seconds,
            response.milliseconds,
            tallies[0].told - before
        );
    }
    for tally in &tallies {
        let unit = if tally.is_relative { "%" } else { "dB" };
        println!(
            "{}: {} of {} bands reported, {} within two errors, at most {:.3} {unit} off, {} more than {} {unit}",
            tally.name,
            tally.told,
            tally.exist,
            tally.within,
            tally.worst,
            tally.beyond,
            tally.limit
        );
    }
    Ok(())
}
