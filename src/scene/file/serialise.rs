//! Serialisation and deserialisation of scenes with serde, in any format, with the structure of a scene file.
//!
//! The names of the fields are those of the types for reading ([`Form`]), and values have the units of a scene file.
//! Reading and writing thus share one notation.

use super::SceneFile;
use super::sources_and_listeners::DIRECTIVITIES;
use crate::bands::{BAND_COUNT, Bands};
use crate::scene::ValueRange;
use crate::scene::notation::{Attached, Fields, Form, ShapeName, Written};
use crate::scene::shape::Room;
use crate::scene::shape::{form_of, numbered};
use crate::scene::{
    Air, Directivity, Driver, Listener, Material, MaterialDriver, MaterialNumber, Motion, Path,
    Quantity, Scene, Shape, Source, Surface, Transmission,
};
use glam::{EulerRot, Quat, Vec3};
use serde::{Deserialize, Deserializer, Serialize, Serializer, de, ser};
use std::collections::BTreeMap;

/// A scene is serialised with the structure of a scene file, and includes the content of its base. Height images,
/// users' GLSL and measured directivities are written as file names; the files are read again when the scene is read.
///
/// ```
/// # use echomarch::Scene;
/// let scene = Scene::builtin("corner")?;
/// let text = serde_json::to_string(&scene).expect("the scene is valid");
/// let same: Scene = serde_json::from_str(&text).expect("the text is a scene");
/// assert_eq!(same.surfaces.len(), scene.surfaces.len());
/// # Ok::<(), echomarch::Error>(())
/// ```
///
/// Rotations are written as three angles in degrees, so the last digits may change. A scene is read in its state at
/// time 0. A scene that [`Scene::check`] rejects, or that has no source or no listener, can neither be written nor
/// read.
impl Serialize for Scene {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.check().map_err(ser::Error::custom)?;
        let mut fields = Fields::new();
        if !self.name.is_empty() {
            fields.push(("name", Written::Text(self.name.clone())));
        }
        let surfaces = self.surfaces.iter().map(surface).collect();
        fields.push(("surfaces", Written::List(surfaces)));
        if !self.materials.is_empty() {
            let materials = self.materials.iter();
            let written = |(name, of): (&String, &Material)| {
                let drivers = self.material_drivers.iter();
                let drivers = drivers.filter(|driver| driver.material == *name);
                let written = material(of, self.scattering, &drivers.collect::<Vec<_>>());
                (name.clone(), written)
            };
            fields.push(("materials", Written::Map(materials.map(written).collect())));
        }
        if self.scattering != [0.0; BAND_COUNT] {
            fields.push(("scattering", by_band(self.scattering)));
        }
        if !self.value_ranges.is_empty() {
            let ranges = self.value_ranges.iter();
            let ranges = ranges.map(|(name, range)| (name.clone(), value_range(range)));
            fields.push(("ranges", Written::Map(ranges.collect())));
        }
        fields.extend(self.air.map(|of| ("air", air(of))));
        fields.push(match &self.sources[..] {
            [] => return Err(ser::Error::custom(none_of(self, "source"))),
            [only] => ("source", source(only)),
            _ => ("sources", sources(self)),
        });
        fields.push(match &self.listeners[..] {
            [] => return Err(ser::Error::custom(none_of(self, "listener"))),
            [only] => ("listener", listener(only)),
            _ => ("listeners", listeners(self)),
        });
        Written::Struct("Scene", fields).serialize(serializer)
    }
}

fn value_range(of: &ValueRange) -> Written {
    let mut fields = Fields::new();
    fields.push(("min", Written::Number(of.min)));
    fields.push(("max", Written::Number(of.max)));
    fields.extend(of.step.map(|step| ("step", Written::Number(step))));
    Written::Struct("Range", fields)
}

fn none_of(scene: &Scene, what: &str) -> String {
    format!("scene {:?} has no {what}, and a file needs one", scene.name)
}

/// File names in the scene are relative to the current folder.
impl<'de> Deserialize<'de> for Scene {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Scene, D::Error> {
        let file = SceneFile::deserialize(deserializer)?;
        let files = Attached::in_folder("the scene", std::path::Path::new(""));
        let scene = file.scene(&files, None);
        let scene = scene.map_err(|refused| de::Error::custom(refused.without_place()))?;
        scene.check().map_err(de::Error::custom)?;
        Ok(scene)
    }
}

/// All sources, in order.
pub(super) fn sources(of: &Scene) -> Written {
    Written::List(of.sources.iter().map(source).collect())
}

/// All listeners, in order.
pub(super) fn listeners(of: &Scene) -> Written {
    Written::List(of.listeners.iter().map(listener).collect())
}

/// A material of a scene with this scattering. Values that reading supplies are left out.
fn material(of: &Material, scattering: Bands, drivers: &[&MaterialDriver]) -> Written {
    let parts = [
        ("absorption", MaterialNumber::Absorption, [0.0; BAND_COUNT]),
        ("scattering", MaterialNumber::Scattering, scattering),
    ];
    let mut fields = Fields::new();
    for (part, number, supplied) in parts {
        let bands = *number.of(of);
        let of_number = drivers.iter().filter(|driver| driver.number == number);
        let of_number: Vec<_> = of_number.copied().collect();
        if !of_number.is_empty() {
            fields.push((part, driven_by_band(bands, &of_number)));
        } else if bands != supplied {
            fields.push((part, by_band(bands)));
        }
    }
    match of.transmission {
        None => {}
        Some(Transmission::Reduction {
            index_db,
            thickness_m,
        }) => fields.extend([
            ("reduction", by_band(index_db)),
            ("thickness", Written::Real(thickness_m)),
        ]),
        Some(Transmission::Mass {
            density,
            coincidence,
        }) => {
            fields.push(("density", Written::Real(density)));
            fields.extend(coincidence.map(|product| ("coincidence", Written::Real(product))));
        }
    }
    Written::Struct("Material", fields)
}

/// The numbers of a material that named values set.
fn driven_by_band(bands: Bands, drivers: &[&MaterialDriver]) -> Written {
    let named = |driver: &MaterialDriver, number: f64| {
        Written::Named(driver.value.clone(), Box::new(Written::Real(number)))
    };
    // If several drivers set the same number, the last driver applies.
    let is_one = bands == [bands[0]; BAND_COUNT];
    if let (true, Some(last)) = (
        is_one,
        drivers.last().filter(|driver| driver.band.is_none()),
    ) {
        return named(last, bands[0]);
    }
    let of_band = |(band, number): (usize, &f64)| {
        let mut drivers = drivers.iter().rev();
        let driver = drivers.find(|driver| driver.band.is_none_or(|of| of == band));
        driver.map_or(Written::Real(*number), |driver| named(driver, *number))
    };
    Written::List(bands.iter().enumerate().map(of_band).collect())
}

/// One number if it is the same in all bands, otherwise eight numbers.
fn by_band(bands: Bands) -> Written {
    match bands == [bands[0]; BAND_COUNT] {
        true => Written::Real(bands[0]),
        false => Written::List(bands.map(Written::Real).to_vec()),
    }
}

fn air(of: Air) -> Written {
    let fields = vec![
        ("temperature", Written::Real(of.temperature)),
        ("humidity", Written::Real(of.humidity)),
        ("pressure", Written::Real(of.pressure)),
    ];
    Written::Struct("Air", fields)
}

/// The `name` field, if there is a name.
fn named(name: &Option<String>) -> Fields {
    let name = name.iter().cloned();
    name.map(|name| ("name", Written::Text(name))).collect()
}

fn source(of: &Source) -> Written {
    let mut fields = named(&of.name);
    if of.level_db != 0.0 {
        fields.push(("level_db", Written::Number(of.level_db)));
    }
    fields.push(("position", point(of.position)));
    // Most sources have no angles, so angles of 0 are not written.
    let angles = [("yaw", of.yaw), ("pitch", of.pitch)];
    let angles = angles.into_iter().filter(|(_, angle)| *angle != 0.0);
    fields.extend(angles.map(|(name, angle)| (name, degrees(angle))));
    fields.extend(directivity(&of.directivity).map(|written| ("directivity", written)));
    fields.extend(path(&of.path));
    Written::Struct("Source", fields)
}

/// The notation of a directivity; `None` for an omnidirectional source.
fn directivity(of: &Directivity) -> Option<Written> {
    let index = DIRECTIVITIES.iter().position(|kind| *kind == of.kind())?;
    let name = ShapeName {
        name: of.kind(),
        index: index as u32,
    };
    match of {
        Directivity::Omnidirectional => None,
        Directivity::FirstOrder(shares) => Some(Written::Holding(name, Box::new(by_band(*shares)))),
        Directivity::Balloon(balloon) => {
            let file = Written::Text(balloon.name().to_owned());
            Some(Written::With(name, vec![("file", file)]))
        }
    }
}

fn listener(of: &Listener) -> Written {
    let mut fields = named(&of.name);
    fields.extend([
        ("position", point(of.position)),
        ("yaw", degrees(of.yaw)),
        ("pitch", degrees(of.pitch)),
        ("radius", Written::Number(of.radius)),
    ]);
    fields.extend(path(&of.path));
    Written::Struct("Listener", fields)
}

fn path(of: &Path) -> Option<(&'static str, Written)> {
    if of.is_empty() {
        return None;
    }
    let keys = of.keys().iter().map(|key| {
        let fields = vec![
            ("time", Written::Real(key.time)),
            ("position", point(key.position)),
            ("yaw", degrees(key.yaw)),
            ("pitch", degrees(key.pitch)),
        ];
        Written::Struct("Key", fields)
    });
    Some(("path", Written::List(keys.collect())))
}

fn surface(of: &Surface) -> Written {
    let mut drivers = of.drivers.iter();
    let turning = drivers.any(|driver| driver.parameter.starts_with("rotation."));
    let mut fields = named(&of.name);
    fields.push(("shape", node(&of.shape, "", &of.drivers)));
    let position = of.position.to_array();
    fields.push(("position", along_axes(position, "position", &of.drivers)));
    if turning || of.rotation != Quat::IDENTITY {
        let angles = match turning {
            true => of.angles.to_array().map(|a| in_file(Quantity::Angle, a)),
            false => angles_of(of.rotation),
        };
        fields.push(("rotation", along_axes(angles, "rotation", &of.drivers)));
    }
    if of.dynamic_rotation && !turning {
        fields.push(("turns", Written::Flag(true)));
    }
    let material = of.material.iter().cloned();
    fields.extend(material.map(|name| ("material", Written::Text(name))));
    if of.walls.iter().any(Option::is_some) {
        let walls = Room::WALL_NAMES.into_iter().zip(&of.walls);
        let named = walls.filter_map(|(wall, name)| Some((wall, Written::Text(name.clone()?))));
        fields.push(("walls", Written::Struct("Walls", named.collect())));
    }
    if !of.faces.is_empty() {
        let faces = of.faces.iter();
        let named = faces.map(|(group, name)| (group.clone(), Written::Text(name.clone())));
        fields.push(("faces", Written::Map(named.collect())));
    }
    Written::Struct("Surface", fields)
}

/// The angles of a rotation in degrees, about x, then y, then z of the world axes.
fn angles_of(rotation: Quat) -> [f32; 3] {
    let (x, y, z) = rotation.as_dquat().normalize().to_euler(EulerRot::XYZEx);
    [x, y, z].map(|angle| angle.to_degrees() as f32)
}

/// Three numbers of a surface along the axes, in the unit of a scene file.
fn along_axes(values: [f32; 3], name: &str, drivers: &[Driver]) -> Written {
    let axes = ["x", "y", "z"].into_iter().zip(values);
    let quantity = match name {
        "rotation" => Quantity::Angle,
        _ => Quantity::Position,
    };
    let one = |(axis, value)| number(&format!("{name}.{axis}"), value, quantity, drivers);
    Written::Tuple(axes.map(one).collect())
}

/// A tree of shapes. The names of its numbers begin with `at`.
fn node(of: &Shape, at: &str, drivers: &[Driver]) -> Written {
    let part = of.node.part();
    let child = |(index, child)| node(child, &format!("{at}{index}."), drivers);
    let children = of.children.iter().enumerate().map(child).collect();
    let mut said: BTreeMap<String, Written> = BTreeMap::new();
    let words = part.written_children(children).into_iter();
    said.extend(words.chain(part.words()).map(|(k, v)| (k.to_owned(), v)));
    let mut copy = of.node.clone();
    let numbers = copy.part_mut().parameters_mut().into_iter().map(|own| {
        let value = in_file(own.quantity, *own.number);
        let name = format!("{at}{}", own.name);
        let written = number(&name, value, own.quantity, drivers);
        (own.name, written)
    });
    said.extend(grouped(numbers.collect()));
    let name = of.node.name_in_files();
    match form_of(name) {
        Some(Form::Fields(fields)) => {
            let fields = fields.iter().copied();
            let fields = fields.filter_map(|field| Some((field, said.remove(field)?)));
            Written::With(numbered(name), fields.collect())
        }
        _ => match said.into_values().next() {
            Some(value) => Written::Holding(numbered(name), Box::new(value)),
            None => Written::Plain(numbered(name)),
        },
    }
}

/// Groups numbers by the first part of their names: the components of a vector become `(x, y)`, and those of a list of
/// vectors become `[(x, y), …]`.
fn grouped(numbers: Vec<(String, Written)>) -> Vec<(String, Written)> {
    let mut groups: Vec<(String, Vec<(String, Written)>)> = Vec::new();
    for (name, number) in numbers {
        let (first, rest) = name.split_once('.').unwrap_or((&name, ""));
        let member = (rest.to_owned(), number);
        match groups.last_mut() {
            Some((known, members)) if known == first => members.push(member),
            _ => groups.push((first.to_owned(), vec![member])),
        }
    }
    let together = |(name, members)| (name, together(members));
    groups.into_iter().map(together).collect()
}

fn together(mut members: Vec<(String, Written)>) -> Written {
    if members.len() == 1 && members[0].0.is_empty() {
        return members.remove(0).1;
    }
    let of_vectors = members.iter().any(|(name, _)| name.contains('.'));
    let items = grouped(members).into_iter().map(|(_, item)| item).collect();
    match of_vectors {
        true => Written::List(items),
        false => Written::Tuple(items),
    }
}

/// A number with its motion; `value` is in the unit of a scene file.
fn number(name: &str, value: f32, quantity: Quantity, drivers: &[Driver]) -> Written {
    // If several drivers set the same number, the last driver applies.
    let driver = drivers.iter().rev().find(|d| d.parameter == name);
    match driver.map(|driver| &driver.motion) {
        None => Written::Number(value),
        Some(Motion::Named(name)) => Written::Named(name.clone(), Box::new(Written::Number(value))),
        Some(Motion::Keys(keys)) => {
            let keys = keys.iter();
            Written::Keys(keys.map(|(t, v)| (*t, in_file(quantity, *v))).collect())
        }
    }
}

pub(super) fn degrees(radians: f32) -> Written {
    Written::Number(in_file(Quantity::Angle, radians))
}

fn point(of: Vec3) -> Written {
    Written::Tuple(of.to_array().map(Written::Number).to_vec())
}

/// Converts a number from the unit of the code to the unit of a scene file. If possible, the result converts back to
/// exactly the same number.
fn in_file(quantity: Quantity, value: f32) -> f32 {
    let near = quantity.in_file(value);
    let all = [near, near.next_up(), near.next_down()];
    let same = |said: &f32| quantity.in_code(*said) == value;
    all.into_iter().find(same).unwrap_or(near)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;
    use crate::scene::shape::tests::table::{Entry, entries, scene_of, surfaces};
    use crate::test_common::Random;

    fn through_ron(scene: &Scene) -> Scene {
        let text = ron::to_string(scene).unwrap();
        Scene::from_ron(&text, "written").unwrap_or_else(|error| panic!("{error}\n{text}"))
    }

    /// Whether the field needs no additional files.
    fn is_whole(entry: &Entry) -> bool {
        let mut nodes = entry.field.nodes().into_iter();
        nodes.all(|part| {
            !part
                .node
                .part()
                .words()
                .iter()
                .any(|(k, _)| ["image", "file"].contains(k))
        })
    }

    fn assert_same(read: &Scene, written: &Scene) {
        let bare = |scene: &Scene| Scene {
            surfaces: Vec::new(),
            ..scene.clone()
        };
        assert_eq!(bare(read), bare(written));
        assert_eq!(read.surfaces.len(), written.surfaces.len());
        let mut random = Random(5);
        for (read, written) in read.surfaces.iter().zip(&written.surfaces) {
            assert_eq!(
                (&read.name, read.position),
                (&written.name, written.position)
            );
            assert_eq!(
                (&read.material, &read.walls, &read.faces),
                (&written.material, &written.walls, &written.faces)
            );
            assert_eq!(read.drivers.len(), written.drivers.len());
            for driver in &written.drivers {
                assert!(read.drivers.contains(driver), "{driver:?}");
            }
            assert!(read.rotation.angle_between(written.rotation) < 1e-3);
            assert_eq!(read.has_rotation(), written.has_rotation());
            let names = |shape: &Shape| -> Vec<&str> {
                shape.nodes().iter().map(|part| part.name()).collect()
            };
            assert_eq!(names(&read.shape), names(&written.shape));
            for _ in 0..20 {
                let p = 3.0 * random.unit() * random.direction();
                let (read, written) = (read.shape.value(p), written.shape.value(p));
                assert!(
                    (read - written).abs() <= 1e-5 * (1.0 + written.abs()),
                    "{p}"
                );
            }
        }
    }

    /// Protects every shape and operator: a written shape is read without changes.
    #[test]
    fn every_shape_is_read_as_it_was_written() {
        for entry in entries().iter().filter(|entry| is_whole(entry)) {
            let scene = scene_of(surfaces(entry).to_vec());
            assert_same(&through_ron(&scene), &scene);
        }
    }

    /// Protects moving numbers and the units of a scene file: text and scene convert to each other without loss.
    #[test]
    fn what_moves_is_read_as_it_was_written() {
        const TEXT: &str = r#"Scene(
            name: "moving",
            surfaces: [
                Surface(name: "door", shape: Box(size: (Value("wide", 1), 2, Keys([(0, 1), (2, 3)]))),
                    rotation: (0, Value("open", 30), 0)),
                Surface(shape: Shell(of: Torus(ring: 2, tube: Value("tube", 0.5)), thickness: 0.1),
                    position: (Keys([(0, 8), (1, 9)]), 0, 0), rotation: (10, 20, 30), turns: true),
                Surface(shape: Cylinder(radius: 0.5, height: Value("tall", 2), axis: X),
                    position: (0, 9, 0)),
                Surface(shape: Prism(corners: [(0, 0), (1, 0), (0, Value("up", 1))], depth: 1),
                    position: (0, -9, 0), material: "tiles"),
                Surface(shape: Room(size: (90, 90, 90)), material: "brick",
                    walls: (floor: "carpet", back: "tiles")),
            ],
            materials: {
                "tiles": Material(absorption: 0.015, scattering: 0.1),
                "pane": Material(density: 2500, coincidence: 12.7),
                "wall": Material(reduction: [30, 33, 36, 39, 42, 45, 48, 51], thickness: 0.1),
            },
            scattering: [0.1, 0.1, 0.2, 0.2, 0.3, 0.3, 0.4, 0.4],
            air: Air(temperature: 7.3),
            sources: [
                Source(path: [Key(time: 0, position: (0, 0, 5)), Key(time: 1, position: (1, 0, 5), yaw: 90)],
                    directivity: FirstOrder([1, 0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3])),
                Source(yaw: 15, pitch: -30, directivity: Cardioid),
            ],
            listener: Listener(position: (0, 0, -5), yaw: 33, pitch: -7, radius: 0.3),
        )"#;
        let scene = Scene::from_ron(TEXT, "moving").unwrap();
        let read = through_ron(&scene);
        assert_same(&read, &scene);
        assert_eq!(read.named_values(), scene.named_values());
    }

    /// Protects other formats, and built-in scenes, whose fields are embedded in the program.
    #[test]
    fn built_in_scenes_go_through_json() {
        for name in Scene::BUILTIN_NAMES {
            let scene = Scene::builtin(name).unwrap();
            let text = serde_json::to_string(&scene).unwrap();
            let read: Scene = serde_json::from_str(&text).unwrap_or_else(|e| panic!("{name}: {e}"));
            assert_same(&read, &scene);
        }
    }

    /// Protects readers from scenes that no file can contain: an invalid scene is not written.
    #[test]
    fn an_unsound_scene_is_not_written() {
        let mut scene = Scene::builtin("corner").unwrap();
        scene.listeners[0].radius = f32::NAN;
        assert!(ron::to_string(&scene).is_err());
        for clear in [
            |scene: &mut Scene| scene.sources.clear(),
            |scene: &mut Scene| scene.listeners.clear(),
        ] {
            let mut scene = Scene::builtin("corner").unwrap();
            clear(&mut scene);
            scene.check().unwrap();
            let refused = ron::to_string(&scene).unwrap_err().to_string();
            assert!(refused.contains("and a file needs one"), "{refused}");
        }
        assert!(serde_json::from_str::<Scene>("{}").is_err());
    }
}
