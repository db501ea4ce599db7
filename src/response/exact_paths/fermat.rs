//! Stationary paths over given surfaces: by mirror images of the source over planes (Allen and Berkley, *Image method
//! for efficiently simulating small-room acoustics*, JASA 65, 1979), otherwise by Newton's method.
//!
//! Fermat's principle: a path is specular if its length is stationary among all paths that touch
//! the same surfaces in the same order.
//!
//! Length L(x₁ … x_k) = Σ |x_{i+1} − x_i| between fixed ends, subject to f_i(x_i) = 0. With unit
//! vectors u_i of the segments, its gradient at x_i is u_{i−1} − u_i; it must be a multiple −λ_i
//! of the normal n_i, λ_i = −(u_{i−1} − u_i)·n_i. Newton's step solves, in coordinates t_i of the
//! tangent planes, Tᵀ W T δ = −Tᵀ ∇L with the second derivatives of L + Σ λ_i f_i,
//! - W_ii = P_{i−1}/d_{i−1} + P_i/d_i + λ_i B_i, where P = I − u uᵀ and B_i = ∇²f_i/|∇f_i|,
//! - W_{i,i+1} = −P_i/d_i,
//!
//! and then projects the points back onto their surfaces (Absil, Mahony and Sepulchre,
//! *Optimization Algorithms on Matrix Manifolds*, 2008, chapter 6), which makes the convergence quadratic. The path may
//! be a minimum, a maximum or a saddle: the merit to be reduced is |Tᵀ∇L|, the tangential difference of two unit
//! vectors. If the step does not reduce it, or the matrix is singular (a focus), a Levenberg–Marquardt step is used
//! instead.

use super::sheet::{Osculation, Sheet, outer};
use glam::{DMat3, DVec3};

/// Maximum tangential difference in radians of the unit vectors before and after a specular reflection. One more step
/// of Newton's method squares the difference. The limit is a thousand times the rounding of directions between points
/// whose distance is a thousandth of the scene.
const SPECULAR: f64 = 1e-10;

/// The limit of [`SPECULAR`] for a sheet whose derivatives are finite differences, with normals accurate to about
/// 10⁻¹⁰.
const SPECULAR_BY_DIFFERENCES: f64 = 1e-8;

/// Maximum number of steps. From a wave that passes close by, three to six steps are needed; at a focus about twenty.
const STEPS: usize = 60;

/// Maximum number of halvings of a step, and of tenfold increases of Marquardt's parameter.
const TRIES: usize = 12;

/// Maximum length of a step, as a share of the shorter of the two segments at its point, and maximum turn of the normal
/// in radians. The second derivatives are not valid beyond these limits.
const TRUST: f64 = 0.5;

/// Least distance of two consecutive points, as a share of the path's length: closer points lie in a corner.
const SHORTEST_SEGMENT: f64 = 1e-13;

/// Maximum number of Newton steps that project a point onto its sheet, and the error at which they
/// end, as a share of the coordinate's size.
const PROJECTION_STEPS: usize = 8;
const ON_SURFACE: f64 = 4.0 * f64::EPSILON;

/// A path between fixed ends, with one point on each of its sheets.
pub(super) struct Chain<'a> {
    pub source: DVec3,
    pub listener: DVec3,
    pub sheets: &'a [Sheet<'a>],
}

/// Points on their sheets, with the data for Newton's step.
#[derive(Clone)]
struct State {
    points: Vec<DVec3>,
    near: Vec<Osculation>,
    tangents: Vec<[DVec3; 2]>,
    /// Unit vectors and lengths of the segments.
    segments: Vec<(DVec3, f64)>,
    /// Tangential parts of ∇L, two for each point.
    slope: Vec<f64>,
}

impl Chain<'_> {
    /// The points of a specular path, solved for from `points`; `None` if no path is found.
    pub fn solve(&self, points: Vec<DVec3>) -> Option<Vec<DVec3>> {
        let mut state = self.state(points)?;
        let by_differences = self.sheets.iter().any(Sheet::is_differenced);
        let enough = match by_differences {
            true => SPECULAR_BY_DIFFERENCES,
            false => SPECULAR,
        };
        for _ in 0..STEPS {
            if state.error() <= enough {
                return Some(self.polished(state).points);
            }
            state = self.better(&state)?;
        }
        None
    }

    /// Takes one more step, and keeps it if it reduces the error.
    fn polished(&self, state: State) -> State {
        let step = state.newton_step();
        let next = step.and_then(|step| self.moved(&state, &step, 1.0));
        match next {
            Some(next) if next.merit() < state.merit() => next,
            _ => state,
        }
    }

    fn better(&self, state: &State) -> Option<State> {
        /// The least relative decrease of the merit per share of a full step (Armijo).
        const LEAST_FALL: f64 = 1e-4;
        if let Some(step) = state.newton_step() {
            let mut share = state.trusted(&step);
            for _ in 0..TRIES {
                let next = self.moved(state, &step, share);
                let most = state.merit() * (1.0 - LEAST_FALL * share);
                if let Some(next) = next.filter(|next| next.merit() <= most) {
                    return Some(next);
                }
                share *= 0.5;
            }
        }
        self.damped(state)
    }

    fn damped(&self, state: &State) -> Option<State> {
        /// Initial Marquardt parameter, as a share of the square of the matrix' largest element.
        const FIRST: f64 = 1e-8;
        let matrix = state.matrix();
        let right: Vec<f64> = matrix.times(&state.slope).iter().map(|x| -x).collect();
        let mut more = FIRST * matrix.largest().powi(2);
        for _ in 0..TRIES {
            let step = matrix.squared_plus(more).solve(right.clone());
            let next = step.and_then(|step| self.moved(state, &step, state.trusted(&step)));
            if let Some(next) = next.filter(|next| next.merit() < state.merit()) {
                return Some(next);
            }
            more *= 10.0;
        }
        None
    }

    fn moved(&self, state: &State, step: &[f64], share: f64) -> Option<State> {
        let moved = state.points.iter().enumerate().map(|(i, point)| {
            let [a, b] = state.tangents[i];
            *point + (a * step[2 * i] + b * step[2 * i + 1]) * share
        });
        self.state(moved.collect())
    }

    /// Projects points onto their sheets and computes the data of Newton's step; `None` if a sheet has no normal at its
    /// point, or two points coincide.
    fn state(&self, mut points: Vec<DVec3>) -> Option<State> {
        let mut near = Vec::with_capacity(points.len());
        for (point, sheet) in points.iter_mut().zip(self.sheets) {
            near.push(project(sheet, point)?);
        }
        let all: Vec<DVec3> = [self.source]
            .into_iter()
            .chain(points.iter().copied())
            .chain([self.listener])
            .collect();
        let offsets: Vec<DVec3> = all.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let total: f64 = offsets.iter().map(|offset| offset.length()).sum();
        let mut segments = Vec::with_capacity(offsets.len());
        for offset in offsets {
            let length = offset.length();
            if length.is_nan() || length <= SHORTEST_SEGMENT * total {
                return None;
            }
            segments.push((offset / length, length));
        }
        let tangents: Vec<_> = near
            .iter()
            .map(|at| at.normal.any_orthonormal_pair().into())
            .collect();
        let slope = tangents
            .iter()
            .enumerate()
            .flat_map(|(i, pair): (usize, &[DVec3; 2])| {
                let turn = segments[i].0 - segments[i + 1].0;
                pair.map(|tangent| tangent.dot(turn))
            });
        let slope = slope.collect();
        Some(State {
            points,
            near,
            tangents,
            segments,
            slope,
        })
    }
}

/// Moves a point along normals onto its sheet, and returns the sheet's osculation at that point.
fn project(sheet: &Sheet, point: &mut DVec3) -> Option<Osculation> {
    let mut at = sheet.at(*point)?;
    for _ in 0..PROJECTION_STEPS {
        if at.distance.abs() <= ON_SURFACE * point.abs().max_element() {
            break;
        }
        *point -= at.normal * at.distance;
        at = sheet.at(*point)?;
    }
    Some(at)
}

impl State {
    /// Half the squared length of the tangential slope.
    fn merit(&self) -> f64 {
        0.5 * self.slope.iter().map(|x| x * x).sum::<f64>()
    }

    /// The largest deviation of a reflection from a specular reflection, in radians.
    fn error(&self) -> f64 {
        self.slope.iter().fold(0.0, |most, x| x.abs().max(most))
    }

    fn newton_step(&self) -> Option<Vec<f64>> {
        let right = self.slope.iter().map(|x| -x).collect();
        self.matrix().solve(right)
    }

    /// The share of a step, at most 1, within which the second derivatives are valid.
    fn trusted(&self, step: &[f64]) -> f64 {
        let mut share: f64 = 1.0;
        for (i, at) in self.near.iter().enumerate() {
            let [a, b] = self.tangents[i];
            let offset = a * step[2 * i] + b * step[2 * i + 1];
            let length = offset.length();
            let shorter = self.segments[i].1.min(self.segments[i + 1].1);
            let turn = (at.bend * offset).length();
            if length > 0.0 && !at.bend.abs_diff_eq(DMat3::ZERO, 0.0) {
                share = share.min(TRUST * shorter / length);
            }
            if turn > 0.0 {
                share = share.min(TRUST / turn);
            }
        }
        share
    }

    /// Tᵀ W T.
    fn matrix(&self) -> Matrix {
        let count = self.points.len();
        let across: Vec<DMat3> = self.segments.iter().map(across).collect();
        let mut matrix = Matrix::zero(2 * count);
        for i in 0..count {
            let at = self.near[i];
            let turn = self.segments[i].0 - self.segments[i + 1].0;
            let multiplier = -turn.dot(at.normal);
            let own = across[i] + across[i + 1] + at.bend * multiplier;
            self.fill(&mut matrix, (i, i), own);
            if i + 1 < count {
                self.fill(&mut matrix, (i, i + 1), -across[i + 1]);
                self.fill(&mut matrix, (i + 1, i), -across[i + 1]);
            }
        }
        matrix
    }

    fn fill(&self, matrix: &mut Matrix, (i, j): (usize, usize), block: DMat3) {
        for (row, left) in self.tangents[i].iter().enumerate() {
            for (column, right) in self.tangents[j].iter().enumerate() {
                matrix.0[2 * i + row][2 * j + column] = left.dot(block * *right);
            }
        }
    }
}

/// (I − u uᵀ) ÷ length of a segment.
fn across((unit, length): &(DVec3, f64)) -> DMat3 {
    (DMat3::IDENTITY - outer(*unit, *unit)) * length.recip()
}

/// Maximum distance of a point beyond the ends of its segment, as a share of the segment. In an edge two points of a
/// path coincide, and rounding decides which point comes first.
const BEYOND: f64 = 1e-12;

/// The image of a point in the plane with unit normal n in which n · p is `offset`.
pub(super) fn image(place: DVec3, normal: DVec3, offset: f64) -> DVec3 {
    place - normal * (2.0 * (place.dot(normal) - offset))
}

/// The points at which the line from source to listener is mirrored at all sheets, in order. A line that is closer to a
/// plane than `touch` metres at both ends counts as within the plane. `None` if a sheet is not a plane, or if the line
/// to an image does not cross its plane.
pub(super) fn points_by_images<'a>(
    source: DVec3,
    listener: DVec3,
    touch: f64,
    sheets: impl Iterator<Item = &'a Sheet<'a>>,
) -> Option<Vec<DVec3>> {
    let planes: Vec<(DVec3, f64)> = sheets.map(Sheet::plane).collect::<Option<_>>()?;
    let mut images = vec![source];
    for (normal, offset) in &planes {
        let last = *images.last()?;
        images.push(image(last, *normal, *offset));
    }
    let mut points = vec![DVec3::ZERO; planes.len()];
    let mut seen_from = listener;
    for (i, (normal, offset)) in planes.iter().enumerate().rev() {
        seen_from = point_of_image(seen_from, images[i + 1], (*normal, *offset), touch)?;
        points[i] = seen_from;
    }
    Some(points)
}

/// The point of the plane with unit normal n and n · p = offset at which the line to an image in this plane is mirrored.
/// `None` if the line does not cross the plane.
pub(super) fn point_of_image(
    seen_from: DVec3,
    image: DVec3,
    (normal, offset): (DVec3, f64),
    touch: f64,
) -> Option<DVec3> {
    let here = seen_from.dot(normal) - offset;
    let there = image.dot(normal) - offset;
    // The remaining path is a single point if the source is in an edge. A path within the plane is mirrored at its
    // start.
    let is_point = seen_from.distance(image) <= touch;
    if is_point || here.abs().max(there.abs()) <= touch {
        return Some(image);
    }
    let share = here / (here - there);
    let is_crossed = (-BEYOND..=1.0 + BEYOND).contains(&share);
    is_crossed.then(|| seen_from + (image - seen_from) * share.clamp(0.0, 1.0))
}

/// A square matrix by rows, with 2 rows for each reflection.
#[derive(Clone, Debug)]
struct Matrix(Vec<Vec<f64>>);

/// Least pivot, as a share of the matrix' largest element: smaller pivots are rounding errors.
const LEAST_PIVOT: f64 = 1e-14;

impl Matrix {
    fn zero(size: usize) -> Matrix {
        Matrix(vec![vec![0.0; size]; size])
    }

    /// The largest magnitude of its elements.
    fn largest(&self) -> f64 {
        let elements = self.0.iter().flatten();
        elements.fold(0.0, |most, x| x.abs().max(most))
    }

    /// M v.
    fn times(&self, v: &[f64]) -> Vec<f64> {
        let dot = |row: &Vec<f64>| row.iter().zip(v).map(|(a, b)| a * b).sum();
        self.0.iter().map(dot).collect()
    }

    /// M M + `more` I for a symmetric matrix M.
    fn squared_plus(&self, more: f64) -> Matrix {
        let mut square = Matrix::zero(self.0.len());
        for (row, numbers) in square.0.iter_mut().enumerate() {
            for (column, number) in numbers.iter_mut().enumerate() {
                let products = self.0[row].iter().zip(&self.0);
                let sum: f64 = products.map(|(number, other)| number * other[column]).sum();
                *number = sum + if row == column { more } else { 0.0 };
            }
        }
        square
    }

    /// x with M x = `right`, by Gaussian elimination with row pivots; `None` for a singular matrix.
    fn solve(mut self, mut right: Vec<f64>) -> Option<Vec<f64>> {
        let (least, size) = (LEAST_PIVOT * self.largest(), right.len());
        let rows = &mut self.0;
        for column in 0..size {
            let magnitude = |row: usize| rows[row][column].abs();
            let pivot = (column..size).max_by(|&a, &b| magnitude(a).total_cmp(&magnitude(b)))?;
            if magnitude(pivot) <= least {
                return None;
            }
            rows.swap(pivot, column);
            right.swap(pivot, column);
            let (above, below) = rows.split_at_mut(column + 1);
            let (pivot, of_pivot) = (&above[column], right[column]);
            for (row, right) in below.iter_mut().zip(&mut right[column + 1..]) {
                let factor = row[column] / pivot[column];
                for (number, other) in row[column..].iter_mut().zip(&pivot[column..]) {
                    *number -= factor * other;
                }
                *right -= factor * of_pivot;
            }
        }
        for row in (0..size).rev() {
            let known = (row + 1..size).map(|k| rows[row][k] * right[k]);
            right[row] = (right[row] - known.sum::<f64>()) / rows[row][row];
        }
        Some(right)
    }
}
