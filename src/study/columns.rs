//! The columns of a study: what a point is, and what was found.

use super::file::{FigureName, ResponseFile};
use super::{Kept, Study};
use crate::acoustics::BandFigures;
use crate::bands::BANDS_HZ;
use crate::report::Cell;
use crate::response::{Gap, Response};

/// A column of the joined tables.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Column {
    pub name: String,
    pub kind: Kind,
}

/// What the cells of a column are; each may also be empty, where there is no such value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Whole numbers of 64 bits.
    Whole,
    /// Numbers of 64 bits.
    Real,
    /// Text.
    Text,
}

impl Column {
    fn new(name: impl Into<String>, kind: Kind) -> Column {
        Column {
            name: name.into(),
            kind,
        }
    }
}

/// Which columns a response gives.
#[derive(Clone, Debug)]
pub(super) struct ResponseColumns {
    figures: Vec<FigureName>,
    /// Places in [`BANDS_HZ`].
    bands: Vec<usize>,
    errors: bool,
    /// Bins of the traced echogram, each 1 ms long, in one that is kept.
    echogram_bins: Option<usize>,
}

impl ResponseColumns {
    /// The columns that a checked study requests.
    pub fn of(said: &ResponseFile) -> ResponseColumns {
        let place = |hz: &u32| BANDS_HZ.iter().position(|band| *band == f64::from(*hz));
        ResponseColumns {
            figures: said.figures.clone(),
            bands: said.bands_hz.iter().filter_map(place).collect(),
            errors: said.errors,
            echogram_bins: said.echogram_ms.map(|ms| ms as usize),
        }
    }

    /// Figure and band of each pair of columns, in order.
    fn pairs(&self) -> impl Iterator<Item = (FigureName, usize)> {
        let figures = self.figures.iter();
        figures.flat_map(|figure| self.bands.iter().map(|band| (*figure, *band)))
    }

    fn columns(&self) -> Vec<Column> {
        let mut columns = Vec::new();
        for (figure, band) in self.pairs() {
            let name = format!("{}_{}", figure.column(), BANDS_HZ[band]);
            columns.push(Column::new(name.clone(), Kind::Real));
            if self.errors {
                columns.push(Column::new(name + "_error", Kind::Real));
            }
        }
        if !self.figures.is_empty() {
            columns.extend(self.bands.iter().map(|band| {
                let name = gap_column(BANDS_HZ[*band]);
                Column::new(name, Kind::Whole)
            }));
        }
        if self.echogram_bins.is_some() {
            columns.push(Column::new("echogram_from_s", Kind::Real));
            for band in &self.bands {
                let name = format!("echogram_{}", BANDS_HZ[*band]);
                columns.push(Column::new(name, Kind::Text));
            }
        }
        columns
    }

    /// The cells of these columns.
    pub fn cells(&self, response: &Response) -> Vec<Cell> {
        let mut cells = Vec::new();
        for (figure, band) in self.pairs() {
            cells.push(figure.of(&response.figures.bands[band]).into());
            if self.errors {
                cells.push(figure.of(&response.figures.errors[band]).into());
            }
        }
        if !self.figures.is_empty() {
            let gaps = response.gaps();
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

/// The column that says why figures of a band are empty in a row: [`Gap::code`], 0 where none is.
fn gap_column(band_hz: f64) -> String {
    format!("gap_{band_hz}")
}

/// The column with the reason why cells of this one are empty, if it is one of a figure.
pub(super) fn gap_column_of(column: &str) -> Option<String> {
    let name = column.strip_suffix("_error").unwrap_or(column);
    let (figure, band) = name.rsplit_once('_')?;
    let is_figure = FigureName::ALL.iter().any(|known| known.column() == figure);
    is_figure.then(|| gap_column(band.parse().unwrap_or_default()))
}

/// The energy densities of all that arrives in 1/m², in bins of so many bins of the echogram.
fn energies(response: &Response, bins: usize) -> Vec<crate::bands::Bands> {
    let echogram = &response.echogram;
    let mut energies = vec![crate::bands::Bands::default(); echogram.bins().div_ceil(bins)];
    for bin in 0..echogram.bins() {
        crate::bands::add(&mut energies[bin / bins], &echogram.energy(bin));
    }
    for path in &response.paths {
        let after = (path.delay_s - echogram.first_s()).max(0.0);
        let bin = (after / (echogram.bin_s() * bins as f64)) as usize;
        if bin >= energies.len() {
            energies.resize(bin + 1, Default::default());
        }
        crate::bands::add(&mut energies[bin], &path.energy);
    }
    energies
}

impl FigureName {
    const ALL: [FigureName; 8] = [
        FigureName::Edt,
        FigureName::T20,
        FigureName::T30,
        FigureName::C50,
        FigureName::C80,
        FigureName::D50,
        FigureName::Ts,
        FigureName::G,
    ];

    /// Its column, without the band.
    fn column(self) -> &'static str {
        match self {
            FigureName::Edt => "edt_s",
            FigureName::T20 => "t20_s",
            FigureName::T30 => "t30_s",
            FigureName::C50 => "c50_db",
            FigureName::C80 => "c80_db",
            FigureName::D50 => "d50",
            FigureName::Ts => "ts_s",
            FigureName::G => "g_db",
        }
    }

    fn of(self, figures: &BandFigures) -> Option<f64> {
        match self {
            FigureName::Edt => figures.edt_s,
            FigureName::T20 => figures.t20_s,
            FigureName::T30 => figures.t30_s,
            FigureName::C50 => figures.c50_db,
            FigureName::C80 => figures.c80_db,
            FigureName::D50 => figures.d50,
            FigureName::Ts => figures.ts_s,
            FigureName::G => figures.g_db,
        }
    }
}

impl Kept {
    /// The columns of what was found.
    pub fn columns(&self) -> Vec<Column> {
        let mut columns = Vec::new();
        if self.pan {
            let names = ["left", "right", "pan"];
            columns.extend(names.map(|name| Column::new(name, Kind::Real)));
        }
        if self.counts {
            let names = [
                "listener_hits",
                "dead",
                "travelling",
                "not_finite",
                "zero_length_passes",
                "step_limit_reached",
            ];
            columns.extend(names.map(|name| Column::new(name, Kind::Whole)));
        }
        if self.exact {
            columns.push(Column::new("exact_pan", Kind::Real));
        }
        if let Some((_, response)) = &self.response {
            columns.extend(response.columns());
        }
        columns
    }
}

impl Study {
    /// Names of named values, each once, in alphabetic order.
    pub(super) fn value_names(&self) -> Vec<&str> {
        let names = self.variants.iter().flat_map(|axis| axis.values.keys());
        let names: std::collections::BTreeSet<&str> = names.map(String::as_str).collect();
        names.into_iter().collect()
    }

    /// The columns that identify a point; the first is its number.
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

    /// The columns of what was found.
    pub(super) fn found_columns(&self) -> Vec<Column> {
        self.keep.columns()
    }
}
