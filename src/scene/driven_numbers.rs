//! Sets the driven numbers of surfaces, from key frames or from named values.

use super::shape::{Numbers, Parameter};
use super::{Driver, Motion, Node, Quantity, Scene, SceneError, Shape, Surface};
use glam::{EulerRot, Quat, Vec3};
use std::collections::{BTreeMap, HashMap, HashSet};

/// Rate of the checks between key frames, in frames per second. It equals the default frame rate of a rendering, so
/// that a scene that loads can also be rendered.
const CHECKED_FPS: f64 = 30.0;

impl Surface {
    /// All numbers that a driver can set; see [`Surface::parameter_names`]. The numbers of the rotation (`rotation.x`
    /// …, in radians) are stored in [`Surface::angles`].
    pub(crate) fn parameters_mut(&mut self) -> Vec<Parameter<'_>> {
        let mut all = Vec::new();
        self.position
            .add_to("position", Quantity::Position, &mut all);
        self.angles.add_to("rotation", Quantity::Angle, &mut all);
        all.extend(self.shape.parameters_mut());
        all
    }

    /// Returns the surface with a driver for the number `parameter`.
    #[must_use]
    pub fn driven(mut self, parameter: &str, motion: Motion) -> Surface {
        let parameter = parameter.to_owned();
        self.dynamic_rotation |= parameter.starts_with("rotation.");
        self.drivers.push(Driver { parameter, motion });
        self
    }

    /// Sets each driven number for which `value` returns `Some`.
    fn drive(&mut self, value: impl Fn(&Surface, &Driver) -> Option<f32>) {
        let drivers = std::mem::take(&mut self.drivers);
        let mut values: HashMap<&str, f32> = HashMap::with_capacity(drivers.len());
        for driver in &drivers {
            if let Some(value) = value(self, driver) {
                values.insert(&driver.parameter, value);
            }
        }
        if !values.is_empty() {
            for parameter in self.parameters_mut() {
                if let Some(value) = values.get(parameter.name.as_str()) {
                    *parameter.number = *value;
                }
            }
        }
        if values.keys().any(|name| name.starts_with("rotation.")) {
            let Vec3 { x, y, z } = self.angles;
            self.rotation = Quat::from_euler(EulerRot::XYZEx, x, y, z);
        }
        self.drivers = drivers;
    }

    /// Sets the key-framed numbers to their values at `seconds`.
    pub(super) fn drive_to(&mut self, seconds: f64) {
        if !self.drivers.is_empty() {
            self.drive(|_, driver| driver.motion.at(seconds));
        }
    }

    /// The names of the numbers that [`Surface::driven`] can drive: `position.x` …, `rotation.x` …, the shape's own
    /// numbers (`radius`, `size.x` …), and the numbers of its children, prefixed with the child's index (`0.radius` …).
    pub fn parameter_names(&self) -> HashSet<String> {
        let mut bare = Surface {
            drivers: Vec::new(),
            name: None,
            shape: self.shape.clone(),
            material: None,
            walls: Default::default(),
            faces: Default::default(),
            ..*self
        };
        let parameters = bare.parameters_mut().into_iter();
        parameters.map(|parameter| parameter.name).collect()
    }

    /// Times in seconds at which the surface is checked: all keys in order, then the frames between the first and the
    /// last key at the default frame rate. If there are more than `most_between` frames, only every n-th frame is
    /// checked, with the smallest sufficient n.
    pub(super) fn checked_times(&self, most_between: usize) -> Vec<f64> {
        let mut times = Vec::new();
        for driver in &self.drivers {
            if let Motion::Keys(keys) = &driver.motion {
                times.extend(keys.iter().map(|(time, _)| *time));
            }
        }
        times.sort_by(f64::total_cmp);
        times.dedup();
        if let (Some(&first), Some(&last)) = (times.first(), times.last()) {
            let (first, last) = ((first * CHECKED_FPS).ceil(), (last * CHECKED_FPS).floor());
            let every = ((last - first) / most_between as f64).ceil().max(1.0);
            let between = (0..=most_between).map(|step| first + step as f64 * every);
            let between = between.take_while(|frame| *frame <= last);
            times.extend(between.map(|frame| frame / CHECKED_FPS));
        }
        times
    }

    /// Whether a driver moves one of a node's numbers, for each node of the surface's field in the order of
    /// [`Shape::nodes`].
    pub(crate) fn moving_nodes(&self, field: &Shape) -> Vec<bool> {
        let mut moving = vec![false; field.nodes().len()];
        for driver in &self.drivers {
            if driver.parameter.starts_with("position.")
                || driver.parameter.starts_with("rotation.")
            {
                continue;
            }
            mark(field, &driver.parameter, &mut moving);
        }
        moving
    }
}

/// Marks the node with the named parameter, and each twist, bend and repetition above that node. Their shader numbers
/// are derived from the bounds of their child.
fn mark(field: &Shape, parameter: &str, moving: &mut [bool]) {
    let mut node = field;
    let mut place = 0;
    let mut rest = parameter;
    loop {
        if matches!(node.node, Node::Twist(_) | Node::Bend(_) | Node::Repeat(_)) {
            moving[place] = true;
        }
        let step = rest.split_once('.').and_then(|(first, after)| {
            let index: usize = first.parse().ok()?;
            Some((index, after))
        });
        let Some((index, after)) = step.filter(|(index, _)| *index < node.children.len()) else {
            break;
        };
        let before = node.children[..index].iter().map(|f| f.nodes().len());
        place += 1 + before.sum::<usize>();
        node = &node.children[index];
        rest = after;
    }
    moving[place] = true;
}

impl Scene {
    /// Sets a named value at all its uses in the scene, in the unit of a scene file: metres, degrees for an angle,
    /// degrees per metre for the rate of a twist or a bend.
    ///
    /// ```
    /// use echomarch::scene::{Motion, shape::Sphere};
    /// use echomarch::{Listener, Scene, Source, Surface};
    /// use glam::Vec3;
    /// let door = Surface::new(Sphere { radius: 1.0 })
    ///     .driven("position.x", Motion::Named("door".into()));
    /// let source = Source::at(Vec3::Y * 5.0);
    /// let listener = Listener::at(Vec3::Z * 5.0, 0.5);
    /// let mut scene = Scene::new("hall", vec![door], source, listener);
    /// scene.set_value("door", 3.0)?;
    /// assert_eq!(scene.surfaces[0].position.x, 3.0);
    /// assert!(scene.set_value("window", 1.0).is_err());
    /// # Ok::<(), echomarch::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`SceneError::UnknownValue`] if the scene has no value with that name.
    pub fn set_value(&mut self, name: &str, value: f32) -> Result<(), SceneError> {
        self.set_values(&BTreeMap::from([(name.to_owned(), value)]))
    }

    /// Sets several named values, like [`Scene::set_value`], in one pass.
    pub(super) fn set_values(&mut self, values: &BTreeMap<String, f32>) -> Result<(), SceneError> {
        let names = self.value_names();
        let unknown = values
            .keys()
            .find(|name| names.binary_search(name).is_err());
        if let Some(name) = unknown {
            return Err(self.unknown_value(name, &names));
        }
        let named = |surface: &Surface, driver: &Driver| match &driver.motion {
            Motion::Named(name) => {
                let value = *values.get(name)?;
                Some(surface.quantity(&driver.parameter).in_code(value))
            }
            Motion::Keys(_) => None,
        };
        for surface in &mut self.surfaces {
            surface.drive(named);
        }
        self.drive_materials(values);
        Ok(())
    }

    /// The error of a name that is not one of the scene's named values.
    pub(super) fn unknown_value(&self, name: &str, names: &[String]) -> SceneError {
        SceneError::UnknownValue {
            scene: self.name.clone(),
            name: name.to_owned(),
            known: names.to_vec(),
        }
    }

    /// The names that [`Scene::set_value`] accepts, in alphabetic order and without duplicates.
    pub fn value_names(&self) -> Vec<String> {
        let drivers = self.surfaces.iter().flat_map(|s| &s.drivers);
        let mut names: Vec<String> = drivers
            .filter_map(|driver| match &driver.motion {
                Motion::Named(name) => Some(name.clone()),
                Motion::Keys(_) => None,
            })
            .collect();
        names.extend(
            self.material_drivers
                .iter()
                .map(|driver| driver.value.clone()),
        );
        names.sort();
        names.dedup();
        names
    }

    /// Sets the key-framed numbers of all surfaces to their values at `seconds`.
    pub(super) fn drive_to(&mut self, seconds: f64) {
        for surface in &mut self.surfaces {
            surface.drive_to(seconds);
        }
    }
}

/// The current state of a named value in a scene.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct NamedValue {
    /// Name in the scene.
    pub name: String,
    /// Current value, in the unit of the scene file.
    pub value: f32,
    /// Quantity. If the value drives several quantities, this is the quantity with the narrowest range.
    pub quantity: Quantity,
}

impl Scene {
    /// The named values of the scene, in alphabetic order and without duplicates.
    #[doc(hidden)]
    pub fn named_values(&self) -> Vec<NamedValue> {
        let mut values: Vec<NamedValue> = Vec::new();
        let mut add =
            |value: NamedValue| match values.iter_mut().find(|known| known.name == value.name) {
                None => values.push(value),
                Some(known) if known.quantity.rank() < value.quantity.rank() => *known = value,
                Some(_) => (),
            };
        for surface in &self.surfaces {
            for driver in &surface.drivers {
                let Motion::Named(name) = &driver.motion else {
                    continue;
                };
                let Some((value, quantity)) = surface.parameter(&driver.parameter) else {
                    continue;
                };
                add(NamedValue {
                    name: name.clone(),
                    value: quantity.in_file(value),
                    quantity,
                });
            }
        }
        self.values_of_materials().for_each(&mut add);
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

    /// Every operator that turns its child, and other shapes, all driven by the same named value.
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

    /// Protects the unit of named angles: setting a value to the number in the file changes nothing, and 60 means 60
    /// degrees.
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
