//! Distances sampled on a grid by another program, and their trilinear interpolation.

use super::npy;
use crate::file_input::read;
use crate::scene::SceneError;
use glam::{DVec3, IVec3, UVec3};
use std::path::Path;

/// Maximum number of samples. On the GPU each takes 16 bytes.
const MOST_SAMPLES: usize = 1 << 22;

/// Maximum size of a file in bytes: the maximum number of 64-bit samples, and a header.
const LARGEST_FILE: u64 = 8 * MOST_SAMPLES as u64 + (1 << 16);

/// Range of the distance between two samples, in metres.
const CELLS_M: std::ops::RangeInclusive<f32> = 1e-4..=1e4;

/// Greatest slope of the values, in metres per metre, as for a user's field.
const STEEPEST: f64 = 1e6;

/// Greatest size of a value in metres.
const GREATEST_M: f32 = 1e6;

/// Signed distances in metres on a regular grid, positive in the air. Between the samples the value is interpolated
/// trilinearly.
#[derive(Clone, Debug, PartialEq)]
pub struct SampledField {
    name: String,
    size: UVec3,
    cell: f32,
    values: Vec<f32>,
    steepest: f64,
}

impl SampledField {
    /// Creates a field from `size.x · size.y · size.z` values, z fastest, then y, then x. `cell` is the distance between
    /// neighbouring samples in metres; `name` is the name in reports.
    ///
    /// ```
    /// use echomarch::glam::{UVec3, Vec3};
    /// use echomarch::scene::SampledField;
    /// use echomarch::scene::shape::{Grid, Shape};
    /// use std::sync::Arc;
    ///
    /// // A ball of radius 1 m, sampled every 0.25 m from -1.5 to 1.5 m.
    /// let at = |index: u32| {
    ///     let cell = UVec3::new(index / 169, index / 13 % 13, index % 13);
    ///     (cell.as_vec3() * 0.25 - 1.5).length() - 1.0
    /// };
    /// let values = (0..13 * 13 * 13).map(at).collect();
    /// let field = SampledField::new("ball", UVec3::splat(13), 0.25, values)?;
    /// let ball = Shape::from(Grid { field: Arc::new(field) });
    /// assert!((ball.value([1.0, 0.0, 0.0].into())).abs() < 0.01);
    /// # Ok::<(), echomarch::scene::SceneError>(())
    /// ```
    ///
    /// # Errors
    /// [`SceneError::BadSampledField`] for fewer than two samples along an axis, more than 4,194,304 samples, a wrong
    /// number of values, values that are not finite or beyond 1e6 m, differences beyond 1e6 times the distance, and a cell
    /// outside 0.0001 to 10,000 m.
    pub fn new(
        name: &str,
        size: UVec3,
        cell: f32,
        values: Vec<f32>,
    ) -> Result<SampledField, SceneError> {
        let refused = |why: String| Err(bad(name, &why));
        let sides = size.to_array().map(|side| side as usize);
        let count = sides
            .iter()
            .try_fold(1, |all: usize, side| all.checked_mul(*side));
        if size.min_element() < 2 || count.is_none_or(|count| count > MOST_SAMPLES) {
            let [x, y, z] = sides;
            return refused(format!(
                "it has {x} × {y} × {z} samples: at least 2 along each axis and at most {MOST_SAMPLES} in all are needed"
            ));
        }
        if count != Some(values.len()) {
            let found = values.len();
            return refused(format!("it has {found} values for {sides:?} samples"));
        }
        if !CELLS_M.contains(&cell) {
            return refused(format!("its cell must be 0.0001 to 10000 m, not {cell}"));
        }
        let is_usable = |value: &&f32| value.abs() <= GREATEST_M;
        if let Some(value) = values.iter().find(|value| !is_usable(value)) {
            return refused(format!(
                "it contains {value:e}: distances of at most 1e6 m are needed"
            ));
        }
        let mut field = SampledField {
            name: name.to_owned(),
            size,
            cell,
            values,
            steepest: 0.0,
        };
        field.steepest = field.find_steepest();
        if field.steepest > STEEPEST {
            let found = field.steepest;
            return refused(format!(
                "neighbouring values differ by {found:.1e} times their distance: at most 1e6 is possible"
            ));
        }
        Ok(field)
    }

    /// Reads an array of 32-bit or 64-bit floats of the shape (x, y, z), as `numpy.save` writes it. `cell` is the
    /// distance between neighbouring samples in metres.
    ///
    /// # Errors
    /// [`SceneError::BadSampledField`] for a file that cannot be read, and as in [`SampledField::new`].
    pub fn from_file(path: &Path, cell: f32) -> Result<SampledField, SceneError> {
        let name = path.display().to_string();
        let bytes = read(path, LARGEST_FILE).map_err(|error| bad(&name, &error.to_string()))?;
        let array = npy::read(&bytes, MOST_SAMPLES).map_err(|why| bad(&name, &why))?;
        // The product of the sides is limited, so that each side fits.
        let size = array.shape.map(|side| u32::try_from(side).unwrap_or(0));
        SampledField::new(&name, size.into(), cell, array.values)
    }

    /// Name in reports.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Number of samples along x, y and z.
    pub fn size(&self) -> UVec3 {
        self.size
    }

    /// Distance between neighbouring samples in metres.
    pub fn cell(&self) -> f32 {
        self.cell
    }

    /// The values: z fastest, then y, then x.
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// Whether both have the same values and cells, regardless of their files.
    pub(crate) fn has_values_of(&self, other: &SampledField) -> bool {
        self.size == other.size && self.cell == other.cell && self.values == other.values
    }

    /// The size, the cell and the values, each as four bytes in little-endian order.
    pub(crate) fn to_bytes(&self) -> Vec<u8> {
        let size = self.size.to_array().into_iter().flat_map(u32::to_le_bytes);
        let cell = self.cell.to_le_bytes();
        let values = self.values.iter().flat_map(|value| value.to_le_bytes());
        size.chain(cell).chain(values).collect()
    }

    /// Half the size in metres of the box that the samples cover, which is centred on the origin.
    pub(crate) fn half_size(&self) -> DVec3 {
        0.5 * f64::from(self.cell) * (self.size - 1).as_dvec3()
    }

    /// Lipschitz constant of the interpolated value, in metres per metre, at least 1. A field of distances that were
    /// sampled exactly has at most √3.
    pub(crate) fn lipschitz(&self) -> f64 {
        self.steepest.max(1.0)
    }

    /// The value at a grid point, with coordinates clamped to the grid.
    pub(crate) fn sample(&self, at: IVec3) -> f32 {
        let at = at.clamp(IVec3::ZERO, self.size.as_ivec3() - 1).as_uvec3();
        let index = (at.x * self.size.y + at.y) * self.size.z + at.z;
        self.values[index as usize]
    }

    /// The trilinearly interpolated value at a point in metres, clamped to the box.
    pub(crate) fn at(&self, p: DVec3) -> f64 {
        let cells = (self.size - 1).as_dvec3();
        let place = ((p + self.half_size()) / f64::from(self.cell)).clamp(DVec3::ZERO, cells);
        let first = place.floor().min(cells - 1.0);
        let within = place - first;
        let first = first.as_ivec3();
        let value = |x, y, z| f64::from(self.sample(first + IVec3::new(x, y, z)));
        let mix = |a: f64, b: f64, share: f64| a + (b - a) * share;
        let along_z = |x, y| mix(value(x, y, 0), value(x, y, 1), within.z);
        let along_y = |x| mix(along_z(x, 0), along_z(x, 1), within.y);
        mix(along_y(0), along_y(1), within.x)
    }

    /// The greatest length of the interpolated value's gradient.
    ///
    /// Within a cell each component of the gradient does not depend on its own coordinate, and is linear in each of the
    /// others. The squared length is therefore convex along each axis, and greatest at a corner of a cell, where the
    /// components are the differences along the three edges of this corner.
    fn find_steepest(&self) -> f64 {
        let size = self.size.as_ivec3();
        let mut steepest: f64 = 0.0;
        for x in 0..size.x {
            for y in 0..size.y {
                for z in 0..size.z {
                    steepest = steepest.max(self.steepest_at(IVec3::new(x, y, z)));
                }
            }
        }
        steepest.sqrt() / f64::from(self.cell)
    }

    /// The greatest squared difference of values over the three edges at a grid point, in m².
    fn steepest_at(&self, at: IVec3) -> f64 {
        let own = f64::from(self.sample(at));
        let greatest = |axis: IVec3| {
            let ends = [at + axis, at - axis].map(|end| f64::from(self.sample(end)));
            let [after, before] = ends.map(|end| (end - own).abs());
            after.max(before)
        };
        let squared = IVec3::AXES.map(|axis| greatest(axis).powi(2));
        squared.iter().sum()
    }
}

fn bad(name: &str, why: &str) -> SceneError {
    SceneError::BadSampledField {
        why: format!("cannot use the sampled field {name}: {why}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the interpolation and its slope: a function that is linear along each axis is reproduced between the
    /// samples, and no difference quotient exceeds the Lipschitz constant.
    #[test]
    fn trilinear_functions_are_reproduced() {
        let value = |p: DVec3| 0.5 * p.x - 0.3 * p.y + 2.0 * p.z + 0.7 * p.x * p.y * p.z - 0.2;
        let (size, cell) = (UVec3::new(3, 4, 5), 0.5);
        let half = 0.25 * (size - 1).as_dvec3();
        let place = |index: u32| {
            let at = UVec3::new(index / 20, index / 5 % 4, index % 5);
            at.as_dvec3() * 0.5 - half
        };
        let values = (0..60).map(|index| value(place(index)) as f32).collect();
        let field = SampledField::new("test", size, cell, values).unwrap();
        assert_eq!(field.half_size(), half);
        let share = |k: u32, by: f64| 2.0 * (f64::from(k) * by).fract() - 1.0;
        let points =
            (0..200).map(|k| half * DVec3::new(share(k, 0.618), share(k, 0.755), share(k, 0.57)));
        let points: Vec<DVec3> = points.collect();
        for p in &points {
            assert!((field.at(*p) - value(*p)).abs() < 1e-6, "{p}");
        }
        for pair in points.windows(2) {
            let rise = (field.at(pair[1]) - field.at(pair[0])).abs();
            assert!(rise <= field.lipschitz() * pair[0].distance(pair[1]) + 1e-9);
        }
        let gradient = |p: DVec3| {
            DVec3::new(
                0.5 + 0.7 * p.y * p.z,
                -0.3 + 0.7 * p.x * p.z,
                2.0 + 0.7 * p.x * p.y,
            )
        };
        let corners =
            (0..8).map(|k| half * (IVec3::new(k & 1, k >> 1 & 1, k >> 2) * 2 - 1).as_dvec3());
        let steepest = corners.map(|corner| gradient(corner).length());
        let steepest = steepest.fold(0.0, f64::max);
        assert!((field.lipschitz() - steepest).abs() < 1e-5, "{steepest}");
        // Beyond the box the value is that of its face.
        assert_eq!(field.at(2.0 * half), field.at(half));
    }

    /// Protects scenes from fields that cannot be traced.
    #[test]
    fn unusable_fields_are_refused() {
        let two = UVec3::splat(2);
        let cases = [
            (
                UVec3::new(1, 2, 2),
                0.1,
                vec![0.0; 4],
                "at least 2 along each axis",
            ),
            (
                UVec3::new(1 << 16, 1 << 16, 2),
                0.1,
                Vec::new(),
                "at most 4194304",
            ),
            (two, 0.1, vec![0.0; 7], "7 values"),
            (two, 0.0, vec![0.0; 8], "its cell must be"),
            (two, f32::NAN, vec![0.0; 8], "its cell must be"),
            (two, 0.1, vec![f32::NAN; 8], "it contains NaN"),
            (two, 0.1, vec![1e7; 8], "it contains 1e7"),
            (two, 1e-3, [[1e6; 4], [-1e6; 4]].concat(), "2.0e9 times"),
        ];
        for (size, cell, values, told) in cases {
            let why = SampledField::new("f.npy", size, cell, values)
                .unwrap_err()
                .to_string();
            assert!(why.contains(told) && why.contains("f.npy"), "{why}");
        }
    }
}
