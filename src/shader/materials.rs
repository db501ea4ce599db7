//! The materials of a scene as numbers, for shaders and for the replay of waves on the CPU.
//!
//! A reflection is an *event* with a number. Number 0 is a reflection without loss or scattering. Each distinct
//! material has a number for mirrored waves, and each material that scatters has a second number for scattered waves. A
//! wave carries no energies: the shader records the events, and the CPU multiplies their effects on the energy in
//! `f64`.
//!
//! For each surface the shader reads one float. Its whole part is the event, and its fraction is half the scattered
//! share, which is common to all bands that are traced together. If these bands scatter by different shares, a share
//! between them decides the direction of the wave, and the energy factor of the event compensates for the difference.
//! Each reflection multiplies by such a factor, so the energies of the waves in a band spread: after many reflections few
//! waves would carry nearly all of the band's energy, unless resampling (`tracer/arrivals/resampling.rs`) evens the
//! energies now and then. Bands with too large a spread are traced with separate waves ([`band_groups`]).
//!
//! Materials whose solids transmit sound have consecutive numbers ([`Materials::transmitting`]), by which the shader
//! recognises the hits at which a part of a wave may pass a solid. A material on a surface with a far side then differs
//! from the same material on a surface without one, such as the walls of a room.
//!
//! If there are few numbers, those of unrolled surfaces are uniforms, and those of surfaces in cells are in the
//! directory (`scene_data.rs`). More than [`MOST_IN_UNIFORMS`] numbers are a table in the scene's data. Without the
//! table the number of uniforms would limit a scene with materials to fewer surfaces than a scene without materials.

use super::distinct_materials::{
    Distinct, MaterialBits, distinct, faces, has_far_side, materials_met, walls,
};
use crate::bands::{BAND_COUNT, Bands};
use crate::scene::shape::Room;
use crate::scene::{Material, Scene};
use glam::Vec4;
use std::collections::HashMap;
use std::ops::Range;

/// Maximum bits of an event. A float can represent all whole numbers of this size together with a fraction.
const MOST_BITS: u32 = 14;

/// Maximum numbers in uniforms: 16 vectors of the 224 that OpenGL ES 3.0 guarantees. (A shader compares the object with
/// one number after another. From a few dozen numbers on, these comparisons take as long as reading a table.)
const MOST_IN_UNIFORMS: usize = 64;

/// The distinct materials of a scene's surfaces.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Materials {
    /// The bands that are traced together.
    bands: Range<usize>,
    /// The distinct materials; those that scatter come first.
    distinct: Vec<Distinct>,
    /// Number of materials that scatter.
    scattering: usize,
    /// The places of the materials that transmit.
    transmitting: Range<usize>,
    /// The number that the shader reads for each surface.
    of_surfaces: Vec<f32>,
    /// The rooms whose walls have different materials, by index, and the numbers of their walls.
    walls: Vec<(usize, [f32; Room::WALL_COUNT])>,
    /// The meshes whose groups have different materials, by index, and the numbers of their groups.
    groups: Vec<(usize, Vec<f32>)>,
}

impl Materials {
    /// The materials of the scene for waves that carry these bands. No solid transmits. The result is empty if no
    /// surface absorbs or scatters.
    pub fn of(scene: &Scene, bands: Range<usize>) -> Materials {
        Materials::numbered(scene, bands, |_, _| false)
    }

    /// The same, with the transmission of solids.
    pub fn with_transmission(scene: &Scene, bands: Range<usize>) -> Materials {
        let carried = bands.clone();
        Materials::numbered(scene, bands, move |index, material| {
            let absorbs = material.absorption[carried.clone()]
                .iter()
                .any(|a| *a > 0.0);
            material.transmission.is_some() && absorbs && has_far_side(scene, index)
        })
    }

    /// The materials of the scene; `transmits` returns whether the solid of a surface (counted from 0) transmits if it
    /// has this material.
    fn numbered(
        scene: &Scene,
        bands: Range<usize>,
        transmits: impl Fn(usize, &Material) -> bool,
    ) -> Materials {
        let mut materials = Materials {
            bands: bands.clone(),
            ..Materials::default()
        };
        if !scene.has_materials() {
            return materials;
        }
        let of = |index, wall| {
            let material = scene.material(index, wall).unwrap_or(Material::MIRROR);
            let transmits = transmits(index, &material);
            Distinct {
                material,
                transmits,
            }
        };
        let scatters = |one: &Distinct| one.material.scatters(bands.clone());
        materials.distinct = distinct(faces(scene).map(|(index, wall)| of(index, wall)));
        // Both the materials that scatter and those that transmit are consecutive.
        let order = |one: &Distinct| match (scatters(one), one.transmits) {
            (true, transmits) => u8::from(transmits),
            (false, transmits) => 3 - u8::from(transmits),
        };
        materials.distinct.sort_by_key(order);
        let all = &materials.distinct;
        let first = all.iter().position(|one| one.transmits).unwrap_or(0);
        let transmitting = all.iter().filter(|one| one.transmits).count();
        materials.scattering = all.iter().filter(|one| scatters(one)).count();
        materials.transmitting = first..first + transmitting;
        let numbers = materials.numbers();
        let number = |index, wall| {
            let key = of(index, wall).bits();
            numbers.get(&key).copied().unwrap_or(0.0)
        };
        let of_surfaces = (0..scene.surfaces.len()).map(|index| number(index, None));
        let of_surfaces: Vec<f32> = of_surfaces.collect();
        let mut rooms = Vec::new();
        let mut groups = Vec::new();
        for (index, of_surface) in of_surfaces.iter().enumerate() {
            let numbers: Vec<f32> = walls(scene, index)
                .map(|wall| number(index, wall))
                .collect();
            if numbers.iter().all(|number| number == of_surface) {
                continue;
            }
            if scene.surfaces[index].shape.mesh().is_some() {
                groups.push((index, numbers));
            } else if let Ok(walls) = <[f32; Room::WALL_COUNT]>::try_from(numbers) {
                rooms.push((index, walls));
            }
        }
        Materials {
            of_surfaces,
            walls: rooms,
            groups,
            ..materials
        }
    }

    /// The number that shaders read for each distinct material.
    fn numbers(&self) -> HashMap<MaterialBits, f32> {
        let all = self.distinct.iter().enumerate();
        let number = |place: usize, material| (place + 1) as f32 + 0.5 * self.share(material);
        all.map(|(place, one)| (one.bits(), number(place, &one.material)))
            .collect()
    }

    /// Whether no surface absorbs or scatters.
    pub fn is_empty(&self) -> bool {
        self.distinct.is_empty()
    }

    /// Whether any material scatters.
    pub fn scatter(&self) -> bool {
        self.scattering > 0
    }

    /// Whether the solid of any surface transmits.
    pub fn transmit(&self) -> bool {
        !self.transmitting.is_empty()
    }

    /// The materials whose solids transmit: the number before the first of them, and the number of the last one.
    pub fn transmitting(&self) -> Range<usize> {
        self.transmitting.clone()
    }

    /// Number of distinct materials. This count is added to the number of an event if the wave is scattered.
    pub fn count(&self) -> usize {
        self.distinct.len()
    }

    /// Bits of an event; 0 without materials. A float cannot represent events of more than [`Materials::MOST_BITS`]
    /// bits.
    pub fn bits(&self) -> u32 {
        let events = self.distinct.len() + self.scattering;
        usize::BITS - events.leading_zeros()
    }

    /// Maximum bits of an event.
    pub const MOST_BITS: u32 = MOST_BITS;

    /// The rooms whose walls have different materials, by index.
    pub fn rooms(&self) -> Vec<usize> {
        self.walls.iter().map(|(room, _)| *room).collect()
    }

    /// Whether the groups of a mesh have different materials.
    pub fn has_groups(&self) -> bool {
        !self.groups.is_empty()
    }

    /// The number that shaders read for each surface.
    pub fn of_surfaces(&self) -> &[f32] {
        &self.of_surfaces
    }

    /// The vectors of a table in the scene's data that begins at index `first`. The table has the number of each
    /// surface. For a room whose walls differ the table also has the index of two vectors with the numbers of the
    /// walls; for a mesh whose groups differ, the index of the number of its first group, and the number of its last
    /// group.
    pub fn table(&self, first: usize) -> Vec<Vec4> {
        let own = |number: &f32| Vec4::new(*number, 0.0, 0.0, 0.0);
        let mut table: Vec<Vec4> = self.of_surfaces.iter().map(own).collect();
        for (room, [left, right, floor, ceiling, front, back]) in &self.walls {
            table[*room].y = (first + table.len()) as f32;
            table.push(Vec4::new(*left, *right, *floor, *ceiling));
            table.push(Vec4::new(*front, *back, 0.0, 0.0));
        }
        for (mesh, numbers) in &self.groups {
            table[*mesh].z = (first + table.len()) as f32;
            table[*mesh].w = numbers.len() as f32 - 1.0;
            table.extend(numbers.iter().map(own));
        }
        table
    }

    /// Whether the numbers of `unrolled` surfaces are uniforms. The numbers of groups of meshes are always in a table.
    pub fn fit(&self, unrolled: usize) -> bool {
        Materials::fit_uniforms(unrolled, self.walls.len()) && self.groups.is_empty()
    }

    /// Whether the numbers of `unrolled` surfaces fit in uniforms. `rooms` is the number of these surfaces that are
    /// rooms whose walls differ.
    pub fn fit_uniforms(unrolled: usize, rooms: usize) -> bool {
        unrolled + (Room::WALL_COUNT - 1) * rooms <= MOST_IN_UNIFORMS
    }

    /// The numbers of some surfaces in vectors of four, or of all walls of a room whose walls differ. The result is
    /// empty if the numbers do not fit in uniforms.
    pub fn uniform_values(&self, surfaces: &[usize]) -> Vec<Vec4> {
        if !self.fit(surfaces.len()) {
            return Vec::new();
        }
        let mut numbers = Vec::new();
        for index in surfaces {
            match self.walls.iter().find(|(room, _)| room == index) {
                Some((_, walls)) => numbers.extend(walls),
                None => numbers.push(self.of_surfaces.get(*index).copied().unwrap_or(0.0)),
            }
        }
        let four = |four: &[f32]| {
            let at = |place: usize| four.get(place).copied().unwrap_or(0.0);
            Vec4::new(at(0), at(1), at(2), at(3))
        };
        numbers.chunks(4).map(four).collect()
    }

    /// The share of the energy that remains after each event, by the event's number. The values for bands that other
    /// waves carry are meaningless.
    pub fn left(&self) -> Vec<Bands> {
        let mirrored = self.distinct.iter().map(|one| {
            self.left_of(&one.material, |scattered, share| match share < 1.0 {
                true => (1.0 - scattered) / (1.0 - share),
                false => 0.0,
            })
        });
        let scattered = self.distinct[..self.scattering]
            .iter()
            .map(|one| self.left_of(&one.material, |scattered, share| scattered / share));
        let nothing_lost = std::iter::once([1.0; BAND_COUNT]);
        nothing_lost.chain(mirrored).chain(scattered).collect()
    }

    /// The energy that a material reflects in each band, multiplied by the factor of the chosen way (mirrored or
    /// scattered). The mean of `of_way(scattering, share)` over both ways is 1.
    fn left_of(&self, material: &Material, of_way: impl Fn(f64, f64) -> f64) -> Bands {
        let share = f64::from(self.share(material));
        let reflectance = material.reflectance();
        std::array::from_fn(|band| reflectance[band] * of_way(material.scattering[band], share))
    }

    /// The share of reflections that are diffuse, common to the bands that are traced together. The share is
    /// rounded so that a float holds half the share exactly as the fraction of an event number.
    fn share(&self, material: &Material) -> f32 {
        let steps = f64::from(1u32 << (22 - self.bits().min(MOST_BITS)));
        let common = common_scattering(material, &self.bands);
        if common == 0.0 {
            return 0.0;
        }
        // A way that carries energy must keep a probability above 0.
        let most = if common < 1.0 { steps - 1.0 } else { steps };
        ((common * steps).round().clamp(1.0, most) / steps) as f32
    }

    /// Whether an event scatters the wave.
    pub fn is_scattered(&self, event: usize) -> bool {
        event > self.distinct.len()
    }
}

/// The least and the greatest scattered share of some bands.
fn scattering_range(material: &Material, bands: &Range<usize>) -> [f64; 2] {
    let shares = &material.scattering[bands.clone()];
    let least = shares.iter().copied().fold(1.0, f64::min);
    [least, shares.iter().copied().fold(0.0, f64::max)]
}

/// The share of the waves that a material scatters: the middle of the shares of the bands that they carry. The energies
/// of the waves in a band spread by the square of the difference from the band's share, and the middle has the least
/// greatest difference.
pub fn common_scattering(material: &Material, bands: &Range<usize>) -> f64 {
    let [least, most] = scattering_range(material, bands);
    0.5 * (least + most)
}

/// The least share of its reflections that a face of the scene scatters, common to these bands.
pub fn least_scattering(scene: &Scene, bands: &Range<usize>) -> f64 {
    let shares = materials_met(scene).map(|material| common_scattering(&material, bands));
    shares.reduce(f64::min).unwrap_or(0.0)
}

/// The share of the energy at the end of the evaluated decay: −30 dB.
const DECAYED: f64 = 1e-3;

/// Maximum growth of the mean square of the energies over this decay, or until copies of resampled waves have separated. A
/// factor of 2 has the effect of half the number of waves. For resampled waves it is an estimate, because resampling evens
/// out their importance over all bands. In a measured seminar room (BRAS CR2) it gives three groups of bands instead of six.
const MOST_GROWTH: f64 = 2.0;

/// The reflections over which the energies of waves that carry several bands may spread.
#[derive(Clone, Copy, Debug)]
pub enum Spread {
    /// All reflections of a decay by 30 dB.
    OfDecay,
    /// Waves of little energy end, and waves of much energy are split, after this number of reflections.
    Resampled(u32),
    /// Waves end after this number of reflections.
    Ended(u32),
}

/// Groups of bands, each traced by separate waves. All bands are in one group if they scatter alike.
pub fn band_groups(scene: &Scene, spread: Spread) -> Vec<Range<usize>> {
    let materials: Vec<Material> = materials_met(scene).collect();
    let are_alike = |bands: &Range<usize>| {
        let mut all = materials.iter();
        all.all(|material| scatters_alike(material, bands, spread))
    };
    let mut groups = Vec::new();
    let mut first = 0;
    for end in 1..=BAND_COUNT {
        if end == BAND_COUNT || !are_alike(&(first..end + 1)) {
            groups.push(first..end);
            first = end;
        }
    }
    groups
}

/// Whether waves that scatter with the common share of these bands can represent each of the bands.
fn scatters_alike(material: &Material, bands: &Range<usize>, spread: Spread) -> bool {
    let [least, most] = scattering_range(material, bands);
    if least == most {
        return true;
    }
    let share = common_scattering(material, bands);
    let is_alike = |band: usize| {
        let most_reflections = match spread {
            Spread::OfDecay => f64::INFINITY,
            // Copies of a wave fly together until one of them is scattered. In a band with the share s, they count as
            // further waves after some 1/s reflections, and never without scattering.
            Spread::Resampled(after) => f64::from(after).max(1.0 / material.scattering[band]),
            Spread::Ended(after) => after.into(),
        };
        // The mean of the squared energies over both ways, (1 − s)² / (1 − p) + s² / p, is 1 plus this growth.
        let growth = (material.scattering[band] - share).powi(2) / (share * (1.0 - share));
        let reflections = reflections(&material.absorption, band).min(most_reflections);
        reflections * growth.ln_1p() <= MOST_GROWTH.ln()
    };
    bands.clone().all(is_alike)
}

/// Number of reflections after which only [`DECAYED`] of the energy is left. It is infinite if the material absorbs
/// nothing.
fn reflections(absorption: &Bands, band: usize) -> f64 {
    DECAYED.ln() / (-absorption[band]).ln_1p()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::shape::{Cuboid, Room, Sphere};
    use crate::{Listener, Node, Source, Surface};
    use glam::Vec3;

    fn material(number: u32) -> Material {
        let share = f64::from(number) / 40.0;
        Material {
            absorption: [share; BAND_COUNT],
            scattering: std::array::from_fn(|band| match number % 3 {
                0 => 0.0,
                1 => share,
                _ => (share + band as f64 / 16.0).min(1.0),
            }),
            transmission: None,
        }
    }

    fn scene() -> Scene {
        let mut scene = Scene::builtin("shoebox").unwrap();
        for number in 0..20 {
            scene
                .materials
                .insert(format!("m{number}"), material(number));
        }
        let walls = Room {
            size: Vec3::splat(9.0),
        };
        let room = Surface::new(Node::Room(walls)).with_material("m1");
        scene.surfaces = vec![room.with_wall_material(3, "m2").unwrap()];
        let ball = |number: u32| {
            let ball = Surface::new(Node::Sphere(Sphere { radius: 0.1 }));
            ball.with_material(format!("m{number}"))
        };
        scene.surfaces.extend((0..20).map(ball));
        scene
    }

    /// Protects energy: averaged over both ways of a reflection, each band keeps exactly the energy that the material
    /// reflects, regardless of the rounding of the scattered share.
    #[test]
    fn both_ways_together_keep_what_is_reflected() {
        let scene = scene();
        let materials = Materials::of(&scene, 0..BAND_COUNT);
        let left = materials.left();
        assert_eq!(left.len(), 1 + materials.count() + materials.scattering);
        for (index, number) in materials.of_surfaces().iter().enumerate().skip(1) {
            let material = scene.material(index, None).unwrap();
            let event = number.floor() as usize;
            let share = 2.0 * f64::from(number.fract());
            let scattered = left.get(event + materials.count()).filter(|_| share > 0.0);
            let scattered = scattered.unwrap_or(&[0.0; BAND_COUNT]);
            for band in 0..BAND_COUNT {
                let mean = (1.0 - share) * left[event][band] + share * scattered[band];
                assert!(
                    (mean - material.reflectance()[band]).abs() < 1e-12,
                    "{material:?}"
                );
            }
        }
    }

    /// Protects the numbers of walls, and that equal materials have the same event number.
    #[test]
    fn walls_that_differ_have_numbers_of_their_own() {
        let materials = Materials::of(&scene(), 0..BAND_COUNT);
        assert_eq!(materials.rooms(), [0]);
        let values = materials.uniform_values(&[0, 1, 2]);
        let numbers: Vec<f32> = values.iter().flat_map(|v| v.to_array()).collect();
        assert_eq!(numbers[0], numbers[5]);
        assert_ne!(numbers[0], numbers[3]);
        // Surface 1 has the material m0, which is a mirror. Surface 2 has m1, as the walls do.
        assert_eq!(numbers[6..], [0.0, numbers[0]]);
        assert!(Materials::of(&Scene::builtin("corner").unwrap(), 0..BAND_COUNT).is_empty());
    }

    /// Protects the table of many materials: the table has the number of each surface and, at the index stated for a
    /// room, the numbers of its walls in the order of the walls.
    #[test]
    fn a_table_has_what_uniforms_have() {
        let materials = Materials::of(&scene(), 0..BAND_COUNT);
        let surfaces: Vec<usize> = (0..materials.of_surfaces().len()).collect();
        let values = materials.uniform_values(&surfaces);
        let uniforms: Vec<f32> = values.iter().flat_map(|v| v.to_array()).collect();
        let first = 1000;
        let table = materials.table(first);
        let own = |surface: &usize| table[*surface].x;
        assert!(
            surfaces[1..]
                .iter()
                .map(own)
                .eq(uniforms[6..26].iter().copied())
        );
        assert!(table[1..surfaces.len()].iter().all(|own| own.y == 0.0));
        let walls = table[0].y as usize - first;
        let walls = [table[walls], table[walls + 1]].map(|vector| vector.to_array());
        assert_eq!(walls.as_flattened()[..6], uniforms[..6]);
        let most: Vec<usize> = vec![0; MOST_IN_UNIFORMS - 4];
        assert!(materials.uniform_values(&most).is_empty());
    }

    /// Protects passages through solids: the numbers of materials that transmit are consecutive, the materials that
    /// scatter come first, and the walls of rooms do not transmit.
    #[test]
    fn materials_that_transmit_have_consecutive_numbers() {
        let mut scene = scene();
        let pane = Material::builtin("glass").expect("a built-in material");
        let rough = pane.scattering_by(0.25);
        scene.materials.insert("rough pane".to_owned(), rough);
        let size = Vec3::ONE;
        for name in ["m1", "glass", "m3", "rough pane", "m2"] {
            let surface = Surface::new(Cuboid { size }).with_material(name);
            scene.surfaces.push(surface);
        }
        let room = Surface::new(Room { size }).with_material("glass");
        scene.surfaces.push(room);
        let of = Materials::with_transmission(&scene, 0..BAND_COUNT);
        let numbers = |surfaces: Range<usize>| of.of_surfaces()[surfaces].iter();
        let count = scene.surfaces.len();
        let passes = |number: &f32| of.transmitting().contains(&(number.floor() as usize - 1));
        let found: Vec<bool> = numbers(count - 6..count).map(passes).collect();
        assert_eq!(found, [false, true, false, true, false, false]);
        assert_eq!(of.transmitting().len(), 2);
        let scattering = of.scattering;
        let scatters = |one: &Distinct| one.material.scatters(0..BAND_COUNT);
        assert!(of.distinct[..scattering].iter().all(scatters));
        assert!(!of.distinct[scattering..].iter().any(scatters));
        assert!(!Materials::of(&scene, 0..BAND_COUNT).transmit());
    }

    fn groups(materials: &[(f64, Bands)]) -> Vec<Range<usize>> {
        groups_with(materials, Spread::OfDecay)
    }

    fn groups_with(materials: &[(f64, Bands)], spread: Spread) -> Vec<Range<usize>> {
        let size = Vec3::splat(9.0);
        let mut surfaces = Vec::new();
        let mut named = Vec::new();
        for (number, (absorption, scattering)) in materials.iter().enumerate() {
            let name = format!("m{number}");
            surfaces.push(Surface::new(Room { size }).with_material(&*name));
            let scattering = *scattering;
            let material = Material {
                scattering,
                ..Material::absorbing(*absorption)
            };
            named.push((name, material));
        }
        let (source, listener) = (Source::at(Vec3::ZERO), Listener::at(Vec3::X, 0.3));
        let mut scene = Scene::new("groups", surfaces, source, listener);
        scene.materials.extend(named);
        band_groups(&scene, spread)
    }

    /// Protects the time of resampled waves and of waves that end early, which carry bands of different scattering; and
    /// bands with little or no scattering, in which resampling adds no waves.
    #[test]
    fn resampled_waves_carry_more_bands() {
        let rising: Bands = std::array::from_fn(|band| 0.1 + 0.05 * band as f64);
        let from_0 = rising.map(|share| share - 0.1);
        let count = |scattering, spread| groups_with(&[(0.05, scattering)], spread).len();
        let of_decay = count(rising, Spread::OfDecay);
        assert!(count(rising, Spread::Resampled(6)) < of_decay);
        assert!(count(rising, Spread::Ended(3)) < count(rising, Spread::Resampled(3)));
        for least in [0.0, 1e-3] {
            let from_least = from_0.map(|share| share + least);
            let groups = groups_with(&[(0.05, from_least)], Spread::Resampled(1));
            assert_eq!(groups[0], 0..1, "{least}");
        }
    }

    /// Protects bands from waves whose energies spread too much, and protects bands that scatter alike from the cost of
    /// separate waves.
    #[test]
    fn bands_that_scatter_alike_are_traced_together() {
        let rising: Bands = std::array::from_fn(|band| band as f64 / 7.0);
        let slightly = rising.map(|share| 0.4 + 0.02 * share);
        let stepped: Bands = std::array::from_fn(|band| if band < 3 { 0.1 } else { 0.6 });
        let low_alone: Bands = std::array::from_fn(|band| if band == 0 { 0.0 } else { 0.3 });
        let whole = |bands: Range<usize>| vec![bands];
        assert_eq!(groups(&[]), whole(0..8));
        assert_eq!(groups(&[(0.1, [0.3; BAND_COUNT])]), whole(0..8));
        assert_eq!(groups(&[(0.1, rising)]).len(), 8);
        // A material that absorbs everything scatters nothing. A material that absorbs little is hit often.
        assert_eq!(groups(&[(1.0, rising)]), whole(0..8));
        assert_eq!(groups(&[(0.2, slightly)]), whole(0..8));
        assert!(groups(&[(0.0, slightly)]).len() > 1);
        assert_eq!(groups(&[(0.1, stepped)]), [0..3, 3..8]);
        // A material that no wave hits has no influence. Here it is the material of a room whose walls all have another
        // material.
        let mut scene = Scene::builtin("shoebox").expect("a built-in scene");
        let rising = Material {
            scattering: rising,
            ..Material::absorbing(0.1)
        };
        scene.materials.insert("rising".to_owned(), rising);
        scene
            .materials
            .insert("mirror".to_owned(), Material::MIRROR);
        scene.surfaces[0].material = Some("rising".to_owned());
        assert_eq!(band_groups(&scene, Spread::OfDecay).len(), 8);
        for wall in 0..Room::WALL_COUNT {
            let room = scene.surfaces[0].clone();
            scene.surfaces[0] = room.with_wall_material(wall, "mirror").unwrap();
        }
        assert_eq!(band_groups(&scene, Spread::OfDecay), whole(0..8));
        assert_eq!(
            groups(&[(0.1, stepped), (0.1, low_alone)]),
            [0..1, 1..3, 3..8]
        );
    }
}
