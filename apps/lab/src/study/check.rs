//! Checks the content of a study file before any work: each field must be within its valid range.

use super::StudyError;
use super::file::{
    FigureName, Keep, Numbers, Places, ResponseFile, Seeds, SettingsFile, StudyFile,
};
use crate::text::check_name;
use echomarch::Error;
use echomarch::bands::BANDS_HZ;
use echomarch::response::ResponseSettings;
use echomarch::response::{Accuracy, ImpulseSettings};
use echomarch::tracer::{Settings, TraceError};
use std::fmt::Display;

/// Maximum number of points in a study. 10⁹ points take years on one core, and point numbers up to this maximum are
/// exact in every table format.
pub(super) const MOST_POINTS: u64 = 1_000_000_000_000;

/// Maximum number of values on one axis.
const MOST_ON_AXIS: u64 = 1_000_000_000;

/// Maximum coordinate of a source or a listener, in metres. Scene files have the same limit.
const FARTHEST_M: f32 = 1e6;

/// Maximum time on a path, in seconds: one day.
const LATEST_S: f64 = 86_400.0;

/// Minimum length of a response, in seconds: one time bin.
const SHORTEST_S: f64 = 1e-3;

/// Maximum length of an echogram bin, in milliseconds, as in [`Echogram::BINS_S`](crate::response::Echogram::BINS_S).
const LONGEST_BIN_MS: u32 = 100;

/// Creates errors for invalid fields, with the name of the file.
pub(super) struct Checker<'a> {
    /// The name of the file in error messages.
    pub origin: &'a str,
}

impl Checker<'_> {
    /// Checks every field whose check does not need the scenes.
    pub fn check(&self, file: &StudyFile) -> Result<(), StudyError> {
        if let Err(why) = check_name(&file.name) {
            return self.bad("name", format!("a name that can be shown ({why})"), "it");
        }
        self.count("scenes", file.scenes.len() as u64)?;
        for (at, scene) in file.scenes.iter().enumerate() {
            for (name, numbers) in &scene.values {
                let place = format!("scenes[{}].values.{name:?}", at + 1);
                self.numbers(&place, numbers, f64::from(f32::MIN), f64::from(f32::MAX))?;
            }
        }
        if let Some(times) = &file.times {
            self.numbers("times", times, 0.0, LATEST_S)?;
        }
        self.places("sources", &file.sources)?;
        self.places("listeners", &file.listeners)?;
        if let Some(radius) = file.listener_radius {
            let is_right = radius > 0.0 && radius <= FARTHEST_M;
            self.must(is_right, "listener_radius", "metres above 0", radius)?;
        }
        self.settings(&file.settings)?;
        self.seeds(&file.seeds)?;
        self.keep(&file.keep, &file.settings)
    }

    /// Returns the error for an invalid field.
    pub fn bad<T>(
        &self,
        place: &str,
        must: impl Into<String>,
        value: impl Display,
    ) -> Result<T, StudyError> {
        Err(StudyError::BadField {
            origin: self.origin.to_owned(),
            place: place.to_owned(),
            must: must.into(),
            value: value.to_string(),
        })
    }

    fn must(
        &self,
        is_right: bool,
        place: &str,
        must: &str,
        value: impl Display,
    ) -> Result<(), StudyError> {
        match is_right {
            true => Ok(()),
            false => self.bad(place, must, value),
        }
    }

    /// Checks the number of values of a list.
    fn count(&self, place: &str, count: u64) -> Result<(), StudyError> {
        let must = format!("1 to {MOST_ON_AXIS} of them");
        self.must((1..=MOST_ON_AXIS).contains(&count), place, &must, count)
    }

    fn within(&self, place: &str, value: f64, least: f64, most: f64) -> Result<(), StudyError> {
        let must = format!("from {least} to {most}");
        self.must((least..=most).contains(&value), place, &must, value)
    }

    fn numbers(
        &self,
        place: &str,
        numbers: &Numbers,
        least: f64,
        most: f64,
    ) -> Result<(), StudyError> {
        self.count(place, numbers.len())?;
        match numbers {
            Numbers::List(list) => list.iter().enumerate().try_for_each(|(at, number)| {
                self.within(&format!("{place}[{}]", at + 1), *number, least, most)
            }),
            Numbers::Range { from, to, count } => {
                self.within(&format!("{place}.from"), *from, least, most)?;
                self.within(&format!("{place}.to"), *to, least, most)?;
                self.ends(place, from == to, *count)
            }
            Numbers::Geometric { from, to, count } => {
                self.within(&format!("{place}.from"), *from, least, most)?;
                self.within(&format!("{place}.to"), *to, least, most)?;
                let same_sign = from * to > 0.0;
                let must = "0 between them: neither, nor on either side of it";
                self.must(
                    same_sign,
                    &format!("{place}: from and to"),
                    must,
                    format!("{from} and {to}"),
                )?;
                self.ends(place, from == to, *count)
            }
        }
    }

    /// Checks the ends of a range. The ends must be equal for a count of 1, and different for a larger count.
    fn ends(&self, place: &str, are_equal: bool, count: u64) -> Result<(), StudyError> {
        let is_right = are_equal == (count == 1);
        let must = "1 where from and to are equal, else 2 or more";
        self.must(is_right, &format!("{place}.count"), must, count)
    }

    fn places(&self, place: &str, places: &Places) -> Result<(), StudyError> {
        let Some(count) = places.len() else {
            return self.bad(
                place,
                format!("1 to {MOST_ON_AXIS} places"),
                "more than can be counted",
            );
        };
        self.count(place, count)?;
        match places {
            Places::AsInScene => Ok(()),
            Places::List(list) => self.points(place, list),
            Places::Grid { from, to, counts } => {
                self.points(&format!("{place}.from and .to"), &[*from, *to])?;
                for axis in 0..3 {
                    let at = format!("{place}.counts[{}]: its", axis + 1);
                    self.ends(&at, from[axis] == to[axis], counts[axis])?;
                }
                Ok(())
            }
            Places::Path { through, .. } => {
                let is_line = through.len() >= 2;
                let at = format!("{place}.through");
                self.must(is_line, &at, "2 points or more", through.len())?;
                self.must(count >= 2, &format!("{place}.count"), "2 or more", count)?;
                self.points(&at, through)
            }
        }
    }

    fn points(&self, place: &str, points: &[[f32; 3]]) -> Result<(), StudyError> {
        for (at, point) in points.iter().enumerate() {
            for coordinate in point {
                let place = format!("{place}[{}]", at + 1);
                let must = format!("metres from {} to {FARTHEST_M}", -FARTHEST_M);
                let is_near = coordinate.abs() <= FARTHEST_M;
                self.must(is_near, &place, &must, coordinate)?;
            }
        }
        Ok(())
    }

    fn settings(&self, settings: &SettingsFile) -> Result<(), StudyError> {
        let SettingsFile::All {
            profiles,
            waves,
            iterations,
            directions,
        } = settings
        else {
            return Ok(());
        };
        self.count("settings.profiles", profiles.len() as u64)?;
        self.count("settings.directions", directions.len() as u64)?;
        for (place, list, most) in [
            ("settings.waves", waves, Settings::MAX_WAVES),
            ("settings.iterations", iterations, Settings::MAX_ITERATIONS),
        ] {
            self.count(place, list.len() as u64)?;
            for (at, number) in list.iter().enumerate() {
                let place = format!("{place}[{}]", at + 1);
                self.within(&place, f64::from(*number), 1.0, f64::from(most))?;
            }
        }
        Ok(())
    }

    fn seeds(&self, seeds: &Seeds) -> Result<(), StudyError> {
        self.count("seeds", seeds.len())?;
        let Seeds::Range { from, count } = seeds else {
            return Ok(());
        };
        let last = u64::from(*from) + count - 1;
        let must = format!("at most {} from {from} on", u32::MAX);
        self.must(last <= u64::from(u32::MAX), "seeds.count", &must, count)
    }

    fn keep(&self, keep: &Keep, settings: &SettingsFile) -> Result<(), StudyError> {
        let traces_frames = keep.pan || keep.counts || keep.exact;
        if !traces_frames && keep.response.is_none() {
            return self.bad("keep", "something", "nothing");
        }
        let is_accurate = |response: &ResponseFile| response.accuracy.is_some();
        let finds_waves = keep.response.as_ref().is_some_and(is_accurate);
        if let SettingsFile::All {
            iterations, waves, ..
        } = settings
        {
            for (place, list, has_no_effect, must) in [
                (
                    "settings.iterations",
                    iterations,
                    !traces_frames,
                    "one number where only responses are kept: they use as many as they need",
                ),
                (
                    "settings.waves",
                    waves,
                    !traces_frames && finds_waves,
                    "one number where only responses with an accuracy are kept: they use as many as they need",
                ),
            ] {
                let is_right = !has_no_effect || list.len() == 1;
                self.must(is_right, place, must, list.len())?;
            }
        }
        match &keep.response {
            None => Ok(()),
            Some(response) => self.response(response),
        }
    }

    fn response(&self, response: &ResponseFile) -> Result<(), StudyError> {
        let ResponseFile {
            figures, bands_hz, ..
        } = response;
        let place = "keep.response.figures";
        let is_once = |figure: &FigureName| figures.iter().filter(|it| *it == figure).count() == 1;
        let is_something = !figures.is_empty() || response.echogram_ms.is_some();
        self.must(is_something, place, "one or more", "none")?;
        self.must(figures.iter().all(is_once), place, "each once", "twice")?;
        self.must(
            !bands_hz.is_empty(),
            "keep.response.bands_hz",
            "some",
            "none",
        )?;
        for (at, band) in bands_hz.iter().enumerate() {
            let is_known = BANDS_HZ.contains(&f64::from(*band)) && !bands_hz[..at].contains(band);
            let place = format!("keep.response.bands_hz[{}]", at + 1);
            let must = "one of 63, 125, 250, 500, 1000, 2000, 4000, 8000, each once";
            self.must(is_known, &place, must, band)?;
        }
        if let Some(seconds) = response.seconds {
            self.within(
                "keep.response.seconds",
                seconds,
                SHORTEST_S,
                ImpulseSettings::MAX_SECONDS,
            )?;
        }
        if let Some(order) = response.order {
            let most = f64::from(ResponseSettings::MAX_ORDER);
            self.within("keep.response.order", f64::from(order), 0.0, most)?;
        }
        if let Some(share) = response.accuracy
            && let Err(Error::Trace(TraceError::BadSetting { must, value, .. })) =
                Accuracy::new(share).validate()
        {
            return self.bad("keep.response.accuracy", must, value);
        }
        if let Some(bin) = response.echogram_ms {
            let most = f64::from(LONGEST_BIN_MS);
            self.within("keep.response.echogram_ms", f64::from(bin), 1.0, most)?;
        }
        Ok(())
    }
}
