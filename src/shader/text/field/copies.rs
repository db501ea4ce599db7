//! Values and gradients of repeated shapes.

use super::function_kind::Kind;
use super::{Writer, literal};
use crate::scene::shape::Repeat;
use crate::scene::{Copies, Node, Shape};
use std::fmt::Write;

impl Writer<'_> {
    pub(super) fn repeated(
        &mut self,
        field: &Shape,
        kind: Kind,
        p: &str,
        numbers: &[String],
    ) -> String {
        // A rejected repetition never gets here.
        let copies = field.copies().unwrap_or([Copies::Own; 3]);
        let Node::Repeat(Repeat { count, .. }) = &field.node else {
            return String::new();
        };
        let axes: Vec<Axis> = (0..3)
            .map(|axis| Axis {
                coordinate: format!("{p}.{}", ["x", "y", "z"][axis]),
                period: numbers[axis].clone(),
                count: count[axis],
                copies: copies[axis],
            })
            .collect();
        if axes.iter().all(|axis| axis.copies.count() == 1) {
            let inner: Vec<String> = axes.iter().map(|axis| axis.copy("0.0")).collect();
            let q = self.point(&format!("vec3({})", inner.join(", ")));
            return self.node(&field.children[0], kind, &q);
        }
        let child = self.child_function(&field.children[0], kind);
        let none = if kind == Kind::Value {
            "1e30"
        } else {
            "vec4(0.0, 0.0, 0.0, 1e30)"
        };
        let result = self.result(kind, none);
        self.copies_loop(&axes, &child, &result);
        let (Some(_), [.., x, y, z, near, inverse]) = (field.cap(), numbers) else {
            return result;
        };
        let prefix = kind.prefix(&field.node);
        self.result(
            kind,
            &format!(
                "opUnion({result}, {prefix}RepeatCap({p}, vec3({x}, {y}, {z}), {near}, {inverse}))"
            ),
        )
    }

    /// A loop with one call of the child for each copy.
    fn copies_loop(&mut self, axes: &[Axis], child: &str, result: &str) {
        let mut coordinates = Vec::new();
        for axis in axes {
            if axis.copies.count() == 1 {
                coordinates.push(axis.copy("0.0"));
                continue;
            }
            let step = self.name("step");
            let (from, to) = axis.steps();
            self.line(&format!(
                "for (int {step} = {from}; {step} <= {to}; ++{step}) {{"
            ));
            coordinates.push(axis.copy(&axis.moved_by(&step)));
        }
        let point = coordinates.join(", ");
        let argument = self.place.argument;
        self.line(&format!(
            "{result} = opUnion({result}, {child}(vec3({point}){argument}));"
        ));
        for axis in axes {
            if axis.copies.count() > 1 {
                self.line("}");
            }
        }
    }

    /// A field as a separate function, for callers that need it more than once.
    fn child_function(&mut self, field: &Shape, kind: Kind) -> String {
        // Two directly nested repetitions have used no name in between.
        let name = self.name(&format!("{}{}_", self.stem, self.place.tag));
        let outer = std::mem::take(&mut self.body);
        let result = self.node(field, kind, "p");
        let body = std::mem::replace(&mut self.body, outer);
        let _ = write!(
            self.functions,
            "{} {name}(vec3 p{}) {{\n{body}    return {result};\n}}\n\n",
            kind.of_type(),
            self.place.parameter
        );
        name
    }
}

/// One axis of a repetition.
pub(super) struct Axis {
    pub coordinate: String,
    pub period: String,
    pub count: u32,
    pub copies: Copies,
}

impl Axis {
    /// The coordinate, and the period and range of the copies, as arguments of the GLSL functions.
    pub fn range(&self) -> (String, String) {
        let even = self.count > 0 && self.count.is_multiple_of(2);
        let (coordinate, period) = (&self.coordinate, &self.period);
        // An even number of copies is centred on the origin, with none at the origin itself.
        let q = if even {
            format!("{coordinate} - 0.5 * {period}")
        } else {
            coordinate.clone()
        };
        let (first, last) = match self.count {
            0 => (-1e30, 1e30),
            count => {
                let first = -f64::from(count / 2);
                (first, first + f64::from(count - 1))
            }
        };
        let range = format!("{period}, {}, {}", literal(first), literal(last));
        (q, range)
    }

    pub fn copy(&self, step: &str) -> String {
        if self.copies == Copies::None {
            return self.coordinate.clone();
        }
        let (q, range) = self.range();
        format!("repeatCopy({q}, {range}, {step})")
    }

    fn steps(&self) -> (i64, i64) {
        match self.copies {
            Copies::Around(reach) => (-i64::from(reach), reach.into()),
            Copies::OwnAndNext => (0, 1),
            Copies::None | Copies::Own => (0, 0),
        }
    }

    fn moved_by(&self, step: &str) -> String {
        match self.copies {
            Copies::OwnAndNext => {
                let (q, range) = self.range();
                format!("float({step}) * repeatSide({q}, {range})")
            }
            _ => format!("float({step})"),
        }
    }
}
