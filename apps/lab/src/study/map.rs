//! Maps: pictures of one column of a joined study whose listeners form a grid on a plane.

use super::columns::{Column, Kind};
use super::empty::EmptyCount;
use super::file::Places;
use super::{Study, StudyError, Worker};
use crate::stats::mean;
use echomarch::Error;
use echomarch::internals::plain_file;
use echomarch::picture::{MapOptions, map, save_png_inside};
use echomarch::response::Gap;
use glam::Vec3;
use plotters::style::colors::colormaps::ViridisRGB;
use std::collections::BTreeMap;
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

/// Maximum number of maps of one column. Further maps can be drawn from the table.
const MOST_MAPS: u64 = 100;

/// Maximum number of positions in a map. With more positions than pixels, some would be invisible.
const MOST_PLACES: u64 = 4_000_000;

/// Width of the plan in a map, in pixels.
const WIDTH: u32 = 800;

/// Draws maps of a column of the joined table in `folder`, one for every combination of scene, time, settings and
/// source. The file is `map-COLUMN.png`, or `map-COLUMN-1.png` and so on for several maps. The colour of a position is
/// the mean over its seeds. Returns the paths of the files.
///
/// # Errors
/// [`StudyError::NoMap`] if the study's listeners are not a grid along x and z, or if the column has no numbers;
/// [`StudyError::Output`]; errors of OpenGL.
pub fn draw_map(
    worker: &mut Worker,
    folder: &Path,
    column: &str,
) -> Result<Vec<PathBuf>, StudyError> {
    let study = worker.study;
    let lattice = Lattice::of(study)?;
    let (at, column) = numbers_column(study, column)?;
    let pictures = files(study, &lattice, folder, &column);
    let table = folder.join("study.csv");
    let failed = |source: io::Error| StudyError::output(&table, source);
    let rows = plain_file::open(&table, File::options().read(true)).map_err(failed)?;
    let mut rows = csv::Reader::from_reader(rows);
    let mut rows = rows.records();
    let columns = study.columns();
    let reasons = EmptyCount::new(columns);
    for (number, file) in pictures.iter().enumerate() {
        let mut values = Vec::new();
        let mut gaps: BTreeMap<Gap, u64> = BTreeMap::new();
        for _ in 0..lattice.places {
            let mut seeds = Vec::new();
            let mut gap = None;
            for _ in 0..study.seeds.len() {
                let ended = || failed(io::Error::other("it has fewer rows than the study"));
                let row = rows.next().ok_or_else(ended)?;
                let row = row.map_err(|error| failed(error.into()))?;
                let cell = row.get(at).and_then(|cell| cell.parse::<f64>().ok());
                seeds.extend(cell.filter(|number| number.is_finite()));
                let cells: Vec<&str> = row.iter().collect();
                gap = gap.or(reasons.reason(at, &cells));
            }
            if let Some(gap) = gap.filter(|_| seeds.is_empty()) {
                *gaps.entry(gap).or_default() += 1;
            }
            values.push(mean(seeds));
        }
        let numbers = Numbers { values, gaps };
        draw(worker, &lattice, number as u64, &column, &numbers, file)?;
    }
    Ok(pictures)
}

/// The paths of the maps of a column.
fn files(study: &Study, lattice: &Lattice, folder: &Path, column: &Column) -> Vec<PathBuf> {
    let maps = study.points / lattice.places / study.seeds.len();
    let name = |number: u64| match maps {
        1 => format!("map-{}.png", column.name),
        _ => format!("map-{}-{number}.png", column.name),
    };
    (1..=maps).map(|number| folder.join(name(number))).collect()
}

/// The numbers shown in a map.
struct Numbers {
    /// The number at each position; `None` if the position is empty.
    values: Vec<Option<f64>>,
    /// Number of empty cells, by reason.
    gaps: BTreeMap<Gap, u64>,
}

impl Numbers {
    /// The end of the map's title: the number of empty positions and the reasons.
    fn empty(&self) -> String {
        let empty = self.values.iter().filter(|value| value.is_none()).count();
        if empty == 0 {
            return String::new();
        }
        let why: Vec<&str> = self.gaps.keys().map(|gap| gap.words()).collect();
        let why = match why.is_empty() {
            true => String::new(),
            false => format!(": {}", why.join(", ")),
        };
        format!(", {empty} of {} empty{why}", self.values.len())
    }
}

fn draw(
    worker: &mut Worker,
    lattice: &Lattice,
    number: u64,
    column: &Column,
    numbers: &Numbers,
    file: &Path,
) -> Result<(), StudyError> {
    let study = worker.study;
    let point = study.point(number * lattice.places * study.seeds.len());
    let mut draw = || -> Result<(), Error> {
        let mut scene = study.posed(point.variant, point.time)?;
        if let Some(position) = study.source_of(&point) {
            scene.sources[0].position = position;
        }
        let options = MapOptions {
            width: WIDTH,
            height: lattice.ends[0].y,
            ends: lattice.ends,
            counts: lattice.counts,
            values: &numbers.values,
            title: &format!("{}: {}{}", scene.name, title(&column.name), numbers.empty()),
            around_zero: has_sides(&column.name),
            unit: unit(&column.name),
            colour: match has_sides(&column.name) {
                true => two_sided,
                false => viridis,
            },
        };
        let picture = map(worker.tracer().context(), scene.only_pair()?, &options)?;
        Ok(save_png_inside(file, &picture)?)
    };
    draw().map_err(|source| StudyError::Point {
        index: point.index,
        what: study.label(&point),
        source: Box::new(source),
    })
}

/// A grid of listeners along x and z.
struct Lattice {
    ends: [Vec3; 2],
    counts: [u32; 2],
    places: u64,
}

impl Lattice {
    fn of(study: &Study) -> Result<Lattice, StudyError> {
        let refused = |why: &str| StudyError::NoMap {
            why: why.to_owned(),
        };
        let Places::Grid { from, to, counts } = &study.listeners else {
            return Err(refused("the listeners of the study are not a Grid"));
        };
        let [x, y, z] = *counts;
        if x < 2 || z < 2 || y != 1 {
            return Err(refused(
                "the listeners' Grid must have 2 places or more along x and z, and one along y",
            ));
        }
        let places = x.saturating_mul(z);
        let maps = study.points / places / study.seeds.len();
        if places > MOST_PLACES || maps > MOST_MAPS {
            return Err(refused(&format!(
                "{maps} maps of {places} places are too many: at most {MOST_MAPS} of {MOST_PLACES}"
            )));
        }
        Ok(Lattice {
            ends: [Vec3::from(*from), Vec3::from(*to)],
            counts: [x as u32, z as u32],
            places,
        })
    }
}

/// Checks, before long work, that maps of these columns can be drawn.
///
/// # Errors
/// The errors of [`draw_map`] that depend only on the study.
pub fn check_maps(study: &Study, columns: &[String]) -> Result<(), StudyError> {
    if columns.is_empty() {
        return Ok(());
    }
    Lattice::of(study)?;
    columns
        .iter()
        .try_for_each(|column| numbers_column(study, column).map(drop))
}

/// Checks that the files of these maps can be written to the folder, which must exist.
pub fn check_map_files(study: &Study, folder: &Path, columns: &[String]) -> Result<(), StudyError> {
    for column in columns {
        let (lattice, (_, column)) = (Lattice::of(study)?, numbers_column(study, column)?);
        for file in files(study, &lattice, folder, &column) {
            echomarch::internals::file_output::check_inside(&file)?;
        }
    }
    Ok(())
}

/// The index of a column of numbers among all columns of the joined table.
fn numbers_column(study: &Study, name: &str) -> Result<(usize, Column), StudyError> {
    let points = study.point_columns().len();
    let found = study.found_columns();
    let numbers = || found.iter().filter(|column| column.kind != Kind::Text);
    match found
        .iter()
        .position(|column| column.name == name && column.kind != Kind::Text)
    {
        Some(at) => Ok((points + at, found[at].clone())),
        None => {
            let known: Vec<&str> = numbers().map(|column| column.name.as_str()).collect();
            let known = known.join(", ");
            let why = format!("the study keeps no numbers called {name:?}; it keeps: {known}");
            Err(StudyError::NoMap { why })
        }
    }
}

/// The title of a map of the column, such as `G at 1000 Hz` or `pan`.
fn title(column: &str) -> String {
    let words: Vec<&str> = column.split('_').collect();
    let band = words.last().filter(|last| last.parse::<u32>().is_ok());
    let figure = words[0].to_uppercase();
    match (band, words.len()) {
        (Some(band), 2 | 3) => format!("{figure} at {band} Hz"),
        _ => words.join(" "),
    }
}

/// Whether the sign of a column's numbers means left or right.
fn has_sides(column: &str) -> bool {
    column.split('_').any(|word| word == "pan")
}

/// The colour map viridis: dark blue for the smallest number, yellow for the largest.
fn viridis(share: f64) -> [u8; 3] {
    let colour = ViridisRGB::get_color(share);
    [colour.0, colour.1, colour.2]
}

/// A diverging colour map: blue for the left, pale yellow for 0, red for the right.
fn two_sided(share: f64) -> [u8; 3] {
    const LEFT: [f64; 3] = [69.0, 117.0, 180.0];
    const MIDDLE: [f64; 3] = [255.0, 255.0, 191.0];
    const RIGHT: [f64; 3] = [215.0, 48.0, 39.0];
    let side = 2.0 * share.clamp(0.0, 1.0) - 1.0;
    let end = if side < 0.0 { LEFT } else { RIGHT };
    let mixed = |at: usize| MIDDLE[at] + side.abs() * (end[at] - MIDDLE[at]);
    [0, 1, 2].map(|at| mixed(at).round() as u8)
}

/// The unit of a column, derived from its name.
fn unit(column: &str) -> &'static str {
    let mut words = column.split('_');
    match words.nth(1) {
        Some("db") => "dB",
        Some("s") => "s",
        _ => "",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the reader of a map: its title, and the assignment of colours to sides.
    #[test]
    fn maps_are_titled_and_sides_coloured() {
        for (column, told) in [
            ("g_db_1000", "G at 1000 Hz"),
            ("d50_500", "D50 at 500 Hz"),
            ("pan", "pan"),
            ("listener_hits", "listener hits"),
        ] {
            assert_eq!(title(column), told);
        }
        let mut numbers = Numbers {
            values: vec![Some(1.0), None, None],
            gaps: BTreeMap::from([(Gap::TooNoisy, 1), (Gap::Silence, 1)]),
        };
        assert_eq!(
            numbers.empty(),
            ", 2 of 3 empty: nothing arrives, too noisy"
        );
        numbers.values.truncate(1);
        assert_eq!(numbers.empty(), "");
        assert!(has_sides("pan") && !has_sides("g_db_1000"));
        assert_eq!(two_sided(0.5), [255, 255, 191]);
        assert_eq!(
            (two_sided(0.0), two_sided(1.0)),
            ([69, 117, 180], [215, 48, 39])
        );
    }
}
