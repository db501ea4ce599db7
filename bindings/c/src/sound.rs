//! Formats, and the functions of audio callbacks.

use crate::call::{EchomarchStatus, Failure, guard, status_of, text_of};
use crate::handle::{EchomarchSimulator, with};
use crate::values::{read, write};
use echomarch::hrtf::HrirSet;
use echomarch::simulator::{Ears, EarsSpec, Mix, SourceId};
use std::ffi::{c_char, c_void};
use std::path::Path;
use std::sync::Arc;
use std::{ptr, slice};

/// The sound of all sources as the listener hears them.
pub struct EchomarchMix(Mix);

/// The sound of one source as the listener hears it, for engines that mix sources themselves.
pub struct EchomarchEars(Ears);

/// The format of EchomarchMix and EchomarchEars: 24 bytes where pointers have 8. `echomarch_default_format` fills it.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EchomarchFormat {
    /// Longest delay of a direct way or an echo in seconds, 0.01 to 5.
    pub longest_s: f64,
    /// A SOFA file with a head, for headphones; NULL for two loudspeakers. Read by `echomarch_mix_new` and
    /// `echomarch_ears_new` only.
    pub head_file: *const c_char,
    /// Samples per second, 8000 to 192000.
    pub rate_hz: u32,
    /// Maximum number of sources that are heard at once, 1 to 256. EchomarchEars have one.
    pub sources: u32,
}

/// Fills `samples`, which are silent before, with the next `count` samples of a source. Called on the thread of
/// `echomarch_mix_process`, with its `user`. It must not throw or jump out.
pub type EchomarchFill =
    Option<unsafe extern "C" fn(user: *mut c_void, source: u64, samples: *mut f32, count: usize)>;

impl EchomarchFormat {
    /// # Safety
    /// `head_file` is null, or a text that ends with 0.
    unsafe fn spec(&self) -> Result<EarsSpec, Failure> {
        let mut spec = EarsSpec::new(self.rate_hz).with_sources(self.sources as usize);
        spec.longest_s = self.longest_s;
        if !self.head_file.is_null() {
            // SAFETY: the caller's text.
            let file = unsafe { text_of(self.head_file, "the head's file") }?;
            let head = HrirSet::read_sofa(Path::new(file)).map_err(echomarch::Error::from)?;
            spec = spec.with_head(Arc::new(head));
        }
        Ok(spec)
    }
}

/// Fills a format with its defaults: 64 sources, 0.6 s, two loudspeakers.
///
/// # Safety
/// `format` is NULL, or memory for a format.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn echomarch_default_format(
    rate_hz: u32,
    format: *mut EchomarchFormat,
) -> EchomarchStatus {
    let spec = EarsSpec::new(rate_hz);
    let defaults = EchomarchFormat {
        longest_s: spec.longest_s,
        head_file: ptr::null(),
        rate_hz,
        sources: spec.sources as u32,
    };
    // SAFETY: the caller's memory for a format.
    status_of(&guard(|| unsafe { write(format, defaults, "format") }))
}

/// Makes a mix of all sources. Writes the handle to `mix`, or NULL if there is an error.
///
/// # Safety
/// `sim` is NULL or a handle that no other thread uses; `format` is NULL or points to a format; `mix` is NULL or memory
/// for a pointer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn echomarch_mix_new(
    sim: *mut EchomarchSimulator,
    format: *const EchomarchFormat,
    mix: *mut *mut EchomarchMix,
) -> EchomarchStatus {
    let body = |sim: &mut EchomarchSimulator| {
        // SAFETY: the caller's memory for a pointer, and a format.
        let spec = unsafe {
            write(mix, ptr::null_mut(), "mix")?;
            read(format, "format")?.spec()?
        };
        let made = Box::new(EchomarchMix(sim.simulator.mix(&spec)?));
        // SAFETY: as above.
        unsafe { write(mix, Box::into_raw(made), "mix") }
    };
    // SAFETY: the caller's handle.
    unsafe { with(sim, body) }
}

/// Overwrites `stereo`, `frames` pairs of left and right, with the next samples. `fill` is called for each source that
/// is heard, several times if there are more than 128 frames; NULL plays silence into the mix. Samples that are not
/// numbers count as 0. Neither allocates, frees nor locks.
///
/// # Safety
/// `mix` is NULL or a handle that no other thread uses; `stereo` is NULL or memory for 2 * `frames` samples; `fill` is
/// NULL or a function that keeps to its place.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn echomarch_mix_process(
    mix: *mut EchomarchMix,
    stereo: *mut f32,
    frames: usize,
    fill: EchomarchFill,
    user: *mut c_void,
) -> EchomarchStatus {
    status_of(&guard(|| {
        // SAFETY: the caller's handle.
        let mix = unsafe { mix.as_mut() }.ok_or(Failure::Null("mix"))?;
        // SAFETY: the caller's memory for the samples.
        let stereo = unsafe { samples(stereo, frames) }?;
        mix.0.process(stereo, |source: SourceId, place| {
            if let Some(fill) = fill {
                // SAFETY: the caller's function, which fills the given place.
                unsafe { fill(user, source.to_bits(), place.as_mut_ptr(), place.len()) };
            }
        });
        Ok(())
    }))
}

/// The memory of `frames` pairs.
///
/// # Safety
/// `stereo` is null, or memory for 2 · `frames` samples, aligned and with any numbers.
unsafe fn samples<'a>(stereo: *mut f32, frames: usize) -> Result<&'a mut [f32], Failure> {
    if stereo.is_null() {
        return match frames {
            0 => Ok(&mut []),
            _ => Err(Failure::Null("stereo")),
        };
    }
    let count = frames.saturating_mul(2);
    // SAFETY: it is not null, and the caller's memory.
    Ok(unsafe { slice::from_raw_parts_mut(stereo, count) })
}

/// Frees a mix, before or after its simulator, while no thread uses it. NULL is allowed.
///
/// # Safety
/// `mix` is NULL, or a handle of `echomarch_mix_new` that was not freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn echomarch_mix_free(mix: *mut EchomarchMix) {
    let _ = guard(|| {
        if !mix.is_null() {
            // SAFETY: the box of echomarch_mix_new, which is not used again.
            drop(unsafe { Box::from_raw(mix) });
        }
        Ok(())
    });
}

/// Makes the ears of one source. Writes the handle to `ears`, or NULL if there is an error.
///
/// # Safety
/// `sim` is NULL or a handle that no other thread uses; `format` is NULL or points to a format; `ears` is NULL or memory
/// for a pointer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn echomarch_ears_new(
    sim: *mut EchomarchSimulator,
    source: u64,
    format: *const EchomarchFormat,
    ears: *mut *mut EchomarchEars,
) -> EchomarchStatus {
    let body = |sim: &mut EchomarchSimulator| {
        // SAFETY: the caller's memory for a pointer, and a format.
        let spec = unsafe {
            write(ears, ptr::null_mut(), "ears")?;
            read(format, "format")?.spec()?
        };
        let id = SourceId::from_bits(source);
        let made = Box::new(EchomarchEars(sim.simulator.ears(id, &spec)?));
        // SAFETY: as above.
        unsafe { write(ears, Box::into_raw(made), "ears") }
    };
    // SAFETY: the caller's handle.
    unsafe { with(sim, body) }
}

/// Overwrites `stereo`, `frames` pairs of left and right, with what is heard of the next `frames` samples of the source.
/// Samples that are not numbers count as 0. Neither allocates, frees nor locks.
///
/// # Safety
/// `ears` is NULL or a handle that no other thread uses; `mono` is NULL or points to `frames` samples, and `stereo` is
/// NULL or memory for 2 * `frames` samples, which do not overlap.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn echomarch_ears_process(
    ears: *mut EchomarchEars,
    mono: *const f32,
    stereo: *mut f32,
    frames: usize,
) -> EchomarchStatus {
    status_of(&guard(|| {
        // SAFETY: the caller's handle.
        let ears = unsafe { ears.as_mut() }.ok_or(Failure::Null("ears"))?;
        // SAFETY: the caller's memory for the samples.
        let stereo = unsafe { samples(stereo, frames) }?;
        let mono: &[f32] = match mono.is_null() {
            true if frames == 0 => &[],
            true => return Err(Failure::Null("mono")),
            // SAFETY: it is not null, and the caller's memory.
            false => unsafe { slice::from_raw_parts(mono, frames) },
        };
        let played = ears.0.process(mono, stereo);
        played.map_err(|error| Failure::Library(error.into()))
    }))
}

/// Frees ears, before or after their simulator, while no thread uses them. NULL is allowed.
///
/// # Safety
/// `ears` is NULL, or a handle of `echomarch_ears_new` that was not freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn echomarch_ears_free(ears: *mut EchomarchEars) {
    let _ = guard(|| {
        if !ears.is_null() {
            // SAFETY: the box of echomarch_ears_new, which is not used again.
            drop(unsafe { Box::from_raw(ears) });
        }
        Ok(())
    });
}
