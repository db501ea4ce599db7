//! Contexts without a window through EGL: on a device chosen by index, or on a display without a device if EGL lists
//! none.

mod foreign;
mod library;
mod plain;

use std::rc::Rc;

use glutin::api::egl::context::PossiblyCurrentContext;
use glutin::api::egl::device::Device;
use glutin::api::egl::display::Display;
use glutin::config::ConfigSurfaceTypes;
use glutin::error::ErrorKind;
use glutin::prelude::*;

use super::backend::Backend;
use super::glutin_context::{GlutinContext, attributes, new_context, template};
use super::{Api, GpuError};
pub(super) use foreign::Foreign;
use plain::{Plain, Platform};

/// A place where a context can be made.
#[derive(Debug)]
pub(super) enum Place {
    /// A device in EGL's list.
    Device(Device),
    /// A display without a device.
    Platform(Platform),
}

/// The places where contexts can be made, at least one: the devices that EGL lists, in its order. If it lists none
/// (ANGLE, older drivers), the displays without a device that can be opened.
///
/// # Errors
/// [`GpuError::NoEglLibrary`], [`GpuError::StrangeEglLibrary`], [`GpuError::NoEglDevice`].
pub(super) fn places() -> Result<Vec<Place>, GpuError> {
    prepare()?;
    let mut reasons = Vec::new();
    match Device::query_devices() {
        Ok(devices) => {
            let places: Vec<Place> = devices.map(Place::Device).collect();
            if !places.is_empty() {
                return Ok(places);
            }
            reasons.push("the list is empty".to_owned());
        }
        Err(error) => reasons.push(error.to_string()),
    }
    let mut places = Vec::new();
    for platform in Platform::ALL {
        match platform.check() {
            Ok(()) => places.push(Place::Platform(platform)),
            Err(reason) => reasons.push(reason),
        }
    }
    match places.is_empty() {
        true => Err(GpuError::NoEglDevice {
            reason: reasons.join("; "),
        }),
        false => Ok(places),
    }
}

/// Checks that there is a complete library before glutin looks for one, which ends the program if functions are
/// missing.
///
/// # Errors
/// [`GpuError::NoEglLibrary`], [`GpuError::StrangeEglLibrary`].
pub(super) fn prepare() -> Result<(), GpuError> {
    library::functions().map(|_| ())
}

/// Makes a context; it is not current yet.
///
/// # Errors
/// [`GpuError::NoContext`] with EGL's answer.
pub(super) fn open(place: &Place, api: Api) -> Result<Rc<dyn Backend>, GpuError> {
    match place {
        Place::Device(device) => match create(device, api) {
            Ok(egl) => Ok(Rc::new(egl)),
            Err(error) => Err(GpuError::NoContext {
                api,
                reason: error.to_string(),
            }),
        },
        Place::Platform(platform) => Ok(Rc::new(Plain::on(*platform, api)?)),
    }
}

/// Creates a context on a device, without a surface.
fn create(device: &Device, api: Api) -> Result<impl Backend + use<>, glutin::error::Error> {
    // SAFETY: no native display handle is given that would have to be valid.
    let display = unsafe { Display::with_device(device, None) }?;
    let template = template(api, ConfigSurfaceTypes::empty());
    // SAFETY: the template names no native window or pixmap.
    let mut configs = unsafe { display.find_configs(template.build()) }?;
    let config = configs.next().ok_or(ErrorKind::BadConfig)?;
    drop(configs);
    Ok(GlutinContext {
        context: new_context(&display, &config, attributes(api))?.treat_as_possibly_current(),
        make_current: PossiblyCurrentContext::make_current_surfaceless,
        display,
    })
}
