//! Levels while a listener walks across the boundaries of shadows and past the ends of reflections.
//!
//! The pressure of sound among rigid bodies is continuous: where a shadow begins or a reflection ends, one path takes over
//! from another. A walk is a straight line in steps of 1 cm, and its levels are those of all paths together.

use crate::oracle::half_plane;
use crate::responses::{BANDS_HZ, SPEED, coarse_band_level_db, tracer};
use echomarch::response::{Response, ResponseSettings};
use echomarch::{Scene, Settings, Tracer};
use std::f64::consts::PI;

/// Highest band in hertz whose levels are compared. Above it the interference of ways itself changes within centimetres.
const UNTIL_HZ: f64 = 2e3;

/// Greatest step that a level may have beyond the exact one, in decibels per centimetre.
const BEYOND_EXACT_DB: f64 = 0.5;

/// A walk of a listener among surfaces.
struct Walk {
    surfaces: String,
    source: [f64; 3],
    from: [f64; 3],
    to: [f64; 3],
    /// Number of reflections up to which paths are sought.
    order: u32,
}

/// Rooms in the form of boxes from one corner to the other, joined where they touch.
fn rooms(of: &[[[f64; 3]; 2]]) -> String {
    let room = |(index, [[x, y, z], [u, v, w]]): (usize, &[[f64; 3]; 2])| {
        format!("(name: \"{index}\", from: ({x}, {y}, {z}), to: ({u}, {v}, {w}))")
    };
    let rooms: Vec<String> = of.iter().enumerate().map(room).collect();
    format!(
        "Surface(shape: Rooms(of: [{}]), material: \"w\")",
        rooms.join(", ")
    )
}

impl Walk {
    /// The octave-band levels at each centimetre in dB, with an arbitrary reference.
    fn levels_db(&self, tracer: &mut Tracer) -> Vec<[f64; 8]> {
        let apart = |axis: usize| self.to[axis] - self.from[axis];
        let length_m = (0..3).map(|axis| apart(axis).powi(2)).sum::<f64>().sqrt();
        let steps = (100.0 * length_m).round() as u32;
        let place = |step: u32| -> [f64; 3] {
            let share = f64::from(step) / f64::from(steps);
            std::array::from_fn(|axis| self.from[axis] + share * apart(axis))
        };
        (0..=steps)
            .map(|step| self.level_db(tracer, place(step)))
            .collect()
    }

    fn level_db(&self, tracer: &mut Tracer, [x, y, z]: [f64; 3]) -> [f64; 8] {
        let [sx, sy, sz] = self.source;
        let text = format!(
            "Scene(surfaces: [{}], materials: {{\"w\": Material(absorption: 0.1)}}, \
             source: Source(position: ({sx}, {sy}, {sz})), \
             listener: Listener(position: ({x}, {y}, {z}), radius: 0.05))",
            self.surfaces
        );
        let scene = Scene::from_ron(&text, "walk").expect("a scene");
        let settings = ResponseSettings::default()
            .with_seconds(0.1)
            .with_order(self.order)
            .with_diffraction(true)
            .with_trace(Settings::default().with_waves(16));
        let paths = Response::trace(tracer, &scene, &settings)
            .expect("a response")
            .paths;
        let energy = |band: usize| paths.iter().map(|path| path.energy[band]).sum::<f64>();
        let levels: [f64; 8] = std::array::from_fn(|band| 10.0 * energy(band).log10());
        assert!(levels.iter().all(|level| level.is_finite()), "{levels:?}");
        levels
    }
}

/// The greatest change of a level between neighbouring places in decibels.
fn greatest_step_db(levels: &[[f64; 8]]) -> f64 {
    let bands = BANDS_HZ.iter().filter(|hz| **hz <= UNTIL_HZ).count();
    let step = |places: &[[f64; 8]]| {
        let change = |band: usize| (places[1][band] - places[0][band]).abs();
        (0..bands).map(change).fold(0.0, f64::max)
    };
    levels.windows(2).map(step).fold(0.0, f64::max)
}

/// The greatest exact step in decibels per centimetre across the boundary of the shadow of a half plane, for a source and
/// a listener `near_m` metres from its edge: nearer than those of any walk here.
fn exact_step_db(near_m: f64) -> f64 {
    let [source_angle, boundary] = [60.0_f64, 240.0_f64].map(f64::to_radians);
    let bands = BANDS_HZ.iter().filter(|hz| **hz <= UNTIL_HZ);
    let steps = (-30..30).flat_map(|step: i32| {
        let level_db = |step: i32, hz: f64| {
            let angle = boundary + 0.01 * f64::from(step) / near_m;
            let pressure = |hz: f64| {
                let k = 2.0 * PI * hz / SPEED;
                half_plane::pressure(k, near_m, source_angle, near_m, angle, 0.0)
            };
            coarse_band_level_db(pressure, hz)
        };
        let step_db = move |hz: &f64| (level_db(step + 1, *hz) - level_db(step, *hz)).abs();
        bands.clone().map(step_db)
    });
    steps.fold(0.0, f64::max)
}

/// A room in the shape of an L.
fn corner() -> String {
    rooms(&[
        [[0.0, 0.0, 0.0], [6.0, 2.8, 3.0]],
        [[0.0, 0.0, 3.0], [3.0, 2.8, 7.0]],
    ])
}

/// Two rooms that are joined by a doorway.
fn doorway() -> String {
    rooms(&[
        [[0.0, 0.0, 0.0], [5.0, 2.7, 4.0]],
        [[5.0, 0.0, 1.5], [5.2, 2.05, 2.4]],
        [[5.2, 0.0, -1.0], [9.0, 2.7, 5.0]],
    ])
}

/// Two rooms that are joined by a window.
fn window() -> String {
    rooms(&[
        [[0.0, 0.0, 0.0], [4.0, 2.6, 4.0]],
        [[4.0, 0.9, 1.2], [4.25, 2.1, 2.6]],
        [[4.25, 0.0, 0.0], [8.0, 2.6, 4.0]],
    ])
}

/// Two rooms that are joined by an opening in a thick wall.
fn thick_doorway() -> String {
    rooms(&[
        [[0.0, 0.0, 0.0], [5.0, 3.0, 4.0]],
        [[5.0, 0.0, 1.5], [5.4, 2.2, 2.5]],
        [[5.4, 0.0, 0.0], [9.0, 3.0, 4.0]],
    ])
}

/// Least distance of sources and listeners from edges in metres.
const NEAR_M: f64 = 1.1;

/// Protects walks against jumps. The exact level is as continuous as at a half plane, of which one edge has the steepest
/// step; the bound is that step and half a decibel, which listeners hardly notice in a centimetre.
fn assert_continuous(walk: &Walk) {
    let step_db = greatest_step_db(&walk.levels_db(&mut tracer()));
    let most_db = exact_step_db(NEAR_M) + BEYOND_EXACT_DB;
    assert!(step_db < most_db, "{step_db} dB, at most {most_db} dB");
}

/// Protects reflections at a ceiling and a floor behind the corner of a room, where the solid behind the corner covers the
/// point of reflection.
#[test]
fn reflections_at_a_ceiling_go_on_behind_a_corner() {
    for order in [1, 2] {
        assert_continuous(&Walk {
            surfaces: corner(),
            source: [4.5, 1.5, 1.4],
            from: [1.35, 1.6, 5.5],
            to: [1.65, 1.6, 5.5],
            order,
        });
    }
}

/// Protects reflections at a ceiling that bend around a jamb and a lintel: half-planes over both edges have no way in
/// common.
#[test]
fn reflections_at_a_ceiling_go_on_behind_a_doorway() {
    assert_continuous(&Walk {
        surfaces: doorway(),
        source: [2.3, 1.5, 1.1],
        from: [7.4, 1.5, 1.5],
        to: [7.4, 1.5, 1.7],
        order: 1,
    });
}

/// Protects ways that meet the edges of a thick wall obliquely, where the listener begins to see its far edge.
#[test]
fn levels_behind_a_thick_wall_do_not_jump_obliquely() {
    for height in [1.5, 3.0] {
        assert_continuous(&Walk {
            surfaces: rooms(&[
                [[-300.0, -300.0, -300.0], [5.0, 300.0, 300.0]],
                [[5.0, -300.0, 2.5], [5.4, 300.0, 300.0]],
                [[5.4, -300.0, -300.0], [300.0, 300.0, 300.0]],
            ]),
            source: [3.9, -height, 1.8],
            from: [6.5, height, 2.47],
            to: [6.5, height, 2.53],
            order: 0,
        });
    }
}

/// Protects levels in sight through a window at the height of the source: the ways over both edges of the upper side of the
/// window are equally long there.
#[test]
fn levels_in_a_window_do_not_jump_at_the_height_of_the_source() {
    assert_continuous(&Walk {
        surfaces: window(),
        source: [2.5, 1.9, 1.9],
        from: [6.0, 1.8, 2.2],
        to: [6.0, 1.95, 2.2],
        order: 1,
    });
}

/// Protects walks across the plane of a jamb's inner face, where a second edge hides the source, and the other jamb
/// reflects.
#[test]
fn levels_behind_a_thick_doorway_do_not_jump_beside_a_jamb() {
    assert_continuous(&Walk {
        surfaces: thick_doorway(),
        source: [4.0, 1.5, 3.2],
        from: [6.5, 1.5, 2.42],
        to: [6.5, 1.5, 2.56],
        order: 1,
    });
}
