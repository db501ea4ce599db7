//! Tests of contexts and devices through the public interface. `src/gl/tests` tests the objects that contexts create.

use crate::common::on_a_thread_for_each_api;
use echomarch::gl::{Context, ContextOptions, GpuError, list_gpus};

/// Protects the list of devices: it has at least one working device, under the number that selects this device.
#[test]
fn gpu_list_numbers_devices_as_options_do() {
    on_a_thread_for_each_api(|api| {
        let gpus = list_gpus(api).unwrap();
        assert!(gpus.iter().any(|gpu| gpu.outcome.is_ok()));
        for gpu in gpus {
            println!("{api} {gpu}");
            let again = Context::headless(&ContextOptions::new(api).with_gpu(gpu.index));
            match gpu.outcome {
                Ok(renderer) => assert_eq!(again.unwrap().renderer(), renderer.name),
                Err(_) => assert!(again.is_err()),
            }
        }
    });
}

/// Protects from the use of another device: a missing device is an error that states the number of devices.
#[test]
fn gpu_missing_device_is_an_error() {
    on_a_thread_for_each_api(|api| {
        let error = Context::headless(&ContextOptions::new(api).with_gpu(99)).unwrap_err();
        assert!(error.is_bad_input());
        assert!(
            matches!(
                error,
                GpuError::NoSuchGpu {
                    asked: 99,
                    found: 1..
                }
            ),
            "{error}"
        );
    });
}
