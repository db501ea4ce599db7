//! Small dense systems of linear equations.

/// A square matrix by rows, with 2 rows for each reflection.
#[derive(Clone, Debug)]
pub(super) struct Matrix {
    size: usize,
    numbers: Vec<f64>,
}

/// Least pivot, as a share of the matrix' largest element: a smaller one is rounding.
const LEAST_PIVOT: f64 = 1e-14;

impl Matrix {
    pub fn zero(size: usize) -> Matrix {
        Matrix {
            size,
            numbers: vec![0.0; size * size],
        }
    }

    pub fn at_mut(&mut self, row: usize, column: usize) -> &mut f64 {
        &mut self.numbers[row * self.size + column]
    }

    pub fn at(&self, row: usize, column: usize) -> f64 {
        self.numbers[row * self.size + column]
    }

    /// The largest magnitude of its elements.
    pub fn largest(&self) -> f64 {
        self.numbers.iter().fold(0.0, |most, x| x.abs().max(most))
    }

    /// M v.
    pub fn times(&self, v: &[f64]) -> Vec<f64> {
        let rows = self.numbers.chunks_exact(self.size);
        let dot = |row: &[f64]| row.iter().zip(v).map(|(a, b)| a * b).sum();
        rows.map(dot).collect()
    }

    /// M M + `more` I for a symmetric matrix M.
    pub fn squared_plus(&self, more: f64) -> Matrix {
        let mut square = Matrix::zero(self.size);
        for row in 0..self.size {
            for column in 0..self.size {
                let products = (0..self.size).map(|k| self.at(row, k) * self.at(k, column));
                let diagonal = if row == column { more } else { 0.0 };
                *square.at_mut(row, column) = products.sum::<f64>() + diagonal;
            }
        }
        square
    }

    /// x with M x = `right`, by Gaussian elimination with row pivots; `None` for a singular matrix.
    pub fn solve(mut self, mut right: Vec<f64>) -> Option<Vec<f64>> {
        let least = LEAST_PIVOT * self.largest();
        for column in 0..self.size {
            let below = column..self.size;
            let pivot = below.max_by(|&a, &b| {
                let size = |row: usize| self.at(row, column).abs();
                size(a).total_cmp(&size(b))
            })?;
            if self.at(pivot, column).abs() <= least {
                return None;
            }
            self.swap_rows(pivot, column);
            right.swap(pivot, column);
            for row in column + 1..self.size {
                let factor = self.at(row, column) / self.at(column, column);
                for k in column..self.size {
                    *self.at_mut(row, k) -= factor * self.at(column, k);
                }
                right[row] -= factor * right[column];
            }
        }
        for row in (0..self.size).rev() {
            let known = (row + 1..self.size).map(|k| self.at(row, k) * right[k]);
            right[row] = (right[row] - known.sum::<f64>()) / self.at(row, row);
        }
        Some(right)
    }

    fn swap_rows(&mut self, a: usize, b: usize) {
        for column in 0..self.size {
            self.numbers
                .swap(a * self.size + column, b * self.size + column);
        }
    }
}
