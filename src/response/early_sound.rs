//! The early sound of a listener: exact paths take the place of early arrivals. It depends on the waves of early arrivals
//! alone, so rounds with the same number of these waves share it.

use super::early_part::{Caught, EarlyPart, Search};
use super::exact_paths::EarlyPaths;
use super::hidden::Hidden;
use super::late::Heard;
use super::source_sound::Medium;
use super::{Arrival, Echogram, Figures, HeardPath, Response, ResponseSettings, direct};
use crate::error::Error;
use crate::tracer::{ArrivalCounts, Settings, Tracer};
use glam::Vec3;

/// The start directions of all waves, computed when they are first needed.
#[derive(Default)]
pub(super) struct StartDirections(Vec<Vec3>);

impl StartDirections {
    /// The waves that arrived early, each once, in order of number, with their start directions.
    pub fn of_waves(
        &mut self,
        tracer: &mut Tracer,
        settings: &Settings,
        early: &[Arrival],
    ) -> Result<Vec<(u32, Vec3)>, Error> {
        if self.0.is_empty() && !early.is_empty() {
            self.0 = tracer.start_directions(settings)?;
        }
        let mut waves: Vec<u32> = early.iter().map(|arrival| arrival.wave).collect();
        waves.dedup();
        let start = |wave: u32| (wave, self.0[wave as usize]);
        Ok(waves.into_iter().map(start).collect())
    }
}

/// The exact paths of a listener, and the early arrivals that remain statistical.
pub(super) struct EarlySound {
    /// The exact paths and the waves that they replace.
    pub caught: Caught,
    pub hidden: Hidden,
    /// The sound along all paths, those around and through obstacles included, in order of time.
    pub paths: Vec<HeardPath>,
    /// Number of waves of early arrivals.
    pub waves: u32,
    /// Whether no exact path leads straight from the source.
    is_hidden: bool,
}

impl EarlySound {
    /// Finds the paths of `early` arrivals in a record of `seconds`. `starts` are the directions of their waves, as from
    /// [`StartDirections::of_waves`].
    pub fn find(
        heard: &Heard,
        settings: &ResponseSettings,
        seconds: f64,
        (starts, early): (Vec<(u32, Vec3)>, Vec<Arrival>),
    ) -> Result<EarlySound, Error> {
        let Heard { pair, medium, .. } = *heard;
        let early_paths = EarlyPaths::new(pair)?;
        let search = Search {
            pair,
            paths: &early_paths,
            waves: settings.trace.waves,
            order: settings.order_in(pair.scene),
            diffracts: settings.diffracts(),
        };
        let part = EarlyPart::find(&search, &starts, early);
        let straight = part.heard(pair, medium);
        let mut paths = straight.clone();
        let hidden = Hidden::find(
            (pair, medium, &early_paths),
            settings,
            part.hidden_reflections(),
            &mut paths,
        );
        let around: Vec<HeardPath> = hidden.paths().cloned().collect();
        let exact = (&straight[..], paths.clone());
        let caught = Caught::new((pair, medium), part, exact, around.clone());
        paths.extend(around);
        paths.sort_by(|a, b| a.delay_s.total_cmp(&b.delay_s));
        let is_heard = |path: &HeardPath| path.energy.iter().any(|energy| *energy > 0.0);
        paths.retain(|path| path.delay_s <= seconds && is_heard(path));
        Ok(EarlySound {
            is_hidden: direct(&straight).is_none(),
            caught,
            hidden,
            paths,
            waves: settings.trace.waves,
        })
    }

    /// The response of this sound alone, without any other arrival and without figures.
    pub fn alone(
        self,
        medium: &Medium,
        settings: &ResponseSettings,
        seconds: f64,
    ) -> Result<Response, Error> {
        let part = &self.caught.part;
        let echogram = Echogram::with_edge_at(medium.direct_s, settings.bin_s, settings.batches)?;
        Ok(Response {
            missed: part.missed(),
            left_out: 0,
            left_out_share: 0.0,
            search_left_out_share: part.search_left_out_share(),
            diffraction_milliseconds: self.hidden.diffraction_milliseconds(),
            paths: self.paths,
            echogram,
            figures: Figures::omitted(),
            seconds,
            followed_s: None,
            counts: ArrivalCounts::default(),
            waves: 0,
            onset_waves: 0,
            accuracy: None,
            ended: None,
            diffraction: settings.diffracts(),
            milliseconds: 0.0,
        })
    }

    /// Whether the paths of all early arrivals were searched for. Otherwise more waves of early arrivals add no paths.
    pub fn is_search_complete(&self) -> bool {
        self.caught.part.waves() == self.waves
    }

    /// Adds the arrivals that no path replaces.
    pub fn add_left_over(&self, medium: &Medium, to: &mut Echogram) {
        // Diffracted paths replace the waves that pass an edge and reach a part of the listener's sphere.
        let is_replaced = |arrival: &Arrival| arrival.reflections == 0 && self.hidden.is_bent();
        let is_bent = |reflection| self.hidden.is_reflection_bent(reflection);
        let left_over = self.caught.part.left_over(is_bent);
        left_over
            .filter(|arrival| !is_replaced(arrival))
            .for_each(|arrival| medium.add(to, arrival));
    }

    /// Whether waves that pass solids in a straight line count: an exact path would replace them.
    pub fn counts_straight(&self) -> bool {
        self.is_hidden && !self.hidden.replaces_straight_waves()
    }
}
