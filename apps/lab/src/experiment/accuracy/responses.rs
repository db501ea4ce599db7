//! Compares impulse responses with image sources: the error of their figures, and the computation time.
//!
//! The test room measures 8 × 3 × 5 m, has an absorption that differs by wall and band (0.1 to 0.43), and is traced
//! with 4,096 to 262,144 waves. Each error is the largest over the bands that have the figure; the number of these
//! bands is reported. The errors are compared with the just noticeable differences: 5 % in reverberation times, 1 dB in
//! clarity and strength (ISO 3382-1:2009, annex A, table A.1).

use super::report::{AccuracyReport, ResponseRow};
use crate::columns;
use crate::experiment::plot::{
    HYBRID, LogAxis, MARCH, Panel, Point, Stroke, THESIS, chart, draw_legend, draw_line,
};
use crate::report::{Column, PlotError, Row};
use crate::stats::median;
use echomarch::Error;
use echomarch::bands::{BAND_COUNT, Bands};
use echomarch::geometry::ShoeboxEnergies;
use echomarch::response::{BandFigures, Figures, Response, ResponseSettings};
use echomarch::scene::{Listener, Scene, Source};
use echomarch::tracer::{Profile, Settings, Tracer};
use glam::Vec3;
use plotters::prelude::*;

/// Numbers of waves.
const WAVES: [u32; 4] = [1 << 12, 1 << 14, 1 << 16, 1 << 18];

/// Profiles that compute responses.
const PROFILES: [Profile; 2] = [Profile::Hybrid, Profile::March];

/// Number of runs per case; the median time is reported. The first run includes shader compilation.
const RUNS: usize = 4;

/// Length of the response in seconds: the time of a decay by 60 dB, plus a quarter.
const SECONDS: f64 = 1.2;

/// Just noticeable differences: relative for times, in decibels for levels.
const NOTICED_TIME: f64 = 0.05;
const NOTICED_DB: f64 = 1.0;

const SIZE: Vec3 = Vec3::new(8.0, 3.0, 5.0);
const SOURCE: Vec3 = Vec3::new(-2.0, 0.0, -1.5);
const LISTENER: Vec3 = Vec3::new(2.0, -0.3, 1.5);

/// Absorption of the walls at −x, +x, −y, +y, −z, +z.
fn absorption() -> [Bands; 6] {
    [0.6, 1.3, 1.5, 0.7, 1.1, 0.8]
        .map(|wall| std::array::from_fn(|band| 0.2 * wall * (0.8 + 0.09 * band as f64)))
}

fn room() -> Scene {
    let (source, listener) = (Source::at(SOURCE), Listener::at(LISTENER, 0.3));
    Scene::shoebox(SIZE, &absorption(), source, listener)
}

/// The exact figures, computed from image sources.
fn truth(speed: f64) -> Result<Figures, Error> {
    let [size, source, listener] = [SIZE, SOURCE, LISTENER].map(|v| v.as_dvec3());
    let Some(exact) = ShoeboxEnergies::new(size, source, listener, &absorption()) else {
        unreachable!("the room is a room");
    };
    Ok(Figures::of_image_sources(&exact, speed, SECONDS)?)
}

/// Number of calls of `step` in [`measure`].
pub(super) const STEPS: u64 = (WAVES.len() * PROFILES.len()) as u64;

/// Traces the room with every combination of profile and number of waves.
pub(super) fn measure(
    tracer: &mut Tracer,
    step: &mut dyn FnMut(),
) -> Result<Vec<ResponseRow>, Error> {
    let scene = room();
    let truth = truth(scene.speed_of_sound())?;
    let mut rows = Vec::new();
    for profile in PROFILES {
        for waves in WAVES {
            let settings = ResponseSettings::default()
                .with_trace(Settings::new(profile).with_waves(waves))
                .with_seconds(SECONDS);
            let mut response = Response::trace(tracer, &scene, &settings)?;
            let mut times = Vec::new();
            for _ in 1..RUNS {
                response = Response::trace(tracer, &scene, &settings)?;
                times.push(response.milliseconds);
            }
            rows.push(row(
                profile,
                waves,
                median(times),
                &truth,
                &response.figures,
            ));
            step();
        }
    }
    Ok(rows)
}

fn row(
    profile: Profile,
    waves: u32,
    milliseconds: f64,
    truth: &Figures,
    found: &Figures,
) -> ResponseRow {
    let worst = |figure: fn(&BandFigures) -> Option<f64>, is_share: bool| {
        let of_band = |band: usize| {
            let truth = figure(&truth.bands[band])?;
            let off = (figure(&found.bands[band])? - truth).abs();
            Some(if is_share { off / truth } else { off })
        };
        (0..BAND_COUNT).filter_map(of_band).reduce(f64::max)
    };
    ResponseRow {
        profile: profile.to_string(),
        waves,
        milliseconds,
        t30_error: worst(|band| band.t30_s, true),
        edt_error: worst(|band| band.edt_s, true),
        c80_error_db: worst(|band| band.c80_db, false),
        g_error_db: worst(|band| band.g_db, false),
        t30_bands: found.bands.iter().filter(|b| b.t30_s.is_some()).count(),
    }
}

impl Row for &ResponseRow {
    fn columns() -> Vec<Column<Self>> {
        let percent = |share: Option<f64>| share.map(|share| 100.0 * share);
        columns! { row: &ResponseRow;
            ("profile", "profile") => &row.profile, text();
            ("waves", "waves") => row.waves;
            ("milliseconds", "response") => row.milliseconds, unit("ms").fixed(0);
            ("t30_error", "T30 off") => percent(row.t30_error), unit("%").fixed(2);
            ("edt_error", "EDT off") => percent(row.edt_error), unit("%").fixed(2);
            ("c80_error_db", "C80 off") => row.c80_error_db, unit("dB").fixed(3);
            ("g_error_db", "G off") => row.g_error_db, unit("dB").fixed(3);
            ("t30_bands", "bands with T30") => row.t30_bands as u64;
        }
    }
}

type Figure = fn(&ResponseRow) -> Option<f64>;

/// A line of the plot: its name, its colour, and the error that it shows.
type Drawn = (&'static str, RGBColor, Figure);

/// Plots the errors of times and of levels against milliseconds, with lines at the just noticeable differences.
pub(super) fn plot(
    [left, right, legend]: [&Panel; 3],
    report: &AccuracyReport,
) -> Result<(), PlotError> {
    let times: [Drawn; 2] = [
        ("T30", HYBRID, |row| row.t30_error),
        ("EDT", MARCH, |row| row.edt_error),
    ];
    let levels: [Drawn; 2] = [
        ("C80", HYBRID, |row| row.c80_error_db),
        ("G", MARCH, |row| row.g_error_db),
    ];
    let share = "error of T30 and EDT as a share, hybrid";
    panel(left, report, share, &times, NOTICED_TIME)?;
    let decibels = "error of C80 and G, dB, hybrid";
    panel(right, report, decibels, &levels, NOTICED_DB)?;
    let line = |name: String, colour: RGBColor| (name, Stroke::solid(colour, 2));
    let entries = [
        line("T30; C80".to_owned(), HYBRID),
        line("EDT; G".to_owned(), MARCH),
        ("just noticeable".to_owned(), NOTICED),
    ];
    draw_legend(legend, &entries)
}

const NOTICED: Stroke = Stroke::new(THESIS, 2, Some((8, 6)));

fn panel(
    panel: &Panel,
    report: &AccuracyReport,
    what: &str,
    lines: &[Drawn],
    noticed: f64,
) -> Result<(), PlotError> {
    let hybrid = Profile::Hybrid.to_string();
    let of_profile = report.responses.iter().filter(|row| row.profile == hybrid);
    let rows: Vec<&ResponseRow> = of_profile.collect();
    let points = |figure: Figure| -> Vec<Point> {
        let point = |row: &&ResponseRow| Some((row.milliseconds, figure(row)?));
        rows.iter().filter_map(point).collect()
    };
    let all: Vec<Point> = lines.iter().flat_map(|line| points(line.2)).collect();
    let x = LogAxis::around(all.iter().map(|point| point.0));
    let y = LogAxis::around(all.iter().map(|point| point.1).chain([noticed]));
    let axes = ["milliseconds per response", what];
    let mut chart = chart(panel, "responses of a room", [x, y], axes)?;
    let first = rows.iter().map(|row| row.milliseconds);
    let from = first.fold(x.end(), f64::min);
    draw_line(
        &mut chart,
        vec![(from, noticed), (x.end(), noticed)],
        NOTICED,
    )?;
    for (_, colour, figure) in lines {
        let placed = points(*figure).into_iter().map(|p| (p.0, y.place(p.1)));
        draw_line(&mut chart, placed.collect(), Stroke::solid(*colour, 2))?;
    }
    Ok(())
}
