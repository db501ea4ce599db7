//! Tests of what C cannot see.

use crate::call::{EchomarchStatus, Failure, guard, status_of};
use crate::*;
use assert_no_alloc::{AllocDisabler, assert_no_alloc};
use std::ffi::{CStr, c_void};
use std::ptr;
use std::time::{Duration, Instant};

#[global_allocator]
static ALLOCATOR: AllocDisabler = AllocDisabler;

/// Protects programs in C, in which a panic would be undefined.
#[test]
fn a_panic_becomes_a_status() {
    let result = guard(|| -> Result<(), Failure> { panic!("on purpose") });
    assert_eq!(status_of(&result), EchomarchStatus::Fault);
}

/// Protects programs that hand the handles to other threads.
#[test]
fn handles_may_change_threads() {
    fn check<T: Send>() {}
    check::<EchomarchSimulator>();
    check::<EchomarchMix>();
    check::<EchomarchEars>();
}

unsafe extern "C" fn noise(_: *mut c_void, source: u64, samples: *mut f32, count: usize) {
    for index in 0..count {
        let value = (index as f32 * 0.7 + source as f32).sin();
        // SAFETY: the place has `count` samples.
        unsafe { samples.add(index).write(value) };
    }
}

/// Protects audio callbacks: neither the calls nor the statuses of bad calls allocate or free.
#[test]
fn processing_allocates_nothing() {
    let mut sim = ptr::null_mut();
    let (mut mix, mut ears) = (ptr::null_mut(), ptr::null_mut());
    let (mut format, mut id) = (unset(), 0);
    // SAFETY: all places are there, and only this thread uses the handles.
    unsafe {
        let made = echomarch_simulator_new(ptr::null(), &raw mut sim, ptr::null_mut(), 0);
        assert_eq!(made, EchomarchStatus::Ok);
        let room = c"Surface(shape: Room(size: (8, 3, 6)), material: \"brick\")";
        let added = echomarch_add_surface(sim, room.as_ptr(), 0, ptr::null_mut());
        let error = CStr::from_ptr(echomarch_simulator_error(sim));
        assert_eq!(added, EchomarchStatus::Ok, "{error:?}");
        let at = EchomarchPose {
            position: [1.0, 0.0, -1.0],
            rotation: [0.0, 0.0, 0.0, 1.0],
        };
        assert_eq!(
            echomarch_add_source(sim, ptr::null(), &raw const at, &raw mut id),
            EchomarchStatus::Ok
        );
        echomarch_default_format(48_000, &raw mut format);
        assert_eq!(
            echomarch_mix_new(sim, &raw const format, &raw mut mix),
            EchomarchStatus::Ok
        );
        assert_eq!(
            echomarch_ears_new(sim, id, &raw const format, &raw mut ears),
            EchomarchStatus::Ok
        );
        echomarch_commit(sim, ptr::null_mut());
    }
    let (mono, mut stereo, mut loudest) = ([0.5_f32; 300], [0.0_f32; 600], [0.0_f32; 2]);
    let began = Instant::now();
    while loudest.contains(&0.0) && began.elapsed() < Duration::from_secs(60) {
        assert_no_alloc(|| {
            // SAFETY: the places have the stated numbers of samples.
            unsafe {
                let user = ptr::null_mut();
                let done = echomarch_mix_process(mix, stereo.as_mut_ptr(), 300, Some(noise), user);
                assert_eq!(done, EchomarchStatus::Ok);
                loudest[0] = stereo
                    .iter()
                    .fold(loudest[0], |most, now| most.max(now.abs()));
                let done = echomarch_ears_process(ears, mono.as_ptr(), stereo.as_mut_ptr(), 300);
                assert_eq!(done, EchomarchStatus::Ok);
                loudest[1] = stereo
                    .iter()
                    .fold(loudest[1], |most, now| most.max(now.abs()));
                let bad = echomarch_ears_process(ears, ptr::null(), stereo.as_mut_ptr(), 300);
                assert_eq!(bad, EchomarchStatus::Null);
            }
        });
        std::thread::sleep(Duration::from_millis(2));
    }
    // SAFETY: the handles are not used again.
    unsafe {
        echomarch_simulator_free(sim);
        echomarch_mix_free(mix);
        echomarch_ears_free(ears);
    }
    assert!(!loudest.contains(&0.0), "{loudest:?}");
}

fn unset() -> EchomarchFormat {
    EchomarchFormat {
        longest_s: 0.0,
        head_file: ptr::null(),
        rate_hz: 0,
        sources: 0,
    }
}
