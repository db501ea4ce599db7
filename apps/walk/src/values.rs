//! Sliders for the named values of a scene: their initial positions and ranges.

use echomarch::picture::Bounds;
use echomarch::scene::{NamedValue, Quantity, Scene};
use std::ops::RangeInclusive;

/// Factor by which a length may grow or shrink. The factor is a guess, because the size at which surfaces collide is
/// unknown.
const LENGTHS: f32 = 4.0;
/// A half turn, in degrees.
const HALF_TURN: f32 = 180.0;
/// Minimum half-width of a slider for a rate, in degrees per metre.
const LEAST_RATE: f32 = 45.0;
/// Minimum half-width of a slider for a number without a unit.
const LEAST_PLAIN: f32 = 1.0;

/// A slider for a named value, in the unit of the scene's file.
#[derive(Clone, Debug, PartialEq)]
pub struct ValueSlider {
    /// The value's name.
    pub name: String,
    /// The value in the scene file.
    pub start: f32,
    /// The slider's range.
    pub range: RangeInclusive<f32>,
    /// The step between two values; `None` for any value.
    pub step: Option<f32>,
    /// Whether the slider is logarithmic.
    pub is_logarithmic: bool,
    /// The unit shown behind the number.
    pub unit: &'static str,
}

/// Returns a slider for each named value of a scene, as read from the scene file.
pub fn value_sliders(scene: &Scene) -> Vec<ValueSlider> {
    let values = scene.named_values();
    if values.is_empty() {
        return Vec::new();
    }
    let height = scene
        .listeners
        .first()
        .map_or(0.0, |first| first.position.y);
    let shown = Bounds::of(scene, height);
    let reach = 0.5 * (shown.max - shown.min).max_element();
    let slider = |value: NamedValue| {
        let (name, start, quantity) = (value.name, value.value, value.quantity);
        let stated = scene.value_ranges.get(&name);
        ValueSlider {
            range: match stated {
                Some(stated) => stated.min..=stated.max,
                None => range(quantity, start, reach),
            },
            step: stated.and_then(|stated| stated.step),
            is_logarithmic: stated.is_none()
                && matches!(quantity, Quantity::Length | Quantity::Factor),
            unit: unit(quantity),
            name,
            start,
        }
    };
    values.into_iter().map(slider).collect()
}

/// The range of a slider whose initial value is `start`. `reach` is half of the extent of the scene's plan, in metres.
fn range(quantity: Quantity, start: f32, reach: f32) -> RangeInclusive<f32> {
    let about = |way: f32| start - way..=start + way;
    match quantity {
        Quantity::Share => 0.0..=1.0,
        Quantity::Length | Quantity::Factor => start / LENGTHS..=start * LENGTHS,
        Quantity::Angle if start.abs() <= HALF_TURN => -HALF_TURN..=HALF_TURN,
        Quantity::Angle => about(HALF_TURN),
        Quantity::Rate => about(start.abs().max(LEAST_RATE)),
        Quantity::Position => about(reach),
        Quantity::Plain => about(start.abs().max(LEAST_PLAIN)),
    }
}

fn unit(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Position | Quantity::Length => "m",
        Quantity::Angle => "°",
        Quantity::Rate => "°/m",
        Quantity::Factor | Quantity::Share | Quantity::Plain => "",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCENE: &str = r#"Scene(
        surfaces: [
            Surface(shape: Room(size: (20, 6, 20))),
            Surface(
                shape: Box(size: (Value("width", 2), 6, 0.5)),
                position: (Value("way", -3), 0, 0),
                rotation: (0, Value("door", 30), 0),
            ),
            Surface(shape: Morph(from: Sphere(radius: 1), to: Box(size: (1, 1, 1)), amount: Value("melt", 0.25)), position: (5, 0, 5)),
        ],
        source: Source(position: (0, 1, -5)), listener: Listener(position: (0, 1, 5), radius: 1))"#;

    /// Protects sliders from values that the scene rejects: shares stay between 0 and 1, lengths stay above 0, angles
    /// are in degrees as in the file, and both ends of every range are valid.
    #[test]
    fn sliders_go_as_far_as_the_scene_takes() {
        let scene = Scene::from_ron(SCENE, "s").unwrap();
        let sliders = value_sliders(&scene);
        let of = |name: &str| sliders.iter().find(|slider| slider.name == name).unwrap();
        assert_eq!(of("melt").range, 0.0..=1.0);
        assert_eq!(
            (of("door").range.clone(), of("door").unit),
            (-180.0..=180.0, "°")
        );
        assert_eq!(of("width").range, 0.5..=8.0);
        assert!((of("door").start - 30.0).abs() < 1e-4);
        let way = of("way");
        assert!(
            way.range.contains(&-10.0) && way.range.contains(&5.0),
            "{way:?}"
        );
        let mut world = super::super::World::of(scene).unwrap();
        for slider in &sliders {
            for end in [*slider.range.start(), *slider.range.end()] {
                world.set(&slider.name, end).unwrap();
                assert_eq!(world.value_of(slider), end);
            }
            world.set(&slider.name, slider.start).unwrap();
        }
        assert!(world.values.is_empty());
        assert!(world.set("melt", 2.0).is_err() && world.set("nothing", 2.0).is_err());
        world.set("door", 90.0).unwrap();
        assert!((world.base.surfaces[1].angles.y - 90f32.to_radians()).abs() < 1e-6);
        assert_eq!(world.values, [("door".to_owned(), 90.0)]);
    }

    /// Protects the range that a scene file states: the slider has its ends and its step.
    #[test]
    fn a_slider_has_the_range_of_the_file() {
        let ranges = "ranges: {\"door\": Range(min: 0, max: 90, step: 5), \"width\": Range(min: 1, max: 3)},";
        let text = SCENE.replacen("source:", &format!("{ranges} source:"), 1);
        let sliders = value_sliders(&Scene::from_ron(&text, "s").unwrap());
        let of = |name: &str| sliders.iter().find(|slider| slider.name == name).unwrap();
        assert_eq!(
            (of("door").range.clone(), of("door").step),
            (0.0..=90.0, Some(5.0))
        );
        let width = of("width");
        assert_eq!(
            (width.range.clone(), width.step, width.is_logarithmic),
            (1.0..=3.0, None, false)
        );
        assert_eq!(of("melt").range, 0.0..=1.0);
    }
}
