//! The files of `echomarch impulse`.

use super::Arguments;
use super::pairs::NamedPair;
use anyhow::anyhow;
use echomarch::Error;
use echomarch::audio::WavWriter;
use echomarch::internals::file_output::write_whole;
use echomarch::response::{
    Echogram, EchogramRow, Format, ImpulseResponse, ImpulseSettings, ListenerAxes, Response,
};
use echomarch_lab::experiment::decay_plot;
use std::io::{self, Write};
use std::path::Path;

/// Writes the requested files.
pub fn write(
    arguments: &Arguments,
    format: &Format,
    pair: &NamedPair,
    response: &Response,
) -> anyhow::Result<()> {
    if let Some(file) = &arguments.output {
        write_wav(arguments, file, format, pair, response)?;
    }
    if let Some(file) = &arguments.echogram {
        write_whole(file, |out| write_echogram(&response.echogram, out))?;
    }
    if let Some(file) = &arguments.plot {
        let title = format!(
            "{}: source {}, listener {}",
            pair.pair.scene().name,
            pair.source,
            pair.listener
        );
        let svg = decay_plot::svg(&title, response);
        let svg = svg.map_err(|error| anyhow!("cannot draw the plot: {error}"))?;
        write_whole(file, |out| out.write_all(svg.as_bytes()))?;
    }
    Ok(())
}

fn write_wav(
    arguments: &Arguments,
    file: &Path,
    format: &Format,
    pair: &NamedPair,
    response: &Response,
) -> anyhow::Result<()> {
    let axes = ListenerAxes::of(pair.pair.listener()).map_err(Error::from)?;
    let mut settings = ImpulseSettings::new(response.seconds);
    settings.rate_hz = arguments.rate;
    settings.format = format.clone();
    settings.seed = arguments.seed.into();
    let impulse = ImpulseResponse::new(&response.taps(), &response.echogram, &axes, &settings);
    let impulse = impulse.map_err(Error::from)?;
    let channels = settings.format.channels() as u16;
    let mut wav = WavWriter::create_with_channels(file, arguments.rate, channels)?;
    wav.write(&impulse.interleaved())?;
    Ok(wav.finish()?)
}

fn write_echogram(echogram: &Echogram, out: &mut dyn Write) -> io::Result<()> {
    let mut csv = csv::Writer::from_writer(out);
    csv.write_record(EchogramRow::COLUMNS)?;
    for row in echogram.rows() {
        csv.write_record(row.values().map(|value| value.to_string()))?;
    }
    csv.flush()
}
