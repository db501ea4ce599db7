//! Plots the energy and its decay against time: the energy of each bin, the exact paths, the decay curve of each band,
//! and the time of the direct sound.

use super::plot::{Panel, Sheet, Stroke, builder, draw_legend, draw_line};
use crate::report::PlotError;
use echomarch::bands::{self, BAND_COUNT, BANDS_HZ, Bands};
#[cfg(doc)]
use echomarch::response::Figures;
use echomarch::response::Response;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use std::ops::Range;

const SHEET: Sheet = Sheet {
    width: 1100,
    title_height: 48,
    row_height: 380,
};

/// Width of the plots in pixels; the legend fills the remaining width.
const PLOTS_WIDTH: u32 = 900;

/// Range of the plots, in decibels below the maximum.
const DEPTH_DB: f64 = 80.0;

const ENERGY: RGBColor = RGBColor(150, 150, 150);
const PATHS: RGBColor = RGBColor(213, 94, 0);

/// Band colours from dark (low frequency) to light (high frequency), from the palette viridis. Neighbouring bands can
/// be distinguished, and the order is visible.
const BAND_COLOURS: [RGBColor; BAND_COUNT] = [
    RGBColor(68, 1, 84),
    RGBColor(70, 50, 126),
    RGBColor(54, 92, 141),
    RGBColor(39, 127, 142),
    RGBColor(31, 161, 135),
    RGBColor(74, 193, 109),
    RGBColor(160, 218, 57),
    RGBColor(223, 205, 20),
];

type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

/// The curves, in decibels against seconds.
struct Curves {
    /// The energy of each bin that is not empty, averaged over the bands.
    energy: Vec<(f64, f64)>,
    paths: Vec<(f64, f64)>,
    /// The remaining energy relative to the total. The total includes the estimated energy after the end of the
    /// response ([`Figures::cut_off`]).
    decay: [Vec<(f64, f64)>; BAND_COUNT],
}

/// The plot as SVG.
///
/// # Errors
/// If drawing fails. The error contains the reason.
pub fn svg(title: &str, response: &Response) -> Result<String, PlotError> {
    let curves = Curves::of(response);
    let direct_s = response.direct().map(|path| path.delay_s);
    SHEET.svg(title, 2, |rows| {
        let energies = || curves.energy.iter().chain(&curves.paths).map(|(_, db)| *db);
        let top = (energies().fold(-300.0, f64::max) / 10.0).ceil() * 10.0;
        let (plot, legend) = rows[0].split_horizontally(PLOTS_WIDTH);
        let range = top - DEPTH_DB..top;
        let name = "energy density, dB re 1/m²";
        let mut chart = empty(
            &plot,
            "Energy against time, mean of the bands",
            response.seconds,
            range.clone(),
            name,
        )?;
        let bottom = range.start;
        draw_stems(&mut chart, &curves.energy, bottom, ENERGY, 1)?;
        draw_stems(&mut chart, &curves.paths, bottom, PATHS, 2)?;
        mark_direct(&mut chart, direct_s, range)?;
        draw_legend(
            &legend,
            &[
                ("exact paths".to_owned(), Stroke::solid(PATHS, 2)),
                ("all else, by bin".to_owned(), Stroke::solid(ENERGY, 2)),
                ("direct sound".to_owned(), DIRECT),
            ],
        )?;
        plot_decay(&rows[1], &curves, response.seconds, direct_s)
    })
}

fn plot_decay(
    row: &Panel,
    curves: &Curves,
    seconds: f64,
    direct_s: Option<f64>,
) -> Result<(), PlotError> {
    let (plot, legend) = row.split_horizontally(PLOTS_WIDTH);
    let range = -DEPTH_DB..0.0;
    let name = "energy still to come, dB";
    let mut chart = empty(&plot, "Decay by band", seconds, range.clone(), name)?;
    let groups = equal_bands(&curves.decay);
    for bands in &groups {
        let points = curves.decay[bands.start].iter().copied();
        let inside = points.filter(|(_, db)| *db >= -DEPTH_DB);
        let style = BAND_COLOURS[bands.start].stroke_width(2);
        chart.draw_series(LineSeries::new(inside, style))?;
    }
    mark_direct(&mut chart, direct_s, range)?;
    let entry = |bands: &Range<usize>| (label(bands), Stroke::solid(BAND_COLOURS[bands.start], 2));
    let mut entries: Vec<(String, Stroke)> = groups.iter().map(entry).collect();
    entries.push(("direct sound".to_owned(), DIRECT));
    draw_legend(&legend, &entries)
}

/// Groups adjacent bands that have equal curves. Each group is drawn as one line, because the line of the last band
/// would hide the others.
fn equal_bands(decay: &[Vec<(f64, f64)>; BAND_COUNT]) -> Vec<Range<usize>> {
    let mut groups: Vec<Range<usize>> = Vec::new();
    for band in 0..BAND_COUNT {
        match groups.last_mut() {
            Some(group) if decay[group.start] == decay[band] => group.end = band + 1,
            _ => groups.push(band..band + 1),
        }
    }
    groups
}

fn label(bands: &Range<usize>) -> String {
    let [first, last] = [bands.start, bands.end - 1].map(|band| BANDS_HZ[band]);
    match bands.len() {
        1 => format!("{first} Hz"),
        _ => format!("{first} to {last} Hz"),
    }
}

const DIRECT: Stroke = Stroke::new(BLACK, 1, Some((5, 4)));

fn empty<'a, 'b>(
    panel: &'a Panel<'b>,
    caption: &str,
    seconds: f64,
    range: Range<f64>,
    name: &str,
) -> Result<Chart<'a, 'b>, PlotError> {
    let mut chart = builder(panel, caption).build_cartesian_2d(0.0..seconds, range)?;
    chart
        .configure_mesh()
        .x_desc("time after the source's impulse, s")
        .y_desc(name)
        .bold_line_style(BLACK.mix(0.15))
        .light_line_style(TRANSPARENT)
        .draw()?;
    Ok(chart)
}

/// Draws a vertical line from the bottom to each point.
fn draw_stems(
    chart: &mut Chart,
    points: &[(f64, f64)],
    bottom: f64,
    colour: RGBColor,
    width: u32,
) -> Result<(), PlotError> {
    let inside = points.iter().filter(|(_, db)| *db > bottom);
    let stem =
        |&(x, y): &(f64, f64)| PathElement::new([(x, bottom), (x, y)], colour.stroke_width(width));
    chart.draw_series(inside.map(stem))?;
    Ok(())
}

fn mark_direct(
    chart: &mut Chart,
    direct_s: Option<f64>,
    range: Range<f64>,
) -> Result<(), PlotError> {
    let Some(x) = direct_s else {
        return Ok(());
    };
    draw_line(chart, vec![(x, range.start), (x, range.end)], DIRECT)
}

impl Curves {
    fn of(response: &Response) -> Curves {
        let echogram = &response.echogram;
        let middle_s = |bin: usize| echogram.first_s() + (bin as f64 + 0.5) * echogram.bin_s();
        let bins = (0..echogram.bins()).map(|bin| (middle_s(bin), echogram.energy(bin)));
        let paths = response.paths.iter();
        let paths = paths.map(|path| (path.delay_s, path.energy));
        let mut pieces: Vec<(f64, Bands)> = bins.clone().chain(paths.clone()).collect();
        pieces.sort_by(|a, b| a.0.total_cmp(&b.0));
        let ends_s = response.followed_s.unwrap_or(response.seconds);
        pieces.retain(|(x, _)| *x < ends_s);
        let cut_off = |band: usize| response.figures.cut_off[band].unwrap_or(0.0);
        Curves {
            energy: in_db(bins),
            paths: in_db(paths),
            decay: std::array::from_fn(|band| decay(&pieces, band, cut_off(band))),
        }
    }
}

/// The energy of each piece in decibels, averaged over the bands. Empty pieces are excluded.
fn in_db(pieces: impl Iterator<Item = (f64, Bands)>) -> Vec<(f64, f64)> {
    let mean = pieces.map(|(x, bands)| (x, bands::mean(&bands)));
    let heard = mean.filter(|(_, energy)| *energy > 0.0);
    heard
        .map(|(x, energy)| (x, 10.0 * energy.log10()))
        .collect()
}

/// The energy that remains at each piece relative to the total, in decibels. `cut_off` is the share of the total that
/// arrives after the last piece.
fn decay(pieces: &[(f64, Bands)], band: usize, cut_off: f64) -> Vec<(f64, f64)> {
    let told: f64 = pieces.iter().map(|(_, bands)| bands[band]).sum();
    let all = told / (1.0 - cut_off);
    let mut to_come = cut_off * all;
    let mut curve: Vec<(f64, f64)> = Vec::new();
    for (x, bands) in pieces.iter().rev() {
        to_come += bands[band];
        if to_come > 0.0 {
            curve.push((*x, 10.0 * (to_come / all).log10()));
        }
    }
    curve.reverse();
    curve
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the decay curve: it begins with the total energy, and each step falls to the remaining energy.
    #[test]
    fn the_decay_falls_from_all_to_the_last() {
        let pieces = [
            (0.0, [9.0; BAND_COUNT]),
            (1.0, [0.9; BAND_COUNT]),
            (2.0, [0.1; BAND_COUNT]),
        ];
        let curve = decay(&pieces, 0, 0.0);
        let expected = [(0.0, 0.0), (1.0, -10.0), (2.0, -20.0)];
        for ((x, db), (at, level)) in curve.into_iter().zip(expected) {
            assert_eq!(x, at);
            assert!((db - level).abs() < 1e-9);
        }
        assert!(decay(&[(0.0, [0.0; BAND_COUNT])], 0, 0.0).is_empty());
        // A response that ends after 99 % of the energy has arrived.
        let curve = decay(&pieces[..2], 0, 0.01);
        let levels: Vec<f64> = curve.into_iter().map(|(_, db)| db).collect();
        assert!((levels[0] - 0.0).abs() < 1e-9 && (levels[1] + 10.0).abs() < 1e-9);
    }

    /// Protects a band from being hidden by another band with the same curve.
    #[test]
    fn equal_bands_are_one_line() {
        let curve = |db: f64| vec![(0.0, db)];
        let mut decay = [(); BAND_COUNT].map(|()| curve(-1.0));
        decay[3] = curve(-2.0);
        let labels: Vec<String> = equal_bands(&decay).iter().map(label).collect();
        assert_eq!(labels, ["63 to 250 Hz", "500 Hz", "1000 to 8000 Hz"]);
    }
}
