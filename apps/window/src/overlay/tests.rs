//! Tests of the panels without a window.

use super::super::DemoOptions;
use super::*;
use echomarch::auralisation::HeardSource;
use echomarch::response::PathKind;
use echomarch_walk::DrawnPath;
use egui::{Context, Id, RawInput, Rect};
use glam::Vec3;
use std::sync::Arc;

/// All areas that have a fixed position.
const AREAS: [&str; 7] = [
    "left", "right", "lower", "hint", "message", "refusal", "help",
];

/// The values that change from frame to frame while the panels are open.
#[derive(Clone, Copy)]
struct Moment {
    waves: u32,
    milliseconds: f64,
    heard: Option<u64>,
    sound: &'static str,
    drawn: [u32; 2],
    seconds: f64,
}

const QUIET: Moment = Moment {
    waves: 64,
    milliseconds: 0.0,
    heard: None,
    sound: "",
    drawn: [96, 54],
    seconds: 0.0,
};

const BUSY: Moment = Moment {
    waves: 1 << 20,
    milliseconds: 12_345.67,
    heard: Some(1 << 20),
    sound: "no sound: the device with a very long name that does not fit any line of any panel went away",
    drawn: [1600, 900],
    seconds: 12.3,
};

/// A path of each kind.
fn drawn_paths() -> Vec<DrawnPath> {
    let path = |kind| DrawnPath {
        kind,
        points: vec![Vec3::ZERO, Vec3::X, Vec3::Z],
    };
    PathKind::ALL.map(path).to_vec()
}

/// Returns the positions of all areas after several frames with these values, in a window of this size.
fn laid_out(
    size: [u32; 2],
    scene: &str,
    moment: Moment,
    says: [Option<&str>; 2],
    help: bool,
) -> Vec<(&'static str, Rect)> {
    let context = Context::default();
    set_style(&context);
    let mut world = World::load(scene).unwrap();
    world.seconds = moment.seconds;
    let mut chosen = Choices::of(&DemoOptions::default());
    chosen.settings.waves = moment.waves;
    chosen.help = help;
    let frame = moment.heard.map(|count| {
        let mut frame = Frame::default();
        (frame.panning.left, frame.panning.right) = (0.25, 0.5);
        let counts = &mut frame.counts;
        counts.listener_hits = count;
        counts.dead = count;
        counts.travelling = count;
        counts.zero_length_passes = count;
        counts.step_limit_reached = count;
        counts.evaluations = count;
        frame
    });
    let times = [FrameTimes {
        picture: moment.milliseconds,
        waves: moment.milliseconds,
        whole: moment.milliseconds,
        ..FrameTimes::default()
    }; 3];
    let sound = SoundStatus {
        text: moment.sound.to_owned(),
        ..SoundStatus::default()
    };
    let ears = match moment.heard {
        None => EarsStatus::default(),
        Some(_) => EarsStatus {
            sources: vec![HeardSource::default(); 3],
            curve: vec![-20.0; 120],
            paths: Arc::new(drawn_paths()),
            ..EarsStatus::default()
        },
    };
    let hud = HudState {
        world: &world,
        files: &[],
        heard: frame.as_ref(),
        paths: &[],
        times: &times,
        target: 33.3,
        drawn: Drawn {
            size: moment.drawn,
            ..Drawn::default()
        },
        more_waves_asked: moment.heard.map(|_| 1 << 20),
        fields: None,
        window: size,
        latency: Parts::default(),
        sound: &sound,
        ears: Some(&ears),
        levels: [0.0, moment.milliseconds.min(1.0) as f32],
        played_pan: Some(0.25),
        gl_errors: moment.heard,
        message: says[0],
        refusal: says[1],
        mouse_looks: false,
        renderer: "llvmpipe (LLVM 15.0.6, 256 bits)",
    };
    let mut plan = Plan::default();
    let screen = Rect::from_min_size(egui::Pos2::ZERO, size.map(|side| side as f32).into());
    for _ in 0..3 {
        let input = RawInput {
            screen_rect: Some(screen),
            ..RawInput::default()
        };
        let mut output = context.run_ui(input, |ui| {
            draw(ui, &hud, &mut chosen, &mut plan);
        });
        // Nothing draws the textures in this test.
        output.textures_delta.clear();
    }
    let shown = |name: &&str| {
        let layer = egui::LayerId::new(egui::Order::Middle, Id::unique(*name));
        context.memory(|memory| memory.areas().is_visible(&layer))
    };
    let place = |name| {
        let rect = context.memory(|memory| memory.area_rect(Id::unique(name)));
        (name, rect.unwrap())
    };
    AREAS.into_iter().filter(shown).map(place).collect()
}

const SIZES: [[u32; 2]; 6] = [
    [320, 180],
    [500, 400],
    [720, 405],
    [960, 540],
    [1280, 720],
    [1600, 900],
];

/// Protects the panels from moving: their positions and sizes do not depend on the numbers shown.
#[test]
fn panels_stand_still_while_one_reads() {
    for size in SIZES {
        for scene in ["corner", "open-field"] {
            let quiet = laid_out(size, scene, QUIET, [None; 2], false);
            let busy = laid_out(size, scene, BUSY, [None; 2], false);
            assert!(quiet.len() >= 2, "{size:?}: {quiet:?}");
            assert_eq!(quiet, busy, "{scene} {size:?}");
        }
        // Messages, and plans of another shape, do not move the panels.
        let panels = |all: Vec<(&'static str, Rect)>| {
            let is_panel = |(name, _): &(&str, Rect)| ["left", "lower"].contains(name);
            all.into_iter().filter(is_panel).collect::<Vec<_>>()
        };
        let corner = panels(laid_out(size, "corner", QUIET, [None; 2], false));
        let other = laid_out(
            size,
            "whispering-gallery",
            BUSY,
            [Some("saved"), None],
            false,
        );
        assert_eq!(corner, panels(other), "{size:?}");
    }
}

/// Protects small windows: areas do not overlap, and do not extend beyond the window's edge, even with long messages.
#[test]
fn nothing_lies_over_anything_else() {
    let long = "a sentence that goes on and on, with file and line, ".repeat(8);
    for size in SIZES {
        for help in [false, true] {
            for says in [
                [None, None],
                [Some(long.as_str()), None],
                [None, Some(&long)],
                [Some(&long), Some(&long)],
            ] {
                let areas = laid_out(size, "open-pillars", BUSY, says, help);
                let screen =
                    Rect::from_min_size(egui::Pos2::ZERO, size.map(|side| side as f32).into());
                for (index, (name, rect)) in areas.iter().enumerate() {
                    assert!(screen.contains_rect(*rect), "{size:?} {name} {rect:?}");
                    for (other, over) in &areas[..index] {
                        let both = rect.intersect(*over);
                        let is_over = both.width() > 0.5 && both.height() > 0.5;
                        assert!(!is_over, "{size:?}: {name} {rect:?} over {other} {over:?}");
                    }
                }
                assert_eq!(areas.iter().any(|(name, _)| *name == "help"), help);
            }
        }
    }
}
