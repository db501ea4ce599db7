//! Directivities of sources from SOFA files.
//!
//! Supports two conventions:
//!
//! - **FreeFieldDirectivityTF** (AES69-2022): the spectra `Data.Real` + i `Data.Imag` \[M\]\[R\]\[N\] at the
//!   frequencies `N` in hertz, of M measurements with R receivers around the source. The direction of a receiver is
//!   that from `SourcePosition` to `ReceiverPosition`, which is relative to `ListenerPosition` and its axes, in the
//!   axes of `SourceView` and `SourceUp`. If several measurements have the same direction, such as those of different
//!   notes, the mean of their energies is used.
//! - **SimpleFreeFieldHRIR**: the mean energy of both ears against direction. By reciprocity these are the energies
//!   that the ears would radiate. If several measurements have the same direction, the farthest one is used.
//!
//! The energy of an octave band is the mean of the squared amplitudes at the file's frequencies from 1/√2 to √2 times
//! the centre frequency. A band without a frequency has the energy of the nearest band that has one, the lower of two.

use super::variables::wrong_convention;
use super::{Kind, SofaError, SofaProblem};
use super::{Variables, axes, bad_shape, bad_value, caught, measurements, read, vectors};
use crate::bands::{BAND_COUNT, BANDS_HZ, Bands};
use crate::hrtf::{Balloon, BalloonError, HrirError, HrirSet, MeasuredHrir, facets};
use glam::DVec3;
use rayon::prelude::*;
use realfft::RealFftPlanner;
use std::f64::consts::SQRT_2;
use std::path::Path;

/// The supported conventions, as text of an error.
const CONVENTIONS: &str = "FreeFieldDirectivityTF or SimpleFreeFieldHRIR";

/// Maximum number of frequencies of a file. A spectrum of an impulse response of 2 s at 48 kHz has this number.
const MAX_FREQUENCIES: usize = 1 << 16;

/// Largest step between the frequencies of an impulse response's spectrum, in hertz: the narrowest octave, 44 to 89 Hz,
/// has five frequencies or more.
const FREQUENCY_STEP_HZ: f64 = 8.0;

/// Directions with the energies of their octave bands, in any unit.
type Measured = Vec<(DVec3, Bands)>;

/// Reads a directivity from a SOFA file; the name of the directivity is the path.
///
/// # Errors
/// The file and the problem with it.
pub(crate) fn read_balloon(path: &Path) -> Result<Balloon, SofaError> {
    read(path, |bytes| from_bytes(&path.display().to_string(), bytes))
}

/// The directivity in the bytes of a file.
pub(super) fn from_bytes(name: &str, bytes: Vec<u8>) -> Result<Balloon, SofaProblem> {
    let measured = caught(|| measured(&Variables::open(bytes)?))?;
    Balloon::new(name, measured).map_err(|source| SofaProblem::Balloon { source })
}

fn measured(file: &Variables) -> Result<Measured, SofaProblem> {
    file.expect_global("Conventions", "SOFA")?;
    let convention = file.global("SOFAConventions")?;
    match convention.as_deref() {
        Some("FreeFieldDirectivityTF") => of_spectra(file),
        Some("SimpleFreeFieldHRIR") => {
            let (rate_hz, measured) = measurements(file)?;
            of_responses(rate_hz, &measured)
        }
        _ => Err(wrong_convention("SOFAConventions", convention, CONVENTIONS)),
    }
}

/// The measurements of a file of the convention FreeFieldDirectivityTF.
fn of_spectra(file: &Variables) -> Result<Measured, SofaProblem> {
    file.expect_global("DataType", "TF")?;
    let [count, receivers, frequencies] = shape_of_spectra(file)?;
    let bands = FrequencyBands::of(&frequencies_hz(file, frequencies)?)?;
    let directions = directions(file, count, receivers)?;
    let values = count * receivers * frequencies;
    let real = file.samples("Data.Real", values)?;
    let imaginary = file.samples("Data.Imag", values)?;
    let spectra = real
        .chunks_exact(frequencies)
        .zip(imaginary.chunks_exact(frequencies));
    let energies = spectra.map(|(real, imaginary)| {
        let energy = |at: usize| f64::from(real[at]).powi(2) + f64::from(imaginary[at]).powi(2);
        bands.energies(energy)
    });
    Ok(directions.into_iter().zip(energies).collect())
}

/// The numbers of measurements, receivers and frequencies, each at least 1, of variables that are not too large.
fn shape_of_spectra(file: &Variables) -> Result<[usize; 3], SofaProblem> {
    const EXPECTED: &str = "measurements × receivers × frequencies";
    let shape = file.shape("Data.Real")?;
    let [count, receivers, frequencies] = shape[..] else {
        return Err(bad_shape("Data.Real", &shape, EXPECTED));
    };
    if file.shape("Data.Imag")? != shape {
        let shape = file.shape("Data.Imag")?;
        return Err(bad_shape("Data.Imag", &shape, "that of Data.Real"));
    }
    let directions = count.saturating_mul(receivers);
    if directions == 0 || directions > Balloon::MAX_DIRECTIONS as u64 {
        let count = usize::try_from(directions).unwrap_or(usize::MAX);
        let source = BalloonError::BadCount { count };
        return Err(SofaProblem::Balloon { source });
    }
    if frequencies == 0 || frequencies > MAX_FREQUENCIES as u64 {
        let reason =
            format!("it has {frequencies} frequencies: there must be 1 to {MAX_FREQUENCIES}");
        return Err(bad_value("Data.Real", reason));
    }
    let values = directions * frequencies;
    if values > HrirSet::MAX_VALUES {
        let most = HrirSet::MAX_VALUES;
        let reason = format!("it has {values} numbers: there must be at most {most}");
        return Err(bad_value("Data.Real", reason));
    }
    Ok([count as usize, receivers as usize, frequencies as usize])
}

fn frequencies_hz(file: &Variables, count: usize) -> Result<Vec<f64>, SofaProblem> {
    const NAME: &str = "N";
    let shape = file.shape(NAME)?;
    if shape.iter().product::<u64>() != count as u64 {
        return Err(bad_shape(NAME, &shape, "one number for each frequency"));
    }
    if let Some(units) = file.attribute(NAME, "Units")?
        && !units.eq_ignore_ascii_case("hertz")
    {
        let reason = format!("its unit is {units:?}, not \"hertz\"");
        return Err(bad_value(NAME, reason));
    }
    file.numbers(NAME, count)
}

/// The direction of each receiver in the axes of the source, for each measurement.
fn directions(file: &Variables, count: usize, receivers: usize) -> Result<Vec<DVec3>, SofaProblem> {
    let source = vectors(file, "SourcePosition", count, Some(DVec3::ZERO))?;
    let source_view = vectors(file, "SourceView", count, Some(DVec3::X))?;
    let source_up = vectors(file, "SourceUp", count, Some(DVec3::Z))?;
    let listener = vectors(file, "ListenerPosition", count, Some(DVec3::ZERO))?;
    let listener_view = vectors(file, "ListenerView", count, Some(DVec3::X))?;
    let listener_up = vectors(file, "ListenerUp", count, Some(DVec3::Z))?;
    let positions = Receivers::of(file, count, receivers)?;
    let mut directions = Vec::with_capacity(count * receivers);
    for index in 0..count {
        let of_source = axes("SourceView", source_view[index], source_up[index])?;
        let of_listener = axes("ListenerView", listener_view[index], listener_up[index])?;
        for receiver in 0..receivers {
            let position = listener[index] + of_listener * positions.at(receiver, index);
            directions.push(of_source.transpose() * (position - source[index]));
        }
    }
    Ok(directions)
}

/// The positions of the receivers, relative to the listener.
struct Receivers {
    numbers: Vec<f64>,
    kind: Kind,
    /// Number of positions of a receiver: 1, or one for each measurement.
    per_receiver: usize,
}

impl Receivers {
    fn of(file: &Variables, count: usize, receivers: usize) -> Result<Receivers, SofaProblem> {
        const NAME: &str = "ReceiverPosition";
        let shape = file.shape(NAME)?;
        let (found, per_receiver) = match shape[..] {
            [found, 3] => (found, 1),
            [found, 3, measurements] => (found, measurements),
            _ => (0, 0),
        };
        let is_right =
            found == receivers as u64 && (per_receiver == 1 || per_receiver == count as u64);
        if !is_right {
            return Err(bad_shape(
                NAME,
                &shape,
                "receivers × 3, for one or all measurements",
            ));
        }
        let per_receiver = per_receiver as usize;
        Ok(Receivers {
            numbers: file.numbers(NAME, 3 * receivers * per_receiver)?,
            kind: Kind::of(file, NAME)?,
            per_receiver,
        })
    }

    fn at(&self, receiver: usize, measurement: usize) -> DVec3 {
        let measurement = measurement.min(self.per_receiver - 1);
        let number = |axis: usize| {
            let at = (3 * receiver + axis) * self.per_receiver + measurement;
            self.numbers[at]
        };
        self.kind.cartesian(std::array::from_fn(number))
    }
}

/// The energies of the impulse responses, averaged over both ears.
fn of_responses(rate_hz: u32, measured: &[MeasuredHrir]) -> Result<Measured, SofaProblem> {
    if !HrirSet::RATES_HZ.contains(&rate_hz) {
        let source = HrirError::BadRate { rate_hz };
        return Err(SofaProblem::Set { source });
    }
    let units: Vec<DVec3> = measured.iter().map(|one| one.from.normalize()).collect();
    let kept = facets::distinct(&units);
    let rate_hz = f64::from(rate_hz);
    let samples = measured.first().map_or(0, |first| first.ears[0].len());
    let length = samples.max((rate_hz / FREQUENCY_STEP_HZ) as usize);
    let transform = RealFftPlanner::<f64>::new().plan_fft_forward(length.next_power_of_two());
    let step_hz = rate_hz / transform.len() as f64;
    let hertz = (0..=transform.len() / 2).map(|bin| bin as f64 * step_hz);
    let bands = FrequencyBands::of(&hertz.collect::<Vec<f64>>())?;
    let energies = |index: usize| {
        let mut sum = vec![0.0; transform.len() / 2 + 1];
        for ear in &measured[index].ears {
            let mut padded = transform.make_input_vec();
            let mut spectrum = transform.make_output_vec();
            for (padded, sample) in padded.iter_mut().zip(ear) {
                *padded = f64::from(*sample);
            }
            // The lengths are those that the transform requires.
            if transform.process(&mut padded, &mut spectrum).is_ok() {
                let squares = spectrum.iter().map(|value| value.norm_sqr());
                sum.iter_mut()
                    .zip(squares)
                    .for_each(|(sum, more)| *sum += more);
            }
        }
        (units[index], bands.energies(|bin| sum[bin]))
    };
    Ok(kept.into_par_iter().map(energies).collect())
}

/// The frequencies of each octave band, as indices.
struct FrequencyBands([Vec<usize>; BAND_COUNT]);

impl FrequencyBands {
    /// Sorts frequencies in hertz into bands. A band without a frequency gets those of the nearest band.
    fn of(hertz: &[f64]) -> Result<FrequencyBands, SofaProblem> {
        let in_band = |centre: f64| -> Vec<usize> {
            let band = centre / SQRT_2..centre * SQRT_2;
            let inside = hertz.iter().enumerate().filter(|(_, f)| band.contains(f));
            inside.map(|(index, _)| index).collect()
        };
        let own = BANDS_HZ.map(in_band);
        let nearest = |band: usize| {
            let filled = (0..BAND_COUNT).filter(|other| !own[*other].is_empty());
            filled.min_by_key(|other| other.abs_diff(band))
        };
        if nearest(0).is_none() {
            let reason = "no frequency is in the octave bands of 63 Hz to 8 kHz".into();
            return Err(bad_value("N", reason));
        }
        let filled = std::array::from_fn(|band| own[nearest(band).unwrap_or(band)].clone());
        Ok(FrequencyBands(filled))
    }

    /// The mean energy of each band, from the energy at each frequency.
    fn energies(&self, energy: impl Fn(usize) -> f64) -> Bands {
        std::array::from_fn(|band| {
            let all = &self.0[band];
            all.iter().map(|at| energy(*at)).sum::<f64>() / all.len() as f64
        })
    }
}

#[cfg(test)]
mod tests;
