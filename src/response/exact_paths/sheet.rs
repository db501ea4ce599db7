//! One smooth piece of a surface: the face of a box, the side of a cylinder, a patch of ground.
//!
//! Surfaces of trees have edges, where they are not differentiable. A [`Sheet`] is the piece hit by a wave, continued
//! beyond its edges, so that the function is smooth for Newton's method. A later check decides whether the result lies
//! on the surface itself.
//!
//! # Differences
//! Values are rounded: for coordinates up to X the error of a value is about ε X. With features of length ℓ the n-th
//! derivative of a value is about ℓ^(1−n). A difference quotient over steps h has a rounding error and a truncation
//! error. The step h makes both errors equal:
//! - gradient, of fourth order: rounding ε X / h, truncation h⁴ / ℓ⁴ (÷ 30): h⁵ = ε X ℓ⁴;
//! - second derivatives, of second order: ε X / h² and h² / ℓ³ (÷ 12): h⁴ = 12 ε X ℓ³, extrapolated
//!   from two steps to a step of 0 (Richardson).
//!
//! X = 50 m and ℓ = 0.1 m give an error of 4·10⁻¹¹ in the gradient and of 10⁻⁶/m in the second derivatives.

use crate::sampling::{FNV_EMPTY, fnv_with};
use crate::scene::Shape;
use glam::{DMat3, DVec3};

/// A smooth implicit function near a point: its zero set to second order.
#[derive(Clone, Copy, Debug)]
pub(super) struct Osculation {
    /// Value ÷ |gradient|. This is the signed distance to first order, in metres, positive in the air.
    pub distance: f64,
    /// Unit gradient in world axes, into the air.
    pub normal: DVec3,
    /// Second derivatives ÷ |gradient|, in 1/m; along the surface these are its curvatures, positive where the surface
    /// bends away from the air.
    pub bend: DMat3,
}

/// Axes of a part of a tree: p_own = `turn` p_outer + `shift`. The turn may scale, mirror, and flatten (inside the gap
/// of an elongated shape).
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    pub turn: DMat3,
    pub shift: DVec3,
}

/// A quadratic function pᵀ Q p + b · p + c, with Q symmetric.
#[derive(Clone, Copy, Debug)]
pub(super) struct Quadratic {
    pub form: DMat3,
    pub linear: DVec3,
    pub constant: f64,
}

/// The form of a sheet, in its own axes.
#[derive(Clone, Debug)]
pub(super) enum Form<'a> {
    /// normal · p = offset, in world axes.
    Flat { normal: DVec3, offset: f64 },
    /// The zero set of a quadratic function.
    Quadric(Quadratic),
    /// A ring about y, with the radii of its centre line and its tube.
    Torus { ring: f64, tube: f64 },
    /// A level of a tree's value, with derivatives by differences.
    Differenced(Differenced<'a>),
}

/// One smooth piece of a surface in the world.
#[derive(Clone, Debug)]
pub(super) struct Sheet<'a> {
    pub form: Form<'a>,
    pub frame: Frame,
    /// 1 if the air is on the side of positive values, otherwise −1.
    pub sign: f64,
    /// Identifies the sheet of a surface.
    pub id: u64,
    /// The wall of a room: −x, +x, −y, +y, −z, +z as 0 to 5; or the group of a mesh.
    pub wall: Option<u8>,
}

impl Frame {
    /// The outer axes, unchanged.
    pub const SAME: Frame = Frame {
        turn: DMat3::IDENTITY,
        shift: DVec3::ZERO,
    };

    pub fn place(&self, p: DVec3) -> DVec3 {
        self.turn * p + self.shift
    }

    /// The frame with the own point `turn` p + `shift`, where p is the own point of `self`.
    pub fn then(&self, turn: DMat3, shift: DVec3) -> Frame {
        Frame {
            turn: turn * self.turn,
            shift: turn * self.shift + shift,
        }
    }
}

impl Quadratic {
    /// A ball, scaled so that its gradient has length 1 at the surface.
    pub fn ball(centre: DVec3, radius: f64) -> Quadratic {
        Quadratic::about(DMat3::IDENTITY, centre, radius)
    }

    /// An infinite cylinder about a line along the unit vector `axis`, scaled so that its gradient has length 1 at the
    /// surface.
    pub fn rod(axis: DVec3, on_axis: DVec3, radius: f64) -> Quadratic {
        let across = DMat3::IDENTITY - outer(axis, axis);
        Quadratic::about(across, on_axis, radius)
    }

    fn about(across: DMat3, centre: DVec3, radius: f64) -> Quadratic {
        let form = across * (0.5 / radius);
        let seen = form * centre;
        Quadratic {
            form,
            linear: -2.0 * seen,
            constant: centre.dot(seen) - 0.5 * radius,
        }
    }

    fn derivatives(&self, p: DVec3) -> Derivatives {
        let form = self.form * p;
        Derivatives {
            value: p.dot(form) + self.linear.dot(p) + self.constant,
            gradient: 2.0 * form + self.linear,
            hessian: self.form * 2.0,
        }
    }
}

/// The outer product a bᵀ.
pub(super) fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}

impl Sheet<'_> {
    /// A key of a plane and its air side. Despite rounding, the keys of sheets in one plane with the air on the same
    /// side are equal in most cases.
    pub fn rounded_plane(&self, touch: f64) -> Option<[i64; 4]> {
        /// Resolution of normals: one part in this number, coarser than the rounding of turned axes.
        const PARTS: f64 = 1e11;
        let (normal, offset) = self.plane()?;
        let [x, y, z] = (normal * PARTS).to_array().map(|part| part.round() as i64);
        Some([x, y, z, (offset / touch).round() as i64])
    }

    /// Whether the sheet is a plane.
    pub fn is_flat(&self) -> bool {
        matches!(self.form, Form::Flat { .. })
    }

    /// The unit normal and the offset of a plane normal · p = offset, in world axes.
    pub fn plane(&self) -> Option<(DVec3, f64)> {
        match self.form {
            Form::Flat { normal, offset } => Some((normal, offset)),
            _ => None,
        }
    }

    /// Whether its derivatives are finite differences of a value.
    pub fn is_differenced(&self) -> bool {
        matches!(self.form, Form::Differenced(_))
    }

    /// The sheet near a world point; `None` if it has no normal at that point.
    pub fn at(&self, p: DVec3) -> Option<Osculation> {
        let own = self.frame.place(p);
        let found = match &self.form {
            Form::Flat { normal, offset } => {
                return Some(Osculation {
                    distance: normal.dot(p) - offset,
                    normal: *normal,
                    bend: DMat3::ZERO,
                });
            }
            Form::Quadric(quadric) => quadric.derivatives(own),
            Form::Torus { ring, tube } => torus(*ring, *tube, own),
            Form::Differenced(differenced) => differenced.derivatives(own),
        };
        let back = self.frame.turn.transpose();
        let gradient = self.sign * (back * found.gradient);
        let steepness = gradient.length();
        let is_sound = steepness > 0.0 && steepness.is_finite();
        is_sound.then(|| Osculation {
            distance: self.sign * found.value / steepness,
            normal: gradient / steepness,
            bend: back * found.hessian * self.frame.turn * (self.sign / steepness),
        })
    }
}

/// The distance from a ring about y. With q = (ρ − ring, y) in the plane through the axis, the gradient is e = q/|q|,
/// and its derivatives are 1/|q| across the tube and e_ρ/ρ about the axis.
fn torus(ring: f64, tube: f64, p: DVec3) -> Derivatives {
    let from_axis = p.x.hypot(p.z);
    let outwards = DVec3::new(p.x, 0.0, p.z) / from_axis;
    let about = DVec3::new(-outwards.z, 0.0, outwards.x);
    let from_ring = (from_axis - ring).hypot(p.y);
    let (across, up) = ((from_axis - ring) / from_ring, p.y / from_ring);
    let along_tube = DVec3::Y * across - outwards * up;
    Derivatives {
        value: from_ring - tube,
        gradient: outwards * across + DVec3::Y * up,
        hessian: outer(along_tube, along_tube) * from_ring.recip()
            + outer(about, about) * (across / from_axis),
    }
}

/// Value, gradient and second derivatives at a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Derivatives {
    pub value: f64,
    pub gradient: DVec3,
    pub hessian: DMat3,
}

/// A level set of a tree's value, with derivatives by finite differences.
#[derive(Clone, Copy, Debug)]
pub(super) struct Differenced<'a> {
    shape: &'a Shape,
    level: f64,
    gradient_step: f64,
    hessian_step: f64,
}

impl<'a> Differenced<'a> {
    /// The surface where the value of `shape` is `level` metres; `largest` is the largest
    /// coordinate of a point, in metres.
    pub fn new(shape: &'a Shape, level: f64, largest: f64) -> Differenced<'a> {
        let lengths = shape.nodes().into_iter();
        let own = lengths.map(|tree| tree.node.part().own_length());
        let shortest = own.filter(|l| *l > 0.0).fold(f64::INFINITY, f64::min);
        // If the shape contains no lengths, any step is suitable.
        let feature = if shortest.is_finite() { shortest } else { 1.0 };
        let rounding = f64::EPSILON * largest.max(feature);
        Differenced {
            shape,
            level,
            gradient_step: (rounding * feature.powi(4)).powf(0.2),
            hessian_step: (12.0 * rounding * feature.powi(3)).powf(0.25),
        }
    }

    /// Derivatives at a point in the tree's own axes.
    pub fn derivatives(&self, p: DVec3) -> Derivatives {
        let (h, value) = (self.hessian_step, self.shape.value(p));
        let fine = self.second(p, value, h);
        let coarse = self.second(p, value, 2.0 * h);
        Derivatives {
            value: value - self.level,
            gradient: self.gradient(p),
            hessian: (fine * 4.0 - coarse) * (1.0 / 3.0),
        }
    }

    fn gradient(&self, p: DVec3) -> DVec3 {
        let h = self.gradient_step;
        let along = |axis: DVec3| {
            let rise = |steps: f64| {
                self.shape.value(p + axis * (steps * h)) - self.shape.value(p - axis * (steps * h))
            };
            (8.0 * rise(1.0) - rise(2.0)) / (12.0 * h)
        };
        DVec3::new(along(DVec3::X), along(DVec3::Y), along(DVec3::Z))
    }

    fn second(&self, p: DVec3, value: f64, h: f64) -> DMat3 {
        let at = |offset: DVec3| self.shape.value(p + offset * h);
        let straight = |axis: DVec3| (at(axis) + at(-axis) - 2.0 * value) / (h * h);
        let mixed =
            |a: DVec3, b: DVec3| (at(a + b) + at(-a - b) - at(a - b) - at(b - a)) / (4.0 * h * h);
        let [x, y, z] = DVec3::AXES;
        let (xy, yz, zx) = (mixed(x, y), mixed(y, z), mixed(z, x));
        DMat3::from_cols(
            DVec3::new(straight(x), xy, zx),
            DVec3::new(xy, straight(y), yz),
            DVec3::new(zx, yz, straight(z)),
        )
    }
}

/// A path down a tree to a leaf or subtree.
#[derive(Clone, Copy, Debug)]
pub(super) struct Way {
    pub frame: Frame,
    /// The surface's level of the value, in metres.
    pub level: f64,
    /// 1 if the air is on the side of greater values, otherwise −1.
    pub sign: f64,
    /// Identifies this path down the tree.
    pub id: u64,
}

/// A search for sheets at a point, with the sheets found.
pub(super) struct Search<'a> {
    /// The point at which the surface was hit, in world metres.
    pub point: DVec3,
    /// Maximum distance in metres at which a point counts as on a surface.
    pub touch: f64,
    /// The largest coordinate of the scene in metres.
    pub largest: f64,
    pub found: Vec<Sheet<'a>>,
    /// Whether the search reached a surface known only from samples.
    pub is_sampled: bool,
}

impl Way {
    /// The start of the path down a tree, at the surface with this number and these axes.
    pub fn to_surface(number: u32, frame: Frame) -> Way {
        let way = Way {
            frame,
            level: 0.0,
            sign: 1.0,
            id: FNV_EMPTY,
        };
        way.branch(number.into())
    }

    /// The path down the tree, continued to the branch with this number.
    pub fn branch(self, number: u64) -> Way {
        let id = fnv_with(self.id, number + 1);
        Way { id, ..self }
    }

    pub fn turned(self, turn: DMat3, shift: DVec3) -> Way {
        let frame = self.frame.then(turn, shift);
        Way { frame, ..self }
    }

    pub fn moved(self, shift: DVec3) -> Way {
        self.turned(DMat3::IDENTITY, shift)
    }

    pub fn at(self, level: f64) -> Way {
        Way { level, ..self }
    }

    /// The way with negated values.
    pub fn turned_out(self) -> Way {
        Way {
            level: -self.level,
            sign: -self.sign,
            ..self
        }
    }

    /// The sheet of this form at the end of the way.
    fn sheet(self, form: Form<'_>, wall: Option<u8>) -> Sheet<'_> {
        Sheet {
            form,
            frame: self.frame,
            sign: self.sign,
            id: self.id,
            wall,
        }
    }

    /// The path down the tree, continued to the branch with these 64 bits.
    pub fn branch_of_bits(self, bits: u64) -> Way {
        self.branch(bits.rotate_left(20) >> 1)
    }
}

impl<'a> Search<'a> {
    /// A search at a world point, without sheets.
    pub fn near(point: DVec3, touch: f64, largest: f64) -> Search<'a> {
        Search {
            point,
            touch,
            largest,
            found: Vec::new(),
            is_sampled: false,
        }
    }

    /// Offers the plane normal · p = offset in a leaf's axes; the normal is a unit vector towards greater values.
    pub fn flat(&mut self, normal: DVec3, offset: f64, way: Way, wall: Option<u8>) {
        let seen = way.frame.turn.transpose() * normal;
        let scale = seen.length();
        // If the shape is elongated along the normal, there is no face in the gap.
        if scale == 0.0 {
            return;
        }
        let form = Form::Flat {
            normal: seen * (way.sign / scale),
            offset: (offset - normal.dot(way.frame.shift)) * (way.sign / scale),
        };
        self.offer(form, way, wall);
    }

    pub fn quadric(&mut self, quadric: Quadratic, way: Way) {
        self.offer(Form::Quadric(quadric), way, None);
    }

    /// Adds a sheet of a leaf if the point lies on it.
    pub fn offer(&mut self, form: Form<'a>, way: Way, wall: Option<u8>) {
        let sheet = way.sheet(form, wall);
        let at = sheet.at(self.point);
        if at.is_some_and(|at| at.distance.abs() <= self.touch) {
            self.found.push(sheet);
        }
    }

    /// Adds a sheet that is known to contain the point.
    pub fn add(&mut self, form: Form<'a>, way: Way) {
        self.found.push(way.sheet(form, None));
    }
}
