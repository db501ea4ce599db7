//! Helpers shared by the library's unit tests and the integration tests.
#![allow(dead_code)] // Each test program uses only some of these.

use echomarch::gl::{Api, Context, ContextOptions};
use echomarch::tracer::FieldTrial;
use echomarch::{Scene, Settings, Tracer};
use std::sync::Once;

/// Runs `test` once for every API, each time on a separate thread.
pub fn on_a_thread_for_each_api(test: impl Fn(Api) + Sync) {
    for api in Api::ALL {
        let ended = std::thread::scope(|scope| {
            std::thread::Builder::new()
                .name(api.to_string())
                .spawn_scoped(scope, || test(api))
                .unwrap()
                .join()
        });
        assert!(ended.is_ok(), "failed with the API {api}");
    }
}

/// Runs `test` once with a context of every API, each time on a separate thread.
pub fn for_each_api(test: impl Fn(&Context) + Sync) {
    on_a_thread_for_each_api(|api| test(&context(api)));
}

/// Lets this process compile users' fields of the tests. Only the first call has an effect, so that a test can choose a
/// different setting afterwards.
pub fn trust_fields() {
    static CHOSEN: Once = Once::new();
    CHOSEN.call_once(|| FieldTrial::InThisProcess.set());
}

/// Creates a context of the API on the first device that provides one. Users' fields are trusted.
pub fn context(api: Api) -> Context {
    trust_fields();
    Context::headless(&ContextOptions::new(api)).unwrap_or_else(|e| panic!("{e}"))
}

/// Creates a tracer on a context of the preferred API.
pub fn tracer() -> Tracer {
    Tracer::new(&context(Api::Gl)).unwrap()
}

/// Returns the settings of the thesis with these numbers of waves and iterations.
pub fn thesis(waves: u32, iterations: u32) -> Settings {
    Settings::thesis()
        .with_waves(waves)
        .with_iterations(iterations)
}

/// Returns a built-in scene; panics if it is missing.
pub fn builtin(name: &str) -> Scene {
    Scene::builtin(name).unwrap()
}
