use super::*;
use crate::scene::Material;
use crate::scene::mesh::tests::box_faces;
use crate::scene::mesh::{MeshOptions, TriangleMesh};
use crate::scene::shape::{Cuboid, Mesh, RoundedBox, Sphere};
use crate::{Listener, Source, Surface};
use glam::{Quat, Vec3};
use std::sync::Arc;

/// Tolerance of levels in decibels.
const WITHIN_DB: f64 = 0.1;

/// Brickwork of 1000 kg/m³ without coincidence.
const BRICKWORK: Transmission = Transmission::Mass {
    density: 1000.0,
    coincidence: None,
};

/// A box `thickness` metres thick whose centre is at `x`, as wide and high as `side` metres.
fn slab(x: f32, thickness: f32, side: f32, material: &str) -> Surface {
    let size = Vec3::new(thickness, side, side);
    Surface::new(Cuboid { size })
        .at(Vec3::new(x, 0.0, 0.0))
        .with_material(material)
}

/// The reductions in decibels on the line from `a` to `b`; `None` if nothing passes.
fn reductions(
    surfaces: Vec<Surface>,
    materials: &[(&str, Transmission)],
    a: Vec3,
    b: Vec3,
) -> Option<Bands> {
    let mut scene = Scene::new("walls", surfaces, Source::at(a), Listener::at(b, 0.1));
    for (name, transmission) in materials {
        let material = Material::absorbing(0.1).transmitting(*transmission);
        scene.materials.insert((*name).to_owned(), material);
    }
    let exact = ExactScene::new(&scene).unwrap();
    let passed = through(&scene, &exact, (a.as_dvec3(), b.as_dvec3()))?;
    Some(passed.share.map(|share| -decibels(share)))
}

/// The same at a line along x.
fn upright(surfaces: Vec<Surface>, materials: &[(&str, Transmission)]) -> Bands {
    let (a, b) = (Vec3::new(-5.0, 0.3, 0.2), Vec3::new(5.0, 0.3, 0.2));
    reductions(surfaces, materials, a, b).expect("sound passes")
}

/// The mass law, written a second time.
fn mass_law(mass: f64) -> Bands {
    BANDS_HZ.map(|hertz| 10.0 * (1.0 + (PI * hertz * mass / (1.8 * 415.0)).powi(2)).log10())
}

fn assert_near(found: &Bands, expected: &Bands) {
    for (found, expected) in found.iter().zip(expected) {
        assert!(
            (found - expected).abs() < WITHIN_DB,
            "{found} for {expected}"
        );
    }
}

/// Protects the mass law: 35.7 dB at 63 Hz and 77.8 dB at 8 kHz for 230 kg/m².
#[test]
fn a_mass_reduces_by_the_mass_law() {
    let plate = Plate {
        mass: 230.0,
        critical_hz: None,
    };
    assert!((plate.reduction_db(63.0) - 35.70).abs() < 0.01);
    assert!((plate.reduction_db(8e3) - 77.77).abs() < 0.01);
}

/// Protects coincidence: no effect up to half the critical frequency, a dip at it, and 9 dB per octave above it with a
/// loss factor that does not change (of 6 mm of glass, 15 kg/m², whose loss at the edges is small).
#[test]
fn glass_has_a_dip_at_its_critical_frequency() {
    let pane = Plate {
        mass: 15.0,
        critical_hz: Some(2000.0),
    };
    let limp = Plate {
        critical_hz: None,
        ..pane
    };
    assert_eq!(pane.reduction_db(1000.0), limp.reduction_db(1000.0));
    let dip = pane.reduction_db(2000.0);
    // η = 0.01 + 15 / (485 √2000) = 0.010692; 20 lg(π · 2000 · 15 / 415) + 10 lg(2η / π) = 25.454 dB.
    assert!((dip - 25.454).abs() < 0.001, "{dip}");
    let between = pane.reduction_db(2000.0 / 2f64.sqrt());
    assert!((between - 0.5 * (dip + pane.reduction_db(1000.0))).abs() < 1e-9);
    let slope = pane.reduction_db(8000.0) - pane.reduction_db(4000.0);
    assert!((slope - 9.0).abs() < 0.15, "{slope}");
    // At a critical frequency so low that the waves in the plate do not weaken it, the reduction is that of normal
    // incidence.
    let stiff = Plate {
        mass: 15.0,
        critical_hz: Some(1.0),
    };
    let normal = 20.0 * stiff.impedance_ratio(8e3).log10();
    assert!((stiff.reduction_db(8e3) - normal).abs() < 1e-9);
}

/// Protects slabs at any angle: the thickness is that of the slab, for flat boxes and for boxes with round edges, whose
/// intersections are marched.
#[test]
fn a_slab_reduces_the_same_at_any_angle() {
    let materials = [("brickwork", BRICKWORK)];
    let expected = mass_law(200.0);
    for degrees in [0.0_f32, 25.0, 50.0, 65.0, 80.0] {
        let turn = Quat::from_rotation_y(degrees.to_radians());
        let mut flat = slab(0.0, 0.2, 90.0, "brickwork");
        flat.rotation = turn;
        assert_near(&upright(vec![flat], &materials), &expected);
        let mut round = Surface::new(RoundedBox {
            size: Vec3::new(0.2, 90.0, 90.0),
            rounding: 0.05,
        })
        .with_material("brickwork");
        round.rotation = turn;
        assert_near(&upright(vec![round], &materials), &expected);
    }
}

/// Protects solids in contact: a wall split into two boxes, lengthwise or crosswise, or into boxes that overlap, is the
/// same wall.
#[test]
fn a_split_wall_is_the_same_wall() {
    let materials = [("brickwork", BRICKWORK)];
    let expected = mass_law(200.0);
    let layers = |at: f32, thick: [f32; 2]| {
        let [first, second] = thick;
        vec![
            slab(at + 0.5 * first, first, 9.0, "brickwork"),
            slab(at + 0.2 - 0.5 * second, second, 9.0, "brickwork"),
        ]
    };
    for surfaces in [
        layers(-0.1, [0.1, 0.1]),
        layers(0.35, [0.07, 0.13]),
        layers(-0.1, [0.15, 0.12]),
        layers(-0.1, [0.2, 0.05]),
    ] {
        assert_near(&upright(surfaces, &materials), &expected);
    }
    // The line crosses the seam at y = 0 within the wall.
    let half = |y: f32| {
        let mut half = slab(0.0, 0.2, 9.0, "brickwork");
        half.position.y = y;
        half
    };
    let seam = vec![half(-4.5), half(4.5)];
    let (a, b) = (Vec3::new(-2.0, -3.0, 0.3), Vec3::new(2.0, 3.0, 0.3));
    assert_near(&reductions(seam, &materials, a, b).unwrap(), &expected);
}

/// Protects the sums: leaves with air between them add their reductions; materials in contact add their masses; stated
/// reductions are scaled by the thickness and added.
#[test]
fn walls_in_rows_add_up() {
    let glass = Transmission::of_density(2500.0);
    let index = [30.0, 33.0, 36.0, 39.0, 42.0, 45.0, 48.0, 51.0];
    let panel = Transmission::reduced_by(index, 0.1);
    let materials = [("brickwork", BRICKWORK), ("glass", glass), ("panel", panel)];
    let sum = |a: Bands, b: Bands| std::array::from_fn(|band| a[band] + b[band]);
    let row = |second: Surface| {
        let surfaces = vec![slab(0.0, 0.1, 9.0, "brickwork"), second];
        upright(surfaces, &materials)
    };
    let apart = row(slab(0.5, 0.01, 9.0, "glass"));
    assert_near(&apart, &sum(mass_law(100.0), mass_law(25.0)));
    let touching = row(slab(0.055, 0.01, 9.0, "glass"));
    assert_near(&touching, &mass_law(125.0));
    // 0.05 m of the panel: 6.02 dB less.
    let stated = index.map(|index| index - 6.0206);
    let touching = row(slab(0.075, 0.05, 9.0, "panel"));
    assert_near(&touching, &sum(mass_law(100.0), stated));
}

/// A box of triangles, 0.1 m thick in x and 9 m wide and high, with these groups on its side towards −x and elsewhere.
fn mesh_slab(left: &str, others: &str) -> Surface {
    let mut faces = box_faces(DVec3::new(0.1, 9.0, 9.0));
    faces.groups = vec![left.to_owned(), others.to_owned()];
    faces.group_of.iter_mut().for_each(|of| *of = (*of).min(1));
    let mesh = TriangleMesh::new("slab", faces, MeshOptions::default()).expect("a mesh");
    Surface::new(Mesh {
        mesh: Arc::new(mesh),
    })
}

/// Protects the materials of a mesh's faces: they transmit, and not only the material of the whole mesh. Two reductions of
/// one wall do not add up.
#[test]
fn a_mesh_transmits_by_the_materials_of_its_faces() {
    let heavy = Transmission::of_density(2500.0);
    let materials = [("brickwork", BRICKWORK), ("heavy", heavy)];
    for (left, others, mass) in [
        ("brickwork", "brickwork", 100.0),
        ("brickwork", "heavy", 175.0),
    ] {
        assert_near(
            &upright(vec![mesh_slab(left, others)], &materials),
            &mass_law(mass),
        );
    }
    let panels = [
        ("brickwork", BRICKWORK),
        ("panel", Transmission::reduced_by(40.0, 0.1)),
        ("other", Transmission::reduced_by(41.0, 0.1)),
    ];
    let of = |left: &str, others: &str| upright(vec![mesh_slab(left, others)], &panels);
    assert_near(&of("panel", "panel"), &[40.0; BAND_COUNT]);
    assert_near(&of("panel", "other"), &[40.5; BAND_COUNT]);
    let mean = mass_law(100.0).map(|mass| 0.5 * (mass + 40.0));
    assert_near(&of("panel", "brickwork"), &mean);
    assert_near(&of("brickwork", "panel"), &mean);
    let (a, b) = (Vec3::new(-5.0, 0.3, 0.2), Vec3::new(5.0, 0.3, 0.2));
    for (left, others) in [("brickwork", "carpet"), ("carpet", "brickwork")] {
        let mesh = mesh_slab(left, others).with_material("brickwork");
        assert_eq!(
            reductions(vec![mesh], &materials, a, b),
            None,
            "{left}, {others}"
        );
    }
}

/// Protects silence: a solid without transmission, or one that leaves less than −100 dB in every band, has no path.
#[test]
fn a_solid_that_is_silent_has_no_path() {
    let (a, b) = (Vec3::new(-5.0, 0.3, 0.2), Vec3::new(5.0, 0.3, 0.2));
    let passes = |surfaces, reduction| {
        let panel = Transmission::reduced_by(reduction, 0.1);
        reductions(surfaces, &[("panel", panel)], a, b).is_some()
    };
    let wall = || slab(0.0, 0.1, 9.0, "panel");
    assert!(passes(vec![wall()], 99.9));
    assert!(!passes(vec![wall()], 100.1));
    let opaque = slab(2.0, 0.1, 9.0, "curtain");
    assert!(!passes(vec![wall(), opaque], 10.0));
    let bare = Surface::new(Sphere { radius: 1.0 });
    assert!(!passes(vec![bare], 10.0));
    assert!(
        !passes(vec![slab(0.0, 0.1, 0.1, "panel")], 10.0),
        "not in the way"
    );
}
