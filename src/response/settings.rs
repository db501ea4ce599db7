//! Settings of responses.

use super::late::Onset;
use crate::error::Error;
use crate::response::{Accuracy, Echogram, ImpulseSettings, ResponseError};
use crate::scene::{Scene, Surface};
use crate::serialised::finite;
use crate::tracer::{Profile, Settings, TraceError};
use serde::{Deserialize, Serialize};

/// Settings of a [`Response`](super::Response).
///
/// Each field is serialised by its name. A missing field has its default. Unknown fields and numbers out of range are
/// refused.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(try_from = "SettingsFile")]
#[non_exhaustive]
pub struct ResponseSettings {
    /// Waves, start directions, seed and algorithm. The number of iterations follows from the length, so any number
    /// other than the default is rejected.
    pub trace: Settings,
    /// Length of the record. If `None`, the waves are followed until the energy of every band has fallen by 60 dB, as
    /// estimated by a few waves.
    #[serde(serialize_with = "finite")]
    pub seconds: Option<f64>,
    /// Maximum length of the record if `seconds` is `None`, in seconds: 10 by default, because sound is audible for
    /// longer in only a few halls. A record never ends before the direct sound arrives.
    pub longest_s: f64,
    /// Number of waves whose late arrivals are counted; all waves if `None`, or if larger than the number of waves.
    /// Exact paths are searched for with all waves.
    pub late_waves: Option<u32>,
    /// Maximum number of reflections of an exact path, 0 to [`ResponseSettings::MAX_ORDER`]. `None` stands for 8 if all
    /// surfaces are flat, otherwise 3. If walls absorb half of the sound, a decay of 35 dB consists of some dozen
    /// echoes of up to six reflections, and few waves find each echo. In an empty room all paths of up to eight
    /// reflections are found. At curved surfaces the search starts from up to 512 waves of each sequence of surfaces.
    pub order: Option<u32>,
    /// Length of a time bin of the echogram in seconds. The default is 1 ms, which is less than the time that sound
    /// needs to cross a listener of common size.
    pub bin_s: f64,
    /// Number of batches for estimating errors: 16 by default.
    pub batches: usize,
    /// Whether the direct sound, and reflections at plane faces, bend around obstacles: false by default, because late
    /// arrivals do not bend. The profile `thesis` has no diffraction.
    pub diffraction: bool,
    /// Whether sound passes through solids whose materials transmit sound, in a straight line to the listener and in
    /// the late part: true by default. The profile `thesis` has no transmission.
    pub transmission: bool,
    /// The least level of a source at its listener in decibels, relative to the level that its direct sound would have
    /// in the open at the same distance: −100 to 0, or `None` (the default). If everything heard from the source is
    /// quieter in a band, a path of the kind [`PathKind::Added`](super::PathKind::Added) adds the missing energy. This
    /// is a floor for games, so that a hidden source does not vanish. It is not a model of sound. The figures do not
    /// contain the added energy.
    #[serde(serialize_with = "finite")]
    pub least_level_db: Option<f64>,
    /// The accuracy of the figures. If present, it determines the number of late waves, and `late_waves` is ignored.
    /// `None` (the default) traces the given number of waves.
    pub accuracy: Option<Accuracy>,
    /// Whether the figures and their errors are left out, which takes most of the time of a trace with few waves.
    #[serde(skip)]
    pub(crate) omits_figures: bool,
    /// More waves for the onset of the late arrivals.
    #[serde(skip)]
    pub(super) onset: Option<Onset>,
}

/// The fields of [`ResponseSettings`], all of them optional.
#[derive(Deserialize)]
#[serde(default, deny_unknown_fields)]
struct SettingsFile {
    trace: Settings,
    seconds: Option<f64>,
    longest_s: f64,
    late_waves: Option<u32>,
    order: Option<u32>,
    bin_s: f64,
    batches: usize,
    diffraction: bool,
    transmission: bool,
    least_level_db: Option<f64>,
    accuracy: Option<Accuracy>,
}

impl Default for SettingsFile {
    fn default() -> SettingsFile {
        let ResponseSettings {
            trace,
            seconds,
            longest_s,
            late_waves,
            order,
            bin_s,
            batches,
            diffraction,
            transmission,
            least_level_db,
            accuracy,
            omits_figures: _,
            onset: _,
        } = ResponseSettings::default();
        SettingsFile {
            trace,
            seconds,
            longest_s,
            late_waves,
            order,
            bin_s,
            batches,
            diffraction,
            transmission,
            least_level_db,
            accuracy,
        }
    }
}

impl TryFrom<SettingsFile> for ResponseSettings {
    type Error = Error;

    fn try_from(file: SettingsFile) -> Result<ResponseSettings, Error> {
        let settings = ResponseSettings {
            trace: file.trace,
            seconds: file.seconds,
            longest_s: file.longest_s,
            late_waves: file.late_waves,
            order: file.order,
            bin_s: file.bin_s,
            batches: file.batches,
            diffraction: file.diffraction,
            transmission: file.transmission,
            least_level_db: file.least_level_db,
            accuracy: file.accuracy,
            omits_figures: false,
            onset: None,
        };
        settings.validate()?;
        Ok(settings)
    }
}

/// The default orders: see [`ResponseSettings::order`].
const ORDER_AT_PLANES: u32 = 8;
const ORDER_AT_CURVES: u32 = 3;

/// The default longest record, in seconds.
const USUAL_LONGEST_S: f64 = 10.0;

impl Default for ResponseSettings {
    /// Returns 65,536 waves of the profile `hybrid`, and exact paths of the default order.
    fn default() -> ResponseSettings {
        ResponseSettings {
            trace: Settings::default(),
            seconds: None,
            longest_s: USUAL_LONGEST_S,
            late_waves: None,
            order: None,
            bin_s: 1e-3,
            batches: 16,
            diffraction: false,
            transmission: true,
            least_level_db: None,
            accuracy: None,
            omits_figures: false,
            onset: None,
        }
    }
}

impl ResponseSettings {
    /// Lower limit of [`ResponseSettings::least_level_db`], in decibels. A level this far below the direct sound is
    /// inaudible.
    pub const LOWEST_LEAST_LEVEL_DB: f64 = -100.0;

    /// Upper limit of the order of exact paths: the number of paths grows with the cube of the order, and waves find a
    /// decreasing share of them.
    pub const MAX_ORDER: u32 = 16;

    /// Leaves out the figures, which take most of the time of a trace with few waves.
    #[doc(hidden)]
    #[must_use]
    pub fn without_figures(mut self) -> ResponseSettings {
        self.omits_figures = true;
        self
    }

    /// Sets the waves, directions and algorithm. [`Response::trace`](super::Response::trace) rejects settings with a
    /// number of iterations other than the default.
    #[must_use]
    pub fn with_trace(mut self, trace: Settings) -> ResponseSettings {
        self.trace = trace;
        self
    }

    /// Sets the waves, directions and algorithm from the settings of frames, and ignores their number of iterations.
    #[doc(hidden)]
    #[must_use]
    pub fn with_trace_of_frames(self, frames: &Settings) -> ResponseSettings {
        let usual = Settings::new(frames.profile()).iterations;
        self.with_trace(frames.clone().with_iterations(usual))
    }

    /// Sets the length of the record in seconds.
    #[must_use]
    pub fn with_seconds(mut self, seconds: f64) -> ResponseSettings {
        self.seconds = Some(seconds);
        self
    }

    /// Sets the maximum length of the record in seconds, used if no length is set.
    #[must_use]
    pub fn with_longest(mut self, seconds: f64) -> ResponseSettings {
        self.longest_s = seconds;
        self
    }

    /// Sets the number of waves for late arrivals.
    #[must_use]
    pub fn with_late_waves(mut self, waves: u32) -> ResponseSettings {
        self.late_waves = Some(waves);
        self
    }

    /// Sets the accuracy of the figures.
    #[must_use]
    pub fn with_accuracy(mut self, accuracy: Accuracy) -> ResponseSettings {
        self.accuracy = Some(accuracy);
        self
    }

    /// Sets whether sound bends around the edges of obstacles that hide the source from the listener.
    #[must_use]
    pub fn with_diffraction(mut self, diffraction: bool) -> ResponseSettings {
        self.diffraction = diffraction;
        self
    }

    /// Whether responses have diffracted paths.
    pub(super) fn diffracts(&self) -> bool {
        self.diffraction && self.trace.profile() != Profile::Thesis
    }

    /// Sets whether sound passes through solids whose materials transmit sound.
    #[must_use]
    pub fn with_transmission(mut self, transmission: bool) -> ResponseSettings {
        self.transmission = transmission;
        self
    }

    /// Sets the least level of a source at its listener in decibels, relative to its direct sound in the open at the
    /// same distance.
    #[must_use]
    pub fn with_least_level(mut self, decibels: f64) -> ResponseSettings {
        self.least_level_db = Some(decibels);
        self
    }

    /// Whether sound passes solids.
    pub(super) fn transmits(&self) -> bool {
        self.transmission && self.trace.profile() != Profile::Thesis
    }

    /// Sets the maximum number of reflections of exact paths.
    #[must_use]
    pub fn with_order(mut self, order: u32) -> ResponseSettings {
        self.order = Some(order);
        self
    }

    /// The trace settings of the waves whose late arrivals are counted.
    pub(super) fn late_trace(&self) -> Settings {
        let waves = self.trace.waves;
        let most = self.onset.map_or(waves, |_| Settings::MAX_WAVES);
        let late = self.late_waves.map_or(waves, |late| late.min(most));
        self.trace.clone().with_waves(late)
    }

    /// Number of waves of the onset.
    pub(super) fn onset_waves(&self) -> u32 {
        let of_onset = self.onset.map(|onset| onset.waves);
        of_onset.unwrap_or_else(|| self.late_trace().waves)
    }

    /// The maximum order of exact paths in this scene.
    pub(crate) fn order_in(&self, scene: &Scene) -> u32 {
        let is_flat = |surface: &Surface| surface.shape.is_flat();
        self.order
            .unwrap_or(match scene.surfaces.iter().all(is_flat) {
                true => ORDER_AT_PLANES,
                false => ORDER_AT_CURVES,
            })
    }

    /// Checks every number against its range, before anything is traced.
    ///
    /// # Errors
    /// [`Error::Trace`] with the name, the range and the value, also for a number of iterations other than the default;
    /// [`TraceError::NoArrivals`] for the profile `thesis`; [`Error::Acoustics`] for a length
    /// that is not above 0 s and at most [`ImpulseSettings::MAX_SECONDS`], and for bins and batches out of range.
    pub fn validate(&self) -> Result<(), Error> {
        self.trace.validate()?;
        let profile = self.trace.profile();
        if profile == Profile::Thesis {
            let profile = profile.to_string();
            return Err(TraceError::NoArrivals { profile }.into());
        }
        let (usual, iterations) = (Settings::new(profile).iterations, self.trace.iterations);
        if iterations != usual {
            let must = format!("{usual}, as usual: its seconds decide how long waves are followed");
            return Err(bad("number of iterations of a response", must, iterations));
        }
        Echogram::new(self.bin_s, self.batches)?;
        if let Some(seconds) = self.seconds
            && !(seconds > 0.0 && seconds <= ImpulseSettings::MAX_SECONDS)
        {
            return Err(ResponseError::BadLength { seconds }.into());
        }
        let longest_s = self.longest_s;
        if !(longest_s > 0.0 && longest_s <= ImpulseSettings::MAX_SECONDS) {
            let must = format!("above 0, at most {} seconds", ImpulseSettings::MAX_SECONDS);
            return Err(bad("longest record", must, longest_s));
        }
        if let Some(least_db) = self.least_level_db {
            let lowest_db = ResponseSettings::LOWEST_LEAST_LEVEL_DB;
            if !(lowest_db..=0.0).contains(&least_db) {
                let must = format!("{lowest_db} to 0 decibels");
                return Err(bad("least level", must, least_db));
            }
        }
        if let Some(accuracy) = &self.accuracy {
            accuracy.validate()?;
        }
        if self.late_waves == Some(0) {
            return Err(bad("number of late waves", "1 or more".to_owned(), 0));
        }
        if let Some(order) = self
            .order
            .filter(|order| *order > ResponseSettings::MAX_ORDER)
        {
            return Err(bad(
                "order of exact paths",
                format!("0 to {}", ResponseSettings::MAX_ORDER),
                order,
            ));
        }
        Ok(())
    }
}

fn bad(what: &'static str, must: String, value: impl ToString) -> Error {
    let value = value.to_string();
    TraceError::BadSetting { what, must, value }.into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::shape::{Cuboid, HalfSpace, Plane, Prism, Room, Sphere};
    use crate::{Listener, Source};
    use glam::{Vec2, Vec3};

    /// Protects tracing: lengths and numbers of waves out of range are rejected.
    #[test]
    fn bad_numbers_are_refused() {
        let settings = ResponseSettings::default();
        assert!(settings.validate().is_ok());
        let with_bins = |bin_s, batches| ResponseSettings {
            bin_s,
            batches,
            ..ResponseSettings::default()
        };
        for bad in [
            settings.clone().with_late_waves(0),
            settings.clone().with_longest(0.0),
            settings.clone().with_longest(f64::NAN),
            settings
                .clone()
                .with_longest(2.0 * ImpulseSettings::MAX_SECONDS),
            settings
                .clone()
                .with_seconds(2.0 * ImpulseSettings::MAX_SECONDS),
            settings.clone().with_order(ResponseSettings::MAX_ORDER + 1),
            settings
                .clone()
                .with_trace(Settings::default().with_iterations(9)),
            settings.clone().with_least_level(0.1),
            settings.clone().with_least_level(-100.1),
            settings.clone().with_least_level(f64::NAN),
            with_bins(0.0, 16),
            with_bins(f64::NAN, 16),
            with_bins(1e-3, 0),
            with_bins(1e-3, usize::MAX),
        ] {
            assert!(bad.validate().is_err(), "{bad:?}");
        }
        // Lengths out of range have one sentence.
        for seconds in [0.0, -1.0, f64::NAN, f64::INFINITY, 61.0] {
            let refused = settings.clone().with_seconds(seconds).validate();
            let refused = refused.expect_err("a length out of range").to_string();
            let sentence = "it must be longer than 0 s and no longer than 60 s";
            assert!(refused.ends_with(sentence), "{refused}");
        }
        // A number larger than the number of waves means all waves.
        assert_eq!(
            settings.clone().with_late_waves(1 << 30).late_trace(),
            settings.trace
        );
    }

    /// Protects the default order of exact paths: eight reflections if all surfaces are flat, for any combination of
    /// flat shapes, and three if a surface is curved.
    #[test]
    fn paths_among_planes_have_more_reflections() {
        let size = Vec3::splat(4.0);
        let flat = [
            Surface::new(Plane),
            Surface::new(HalfSpace {
                normal: Vec3::Y,
                offset: -2.0,
            }),
            Surface::new(Cuboid { size }),
            Surface::new(Room { size }),
            Surface::new(Prism {
                corners: [Vec2::ZERO, Vec2::X, Vec2::Y],
                depth: 1.0,
            }),
        ];
        let ball = Surface::new(Sphere { radius: 1.0 });
        let order = |surfaces: &[Surface], settings: ResponseSettings| {
            let (source, listener) = (Source::at(Vec3::X), Listener::at(Vec3::Z, 0.3));
            settings.order_in(&Scene::new("order", surfaces.to_vec(), source, listener))
        };
        assert_eq!(order(&flat, ResponseSettings::default()), ORDER_AT_PLANES);
        let curved = [&flat[..], &[ball]].concat();
        assert_eq!(order(&curved, ResponseSettings::default()), ORDER_AT_CURVES);
        assert_eq!(order(&curved, ResponseSettings::default().with_order(9)), 9);
    }
}
