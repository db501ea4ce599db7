//! The named values of a scene.

use super::{Motion, Quantity, Scene, Surface};

/// The current state of a named value in a scene.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct NamedValue {
    /// Its name.
    pub name: String,
    /// Its value, in the unit of the file.
    pub value: f32,
    /// Its quantity; of several uses with different quantities, the one with the narrowest range.
    pub quantity: Quantity,
}

impl Scene {
    /// The named values of the scene in alphabetic order, each once.
    pub fn named_values(&self) -> Vec<NamedValue> {
        let mut values: Vec<NamedValue> = Vec::new();
        for surface in &self.surfaces {
            for driver in &surface.drivers {
                let Motion::Named(name) = &driver.motion else {
                    continue;
                };
                let Some((value, quantity)) = surface.parameter(&driver.parameter) else {
                    continue;
                };
                let value = NamedValue {
                    name: name.clone(),
                    value: quantity.in_file(value),
                    quantity,
                };
                match values.iter_mut().find(|known| known.name == *name) {
                    None => values.push(value),
                    Some(known) if known.quantity.rank() < quantity.rank() => *known = value,
                    Some(_) => (),
                }
            }
        }
        values.sort_by(|a, b| a.name.cmp(&b.name));
        values
    }
}

impl Surface {
    /// The quantity of one of the surface's numbers, by its name (see
    /// [`Surface::parameter_names`]).
    pub fn quantity(&self, parameter: &str) -> Quantity {
        let found = self.parameter(parameter);
        found.map_or(Quantity::Plain, |(_, quantity)| quantity)
    }

    /// The value of a number, and its quantity.
    fn parameter(&self, parameter: &str) -> Option<(f32, Quantity)> {
        let mut copy = self.clone();
        let mut all = copy.parameters_mut().into_iter();
        let found = all.find(|known| known.name == parameter)?;
        Some((*found.number, found.quantity))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every operator that turns, with other shapes, all driven by one name.
    const TURNS: &str = r#"Scene(
        surfaces: [
            Surface(shape: Plane, position: (0, Value("a", 30), 0), rotation: (0, 0, Value("a", 30))),
            Surface(shape: Union(of: [
                Translate(of: Rotate(of: Box(size: (1, 1, 1)), by: (0, Value("a", 30), 0)), by: (Value("a", 30), 0, 0)),
                Twist(of: Box(size: (1, 1, 1)), rate: Value("a", 30), lipschitz: 90),
                Bend(of: Box(size: (1, 1, 1)), rate: Value("a", 30), lipschitz: 90),
            ])),
        ],
        source: Source(position: (0, 1, -5)), listener: Listener(position: (0, 1, 5), radius: 1))"#;

    /// Protects the unit of the file everywhere that an angle may be used: setting a value to the number in the
    /// file changes nothing, and 60 means 60 degrees.
    #[test]
    fn values_are_in_the_unit_of_the_file() {
        let read = Scene::from_ron(TURNS, "turns").unwrap();
        let mut set = read.clone();
        set.set_value("a", 30.0).unwrap();
        assert_eq!(set.surfaces, read.surfaces);
        set.set_value("a", 60.0).unwrap();
        let expected = Scene::from_ron(&TURNS.replace("30", "60"), "turns").unwrap();
        assert_eq!(set.surfaces, expected.surfaces);
        let values = set.named_values();
        assert_eq!((values.len(), values[0].quantity), (1, Quantity::Angle));
        assert!((values[0].value - 60.0).abs() < 1e-4);
    }
}
