//! The columns of a study's tables. The first columns identify a point, and the others contain its results.

use super::file::{FigureName, ResponseFile};
use super::{Kept, Study};
use crate::report::Cell;
use echomarch::bands::BANDS_HZ;
use echomarch::response::{BandFigures, Gap, Response, ResponseSettings};
use echomarch::scene::Pair;
use echomarch::tracer::Settings;

/// Maximum of all times in the results, in seconds. A response has at most 60 s, and a decay time is three times the
/// evaluated part of the decay.
const LONGEST_S: f64 = 3600.0;

/// Maximum of all levels in the results, in decibels. The ratio of two 64-bit numbers is at most 6,320 dB.
const LOUDEST_DB: f64 = 6400.0;

/// Maximum error as a multiple of the figure's range. Student's t widens an error by a factor of up to 6.4.
const ERROR_TO_RANGE: f64 = 10.0;

/// Rounding error by which a share or a time may exceed its limit.
const ROUNDING: f64 = 1e-9;

/// A column of the joined tables.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Column {
    pub name: String,
    pub kind: Kind,
    /// The permitted numbers in the cells of the column. In a text cell, they are the permitted numbers of the list.
    pub range: Range,
}

/// The permitted numbers of a column, from minimum to maximum. Cells read from a shard are checked against this range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Range {
    pub least: f64,
    pub most: f64,
    /// Whether cells may be empty.
    pub may_be_empty: bool,
}

impl Range {
    /// All finite numbers.
    const ANY: Range = Range::new(f64::MIN, f64::MAX);

    const fn new(least: f64, most: f64) -> Range {
        Range {
            least,
            most,
            may_be_empty: false,
        }
    }

    const fn or_empty(self) -> Range {
        Range {
            may_be_empty: true,
            ..self
        }
    }

    /// The range of the errors of a figure whose own range is `self`.
    fn of_errors(self) -> Range {
        let most = ERROR_TO_RANGE * (self.most - self.least);
        Range::new(0.0, most).or_empty()
    }
}

/// The type of a column's cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Whole numbers of 64 bits.
    Whole,
    /// Numbers of 64 bits.
    Real,
    /// Text. In results, it is a list of numbers separated by spaces.
    Text,
}

impl Column {
    /// Creates a column that may contain every finite number.
    pub(super) fn new(name: impl Into<String>, kind: Kind) -> Column {
        Column::within(name, kind, Range::ANY)
    }

    fn within(name: impl Into<String>, kind: Kind, range: Range) -> Column {
        Column {
            name: name.into(),
            kind,
            range,
        }
    }
}

/// The columns of a response.
#[derive(Clone, Debug)]
pub(super) struct ResponseColumns {
    figures: Vec<FigureName>,
    /// Indices into [`BANDS_HZ`].
    bands: Vec<usize>,
    errors: bool,
    /// Number of bins of the traced echogram (1 ms each) that are summed to one bin of the table.
    echogram_bins: Option<usize>,
}

impl ResponseColumns {
    /// The columns that a valid study requests.
    pub fn of(said: &ResponseFile) -> ResponseColumns {
        let place = |hz: &u32| BANDS_HZ.iter().position(|band| *band == f64::from(*hz));
        ResponseColumns {
            figures: said.figures.clone(),
            bands: said.bands_hz.iter().filter_map(place).collect(),
            errors: said.errors,
            echogram_bins: said.echogram_ms.map(|ms| ms as usize),
        }
    }

    /// The figure and the band of each pair of columns (value and error), in order.
    fn pairs(&self) -> impl Iterator<Item = (FigureName, usize)> {
        let figures = self.figures.iter();
        figures.flat_map(|figure| self.bands.iter().map(|band| (*figure, *band)))
    }

    fn columns(&self) -> Vec<Column> {
        let mut columns = Vec::new();
        for (figure, band) in self.pairs() {
            let name = format!("{}_{}", figure.column(), BANDS_HZ[band]);
            let range = figure.range();
            columns.push(Column::within(name.clone(), Kind::Real, range));
            if self.errors {
                let errors = range.of_errors();
                columns.push(Column::within(name + "_error", Kind::Real, errors));
            }
        }
        if !self.figures.is_empty() {
            columns.extend(self.bands.iter().map(|band| {
                let name = gap_column(BANDS_HZ[*band]);
                Column::within(name, Kind::Whole, Range::new(0.0, Gap::ALL.len() as f64))
            }));
        }
        if self.echogram_bins.is_some() {
            let first = Range::new(0.0, LONGEST_S);
            let energies = Range::new(0.0, f64::MAX).or_empty();
            columns.push(Column::within("echogram_from_s", Kind::Real, first));
            for band in &self.bands {
                let name = format!("echogram_{}", BANDS_HZ[*band]);
                columns.push(Column::within(name, Kind::Text, energies));
            }
        }
        columns
    }

    /// The cells of these columns for the response of a pair.
    pub fn cells(&self, response: &Response, pair: Pair) -> Vec<Cell> {
        let mut cells = Vec::new();
        for (figure, band) in self.pairs() {
            let finite = |number: Option<f64>| number.filter(|number| number.is_finite());
            cells.push(finite(figure.of(&response.figures.bands[band])).into());
            if self.errors {
                cells.push(finite(figure.of(&response.figures.errors[band])).into());
            }
        }
        if !self.figures.is_empty() {
            let gaps = response.gaps(pair);
            let has_gap = |band: usize| {
                let figures = self.figures.iter();
                figures
                    .clone()
                    .any(|figure| figure.of(&response.figures.bands[band]).is_none())
            };
            let code = |band: usize| gaps[band].filter(|_| has_gap(band)).map_or(0, Gap::code);
            cells.extend(self.bands.iter().map(|band| Cell::from(code(*band))));
        }
        if let Some(bins) = self.echogram_bins {
            cells.push(response.echogram.first_s().into());
            let energies = energies(response, bins);
            let text = |band: &usize| {
                let numbers: Vec<String> =
                    energies.iter().map(|e| format!("{:?}", e[*band])).collect();
                Cell::text(numbers.join(" "))
            };
            cells.extend(self.bands.iter().map(text));
        }
        cells
    }
}

/// Name of the column that states why the figures of a band are empty in a row. The column contains [`Gap::code`], or 0
/// if the figures are not empty.
fn gap_column(band_hz: f64) -> String {
    format!("gap_{band_hz}")
}

/// Name of the column that states why the cells of the given column are empty; `None` if the column does not contain a
/// figure.
pub(super) fn gap_column_of(column: &str) -> Option<String> {
    let name = column.strip_suffix("_error").unwrap_or(column);
    let (figure, band) = name.rsplit_once('_')?;
    BandFigures::NAMES
        .contains(&figure)
        .then(|| gap_column(band.parse().unwrap_or_default()))
}

/// The energy densities of all arrivals in 1/m². Each is the sum over `bins` bins of the echogram.
fn energies(response: &Response, bins: usize) -> Vec<echomarch::bands::Bands> {
    let echogram = &response.echogram;
    let mut energies = vec![echomarch::bands::Bands::default(); echogram.bins().div_ceil(bins)];
    for bin in 0..echogram.bins() {
        echomarch::bands::add(&mut energies[bin / bins], &echogram.energy(bin));
    }
    for path in &response.paths {
        let after = (path.delay_s - echogram.first_s()).max(0.0);
        let bin = (after / (echogram.bin_s() * bins as f64)) as usize;
        if bin >= energies.len() {
            energies.resize(bin + 1, Default::default());
        }
        echomarch::bands::add(&mut energies[bin], &path.energy);
    }
    energies
}

impl FigureName {
    /// Name of the figure's column, without the suffix for the band.
    fn column(self) -> &'static str {
        BandFigures::NAMES[self as usize]
    }

    fn range(self) -> Range {
        let range = match self {
            FigureName::Edt | FigureName::T20 | FigureName::T30 | FigureName::Ts => {
                Range::new(-ROUNDING, LONGEST_S)
            }
            FigureName::C50 | FigureName::C80 | FigureName::G => {
                Range::new(-LOUDEST_DB, LOUDEST_DB)
            }
            FigureName::D50 => Range::new(-ROUNDING, 1.0 + ROUNDING),
        };
        range.or_empty()
    }

    fn of(self, figures: &BandFigures) -> Option<f64> {
        figures.list()[self as usize]
    }
}

impl Kept {
    /// Whether frames are traced.
    pub(super) fn traces_frames(&self) -> bool {
        self.pan || self.counts || self.exact
    }

    /// Whether the number of waves of the responses is a result: with an accuracy.
    pub(super) fn states_waves(&self) -> bool {
        let accuracy = |(response, _): &(ResponseSettings, _)| response.accuracy.is_some();
        self.response.as_ref().is_some_and(accuracy)
    }

    /// The columns of the results. Counts of waves are at most `waves`, and counts of marches are at most `marches`.
    fn columns(&self, waves: u64, marches: u64) -> Vec<Column> {
        let mut columns = Vec::new();
        let waves = Range::new(0.0, waves as f64);
        let marches = Range::new(0.0, marches as f64);
        let pan = Range::new(-1.0, 1.0);
        if self.pan {
            // Each wave adds 1 to the sum of the two channels.
            let ranges = [("left", waves), ("right", waves), ("pan", pan)];
            columns.extend(ranges.map(|(name, range)| Column::within(name, Kind::Real, range)));
        }
        if self.counts {
            let ranges = [
                ("listener_hits", waves),
                ("dead", waves),
                ("travelling", waves),
                ("not_finite", waves),
                ("zero_length_passes", marches),
                ("step_limit_reached", marches),
            ];
            columns.extend(ranges.map(|(name, range)| Column::within(name, Kind::Whole, range)));
        }
        if self.exact {
            let range = Range::new(-1.0 - ROUNDING, 1.0 + ROUNDING);
            columns.push(Column::within("exact_pan", Kind::Real, range));
        }
        if self.states_waves() {
            let range = Range::new(0.0, f64::from(Settings::MAX_WAVES));
            columns.push(Column::within("response_waves", Kind::Whole, range));
        }
        if let Some((_, response)) = &self.response {
            columns.extend(response.columns());
        }
        columns
    }
}

impl Study {
    /// The names of all named values in alphabetical order, without duplicates.
    pub(super) fn value_names(&self) -> Vec<&str> {
        let names = self.variants.iter().flat_map(|axis| axis.values.keys());
        let names: std::collections::BTreeSet<&str> = names.map(String::as_str).collect();
        names.into_iter().collect()
    }

    /// The columns that identify a point. The first column is the point's number.
    pub(super) fn point_columns(&self) -> Vec<Column> {
        let mut columns = vec![
            Column::new("point", Kind::Whole),
            Column::new("scene", Kind::Text),
        ];
        let values = self.value_names().into_iter();
        columns.extend(values.map(|name| Column::new(format!("value_{name}"), Kind::Real)));
        if self.times.is_some() {
            columns.push(Column::new("time_s", Kind::Real));
        }
        if self.settings.iter().any(|case| case.label.is_some()) {
            columns.push(Column::new("case", Kind::Text));
        }
        for (name, kind) in [
            ("profile", Kind::Text),
            ("directions", Kind::Text),
            ("waves", Kind::Whole),
            ("iterations", Kind::Whole),
            ("source_x_m", Kind::Real),
            ("source_y_m", Kind::Real),
            ("source_z_m", Kind::Real),
            ("listener_x_m", Kind::Real),
            ("listener_y_m", Kind::Real),
            ("listener_z_m", Kind::Real),
            ("seed", Kind::Whole),
        ] {
            columns.push(Column::new(name, kind));
        }
        columns
    }

    /// All columns, in order.
    pub(super) fn columns(&self) -> Vec<Column> {
        [self.point_columns(), self.found_columns()].concat()
    }

    /// The columns of the results.
    pub(super) fn found_columns(&self) -> Vec<Column> {
        let settings = || self.settings.iter().map(|case| &case.settings);
        let waves = settings().map(|settings| u64::from(settings.waves));
        let marches = settings().map(|it| u64::from(it.waves) * u64::from(it.iterations));
        let (waves, marches) = (waves.max().unwrap_or(0), marches.max().unwrap_or(0));
        self.keep.columns(waves, marches)
    }
}
