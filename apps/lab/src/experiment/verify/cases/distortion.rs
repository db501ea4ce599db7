//! Distance functions that over-estimate.

use super::super::Case;
use super::build::{builtin, lattice};

pub fn cases() -> Vec<Case> {
    vec![
        overestimated("corner", 1.5),
        overestimated("obstacles", 2.0),
        overestimated("open-pillars", 10.0),
    ]
}

fn overestimated(name: &str, factor: f32) -> Case {
    Case::spread(
        format!("{name}-overestimated-{factor}"),
        "the distance is too large by a factor: steps lead through walls",
        "that of the scene, with a Lipschitz bound above the factor; not with a bound of 1",
        builtin(name),
        lattice(1024),
        8,
    )
    .overestimated(factor)
}
