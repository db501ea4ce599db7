//! Commits, the state, and what was heard.

use crate::call::{EchomarchStatus, Failure};
use crate::handle::{EchomarchSimulator, with};
use crate::values::{ECHOMARCH_BANDS, write};
use echomarch::simulator::{EarlyEcho, SimulatorState, SourceId, Update};

/// The state of a simulator's threads.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EchomarchState {
    /// Updates are of the last commit's surfaces, or there was no commit yet.
    Ready = 0,
    /// Programs for the last commit's surfaces are compiled. Until they are ready, updates are of the surfaces before.
    Compiling = 1,
    /// The last commit's surfaces cannot be traced. Updates are of the surfaces before, if there are any.
    Failed = 2,
}

/// What was heard of a source last: 416 bytes. Gains are amplitudes by octave band, relative to the direct sound of the
/// source at 1 m. Directions are unit vectors of the world towards the origin of the sound.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EchomarchUpdate {
    /// Gains of the direct way, with distance, directivity, level, air, diffraction and transmission.
    pub direct_gain: [f64; ECHOMARCH_BANDS],
    /// The share of the energy that arrives on the direct way, of that in the open, 0 to 1.
    pub visibility: f64,
    /// Seconds from the source to the listener on the direct way.
    pub direct_delay_s: f64,
    /// Seconds from the source to the first sound, also if it is an echo.
    pub delay_s: f64,
    /// Seconds from the direct sound to the first reverberant sound.
    pub pre_delay_s: f64,
    /// Gains of all reverberation, echoes included: the root of its energy.
    pub reverb_gain: [f64; ECHOMARCH_BANDS],
    /// Errors of these gains in decibels, one standard deviation.
    pub reverb_gain_error_db: [f64; ECHOMARCH_BANDS],
    /// Decay times in seconds for 60 dB, at most 60; 0 where nothing reverberates.
    pub decay_s: [f64; ECHOMARCH_BANDS],
    /// Errors of the decay times in seconds, one standard deviation.
    pub decay_error_s: [f64; ECHOMARCH_BANDS],
    /// The number of the commit that the direct way belongs to.
    pub commit: u64,
    /// Number of traces of this source.
    pub traces: u64,
    /// Direction of the direct way.
    pub direct_from: [f32; 3],
    /// Direction of the first sound, also if it is an echo.
    pub from: [f32; 3],
    /// Whether the line from source to listener is free, 0 or 1.
    pub is_in_sight: u32,
    /// Number of waves of the last trace; 0 before the first.
    pub waves: u32,
    /// Number of echoes, also of those that the given array has no place for.
    pub echoes: u32,
    /// 0. For later versions.
    pub reserved: u32,
    /// Whether a part of the decay of a band lies beyond the traced record, 0 or 1.
    pub is_extrapolated: [u8; ECHOMARCH_BANDS],
}

const _: () = assert!(size_of::<EchomarchUpdate>() == 416);

/// An echo, over a few reflections: 96 bytes.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EchomarchEcho {
    /// Stays the same while the echo comes over the same surfaces and walls.
    pub key: u64,
    /// Amplitude by octave band, relative to the direct sound of the source at 1 m.
    pub gain: [f64; ECHOMARCH_BANDS],
    /// Seconds from the source to the listener.
    pub delay_s: f64,
    /// Unit vector of the world towards the origin of the sound.
    pub from: [f32; 3],
    /// 0. For later versions.
    pub reserved: u32,
}

const _: () = assert!(size_of::<EchomarchEcho>() == 96);

impl From<&EarlyEcho> for EchomarchEcho {
    fn from(echo: &EarlyEcho) -> EchomarchEcho {
        EchomarchEcho {
            key: echo.key,
            gain: echo.gain,
            delay_s: echo.delay_s,
            from: echo.from.to_array(),
            reserved: 0,
        }
    }
}

impl From<&Update> for EchomarchUpdate {
    fn from(update: &Update) -> EchomarchUpdate {
        let Update { direct, reverb, .. } = update;
        EchomarchUpdate {
            direct_gain: direct.gain,
            visibility: direct.visibility,
            direct_delay_s: direct.delay_s,
            delay_s: update.delay_s,
            pre_delay_s: reverb.pre_delay_s,
            reverb_gain: reverb.gain,
            reverb_gain_error_db: reverb.gain_error_db,
            decay_s: reverb.decay_s,
            decay_error_s: reverb.decay_error_s,
            commit: update.commit,
            traces: update.traces,
            direct_from: direct.from.to_array(),
            from: update.from.to_array(),
            is_in_sight: direct.is_in_sight.into(),
            waves: update.waves,
            echoes: u32::try_from(update.echoes.len()).unwrap_or(u32::MAX),
            reserved: 0,
            is_extrapolated: reverb.is_extrapolated.map(u8::from),
        }
    }
}

/// Hands the world to the simulator's threads. It does not wait. Writes the number of the commit, from 1, to `commit`,
/// unless it is NULL.
///
/// # Safety
/// `sim` is NULL or a handle that no other thread uses; `commit` is NULL or memory for a number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn echomarch_commit(
    sim: *mut EchomarchSimulator,
    commit: *mut u64,
) -> EchomarchStatus {
    let body = |sim: &mut EchomarchSimulator| {
        let number = sim.simulator.commit();
        if !commit.is_null() {
            // SAFETY: it is not null, so it is memory for a number.
            unsafe { write(commit, number, "commit") }?;
        }
        Ok(())
    };
    // SAFETY: the caller's handle.
    unsafe { with(sim, body) }
}

/// Writes the state of the simulator's threads to `state`. If they have failed, `echomarch_simulator_error` has the
/// reason.
///
/// # Safety
/// `sim` is NULL or a handle that no other thread uses; `state` is NULL or memory for a state.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn echomarch_state(
    sim: *mut EchomarchSimulator,
    state: *mut EchomarchState,
) -> EchomarchStatus {
    let body = |sim: &mut EchomarchSimulator| {
        let now = match sim.simulator.state() {
            SimulatorState::Ready => EchomarchState::Ready,
            SimulatorState::Failed(error) => {
                sim.note(&error.to_string());
                EchomarchState::Failed
            }
            _ => EchomarchState::Compiling,
        };
        // SAFETY: the caller's memory for a state.
        unsafe { write(state, now, "state") }
    };
    // SAFETY: the caller's handle.
    unsafe { with(sim, body) }
}

/// Writes 1 to `would_compile` if the world as it is now would have programs compiled aside if it were committed,
/// otherwise 0.
///
/// # Safety
/// `sim` is NULL or a handle that no other thread uses; `would_compile` is NULL or memory for a number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn echomarch_would_compile(
    sim: *mut EchomarchSimulator,
    would_compile: *mut u32,
) -> EchomarchStatus {
    let body = |sim: &mut EchomarchSimulator| {
        let answer = sim.simulator.would_compile().into();
        // SAFETY: the caller's memory for a number.
        unsafe { write(would_compile, answer, "would_compile") }
    };
    // SAFETY: the caller's handle.
    unsafe { with(sim, body) }
}

/// Writes what was heard of a source last to `update`, and its first echoes, by delay, to the `capacity` places of
/// `echoes`. `echoes` may be NULL. ECHOMARCH_STATUS_NOT_YET before the source's first round, and if it is removed or
/// disabled.
///
/// # Safety
/// `sim` is NULL or a handle that no other thread uses; `update` is NULL or memory for an update; `echoes` is NULL or
/// memory for `capacity` echoes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn echomarch_update(
    sim: *mut EchomarchSimulator,
    source: u64,
    update: *mut EchomarchUpdate,
    echoes: *mut EchomarchEcho,
    capacity: usize,
) -> EchomarchStatus {
    let body = |sim: &mut EchomarchSimulator| {
        let heard = sim.simulator.updates(SourceId::from_bits(source));
        let heard = heard.ok_or(Failure::NotYet)?;
        // SAFETY: the caller's memory for an update.
        unsafe { write(update, EchomarchUpdate::from(&*heard), "update") }?;
        if echoes.is_null() {
            return Ok(());
        }
        for (index, echo) in heard.echoes.iter().take(capacity).enumerate() {
            // SAFETY: the caller's memory for `capacity` echoes.
            unsafe { write(echoes.add(index), EchomarchEcho::from(echo), "echoes") }?;
        }
        Ok(())
    };
    // SAFETY: the caller's handle.
    unsafe { with(sim, body) }
}
