//! One smooth piece of a surface: the face of a box, the side of a cylinder, a patch of ground.
//!
//! Surfaces of trees have edges, where they are not differentiable. A [`Sheet`] is the piece that a
//! wave has met, continued over its edges, so that Newton's method sees a smooth function. Whether
//! the result lies on the surface itself is checked afterwards.

use super::differences::{Derivatives, Differenced};
use glam::{DMat3, DVec3};

/// A smooth implicit function near a point: its zero set there, to second order.
#[derive(Clone, Copy, Debug)]
pub(super) struct Osculation {
    /// Value ÷ |gradient|: the signed distance to first order, in metres, positive in the air.
    pub distance: f64,
    /// Unit gradient in world axes, into the air.
    pub normal: DVec3,
    /// Second derivatives ÷ |gradient|, in 1/m; along the surface these are its curvatures,
    /// positive where it bends away from the air.
    pub bend: DMat3,
}

/// Axes of a part of a tree: p_own = `turn` p_outer + `shift`. The turn may scale, mirror, and
/// flatten (where a shape was moved apart).
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    pub turn: DMat3,
    pub shift: DVec3,
}

/// pᵀ Q p + b · p + c, Q symmetric.
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
    /// A ring about y: radius of its centre line, and of its tube.
    Torus { ring: f64, tube: f64 },
    /// A level of a tree's value, with derivatives by differences.
    Differenced(Differenced<'a>),
}

/// One smooth piece of a surface in the world.
#[derive(Clone, Debug)]
pub(super) struct Sheet<'a> {
    pub form: Form<'a>,
    pub frame: Frame,
    /// 1 if the air is on the side of positive values, else −1.
    pub sign: f64,
    /// Identifies the sheet of a surface.
    pub id: u64,
    /// The wall of a room: −x, +x, −y, +y, −z, +z as 0 to 5.
    pub wall: Option<u8>,
}

impl Frame {
    /// The outer axes themselves.
    pub const SAME: Frame = Frame {
        turn: DMat3::IDENTITY,
        shift: DVec3::ZERO,
    };

    pub fn place(&self, p: DVec3) -> DVec3 {
        self.turn * p + self.shift
    }

    /// The frame whose own point is `turn` p + `shift` where this one's own point is p.
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

    /// An infinite cylinder about a line along the unit vector `axis`, scaled in the same way.
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

/// a bᵀ.
pub(super) fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}

impl Sheet<'_> {
    /// A key that is equal, in most cases despite rounding, for sheets in one plane with the air on the same side.
    pub fn rounded_plane(&self, touch: f64) -> Option<[i64; 4]> {
        /// Resolution of normals, as a share of their length: coarser than the rounding of turned
        /// axes.
        const PARTS: f64 = 1e11;
        let (normal, offset) = self.plane()?;
        let [x, y, z] = (normal * PARTS).to_array().map(|part| part.round() as i64);
        Some([x, y, z, (offset / touch).round() as i64])
    }

    /// Whether it is a plane.
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

    /// Whether its derivatives are differences of a value.
    pub fn is_differenced(&self) -> bool {
        matches!(self.form, Form::Differenced(_))
    }

    /// The sheet near a world point; `None` if it has no normal there.
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

/// The distance from a ring about y. With q = (ρ − ring, y) in the plane through the axis, its
/// gradient is e = q/|q|; it bends by 1/|q| across the tube and by e_ρ/ρ about the axis.
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
