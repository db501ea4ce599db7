//! What cannot be a field, and why: each in one sentence.

use super::value::Quadric;
use super::{Field, Node};
use glam::{DVec2, DVec3, Vec3};

/// The largest length, in metres.
const LARGEST: f32 = 1e9;

/// Nodes of one tree at the most.
const MOST_NODES: usize = crate::scene::layout::MOST_UNROLLED;

/// Points at which a stated Lipschitz constant is tried.
const TRIES: usize = 4096;

/// Times at which it is tried at all these points; of more times each gets a share of them.
const TIMES_IN_FULL: usize = 64;

/// Points at which it is tried at each time at the least.
const LEAST_TRIES: usize = 32;

/// By how much a difference quotient may exceed a stated constant before it is refused:
/// what rounding does to a quotient over a thousandth of the size.
const ROUNDING: f64 = 1e-3;

impl Field {
    /// Checks the tree's numbers, its operators' operands and that every repetition is safe:
    /// cheap enough for every frame. What takes evaluations is in [`Field::check`].
    ///
    /// # Errors
    /// A sentence that names the node and says what it must be.
    pub fn validate(&self) -> Result<(), String> {
        let nodes = self.nodes();
        if nodes.len() > MOST_NODES {
            let count = nodes.len();
            return Err(format!(
                "a field of {count} nodes is too large: {MOST_NODES} at the most"
            ));
        }
        for field in nodes {
            field
                .validate_operands()
                .and_then(|()| field.node.validate())
                .map_err(|why| format!("{}: {why}", field.node.name()))?;
        }
        // Only sound numbers have properties.
        for field in self.nodes() {
            field
                .copies()
                .map(|_| ())
                .and_then(|()| field.validate_turning())
                .map_err(|why| format!("{}: {why}", field.node.name()))?;
        }
        Ok(())
    }

    /// Checks the tree as [`Field::validate`] does, and tries every stated Lipschitz constant
    /// by some thousand evaluations; the text of users' fields is read, but not yet compiled.
    ///
    /// # Errors
    /// A sentence that names the node and says what it must be.
    pub fn check(&self) -> Result<(), String> {
        self.validate()?;
        for field in self.nodes() {
            field
                .check_growth(TRIES)
                .and_then(|()| field.check_text())
                .map_err(|why| format!("{}: {why}", field.node.name()))?;
        }
        Ok(())
    }

    /// Tries every stated Lipschitz constant as the field stands at one of so many times, all
    /// of which take some seconds together at the most.
    pub(in crate::scene) fn check_growth_at_one_of(&self, times: usize) -> Result<(), String> {
        let tries = TRIES * TIMES_IN_FULL / times.max(1);
        let tries = tries.clamp(LEAST_TRIES, TRIES);
        for field in self.nodes() {
            let checked = field.check_growth(tries);
            checked.map_err(|why| format!("{}: {why}", field.node.name()))?;
        }
        Ok(())
    }

    fn validate_operands(&self) -> Result<(), String> {
        let (least, most) = self.node.operands();
        let count = self.of.len();
        if (least..=most).contains(&count) {
            return Ok(());
        }
        Err(match (least, most) {
            (0, _) => "is a shape and takes no fields".to_owned(),
            (least, most) if least == most => format!("takes {least} fields, not {count}"),
            (least, _) => format!("takes at least {least} fields, not {count}"),
        })
    }

    /// A twist or a bend grows the value without bound unless what it turns ends.
    fn validate_turning(&self) -> Result<(), String> {
        let axis = match &self.node {
            Node::Twist { .. } => 1,
            Node::Bend { .. } => 2,
            _ => return Ok(()),
        };
        let of = self.of[0].properties();
        let away = ["x", "y", "z"][axis];
        if of.bounds.radius_about(axis).is_finite() {
            return Ok(());
        }
        Err(format!(
            "what it turns has no end away from the {away} axis, so that its value grows without bound: intersect it with something that ends"
        ))
    }

    /// The constant that a twist or a bend states is tried.
    fn check_growth(&self, tries: usize) -> Result<(), String> {
        let stated = match &self.node {
            Node::Twist { lipschitz, .. } | Node::Bend { lipschitz, .. } if *lipschitz > 0.0 => {
                *lipschitz
            }
            _ => return Ok(()),
        };
        let (steepest, place) = self.steepest_of(tries);
        if steepest <= f64::from(stated) * (1.0 + ROUNDING) {
            return Ok(());
        }
        Err(format!(
            "its value grows by {steepest:.3} a metre at ({:.3}, {:.3}, {:.3}), more than the stated lipschitz of {stated}: state at least {:.3}, or leave it out to have it computed",
            place.x,
            place.y,
            place.z,
            1.01 * steepest
        ))
    }

    /// A user's text has the function, and nothing that a shader would have to be given.
    fn check_text(&self) -> Result<(), String> {
        match &self.node {
            Node::User { field } => field.check_text().map_err(|(line, why)| {
                let file = field.file.display();
                match line {
                    Some(line) => format!("{file}:{line}: {why}"),
                    None => format!("{file}: {why}"),
                }
            }),
            _ => Ok(()),
        }
    }

    /// The greatest difference quotient found at points of the field's bounds, and where.
    pub fn steepest(&self) -> (f64, DVec3) {
        self.steepest_of(TRIES)
    }

    fn steepest_of(&self, tries: usize) -> (f64, DVec3) {
        let bounds = self.properties().bounds;
        let reach = DVec3::splat(10.0);
        let box_ = super::Bounds3 {
            min: bounds.min.max(-reach),
            max: bounds.max.min(reach),
        };
        let step = 1e-4 * (box_.max - box_.min).max_element().max(1e-6);
        let mut found = (0.0, DVec3::ZERO);
        for index in 1..=tries {
            let p = box_.min + halton(index) * (box_.max - box_.min);
            let along = |axis: DVec3| {
                (self.value(p + axis * step) - self.value(p - axis * step)) / (2.0 * step)
            };
            let gradient = DVec3::new(along(DVec3::X), along(DVec3::Y), along(DVec3::Z));
            if gradient.length() > found.0 {
                found = (gradient.length(), p);
            }
        }
        found
    }
}

/// The n-th point of Halton's sequence in bases 2, 3, 5: evenly over the unit cube.
pub(crate) fn halton(index: usize) -> DVec3 {
    let radical_inverse = |base: usize| {
        let (mut rest, mut share, mut sum) = (index, 1.0, 0.0);
        while rest > 0 {
            share /= base as f64;
            sum += share * (rest % base) as f64;
            rest /= base;
        }
        sum
    };
    DVec3::new(radical_inverse(2), radical_inverse(3), radical_inverse(5))
}

impl Node {
    /// The node's own numbers, each against its range.
    fn validate(&self) -> Result<(), String> {
        match self {
            Node::HalfSpace { normal, offset } => {
                finite("normal", *normal)?;
                if normal.length() < 1e-6 {
                    return Err("its normal must have a length".to_owned());
                }
                number("offset in metres", *offset)
            }
            Node::Box { size } | Node::Room { size } => all_positive("size in metres", *size),
            Node::RoundedBox { size, rounding } => {
                all_positive("size in metres", *size)?;
                positive("rounding in metres", *rounding)?;
                if 2.0 * rounding > size.min_element() {
                    return Err(format!(
                        "its rounding of {rounding} m must be at most half its least size of {} m",
                        size.min_element()
                    ));
                }
                Ok(())
            }
            Node::Sphere { radius } | Node::Cylinder { radius } => {
                positive("radius in metres", *radius)
            }
            Node::CappedCylinder { radius, height }
            | Node::Capsule { radius, height }
            | Node::Cone { radius, height } => {
                positive("radius in metres", *radius)?;
                positive("height in metres", *height)
            }
            Node::Torus { ring, tube } => {
                positive("ring radius in metres", *ring)?;
                positive("tube radius in metres", *tube)
            }
            Node::Prism { corners, depth } => {
                positive("depth in metres", *depth)?;
                let [a, b, c] = corners.map(|c| c.as_dvec2());
                let area = 0.5 * (b - a).perp_dot(c - a).abs();
                let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
                if area > 1e-6 * longest * longest && DVec2::is_finite(a + b + c) {
                    return Ok(());
                }
                Err("its corners must not lie on one line".to_owned())
            }
            Node::Ellipsoid { radii } => all_positive("radii in metres", *radii),
            Node::Paraboloid { focal_length } => positive("focal length in metres", *focal_length),
            Node::Hyperboloid { waist, rise, .. } => {
                positive("waist in metres", *waist)?;
                positive("rise in metres", *rise)
            }
            Node::Quadric { coefficients } => validate_quadric(self, coefficients),
            Node::HeightField { size, .. } => all_positive("size in metres", *size),
            Node::User { field } => {
                all_positive("size in metres", field.size)?;
                if field.lipschitz >= 1e-3 && field.lipschitz <= 1e6 {
                    return Ok(());
                }
                let value = field.lipschitz;
                Err(format!("its lipschitz must be 0.001 to 1e6, not {value}"))
            }
            Node::Shell { thickness } => positive("thickness in metres", *thickness),
            Node::SmoothUnion { radius } => positive("radius in metres", *radius),
            Node::Offset { by } => number("length in metres", *by),
            Node::Scale { by } => positive("factor", *by),
            Node::Translate { by } => finite("length in metres", *by),
            Node::Rotate { by } => finite("angle", *by),
            Node::Repeat { period, count } => {
                finite("period in metres", *period)?;
                // Above it f32 can no longer tell one copy from the next.
                if count.iter().any(|count| *count >= 1 << 24) {
                    return Err("its counts must be below 16777216".to_owned());
                }
                if period.min_element() >= 0.0 && period.max_element() > 0.0 {
                    return Ok(());
                }
                Err("its period must be greater than 0 along an axis, and 0 along those that are not repeated".to_owned())
            }
            Node::Elongate { by } => {
                finite("length in metres", *by)?;
                if by.min_element() >= 0.0 {
                    return Ok(());
                }
                Err("its lengths must not be negative".to_owned())
            }
            Node::Twist { rate, lipschitz } | Node::Bend { rate, lipschitz } => {
                number("rate", *rate)?;
                if *lipschitz == 0.0 || (1.0..=1e6).contains(lipschitz) {
                    return Ok(());
                }
                Err(format!("its lipschitz must be 1 to 1e6, not {lipschitz}"))
            }
            Node::Morph { amount } => {
                if (0.0..=1.0).contains(amount) {
                    return Ok(());
                }
                Err(format!("its amount must be 0 to 1, not {amount}"))
            }
            _ => Ok(()),
        }
    }
}

fn validate_quadric(node: &Node, coefficients: &[f32; 10]) -> Result<(), String> {
    for (index, coefficient) in coefficients.iter().enumerate() {
        number(&format!("coefficient {}", index + 1), *coefficient)?;
    }
    let has_form = Quadric::of(node).is_some_and(|q| q.norm() > 0.0);
    if has_form {
        return Ok(());
    }
    Err(
        "one of its first six coefficients must not be 0: for a plane there is HalfSpace"
            .to_owned(),
    )
}

fn number(what: &str, value: f32) -> Result<(), String> {
    if value.is_finite() && value.abs() <= LARGEST {
        return Ok(());
    }
    Err(format!(
        "its {what} must be finite and at most 1e9 in size, not {value}"
    ))
}

fn finite(what: &str, value: Vec3) -> Result<(), String> {
    value
        .to_array()
        .into_iter()
        .try_for_each(|v| number(what, v))
}

fn positive(what: &str, value: f32) -> Result<(), String> {
    if value > 0.0 && value <= LARGEST {
        return Ok(());
    }
    Err(format!(
        "its {what} must be greater than 0 and at most 1e9, not {value}"
    ))
}

fn all_positive(what: &str, value: Vec3) -> Result<(), String> {
    value
        .to_array()
        .into_iter()
        .try_for_each(|v| positive(what, v))
}
