//! Impulse responses as a SOFA file of the convention SingleRoomSRIR 1.0 (AES69-2022), in netCDF-4.
//!
//! One file has one measurement for each pair of source and listener (dimension M), and one receiver for each channel
//! (R). Positions and directions are those of the scene in the axes of SOFA: x is the scene's −z, y is −x, z is y.

use super::{Format, ImpulseResponse, ListenerAxes, ResponseError};
use crate::file_output::write_whole;
use crate::hrtf::{SofaError, SofaProblem};
use crate::scene::{Pair, Source};
use chrono::Utc;
use glam::DVec3;
use netcdf_writer::{DimensionId, Error, NcAttrValue};
use netcdf_writer::{NcFileBuilder, NcWriteFormat, NcWriteOptions};
use std::path::Path;
use std::{io, iter};

/// Level of the lossless compression of the samples, 0 to 9. Higher levels take longer and save little, because the
/// samples are noise.
const DEFLATE_LEVEL: u8 = 4;

/// An impulse response, and the places and directions of its source and its listener.
///
/// ```
/// use echomarch::response::{Echogram, ImpulseResponse, ImpulseSettings, ListenerAxes, RoomMeasurement, Tap};
/// use echomarch::Scene;
/// use echomarch::glam::DVec3;
///
/// let scene = Scene::builtin("shoebox")?;
/// let pair = scene.only_pair()?;
/// let tap = Tap { seconds: 0.01, energy: [0.08; 8], direction: DVec3::X };
/// let axes = ListenerAxes::of(pair.listener())?;
/// let settings = ImpulseSettings::new(0.1);
/// let impulse = ImpulseResponse::new(&[tap], &Echogram::new(0.001, 1)?, &axes, &settings)?;
/// let file = std::env::temp_dir().join(format!("echomarch-room-{}.sofa", std::process::id()));
/// RoomMeasurement::write_sofa(&file, "shoebox", &[RoomMeasurement::of(pair, impulse)?])?;
/// # std::fs::remove_file(&file).unwrap();
/// # Ok::<(), echomarch::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct RoomMeasurement {
    /// Names of the source and the listener, for the comment of the file.
    pub name: String,
    /// Position of the source in metres, world axes.
    pub source_position: DVec3,
    /// Axes of the source.
    pub source_axes: ListenerAxes,
    /// Position of the listener in metres, world axes.
    pub listener_position: DVec3,
    /// Axes of the listener.
    pub listener_axes: ListenerAxes,
    /// The impulse response.
    pub impulse: ImpulseResponse,
}

impl RoomMeasurement {
    /// Maximum number of samples of all measurements of a file, 2^27. They take 1 GiB before compression.
    pub const MOST_SAMPLES: usize = 134_217_728;

    /// The impulse response of a pair.
    ///
    /// # Errors
    /// [`ResponseError::BadAxes`] if the axes of the source or the listener are not finite.
    pub fn of(pair: Pair, impulse: ImpulseResponse) -> Result<RoomMeasurement, ResponseError> {
        let (source, listener) = (pair.source(), pair.listener());
        let (source_index, listener_index) = pair.indices();
        let [mut sources, mut listeners] =
            [pair.scene().source_labels(), pair.scene().listener_labels()];
        let from = sources.swap_remove(source_index);
        let to = listeners.swap_remove(listener_index);
        Ok(RoomMeasurement {
            name: format!("{from} at {to}"),
            source_position: source.position.as_dvec3(),
            source_axes: axes_of(source)?,
            listener_position: listener.position.as_dvec3(),
            listener_axes: ListenerAxes::of(listener)?,
            impulse,
        })
    }

    /// Writes a SOFA file of the convention SingleRoomSRIR with these measurements. `title` names the scene. Shorter
    /// responses end with silence, so that all have the same number of samples.
    ///
    /// The channels of [`Format::AmbiX`] are spherical harmonics about the listener, in the order ACN with the
    /// normalisation SN3D. All other channels are receivers at the listener's position.
    ///
    /// # Errors
    /// [`SofaProblem::NotOneSet`] for no measurements, or for measurements with different rates or formats;
    /// [`SofaProblem::TooManySamples`] for more than [`RoomMeasurement::MOST_SAMPLES`]; [`SofaProblem::NotWritten`] if the
    /// file cannot be written.
    pub fn write_sofa(
        path: &Path,
        title: &str,
        measurements: &[RoomMeasurement],
    ) -> Result<(), SofaError> {
        let failed = |problem| SofaError {
            path: path.into(),
            problem,
        };
        let bytes = bytes(title, measurements).map_err(failed)?;
        write_whole(path, |out| out.write_all(&bytes)).map_err(|error| {
            failed(SofaProblem::NotWritten {
                reason: error.source,
            })
        })
    }
}

fn axes_of(source: &Source) -> Result<ListenerAxes, ResponseError> {
    ListenerAxes::new(source.forward().as_dvec3(), source.up().as_dvec3())
}

/// A vector of the world in the axes of SOFA.
fn in_sofa_axes(world: DVec3) -> [f64; 3] {
    // Adding zero turns -0 into 0.
    [-world.z + 0.0, -world.x + 0.0, world.y + 0.0]
}

/// The file's bytes.
fn bytes(title: &str, measurements: &[RoomMeasurement]) -> Result<Vec<u8>, SofaProblem> {
    let Some(first) = measurements.first() else {
        let what = "there are no measurements";
        return Err(SofaProblem::NotOneSet { what });
    };
    let (rate_hz, format) = (first.impulse.rate_hz(), first.impulse.format());
    let is_alike = |other: &RoomMeasurement| {
        other.impulse.rate_hz() == rate_hz && other.impulse.format() == format
    };
    if !measurements.iter().all(is_alike) {
        let what = "the measurements differ in rate or format";
        return Err(SofaProblem::NotOneSet { what });
    }
    let samples = measurements.len() * format.channels() * longest(measurements);
    if samples > RoomMeasurement::MOST_SAMPLES {
        return Err(SofaProblem::TooManySamples {
            samples,
            limit: RoomMeasurement::MOST_SAMPLES,
        });
    }
    write(title, format, measurements).map_err(|error| SofaProblem::NotWritten {
        reason: io::Error::other(error),
    })
}

/// Maximum length of the comment in bytes. An attribute of netCDF-4 has at most 64 KiB with its name.
const LONGEST_COMMENT: usize = 60_000;

/// The names of the measurements, by number, as many as fit.
fn comment(measurements: &[RoomMeasurement]) -> String {
    let mut comment = String::new();
    for (number, measured) in (1..).zip(measurements) {
        let name = format!("{number}: {}", measured.name);
        if comment.len() + name.len() > LONGEST_COMMENT {
            comment.push_str("; and so on");
            break;
        }
        let gap = if comment.is_empty() { "" } else { "; " };
        comment.extend([gap, &name]);
    }
    comment
}

/// The number of samples of the longest channel.
fn longest(measurements: &[RoomMeasurement]) -> usize {
    let channels = measurements.iter().flat_map(|one| one.impulse.channels());
    channels.map(Vec::len).max().unwrap_or(0)
}

fn write(title: &str, format: &Format, measurements: &[RoomMeasurement]) -> Result<Vec<u8>, Error> {
    let mut file = SofaBuilder::new(measurements.len(), format.channels(), longest(measurements))?;
    file.add_globals(title, format, &comment(measurements))?;
    file.add_places(measurements)?;
    file.add_receivers(format)?;
    file.add_samples(measurements)?;
    let options = NcWriteOptions {
        format: NcWriteFormat::Nc4,
    };
    Ok(file.file.to_vec(options)?.1)
}

/// A file with the dimensions of SOFA.
struct SofaBuilder {
    file: NcFileBuilder,
    /// The dimension 1.
    i: DimensionId,
    /// The coordinates of a position: 3.
    c: DimensionId,
    /// The measurements.
    m: DimensionId,
    /// The receivers.
    r: DimensionId,
    /// The emitters: 1.
    e: DimensionId,
    /// The samples.
    n: DimensionId,
    samples: usize,
}

impl SofaBuilder {
    fn new(measurements: usize, receivers: usize, samples: usize) -> Result<SofaBuilder, Error> {
        let mut file = NcFileBuilder::new();
        let mut dimension = |name, size: usize| file.add_dimension(name, size as u64);
        Ok(SofaBuilder {
            i: dimension("I", 1)?,
            c: dimension("C", 3)?,
            m: dimension("M", measurements)?,
            r: dimension("R", receivers)?,
            e: dimension("E", 1)?,
            n: dimension("N", samples)?,
            samples,
            file,
        })
    }

    fn add_globals(&mut self, title: &str, format: &Format, comment: &str) -> Result<(), Error> {
        let now = Utc::now().format("%Y-%m-%d %H:%M:%S").to_string();
        let globals = [
            ("Conventions", "SOFA"),
            ("Version", "2.1"),
            ("SOFAConventions", "SingleRoomSRIR"),
            ("SOFAConventionsVersion", "1.0"),
            ("DataType", "FIR"),
            ("RoomType", "reverberant"),
            ("RoomDescription", "a simulated scene"),
            ("Title", title),
            ("Comment", comment),
            ("DatabaseName", title),
            ("DateCreated", &now),
            ("DateModified", &now),
            ("APIName", "echomarch"),
            ("APIVersion", env!("CARGO_PKG_VERSION")),
            ("ApplicationName", "Echomarch"),
            ("ApplicationVersion", env!("CARGO_PKG_VERSION")),
            ("AuthorContact", ""),
            ("Organization", ""),
            (
                "License",
                "No license provided, ask the author for permission",
            ),
            ("ReceiverDescription", receivers(format)),
        ];
        for (name, value) in globals {
            self.file.add_attribute(name, text(value))?;
        }
        Ok(())
    }

    /// Adds the positions and axes of sources and listeners.
    fn add_places(&mut self, measurements: &[RoomMeasurement]) -> Result<(), Error> {
        let mut add = |name, unit: Units, vector: fn(&RoomMeasurement) -> DVec3| {
            let all = measurements.iter().map(vector).flat_map(in_sofa_axes);
            let all: Vec<f64> = all.collect();
            self.add_numbers(name, &[self.m, self.c], unit, &all)
        };
        add("ListenerPosition", Units::Cartesian, |one| {
            one.listener_position
        })?;
        add("ListenerView", Units::Cartesian, |one| {
            one.listener_axes.forward()
        })?;
        add("ListenerUp", Units::None, |one| one.listener_axes.up())?;
        add("SourcePosition", Units::Cartesian, |one| {
            one.source_position
        })?;
        add("SourceView", Units::Cartesian, |one| {
            one.source_axes.forward()
        })?;
        add("SourceUp", Units::None, |one| one.source_axes.up())
    }

    /// Adds the receivers at the centre of the listener, and the emitter at the centre of the source.
    fn add_receivers(&mut self, format: &Format) -> Result<(), Error> {
        let kind = match format {
            Format::AmbiX(_) => Units::SphericalHarmonics,
            Format::Mono | Format::Stereo | Format::Binaural(_) => Units::Cartesian,
        };
        let centres = vec![0.0; 3 * format.channels()];
        self.add_numbers(
            "ReceiverPosition",
            &[self.r, self.c, self.i],
            kind,
            &centres,
        )?;
        let emitter = [self.e, self.c, self.i];
        self.add_numbers("EmitterPosition", &emitter, Units::Cartesian, &[0.0; 3])
    }

    /// Adds the impulse responses. Each begins at the time of the source's impulse, without a further delay.
    fn add_samples(&mut self, measurements: &[RoomMeasurement]) -> Result<(), Error> {
        let samples = self.samples;
        let mut all = Vec::with_capacity(measurements.len() * samples);
        for channel in measurements.iter().flat_map(|one| one.impulse.channels()) {
            all.extend(channel.iter().copied().map(f64::from));
            all.extend(iter::repeat_n(0.0, samples - channel.len()));
        }
        let responses = self
            .file
            .add_variable::<f64>("Data.IR", &[self.m, self.r, self.n])?;
        self.file
            .set_variable_chunking(responses, [1, 1, samples as u64])?;
        self.file
            .set_variable_deflate(responses, Some(DEFLATE_LEVEL), true)?;
        self.file.write_variable(responses, &all)?;
        let rate_hz = measurements.first().map_or(0, |one| one.impulse.rate_hz());
        self.add_numbers(
            "Data.SamplingRate",
            &[self.i],
            Units::Hertz,
            &[rate_hz.into()],
        )?;
        let receivers = measurements
            .first()
            .map_or(0, |one| one.impulse.channels().len());
        let delays = vec![0.0; receivers];
        self.add_numbers("Data.Delay", &[self.i, self.r], Units::None, &delays)
    }

    fn add_numbers(
        &mut self,
        name: &str,
        dimensions: &[DimensionId],
        units: Units,
        numbers: &[f64],
    ) -> Result<(), Error> {
        let variable = self.file.add_variable::<f64>(name, dimensions)?;
        for (attribute, value) in units.attributes() {
            self.file
                .add_variable_attribute(variable, *attribute, text(value))?;
        }
        self.file.write_variable(variable, numbers)
    }
}

/// The attributes of a variable.
#[derive(Clone, Copy)]
enum Units {
    Cartesian,
    SphericalHarmonics,
    Hertz,
    None,
}

impl Units {
    fn attributes(self) -> &'static [(&'static str, &'static str)] {
        match self {
            Units::Cartesian => &[("Type", "cartesian"), ("Units", "metre")],
            Units::SphericalHarmonics => &[
                ("Type", "spherical harmonics"),
                ("Units", "degree, degree, metre"),
            ],
            Units::Hertz => &[("Units", "hertz")],
            Units::None => &[],
        }
    }
}

fn text(value: &str) -> NcAttrValue {
    NcAttrValue::Chars(value.to_owned())
}

fn receivers(format: &Format) -> &'static str {
    match format {
        Format::Mono => "omnidirectional",
        Format::Stereo => "left, right",
        Format::Binaural(_) => "left ear, right ear",
        Format::AmbiX(_) => "ambisonics (AmbiX): ACN order, SN3D normalisation",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::response::{AmbisonicOrder, Echogram, ImpulseSettings, Tap};
    use hdf5_pure::File;

    /// A measurement with one tap after 10 ms, in a file of this length.
    fn measurement(seconds: f64, format: Format) -> RoomMeasurement {
        let tap = Tap {
            seconds: 0.01,
            energy: [0.08; 8],
            direction: DVec3::X,
        };
        let axes = ListenerAxes::new(DVec3::X, DVec3::Y).unwrap();
        let mut settings = ImpulseSettings::new(seconds);
        settings.format = format;
        let silence = Echogram::new(0.001, 1).unwrap();
        RoomMeasurement {
            name: "flute at seat".to_owned(),
            source_position: DVec3::new(1.0, 2.0, 3.0),
            source_axes: ListenerAxes::new(DVec3::NEG_Z, DVec3::Y).unwrap(),
            listener_position: DVec3::new(-4.0, 5.0, -6.0),
            listener_axes: axes,
            impulse: ImpulseResponse::new(&[tap], &silence, &axes, &settings).unwrap(),
        }
    }

    /// Protects programs that read the file: the shapes, the samples of a shorter response, and the axes of SOFA, read
    /// by another library than the one that wrote them.
    #[test]
    fn a_file_has_all_measurements_in_the_axes_of_sofa() {
        let order = Format::AmbiX(AmbisonicOrder::FIRST);
        let all = [0.1, 0.05].map(|seconds| measurement(seconds, order.clone()));
        let file = File::from_bytes(bytes("a room", &all).unwrap()).unwrap();
        let read = |name: &str| {
            let variable = file.dataset(name).unwrap();
            (variable.shape().unwrap(), variable.read_f64().unwrap())
        };
        let (shape, samples) = read("Data.IR");
        assert_eq!(shape, [2, 4, 4800]);
        let mut expected: Vec<f64> = Vec::new();
        for channel in all.iter().flat_map(|one| one.impulse.channels()) {
            let mut samples = channel.clone();
            samples.resize(4800, 0.0);
            expected.extend(samples.into_iter().map(f64::from));
        }
        assert_eq!(samples, expected);
        assert_eq!(
            read("SourcePosition"),
            (vec![2, 3], vec![-3.0, -1.0, 2.0, -3.0, -1.0, 2.0])
        );
        assert_eq!(read("ListenerPosition").1[..3], [6.0, 4.0, 5.0]);
        assert_eq!(read("SourceView").1[..3], [1.0, 0.0, 0.0]);
        assert_eq!(read("ListenerView").1[..3], [0.0, -1.0, 0.0]);
        assert_eq!(read("ListenerUp").1[..3], [0.0, 0.0, 1.0]);
        assert_eq!(read("ReceiverPosition"), (vec![4, 3, 1], vec![0.0; 12]));
        assert_eq!(read("Data.SamplingRate"), (vec![1], vec![48_000.0]));
        let globals = file.root().attrs().unwrap();
        assert_eq!(globals["SOFAConventions"].as_str(), Some("SingleRoomSRIR"));
        assert_eq!(globals["Title"].as_str(), Some("a room"));
        let names = "1: flute at seat; 2: flute at seat";
        assert_eq!(globals["Comment"].as_str(), Some(names));
    }

    /// Protects callers from files with mixed channels, and from empty files.
    #[test]
    fn measurements_of_different_formats_are_refused() {
        let mixed = [Format::Mono, Format::Stereo].map(|format| measurement(0.05, format));
        for measurements in [&mixed[..], &[]] {
            let refused = bytes("a room", measurements).unwrap_err();
            assert!(
                matches!(refused, SofaProblem::NotOneSet { .. }),
                "{refused}"
            );
        }
    }
}
