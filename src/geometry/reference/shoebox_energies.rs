//! Energies of image sources in an empty rectangular room with absorbing walls (Allen & Berkley 1979, with energies
//! instead of pressures).
//!
//! The images of the source form a lattice, with one image in each mirrored copy of the room. The straight line from an
//! image to the listener crosses one wall for each reflection of the path. From copy *m* along an axis, it crosses
//! |*m*| walls, alternately the wall on the image's side and the opposite wall. An image at a distance of *r* metres
//! contributes Π (1 − α) / (4π r²). The sum includes all images within the given length and uses no random numbers. Its
//! only errors are rounding errors and the finite length of the cells.

use crate::bands::{BAND_COUNT, Bands};
use crate::tracer::TraceError;
use glam::DVec3;
use rayon::prelude::*;
use std::f64::consts::PI;

/// Number of parallel parts of the sum. It does not depend on the number of cores, so that the sums are bit-identical
/// on every machine.
const PARTS: usize = 16;

/// Maximum order of a listed image. About 300,000 images have at most this order.
const MOST_ORDER: u32 = 60;

/// Maximum number of cells. The sum of this number of cells needs one gibibyte of memory.
const MOST_CELLS: f64 = (1 << 20) as f64;

/// Maximum number of images in a sum. A sum of this number of images takes hours on one core.
const MOST_IMAGES: f64 = 1e12;

/// A source and a listener in a rectangular room, with the absorption of each wall in each octave band.
#[derive(Clone, Debug, PartialEq)]
pub struct ShoeboxEnergies {
    size: DVec3,
    source: DVec3,
    listener: DVec3,
    /// Reflectance of the walls at −x, +x, −y, +y, −z, +z, by octave band.
    reflectance: [Bands; 6],
}

/// An image of the source.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImageSource {
    /// Number of reflections at each wall: −x, +x, −y, +y, −z, +z.
    pub reflections: [u32; 6],
    /// Distance to the listener in metres.
    pub length_m: f64,
    /// Direction of arrival at the listener: a unit vector in room axes that points away from the image.
    pub direction: DVec3,
    /// Energy density at the listener for a source of unit power, multiplied by the speed of sound, in 1/m². The
    /// absorption by air is not included.
    pub energy: Bands,
}

/// Energies in cells of path length.
#[derive(Clone, Debug, PartialEq)]
pub struct EnergiesByLength {
    /// Lower limit of the first cell in metres: the length of the direct path, which is the shortest path.
    pub first_m: f64,
    /// Length of a cell in metres.
    pub cell_m: f64,
    /// Energy in each cell, in 1/m².
    pub energies: Vec<Bands>,
    /// Number of images summed.
    pub images: u64,
}

/// A copy of the room along one axis.
#[derive(Clone, Copy, Debug)]
struct Copy {
    /// Distance in metres from the listener to the image along the axis.
    offset: f64,
    /// Number of reflections at the wall on the negative side and at the wall on the positive side.
    reflections: [u32; 2],
    /// Product of the reflectances of all these reflections.
    reflectance: Bands,
}

impl Copy {
    fn order(&self) -> u32 {
        self.reflections[0] + self.reflections[1]
    }
}

impl ShoeboxEnergies {
    /// Creates a room of `size` metres, centred on the origin. Source and listener are positions in metres.
    /// `absorption` contains the absorption coefficients (0 to 1) of the walls at −x, +x, −y, +y, −z, +z. `None` if the
    /// source or the listener is outside the room, if both are at the same point, or if an absorption coefficient is
    /// out of range.
    pub fn new(
        size: DVec3,
        source: DVec3,
        listener: DVec3,
        absorption: &[Bands; 6],
    ) -> Option<ShoeboxEnergies> {
        let inside = |point: DVec3| point.abs().cmple(size / 2.0).all();
        let mut all = absorption.iter().flatten();
        let valid = size.is_finite()
            && inside(source)
            && inside(listener)
            && source != listener
            && all.all(|absorption| (0.0..=1.0).contains(absorption));
        valid.then(|| ShoeboxEnergies {
            size,
            source,
            listener,
            reflectance: absorption.map(|wall| wall.map(|absorption| 1.0 - absorption)),
        })
    }

    /// Distance in metres from source to listener.
    pub fn direct_m(&self) -> f64 {
        self.source.distance(self.listener)
    }

    /// All images with at most `order` reflections, the nearest first.
    ///
    /// # Errors
    /// [`TraceError::BadSetting`] for more than 60 reflections.
    pub fn images(&self, order: u32) -> Result<Vec<ImageSource>, TraceError> {
        if order > MOST_ORDER {
            return Err(TraceError::BadSetting {
                what: "order of image sources",
                must: format!("at most {MOST_ORDER}"),
                value: order.to_string(),
            });
        }
        let reach = i64::from(order);
        let copies = |axis| -> Vec<Copy> {
            let copy = |number| self.copy(axis, number);
            (-reach..=reach).map(copy).collect()
        };
        let [along_x, along_y, along_z] = [copies(0), copies(1), copies(2)];
        let mut images = Vec::new();
        for x in &along_x {
            for y in &along_y {
                for z in &along_z {
                    if x.order() + y.order() + z.order() <= order {
                        images.push(image(x, y, z));
                    }
                }
            }
        }
        images.sort_by(|a, b| a.length_m.total_cmp(&b.length_m));
        Ok(images)
    }

    /// The energies of all images within `length_m` metres, in cells of `cell_m` metres. Images with at most
    /// `without_order` reflections are left out. The sum takes a few nanoseconds per image and core. The result needs
    /// 64 bytes per cell, and the sum needs 16 times as much memory.
    ///
    /// # Errors
    /// [`TraceError::BadSetting`] for a length that is not finite, a cell length that is not positive and finite, more
    /// than a million cells, or more than 10¹² images.
    #[doc(hidden)]
    pub fn energies_by_length(
        &self,
        cell_m: f64,
        length_m: f64,
        without_order: Option<u32>,
    ) -> Result<EnergiesByLength, TraceError> {
        let first_m = self.direct_m();
        let cells = self.check_sum(cell_m, length_m)?;
        let nothing = EnergiesByLength {
            first_m,
            cell_m,
            energies: vec![[0.0; BAND_COUNT]; cells],
            images: 0,
        };
        let along = [0, 1, 2].map(|axis| self.copies_within(axis, length_m));
        let part = |part: usize| {
            let mut sum = nothing.clone();
            for x in along[0].iter().skip(part).step_by(PARTS) {
                sum.add_plane(x, &along, length_m, without_order);
            }
            sum
        };
        let parts: Vec<EnergiesByLength> = (0..PARTS).into_par_iter().map(part).collect();
        Ok(parts.iter().fold(nothing.clone(), |mut sum, part| {
            sum.add_all(part);
            sum
        }))
    }

    /// The number of cells between the direct sound and `length_m`, each `cell_m` metres long. Returns an error if the
    /// sum would exceed a limit.
    fn check_sum(&self, cell_m: f64, length_m: f64) -> Result<usize, TraceError> {
        let refused = |what, must: &str, value: f64| {
            Err(TraceError::BadSetting {
                what,
                must: must.to_owned(),
                value: value.to_string(),
            })
        };
        if !(cell_m > 0.0 && cell_m.is_finite()) {
            return refused("length of a cell in metres", "finite and above 0", cell_m);
        }
        if !length_m.is_finite() {
            return refused("longest path in metres", "finite", length_m);
        }
        let cells = ((length_m - self.direct_m()) / cell_m).ceil().max(0.0);
        if cells > MOST_CELLS {
            return refused("number of cells", "at most 1048576", cells);
        }
        // Number of copies along an axis; at least one for any length.
        let copies = |axis: usize| 2.0 * length_m.max(0.0) / self.size[axis] + 1.0;
        let images = copies(0) * copies(1) * copies(2) * PI / 6.0;
        if images.is_nan() || images > MOST_IMAGES {
            return refused("number of image sources", "at most 1e12", images);
        }
        Ok(cells as usize)
    }

    /// The copy with this number along an axis. Number 0 is the room itself.
    fn copy(&self, axis: usize, number: i64) -> Copy {
        let source = self.source[axis];
        let mirrored = if number % 2 == 0 { source } else { -source };
        let crossed = number.unsigned_abs() as u32;
        // From the listener towards the image, the line crosses the wall on the image's side first, then the opposite
        // wall, and so on alternately.
        let (own, other) = (crossed.div_ceil(2), crossed / 2);
        let reflections = if number > 0 {
            [other, own]
        } else {
            [own, other]
        };
        let [lower, upper] = [0, 1].map(|side| self.reflectance[2 * axis + side]);
        Copy {
            offset: number as f64 * self.size[axis] + mirrored - self.listener[axis],
            reflections,
            reflectance: std::array::from_fn(|band| {
                lower[band].powi(reflections[0] as i32) * upper[band].powi(reflections[1] as i32)
            }),
        }
    }

    /// The copies along an axis whose images can be within `length_m` metres.
    fn copies_within(&self, axis: usize, length_m: f64) -> Vec<Copy> {
        // The distance of an image can be up to one and a half room lengths less than the number of its copy, times the
        // room length.
        let reach = (length_m / self.size[axis]).ceil().max(0.0) as i64 + 2;
        let copies = (-reach..=reach).map(|number| self.copy(axis, number));
        copies.filter(|copy| copy.offset.abs() < length_m).collect()
    }
}

fn image(x: &Copy, y: &Copy, z: &Copy) -> ImageSource {
    let offset = DVec3::new(x.offset, y.offset, z.offset);
    let spreading = 1.0 / (4.0 * PI * offset.length_squared());
    let [x_walls, y_walls, z_walls] = [x, y, z].map(|copy| copy.reflections);
    ImageSource {
        reflections: [
            x_walls[0], x_walls[1], y_walls[0], y_walls[1], z_walls[0], z_walls[1],
        ],
        length_m: offset.length(),
        direction: -offset / offset.length(),
        energy: std::array::from_fn(|band| {
            x.reflectance[band] * y.reflectance[band] * z.reflectance[band] * spreading
        }),
    }
}

impl EnergiesByLength {
    /// The centre of a cell in metres.
    pub fn middle_m(&self, cell: usize) -> f64 {
        self.first_m + (cell as f64 + 0.5) * self.cell_m
    }

    /// Adds the images of one copy along x.
    fn add_plane(
        &mut self,
        x: &Copy,
        along: &[Vec<Copy>; 3],
        length_m: f64,
        without_order: Option<u32>,
    ) {
        for y in &along[1] {
            let squared = x.offset * x.offset + y.offset * y.offset;
            if squared >= length_m * length_m {
                continue;
            }
            let reflectance: Bands =
                std::array::from_fn(|band| x.reflectance[band] * y.reflectance[band]);
            let order = x.order() + y.order();
            for z in &along[2] {
                if without_order.is_some_and(|without| order + z.order() <= without) {
                    continue;
                }
                let squared = squared + z.offset * z.offset;
                if squared < length_m * length_m {
                    self.add(squared, &reflectance, &z.reflectance);
                }
            }
        }
    }

    /// Adds an image. `squared` is the squared distance to the listener, in square metres.
    fn add(&mut self, squared: f64, across: &Bands, along: &Bands) {
        let place = (squared.sqrt() - self.first_m) / self.cell_m;
        // Due to rounding, an image at the distance of the source may fall before the first cell.
        let Some(cell) = self.energies.get_mut(place.max(0.0) as usize) else {
            return;
        };
        let spreading = 1.0 / (4.0 * PI * squared);
        for band in 0..BAND_COUNT {
            cell[band] += across[band] * along[band] * spreading;
        }
        self.images += 1;
    }

    fn add_all(&mut self, other: &EnergiesByLength) {
        for (sum, energies) in self.energies.iter_mut().zip(&other.energies) {
            for (sum, energy) in sum.iter_mut().zip(energies) {
                *sum += energy;
            }
        }
        self.images += other.images;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn room(absorption: &[Bands; 6]) -> ShoeboxEnergies {
        let size = DVec3::new(8.0, 3.0, 5.0);
        let source = DVec3::new(-2.0, 0.1, 1.5);
        ShoeboxEnergies::new(size, source, DVec3::new(2.0, -0.3, -1.0), absorption)
            .expect("a good room")
    }

    fn by_wall() -> [Bands; 6] {
        std::array::from_fn(|wall| {
            std::array::from_fn(|band| 0.05 + 0.1 * wall as f64 + 0.02 * band as f64)
        })
    }

    /// Protects the free field: the direct sound and its direction.
    #[test]
    fn the_nearest_image_is_the_source() {
        let images = room(&by_wall()).images(3).unwrap();
        let offset = DVec3::new(4.0, -0.4, -2.5);
        let direct = images[0];
        assert_eq!(direct.reflections, [0; 6]);
        assert!((direct.length_m - offset.length()).abs() < 1e-12);
        assert!(direct.direction.distance(offset.normalize()) < 1e-12);
        let spread = 1.0 / (4.0 * PI * offset.length_squared());
        assert!((direct.energy[3] / spread - 1.0).abs() < 1e-12);
    }

    /// Protects the assignment of reflections to walls, by the first-order images.
    #[test]
    fn first_order_images_lie_behind_their_walls() {
        let absorption = by_wall();
        let images = room(&absorption).images(1).unwrap();
        assert_eq!(images.len(), 7);
        for (wall, absorption) in absorption.iter().enumerate() {
            let found: Vec<&ImageSource> = images
                .iter()
                .filter(|image| image.reflections[wall] == 1)
                .collect();
            assert_eq!(found.len(), 1);
            // The sound arrives from the side of the wall.
            let side = if wall % 2 == 0 { 1.0 } else { -1.0 };
            assert!(found[0].direction[wall / 2] * side > 0.0, "wall {wall}");
            let spread = 1.0 / (4.0 * PI * found[0].length_m.powi(2));
            let reflectance = found[0].energy[5] / spread;
            assert!((reflectance - (1.0 - absorption[5])).abs() < 1e-12);
        }
        let upper_x = images.iter().find(|image| image.reflections[1] == 1);
        // The image is at x = 8 + 2 = 10 m, and the listener at x = 2 m.
        let expected = DVec3::new(8.0, 0.4, 2.5).length();
        assert!((upper_x.expect("an image").length_m - expected).abs() < 1e-12);
    }

    /// Protects the number of images: 4 n² + 2 for each order n > 0.
    #[test]
    fn images_of_an_order_are_all_there() {
        let images = room(&by_wall()).images(4).unwrap();
        let expected: usize = 1 + (1..=4).map(|order| 4 * order * order + 2).sum::<usize>();
        assert_eq!(images.len(), expected);
        assert!(images.is_sorted_by(|a, b| a.length_m <= b.length_m));
    }

    /// Protects the energies in cells, by comparison with the list of images.
    #[test]
    fn cells_hold_the_images_of_the_list() {
        let room = room(&by_wall());
        let length_m = 14.0;
        // All images within 14 m have fewer than 12 reflections. A path of 14 m crosses at most 14/8 + 14/3 + 14/5
        // walls, and one more along each axis.
        let near = |image: &ImageSource| image.length_m < length_m;
        let images: Vec<ImageSource> = room.images(12).unwrap().into_iter().filter(near).collect();
        let summed = room.energies_by_length(0.5, length_m, None).unwrap();
        let mut expected = vec![[0.0; BAND_COUNT]; summed.energies.len()];
        for image in &images {
            let cell = ((image.length_m - room.direct_m()) / 0.5) as usize;
            for (sum, energy) in expected[cell].iter_mut().zip(&image.energy) {
                *sum += energy;
            }
        }
        assert_eq!(summed.images, images.len() as u64);
        for (found, expected) in summed.energies.iter().zip(&expected) {
            for band in 0..BAND_COUNT {
                assert!((found[band] - expected[band]).abs() <= 1e-12 * expected[band]);
            }
        }
        let late = room.energies_by_length(0.5, length_m, Some(1)).unwrap();
        assert_eq!(late.images, summed.images - 7);
    }

    /// Protects the total energy, by comparison with a diffuse field. With equal walls of low absorption, a source of
    /// unit power gives 4/A (in 1/m², with the absorption area A) in addition to the direct sound. The difference is at
    /// most the few per cent error of Sabine's assumption of low absorption.
    #[test]
    fn the_energy_of_a_live_room_is_that_of_sabine() {
        let room = room(&[[0.02; BAND_COUNT]; 6]);
        let (volume, surface) = (8.0 * 3.0 * 5.0, 2.0 * (24.0 + 40.0 + 15.0));
        // Seven times the path length over which the energy falls by a factor of e. Only 0.1 % of the energy arrives
        // later.
        let length_m = 7.0 * 4.0 * volume / (0.02 * surface);
        let summed = room.energies_by_length(0.1, length_m, Some(0)).unwrap();
        let energy: f64 = summed.energies.iter().map(|energy| energy[0]).sum();
        let sabine = 4.0 / (0.02 * surface);
        assert!((energy / sabine - 1.0).abs() < 0.05, "{energy} {sabine}");
    }

    /// Protects the rejection of invalid rooms.
    #[test]
    fn bad_rooms_are_refused() {
        let build = |listener, absorption: f64| {
            let walls = [[absorption; BAND_COUNT]; 6];
            ShoeboxEnergies::new(DVec3::splat(4.0), DVec3::X, listener, &walls)
        };
        assert!(build(DVec3::Y, 0.5).is_some());
        assert!(build(DVec3::X, 0.5).is_none());
        assert!(build(DVec3::Y * 2.1, 0.5).is_none());
        assert!(build(DVec3::Y, 1.1).is_none());
        assert!(build(DVec3::Y, f64::NAN).is_none());
    }

    /// Protects memory and time from arguments for which the sum would take too long.
    #[test]
    fn endless_sums_are_refused() {
        let room = room(&by_wall());
        assert!(room.images(61).is_err() && room.images(u32::MAX).is_err());
        for (cell_m, length_m) in [
            (0.0, 10.0),
            (-1.0, 10.0),
            (f64::NAN, 10.0),
            (1e-9, 10.0),
            (1.0, f64::NAN),
            (1.0, f64::INFINITY),
            (1e9, 1e9),
        ] {
            let refused = room.energies_by_length(cell_m, length_m, None);
            assert!(refused.is_err(), "{cell_m} {length_m}");
        }
        let nothing = room.energies_by_length(1.0, -5.0, None).unwrap();
        assert!(nothing.energies.is_empty());
    }
}
