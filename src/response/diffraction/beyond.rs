//! Reflections at the faces beside an edge: their sound beyond the ends of the face.
//!
//! A plane face is an opening between the image of the source and the listener. Beyond its end the reflection goes on as
//! the pressure that the end diffracts (`wedge.rs`). A narrow face, as the inner face of a doorway, has a second end near
//! by. It adds ½ W(√(kδ)) of the image's pressure, with the detour δ of the way over it from the image: with a minus sign
//! while the line to the image passes the plane on the face's side of this end, as in `face.rs`. Sound that passes both
//! ends one after the other, as along the top of a wall, has twice the product of both pressures (Pierce 1974): on the face
//! between them it is one with its reflection.

use super::brink::Brink;
use super::edge::{Edge, ON_SURFACE};
use super::space::Space;
use super::wedge::{behind_screen, share_of_direct};
use glam::DVec3;
use num_complex::Complex64;

/// Distance from an edge at which the normals of its faces are measured, as a share of the leg.
const NEAR_EDGE: f64 = 0.002;

/// Width of the narrowest face with two separate ends, as a share of the way: 2 cm in 5 m. A wall of this
/// thickness is a thin screen up to 8 kHz.
const NARROWEST: f64 = 0.004;

/// Exponent of the share with which a narrow face counts as hidden. A face that is seen at a small angle reflects almost
/// as one that is seen from the front: levels behind doorways (`tests.rs`) have the smallest errors without this share.
/// With it they are continuous where the listener passes the plane of the face.
const HIDDEN: i32 = 4;

/// Distance at which faces are perceived, as a share of the width of a face, up to which the face has this width.
const MOST_OF_WIDTH: f64 = 0.7;

/// A face beside an edge.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct FaceBeside {
    /// Whether its reflection is a path of its own.
    pub is_heard: bool,
    /// Whether what its ends diffract counts at the other end.
    is_left: bool,
    /// The face between two ends, if the other one is straight and near.
    strip: Option<Strip>,
}

/// A face between two parallel ends.
#[derive(Clone, Copy, Debug)]
struct Strip {
    /// How much of the face is seen, from 0 in its plane to 1.
    seen: f64,
    /// The line of the end that is not at the edge itself.
    far: Edge,
    /// Width in metres.
    width_m: f64,
    /// Distance in metres from the image of the source to the listener.
    image_m: f64,
    /// The end at the edge itself, and the other one.
    ends: [End; 2],
}

/// The end of a face.
#[derive(Clone, Copy, Debug)]
struct End {
    /// Length in metres from the source to the listener over this end.
    length_m: f64,
    /// 1 if the reflection lies beyond this end, otherwise −1.
    sign: f64,
}

impl FaceBeside {
    /// The face that lies beside the leg from an edge to the first of these ends. `outwards` points away from the solid.
    pub fn of(
        space: &impl Space,
        (edge, outwards): (&Edge, DVec3),
        [end, other]: [DVec3; 2],
    ) -> FaceBeside {
        let radius = NEAR_EDGE * edge.point.distance(end);
        let Some((along, normal)) = edge.face_beside(space, (end, outwards), radius) else {
            return FaceBeside::default();
        };
        let heights = [end, other].map(|end| (end - edge.point).dot(normal));
        if heights.iter().any(|height| *height <= 0.0) {
            return FaceBeside::default();
        }
        let share = heights[0] / (heights[0] + heights[1]);
        let image = end - normal * (2.0 * heights[0]);
        let point = image.lerp(other, share);
        let length_m = end.distance(edge.point) + edge.point.distance(other);
        let widths_m = [NARROWEST * length_m, length_m];
        let strip = Brink::of_face(space, edge, (along, normal), widths_m).map(|brink| {
            let at = |line: &Edge, beyond: DVec3| {
                let over = line.shortest(end, other);
                End {
                    length_m: end.distance(over) + over.distance(other),
                    sign: if (point - line.point).dot(beyond) > 0.0 {
                        1.0
                    } else {
                        -1.0
                    },
                }
            };
            let far = brink.edge();
            let angle = |end: DVec3| {
                let off = end - edge.point;
                off.dot(normal).atan2(off.dot(along))
            };
            let share = share_of_direct(angle(end), angle(other));
            Strip {
                seen: 1.0 - (2.0 * share).min(1.0).powi(HIDDEN),
                far,
                width_m: brink.width_m,
                image_m: image.distance(other),
                ends: [at(edge, -along), at(&far, along)],
            }
        });
        FaceBeside {
            // A reflection whose point another solid covers is hidden.
            is_heard: space.distance(point) <= ON_SURFACE * length_m,
            is_left: false,
            strip,
        }
    }

    /// Leaves the reflection to the other end of the face, if that lies on this edge.
    pub fn leave_to(&mut self, other: &Edge, near_m: f64) {
        self.is_left |= self.ends_at(other.point, near_m);
    }

    /// The line of the end of a narrow face that is not at the edge itself.
    pub fn other_end(&self) -> Option<Edge> {
        self.strip.as_ref().map(|strip| strip.far)
    }

    /// Whether a point lies on this end.
    pub fn ends_at(&self, point: DVec3, near_m: f64) -> bool {
        self.other_end()
            .is_some_and(|end| end.is_near(point, near_m))
    }

    /// The pressure of the reflection for the wave number `k`, relative to the direct sound over `apart_m` metres; 0 if it is
    /// heard. `term` is the pressure at the edge itself, with faces measured `radius` metres from it, and `share` the part
    /// of it that belongs to the direct sound.
    pub fn reflected(
        &self,
        (k, apart_m): (f64, f64),
        radius: f64,
        (term, share): (Complex64, f64),
    ) -> Complex64 {
        if self.is_heard || self.is_left {
            return Complex64::ZERO;
        }
        let own = own(term, share);
        self.strip.as_ref().map_or(own, |strip| {
            let [near, far] = strip.ends.map(|end| {
                let phase = Complex64::cis(k * (end.length_m - apart_m));
                strip.screen(k, &end) * phase * (end.sign * apart_m / strip.image_m)
            });
            let narrow = strip.seen * strip.narrowness(radius);
            own * (1.0 - narrow) + near * narrow + far * strip.seen
        })
    }

    /// The pressure of sound that passes both ends of the face.
    pub fn over_both_ends(&self, k: f64, (term, share): (Complex64, f64)) -> Complex64 {
        let strip = self.strip.as_ref().filter(|_| !self.is_left);
        strip.map_or(Complex64::ZERO, |strip| {
            2.0 * own(term, share) * strip.screen(k, &strip.ends[1])
        })
    }
}

impl Strip {
    /// The pressure behind a thin screen that ends there, seen from the image.
    fn screen(&self, k: f64, end: &End) -> Complex64 {
        behind_screen(k * (end.length_m - self.image_m))
    }

    /// How much the face is narrower than the distance in metres at which faces are perceived, from 0 to 1: its ends then
    /// diffract as those of an opening do.
    fn narrowness(&self, radius: f64) -> f64 {
        let perceived = MOST_OF_WIDTH * self.width_m;
        ((radius - perceived) / (self.width_m - perceived)).clamp(0.0, 1.0)
    }
}

/// The part of a pressure that does not belong to the direct sound.
fn own(term: Complex64, share: f64) -> Complex64 {
    term * (1.0 - share * share).sqrt()
}
