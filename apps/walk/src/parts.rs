//! The parts of the sound in full listening that the user can switch.

use echomarch::response::{Echogram, PathKind, Response, ResponseError, ResponseSettings};

/// A part of the sound in full listening.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Paths around obstacles ([`ResponseSettings::diffraction`]).
    Diffraction,
    /// Sound through solids ([`ResponseSettings::transmission`]).
    Transmission,
    /// The exact paths over reflections.
    Mirrored,
    /// The late part: everything outside the exact paths.
    Late,
    /// The least level of a source ([`ResponseSettings::least_level_db`]).
    LeastLevel,
}

impl Part {
    /// All parts, in the order of their keys 4 to 8.
    pub const ALL: [Part; 5] = [
        Part::Diffraction,
        Part::Transmission,
        Part::Mirrored,
        Part::Late,
        Part::LeastLevel,
    ];

    /// The part's name in messages and on controls.
    pub fn name(self) -> &'static str {
        match self {
            Part::Diffraction => "diffraction",
            Part::Transmission => "transmission",
            Part::Mirrored => "mirrored paths",
            Part::Late => "late part",
            Part::LeastLevel => "least level",
        }
    }
}

/// The parts of the sound in full listening that are heard.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parts {
    /// Whether the direct sound and reflections at plane faces bend around obstacles.
    pub diffraction: bool,
    /// Whether sound passes solids.
    pub transmission: bool,
    /// Whether the exact paths over reflections are heard.
    pub mirrored: bool,
    /// Whether the late part is heard.
    pub late: bool,
    /// Whether a source has at least `least_level_db`. Parts that are switched off count as heard.
    pub least_level: bool,
    /// The least level of a source in decibels, relative to its direct sound in the open.
    pub least_level_db: f64,
}

/// The least level that a key switches on if no other is chosen, in decibels. It is the level of a source at 32 times
/// the distance in the open.
const USUAL_LEAST_LEVEL_DB: f64 = -30.0;

impl Default for Parts {
    /// Returns the parts that [`ResponseSettings`] has by default.
    fn default() -> Parts {
        let usual = ResponseSettings::default();
        Parts {
            diffraction: usual.diffraction,
            transmission: usual.transmission,
            mirrored: true,
            late: true,
            least_level: usual.least_level_db.is_some(),
            least_level_db: usual.least_level_db.unwrap_or(USUAL_LEAST_LEVEL_DB),
        }
    }
}

impl Parts {
    /// Switches the least level on, or off with `None`. `None` keeps the level for the next time it is switched on.
    #[must_use]
    pub fn with_least_level(mut self, decibels: Option<f64>) -> Parts {
        self.least_level = decibels.is_some();
        self.least_level_db = decibels.unwrap_or(self.least_level_db);
        self
    }

    /// Whether a part is on.
    pub fn has(mut self, part: Part) -> bool {
        *self.switch(part)
    }

    /// The switch of a part.
    pub fn switch(&mut self, part: Part) -> &mut bool {
        match part {
            Part::Diffraction => &mut self.diffraction,
            Part::Transmission => &mut self.transmission,
            Part::Mirrored => &mut self.mirrored,
            Part::Late => &mut self.late,
            Part::LeastLevel => &mut self.least_level,
        }
    }

    /// Applies these choices to the settings of responses.
    pub(super) fn choose(&self, settings: ResponseSettings) -> ResponseSettings {
        let mut settings = settings
            .with_diffraction(self.diffraction)
            .with_transmission(self.transmission);
        settings.least_level_db = self.least_level.then_some(self.least_level_db);
        settings
    }

    /// Removes the parts of a response that are switched off.
    ///
    /// # Errors
    /// [`ResponseError`] if the response's bins are out of range.
    pub(super) fn keep(&self, response: &mut Response) -> Result<(), ResponseError> {
        if !self.mirrored {
            let paths = &mut response.paths;
            // Diffracted paths can have reflections too.
            paths.retain(|path| path.kind != PathKind::Mirrored && path.reflections.is_empty());
        }
        if !self.late {
            let echogram = &response.echogram;
            response.echogram = Echogram::new(echogram.bin_s(), echogram.batches())?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{EarsStatus, Hearing};
    use echomarch::gl::{Context, ContextOptions};
    use echomarch::scene::Scene;
    use echomarch::tracer::Settings;

    /// A source behind a pane that transmits, and a floor that mirrors and scatters. The floor absorbs most of the sound, so
    /// that less is heard than in the open in every trace, and the least level of 0 dB adds sound.
    const HIDDEN: &str = r#"Scene(
        surfaces: [
            Surface(shape: Box(size: (20, 1, 20)), position: (0, -2, 0), material: "floor"),
            Surface(shape: Box(size: (0.02, 1, 1)), material: "glass"),
        ],
        materials: {"floor": Material(absorption: 0.8, scattering: 0.3)},
        source: Source(position: (-2, 0, 0.1)),
        listener: Listener(position: (2, 0, 0), radius: 0.3),
    )"#;

    fn looked(hearing: &mut Hearing, scene: &Scene, parts: Parts) -> EarsStatus {
        let settings = Settings::default().with_waves(4096);
        let looked = hearing.look(scene, &settings, &parts, true, |_| Ok(()));
        looked.unwrap()
    }

    /// The kinds of paths that are heard, and whether a late part is.
    fn heard(status: &EarsStatus) -> (Vec<&'static str>, bool) {
        let source = status.sources[0];
        let kinds = source.kinds.iter().filter(|kind| kind.paths > 0);
        (
            kinds.map(|kind| kind.kind.name()).collect(),
            source.late_db.is_some(),
        )
    }

    /// Protects the switches: each part that is off is silent, the others stay, and a change of a switch causes a trace.
    /// The plan gets the paths that are heard.
    #[test]
    fn each_part_can_be_switched() {
        let context = Context::headless(&ContextOptions::default()).unwrap();
        let mut hearing = Hearing::new(&context).unwrap();
        let scene = Scene::from_ron(HIDDEN, "hidden").unwrap();
        let mut all = Parts::default().with_least_level(Some(0.0));
        all.diffraction = true;
        let status = looked(&mut hearing, &scene, all);
        let kinds = vec!["mirrored", "diffracted", "transmitted", "added"];
        assert_eq!(heard(&status), (kinds.clone(), true));
        assert!(status.paths.iter().all(|path| path.kind != PathKind::Added));
        let drawn = |kind| status.paths.iter().filter(|path| path.kind == kind).count();
        assert!(drawn(PathKind::Diffracted) > 0 && drawn(PathKind::Transmitted) == 1);
        assert!(status.paths.len() <= crate::DRAWN_PER_SOURCE);
        for (part, silent) in [
            (Part::Diffraction, "diffracted"),
            (Part::Transmission, "transmitted"),
            (Part::Mirrored, "mirrored"),
            (Part::LeastLevel, "added"),
            (Part::Late, "late"),
        ] {
            let mut parts = all;
            *parts.switch(part) = false;
            assert!(!parts.has(part));
            let settings = Settings::default().with_waves(4096);
            assert!(hearing.is_new(&scene, &settings, &parts, false), "{part:?}");
            let rest: Vec<_> = kinds
                .iter()
                .copied()
                .filter(|kind| *kind != silent)
                .collect();
            let now = heard(&looked(&mut hearing, &scene, parts));
            assert_eq!(now, (rest, part != Part::Late), "{part:?}");
        }
    }

    /// Protects the level that the user has chosen: switching the least level off and on again keeps it.
    #[test]
    fn the_least_level_is_kept_while_it_is_off() {
        let mut parts = Parts::default().with_least_level(Some(-45.0));
        assert!(parts.has(Part::LeastLevel));
        parts = parts.with_least_level(None);
        assert!(!parts.has(Part::LeastLevel));
        *parts.switch(Part::LeastLevel) = true;
        let settings = parts.choose(ResponseSettings::default());
        assert_eq!(settings.least_level_db, Some(-45.0));
    }
}
