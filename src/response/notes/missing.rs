//! Notes on missing figures of a response: the reasons and the remedies.

use crate::bands::{BAND_COUNT, BANDS_HZ};
use crate::response::diagnosis::Gap;
use crate::response::figures::Withheld;
use crate::response::{BandFigures, Figures, Response};
use crate::scene::{Pair, Scene};
use crate::tracer::Settings;

/// Returns a sentence for each reason why figures are missing, with the affected bands.
pub(super) fn reasons(pair: Pair, response: &Response) -> Vec<String> {
    if response.counts.arrivals == 0 && response.paths.is_empty() {
        // Another note already reports that no sound arrives.
        return Vec::new();
    }
    let (scene, gaps) = (pair.scene(), response.gaps(pair));
    let told = |reason: Gap| {
        let of_reason = gaps.map(|gap| gap == Some(reason));
        of_reason
            .contains(&true)
            .then(|| sentence(scene, response, reason, of_reason))
    };
    Gap::ALL.into_iter().filter_map(told).collect()
}

fn sentence(
    scene: &Scene,
    response: &Response,
    reason: Gap,
    of_reason: [bool; BAND_COUNT],
) -> String {
    let seconds = response.seconds;
    let bands = bands(of_reason);
    let times = missing_among(&TIMES, &response.figures.bands, of_reason);
    match reason {
        Gap::Silence => format!("nothing arrives {bands}"),
        Gap::InSolid => {
            format!("nothing arrives {bands}: the source or the listener is in a solid")
        }
        Gap::TooShort if scene.has_materials() || scene.air.is_some() => format!(
            "sound continues after {seconds:.2} s {bands}, so figures are missing or inexact there: use a longer record (seconds)"
        ),
        Gap::TooShort => format!(
            "sound continues after {seconds:.2} s {bands}, so figures are missing or inexact there: nothing absorbs in this scene; give its surfaces a material (docs/scene-format.md)"
        ),
        Gap::NoLateSound => format!(
            "hardly anything arrives after the first 80 ms, so decay times are not defined: {times}"
        ),
        Gap::TooNoisy => {
            let noisy = too_noisy(response, of_reason);
            match noisy.is_empty() {
                true => format!("decay times are not defined: {times}"),
                false => format!("too noisy: {}", noisy.join("; ")),
            }
        }
    }
}

/// Why figures are withheld: the figures, their bands, the cause, and the number of waves that they take.
fn too_noisy(response: &Response, of_reason: [bool; BAND_COUNT]) -> Vec<String> {
    let figures = &response.figures;
    let most = f64::from(Settings::MAX_WAVES) / f64::from(response.waves.max(1));
    let names = ALL_FIGURES.iter().enumerate();
    let told = names.filter_map(|(figure, (name, _))| {
        let withheld: [Option<Withheld>; BAND_COUNT] =
            std::array::from_fn(|band| figures.withheld(band, figure).filter(|_| of_reason[band]));
        let is_withheld = withheld.map(|withheld| withheld.is_some());
        is_withheld.contains(&true).then(|| {
            let worst = withheld
                .iter()
                .flatten()
                .fold(None, |worst, one| Some(worse(worst, *one)));
            let factors = (0..BAND_COUNT).filter(|band| is_withheld[*band]);
            let factor = factors
                .filter_map(|band| figures.waves_to_report(band, figure))
                .fold(0.0, f64::max);
            (*name, is_withheld, cause(worst, factor, most))
        })
    });
    grouped(told)
}

/// Joins figures that are withheld in the same bands for the same cause.
fn grouped(told: impl Iterator<Item = (&'static str, [bool; BAND_COUNT], String)>) -> Vec<String> {
    let mut groups: Vec<(Vec<&str>, [bool; BAND_COUNT], String)> = Vec::new();
    for (name, of, cause) in told {
        match groups
            .iter_mut()
            .find(|group| group.1 == of && group.2 == cause)
        {
            Some(group) => group.0.push(name),
            None => groups.push((vec![name], of, cause)),
        }
    }
    let text = |(names, of, cause): &(Vec<&str>, [bool; BAND_COUNT], String)| {
        let colon = if cause.is_empty() { "" } else { ": " };
        format!("{} {}{colon}{cause}", listed(names), bands(*of))
    };
    groups.iter().map(text).collect()
}

/// The cause that takes more waves.
fn worse(known: Option<Withheld>, other: Withheld) -> Withheld {
    match (known, other) {
        (Some(Withheld::FewArrivals(a)), Withheld::FewArrivals(b)) => {
            Withheld::FewArrivals(a.min(b))
        }
        (Some(few @ Withheld::FewArrivals(_)), _) => few,
        (Some(Withheld::Noise(Some(a))), Withheld::Noise(Some(b))) => {
            Withheld::Noise(Some(a.max(b)))
        }
        (Some(Withheld::Noise(None)), Withheld::Noise(_)) => Withheld::Noise(None),
        _ => other,
    }
}

/// The least advised growth of the number of waves.
const LEAST_FACTOR: f64 = 1.1;

/// The cause, and the factor by which the number of waves must grow. `most` is the factor up to the maximum number.
fn cause(withheld: Option<Withheld>, factor: f64, most: f64) -> String {
    let cause = match withheld {
        Some(Withheld::FewArrivals(arrivals)) => format!(
            "{arrivals:.0} of {:.0} late arrivals",
            Figures::LEAST_ARRIVALS
        ),
        Some(Withheld::Noise(Some(share))) => {
            format!("standard error of {:.0} %", 100.0 * share)
        }
        Some(Withheld::Noise(None)) => "not defined for half of the waves".to_owned(),
        _ => "few arrivals".to_owned(),
    };
    match factor.is_finite() {
        true if factor.max(LEAST_FACTOR) > most => {
            format!("{cause}; needs more waves than can be traced")
        }
        true => format!(
            "{cause}; needs {:.1} times as many waves",
            factor.max(LEAST_FACTOR)
        ),
        false => format!("{cause}; no wave arrives after the end of the decay"),
    }
}

impl Figures {
    /// The figures that do not have this accuracy, with their bands: `T20 and T30 at 63 Hz; G in all bands`.
    #[doc(hidden)]
    pub fn inaccurate(&self, accuracy: f64) -> String {
        listed_where(|band, figure| self.is_accurate(accuracy, band, figure) == Some(false))
    }
}

/// Why figures do not have the requested accuracy.
pub(super) fn of_accuracy(pair: Pair, response: &Response) -> Vec<String> {
    let (Some(accuracy), figures) = (response.accuracy, &response.figures) else {
        return Vec::new();
    };
    let percent = (1e4 * accuracy).round() / 100.0;
    let mut texts = Vec::new();
    // Other notes are about figures that no number of waves gives.
    let open = listed_where(|band, figure| {
        let factor = figures.waves_to_report(band, figure);
        figures.is_accurate(accuracy, band, figure) == Some(false)
            && factor.is_none_or(f64::is_finite)
            && !figures.rests_on_few_waves(accuracy, band, figure)
    });
    let because = response.ended.map(|ended| format!(", because {ended}"));
    let because = because.unwrap_or_default();
    if !open.is_empty() {
        texts.push(format!(
            "the accuracy of {percent} % is not reached{because}: {open}"
        ));
    }
    let few = listed_where(|band, figure| figures.rests_on_few_waves(accuracy, band, figure));
    if !few.is_empty() {
        texts.push(format!(
            "± may be too small{because}: after the end of the decay few independent waves arrive (docs/acoustics.md#notes): {few}"
        ));
    }
    let limited = listed_where(|band, figure| figures.is_limited(accuracy, band, figure));
    if !limited.is_empty() {
        texts.push(format!(
            "± is above the accuracy of {percent} %, because it is more than noise: exact paths lead to the listener's centre, waves to its sphere of {} m, late arrivals to a larger sphere; more waves may not reduce ±, a smaller listener may (docs/acoustics.md#notes): {limited}",
            pair.listener().radius
        ));
    }
    texts
}

/// The figures for which `is_listed` holds, by index of the band and of the figure, with their bands.
fn listed_where(is_listed: impl Fn(usize, usize) -> bool) -> String {
    let names = ALL_FIGURES.iter().enumerate();
    let listed = names.filter_map(|(figure, (name, _))| {
        let of: [bool; BAND_COUNT] = std::array::from_fn(|band| is_listed(band, figure));
        of.contains(&true).then_some((*name, of, String::new()))
    });
    grouped(listed).join("; ")
}

/// A figure of a frequency band.
type Figure = fn(&BandFigures) -> Option<f64>;

const TIMES: [(&str, Figure); 3] = [
    ("EDT", |band| band.edt_s),
    ("T20", |band| band.t20_s),
    ("T30", |band| band.t30_s),
];

const ALL_FIGURES: [(&str, Figure); 8] = [
    TIMES[0],
    TIMES[1],
    TIMES[2],
    ("C50", |band| band.c50_db),
    ("C80", |band| band.c80_db),
    ("D50", |band| band.d50),
    ("Ts", |band| band.ts_s),
    ("G", |band| band.g_db),
];

/// Returns the figures that some bands lack, each with these bands. Figures that are missing in the same bands are
/// grouped.
fn missing_among(
    figures_named: &[(&'static str, Figure)],
    figures: &[BandFigures; BAND_COUNT],
    of_reason: [bool; BAND_COUNT],
) -> String {
    let mut told: Vec<(Vec<&str>, [bool; BAND_COUNT])> = Vec::new();
    for (name, figure) in figures_named {
        let lacks: [bool; BAND_COUNT] =
            std::array::from_fn(|band| of_reason[band] && figure(&figures[band]).is_none());
        match told.last_mut() {
            Some((names, bands)) if *bands == lacks => names.push(name),
            _ => told.push((vec![name], lacks)),
        }
    }
    let told = told.into_iter().filter(|(_, lacks)| lacks.contains(&true));
    let words = told.map(|(names, lacks)| format!("{} {}", listed(&names), bands(lacks)));
    words.collect::<Vec<_>>().join("; ")
}

/// Formats bands as text: `at 63 and 125 Hz`, `at 500 Hz, 1 and 2 kHz`, `in all bands`.
fn bands(of: [bool; BAND_COUNT]) -> String {
    const KILO: f64 = 1000.0;
    if of == [true; BAND_COUNT] {
        return "in all bands".to_owned();
    }
    let hz = || {
        BANDS_HZ
            .iter()
            .zip(of)
            .filter_map(|(hz, of)| of.then_some(*hz))
    };
    let low: Vec<String> = hz()
        .filter(|hz| *hz < KILO)
        .map(|hz| hz.to_string())
        .collect();
    let high = hz()
        .filter(|hz| *hz >= KILO)
        .map(|hz| (hz / KILO).to_string());
    let high: Vec<String> = high.collect();
    let parts = [(low, "Hz"), (high, "kHz")].into_iter();
    let parts = parts.filter(|(numbers, _)| !numbers.is_empty());
    let parts = parts.map(|(numbers, unit)| format!("{} {unit}", listed(&numbers)));
    format!("at {}", parts.collect::<Vec<_>>().join(", "))
}

/// Formats a list as text: `a`, `a and b`, `a, b and c`.
pub(super) fn listed(words: &[impl AsRef<str>]) -> String {
    let words: Vec<&str> = words.iter().map(AsRef::as_ref).collect();
    match words.split_last() {
        Some((last, [])) => (*last).to_owned(),
        Some((last, others)) => format!("{} and {last}", others.join(", ")),
        None => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(bands: &[usize]) -> [bool; BAND_COUNT] {
        std::array::from_fn(|band| bands.contains(&band))
    }

    /// Protects the reader from a note that contradicts the table: the note lists exactly the bands that have no
    /// reverberation time.
    #[test]
    fn a_time_is_named_with_the_bands_that_lack_it() {
        let mut whole = BandFigures::default();
        (whole.edt_s, whole.t20_s, whole.t30_s) = (Some(1.0), Some(1.0), Some(1.0));
        whole.c80_db = Some(3.0);
        let mut figures = [whole; BAND_COUNT];
        for figures in &mut figures[5..7] {
            figures.t30_s = None;
        }
        figures[5].t20_s = None;
        let told = missing_among(&TIMES, &figures, [true; BAND_COUNT]);
        assert_eq!(told, "T20 at 2 kHz; T30 at 2 and 4 kHz");
        // Bands that have another reason are omitted.
        assert_eq!(missing_among(&TIMES, &figures, of(&[6, 7])), "T30 at 4 kHz");
        let none = [BandFigures::default(); BAND_COUNT];
        let told = missing_among(&TIMES, &none, [true; BAND_COUNT]);
        assert_eq!(told, "EDT, T20 and T30 in all bands");
    }

    /// Protects the reader from advice that the program refuses: the factor is named only up to the maximum number of
    /// waves.
    #[test]
    fn a_number_of_waves_beyond_the_maximum_is_no_advice() {
        let few = Some(Withheld::FewArrivals(1.0));
        let within = cause(few, 400.0, 500.0);
        assert_eq!(
            within,
            "1 of 500 late arrivals; needs 400.0 times as many waves"
        );
        let beyond = cause(few, 501.0, 500.0);
        assert_eq!(
            beyond,
            "1 of 500 late arrivals; needs more waves than can be traced"
        );
    }

    /// Protects the formatting of band names.
    #[test]
    fn bands_are_in_hertz_and_kilohertz() {
        assert_eq!(bands([true; BAND_COUNT]), "in all bands");
        assert_eq!(bands(of(&[0, 1])), "at 63 and 125 Hz");
        assert_eq!(bands(of(&[2, 3, 4, 7])), "at 250 and 500 Hz, 1 and 8 kHz");
        assert_eq!(bands(of(&[4])), "at 1 kHz");
    }
}
