//! Walking through a scene: the part shared by the window and the page in a browser.
//!
//! | file | content |
//! | --- | --- |
//! | `visit` | one walk through a scene, for the page: advances time, traces waves, draws the picture and the plan |
//! | `world`, `walk` | the scene in its current state, the movement of the listener |
//! | `values` | the named values of the scene |
//! | `plan`, `paths` | the scene from above, and the paths of waves drawn in it |
//! | `hearing`, `parts` | full listening, and the parts of it that the user can switch |
//! | `mark_names` | the names of sources and listeners in the plan |
//! | `scene_gain` | the gain of a scene's sound |
//! | `drawn_paths` | the exact paths of the last trace, drawn in the plan |
//! | `ears`, `mix` | for the page: full listening as plain numbers, and its mix in blocks of samples |
//!
//! No code here uses a window, a clock or a thread. The inputs are a [`MoveInput`] and a time step in seconds.

mod drawn_paths;
mod ears;
mod hearing;
mod mark_names;
mod mix;
mod parts;
mod paths;
mod plan;
mod scene_gain;
mod values;
mod visit;
mod walk;
mod wave_budget;
mod world;

pub use drawn_paths::{DRAWN_PER_SOURCE, DrawnPath};
pub use ears::Ears;
pub use hearing::{EarsStatus, Found, Hearing, QUIETEST_DB};
pub use mark_names::{listener_names, source_names};
pub use mix::{HeardMessage, Mix};
#[cfg(feature = "audio")]
pub use mix::{NOISE_SEED, player};
pub use parts::{Part, Parts};
pub use paths::{PATH_ITERATIONS, Paths};
pub use plan::{Cut, STUB, way};
pub use values::ValueSlider;
pub use visit::{Plan, Visit, Way};
pub use walk::{BODY, MoveInput, Walker};
pub use world::{WalkState, World};
