//! Notes on a response: the reasons for missing or inexact figures, with remedies.
//!
//! The texts serve readers of the program and of the Python package. They name settings by words that both have.

mod flutter;
mod missing;
pub(super) mod silence;

use super::{HeardPath, Response};
use crate::bands::BAND_COUNT;
use crate::geometry::ExactScene;
use crate::scene::Pair;
use glam::Vec3;
use missing::listed;
use std::fmt;

/// One sentence about a response, from [`Response::notes`].
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Note {
    /// Whether waves were lost, or not followed to the record's end, so that figures may be wrong.
    pub is_warning: bool,
    text: String,
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl Note {
    fn new(text: impl Into<String>) -> Note {
        Note {
            is_warning: false,
            text: text.into(),
        }
    }

    fn warning(text: String) -> Note {
        Note {
            is_warning: true,
            text,
        }
    }
}

impl Response {
    /// Why figures of this response are missing or inexact, and what to do about it. `pair` is the pair whose sound was
    /// traced. Oddities of the scene itself, such as a listener inside a solid, are in
    /// [`Scene::warnings`](crate::Scene::warnings).
    ///
    /// ```
    /// use echomarch::gl::Context;
    /// use echomarch::response::{Response, ResponseSettings};
    /// use echomarch::{Scene, Tracer};
    ///
    /// let mut tracer = Tracer::new(&Context::headless(&Default::default())?)?;
    /// let scene = Scene::builtin("shoebox")?;
    /// let settings = ResponseSettings::default().with_seconds(0.1);
    /// let response = Response::trace(&mut tracer, &scene, &settings)?;
    /// let notes = response.notes(scene.only_pair()?);
    /// assert!(notes[0].to_string().starts_with("sound continues after 0.10 s in all bands"));
    /// # Ok::<(), echomarch::Error>(())
    /// ```
    pub fn notes(&self, pair: Pair) -> Vec<Note> {
        let scene = pair.scene();
        let mut notes = self.lost_waves();
        notes.extend(self.inexact_paths(pair).into_iter().map(Note::new));
        notes.extend(missing::reasons(pair, self).into_iter().map(Note::new));
        notes.extend(missing::of_accuracy(pair, self).into_iter().map(Note::new));
        notes.extend(flutter::sentences(scene, self).into_iter().map(Note::new));
        notes
    }

    fn lost_waves(&self) -> Vec<Note> {
        let counts = &self.counts;
        let mut notes = Vec::new();
        if counts.step_limit_reached > 0 {
            notes.push(Note::warning(format!(
                "waves that are dead because their march reached the step limit: {}",
                counts.step_limit_reached
            )));
        }
        if counts.cut_off > 0 {
            let stopped = format!(
                "tracing of {} waves stopped after {} iterations",
                counts.cut_off, counts.iterations
            );
            notes.push(match self.followed_s {
                Some(seconds) => Note::warning(format!(
                    "{stopped}: after {seconds:.2} s the response is too weak, and figures are computed from the part before"
                )),
                None => Note::new(format!("{stopped}: their energy is negligible")),
            });
        }
        notes
    }

    fn inexact_paths(&self, pair: Pair) -> Vec<String> {
        let mut texts = Vec::new();
        let is_silent = self.echogram.total().iter().all(|energy| *energy == 0.0);
        if self.counts.arrivals == 0 && is_silent && self.paths.is_empty() {
            texts.push(silence::reason(pair, self.seconds));
        }
        if self.left_out > 0 {
            texts.push(format!(
                "{:.1} % of the energy arrived on paths of few reflections that were not searched, because there are too many: this energy is in the late part",
                100.0 * self.left_out_share
            ));
        }
        if self.search_left_out_share > 0.0 {
            texts.push(format!(
                "{:.0} % of the directions were not searched for exact paths over planes, because too many surfaces hide each other: weak paths may be missing",
                (100.0 * self.search_left_out_share).max(1.0)
            ));
        }
        if self.direct().is_some_and(|direct| direct.path.is_focus) {
            texts.push(format!(
                "the source is so close that the size of the listener's sphere ({} m) limits the direct sound: its level is that at the sphere, not that at a point",
                pair.listener().radius
            ));
        }
        texts.extend(self.hidden_source(pair));
        let gathered = |heard: &&HeardPath| heard.path.is_focus && !heard.is_direct();
        if let Some(focused) = self.paths.iter().find(gathered) {
            texts.push(format!(
                "sound is focused (over {}): after repeated focusing, rounding determines the paths, and ± of late decays does not include that error; compare with a moved listener (docs/acoustics.md#notes)",
                focused.path.surface_labels(pair.scene()).join(", ")
            ));
        }
        let surfaces = pair.scene().surfaces.iter().enumerate();
        let concave = surfaces.filter(|(_, surface)| surface.shape.gathers_sound());
        let concave: Vec<String> = concave.map(|(index, of)| of.label(index)).collect();
        if !concave.is_empty() {
            texts.push(format!(
                "curved surfaces that may be concave can focus sound ({}): if the energy of exact paths at the listener's centre differs from the energy that reaches its sphere, ± includes the difference; for reflections beyond the order of exact paths the difference is unknown, so compare with a larger order and a smaller listener (docs/acoustics.md#notes)",
                listed(&concave)
            ));
        }
        texts
    }

    /// The note on a source that is hidden from the listener, without diffraction.
    fn hidden_source(&self, pair: Pair) -> Option<String> {
        let is_silent = self.energy() == [0.0; BAND_COUNT];
        if is_silent || self.diffraction || self.direct().is_some() {
            return None;
        }
        if silence::end_in_solid(pair).is_some() {
            return None;
        }
        // A source that radiates nothing towards the listener has no direct path either.
        let ends = [pair.source().position, pair.listener().position].map(Vec3::as_dvec3);
        let exact = ExactScene::new(pair).ok()?;
        (!exact.is_in_sight(ends[0], ends[1])).then(|| {
            "the source is hidden from the listener: sound that bends around obstacles is missing, and C50, C80, D50, Ts, EDT and G may be wrong by more than ±; diffraction adds it, if there is a way around (docs/acoustics.md#notes)".to_owned()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Scene;
    use crate::gl::{Context, ContextOptions};
    use crate::response::ResponseSettings;
    use crate::scene::shape::{Cuboid, Room};
    use crate::scene::{Directivity, Listener, Source, Surface};
    use crate::tracer::{Settings, Tracer};

    /// Protects readers of the notes: only lost waves that change figures are a warning, and no text names an option of
    /// the program.
    #[test]
    fn lost_waves_are_warnings_and_texts_name_no_options() {
        let context = Context::headless(&ContextOptions::default()).expect("OpenGL");
        let mut tracer = Tracer::new(&context).expect("a tracer");
        let scene = Scene::builtin("shoebox").expect("a built-in scene");
        let pair = scene.only_pair().expect("one pair");
        let settings = ResponseSettings::default().with_seconds(0.1);
        let settings = settings.with_trace(Settings::default().with_waves(256));
        let mut response = Response::trace(&mut tracer, pair, &settings).expect("a response");
        let is_warning = |response: &Response| response.notes(pair).iter().any(|n| n.is_warning);
        assert!(!is_warning(&response));
        response.counts.cut_off = 3;
        assert!(!is_warning(&response));
        response.followed_s = Some(0.05);
        assert!(is_warning(&response));
        response.left_out = 1;
        response.search_left_out_share = 0.1;
        response.paths[0].path.is_focus = true;
        response.paths[1].path.is_focus = true;
        let notes = response.notes(pair);
        assert!(notes.len() >= 6, "{notes:?}");
        let names = |note: &Note| note.to_string().contains("sound is focused (over room/");
        assert!(notes.iter().any(names), "{notes:?}");
        for note in notes {
            let text = note.to_string();
            assert!(!text.is_empty() && !text.contains("--"), "{text}");
        }
    }

    /// Protects early figures of a hidden source: a note names diffraction where it is off, and only there, also with a
    /// clock too coarse for the time of diffraction.
    #[test]
    fn a_hidden_source_is_told_without_diffraction() {
        let context = Context::headless(&ContextOptions::default()).expect("OpenGL");
        let mut tracer = Tracer::new(&context).expect("a tracer");
        let mut told = |listener: Vec3, diffraction: bool| {
            let room = Surface::new(Room {
                size: Vec3::new(8.0, 3.0, 5.0),
            });
            let screen = Surface::new(Cuboid {
                size: Vec3::new(0.1, 3.0, 2.0),
            });
            let surfaces = vec![room, screen];
            let ends = (Source::at(-2.0 * Vec3::X), Listener::at(listener, 0.3));
            let scene = Scene::new("screen", surfaces, ends.0, ends.1);
            let settings = ResponseSettings::default().with_seconds(0.1);
            let settings = settings.with_trace(Settings::default().with_waves(256));
            let settings = settings.with_diffraction(diffraction);
            let mut response = Response::trace(&mut tracer, &scene, &settings).expect("a response");
            response.diffraction_milliseconds = 0.0;
            let notes = response.notes(scene.only_pair().expect("one pair"));
            let is_hidden = |note: &Note| note.to_string().contains("; diffraction adds it");
            notes.iter().any(is_hidden)
        };
        assert!(told(2.0 * Vec3::X, false));
        assert!(!told(2.0 * Vec3::X, true));
        assert!(!told(2.0 * Vec3::Z - 2.0 * Vec3::X, false));
    }

    /// Protects sources that radiate nothing towards a listener in plain sight: there is nothing to bend.
    #[test]
    fn a_source_that_faces_away_is_not_hidden() {
        let context = Context::headless(&ContextOptions::default()).expect("OpenGL");
        let mut tracer = Tracer::new(&context).expect("a tracer");
        let room = Surface::new(Room {
            size: Vec3::new(8.0, 3.0, 5.0),
        });
        // A source looks along −z.
        let source = Source::at(Vec3::ZERO).with_directivity(Directivity::CARDIOID);
        let listener = Listener::at(2.0 * Vec3::Z, 0.3);
        let scene = Scene::new("room", vec![room], source, listener);
        let settings = ResponseSettings::default().with_seconds(0.1);
        let settings = settings.with_trace(Settings::default().with_waves(256));
        let response = Response::trace(&mut tracer, &scene, &settings).expect("a response");
        assert_eq!(response.direct(), None);
        let notes = response.notes(scene.only_pair().expect("one pair"));
        let is_hidden = |note: &Note| note.to_string().contains("diffraction adds it");
        assert!(!notes.iter().any(is_hidden), "{notes:?}");
    }
}
