//! Output devices: listing, choosing and opening them.

use std::ops::RangeInclusive;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use cpal::traits::{DeviceTrait, HostTrait, StreamTrait};
use cpal::{
    BufferSize, Device, Host, SampleFormat, Stream, StreamConfig, SupportedBufferSize,
    SupportedStreamConfig, SupportedStreamConfigRange,
};

use super::LiveError;
use super::link::Link;
use super::timeout::{ANSWER_LIMIT, within};
use crate::audio::{SAMPLE_RATE, SAMPLE_RATES};

/// An output device.
#[derive(Debug, Clone, PartialEq)]
pub struct DeviceInfo {
    /// Its name; [`LiveOptions::device`](super::LiveOptions::device) accepts it.
    pub name: String,
    /// Its unique name within the sound system, which is accepted as well.
    pub id: String,
    /// Whether it is the default device.
    pub default: bool,
    /// Its default number of channels.
    pub channels: u16,
    /// Its sample rates, in hertz.
    pub rates: RangeInclusive<u32>,
}

/// A device and the sample format to open it with.
pub(super) struct Found {
    device: Device,
    pub(super) name: String,
    config: SupportedStreamConfig,
}

/// The PulseAudio server found last. A connection to it stays open as long as the program runs, and
/// the server limits their number, so one is kept while it answers.
static HOST: Mutex<Option<Arc<Host>>> = Mutex::new(None);

fn kept_host() -> MutexGuard<'static, Option<Arc<Host>>> {
    HOST.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The sound system. Its messages to standard error are not shown: errors are returned.
fn host() -> Arc<Host> {
    hush();
    let kept = kept_host().clone();
    if let Some(host) = kept
        && host.devices().is_ok()
    {
        return host;
    }
    let host = Arc::new(cpal::default_host());
    // Looking for another sound system costs nothing, and PulseAudio may start later.
    let is_kept = host.id().name() == "PulseAudio";
    *kept_host() = is_kept.then(|| Arc::clone(&host));
    host
}

/// Looks for the sound system again next time if its client broke down. A sound system that does
/// not answer is kept: it answers when the server does, and another would have to wait as well.
pub(super) fn forget_broken(error: &LiveError) {
    if matches!(error, LiveError::BrokenDown) {
        *kept_host() = None;
    }
}

/// Keeps ALSA and the libraries that it loads from writing to the standard error stream: ALSA
/// itself on this thread, JACK's client library everywhere.
#[cfg(target_os = "linux")]
fn hush() {
    // If this fails the lines are shown, which is harmless.
    let _ = alsa::Output::local_error_handler();
    super::jack::hush();
}

#[cfg(not(target_os = "linux"))]
fn hush() {}

/// Lists the output devices; empty if the sound system is missing or does not answer.
pub fn list_devices() -> Vec<DeviceInfo> {
    within(ANSWER_LIMIT, || false, list).unwrap_or_else(|error| {
        forget_broken(&error);
        Vec::new()
    })
}

fn list() -> Vec<DeviceInfo> {
    let host = host();
    let default = host.default_output_device().map(|device| id(&device));
    let Ok(devices) = host.output_devices() else {
        return Vec::new();
    };
    let describe = |device: Device| {
        let id = id(&device);
        let ranges: Vec<_> = device.supported_output_configs().ok()?.collect();
        let lowest = ranges.iter().map(|range| range.min_sample_rate()).min()?;
        let highest = ranges.iter().map(|range| range.max_sample_rate()).max()?;
        Some(DeviceInfo {
            name: name(&device),
            default: default.as_ref() == Some(&id),
            id,
            channels: device.default_output_config().ok()?.channels(),
            rates: lowest..=highest,
        })
    };
    // ALSA lists a device that discards all sound.
    let plays = |device: &Device| id(device) != "null";
    devices.filter(plays).filter_map(describe).collect()
}

/// Looks for a device by its name or its id, or for the default one.
pub(super) fn find(wanted: Option<&str>) -> Result<Found, LiveError> {
    let host = host();
    let no_device = |error: cpal::Error| LiveError::NoDevice {
        reason: match error.kind() {
            // cpal's text refers to a requested device, but the default was requested.
            cpal::ErrorKind::DeviceNotAvailable => "the sound system offers none".to_owned(),
            _ => error.to_string(),
        },
    };
    let device = match wanted {
        None => host
            .default_output_device()
            .ok_or_else(|| LiveError::NoDevice {
                reason: "the sound system names no default".to_owned(),
            })?,
        Some(wanted) => {
            let devices: Vec<_> = host.output_devices().map_err(no_device)?.collect();
            named(devices, wanted)?
        }
    };
    let default = device.default_output_config().map_err(no_device)?;
    let name = name(&device);
    let config = choose(&device, default);
    Ok(Found {
        device,
        name,
        config,
    })
}

fn named(devices: Vec<Device>, wanted: &str) -> Result<Device, LiveError> {
    let names: Vec<String> = devices.iter().map(name).collect();
    let fits = |device: &Device| name(device) == wanted || id(device) == wanted;
    let found = devices.into_iter().find(fits);
    found.ok_or_else(|| LiveError::UnknownDevice {
        name: wanted.to_owned(),
        known: if names.is_empty() {
            "none".to_owned()
        } else {
            names.join(", ")
        },
    })
}

fn name(device: &Device) -> String {
    let described = device.description();
    described.map_or_else(|_| id(device), |text| text.name().to_owned())
}

fn id(device: &Device) -> String {
    let id = device.id();
    id.map_or_else(|_| "unknown".to_owned(), |id| id.id().to_owned())
}

/// Chooses the device's own rate, two channels if it has them, and the finest sample format.
fn choose(device: &Device, default: SupportedStreamConfig) -> SupportedStreamConfig {
    let rate_hz = if SAMPLE_RATES.contains(&default.sample_rate()) {
        default.sample_rate()
    } else {
        SAMPLE_RATE
    };
    let rank = |range: &SupportedStreamConfigRange| {
        let channels = match range.channels() {
            2 => 2,
            count if count == default.channels() => 1,
            _ => 0,
        };
        (channels, format_rank(range.sample_format()))
    };
    let ranges = device.supported_output_configs().into_iter().flatten();
    ranges
        .filter(|range| format_rank(range.sample_format()) > 0)
        .filter(|range| range.contains_rate(rate_hz))
        .max_by_key(rank)
        .map_or(default, |range| range.with_sample_rate(rate_hz))
}

/// Rank of a sample format; 0 for formats that cannot be played.
fn format_rank(format: SampleFormat) -> u8 {
    match format {
        SampleFormat::F32 => 3,
        SampleFormat::I32 => 2,
        SampleFormat::I16 => 1,
        _ => 0,
    }
}

impl Found {
    /// Samples per second.
    pub(super) fn rate_hz(&self) -> u32 {
        self.config.sample_rate()
    }

    /// Opens the device with a buffer of `buffer_frames`, or of its own choice if it rejects that
    /// length, and starts it.
    pub(super) fn open(&self, buffer_frames: u32, link: &Link) -> Result<Stream, LiveError> {
        hush();
        let frames = match *self.config.buffer_size() {
            SupportedBufferSize::Range { min, max } if min <= max => buffer_frames.clamp(min, max),
            _ => buffer_frames,
        };
        let stream = self
            .build(BufferSize::Fixed(frames), link)
            .or_else(|_| self.build(BufferSize::Default, link))?;
        stream.play().map_err(|error| self.refused(&error))?;
        Ok(stream)
    }

    fn build(&self, buffer_size: BufferSize, link: &Link) -> Result<Stream, LiveError> {
        let config = StreamConfig {
            buffer_size,
            ..self.config.config()
        };
        match self.config.sample_format() {
            SampleFormat::F32 => self.build_as::<f32>(config, link),
            SampleFormat::I32 => self.build_as::<i32>(config, link),
            SampleFormat::I16 => self.build_as::<i16>(config, link),
            format => Err(LiveError::UnsupportedFormat {
                device: self.name.clone(),
                format: format.to_string(),
            }),
        }
    }

    fn build_as<T: cpal::SizedSample + cpal::FromSample<f32>>(
        &self,
        config: StreamConfig,
        link: &Link,
    ) -> Result<Stream, LiveError> {
        let play = link.player::<T>(config.channels.into(), config.sample_rate);
        let built = self.device.build_output_stream(
            config,
            play,
            link.error_callback(),
            Some(ANSWER_LIMIT),
        );
        built.map_err(|error| self.refused(&error))
    }

    fn refused(&self, error: &cpal::Error) -> LiveError {
        LiveError::Open {
            device: self.name.clone(),
            reason: error.to_string(),
        }
    }
}
