//! Why figures are missing from a response, and what helps.

use crate::acoustics::BandFigures;
use crate::bands::{BAND_COUNT, BANDS_HZ};
use crate::response::Response;
use crate::scene::Scene;

/// Share of the energy after the response's end above which it is reported: a tenth of what
/// figures allow.
const TOLD_CUT_OFF: f64 = 0.001;

/// Why a band has no time of decay.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Reason {
    /// The response ends before its sound has decayed.
    TooShort,
    /// Nothing arrives late enough for a clarity figure: there is no reverberation.
    NoLateSound,
    /// Sound decays, but there are too few waves to estimate the decay.
    TooNoisy,
}

/// A sentence for each reason why figures are missing, with the bands of which it is true.
pub fn reasons(scene: &Scene, response: &Response) -> Vec<String> {
    if response.counts.arrivals == 0 && response.paths.is_empty() {
        // That nothing arrives is told elsewhere.
        return Vec::new();
    }
    let figures = &response.figures;
    let of_bands: Vec<Option<Reason>> = (0..BAND_COUNT)
        .map(|band| reason(&figures.bands[band], figures.cut_off[band]))
        .collect();
    let told = |reason: Reason| {
        let bands = bands(&of_bands, reason)?;
        let of_reason = figures.bands.iter().zip(&of_bands);
        let of_reason = of_reason.filter(|(_, of)| **of == Some(reason));
        let times = missing_times(of_reason.map(|(figures, _)| figures));
        Some(sentence(scene, response, reason, &times, &bands))
    };
    let all = [Reason::TooShort, Reason::NoLateSound, Reason::TooNoisy];
    all.into_iter().filter_map(told).collect()
}

/// Why this band lacks a time of decay; `None` if it has all three.
fn reason(figures: &BandFigures, cut_off: Option<f64>) -> Option<Reason> {
    if cut_off.is_none_or(|share| share > TOLD_CUT_OFF) {
        return Some(Reason::TooShort);
    }
    let times = [figures.edt_s, figures.t20_s, figures.t30_s];
    if times.iter().all(Option::is_some) {
        return None;
    }
    match figures.c80_db {
        Some(_) => Some(Reason::TooNoisy),
        None => Some(Reason::NoLateSound),
    }
}

/// The bands with this reason, in words; `None` if there are none.
fn bands(of_bands: &[Option<Reason>], reason: Reason) -> Option<String> {
    let bands = BANDS_HZ.iter().zip(of_bands);
    let hertz: Vec<String> = bands
        .filter(|(_, of)| **of == Some(reason))
        .map(|(hz, _)| hz.to_string())
        .collect();
    match hertz.len() {
        0 => None,
        BAND_COUNT => Some("in all bands".to_owned()),
        _ => Some(format!("at {} Hz", hertz.join(", "))),
    }
}

/// The times of decay that one or more of these bands lack, in words.
fn missing_times<'a>(bands: impl Iterator<Item = &'a BandFigures> + Clone) -> String {
    let lacks = |of: fn(&BandFigures) -> Option<f64>| bands.clone().any(|band| of(band).is_none());
    let names: Vec<&str> = [
        ("EDT", lacks(|band| band.edt_s)),
        ("T20", lacks(|band| band.t20_s)),
        ("T30", lacks(|band| band.t30_s)),
    ]
    .into_iter()
    .filter_map(|(name, lacks)| lacks.then_some(name))
    .collect();
    match names.split_last() {
        Some((last, [])) => (*last).to_owned(),
        Some((last, others)) => format!("{} and {last}", others.join(", ")),
        None => String::new(),
    }
}

fn sentence(
    scene: &Scene,
    response: &Response,
    reason: Reason,
    times: &str,
    bands: &str,
) -> String {
    let seconds = response.seconds;
    match reason {
        Reason::TooShort if scene.has_materials() || scene.air.is_some() => format!(
            "sound continues after {seconds:.2} s {bands}, so figures are missing (—) or inexact there: use a larger --seconds"
        ),
        Reason::TooShort => format!(
            "sound continues after {seconds:.2} s {bands}, so figures are missing (—) or inexact there: nothing absorbs in this scene; give its surfaces a material (docs/scene-format.md)"
        ),
        Reason::NoLateSound => format!(
            "hardly anything arrives after the first 80 ms {bands}, so EDT, T20 and T30 cannot be determined (—)"
        ),
        Reason::TooNoisy => {
            format!("too noisy {bands} (—): {times}; use more --waves")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The advice follows from what is missing, and there is none where nothing is missing.
    #[test]
    fn each_missing_figure_has_its_reason() {
        let whole = BandFigures {
            edt_s: Some(1.0),
            t20_s: Some(1.0),
            t30_s: Some(1.0),
            c80_db: Some(3.0),
            ..BandFigures::default()
        };
        let noisy = BandFigures {
            t30_s: None,
            ..whole
        };
        let dry = BandFigures::default();
        assert_eq!(reason(&whole, Some(0.0)), None);
        assert_eq!(reason(&noisy, Some(0.0)), Some(Reason::TooNoisy));
        assert_eq!(reason(&dry, Some(0.0)), Some(Reason::NoLateSound));
        for figures in [whole, noisy, dry] {
            assert_eq!(reason(&figures, None), Some(Reason::TooShort));
            assert_eq!(reason(&figures, Some(0.002)), Some(Reason::TooShort));
        }
        let mut all = [Some(Reason::TooShort); BAND_COUNT];
        assert_eq!(bands(&all, Reason::TooShort).unwrap(), "in all bands");
        all[2..].fill(None);
        assert_eq!(bands(&all, Reason::TooShort).unwrap(), "at 63, 125 Hz");
        assert_eq!(bands(&all, Reason::TooNoisy), None);
        assert_eq!(missing_times([whole, noisy].iter()), "T30");
        assert_eq!(missing_times([dry, noisy].iter()), "EDT, T20 and T30");
    }
}
