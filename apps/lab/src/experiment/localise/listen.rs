//! Rotates the listener of a scene and computes the sound at the listener. One frame is traced, and the sound is mixed
//! by the same mixer as in playback.

use super::observer::{Levels, Observer, azimuth_deg};
use echomarch::Error;
use echomarch::audio::{Mixer, PanningLaw, Sound, SoundSpec};
use echomarch::scene::Scene;
use echomarch::tracer::{Settings, TraceError, Tracer};
use glam::DVec3;

/// Angle between the side facings and the middle in degrees, for scenes whose own source is close to the middle.
const BESIDE_DEG: f64 = 45.0;

/// Maximum length of a trial's sound, in seconds.
const MOST_SECONDS: f64 = 600.0;

/// Length of the fades that avoid clicks at the ends of a sound, in seconds.
const FADE_S: f64 = 0.01;

/// Returns the scene three times, with its source to the left, ahead and to the right. Only the listener is rotated.
///
/// The side angle is that of the scene's own source, so that one of the three scenes is the unchanged scene. If the
/// source is near the middle, ahead or behind, the side angle is 45°. Motion is removed, so that all positions are
/// fixed.
pub fn facings(scene: &Scene) -> Vec<Scene> {
    let own = azimuth_deg(scene);
    let beside = match own.abs() {
        angle if (BESIDE_DEG / 2.0..=180.0 - BESIDE_DEG / 2.0).contains(&angle) => angle,
        _ => BESIDE_DEG,
    };
    let still = standing(scene);
    let own_yaw = scene.listeners[0].yaw;
    let turned = |wanted: f64| {
        let mut turned = still.clone();
        if (wanted - own).abs() > 1e-9 {
            turned.listeners[0].yaw = own_yaw + (own - wanted).to_radians() as f32;
        }
        turned
    };
    [-beside, 0.0, beside].map(turned).into()
}

/// Returns the scene without its motion.
pub fn standing(scene: &Scene) -> Scene {
    let mut still = scene.clone();
    for source in &mut still.sources {
        source.path = Default::default();
    }
    for listener in &mut still.listeners {
        listener.path = Default::default();
    }
    for surface in &mut still.surfaces {
        surface.drivers.clear();
    }
    still
}

/// Returns the scene with its source at an azimuth (degrees, positive to the right of the gaze), at a distance of
/// `metres` from the listener, and at the height of the ears.
pub fn source_at(scene: &Scene, azimuth_deg: f64, metres: f64) -> Scene {
    source_towards(scene, (azimuth_deg, 0.0), metres)
}

/// Like [`source_at`], with an elevation above the ears in degrees after the azimuth.
pub fn source_towards(
    scene: &Scene,
    (azimuth_deg, elevation_deg): (f64, f64),
    metres: f64,
) -> Scene {
    let mut placed = standing(scene);
    let angle = f64::from(scene.listeners[0].yaw) + azimuth_deg.to_radians();
    let (sin, cos) = angle.sin_cos();
    let (up, level) = elevation_deg.to_radians().sin_cos();
    let unit = DVec3::new(sin * level, up, -cos * level);
    placed.sources[0].position = scene.listeners[0].position + (metres * unit).as_vec3();
    placed
}

/// Returns the scene with every surface lowered until it reflects no sound to the listener. The surfaces are not
/// removed, because a scene needs at least one.
pub fn without_ground(scene: &Scene) -> Scene {
    const METRES: f32 = 1000.0;
    let mut bare = scene.clone();
    for surface in &mut bare.surfaces {
        surface.position.y -= METRES;
    }
    bare
}

/// A sound of the experiment, loaded once for all trials.
#[derive(Clone, Debug)]
pub struct LoadedSound {
    /// The sound's name as given.
    pub name: String,
    /// Samples at [`Sound::SAMPLE_RATE`], faded in and out.
    pub mono: Vec<f32>,
}

impl LoadedSound {
    /// Loads the first `seconds` of a sound, with fades at both ends.
    ///
    /// # Errors
    /// [`Error::Audio`] if the sound cannot be loaded; [`Error::Trace`] if the length is not positive or exceeds ten
    /// minutes.
    pub fn new(spec: &SoundSpec, seconds: f64) -> Result<LoadedSound, Error> {
        if !(seconds > 0.0 && seconds <= MOST_SECONDS) {
            return Err(Error::from(TraceError::BadSetting {
                what: "length of a trial's sound in seconds",
                must: format!("above 0, at most {MOST_SECONDS}"),
                value: seconds.to_string(),
            }));
        }
        let mut sound = Sound::load(spec, Sound::SAMPLE_RATE)?;
        let rate = f64::from(Sound::SAMPLE_RATE);
        let mut mono = vec![0.0; (seconds * rate).round().max(1.0) as usize];
        sound.fill(&mut mono);
        let fade = ((FADE_S * rate) as usize).min(mono.len() / 2);
        let last = mono.len() - 1;
        for index in 0..fade {
            let along = (index as f32 + 0.5) / fade as f32;
            let gain = 0.5 - 0.5 * (std::f32::consts::PI * along).cos();
            mono[index] *= gain;
            mono[last - index] *= gain;
        }
        let name = spec.to_string();
        Ok(LoadedSound { name, mono })
    }

    /// Both channels, interleaved, for one panning value.
    pub fn mixed(&self, pan: f64, law: PanningLaw) -> Vec<f32> {
        let mut stereo = vec![0.0; 2 * self.mono.len()];
        let mixed = Mixer::new(law).mix(&self.mono, pan as f32, &mut stereo);
        debug_assert!(mixed.is_ok(), "there are two samples for each one");
        stereo
    }
}

/// The result of one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Heard {
    /// The frame's panning value.
    pub pan: f64,
    /// Number of waves that arrived.
    pub hits: u64,
}

/// Traces one frame.
///
/// # Errors
/// Errors of [`Tracer::frame`].
pub fn listen(tracer: &mut Tracer, scene: &Scene, settings: &Settings) -> Result<Heard, Error> {
    let frame = tracer.frame(scene, settings)?;
    Ok(Heard {
        pan: frame.panning.pan(),
        hits: frame.counts.listener_hits,
    })
}

/// Traces one frame, renders the sound, and returns the answer of the observer model to the samples, in degrees.
///
/// # Errors
/// Errors of [`Tracer::frame`].
pub fn observe(
    tracer: &mut Tracer,
    scene: &Scene,
    settings: &Settings,
    sound: &LoadedSound,
    law: PanningLaw,
) -> Result<f64, Error> {
    let heard = listen(tracer, scene, settings)?;
    let levels = Levels::of(&sound.mixed(heard.pan, law));
    Ok(Observer::new(scene, law).answer_deg(levels))
}

/// The converged panning of `hybrid`: the mean over `frames` frames of `waves` waves each, with rotated lattices of
/// directions.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Converged {
    /// The panning value.
    pub pan: f64,
    /// The standard error of the panning value, from the scatter of the frames; 0 for one frame.
    pub uncertainty: f64,
    /// Share of waves that are heard.
    pub heard: f64,
}

/// Computes the converged panning.
///
/// # Errors
/// Errors of [`Tracer::frame`].
pub fn converge(
    tracer: &mut Tracer,
    scene: &Scene,
    iterations: u32,
    (waves, frames): (u32, u32),
) -> Result<Converged, Error> {
    // This seed is far from the seeds of the trials, so that no directions are used twice.
    const FIRST_SEED: u32 = 1_000_001;
    let mut settings = Settings::hybrid()
        .with_waves(waves)
        .with_iterations(iterations);
    settings.directions = echomarch::tracer::Directions::Fibonacci;
    let mut found = Vec::new();
    for index in 0..frames {
        let seed = FIRST_SEED + index;
        found.push(listen(tracer, scene, &settings.clone().with_seed(seed))?);
    }
    let hits: u64 = found.iter().map(|frame| frame.hits).sum();
    let weight = |frame: &Heard| frame.hits as f64 / hits.max(1) as f64;
    let pan: f64 = found.iter().map(|frame| weight(frame) * frame.pan).sum();
    let squares: f64 = found
        .iter()
        .map(|frame| (weight(frame) * (frame.pan - pan)).powi(2))
        .sum();
    let count = f64::from(frames);
    Ok(Converged {
        pan,
        uncertainty: (squares * count / (count - 1.0).max(1.0)).sqrt(),
        heard: hits as f64 / (count * f64::from(waves)).max(1.0),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::localise::observer::lateral_deg;

    /// Protects the true directions: one facing is the scene itself, and the two side facings are mirror images.
    #[test]
    fn a_scene_is_faced_in_three_ways() {
        for name in ["corner", "obstacles"] {
            let scene = Scene::builtin(name).unwrap();
            let facings = facings(&scene);
            assert_eq!(facings[0], scene);
            let angles: Vec<f64> = facings.iter().map(lateral_deg).collect();
            assert!((angles[0] + 48.37).abs() < 0.01, "{angles:?}");
            assert!(angles[1].abs() < 1e-3 && (angles[0] + angles[2]).abs() < 1e-3);
        }
        let ahead = facings(&Scene::builtin("open-field").unwrap());
        assert!((lateral_deg(&ahead[2]) - 45.0).abs() < 1e-3);
        assert_eq!(ahead[1].duration(), 0.0);
    }

    /// Protects the positions of sources in the open field.
    #[test]
    fn a_source_is_put_where_it_is_wanted() {
        let scene = Scene::builtin("open-field").unwrap();
        for wanted in [-80.0, 0.0, 30.0] {
            let placed = source_at(&scene, wanted, 5.0);
            assert!((azimuth_deg(&placed) - wanted).abs() < 1e-3);
            let away = (placed.sources[0].position - scene.listeners[0].position).length();
            assert!((away - 5.0).abs() < 1e-5, "{away}");
        }
        // A source above ear height, with the same lateral angle as a source at ear height and 30 degrees to the side.
        let raised = source_towards(&scene, (45.0, 45.0), 5.0);
        assert!((azimuth_deg(&raised) - 45.0).abs() < 1e-3);
        assert!((lateral_deg(&raised) - 30.0).abs() < 1e-3);
    }

    /// Protects against clicks: a sound begins and ends with silence.
    #[test]
    fn sounds_fade_at_both_ends() {
        let spec = "noise".parse().unwrap();
        let sound = LoadedSound::new(&spec, 0.5).unwrap();
        assert_eq!(sound.mono.len(), 24_000);
        assert!(sound.mono[0].abs() < 1e-3 && sound.mono[23_999].abs() < 1e-3);
        assert!(sound.mono.iter().any(|sample| sample.abs() > 0.4));
    }
}
