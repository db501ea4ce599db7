//! The results of a source: the direct way, echoes, reverberation.

use super::SourceId;
use super::hall::Hall;
use super::reverb::{DecayRecord, Reverb};
use crate::bands::{self, Bands};
use crate::response::{self, HeardPath, PathKind, Response, Tap, amplitude};
use glam::{DVec3, Vec3};
use std::collections::HashMap;
use std::sync::Arc;

/// The direct way of a source: straight, or around and through what is in between.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct DirectWay {
    /// Amplitude by band, relative to the direct sound of the source at 1 m, with distance, directivity, level, air,
    /// diffraction and transmission.
    pub gain: Bands,
    /// The share of the energy that arrives, of that in the open: 1 in sight, 0 if nothing bends or passes. The mean of
    /// the bands.
    pub visibility: f64,
    /// Whether the line from source to listener is free.
    pub is_in_sight: bool,
    /// Seconds from the source to the listener.
    pub delay_s: f64,
    /// Unit vector of the world towards the origin of the sound. If the source is hidden, the mean of all paths by energy:
    /// those around the obstacle and that through it.
    pub from: Vec3,
}

/// An echo, over a few reflections.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct EarlyEcho {
    /// Stays the same while the echo comes over the same surfaces and walls.
    pub key: u64,
    /// Amplitude by band, relative to the direct sound of the source at 1 m.
    pub gain: Bands,
    /// Seconds from the source to the listener.
    pub delay_s: f64,
    /// Unit vector of the world towards the origin of the sound.
    pub from: Vec3,
}

/// The last results of a source.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Update {
    /// The direct way.
    pub direct: DirectWay,
    /// Unit vector of the world towards the sound: that of the direct way, of the mean of its paths if it is hidden, of
    /// the first echo if no direct sound arrives, or else of the mean of all sound. Towards the source if
    /// nothing arrives.
    pub from: Vec3,
    /// Seconds from the source to the first sound.
    pub delay_s: f64,
    /// The strongest echoes, by delay.
    pub echoes: Vec<EarlyEcho>,
    /// Everything but the direct way, by level and decay.
    pub reverb: Reverb,
    /// The commit of the world that the direct way belongs to: see [`Simulator::commit`](super::Simulator::commit).
    pub commit: u64,
    /// Number of waves of the last trace; 0 before the first.
    pub waves: u32,
    /// Number of traces of this source.
    pub traces: u64,
}

impl Update {
    /// The energy of all sound, relative to the direct sound of the source at 1 m: the mean of the bands.
    pub(super) fn energy(&self) -> f64 {
        let (direct, reverb) = (&self.direct.gain, &self.reverb.gain);
        let all: Bands = std::array::from_fn(|band| direct[band].powi(2) + reverb[band].powi(2));
        bands::mean(&all)
    }
}

impl DirectWay {
    /// The direct way of paths that replace the straight one; `open` is the straight path without obstacles.
    pub(super) fn new(open: &HeardPath, paths: &[HeardPath]) -> DirectWay {
        let energy = bands::sum(paths.iter().map(|path| &path.energy));
        let [all, in_the_open] = [&energy, &open.energy].map(bands::mean);
        let strongest = |path: &&HeardPath| bands::mean(&path.energy);
        let first = paths
            .iter()
            .max_by(|a, b| strongest(a).total_cmp(&strongest(b)))
            .unwrap_or(open);
        DirectWay {
            gain: energy.map(amplitude),
            visibility: match in_the_open > 0.0 {
                true => (all / in_the_open).min(1.0),
                false => 0.0,
            },
            is_in_sight: paths.iter().any(HeardPath::is_direct),
            delay_s: first.delay_s,
            from: mean_origin(paths).unwrap_or_else(|| from(first)),
        }
    }

    /// Whether any sound arrives.
    fn is_heard(&self) -> bool {
        self.gain.iter().any(|gain| *gain > 0.0)
    }

    fn energy(&self) -> Bands {
        self.gain.map(energy_of_amplitude)
    }
}

/// Energy in 1/m² of an amplitude relative to 1 m.
fn energy_of_amplitude(amplitude: f64) -> f64 {
    amplitude * amplitude / (4.0 * std::f64::consts::PI)
}

/// Unit vector towards the mean origin of the sound of paths, by energy; `None` if no direction prevails.
fn mean_origin(paths: &[HeardPath]) -> Option<Vec3> {
    let flow = |path: &HeardPath| path.path.arrival_direction * bands::mean(&path.energy);
    let flow: DVec3 = paths.iter().map(flow).sum();
    flow.try_normalize().map(|flow| (-flow).as_vec3())
}

fn from(path: &HeardPath) -> Vec3 {
    (-path.path.arrival_direction).as_vec3()
}

/// The results of all sources.
pub(super) type Published = HashMap<SourceId, Arc<Update>>;

/// The echoes and the reverberation of a trace.
#[derive(Clone, Debug, Default)]
pub(super) struct Surroundings {
    pub echoes: Vec<EarlyEcho>,
    /// All exact reflections.
    taps: Vec<Tap>,
    /// The energy of those that are not among the echoes.
    rest: Bands,
    /// Unit vector towards the mean of all sound.
    mean: Option<Vec3>,
}

impl Surroundings {
    /// Keeps the strongest echoes of a response.
    pub fn new(response: &Response, hall: &Hall, most: usize) -> Surroundings {
        let is_echo =
            |path: &&HeardPath| !matches!(path.kind, PathKind::Direct | PathKind::Transmitted);
        let mut paths: Vec<&HeardPath> = response.paths.iter().filter(is_echo).collect();
        let taps: Vec<Tap> = paths.iter().map(|path| path.tap_of_energy()).collect();
        let level = |path: &HeardPath| bands::mean(&path.energy);
        paths.sort_by(|a, b| level(b).total_cmp(&level(a)));
        // Computed for all paths, so that the keys do not depend on the number of echoes that are kept.
        let keys = response::keys(&paths, |surface| hall.surface_bits(surface));
        let (kept, rest) = paths.split_at(most.min(paths.len()));
        let echo = |(path, key): (&&HeardPath, u64)| EarlyEcho {
            key,
            gain: path.tap().energy.map(amplitude),
            delay_s: path.delay_s,
            from: from(path),
        };
        let mut echoes: Vec<EarlyEcho> = kept.iter().zip(keys).map(echo).collect();
        echoes.sort_by(|a, b| a.delay_s.total_cmp(&b.delay_s));
        let bins = 0..response.echogram.bins();
        let late: DVec3 = bins.flat_map(|bin| response.echogram.flow(bin)).sum();
        let early: DVec3 = taps
            .iter()
            .map(|tap| tap.direction * tap.energy.iter().sum::<f64>())
            .sum();
        Surroundings {
            echoes,
            rest: bands::sum(rest.iter().map(|path| &path.energy)),
            taps,
            mean: (-(late + early)).try_normalize().map(|mean| mean.as_vec3()),
        }
    }

    /// What is heard of a source with this direct way and this record of late energy. `open_s` is the delay of the
    /// direct sound in the open.
    pub fn update(&self, direct: DirectWay, reverb: Reverb) -> Update {
        let first = self.echoes.first();
        let (from, delay_s) = match (direct.is_heard(), first) {
            (true, _) => (direct.from, direct.delay_s),
            (false, Some(echo)) => (echo.from, echo.delay_s),
            (false, None) => (self.mean.unwrap_or(direct.from), direct.delay_s),
        };
        Update {
            direct,
            from,
            delay_s,
            echoes: self.echoes.clone(),
            reverb,
            commit: 0,
            waves: 0,
            traces: 0,
        }
    }

    /// The reverberation from the late energy of several traces.
    pub fn reverb(&self, record: &DecayRecord, direct: &DirectWay, open_s: f64) -> Reverb {
        let energy = direct.energy();
        let mut taps = self.taps.clone();
        taps.push(Tap {
            seconds: open_s,
            energy,
            direction: DVec3::X,
        });
        record.reverb(&taps, &energy, &self.rest, open_s)
    }
}
