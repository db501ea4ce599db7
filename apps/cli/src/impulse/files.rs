//! The files of `echomarch impulse`.

use super::file_names::FileNames;
use super::pairs::NamedPair;
use super::{Arguments, is_sofa};
use anyhow::anyhow;
use echomarch::Error;
use echomarch::audio::WavWriter;
use echomarch::bands::BANDS_HZ;
use echomarch::internals::file_output::write_whole;
use echomarch::response::{
    BandFigures, Echogram, EchogramRow, Format, ImpulseResponse, ImpulseSettings, ListenerAxes,
    Response, RoomMeasurement,
};
use echomarch_lab::experiment::decay_plot;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Writes the echogram and the plot of a pair. `file_of` returns the pair's file for a file given on the command line.
pub fn write(
    arguments: &Arguments,
    pair: &NamedPair,
    response: &Response,
    file_of: impl Fn(&Path) -> PathBuf,
) -> anyhow::Result<()> {
    let file_of = |given: &Option<PathBuf>| given.as_deref().map(&file_of);
    if let Some(file) = file_of(&arguments.echogram) {
        write_whole(&file, |out| write_echogram(&response.echogram, out))?;
    }
    if let Some(file) = file_of(&arguments.plot) {
        let title = format!(
            "{}: source {}, listener {}",
            pair.pair.scene().name,
            pair.source,
            pair.listener
        );
        let svg = decay_plot::svg(&title, response);
        let svg = svg.map_err(|error| anyhow!("cannot draw the plot: {error}"))?;
        write_whole(&file, |out| out.write_all(svg.as_bytes()))?;
    }
    Ok(())
}

/// Writes the impulse responses of all pairs: one SOFA file, or one WAV file for each pair.
pub fn write_impulses(
    arguments: &Arguments,
    format: &Format,
    heard: &[(NamedPair, Response)],
    names: &FileNames,
) -> anyhow::Result<()> {
    let Some(output) = &arguments.output else {
        return Ok(());
    };
    if is_sofa(output) {
        return write_sofa(arguments, output, format, heard);
    }
    for (index, (pair, response)) in heard.iter().enumerate() {
        let impulse = impulse(arguments, format, pair, response)?;
        let channels = impulse.channels().len() as u16;
        let file = names.file(output, index);
        let mut wav = WavWriter::create_with_channels(file, arguments.rate, channels)?;
        wav.write(&impulse.interleaved())?;
        wav.finish()?;
    }
    Ok(())
}

fn write_sofa(
    arguments: &Arguments,
    file: &Path,
    format: &Format,
    heard: &[(NamedPair, Response)],
) -> anyhow::Result<()> {
    let seconds = heard.iter().map(|(_, response)| response.seconds);
    let longest_s = seconds.fold(0.0, f64::max);
    arguments.check_sofa(heard.len() * format.channels(), longest_s)?;
    let measured = heard.iter().map(|(pair, response)| {
        let impulse = impulse(arguments, format, pair, response)?;
        Ok(RoomMeasurement::of(pair.pair, impulse).map_err(Error::from)?)
    });
    let measured: Vec<RoomMeasurement> = measured.collect::<anyhow::Result<_>>()?;
    let title = heard
        .first()
        .map_or("", |(pair, _)| &pair.pair.scene().name);
    Ok(RoomMeasurement::write_sofa(file, title, &measured).map_err(Error::from)?)
}

fn impulse(
    arguments: &Arguments,
    format: &Format,
    pair: &NamedPair,
    response: &Response,
) -> anyhow::Result<ImpulseResponse> {
    let axes = ListenerAxes::of(pair.pair.listener()).map_err(Error::from)?;
    let mut settings = ImpulseSettings::new(response.seconds);
    settings.rate_hz = arguments.rate;
    settings.format = format.clone();
    settings.seed = arguments.seed.into();
    let impulse = ImpulseResponse::new(&response.taps(), &response.echogram, &axes, &settings);
    Ok(impulse.map_err(Error::from)?)
}

fn write_echogram(echogram: &Echogram, out: &mut dyn Write) -> io::Result<()> {
    let mut csv = csv::Writer::from_writer(out);
    csv.write_record(EchogramRow::COLUMNS)?;
    for row in echogram.rows() {
        csv.write_record(row.values().map(|value| value.to_string()))?;
    }
    csv.flush()
}

/// Writes the figures of all pairs and their standard errors, one row for each pair and band. A missing figure is empty.
pub fn write_figures(heard: &[(NamedPair, Response)], out: &mut dyn Write) -> io::Result<()> {
    let mut csv = csv::Writer::from_writer(out);
    let keys = ["source", "listener", "band_hz"].map(str::to_owned);
    let named = BandFigures::NAMES.into_iter();
    let named = named.flat_map(|name| [name.to_owned(), error_name(name)]);
    csv.write_record(keys.into_iter().chain(named))?;
    let text = |value: Option<f64>| value.map(|value| value.to_string()).unwrap_or_default();
    for (pair, response) in heard {
        let figures = &response.figures;
        for (band, band_hz) in BANDS_HZ.iter().enumerate() {
            let values = figures.bands[band].list().into_iter();
            let both = values.zip(figures.errors[band].list());
            let keys = [&pair.source, &pair.listener, &band_hz.to_string()].map(String::clone);
            let values = both.flat_map(|(value, error)| [text(value), text(error)]);
            csv.write_record(keys.into_iter().chain(values))?;
        }
    }
    csv.flush()
}

/// The name of the standard error of a figure: `t30_error_s` for `t30_s`.
fn error_name(figure: &str) -> String {
    match figure.split_once('_') {
        Some((figure, unit)) => format!("{figure}_error_{unit}"),
        None => format!("{figure}_error"),
    }
}
