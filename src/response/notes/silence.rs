//! The note on a response without any arrival.

use crate::platform::HAS_FILES;
use crate::scene::Pair;

/// Why nothing arrives at the listener in a record of this length in seconds.
pub(super) fn reason(pair: Pair, seconds: f64) -> String {
    let scene = pair.scene();
    let (source, listener) = (pair.source(), pair.listener());
    if let Some(end) = end_in_solid(pair) {
        return format!("nothing arrives: {end} is inside a solid");
    }
    let length = f64::from(source.position.distance(listener.position) - listener.radius);
    let first_s = length / scene.speed_of_sound();
    if first_s > seconds {
        return format!(
            "nothing arrives, because sound takes {first_s:.3} s to the listener, and the record ends after {seconds:.3} s: use a longer record (seconds)"
        );
    }
    // A page in a browser has no documents beside it.
    let document = match HAS_FILES {
        true => ", docs/scene-format.md",
        false => "",
    };
    format!(
        "nothing arrives: look for a wall or a closed door between source and listener; sound passes a solid only if its material transmits sound (density or reduction{document}), and bends around obstacles only with diffraction"
    )
}

/// The end of a pair whose centre lies in a solid, such as that around a room.
pub(in crate::response) fn end_in_solid(pair: Pair) -> Option<&'static str> {
    let ends = [
        ("the source", pair.source().position),
        ("the listener", pair.listener().position),
    ];
    let mut ends = ends.into_iter();
    ends.find_map(|(end, place)| pair.scene().solid_at(place).map(|_| end))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::glam::Vec3;
    use crate::scene::shape::{Cuboid, Room};
    use crate::scene::{Listener, Scene, Source, Surface};

    /// Protects listeners in silence from a note without a reason.
    #[test]
    fn silence_has_a_reason() {
        let room = Surface::new(Room {
            size: Vec3::splat(10.0),
        });
        let door = Surface::new(Cuboid {
            size: Vec3::new(0.1, 10.0, 10.0),
        });
        let told = |source: f32, listener: f32, seconds: f64| {
            let source = Source::at(Vec3::X * source);
            let listener = Listener::at(Vec3::X * listener, 0.3);
            let surfaces = vec![room.clone(), door.clone()];
            let scene = Scene::new("s", surfaces, source, listener);
            reason(scene.only_pair().unwrap(), seconds)
        };
        assert!(told(-4.0, 4.0, 1.0).contains("a closed door between"));
        assert!(told(0.0, 4.0, 1.0).ends_with("the source is inside a solid"));
        assert!(told(-4.0, 7.0, 1.0).ends_with("the listener is inside a solid"));
        assert!(told(-4.0, 4.0, 0.01).contains("takes 0.022 s to the listener"));
    }
}
