//! Output devices: their list, choice and opening, and requests to a sound system that may never answer.

#[cfg(target_os = "linux")]
use std::ffi::c_char;
use std::ops::RangeInclusive;
#[cfg(target_os = "linux")]
use std::sync::Once;
use std::sync::atomic::{AtomicBool, Ordering::Acquire, Ordering::Release};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use cpal::traits::{DeviceTrait, HostTrait, StreamTrait};
use cpal::{
    BufferSize, Device, Host, SampleFormat, Stream, StreamConfig, SupportedBufferSize,
    SupportedStreamConfig, SupportedStreamConfigRange,
};

use super::LiveError;
use super::link::Link;
use crate::audio::Sound;

/// An output device.
#[derive(Debug, Clone, PartialEq)]
pub struct DeviceInfo {
    /// Name of the device; [`LiveOptions::device`](super::LiveOptions::device) accepts this name.
    pub name: String,
    /// Unique identifier of the device in the sound system; [`LiveOptions::device`](super::LiveOptions::device) accepts
    /// it as well.
    pub id: String,
    /// Whether it is the default device.
    pub default: bool,
    /// Default number of channels of the device.
    pub channels: u16,
    /// Sample rates of the device, in hertz.
    pub rates: RangeInclusive<u32>,
}

/// A device and the sample format to open it with.
pub(super) struct Found {
    device: Device,
    pub(super) name: String,
    config: SupportedStreamConfig,
}

/// The most recent connection to PulseAudio. A connection stays open until the program ends, and the server limits the
/// number of connections, so the connection is reused while the server answers.
static HOST: Mutex<Option<Arc<Host>>> = Mutex::new(None);

fn kept_host() -> MutexGuard<'static, Option<Arc<Host>>> {
    HOST.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Returns the sound system. Its messages on standard error are suppressed, because all errors are returned.
fn host() -> Arc<Host> {
    hush();
    let kept = kept_host().clone();
    if let Some(host) = kept
        && host.devices().is_ok()
    {
        return host;
    }
    let host = Arc::new(cpal::default_host());
    // Other sound systems are looked up each time: the lookup takes almost no time, and PulseAudio may start later.
    let is_kept = host.id().name() == "PulseAudio";
    *kept_host() = is_kept.then(|| Arc::clone(&host));
    host
}

/// Makes the next call look for the sound system again if the client of the sound system failed. The connection to a
/// sound system that does not answer is kept: it works again when the server does, and another client would have to
/// wait as well.
pub(super) fn forget_broken(error: &LiveError) {
    if matches!(error, LiveError::BrokenDown) {
        *kept_host() = None;
    }
}

/// Keeps ALSA and the libraries that it loads from writing to standard error: ALSA itself on this thread, JACK's client
/// library on all threads.
#[cfg(target_os = "linux")]
fn hush() {
    // If this call fails, the messages are shown, which is harmless.
    let _ = alsa::Output::local_error_handler();
    hush_jack();
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

/// Looks for a device by its name or id, or for the default device.
pub(super) fn find(wanted: Option<&str>) -> Result<Found, LiveError> {
    let host = host();
    let no_device = |error: cpal::Error| LiveError::NoDevice {
        reason: match error.kind() {
            // The text of cpal refers to a requested device, but the request was for the default device.
            cpal::ErrorKind::DeviceNotAvailable => "the sound system has no device".to_owned(),
            _ => error.to_string(),
        },
    };
    let device = match wanted {
        None => host
            .default_output_device()
            .ok_or_else(|| LiveError::NoDevice {
                reason: "the sound system has no default device".to_owned(),
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
    let rate_hz = if Sound::SAMPLE_RATES.contains(&default.sample_rate()) {
        default.sample_rate()
    } else {
        Sound::SAMPLE_RATE
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

    /// Opens and starts the device with a buffer of `buffer_frames`. If the device rejects this length, its own buffer
    /// length is used.
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

/// A function that receives a message of JACK's client library.
#[cfg(target_os = "linux")]
type Told = extern "C" fn(*const c_char);

#[cfg(target_os = "linux")]
extern "C" fn forget(_: *const c_char) {}

/// Discards the messages of JACK's client library, if that library is installed. ALSA still returns
/// errors.
/// ALSA has a plugin that plays to JACK. When ALSA's devices are listed, the plugin looks for a JACK server. Without a
/// server, JACK's client library writes an error of about six lines to the standard error stream each time. The library
/// has two functions to redirect its messages.
#[cfg(target_os = "linux")]
fn hush_jack() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        // SAFETY: this is the library that ALSA's plugin would load by the same name, which would also run its
        // initialisers.
        let Ok(library) = (unsafe { libloading::Library::new("libjack.so.0") }) else {
            return;
        };
        for name in [
            b"jack_set_error_function\0" as &[u8],
            b"jack_set_info_function\0",
        ] {
            // SAFETY: both are `void (void (*)(const char *))` since JACK 0.118, and the function
            // passed to them may be called on any thread at any time: it does nothing.
            unsafe {
                if let Ok(set) = library.get::<unsafe extern "C" fn(Told)>(name) {
                    set(forget);
                }
            }
        }
        // The library keeps a pointer to `forget`, and other libraries use this library.
        std::mem::forget(library);
    });
}

/// Maximum time to wait for a sound system.
pub(super) const ANSWER_LIMIT: Duration = Duration::from_secs(5);

/// Interval at which a waiting thread checks whether to give up.
const GLANCE: Duration = Duration::from_millis(20);

/// Whether a request is in progress. Only one request runs at a time, so that a sound system that hangs occupies only
/// one thread and one connection, even after many requests.
static IS_PENDING: AtomicBool = AtomicBool::new(false);

/// Ends the request when its thread ends, even by a panic.
struct PendingRequest;

impl PendingRequest {
    /// `None` while another request is in progress.
    fn begin() -> Option<Self> {
        (!IS_PENDING.swap(true, Acquire)).then(|| Self)
    }
}

impl Drop for PendingRequest {
    fn drop(&mut self) {
        IS_PENDING.store(false, Release);
    }
}

/// Runs `work`, which calls the sound system, on a separate thread and waits for it up to a limit,
/// or until `is_off`.
///
/// If the answer comes after the limit, that thread drops it. Until then no other request starts.
pub(super) fn within<T: Send + 'static>(
    limit: Duration,
    is_off: impl Fn() -> bool,
    work: impl FnOnce() -> T + Send + 'static,
) -> Result<T, LiveError> {
    let start = Instant::now();
    let is_enough = || is_off() || start.elapsed() > limit;
    let no_answer = LiveError::NoAnswer {
        seconds: limit.as_secs(),
    };
    let request = loop {
        match PendingRequest::begin() {
            Some(request) => break request,
            None if is_enough() => return Err(no_answer),
            None => thread::sleep(GLANCE),
        }
    };
    let (sender, receiver) = mpsc::channel();
    spawn("echomarch-open", move || {
        let answer = work();
        drop(request);
        // The receiver may no longer exist: the answer is then dropped.
        let _ = sender.send(answer);
    })?;
    loop {
        match receiver.recv_timeout(GLANCE) {
            Ok(answer) => return Ok(answer),
            Err(RecvTimeoutError::Disconnected) => return Err(LiveError::BrokenDown),
            Err(RecvTimeoutError::Timeout) if is_enough() => return Err(no_answer),
            Err(RecvTimeoutError::Timeout) => {}
        }
    }
}

/// Drops a value on a separate thread, because dropping it may be slow.
pub(super) fn drop_elsewhere<T: Send + 'static>(value: T) {
    // If the thread cannot start, the closure and the value are dropped here.
    let _ = spawn("echomarch-close", move || drop(value));
}

fn spawn(name: &str, work: impl FnOnce() + Send + 'static) -> Result<(), LiveError> {
    let spawned = thread::Builder::new().name(name.to_owned()).spawn(work);
    spawned.map_err(|source| LiveError::Thread { source })?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects a hanging sound system from repeated requests, each from another thread, and protects a panic from
    /// being reported as a time-out. Both checks are in one test because all requests share one lock.
    #[test]
    fn one_request_at_a_time_and_a_panic_is_told() {
        let (answer, hangs) = mpsc::channel::<()>();
        let brief = Duration::from_millis(50);
        let first = within(brief, || false, move || hangs.recv().is_ok());
        assert!(matches!(first, Err(LiveError::NoAnswer { .. })));
        let second = within(
            brief,
            || false,
            || unreachable!("the first is still under way"),
        );
        assert!(matches!(second, Err(LiveError::NoAnswer { .. })));
        answer.send(()).unwrap();
        assert_eq!(within(ANSWER_LIMIT, || false, || 3).unwrap(), 3);
        let panicked: Result<(), _> = within(ANSWER_LIMIT, || false, || panic!("on purpose"));
        assert!(matches!(panicked, Err(LiveError::BrokenDown)));
        assert_eq!(within(ANSWER_LIMIT, || false, || 4).unwrap(), 4);
    }
}
