//! Cells of the sphere of directions: the sides of a cube, divided evenly by angle.

use glam::DVec3;
use std::f64::consts::FRAC_PI_4;

/// Number of sides of a cube.
const SIDES: usize = 6;

/// The number of cells along each edge of the cube. An edge is divided evenly by angle, so that the largest cell is at
/// most 1.4 times as large as the smallest.
#[derive(Clone, Copy, Debug)]
pub struct Cells {
    along: usize,
}

impl Cells {
    /// Creates about `count` cells, at least six.
    pub fn about(count: f64) -> Cells {
        let along = (count / SIDES as f64).sqrt() as usize;
        Cells {
            along: along.max(1),
        }
    }

    /// Divides each cell into `times` cells along each axis.
    pub fn divided(self, times: usize) -> Cells {
        Cells {
            along: self.along * times,
        }
    }

    /// The cell from which `cell` was [divided](Cells::divided).
    pub fn undivided(self, cell: usize, times: usize) -> usize {
        let (row, column) = (cell / self.along, cell % self.along);
        let along = self.along / times;
        let (side, row) = (row / self.along, row % self.along);
        (side * along + row / times) * along + column / times
    }

    pub fn count(self) -> usize {
        SIDES * self.along * self.along
    }

    /// The cell of a direction.
    pub fn of(self, direction: DVec3) -> usize {
        let axis = direction.abs().max_position();
        let largest = direction[axis];
        let place = |other: usize| {
            let tangent = direction[(axis + other) % 3] / largest.abs();
            let share = 0.5 + 0.5 * tangent.atan() / FRAC_PI_4;
            ((share * self.along as f64) as usize).min(self.along - 1)
        };
        let side = 2 * axis + usize::from(largest < 0.0);
        (side * self.along + place(1)) * self.along + place(2)
    }

    /// The direction at a position in a cell, 0 … 1 along each axis, and the solid angle of the cell in steradians,
    /// approximated by its value at this position.
    pub fn direction(self, cell: usize, place: [f64; 2]) -> (DVec3, f64) {
        let along = self.along;
        let side = cell / (along * along);
        let (axis, is_negative) = (side / 2, side % 2 == 1);
        let tangent = |number: usize, place: f64| {
            let share = (number as f64 + place) / along as f64;
            ((2.0 * share - 1.0) * FRAC_PI_4).tan()
        };
        let a = tangent(cell / along % along, place[0]);
        let b = tangent(cell % along, place[1]);
        let mut direction = DVec3::ZERO;
        direction[axis] = if is_negative { -1.0 } else { 1.0 };
        direction[(axis + 1) % 3] = a;
        direction[(axis + 2) % 3] = b;
        // On the side of a cube: dω = da db / (1 + a² + b²)^(3/2), where a is the tangent of an angle.
        let width = 2.0 * FRAC_PI_4 / along as f64;
        let area = (1.0 + a * a) * (1.0 + b * b) * width * width;
        let steradians = area / direction.length().powi(3);
        (direction.normalize(), steradians)
    }

    /// The cells next to a cell on its side of the cube, including the cell itself.
    pub fn about_cell(self, cell: usize) -> impl Iterator<Item = usize> {
        let along = self.along as isize;
        let (row, column) = (cell as isize / along % along, cell as isize % along);
        let first = cell as isize - row * along - column;
        let near = (-1..=1).flat_map(|down| (-1..=1).map(move |right| (down, right)));
        near.filter_map(move |(down, right)| {
            let (row, column) = (row + down, column + right);
            let is_there = (0..along).contains(&row) && (0..along).contains(&column);
            is_there.then_some((first + row * along + column) as usize)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::lattice;
    use std::f64::consts::PI;

    /// Protects the weights of waves: positions lie in their cells, and the cells together cover the sphere.
    #[test]
    fn cells_are_the_sphere() {
        for cells in [Cells::about(1.0), Cells::about(1000.0)] {
            let mut steradians = 0.0;
            const TIMES: usize = 8;
            for cell in 0..cells.count() {
                for place in 0..TIMES * TIMES {
                    let at = [place / TIMES, place % TIMES];
                    let at = at.map(|at| (at as f64 + 0.5) / TIMES as f64);
                    let (direction, wide) = cells.direction(cell, at);
                    assert_eq!(cells.of(direction), cell);
                    steradians += wide / (TIMES * TIMES) as f64;
                }
            }
            assert!((steradians / (4.0 * PI) - 1.0).abs() < 0.01, "{steradians}");
            let fine = cells.divided(3);
            for cell in 0..fine.count() {
                let (middle, _) = fine.direction(cell, [0.5; 2]);
                assert_eq!(fine.undivided(cell, 3), cells.of(middle));
            }
        }
    }

    /// Protects the estimate of a direction from the estimates of other directions.
    #[test]
    fn directions_have_cells_and_neighbours() {
        let cells = Cells::about(5000.0);
        for direction in lattice(10_000) {
            let cell = cells.of(direction);
            let (middle, _) = cells.direction(cell, [0.5; 2]);
            assert!(middle.angle_between(direction) < 0.05);
            let near: Vec<usize> = cells.about_cell(cell).collect();
            assert!(near.contains(&cell) && (4..=9).contains(&near.len()));
            for near in near {
                let (near, _) = cells.direction(near, [0.5; 2]);
                assert!(middle.angle_between(near) < 0.1);
            }
        }
    }
}
