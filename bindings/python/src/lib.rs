//! The compiled part of the Python package `echomarch`.
//!
//! The classes and functions here take numbers in the axes of the library and texts in the notation of scene files. The
//! Python modules in `python/echomarch/` add the interface of the package: axes, defaults, names and documentation.

mod errors;
mod response;
mod scene;
mod study;
mod trace;
mod worker;

use pyo3::prelude::*;

/// The extension module `echomarch._echomarch`.
#[pymodule(gil_used = false)]
fn _echomarch(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("BANDS_HZ", echomarch::bands::BANDS_HZ)?;
    module.add("BUILTIN_SCENES", echomarch::Scene::BUILTIN_NAMES)?;
    module.add("BUILTIN_MATERIALS", scene::builtin_materials())?;
    module.add("FIGURES", response::figure_names())?;
    module.add_class::<scene::Scene>()?;
    module.add_class::<response::Heard>()?;
    module.add_class::<study::Study>()?;
    module.add_function(wrap_pyfunction!(response::responses, module)?)?;
    module.add_function(wrap_pyfunction!(scene::which_it_has, module)?)?;
    module.add_function(wrap_pyfunction!(scene::there_is_no, module)?)?;
    module.add_function(wrap_pyfunction!(trace::trace, module)?)?;
    module.add_function(wrap_pyfunction!(worker::choose_renderer, module)?)?;
    module.add_function(wrap_pyfunction!(worker::choose_field_trial, module)?)?;
    module.add_function(wrap_pyfunction!(worker::answer_field_trial, module)?)?;
    module.add_function(wrap_pyfunction!(worker::renderer, module)?)?;
    module.add_function(wrap_pyfunction!(worker::close, module)?)
}
