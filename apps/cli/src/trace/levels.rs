//! Level, delay and direction of each source at a listener.

use super::super::impulse::pairs::chosen;
use super::super::print;
use echomarch::response::{Response, ResponseSettings};
use echomarch::scene::{Pair, Scene};
use echomarch::tracer::Tracer;
use serde::Serialize;

/// Level, delay and direction of a source at a listener.
#[derive(Serialize)]
pub struct Heard {
    source: String,
    listener: String,
    heard: bool,
    /// `g_db` and the following fields are `null` if no sound arrives.
    g_db: Option<f64>,
    delay_s: Option<f64>,
    /// Azimuth of the mean direction of all energy, which may differ from that of the first arrival.
    azimuth_deg: Option<f64>,
    elevation_deg: Option<f64>,
    /// Length of the mean direction vector, 0 to 1.
    one_sided: Option<f64>,
}

/// Minimum length of a mean direction that is reported. A shorter one would be noise.
const LEAST_ONE_SIDED: f64 = 0.1;

/// Traces every pair of a source and a listener, as `impulse` does.
pub fn heard(
    tracer: &mut Tracer,
    scene: &Scene,
    settings: &ResponseSettings,
) -> anyhow::Result<Vec<Heard>> {
    let mut all = Vec::new();
    let pairs = chosen(scene, None, None)?;
    let traced: Vec<Pair> = pairs.iter().map(|pair| pair.pair).collect();
    let responses = Response::trace_pairs(tracer, &traced, settings)?;
    for (pair, response) in pairs.into_iter().zip(responses) {
        let level = response.level(pair.pair.listener());
        all.push(Heard {
            source: pair.source,
            listener: pair.listener,
            heard: level.is_some(),
            g_db: level.map(|level| level.g_db),
            delay_s: level.map(|level| level.delay_s),
            azimuth_deg: level.map(|level| level.azimuth.to_degrees()),
            elevation_deg: level.map(|level| level.elevation.to_degrees()),
            one_sided: level.map(|level| level.one_sided),
        });
    }
    Ok(all)
}

/// Prints one line per pair.
pub fn print(heard: &Heard) -> anyhow::Result<()> {
    let of = format!("  source {}, listener {}", heard.source, heard.listener);
    let numbers = (
        heard.g_db,
        heard.delay_s,
        heard.azimuth_deg,
        heard.elevation_deg,
        heard.one_sided,
    );
    let (Some(g_db), Some(delay_s), Some(azimuth), Some(elevation), Some(one_sided)) = numbers
    else {
        return print::line(&format!("{of}: not heard"));
    };
    let from = match one_sided < LEAST_ONE_SIDED {
        true => "mean direction undefined (from all sides)".to_owned(),
        false => format!(
            "mean direction azimuth {azimuth:+.0}°, elevation {elevation:+.0}° ({:.0} % one-sided)",
            100.0 * one_sided
        ),
    };
    print::line(&format!(
        "{of}: G {g_db:.2} dB, first after {:.3} ms, {from}",
        delay_s * 1e3
    ))
}
