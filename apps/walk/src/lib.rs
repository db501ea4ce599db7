//! Walking through a scene: the part shared by the window and the page in a browser.
//!
//! | file | what it does |
//! | --- | --- |
//! | `visit` | one walk through a scene, for the page: time passes, waves are traced, the picture and the plan are drawn |
//! | `world`, `walk` | the scene in its current state, the listener's position in it |
//! | `values` | its named values |
//! | `plan`, `paths` | the scene from above, and the waves shown in it |
//! | `hearing` | full listening |
//! | `ears`, `mix` | for the page: full listening as plain numbers, and mixed into slices |
//!
//! No code here uses a window, a clock of its own, or a thread: its inputs are a [`MoveInput`] and seconds.

mod ears;
mod hearing;
mod mix;
mod paths;
mod plan;
mod values;
mod visit;
mod walk;
mod world;

pub use ears::Ears;
pub use hearing::{EarsStatus, Found, Hearing, QUIETEST_DB};
pub use mix::{HeardMessage, Mix};
#[cfg(feature = "audio")]
pub use mix::{NOISE_SEED, player};
pub use paths::{PATH_ITERATIONS, Paths};
pub use plan::{Cut, STUB, way};
pub use values::ValueSlider;
pub use visit::{Plan, Visit, Way};
pub use walk::{BODY, MoveInput, Walker};
pub use world::{WalkState, World};
