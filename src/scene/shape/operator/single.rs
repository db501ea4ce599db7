//! Operators on one child, which move, rotate, scale or mirror the child, or move its surface along the normals.

use super::{
    Bounds3, Exactness, Part, Properties, Shape, ShapeFile, half, part, slowest, surface_kind,
};
use crate::scene::notation::{Fields, Written};
use glam::{DMat3, DVec3, EulerRot, Vec3};
use serde::de::{Deserialize, Deserializer, Error};

part! {
    /// The child, moved.
    Translate over (of: Box<ShapeFile>) {
        /// Translation in metres along x, y and z.
        by: Vec3 as Metres,
    }
}

impl Part for Translate {
    surface_kind!(MOVED);

    fn properties(&self, children: &[Shape]) -> Properties {
        let of = children[0].properties();
        Properties {
            bounds: of.bounds.moved(self.by.as_dvec3()),
            symmetric: [0, 1, 2].map(|axis| of.symmetric[axis] && self.by[axis] == 0.0),
            ..of
        }
    }

    fn own_length(&self) -> f64 {
        self.by.as_dvec3().abs().max_element()
    }

    fn value(&self, children: &[Shape], p: DVec3) -> f64 {
        children[0].value(p - self.by.as_dvec3())
    }
}

part! {
    /// The child, rotated about the origin.
    Rotate over (of: Box<ShapeFile>) {
        /// Right-handed rotation angles in radians about x, then y, then z of the outer axes.
        by: Vec3 as Angle,
    }
}

impl Part for Rotate {
    surface_kind!(MOVED);

    fn properties(&self, children: &[Shape]) -> Properties {
        let of = children[0].properties();
        Properties {
            bounds: of.bounds.turned(self.matrix()),
            symmetric: [false; 3],
            ..of
        }
    }

    /// If a box grows by a length along its axes, its corners move by √3 times this length.
    fn slowness(&self, children: &[Shape]) -> f64 {
        match children[0].properties().in_air {
            Exactness::Exact => slowest(children),
            _ => 3f64.sqrt() * slowest(children),
        }
    }

    fn value(&self, children: &[Shape], p: DVec3) -> f64 {
        children[0].value(self.matrix().transpose() * p)
    }

    /// The matrix from the outer axes to the inner axes, column by column.
    fn shader_numbers(&self, _: &[Shape]) -> Vec<f64> {
        self.matrix().transpose().to_cols_array().to_vec()
    }
}

impl Rotate {
    /// The matrix from the inner axes to the outer axes.
    pub(crate) fn matrix(&self) -> DMat3 {
        let by = self.by.as_dvec3();
        DMat3::from_euler(EulerRot::XYZEx, by.x, by.y, by.z)
    }
}

part! {
    /// The child, scaled about the origin.
    Scale over (of: Box<ShapeFile>) {
        /// Scale factor, greater than 0.
        by: f32 as Factor,
    }
}

impl Part for Scale {
    surface_kind!(MOVED);

    fn properties(&self, children: &[Shape]) -> Properties {
        let of = children[0].properties();
        Properties {
            bounds: of.bounds.scaled(self.by.into()),
            ..of
        }
    }

    fn value(&self, children: &[Shape], p: DVec3) -> f64 {
        let by = f64::from(self.by);
        children[0].value(p / by) * by
    }
}

part! {
    /// The part of the child on the positive side of some axes, mirrored to the other side.
    Mirror over (of: Box<ShapeFile>) {} and {
        /// Whether the child is mirrored across x = 0, y = 0 and z = 0.
        #[serde(deserialize_with = "mirror_axes")]
        axes: [bool; 3],
    }
}

/// Reads the axes of a mirror from their letters.
fn mirror_axes<'de, D: Deserializer<'de>>(from: D) -> Result<[bool; 3], D::Error> {
    let letters = String::deserialize(from)?;
    let refused = || {
        let must = "the axes of a mirror must be one or more of x, y and z";
        D::Error::custom(format!("{must}, not {letters:?}"))
    };
    let mut axes = [false; 3];
    for letter in letters.chars() {
        let axis = "xyz".find(letter).filter(|axis| !axes[*axis]);
        axes[axis.ok_or_else(refused)?] = true;
    }
    match letters.is_empty() {
        true => Err(refused()),
        false => Ok(axes),
    }
}

impl Part for Mirror {
    surface_kind!(FLAT);

    fn copies(&self) -> bool {
        true
    }

    fn keeps_apart(&self, children: &[Shape]) -> bool {
        let of = children[0].properties();
        let apart = |axis: usize| of.symmetric[axis] || of.bounds.min[axis] > 0.0;
        (0..3).all(|axis| !self.axes[axis] || apart(axis))
    }

    fn words(&self) -> Fields {
        let letters = "xyz".chars().zip(self.axes);
        let letters = letters.filter_map(|(letter, is)| is.then_some(letter));
        vec![("axes", Written::Text(letters.collect()))]
    }

    fn properties(&self, children: &[Shape]) -> Properties {
        let of = children[0].properties();
        let mut result = of;
        result.convex = of.convex && self.axes == [false; 3];
        for axis in (0..3).filter(|&axis| self.axes[axis]) {
            result.symmetric[axis] = true;
            let far = of.bounds.max[axis];
            (result.bounds.min[axis], result.bounds.max[axis]) = (-far, far);
            if of.symmetric[axis] {
                continue;
            }
            // A solid that crosses the mirror plane is cut there, but its value remains the distance to the uncut
            // solid.
            if of.bounds.min[axis] < 0.0 {
                result.in_air = result.in_air.or_bound();
            }
            // A solid that touches the mirror plane merges with its mirror image, so the face in the plane vanishes.
            if of.bounds.min[axis] <= 0.0 {
                result.in_solid = result.in_solid.or_bound();
            }
        }
        result
    }

    fn value(&self, children: &[Shape], p: DVec3) -> f64 {
        let fold = |axis: usize| match self.axes[axis] {
            true => p[axis].abs(),
            false => p[axis],
        };
        children[0].value(DVec3::new(fold(0), fold(1), fold(2)))
    }
}

part! {
    /// The child with air and solid exchanged.
    Complement over (of: Box<ShapeFile>)
}

impl Part for Complement {
    surface_kind!(TURNED_INSIDE_OUT);

    fn properties(&self, children: &[Shape]) -> Properties {
        let of = children[0].properties();
        Properties {
            in_air: of.in_solid,
            in_solid: of.in_air,
            bounds: Bounds3::EVERYWHERE,
            convex: false,
            ..of
        }
    }

    /// The bounds of a complement are infinite, so the solid cannot extend beyond them.
    fn slowness(&self, _: &[Shape]) -> f64 {
        1.0
    }

    /// The air of a complement is the solid of the child.
    fn keeps_air(&self, _: usize) -> bool {
        false
    }

    fn value(&self, children: &[Shape], p: DVec3) -> f64 {
        -children[0].value(p)
    }
}

part! {
    /// A wall along the surface of the child.
    Shell over (of: Box<ShapeFile>) {
        /// Full thickness in metres.
        thickness: f32 as Length,
    }
}

impl Part for Shell {
    fn properties(&self, children: &[Shape]) -> Properties {
        let of = children[0].properties();
        let reach = slowest(children) * half(self.thickness);
        Properties {
            in_air: Exactness::worst([of.in_air, of.in_solid].into_iter(), of.lipschitz),
            in_solid: Exactness::bound(of.lipschitz),
            bounds: of.bounds.grown(DVec3::splat(reach)),
            convex: false,
            ..of
        }
    }

    fn own_length(&self) -> f64 {
        self.thickness.into()
    }

    /// The air of a shell is on both sides of the child's surface.
    fn keeps_air(&self, _: usize) -> bool {
        false
    }

    fn value(&self, children: &[Shape], p: DVec3) -> f64 {
        children[0].value(p).abs() - half(self.thickness)
    }

    fn shader_numbers(&self, _: &[Shape]) -> Vec<f64> {
        vec![half(self.thickness)]
    }
}

part! {
    /// The child, grown or shrunk by a length.
    Offset over (of: Box<ShapeFile>) {
        /// Distance in metres by which the surface moves outwards.
        by: f32 as Metres,
    }
}

impl Part for Offset {
    /// The surface moves to one side. On that side, exact distances remain exact. If the distances are exact, a convex
    /// solid remains convex. The level sets of a bound can be non-convex.
    fn properties(&self, children: &[Shape]) -> Properties {
        let of = children[0].properties();
        let by = f64::from(self.by);
        let (in_air, in_solid) = match by >= 0.0 {
            true => (of.in_air, of.in_solid.or_bound()),
            false => (of.in_air.or_bound(), of.in_solid),
        };
        let stays_convex = match by {
            by if by > 0.0 => of.in_air == Exactness::Exact,
            by if by < 0.0 => of.in_solid == Exactness::Exact,
            _ => true,
        };
        let reach = slowest(children) * by.max(0.0);
        Properties {
            in_air,
            in_solid,
            bounds: of.bounds.grown(DVec3::splat(reach)),
            convex: of.convex && stays_convex,
            ..of
        }
    }

    fn own_length(&self) -> f64 {
        self.by.abs().into()
    }

    /// A shrunk solid leaves air where the child is solid.
    fn keeps_air(&self, _: usize) -> bool {
        false
    }

    fn value(&self, children: &[Shape], p: DVec3) -> f64 {
        children[0].value(p) - f64::from(self.by)
    }
}

part! {
    /// The child, cut at the coordinate planes. The parts are moved apart, and the gaps are filled by extrusion.
    Elongate over (of: Box<ShapeFile>) {
        /// Distance by which each half moves along x, y and z, in metres.
        by: Vec3 as Metres,
    }
}

impl Part for Elongate {
    fn check(&self) -> Result<(), String> {
        if self.by.min_element() >= 0.0 {
            return Ok(());
        }
        Err("its lengths must not be negative".to_owned())
    }

    fn properties(&self, children: &[Shape]) -> Properties {
        let of = children[0].properties();
        Properties {
            in_air: Exactness::bound(of.lipschitz),
            in_solid: Exactness::bound(of.lipschitz),
            bounds: of.bounds.grown(self.by.as_dvec3()),
            // A slanted side that crosses the cut gets a step. A symmetric convex solid becomes its Minkowski sum with
            // a box of half size `by`.
            convex: of.convex && (0..3).all(|a| self.by[a] == 0.0 || of.symmetric[a]),
            ..of
        }
    }

    fn own_length(&self) -> f64 {
        self.by.as_dvec3().abs().max_element()
    }

    fn value(&self, children: &[Shape], p: DVec3) -> f64 {
        let by = self.by.as_dvec3();
        children[0].value(p - p.clamp(-by, by))
    }
}
