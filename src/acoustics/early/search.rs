//! Searches for the sheets of a tree at a point, on all ways down the tree.

use super::sheet::{Form, Frame, Quadratic, Sheet};
use crate::fnv;
use glam::{DMat3, DVec3};

/// A way down a tree to a leaf or subtree.
#[derive(Clone, Copy, Debug)]
pub(super) struct Way {
    pub frame: Frame,
    /// The surface's level of the value, in metres.
    pub level: f64,
    /// 1 if the air is on the side of greater values, else −1.
    pub sign: f64,
    /// Identifies this way.
    pub id: u64,
}

/// A search, with the sheets found.
pub(super) struct Search<'a> {
    /// The point where the surface is met, in world metres.
    pub point: DVec3,
    /// Maximum distance in metres from a surface that counts as on it.
    pub touch: f64,
    /// The largest coordinate of the scene in metres.
    pub largest: f64,
    pub found: Vec<Sheet<'a>>,
    /// Whether a surface was met that is known only from samples.
    pub is_sampled: bool,
}

impl Way {
    /// The way to the surface with this number and these axes.
    pub fn to_surface(number: u32, frame: Frame) -> Way {
        let way = Way {
            frame,
            level: 0.0,
            sign: 1.0,
            id: fnv::OFFSET,
        };
        way.branch(number.into())
    }

    /// The way down the branch with this number.
    pub fn branch(self, number: u64) -> Way {
        let id = fnv::with(self.id, number + 1);
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

    /// The way with the value negated.
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

    /// The way down the branch with these 64 bits.
    pub fn branch_of_bits(self, bits: u64) -> Way {
        self.branch(bits.rotate_left(20) >> 1)
    }
}

impl<'a> Search<'a> {
    /// Offers a plane normal · p = offset in a leaf's axes; the normal is a unit vector towards
    /// greater values.
    pub fn flat(&mut self, normal: DVec3, offset: f64, way: Way, wall: Option<u8>) {
        let seen = way.frame.turn.transpose() * normal;
        let scale = seen.length();
        // If the shape was moved apart along the normal, the face vanishes in the gap.
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

    /// Adds a sheet on which the point lies.
    pub fn add(&mut self, form: Form<'a>, way: Way) {
        self.found.push(way.sheet(form, None));
    }
}
