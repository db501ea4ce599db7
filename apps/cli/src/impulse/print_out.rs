//! The output of `echomarch impulse`.

use super::super::numbers::tenths;
use super::super::print;
use super::notes;
use super::pairs::NamedPair;
use echomarch::bands::{self, BAND_COUNT, BANDS_HZ, Bands};
use echomarch::response::{BandFigures, Figures};
use echomarch::response::{HeardPath, PathKind, Response, ResponseSettings};
use echomarch::scene::Scene;
use echomarch_lab::columns;
use echomarch_lab::report::{Cell, Column, Row, Table};
use serde::{Serialize, Serializer};

/// Maximum number of paths in the text output. The JSON output lists all paths.
const PATHS_IN_TEXT: usize = 8;

/// The JSON output.
#[derive(Serialize)]
pub struct Report<'a> {
    scene: &'a str,
    renderer: &'a str,
    profile: String,
    /// Number of waves for late arrivals, the maximum of all pairs.
    waves: u32,
    /// The requested standard error of decay times, as a share; `null` for a given number of waves.
    accuracy: Option<f64>,
    seed: u32,
    directions: String,
    iterations: u32,
    seconds: f64,
    milliseconds: f64,
    pairs: Vec<PairReport<'a>>,
}

#[derive(Serialize)]
struct PairReport<'a> {
    source: &'a str,
    /// The kind of the source's directivity, as in a scene file, and the direction of the source's axis.
    directivity: &'static str,
    source_yaw_deg: f64,
    source_pitch_deg: f64,
    listener: &'a str,
    /// Number of waves for late arrivals.
    waves: u32,
    /// Number of waves for the first sixth of the record.
    onset_waves: u32,
    seconds: f64,
    iterations: u32,
    milliseconds: f64,
    /// The time origin of the figures, in seconds after the source's impulse, and its standard deviation; `null` if
    /// nothing arrives.
    time_origin_s: Option<f64>,
    time_origin_error_s: Option<f64>,
    bands_hz: Bands,
    #[serde(flatten)]
    figures: FigureReport<'a>,
    error: FigureReport<'a>,
    /// The share of the energy that would arrive after the end of the response.
    cut_off: [Option<f64>; BAND_COUNT],
    /// The share of the early energy that lies on paths found by no wave.
    missed_early_share: Option<f64>,
    /// The share of all energy that arrives after few reflections on paths that were not searched for.
    left_out_share: f64,
    /// The share of the directions in which no paths over planes were searched for.
    search_left_out_share: f64,
    /// The end of the time range in which the figures are valid, in seconds; `null` if they are valid for the whole
    /// response.
    followed_s: Option<f64>,
    /// Notes on missing or inexact figures, with remedies.
    notes: Vec<String>,
    direct: Option<DirectReport>,
    paths: Vec<PathReport<'a>>,
}

/// Figures by band, or the standard deviations of the figures.
struct FigureReport<'a>(&'a [BandFigures; BAND_COUNT]);

impl Serialize for FigureReport<'_> {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let by_band = |at: usize| self.0.iter().map(move |band| band.list()[at]);
        let names = BandFigures::NAMES.into_iter().enumerate();
        to.collect_map(names.map(|(at, name)| (name, by_band(at).collect::<Vec<_>>())))
    }
}

#[derive(Serialize)]
struct DirectReport {
    delay_s: f64,
    g_db: Option<f64>,
    azimuth_deg: f64,
    elevation_deg: f64,
}

#[derive(Serialize)]
struct PathReport<'a> {
    kind: PathKind,
    /// Number of reflections.
    order: usize,
    /// The indices in `surfaces` of the surfaces that reflect the path.
    reflections: &'a [usize],
    /// The surfaces that reflect, diffract or transmit the path, in order.
    surfaces: &'a [u32],
    /// The reflecting walls of rooms (left, right, floor, ceiling, front, back), and the groups of meshes.
    walls: Vec<Option<&'a str>>,
    delay_s: f64,
    /// Strength *G* of the mean energy of all bands.
    g_db: Option<f64>,
    g_db_bands: Vec<Option<f64>>,
    /// Half-widths of the intervals that contain 95 % of the errors of `g_db_bands`, in decibels, for paths
    /// that edges change.
    #[serde(skip_serializing_if = "Option::is_none")]
    errors_db: Option<Bands>,
    azimuth_deg: f64,
    elevation_deg: f64,
    is_focus: bool,
}

/// Returns the whole report.
pub fn report<'a>(
    scene: &'a Scene,
    renderer: &'a str,
    settings: &ResponseSettings,
    heard: &'a [(NamedPair, Response)],
) -> Report<'a> {
    let responses = || heard.iter().map(|(_, response)| response);
    Report {
        scene: &scene.name,
        renderer,
        profile: settings.trace.profile().to_string(),
        waves: responses().map(|r| r.waves).max().unwrap_or(0),
        accuracy: settings.accuracy.map(|accuracy| accuracy.share),
        seed: settings.trace.seed,
        directions: settings.trace.directions.to_string(),
        iterations: responses().map(|r| r.counts.iterations).max().unwrap_or(0),
        seconds: responses().map(|r| r.seconds).fold(0.0, f64::max),
        milliseconds: responses().map(|r| r.milliseconds).sum(),
        pairs: heard
            .iter()
            .map(|(pair, response)| of_pair(pair, response))
            .collect(),
    }
}

fn of_pair<'a>(pair: &'a NamedPair, response: &'a Response) -> PairReport<'a> {
    let Figures {
        bands,
        errors,
        cut_off,
        ..
    } = &response.figures;
    let source = pair.pair.source();
    let degrees = |radians: f32| f64::from(radians.to_degrees());
    PairReport {
        source: &pair.source,
        directivity: source.directivity.kind(),
        source_yaw_deg: degrees(source.yaw),
        source_pitch_deg: degrees(source.pitch),
        listener: &pair.listener,
        waves: response.waves,
        onset_waves: response.onset_waves,
        seconds: response.seconds,
        iterations: response.counts.iterations,
        milliseconds: response.milliseconds,
        time_origin_s: response.figures.begins_s,
        time_origin_error_s: response.figures.begins_error_s,
        bands_hz: BANDS_HZ,
        figures: FigureReport(bands),
        error: FigureReport(errors),
        cut_off: *cut_off,
        missed_early_share: response.missed.energy_share(),
        left_out_share: response.left_out_share,
        search_left_out_share: response.search_left_out_share,
        followed_s: response.followed_s,
        notes: notes::texts(pair.pair, response),
        direct: response.direct().map(|path| DirectReport {
            delay_s: path.delay_s,
            g_db: mean_strength_db(path),
            azimuth_deg: path.azimuth.to_degrees(),
            elevation_deg: path.elevation.to_degrees(),
        }),
        paths: response
            .paths
            .iter()
            .map(|path| of_path(pair.pair.scene(), path))
            .collect(),
    }
}

fn of_path<'a>(scene: &'a Scene, path: &'a HeardPath) -> PathReport<'a> {
    PathReport {
        kind: path.kind,
        order: path.reflections.len(),
        reflections: &path.reflections,
        surfaces: &path.path.surfaces,
        walls: wall_names(scene, path).collect(),
        delay_s: path.delay_s,
        g_db: mean_strength_db(path),
        g_db_bands: path
            .energy
            .iter()
            .map(|energy| Figures::strength_db(*energy))
            .collect(),
        errors_db: Some(path.errors_db).filter(|errors| errors.iter().any(|error| *error > 0.0)),
        azimuth_deg: path.azimuth.to_degrees(),
        elevation_deg: path.elevation.to_degrees(),
        is_focus: path.path.is_focus,
    }
}

/// Strength *G* of the mean energy of a path's bands, in decibels; `None` for silence.
fn mean_strength_db(path: &HeardPath) -> Option<f64> {
    Figures::strength_db(bands::mean(&path.energy))
}

/// The names of the walls, or of the groups of a mesh, that reflect a path; `None` for a surface without such parts.
fn wall_names<'a>(scene: &'a Scene, path: &'a HeardPath) -> impl Iterator<Item = Option<&'a str>> {
    let met = path.path.surfaces.iter().zip(&path.path.walls);
    met.map(|(surface, wall)| {
        let index = (*surface as usize).checked_sub(1)?;
        scene.surfaces.get(index)?.part_name(usize::from((*wall)?))
    })
}

/// One band of one pair: a row of the table.
struct BandRow {
    band_hz: f64,
    figures: BandFigures,
    errors: BandFigures,
}

/// The numbers of waves of a response.
fn waves(response: &Response) -> String {
    match response.onset_waves > response.waves {
        true => format!(
            "{} waves ({} in the onset)",
            response.waves, response.onset_waves
        ),
        false => format!("{} waves", response.waves),
    }
}

/// Prints the figures as text.
pub fn text(
    scene: &Scene,
    settings: &ResponseSettings,
    heard: &[(NamedPair, Response)],
) -> anyhow::Result<()> {
    for (pair, response) in heard {
        print::line(&format!(
            "{}: source {}, listener {}: {}, {} iterations, record {:.2} s, profile {}, seed {}",
            scene.name,
            pair.source,
            pair.listener,
            waves(response),
            response.counts.iterations,
            response.seconds,
            settings.trace.profile(),
            settings.trace.seed
        ))?;
        let rows = (0..BAND_COUNT).map(|band| BandRow {
            band_hz: BANDS_HZ[band],
            figures: response.figures.bands[band],
            errors: response.figures.errors[band],
        });
        print::line(&Table::of(rows).terminal())?;
        print_paths(scene, response)?;
        print::line(&format!("  computed in {:.0} ms", response.milliseconds))?;
    }
    Ok(())
}

impl Row for BandRow {
    fn columns() -> Vec<Column<BandRow>> {
        columns! { row: BandRow;
            ("band_hz", "band") => row.band_hz, unit("Hz").fixed(0);
            (_, "EDT") => time(row.figures.edt_s, row.errors.edt_s), unit("s");
            (_, "T20") => time(row.figures.t20_s, row.errors.t20_s), unit("s");
            (_, "T30") => time(row.figures.t30_s, row.errors.t30_s), unit("s");
            ("t30_error_s", "±") => row.errors.t30_s, unit("s").fixed(3);
            ("c80_db", "C80") => row.figures.c80_db, unit("dB").fixed(2);
            ("c80_error_db", "±") => row.errors.c80_db, unit("dB").fixed(2);
            ("g_db", "G") => row.figures.g_db, unit("dB").fixed(2);
            ("g_error_db", "±") => row.errors.g_db, unit("dB").fixed(2);
        }
    }
}

/// The standard error above which a decay time is marked as rough, as a share of the time.
const ROUGH: f64 = 0.015;

/// A decay time with its mark.
fn time(time_s: Option<f64>, error_s: Option<f64>) -> Cell {
    let Some(time_s) = time_s else {
        return Cell::None;
    };
    let is_rough = error_s.is_some_and(|error_s| error_s > ROUGH * time_s);
    Cell::Text(format!("{}{time_s:.3}", if is_rough { "~" } else { "" }))
}

fn print_paths(scene: &Scene, response: &Response) -> anyhow::Result<()> {
    let shown = response.paths.iter().take(PATHS_IN_TEXT);
    for path in shown {
        let labels = path.path.surface_labels(scene);
        let over = match path.kind {
            PathKind::Direct => "direct".to_owned(),
            PathKind::Diffracted => diffracted(&labels, &path.reflections),
            PathKind::Transmitted => format!("transmitted through {}", labels.join(", ")),
            PathKind::Added => "added up to the least level".to_owned(),
            _ => format!("over {}", labels.join(", ")),
        };
        let strength = mean_strength_db(path);
        print::line(&format!(
            "  {:9.3} ms  G {:>6} dB  azimuth {:+7.1}°, elevation {:+6.1}°  {over}",
            path.delay_s * 1e3,
            strength.map_or("−∞".to_owned(), |db| format!("{db:.2}")),
            tenths(path.azimuth.to_degrees()),
            tenths(path.elevation.to_degrees()),
        ))?;
    }
    match response.paths.len().saturating_sub(PATHS_IN_TEXT) {
        0 => Ok(()),
        more => print::line(&format!("  and {more} more exact paths (--json lists all)")),
    }
}

/// The words for a diffracted path. It is reflected at the surfaces with the indices `reflections`, and bends around
/// the others.
fn diffracted(surfaces: &[String], reflections: &[usize]) -> String {
    let all = surfaces.iter().enumerate();
    let (reflecting, bending): (Vec<_>, Vec<_>) =
        all.partition(|(index, _)| reflections.contains(index));
    let names = |part: Vec<(usize, &String)>| {
        let names: Vec<&str> = part.iter().map(|(_, name)| name.as_str()).collect();
        names.join(", ")
    };
    match reflecting.is_empty() {
        true => format!("diffracted around {}", names(bending)),
        false => format!(
            "diffracted around {}, over {}",
            names(bending),
            names(reflecting)
        ),
    }
}
