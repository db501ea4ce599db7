//! The handle of a simulator: creation, errors, end.

use crate::call::{EchomarchStatus, Failure, guard, status_of};
use crate::values::{read, write};
use echomarch::simulator::{Simulator, SimulatorSettings};
use echomarch::{Listener, Scene, Source};
use std::ffi::{CString, c_char};
use std::ptr;

/// A world of sources, surfaces and a listener, whose sound is traced on threads of its own.
pub struct EchomarchSimulator {
    pub(crate) simulator: Simulator,
    /// A scene without objects, with the materials, the scattering and the air of the simulator.
    pub(crate) medium: Scene,
    renderer: CString,
    error: CString,
}

/// Settings of a simulator: 64 bytes. `echomarch_default_settings` fills them.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EchomarchSettings {
    /// Milliseconds that the simulator's thread works in each round, 0.5 to 1000.
    pub milliseconds: f64,
    /// Rounds per second, 1 to 1000.
    pub rounds_hz: f64,
    /// Length of a trace in seconds, 0.1 to 10.
    pub seconds: f64,
    /// Length in seconds of the traces that measure the decay, 0.1 to 20.
    pub longest_s: f64,
    /// Maximum number of waves of a trace, 64 to 65536.
    pub waves: u32,
    /// Maximum number of reflections of an echo, 0 to 8.
    pub order: u32,
    /// Maximum number of echoes of a source, 0 to 64.
    pub echoes: u32,
    /// Whether sound bends around what hides a source, 0 or 1.
    pub diffraction: u32,
    /// Whether sound passes solids whose materials transmit, 0 or 1.
    pub transmission: u32,
    /// 0. For later versions.
    pub reserved: [u32; 3],
}

const _: () = assert!(size_of::<EchomarchSettings>() == 64);

impl From<&SimulatorSettings> for EchomarchSettings {
    fn from(settings: &SimulatorSettings) -> EchomarchSettings {
        EchomarchSettings {
            milliseconds: settings.milliseconds,
            rounds_hz: settings.rounds_hz,
            seconds: settings.seconds,
            longest_s: settings.longest_s,
            waves: settings.waves,
            order: settings.order,
            echoes: u32::try_from(settings.echoes).unwrap_or(u32::MAX),
            diffraction: settings.diffraction.into(),
            transmission: settings.transmission.into(),
            reserved: [0; 3],
        }
    }
}

impl EchomarchSettings {
    fn settings(&self) -> SimulatorSettings {
        let mut settings = SimulatorSettings::default()
            .with_milliseconds(self.milliseconds)
            .with_waves(self.waves)
            .with_seconds(self.seconds, self.longest_s)
            .with_echoes(self.order, self.echoes as usize);
        settings.rounds_hz = self.rounds_hz;
        settings.diffraction = self.diffraction != 0;
        settings.transmission = self.transmission != 0;
        settings
    }
}

/// A text for C, up to its first 0.
fn c_text(text: &str) -> CString {
    let end = text.find('\0').unwrap_or(text.len());
    CString::new(&text[..end]).unwrap_or_default()
}

impl EchomarchSimulator {
    fn new(settings: SimulatorSettings) -> Result<EchomarchSimulator, Failure> {
        let simulator = Simulator::new(settings)?;
        let (source, listener) = (Source::at([0.0; 3]), Listener::at([0.0; 3], 1.0));
        Ok(EchomarchSimulator {
            renderer: c_text(simulator.renderer()),
            simulator,
            medium: Scene::new("world", Vec::new(), source, listener),
            error: CString::default(),
        })
    }

    /// Remembers the text of an error.
    pub(crate) fn note(&mut self, text: &str) {
        self.error = c_text(text);
    }
}

/// Runs a call of a handle, and remembers its error.
///
/// # Safety
/// `sim` is null, or a handle of [`echomarch_simulator_new`] that is not freed, and that no other thread uses.
pub(crate) unsafe fn with(
    sim: *mut EchomarchSimulator,
    body: impl FnOnce(&mut EchomarchSimulator) -> Result<(), Failure>,
) -> EchomarchStatus {
    // SAFETY: it is null or a handle that only this thread uses.
    let Some(sim) = (unsafe { sim.as_mut() }) else {
        return EchomarchStatus::Null;
    };
    let result = guard(|| body(sim));
    // The text itself is made under the guard, too.
    let _ = guard(|| {
        if let Err(failure) = &result {
            sim.note(&failure.to_string());
        }
        Ok(())
    });
    status_of(&result)
}

/// Fills settings with their defaults: 6 ms in each of 60 rounds a second, 4096 waves of 0.8 s.
///
/// # Safety
/// `settings` is NULL, or memory for settings.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn echomarch_default_settings(
    settings: *mut EchomarchSettings,
) -> EchomarchStatus {
    status_of(&guard(|| {
        let defaults = EchomarchSettings::from(&SimulatorSettings::default());
        // SAFETY: the caller's memory for settings.
        unsafe { write(settings, defaults, "settings") }
    }))
}

/// Starts a simulator, and waits until it has an OpenGL context. `settings` may be NULL for the defaults. Writes the
/// handle to `sim`, or NULL if there is an error. `error` may be NULL; otherwise the text of an error is written to
/// its `error_size` bytes, cut if necessary, with a 0 at the end.
///
/// # Safety
/// `settings` is NULL or points to settings; `sim` is NULL or memory for a pointer; `error` is NULL or memory for
/// `error_size` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn echomarch_simulator_new(
    settings: *const EchomarchSettings,
    sim: *mut *mut EchomarchSimulator,
    error: *mut c_char,
    error_size: usize,
) -> EchomarchStatus {
    let result = guard(|| {
        // SAFETY: the caller's memory for a pointer.
        unsafe { write(sim, ptr::null_mut(), "sim") }?;
        let settings = match settings.is_null() {
            true => SimulatorSettings::default(),
            // SAFETY: it is not null, so it points to settings.
            false => unsafe { read(settings, "settings") }?.settings(),
        };
        let made = Box::new(EchomarchSimulator::new(settings)?);
        // SAFETY: as above.
        unsafe { write(sim, Box::into_raw(made), "sim") }
    });
    let _ = guard(|| {
        let text = result.as_ref().err().map(Failure::to_string);
        // SAFETY: the caller's memory for a text.
        unsafe { copy_text(&text.unwrap_or_default(), error, error_size) };
        Ok(())
    });
    status_of(&result)
}

/// Writes a text and a 0, cut to whole characters.
///
/// # Safety
/// `place` is null, or memory for `size` bytes.
unsafe fn copy_text(text: &str, place: *mut c_char, size: usize) {
    let Some(room) = size.checked_sub(1) else {
        return;
    };
    if place.is_null() {
        return;
    }
    let text = &text[..text.floor_char_boundary(room)];
    // SAFETY: the text has at most size − 1 bytes, so that it and the 0 fit.
    unsafe {
        ptr::copy_nonoverlapping(text.as_ptr().cast(), place, text.len());
        place.add(text.len()).write(0);
    }
}

/// Ends a simulator, after the trace that is under way. NULL is allowed. Its EchomarchMix and EchomarchEars may still be
/// used: they play their last state.
///
/// # Safety
/// `sim` is NULL, or a handle of `echomarch_simulator_new` that was not freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn echomarch_simulator_free(sim: *mut EchomarchSimulator) {
    let _ = guard(|| {
        if !sim.is_null() {
            // SAFETY: the box of echomarch_simulator_new, which is not used again.
            drop(unsafe { Box::from_raw(sim) });
        }
        Ok(())
    });
}

/// The text of the last error of a handle, in UTF-8. Empty before the first error and for NULL. Never NULL. Valid until
/// the next call with this handle.
///
/// # Safety
/// `sim` is NULL, or a handle that was not freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn echomarch_simulator_error(
    sim: *const EchomarchSimulator,
) -> *const c_char {
    // SAFETY: it is null or a handle.
    unsafe { sim.as_ref() }.map_or(c"".as_ptr(), |sim| sim.error.as_ptr())
}

/// The name of the renderer. Empty for NULL. Valid until the handle is freed.
///
/// # Safety
/// `sim` is NULL, or a handle that was not freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn echomarch_simulator_renderer(
    sim: *const EchomarchSimulator,
) -> *const c_char {
    // SAFETY: it is null or a handle.
    unsafe { sim.as_ref() }.map_or(c"".as_ptr(), |sim| sim.renderer.as_ptr())
}
