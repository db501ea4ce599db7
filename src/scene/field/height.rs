//! Heights from an image: bilinear ground.

use glam::{DVec2, UVec2};
use std::path::Path;
use std::sync::OnceLock;

/// Pixels along a side at the most: a million heights are 16 MB on the GPU.
const LARGEST_SIDE: u32 = 1024;

/// A grid of heights from 0 (black) to 1 (white), the image's upper row first: the image
/// lies as it is seen from above, its upper edge at −z.
#[derive(Clone, Debug)]
pub struct HeightImage {
    size: UVec2,
    heights: Vec<f32>,
    name: String,
    /// The width and depth that the steepest slope was asked for first, and that slope.
    steepest: OnceLock<(DVec2, f64)>,
}

impl PartialEq for HeightImage {
    fn eq(&self, other: &HeightImage) -> bool {
        (self.size, &self.name) == (other.size, &other.name) && self.heights == other.heights
    }
}

impl HeightImage {
    /// A grid of heights, row by row; `name` is what reports call it.
    ///
    /// # Errors
    /// A sentence when the grid is smaller than 2 × 2, larger than 1024 × 1024, or a height is
    /// not within 0 to 1.
    pub fn new(name: &str, size: UVec2, heights: Vec<f32>) -> Result<HeightImage, String> {
        if size.min_element() < 2 || size.max_element() > LARGEST_SIDE {
            return Err(format!(
                "the height image {name} has {} x {} pixels: it must have 2 to {LARGEST_SIDE} along each side",
                size.x, size.y
            ));
        }
        if heights.len() != (size.x * size.y) as usize {
            return Err(format!(
                "the height image {name} has not a height for each pixel"
            ));
        }
        if !heights.iter().all(|h| (0.0..=1.0).contains(h)) {
            return Err(format!(
                "the height image {name} has heights outside of 0 to 1"
            ));
        }
        let name = name.to_owned();
        Ok(HeightImage {
            size,
            heights,
            name,
            steepest: OnceLock::new(),
        })
    }

    /// Reads an 8- or 16-bit grey (or coloured: its luma) PNG file.
    ///
    /// # Errors
    /// A sentence with the file when it cannot be read or is too large.
    pub fn from_file(path: &Path) -> Result<HeightImage, String> {
        let shown = path.display().to_string();
        let image = image::open(path)
            .map_err(|error| format!("cannot read the height image {shown}: {error}"))?
            .into_luma16();
        let size = UVec2::new(image.width(), image.height());
        let heights = image.pixels().map(|p| f32::from(p.0[0]) / 65535.0);
        HeightImage::new(&shown, size, heights.collect())
    }

    /// What reports call it.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Pixels along x and z.
    pub fn size(&self) -> UVec2 {
        self.size
    }

    /// The heights, row by row.
    pub fn heights(&self) -> &[f32] {
        &self.heights
    }

    fn height(&self, x: u32, z: u32) -> f64 {
        f64::from(self.heights[(z * self.size.x + x) as usize])
    }

    /// The cell that a place lies in, and where in it. `at` is 0 to 1 along x and z.
    fn cell(&self, at: DVec2) -> (UVec2, DVec2) {
        let cells = (self.size - 1).as_dvec2();
        let place = (at * cells).clamp(DVec2::ZERO, cells);
        let cell = place.floor().min(cells - 1.0);
        (cell.as_uvec2(), place - cell)
    }

    /// Bilinear height, 0 to 1. `at` is 0 to 1 along x and z, held at the edges.
    pub fn at(&self, at: DVec2) -> f64 {
        let (cell, within) = self.cell(at);
        let row = |z: u32| {
            let left = self.height(cell.x, z);
            left + (self.height(cell.x + 1, z) - left) * within.x
        };
        let near = row(cell.y);
        near + (row(cell.y + 1) - near) * within.y
    }

    /// The steepest slope there is, in heights for the full width, along x and z.
    ///
    /// Walks over the whole image once; asked again for the same size it remembers.
    pub fn steepest(&self, size: DVec2) -> f64 {
        let (known_size, known) = self
            .steepest
            .get_or_init(|| (size, self.walk_for_steepest(size)));
        if *known_size == size {
            return *known;
        }
        self.walk_for_steepest(size)
    }

    fn walk_for_steepest(&self, size: DVec2) -> f64 {
        let step = size / (self.size - 1).as_dvec2();
        let mut steepest: f64 = 0.0;
        for z in 0..self.size.y - 1 {
            for x in 0..self.size.x - 1 {
                // The gradient of a bilinear patch is greatest at one of its corners.
                let corner = |dx: u32, dz: u32| self.height(x + dx, z + dz);
                let along_x = [0, 1].map(|dz| (corner(1, dz) - corner(0, dz)) / step.x);
                let along_z = [0, 1].map(|dx| (corner(dx, 1) - corner(dx, 0)) / step.y);
                for slope_x in along_x {
                    for slope_z in along_z {
                        steepest = steepest.max(slope_x.hypot(slope_z));
                    }
                }
            }
        }
        steepest
    }
}
