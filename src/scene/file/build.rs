//! From what a file says to surfaces, fields and the drivers of their numbers.

use super::SurfaceFile;
use super::attached::Attached;
use super::numbers::{Number, Vector};
use super::shapes::{Axis, ShapeFile};
use crate::scene::{Driver, Field, Node, SceneError, Shape, Surface};
use glam::{EulerRot, Quat, Vec2, Vec3};

/// Builds one surface, collecting what moves its numbers.
struct Builder<'a> {
    files: &'a Attached,
    drivers: Vec<Driver>,
}

/// The surface that the file says.
pub(super) fn surface(file: SurfaceFile, files: &Attached) -> Result<Surface, SceneError> {
    let mut builder = Builder {
        files,
        drivers: Vec::new(),
    };
    let position = builder.vector("", "position", file.position);
    let angles = builder.vector("", "rotation", file.rotation);
    let mut drivers = builder.drivers.iter();
    let turning = drivers.any(|driver| driver.parameter.starts_with("rotation."));
    let shape = builder.shape(file.shape)?;
    Ok(Surface {
        name: file.name.map(|name| name.0),
        shape,
        position,
        rotation: Quat::from_euler(EulerRot::XYZEx, angles.x, angles.y, angles.z),
        turns: file.turns || turning,
        angles: if turning { angles } else { Vec3::ZERO },
        drivers: builder.drivers,
    })
}

impl Builder<'_> {
    /// The shape of a surface: the basic ones stand for themselves.
    fn shape(&mut self, file: ShapeFile) -> Result<Shape, SceneError> {
        Ok(match file {
            ShapeFile::Plane => Shape::Plane,
            ShapeFile::Box { size } => Shape::Box {
                size: self.vector("", "size", size),
            },
            ShapeFile::Room { size } => Shape::Room {
                size: self.vector("", "size", size),
            },
            ShapeFile::Sphere { radius } => Shape::Sphere {
                radius: self.number("", "radius", radius),
            },
            ShapeFile::Cylinder {
                radius,
                height: None,
                axis: Axis(Vec3::Y),
            } => Shape::Cylinder {
                radius: self.number("", "radius", radius),
            },
            other => Shape::Field(self.field(other, "")?),
        })
    }

    /// The field at a place of the tree; `at` comes before the names of its numbers.
    fn field(&mut self, file: ShapeFile, at: &str) -> Result<Field, SceneError> {
        match file {
            ShapeFile::Union(of) => self.over(Node::Union, of, at),
            ShapeFile::Intersection(of) => self.over(Node::Intersection, of, at),
            ShapeFile::Difference { from, cut } => {
                let mut of = vec![*from];
                of.extend(cut);
                self.over(Node::Difference, of, at)
            }
            ShapeFile::Complement(of) => self.over(Node::Complement, vec![*of], at),
            ShapeFile::Morph { from, to, amount } => {
                let amount = self.number(at, "amount", amount);
                self.over(Node::Morph { amount }, vec![*from, *to], at)
            }
            ShapeFile::SmoothUnion { of, radius } => {
                let radius = self.number(at, "radius", radius);
                self.over(Node::SmoothUnion { radius }, of, at)
            }
            ShapeFile::Cylinder {
                radius,
                height,
                axis: Axis(axis),
            } if axis != Vec3::Y => {
                let by = turn_from_y(axis);
                let axis = Axis::default();
                let upright = ShapeFile::Cylinder {
                    radius,
                    height,
                    axis,
                };
                self.over(Node::Rotate { by }, vec![upright], at)
            }
            ShapeFile::HeightField { image, size } => {
                let image = self.files.heights(&image)?;
                let size = self.vector(at, "size", size);
                Ok(Field::from(Node::HeightField { image, size }))
            }
            ShapeFile::Field {
                file,
                lipschitz,
                size,
            } => {
                let field = self.files.field(&file, size.0, lipschitz.0)?;
                Ok(Field::from(Node::User { field }))
            }
            other => match self.operator(other, at) {
                Ok((node, of)) => self.over(node, vec![*of], at),
                Err(shape) => Ok(Field::from(self.leaf(*shape, at))),
            },
        }
    }

    /// An operator on one field, and that field; or what is none.
    fn operator(
        &mut self,
        file: ShapeFile,
        at: &str,
    ) -> Result<(Node, Box<ShapeFile>), Box<ShapeFile>> {
        Ok(match file {
            ShapeFile::Shell { of, thickness } => {
                let thickness = self.number(at, "thickness", thickness);
                (Node::Shell { thickness }, of)
            }
            ShapeFile::Offset { of, by } => {
                let by = self.number(at, "by", by);
                (Node::Offset { by }, of)
            }
            ShapeFile::Translate { of, by } => {
                let by = self.vector(at, "by", by);
                (Node::Translate { by }, of)
            }
            ShapeFile::Rotate { of, by } => {
                let by = self.vector(at, "by", by);
                (Node::Rotate { by }, of)
            }
            ShapeFile::Scale { of, by } => {
                let by = self.number(at, "by", by);
                (Node::Scale { by }, of)
            }
            ShapeFile::Mirror { of, axes } => (Node::Mirror { axes: axes.0 }, of),
            ShapeFile::Repeat { of, period, count } => {
                let period = self.vector(at, "period", period);
                let count = <[u32; 3]>::from(count);
                (Node::Repeat { period, count }, of)
            }
            ShapeFile::Elongate { of, by } => {
                let by = self.vector(at, "by", by);
                (Node::Elongate { by }, of)
            }
            ShapeFile::Twist {
                of,
                rate,
                lipschitz,
            } => {
                let rate = self.number(at, "rate", rate);
                let lipschitz = lipschitz.map_or(0.0, |stated| stated.0);
                (Node::Twist { rate, lipschitz }, of)
            }
            ShapeFile::Bend {
                of,
                rate,
                lipschitz,
            } => {
                let rate = self.number(at, "rate", rate);
                let lipschitz = lipschitz.map_or(0.0, |stated| stated.0);
                (Node::Bend { rate, lipschitz }, of)
            }
            shape => return Err(Box::new(shape)),
        })
    }

    /// A shape that needs neither files nor other shapes.
    fn leaf(&mut self, file: ShapeFile, at: &str) -> Node {
        match file {
            ShapeFile::HalfSpace { normal, offset } => Node::HalfSpace {
                normal: self.vector(at, "normal", normal),
                offset: self.number(at, "offset", offset),
            },
            ShapeFile::Box { size } => Node::Box {
                size: self.vector(at, "size", size),
            },
            ShapeFile::Room { size } => Node::Room {
                size: self.vector(at, "size", size),
            },
            ShapeFile::RoundedBox { size, rounding } => Node::RoundedBox {
                size: self.vector(at, "size", size),
                rounding: self.number(at, "rounding", rounding),
            },
            ShapeFile::Sphere { radius } => Node::Sphere {
                radius: self.number(at, "radius", radius),
            },
            ShapeFile::Cylinder { radius, height, .. } => {
                let radius = self.number(at, "radius", radius);
                match height {
                    None => Node::Cylinder { radius },
                    Some(height) => Node::CappedCylinder {
                        radius,
                        height: self.number(at, "height", height),
                    },
                }
            }
            ShapeFile::Capsule { radius, height } => Node::Capsule {
                radius: self.number(at, "radius", radius),
                height: self.number(at, "height", height),
            },
            ShapeFile::Torus { ring, tube } => Node::Torus {
                ring: self.number(at, "ring", ring),
                tube: self.number(at, "tube", tube),
            },
            ShapeFile::Cone { radius, height } => Node::Cone {
                radius: self.number(at, "radius", radius),
                height: self.number(at, "height", height),
            },
            ShapeFile::Prism { corners, depth } => {
                let mut read = [Vec2::ZERO; 3];
                for (index, corner) in corners.0.into_iter().enumerate() {
                    let [x, y] = corner.0;
                    let x = self.number(at, &format!("corners.{index}.x"), x);
                    let y = self.number(at, &format!("corners.{index}.y"), y);
                    read[index] = Vec2::new(x, y);
                }
                Node::Prism {
                    corners: read,
                    depth: self.number(at, "depth", depth),
                }
            }
            ShapeFile::Ellipsoid { radii } => Node::Ellipsoid {
                radii: self.vector(at, "radii", radii),
            },
            ShapeFile::Paraboloid { focal_length } => Node::Paraboloid {
                focal_length: self.number(at, "focal_length", focal_length),
            },
            ShapeFile::Hyperboloid {
                waist,
                rise,
                sheets,
            } => Node::Hyperboloid {
                waist: self.number(at, "waist", waist),
                rise: self.number(at, "rise", rise),
                two_sheets: sheets.0,
            },
            ShapeFile::Quadric(numbers) => {
                let mut coefficients = [0.0; 10];
                for (index, number) in numbers.into_iter().enumerate() {
                    coefficients[index] = self.number(at, &format!("coefficients.{index}"), number);
                }
                Node::Quadric { coefficients }
            }
            // `field` keeps everything else for itself.
            _ => Node::Plane,
        }
    }

    /// An operator over fields, each with its place before the names of its numbers.
    fn over(&mut self, node: Node, of: Vec<ShapeFile>, at: &str) -> Result<Field, SceneError> {
        let mut fields = Vec::with_capacity(of.len());
        for (index, file) in of.into_iter().enumerate() {
            fields.push(self.field(file, &format!("{at}{index}."))?);
        }
        Ok(Field::over(node, fields))
    }

    /// A number where it starts; what moves it is kept.
    fn number<U>(&mut self, at: &str, name: &str, number: Number<U>) -> f32 {
        if let Some(motion) = number.motion {
            let parameter = format!("{at}{name}");
            self.drivers.push(Driver { parameter, motion });
        }
        number.start
    }

    fn vector<U>(&mut self, at: &str, name: &str, vector: Vector<U>) -> Vec3 {
        let [x, y, z] = vector.0;
        Vec3::new(
            self.number(at, &format!("{name}.x"), x),
            self.number(at, &format!("{name}.y"), y),
            self.number(at, &format!("{name}.z"), z),
        )
    }
}

/// The angles about x, then y, that turn the y axis into a unit vector.
fn turn_from_y(axis: Vec3) -> Vec3 {
    let about_x = axis.x.hypot(axis.z).atan2(axis.y);
    let about_y = axis.x.atan2(axis.z);
    Vec3::new(about_x, about_y, 0.0)
}
