//! Errors in scene files, and their positions.

use super::{refusal, scene};

/// Protects the authors of scenes: an error states the line, the column and the mistake.
#[test]
fn mistakes_are_refused_at_their_place() {
    let cases = [
        // Names.
        ("shape: Spere(radius: 1)", "`Spere`"),
        ("shape: Union(of: [Plane, Spere(radius: 1)])", "`Spere`"),
        ("shape: Sphere(raduis: 1)", "`raduis`"),
        ("shape: Shell(of: Plane)", "`thickness`"),
        ("shape: Shell(thickness: 1)", "`of`"),
        (
            "shape: Cylinder(radius: 1, axis: W)",
            "an axis must be X, Y, Z",
        ),
        ("shape: Cylinder(radius: 1, axis: (0, 0, 0))", "length 0"),
        (
            "shape: Mirror(of: Plane, axes: \"w\")",
            "one or more of x, y and z, not \"w\"",
        ),
        ("shape: Mirror(of: Plane, axes: \"xx\")", "not \"xx\""),
        ("shape: Mirror(of: Plane, axes: \"\")", "not \"\""),
        // Numbers.
        (
            "shape: Sphere(radius: -1)",
            "a radius in metres must be finite and greater than 0, not -1",
        ),
        ("shape: Torus(ring: 3, tube: 0)", "greater than 0, not 0"),
        ("shape: Scale(of: Plane, by: 0)", "a factor must be"),
        (
            "shape: Rotate(of: Plane, by: (0, inf, 0))",
            "an angle in degrees must be finite",
        ),
        (
            "shape: Morph(from: Plane, to: Plane, amount: 1.5)",
            "0 to 1, not 1.5",
        ),
        (
            "shape: Hyperboloid(waist: 1, rise: 1, sheets: 3)",
            "1 or 2 sheets, not 3",
        ),
        (
            "shape: Prism(corners: [(0, 0), (1, 0)], depth: 1)",
            "3 corners (x, y), not 2",
        ),
        ("shape: Quadric((1, 2, 3))", "10"),
        (
            "shape: Repeat(of: Plane, period: (1, 0, 0), count: (-1, 0, 0))",
            "",
        ),
        (
            "shape: Twist(of: Plane, rate: 1, lipschitz: 0)",
            "a Lipschitz constant",
        ),
        // Motion.
        ("shape: Sphere(radius: Keys([]))", "at least one"),
        (
            "shape: Sphere(radius: Keys([(0, 1), (0, 2)]))",
            "must increase",
        ),
        (
            "shape: Sphere(radius: Keys([(0, 1), (1, -2)]))",
            "greater than 0, not -2",
        ),
        (
            "shape: Sphere(radius: Keys([(inf, 1)]))",
            "time must be finite",
        ),
        (
            "shape: Sphere(radius: Keys([(0, 1, 2)]))",
            "Keys([(seconds, number)",
        ),
        (
            "shape: Sphere(radius: Kyes([(0, 1)]))",
            "Keys([(seconds, number)",
        ),
        (
            "shape: Sphere(radius: Value(\"r\"))",
            "Value(\"name\", number)",
        ),
        ("shape: Sphere(radius: Value(\"\", 1))", "needs a name"),
        ("shape: Sphere(radius: \"1\")", "Expected a number"),
    ];
    for (surface, says) in cases {
        let sentence = refusal(surface);
        let mut parts = sentence.splitn(4, ':');
        assert_eq!(parts.next(), Some("text"), "{sentence}");
        assert_eq!(parts.next(), Some("2"), "{surface}: {sentence}");
        let column: usize = parts.next().unwrap().parse().unwrap();
        let shape_at = "    surfaces: [Surface(".len() + 1;
        assert!(
            (shape_at..=shape_at + surface.len()).contains(&column),
            "{surface}: {sentence}"
        );
        let reason = parts.next().unwrap();
        assert!(reason.contains(says), "{surface}: {sentence}");
    }
}

/// Protects the authors of scenes with valid numbers but an invalid shape. The error contains the surface, the node,
/// and the time if the shape becomes invalid later.
#[test]
fn what_cannot_be_is_refused_by_name() {
    let cases = [
        (
            "name: \"bed\", shape: RoundedBox(size: (1, 1, 1), rounding: 0.6)",
            "surface 1 (bed): RoundedBox: ",
        ),
        ("shape: Union(of: [])", "surface 1 (Union): Union: "),
        (
            "shape: Repeat(of: Plane, period: (1, 0, 0))",
            "surface 1 (Repeat): Repeat: ",
        ),
        (
            "shape: HalfSpace(normal: (0, 0, 0))",
            "surface 1 (HalfSpace): HalfSpace: ",
        ),
        (
            "shape: RoundedBox(size: (1, 1, 1), rounding: Keys([(0, 0.1), (2, 0.6)]))",
            "at 2 s, scene \"\": surface 1 (RoundedBox): RoundedBox: ",
        ),
        (
            "shape: Repeat(of: Sphere(radius: Keys([(0, 1), (3, 50)])), period: (2, 2, 2))",
            "at 3 s, scene \"\": surface 1 (Repeat): Repeat: ",
        ),
        (
            "shape: Plane, position: (0, Keys([(0, 0), (1, 1e10)]), 0)",
            "at 1 s, ",
        ),
    ];
    for (surface, says) in cases {
        let sentence = refusal(surface);
        assert!(sentence.contains(says), "{sentence}");
    }
}

/// Protects the stack. Extremely nested text is rejected with its position, and any realistic nesting depth is
/// accepted.
#[test]
fn deep_nesting_is_refused_in_a_sentence() {
    let nested = |depth: usize| {
        let (open, close) = ("Complement(of: ".repeat(depth), ")".repeat(depth));
        format!("shape: {open}Plane{close}")
    };
    assert_eq!(scene(&nested(64)).surfaces[0].shape.name(), "Complement");
    let operator = |depth: usize| {
        let (open, close) = (
            "Union(of: [Translate(of: ".repeat(depth),
            ", by: (0, 0, 0))])".repeat(depth),
        );
        format!("shape: {open}Plane{close}")
    };
    assert_eq!(scene(&operator(32)).surfaces[0].shape.name(), "Union");
    for surface in [
        nested(10_000),
        operator(10_000),
        format!("shape: Sphere(radius: {})", "[".repeat(10_000)),
    ] {
        let sentence = refusal(&surface);
        assert!(
            sentence.starts_with("text:2:") && sentence.len() < 200,
            "{sentence}"
        );
        assert!(sentence.contains("nested too deeply"), "{sentence}");
    }
}
