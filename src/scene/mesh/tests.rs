//! Tests of meshes.

use super::*;
use crate::test_common::Random;

/// A box of this size about the origin, with normals that point out of it.
pub(crate) fn box_faces(size: DVec3) -> MeshFaces {
    let corner = |n: usize| {
        let side = |bit: usize| if n >> bit & 1 == 1 { 0.5 } else { -0.5 };
        DVec3::new(side(0), side(1), side(2)) * size
    };
    let quads = [
        [0, 4, 6, 2],
        [1, 3, 7, 5],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 2, 3, 1],
        [4, 5, 7, 6],
    ];
    MeshFaces {
        vertices: (0..8).map(corner).collect(),
        triangles: quads
            .iter()
            .flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]])
            .collect(),
        group_of: (0..6).flat_map(|wall| [wall; 2]).collect(),
        groups: ["left", "right", "floor", "ceiling", "front", "back"]
            .map(str::to_owned)
            .to_vec(),
        ..MeshFaces::default()
    }
}

fn mesh(faces: MeshFaces, inside: Option<Inside>) -> Result<TriangleMesh, MeshError> {
    let options = MeshOptions {
        inside,
        ..MeshOptions::default()
    };
    TriangleMesh::new("test", faces, options)
}

/// Protects the search for walls between rooms, which waves of the late part pass: objects have a far side, one convex
/// room has none, and two rooms in one mesh have one.
#[test]
fn solids_between_rooms_have_a_far_side() {
    let size = DVec3::new(4.0, 3.0, 2.0);
    let of = |faces: MeshFaces, inside| mesh(faces, Some(inside)).expect("a mesh").has_far_side();
    assert!(of(box_faces(size), Inside::Solid));
    assert!(!of(box_faces(size), Inside::Air));
    let (mut both, next) = (box_faces(size), box_faces(size));
    let beside = next.vertices.iter().map(|corner| *corner + DVec3::X * 4.2);
    both.vertices.extend(beside);
    let corners = next.triangles.iter().map(|corners| corners.map(|n| n + 8));
    both.triangles.extend(corners);
    both.group_of.extend(next.group_of);
    assert!(of(both, Inside::Air));
}

/// Protects volume, area and the side of the air: a box with normals out of it is a solid object, and a hollow room if
/// this is stated.
#[test]
fn a_box_is_solid_or_hollow() {
    let size = DVec3::new(4.0, 3.0, 2.0);
    for (inside, is_hollow, sign) in [
        (None, false, -1.0),
        (Some(Inside::Solid), false, -1.0),
        (Some(Inside::Air), true, 1.0),
    ] {
        let mesh = mesh(box_faces(size), inside).expect("a closed box");
        let report = mesh.report();
        assert_eq!((report.is_closed, report.is_hollow), (true, is_hollow));
        assert_eq!(report.is_reversed, is_hollow);
        assert!((report.volume_m3 - 24.0).abs() < 1e-12 && (report.area_m2 - 52.0).abs() < 1e-12);
        assert_eq!(mesh.distance(DVec3::ZERO), sign * 1.0);
        assert_eq!(mesh.distance(DVec3::new(5.0, 5.5, 1.0)), -sign * 5.0);
        assert_eq!(
            (
                mesh.facets_near(DVec3::ZERO, f64::INFINITY).len(),
                report.parts
            ),
            (6, 1)
        );
        assert!(report.warnings().is_empty(), "{:?}", report.warnings());
    }
}

/// Protects scenes from defects: each is counted with its place, or is the reason for a refusal.
#[test]
fn defects_are_told() {
    let size = DVec3::new(4.0, 3.0, 2.0);
    let mut open = box_faces(size);
    open.triangles.pop();
    open.group_of.pop();
    let open = mesh(open, None).expect("an open box");
    assert_eq!(
        (open.report().open_edges.count, open.report().is_closed),
        (3, false)
    );
    let mut turned = box_faces(size);
    turned.triangles[3].swap(0, 1);
    let turned = mesh(turned, None).expect("a box with a reversed face");
    assert_eq!(
        (turned.report().turned.count, turned.report().is_closed),
        (1, true)
    );
    assert!((turned.report().volume_m3 - 24.0).abs() < 1e-12);
    let mut twice = box_faces(size);
    twice.triangles.push([4, 6, 0]);
    twice.triangles.push([1, 1, 2]);
    twice.group_of.extend([0, 0]);
    let twice = mesh(twice, None).expect("a box with a repeated face");
    let report = twice.report();
    assert_eq!(
        (
            report.repeated.count,
            report.degenerate.count,
            report.triangles
        ),
        (1, 1, 12)
    );
    let mut bad = box_faces(size);
    bad.vertices[3].y = f64::NAN;
    assert_eq!(mesh(bad, None), Err(MeshError::NotFinite { vertex: 4 }));
    let mut bad = box_faces(size);
    bad.triangles[5][1] = 8;
    let refused = MeshError::NoSuchVertex {
        triangle: 6,
        vertex: 9,
        vertices: 8,
    };
    assert_eq!(mesh(bad, None), Err(refused));
    assert_eq!(mesh(MeshFaces::default(), None), Err(MeshError::Empty));
    let mut two = box_faces(size);
    let other = box_faces(size);
    two.vertices.extend(
        other
            .vertices
            .iter()
            .map(|v| *v + DVec3::new(3.9, 0.1, 0.2)),
    );
    two.triangles
        .extend(other.triangles.iter().map(|t| t.map(|corner| corner + 8)));
    two.group_of.extend(other.group_of);
    let two = mesh(two, None).expect("two boxes");
    assert!(two.report().intersections.count > 0 && two.report().parts == 2);
    let band: Vec<DVec3> = (0..6)
        .map(|n| DVec3::new(f64::from(n % 3), f64::from(n / 3), f64::from(n * n % 5)))
        .collect();
    let band = MeshFaces {
        vertices: band,
        // A Möbius strip of five triangles.
        triangles: vec![[0, 1, 2], [1, 3, 2], [2, 3, 4], [3, 0, 4], [4, 0, 1]],
        group_of: vec![0; 5],
        groups: vec!["band".to_owned()],
        ..MeshFaces::default()
    };
    assert!(matches!(mesh(band, None), Err(MeshError::OneSided { .. })));
}

/// Adds the faces of another mesh, moved by a vector, as faces of group 0.
fn add(faces: &mut MeshFaces, other: &MeshFaces, by: DVec3) {
    let first = faces.vertices.len() as u32;
    faces
        .vertices
        .extend(other.vertices.iter().map(|v| *v + by));
    let placed = other
        .triangles
        .iter()
        .map(|t| t.map(|corner| first + corner));
    faces.triangles.extend(placed);
    faces.group_of.extend(vec![0; other.triangles.len()]);
}

/// A rectangle of 1.6 m × 0.8 m about the origin, drawn on both sides. The lower side has these triangles.
fn sheet(below: [[u32; 3]; 2]) -> MeshFaces {
    MeshFaces {
        vertices: [(-0.8, -0.4), (0.8, -0.4), (0.8, 0.4), (-0.8, 0.4)]
            .map(|(x, z)| DVec3::new(x, 0.0, z))
            .to_vec(),
        triangles: [[0, 2, 1], [0, 3, 2]].into_iter().chain(below).collect(),
        group_of: vec![0; 4],
        groups: vec!["sheet".to_owned()],
        ..MeshFaces::default()
    }
}

/// A room of 4 m × 3 m × 5 m about the origin.
fn room() -> MeshFaces {
    let mut faces = box_faces(DVec3::new(4.0, 3.0, 5.0));
    faces.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    faces
}

/// Protects both sides of a sheet without thickness, however it is divided, in the open and in a room, and with a box on
/// it: all its faces are known, lines leave it from either side, and air lies on both sides.
#[test]
fn faces_of_sheets_without_thickness_are_known() {
    let lamp = box_faces(DVec3::new(0.2, 0.3, 0.2));
    for below in [[[0, 1, 3], [1, 2, 3]], [[0, 1, 2], [0, 2, 3]]] {
        for (name, mut faces, has_lamp) in [
            ("open", sheet(below), false),
            ("in a room", room(), false),
            ("below a box", room(), true),
        ] {
            let before = faces.triangles.len() as u32;
            if name != "open" {
                add(&mut faces, &sheet(below), DVec3::ZERO);
            }
            if has_lamp {
                add(&mut faces, &lamp, DVec3::new(0.1, 0.15, 0.05));
            }
            let mesh = mesh(faces, None).expect("a mesh");
            let sheets = (0..mesh.triangle_count() as u32).filter(|i| mesh.triangle(*i).is_sheet);
            let first = if name == "open" { 0 } else { before };
            assert_eq!(
                sheets.collect::<Vec<_>>(),
                (first..first + 4).collect::<Vec<_>>(),
                "{name}"
            );
            assert_eq!(mesh.report().sheets.count, 4);
            for side in [-1.0, 1.0] {
                let place = DVec3::new(-0.5, 0.0, 0.1);
                let met = mesh.first_hit(place, DVec3::Y * side, 1e-12, 1.0);
                assert_eq!(met, None, "{name}");
                let met = mesh.first_hit(place + DVec3::Y * side, -DVec3::Y * side, 1e-12, 2.0);
                assert_eq!(met.map(|(t, _)| t), Some(1.0), "{name}");
                let above = place + DVec3::Y * (0.01 * side);
                assert!((mesh.distance(above) - 0.01).abs() < 1e-12, "{name}");
            }
        }
    }
}

/// Protects thin boards, boxes on a floor, and a rug drawn on both sides on a floor from being taken for sheets: only
/// the lower side of the rug, which no wave may meet, has air behind it. All faces of a ball drawn on both sides have.
#[test]
fn sheets_are_told_from_solids_that_touch() {
    let sheets = |faces| mesh(faces, None).expect("a mesh").report().sheets.count;
    let mut board = box_faces(DVec3::new(1.6, 0.001, 0.8));
    add(
        &mut board,
        &box_faces(DVec3::new(1.0, 0.2, 0.5)),
        DVec3::new(0.0, -0.1005, 0.0),
    );
    assert_eq!(sheets(board), 0);
    let on_floor = |other: &MeshFaces, height: f64| {
        let mut faces = room();
        add(&mut faces, other, DVec3::new(0.2, -1.5 + height, 0.3));
        sheets(faces)
    };
    let mut both = ball(1.0, 7);
    let back: Vec<[u32; 3]> = both
        .triangles
        .iter()
        .map(|[a, b, c]| [*a, *c, *b])
        .collect();
    both.group_of.extend(vec![0; back.len()]);
    both.triangles.extend(back);
    let both = mesh(both, None).expect("a mesh");
    assert_eq!(both.report().sheets.count, both.triangle_count());
    let chest = box_faces(DVec3::new(1.0, 0.5, 0.5));
    assert_eq!(on_floor(&chest, 0.25), 0);
    let rug = sheet([[0, 1, 3], [1, 2, 3]]);
    assert_eq!(on_floor(&rug, 0.0), 2);
    // In a room without a ceiling a line upwards meets nothing.
    let mut court = room();
    let ceiling = court.groups.iter().position(|name| name == "ceiling");
    let ceiling = ceiling.expect("a ceiling") as u32;
    let is_kept: Vec<bool> = court.group_of.iter().map(|of| *of != ceiling).collect();
    let mut kept = is_kept.iter();
    court.triangles.retain(|_| kept.next() == Some(&true));
    court.group_of.retain(|of| *of != ceiling);
    add(&mut court, &rug, DVec3::ZERO);
    assert_eq!(sheets(court), 4);
}

/// Protects the materials of rugs and pictures: faces of two materials in one place are reported, whichever is first. A
/// face of the same material, and a rug that is a millimetre above the floor, change nothing.
#[test]
fn faces_of_two_materials_in_one_place_are_reported() {
    let overlays = |height: f64, group: u32, rug_is_first: bool| {
        let mut rug = sheet([[0, 1, 3], [1, 2, 3]]);
        rug.triangles.truncate(2);
        let by = DVec3::new(0.2, -1.5 + height, 0.3);
        let mut faces = room();
        let floor = faces.group_of.len();
        add(&mut faces, &rug, by);
        faces.group_of[floor..].fill(group);
        if rug_is_first {
            faces.triangles.reverse();
            faces.group_of.reverse();
        }
        let mesh = mesh(faces, Some(Inside::Air)).expect("a mesh");
        mesh.report().overlays.count > 0
    };
    for rug_is_first in [false, true] {
        assert!(overlays(0.0, 0, rug_is_first));
        assert!(!overlays(0.0, 2, rug_is_first), "group 2 is the floor");
        assert!(!overlays(0.001, 0, rug_is_first));
    }
}

/// A ball of triangles.
fn ball(radius: f64, rings: u32) -> MeshFaces {
    let around = 2 * rings;
    let mut faces = MeshFaces {
        groups: vec!["ball".to_owned()],
        ..MeshFaces::default()
    };
    for ring in 0..=rings {
        let polar = std::f64::consts::PI * f64::from(ring) / f64::from(rings);
        for step in 0..around {
            let turn = std::f64::consts::TAU * f64::from(step) / f64::from(around);
            let flat = polar.sin() * radius;
            let place = DVec3::new(flat * turn.cos(), radius * polar.cos(), flat * turn.sin());
            let is_pole = ring == 0 || ring == rings;
            let pole = DVec3::new(0.0, place.y, 0.0);
            faces.vertices.push(if is_pole { pole } else { place });
        }
    }
    for ring in 0..rings {
        for step in 0..around {
            let next = (step + 1) % around;
            let [a, b] = [step, next].map(|step| ring * around + step);
            let [c, d] = [step, next].map(|step| (ring + 1) * around + step);
            faces.triangles.extend([[a, b, c], [b, d, c]]);
        }
    }
    faces.group_of = vec![0; faces.triangles.len()];
    faces
}

/// Distance and first hit by testing every triangle, with formulas that share nothing with the mesh's own.
fn brute_force(mesh: &TriangleMesh, o: DVec3, d: DVec3) -> (f64, Option<f64>) {
    let mut nearest = f64::INFINITY;
    let mut hit: Option<f64> = None;
    for triangle in mesh.triangles() {
        let [a, b, c] = triangle.corners.map(|corner| corner.as_dvec3());
        // Möller and Trumbore 1997.
        let (u, v) = (b - a, c - a);
        let p = d.cross(v);
        let determinant = u.dot(p);
        let s = (o - a) / determinant;
        let (x, q) = (s.dot(p), s.cross(u));
        let (y, t) = (d.dot(q), v.dot(q));
        if determinant > 0.0 && x >= 0.0 && y >= 0.0 && x + y <= 1.0 && t >= 0.0 {
            hit = Some(hit.map_or(t, |known: f64| known.min(t)));
        }
        // The nearest point by many small steps of projection onto the triangle's barycentric simplex.
        let on_edge = |from: DVec3, to: DVec3| {
            let along = ((o - from).dot(to - from) / (to - from).length_squared()).clamp(0.0, 1.0);
            o.distance(from.lerp(to, along))
        };
        nearest = nearest
            .min(on_edge(a, b))
            .min(on_edge(b, c))
            .min(on_edge(c, a));
        let normal = u.cross(v).normalize();
        let foot = o - normal * normal.dot(o - a);
        let inside = |from: DVec3, to: DVec3| (to - from).cross(foot - from).dot(normal) >= 0.0;
        if inside(a, b) && inside(b, c) && inside(c, a) {
            nearest = nearest.min(o.distance(foot));
        }
    }
    (nearest, hit)
}

/// Protects distances and hits in `f64`: both agree with a search over all triangles, and the sign is that of a ball.
#[test]
fn distances_and_hits_are_those_of_all_triangles() {
    for (inside, side) in [(Inside::Solid, 1.0), (Inside::Air, -1.0)] {
        let mesh = mesh(ball(2.0, 16), Some(inside)).expect("a ball");
        assert!(mesh.report().is_closed);
        let mut random = Random(7);
        for _ in 0..2000 {
            let o = 4.0 * random.unit() * random.direction();
            let d = random.direction();
            let (nearest, hit) = brute_force(&mesh, o, d);
            let own = mesh.distance(o);
            assert!((own.abs() - nearest).abs() < 1e-12, "{own} {nearest}");
            // The inscribed ball of the mesh has a radius of 2 cos²(π / 32).
            if !(1.98..=2.0).contains(&o.length()) {
                assert_eq!(own > 0.0, side * (o.length() - 2.0) > 0.0, "{o}");
            }
            let found = mesh.first_hit(o, d, 0.0, f64::INFINITY);
            assert_eq!(found.is_some(), hit.is_some(), "{o} {d}");
            if let (Some((t, _)), Some(hit)) = (found, hit) {
                assert!((t - hit).abs() < 1e-9 * (1.0 + hit), "{t} {hit}");
            }
        }
    }
}

/// Protects closed rooms from leaks in `f64`: lines through edges and corners hit a face, also from the middle of the
/// mesh, where many products are 0.
#[test]
fn no_line_passes_between_triangles() {
    let mesh = mesh(ball(2.0, 8), Some(Inside::Air)).expect("a ball");
    let mut random = Random(3);
    let corners: Vec<DVec3> = mesh.vertices.iter().map(|v| v.as_dvec3()).collect();
    for index in 0..20_000 {
        let o = if index % 4 == 0 {
            DVec3::ZERO
        } else {
            1.8 * random.unit() * random.direction()
        };
        let triangle = mesh.triangles[index % mesh.triangles.len()];
        let [a, b] = [triangle[0], triangle[1]].map(|corner| corners[corner as usize]);
        let share = [0.0, 1.0, random.unit()][index % 3];
        let d = (a.lerp(b, share) - o).normalize();
        assert!(
            mesh.first_hit(o, d, 1e-15, f64::INFINITY).is_some(),
            "{o} {d}"
        );
    }
}

/// Protects the grid of the GPU: each triangle is in the list of the cells of its points, a skip distance never passes a
/// list, and the side of a free cell is that of the distance.
#[test]
fn cells_list_their_triangles() {
    let mesh = mesh(ball(2.0, 12), Some(Inside::Air)).expect("a ball");
    let cells = mesh.cells();
    let count = cells.count.as_ivec3();
    let at =
        |cell: glam::IVec3| cells.words[((cell.z * count.y + cell.y) * count.x + cell.x) as usize];
    let cell_of = |p: DVec3| {
        ((p - cells.origin.as_dvec3()) / f64::from(cells.size))
            .floor()
            .as_ivec3()
    };
    let mut random = Random(11);
    for (index, triangle) in mesh.triangles().enumerate() {
        let [a, b, c] = triangle.corners.map(|corner| corner.as_dvec3());
        for _ in 0..50 {
            let (u, v) = (random.unit(), random.unit());
            let (u, v) = if u + v > 1.0 {
                (1.0 - u, 1.0 - v)
            } else {
                (u, v)
            };
            let word = at(cell_of(a + u * (b - a) + v * (c - a)));
            assert!(word < 0.0, "triangle {index}");
            let mut list = (-1.0 - word) as usize;
            let mut is_listed = false;
            loop {
                let vector = cells.lists[list];
                is_listed |= vector[..3].contains(&(index as f32));
                if vector[3] == 0.0 {
                    break;
                }
                list += 1;
            }
            assert!(is_listed, "triangle {index}");
        }
    }
    for z in 0..count.z {
        for y in 0..count.y {
            for x in 0..count.x {
                let cell = glam::IVec3::new(x, y, z);
                let word = at(cell);
                if word < 0.0 || (x + 7 * y + 31 * z) % 97 != 0 {
                    continue;
                }
                let skip = word.floor() as i32;
                let middle =
                    cells.origin.as_dvec3() + (cell.as_dvec3() + 0.5) * f64::from(cells.size);
                assert_eq!(word.fract() == 0.5, mesh.distance(middle) < 0.0);
                let around = 1 - skip..skip;
                for (dx, dy, dz) in around.clone().flat_map(|dx| {
                    let around = around.clone();
                    around
                        .clone()
                        .flat_map(move |dy| around.clone().map(move |dz| (dx, dy, dz)))
                }) {
                    let other = cell + glam::IVec3::new(dx, dy, dz);
                    if other.cmpge(glam::IVec3::ZERO).all() && other.cmplt(count).all() {
                        assert!(at(other) >= 0.0, "{cell} skips {skip} over {other}");
                    }
                }
            }
        }
    }
}

/// Protects furniture that is inside out: it is reversed and reported, also if the faces of the room are reversed with it.
/// Furniture that is right, or intersects another piece or a wall, remains.
#[test]
fn parts_that_are_inside_out_are_reversed() {
    let table = box_faces(DVec3::new(1.6, 0.8, 0.9));
    let mut inside_out = table.clone();
    inside_out.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    let place = DVec3::new(0.5, -0.9, 0.3);
    let furnished = |room: MeshFaces, pieces: &[(&MeshFaces, DVec3)]| {
        let mut faces = room;
        for (piece, at) in pieces {
            add(&mut faces, piece, *at);
        }
        faces
    };
    let beside = place + DVec3::new(0.7, 0.1, 0.2);
    let in_wall = DVec3::new(1.6, 0.2, 0.1);
    let cupboard = box_faces(DVec3::new(1.2, 2.2, 0.6));
    // The back is 1 cm within the wall.
    let at_wall = DVec3::new(0.3, -0.39, -2.21);
    let mut pane = box_faces(DVec3::new(2.0, 1.5, 0.003));
    pane.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    let cases = [
        (furnished(room(), &[(&table, place)]), 0, 60.0 - 1.152),
        (furnished(room(), &[(&cupboard, at_wall)]), 0, 60.0 - 1.584),
        (furnished(room(), &[(&pane, place)]), 1, 60.0 - 0.009),
        (
            furnished(
                room(),
                &[(&table, place), (&table, beside), (&table, in_wall)],
            ),
            0,
            60.0 - 3.0 * 1.152,
        ),
        (furnished(room(), &[(&inside_out, place)]), 1, 60.0 - 1.152),
        (
            furnished(
                room(),
                &[
                    (&inside_out, place),
                    (&table, -place),
                    (&inside_out, beside),
                ],
            ),
            2,
            60.0 - 3.0 * 1.152,
        ),
        (
            furnished(box_faces(DVec3::new(4.0, 3.0, 5.0)), &[(&table, place)]),
            1,
            60.0 - 1.152,
        ),
        (
            furnished(room(), &[(&table, DVec3::new(9.0, 0.0, 0.0))]),
            1,
            60.0 + 1.152,
        ),
    ];
    for (index, (faces, inverted, volume_m3)) in cases.into_iter().enumerate() {
        let mesh = mesh(faces, Some(Inside::Air)).expect("a furnished room");
        let report = mesh.report();
        assert_eq!(report.inverted.count, inverted, "case {index}");
        assert!(
            (report.volume_m3 - volume_m3).abs() < 1e-5,
            "case {index}: {}",
            report.volume_m3
        );
        let told = report
            .warnings()
            .iter()
            .any(|warning| warning.contains("reversed: faces enclosed"));
        assert_eq!(told, inverted > 0, "case {index}");
    }
    let mut pair = table.clone();
    add(&mut pair, &inside_out, DVec3::new(9.0, 0.0, 0.0));
    add(&mut pair, &table, DVec3::new(0.0, 9.0, 0.0));
    let pair = mesh(pair, None).expect("three solids");
    assert_eq!(
        (pair.report().inverted.count, pair.report().is_hollow),
        (1, false)
    );
    let mut shell = box_faces(DVec3::new(4.0, 3.0, 5.0));
    add(&mut shell, &inside_out, place);
    let shell = mesh(shell, None).expect("a solid with a cavity");
    assert_eq!(shell.report().inverted.count, 0);
}

/// Protects models in the coordinates of a survey: corners that are rounded by too much are reported.
#[test]
fn corners_far_from_the_origin_are_reported() {
    let far = |metres: f64| {
        let mut faces = box_faces(DVec3::new(4.1, 3.3, 5.7));
        faces.vertices.iter_mut().for_each(|v| v.x += metres);
        let mesh = mesh(faces, None).expect("a box");
        let told = mesh.report().warnings();
        told.iter()
            .any(|warning| warning.contains("rounded by up to"))
    };
    assert_eq!([0.0, 100.0, 1e5, 5e5].map(far), [false, false, true, true]);
}
