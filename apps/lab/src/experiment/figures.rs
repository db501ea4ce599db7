//! The performance experiment: figures 11.1 to 11.4 of the thesis (section 4.2).
//!
//! For each table and number of waves, one warm-up frame is followed by `runs` frames on the same textures. The frames
//! of the profiles run in turns. Times are medians. All runs use the same seed, so they have the same counts.

mod plot;
mod report;

use super::thesis_tables::{THESIS_TABLES, ThesisRow, ThesisTable, WAVE_COUNTS};
use echomarch::Error;
use echomarch::scene::Scene;
use echomarch::tracer::{Counts, Frame, Milliseconds, Settings, Tracer};
use serde::Serialize;

/// Duration of a frame at 30 frames per second in milliseconds: the thesis' criterion of real time.
pub const FRAME_BUDGET_MS: f64 = 1000.0 / 30.0;

/// The options of a run.
#[derive(Clone, Debug)]
pub struct FiguresOptions {
    /// The profiles to compare. The tables set the numbers of waves and iterations.
    pub profiles: Vec<Settings>,
    /// Maximum number of waves. Rows with more waves are omitted.
    pub max_waves: u32,
    /// Number of timed frames per row.
    pub runs: u32,
}

/// The measurements for all four tables.
#[derive(Clone, Debug, Serialize)]
pub struct FiguresReport {
    /// The renderer's name.
    pub renderer: String,
    /// The kind of clock that measured the times of the passes.
    pub clock: String,
    /// Number of timed frames per row.
    pub runs: u32,
    /// Seed of the directions.
    pub seed: u32,
    /// The tables, in the order of the thesis.
    pub tables: Vec<FigureTable>,
}

/// One table.
#[derive(Clone, Debug, Serialize)]
pub struct FigureTable {
    /// Number of the thesis' figure.
    pub figure: &'static str,
    /// The scene's name.
    pub scene: &'static str,
    /// Number of iterations of every wave.
    pub iterations: u32,
    /// The rows, ordered by number of waves, then by profile.
    pub rows: Vec<FigureRow>,
}

/// One row, with the thesis' row for comparison.
#[derive(Clone, Debug, Serialize)]
pub struct FigureRow {
    /// Name of the profile.
    pub profile: String,
    /// Number of waves.
    pub waves: u32,
    /// Median times over the runs.
    pub milliseconds: Milliseconds,
    /// Number of waves by final state.
    pub counts: Counts,
    /// Share of all iterations, over all waves, that ended at distance 0.
    pub zero_length_share: f64,
    /// The panning value.
    pub pan: f64,
    /// The corresponding row of the thesis.
    pub thesis: ThesisRow,
}

impl FigureRow {
    /// Difference between the listener hits and the thesis' hits, in standard errors. Hits are counts of rare
    /// independent events, so the standard error of the difference is the root of their sum.
    pub fn standard_errors(&self) -> f64 {
        let ours = self.counts.listener_hits as f64;
        let thesis = self.thesis.listener_hits as f64;
        if ours == thesis {
            return 0.0;
        }
        (ours - thesis) / (ours + thesis).sqrt()
    }
}

/// Runs the experiment. `progress` receives the number of completed rows and the total.
///
/// # Errors
/// Errors of [`Tracer::frame`].
pub fn run(
    tracer: &mut Tracer,
    options: &FiguresOptions,
    progress: &mut dyn FnMut(u64, u64),
) -> Result<FiguresReport, Error> {
    let counts: Vec<usize> = (0..WAVE_COUNTS.len())
        .filter(|&row| WAVE_COUNTS[row] <= options.max_waves)
        .collect();
    let total = (counts.len() * THESIS_TABLES.len()) as u64;
    let mut done = 0;
    let mut tables = Vec::new();
    for table in &THESIS_TABLES {
        let scene = Scene::builtin(table.scene)?;
        let mut rows = Vec::new();
        for &row in &counts {
            rows.extend(measure(tracer, &scene, table, row, options)?);
            done += 1;
            progress(done, total);
        }
        tables.push(FigureTable {
            figure: table.figure,
            scene: table.scene,
            iterations: table.iterations,
            rows,
        });
    }
    Ok(FiguresReport {
        renderer: tracer.context().renderer().to_owned(),
        clock: tracer.clock_name().to_owned(),
        runs: options.runs,
        seed: options.profiles.first().map_or(0, |s| s.seed),
        tables,
    })
}

fn measure(
    tracer: &mut Tracer,
    scene: &Scene,
    table: &ThesisTable,
    row: usize,
    options: &FiguresOptions,
) -> Result<Vec<FigureRow>, Error> {
    let settings: Vec<Settings> = options
        .profiles
        .iter()
        .map(|s| {
            s.clone()
                .with_waves(WAVE_COUNTS[row])
                .with_iterations(table.iterations)
        })
        .collect();
    for settings in &settings {
        tracer.frame(scene, settings)?;
    }
    let mut frames: Vec<Vec<Frame>> = vec![Vec::new(); settings.len()];
    for _ in 0..options.runs.max(1) {
        for (settings, frames) in settings.iter().zip(&mut frames) {
            frames.push(tracer.frame(scene, settings)?);
        }
    }
    let rows = settings.iter().zip(&frames);
    Ok(rows
        .map(|(settings, frames)| figure_row(settings, frames, table.rows[row]))
        .collect())
}

fn figure_row(settings: &Settings, frames: &[Frame], thesis: ThesisRow) -> FigureRow {
    let times: Vec<Milliseconds> = frames.iter().map(|frame| frame.milliseconds).collect();
    let counts = frames[0].counts;
    let passes = f64::from(settings.waves) * f64::from(settings.iterations);
    FigureRow {
        profile: settings.profile().to_string(),
        waves: settings.waves,
        milliseconds: Milliseconds::medians(&times),
        counts,
        zero_length_share: counts.zero_length_passes as f64 / passes,
        pan: frames[0].panning.pan(),
        thesis,
    }
}
