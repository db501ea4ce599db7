//! Compares pictures on every GL API with golden pictures, and with the CPU's distance function. Without GL these tests
//! fail.
//!
//! The golden pictures in `tests/golden/` were drawn by Mesa's llvmpipe. Another renderer may round differently, so a
//! picture matches if the mean difference of its channels is below 1/255, and fewer than 0.5 % of its pixels differ by
//! more than 8/255 in any channel. `ECHOMARCH_UPDATE_GOLDEN=1` rewrites the golden pictures, drawn with the first API.

#![cfg(feature = "picture")]

use echomarch::gl::{Api, Context, ContextOptions};
use echomarch::picture::{
    Bounds, RgbaImage, SliceOptions, ViewOptions, first_person, save_png, slice,
};
use echomarch::scene::{Key, Path as KeyPath};
use echomarch::{Error, Listener, Scene, Source, Tracer};
use glam::{Quat, Vec2, Vec3};
use std::path::{Path, PathBuf};

const MEAN_DIFFERENCE: f64 = 1.0;
const PIXEL_DIFFERENCE: u8 = 8;
const PIXELS_OFF: f64 = 0.005;

/// A picture's name, and the function that draws it.
type Golden = (&'static str, fn(&mut Tracer) -> RgbaImage);

const GOLDEN: [Golden; 8] = [
    ("corner-view", |t| view(t, "corner")),
    ("obstacles-view", |t| view(t, "obstacles")),
    ("open-pillars-view", |t| view(t, "open-pillars")),
    ("corner-slice", |t| plan(t, "corner", 0)),
    ("corner-slice-paths", |t| plan(t, "corner", 40)),
    ("shoebox-slice-paths", |t| plan(t, "shoebox", 40)),
    ("open-pillars-slice", |t| plan(t, "open-pillars", 0)),
    ("open-pillars-slice-paths", |t| plan(t, "open-pillars", 40)),
];

/// Protects every picture from unnoticed changes and from differences between APIs.
#[test]
fn pictures_match_the_golden_ones_on_every_api() {
    if std::env::var_os("ECHOMARCH_UPDATE_GOLDEN").is_some() {
        let mut tracer = tracer(Api::ALL[0]);
        for (name, draw) in GOLDEN {
            save_png(&golden_file(name), &draw(&mut tracer)).unwrap();
        }
    }
    for api in Api::ALL {
        let ended = std::thread::spawn(move || {
            let mut tracer = tracer(api);
            for (name, draw) in GOLDEN {
                let drawn = draw(&mut tracer);
                let golden = image::open(golden_file(name)).unwrap().into_rgba8();
                assert_alike(&drawn, &golden, &format!("{name}-{api}"));
            }
        });
        assert!(ended.join().is_ok(), "failed with the API {api}");
    }
}

/// Protects pictures: they show the surfaces that waves hit. A block that hides the source from the waves hides it from
/// the eye, and without the block the source is visible.
#[test]
fn the_source_is_seen_only_where_nothing_is_before_it() {
    let context = tracer(Api::Gl).context().clone();
    let mut scene = Scene::builtin("corner").unwrap();
    let ahead = scene.sources[0].position - scene.listeners[0].position;
    scene.listeners[0].yaw = ahead.x.atan2(-ahead.z);
    let options = ViewOptions {
        width: 60,
        height: 60,
        field_of_view: 0.2,
    };
    let glows = |scene: &Scene| {
        let picture = first_person(&context, scene, &options).unwrap();
        let [red, green, blue, alpha] = picture.get_pixel(30, 30).0;
        assert_eq!(alpha, 255);
        red > 245 && green > 235 && blue > 215
    };
    assert!(!glows(&scene));
    scene.surfaces.truncate(1);
    assert!(glows(&scene));
    // After the turn the source is behind the eye.
    scene.listeners[0].yaw += std::f32::consts::PI;
    assert!(!glows(&scene));
}

/// Protects plans: points that are solid by the CPU's distance function are filled, points in the air are not, and
/// every pixel has the position that the bounds state.
#[test]
fn a_slice_is_filled_where_the_scene_is_solid() {
    let mut tracer = tracer(Api::Gl);
    for (name, height) in [("obstacles", 3.0), ("open-pillars", -0.5)] {
        let scene = Scene::builtin(name).unwrap();
        let options = SliceOptions {
            width: 320,
            height: Some(height),
            bounds: Some(square(16.0)),
            scale_bar: false,
            ..SliceOptions::default()
        };
        let picture = slice(&mut tracer, &scene, &options).unwrap();
        assert_eq!(picture.dimensions(), (320, 320));
        let mut seen = [0, 0];
        for (column, row, pixel) in picture.enumerate_pixels() {
            let metres = |index: u32| (index as f32 + 0.5) * 0.1 - 16.0;
            let place = Vec3::new(metres(column), height, metres(row));
            let distance = scene.surface_distance(place).distance;
            if near_a_mark(&scene, place) || distance.abs() < 0.3 {
                continue;
            }
            let [red, green, blue, _] = pixel.0;
            let hue = red.max(green).max(blue) - red.min(green).min(blue);
            assert_eq!(hue > 20, distance < 0.0, "{name}: {pixel:?} at {place}");
            seen[usize::from(distance < 0.0)] += 1;
        }
        assert!(seen.iter().all(|&count| count > 1000), "{name}: {seen:?}");
    }
}

/// Protects x and yaw from a wrong sign: the plan of a mirrored scene is the mirrored plan, including marks and
/// key-framed paths.
#[test]
fn a_mirrored_scene_gives_a_mirrored_slice() {
    let mut tracer = tracer(Api::Gl);
    let mut scene = Scene::builtin("open-pillars").unwrap();
    scene.listeners[0].yaw = 0.7;
    let options = SliceOptions {
        width: 200,
        bounds: Some(square(15.0)),
        scale_bar: false,
        ..SliceOptions::default()
    };
    let mut drawn = slice(&mut tracer, &mirrored(&scene), &options).unwrap();
    image::imageops::flip_horizontal_in_place(&mut drawn);
    let expected = slice(&mut tracer, &scene, &options).unwrap();
    assert_alike(&drawn, &expected, "mirrored-slice");
}

/// Protects plans of several sources and listeners: all of them are shown and named. Those without a drawn wave have a
/// paler colour.
#[test]
fn a_slice_shows_all_sources_and_listeners() {
    let mut tracer = tracer(Api::Gl);
    let mut scene = Scene::builtin("shoebox").unwrap();
    let options = SliceOptions {
        width: 400,
        bounds: Some(square(8.0)),
        scale_bar: false,
        ..SliceOptions::default()
    };
    let alone = slice(&mut tracer, &scene, &options).unwrap();
    let [source, listener] = [Vec3::new(-3.1, 0.0, 6.3), Vec3::new(4.3, 0.0, -6.1)];
    scene.sources.push(Source::at(source).named("flute"));
    scene.listeners.push(Listener::at(listener, 0.5));
    let first = scene.pair(0, 0).unwrap();
    let all = slice(&mut tracer, first, &options).unwrap();
    let pixel = |place: Vec3| ((place.x + 8.0) * 25.0, (place.z + 8.0) * 25.0);
    let changed = |place: Vec3, right: f32, half: f32| {
        let (x, y) = pixel(place);
        let (x, half) = (x + right, half as i32);
        let around = (-half..=half).flat_map(|dx| (-half..=half).map(move |dy| (dx, dy)));
        let at = around.map(|(dx, dy)| ((x as i32 + dx) as u32, (y as i32 + dy) as u32));
        at.filter(|&(x, y)| alone.get_pixel(x, y) != all.get_pixel(x, y))
            .count()
    };
    let marks = [changed(source, 0.0, 2.0), changed(listener, 0.0, 2.0)];
    assert_eq!(marks, [25, 25], "both are filled");
    let names = [changed(source, 14.0, 6.0), changed(listener, 20.0, 6.0)];
    assert!(
        names.iter().all(|&dots| dots > 5),
        "both are named: {names:?}"
    );
    let (x, y) = pixel(source);
    let [red, green, blue, _] = all.get_pixel(x as u32, y as u32).0;
    assert!(red > green && green > blue, "a source is orange");
    // Without given bounds, all sources are in the picture too.
    scene.sources[1].position.x = 40.0;
    let shown = Bounds::of(&scene, scene.listeners[0].position.y);
    assert!(shown.max.x > 40.0, "{shown:?}");
}

/// Protects pictures from unnecessary requirements. Without a source, a view and a plan can be drawn. Without a
/// listener, a plan at a given height can be drawn. If there are several listeners, the caller chooses one.
#[test]
fn a_picture_needs_no_source() {
    let mut tracer = tracer(Api::Gl);
    let context = tracer.context().clone();
    let view = ViewOptions {
        width: 64,
        height: 48,
        ..ViewOptions::default()
    };
    let mut scene = Scene::builtin("corner").unwrap();
    let with_source = first_person(&context, &scene, &view).unwrap();
    let own = scene.sources.remove(0);
    let plan = SliceOptions {
        width: 64,
        ..SliceOptions::default()
    };
    let without = first_person(&context, &scene, &view).unwrap();
    assert_eq!(without.dimensions(), with_source.dimensions());
    slice(&mut tracer, &scene, &plan).unwrap();
    let with_paths = SliceOptions {
        paths: 4,
        ..plan.clone()
    };
    refused(slice(&mut tracer, &scene, &with_paths));
    let listener = scene.listeners.remove(0);
    refused(first_person(&context, &scene, &view));
    refused(slice(&mut tracer, &scene, &plan));
    let at_height = SliceOptions {
        height: Some(0.0),
        ..plan.clone()
    };
    slice(&mut tracer, &scene, &at_height).unwrap();
    scene.surfaces.clear();
    let nowhere = Bounds::of(&scene, 0.0);
    assert!(nowhere.min.is_finite() && nowhere.max.is_finite());
    scene.surfaces = Scene::builtin("corner").unwrap().surfaces;
    scene.sources = vec![own.clone(), own];
    scene.listeners = vec![listener];
    refused(first_person(&context, &scene, &view));
    refused(slice(&mut tracer, &scene, &plan));
    let chosen = first_person(&context, scene.pair(1, 0).unwrap(), &view).unwrap();
    assert_eq!(chosen, with_source);
}

/// Protects the user from an empty picture, and the renderer from sizes that it cannot draw.
#[test]
fn pictures_that_cannot_be_are_refused_as_bad_input() {
    let mut tracer = tracer(Api::Gl);
    let context = tracer.context().clone();
    let scene = Scene::builtin("corner").unwrap();
    // No renderer allows textures with sides of this length in texels.
    let too_wide = 1 << 20;
    for (width, height, field_of_view) in [
        (0, 10, 1.0),
        (10, 0, 1.0),
        (too_wide, 1, 1.0),
        (10, 10, 0.0),
        (10, 10, 3.2),
        (10, 10, f32::NAN),
    ] {
        let options = ViewOptions {
            width,
            height,
            field_of_view,
        };
        refused(first_person(&context, &scene, &options));
    }
    let sound = SliceOptions::default();
    let spoil: [fn(&mut SliceOptions); 5] = [
        |o| o.width = 0,
        |o| o.width = u32::MAX,
        |o| o.height = Some(f32::INFINITY),
        |o| o.bounds = Some(square(-1.0)),
        |o| o.bounds.insert(square(1.0)).max.y = 1e9,
    ];
    for spoil in spoil {
        let mut options = sound.clone();
        spoil(&mut options);
        refused(slice(&mut tracer, &scene, &options));
    }
}

/// Protects picture files: a picture that is read equals the one that was written, and a missing folder is reported.
#[test]
fn a_saved_picture_reads_back() {
    let folder = tempfile::tempdir().unwrap();
    let picture = RgbaImage::from_fn(7, 3, |x, y| image::Rgba([x as u8, y as u8, 99, 255]));
    let file = folder.path().join("picture.png");
    save_png(&file, &picture).unwrap();
    assert_eq!(image::open(&file).unwrap().into_rgba8(), picture);
    let error = save_png(&folder.path().join("absent/picture.png"), &picture).unwrap_err();
    assert!(error.to_string().contains("absent"), "{error}");
    assert!(error.is_bad_input(), "a missing folder is bad input");
}

fn tracer(api: Api) -> Tracer {
    let options = ContextOptions::new(api);
    let context = Context::headless(&options).unwrap_or_else(|error| panic!("{error}"));
    Tracer::new(&context).unwrap()
}

fn view(tracer: &mut Tracer, name: &str) -> RgbaImage {
    let options = ViewOptions {
        width: 160,
        height: 120,
        ..ViewOptions::default()
    };
    let scene = Scene::builtin(name).unwrap();
    first_person(tracer.context(), &scene, &options).unwrap()
}

fn plan(tracer: &mut Tracer, name: &str, paths: u32) -> RgbaImage {
    let options = SliceOptions {
        width: 160,
        paths,
        ..SliceOptions::default()
    };
    let scene = Scene::builtin(name).unwrap();
    slice(tracer, &scene, &options).unwrap()
}

fn square(half: f32) -> Bounds {
    Bounds {
        min: Vec2::splat(-half),
        max: Vec2::splat(half),
    }
}

fn near_a_mark(scene: &Scene, place: Vec3) -> bool {
    let listener = &scene.listeners[0];
    let path = (0..=50).filter_map(|step| listener.path.at(f64::from(step) * 0.1));
    let mut marks = vec![(listener.position, listener.radius + 2.0)];
    marks.push((scene.sources[0].position, 0.8));
    marks.extend(path.map(|key| (key.position, 0.5)));
    let level = |p: Vec3| Vec2::new(p.x, p.z);
    let is_near = |&(mark, radius): &(Vec3, f32)| level(mark).distance(level(place)) < radius;
    marks.iter().any(is_near)
}

/// Returns the scene with left and right exchanged.
fn mirrored(scene: &Scene) -> Scene {
    let place = |p: Vec3| Vec3::new(-p.x, p.y, p.z);
    let path = |path: &KeyPath| {
        let key = |key: &Key| Key {
            position: place(key.position),
            yaw: -key.yaw,
            ..*key
        };
        KeyPath::new(path.keys().iter().map(key).collect()).unwrap()
    };
    let mut mirrored = scene.clone();
    mirrored.sources[0].position = place(scene.sources[0].position);
    mirrored.sources[0].path = path(&scene.sources[0].path);
    mirrored.listeners[0].position = place(scene.listeners[0].position);
    mirrored.listeners[0].yaw = -scene.listeners[0].yaw;
    mirrored.listeners[0].path = path(&scene.listeners[0].path);
    for surface in &mut mirrored.surfaces {
        surface.position = place(surface.position);
        let [x, y, z, w] = surface.rotation.to_array();
        surface.rotation = Quat::from_xyzw(x, -y, -z, w);
    }
    mirrored
}

fn refused(drawn: Result<RgbaImage, Error>) {
    let error = drawn.expect_err("the call should fail");
    assert!(error.is_bad_input(), "{error}");
}

fn golden_file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/golden/{name}.png"))
}

/// Compares pictures within the tolerance above. A picture that does not match is saved for inspection.
fn assert_alike(drawn: &RgbaImage, expected: &RgbaImage, name: &str) {
    let verdict = difference(drawn, expected);
    if let Err(difference) = verdict {
        let kept = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}.png"));
        save_png(&kept, drawn).unwrap();
        panic!("{name}: {difference}; drawn: {}", kept.display());
    }
}

fn difference(drawn: &RgbaImage, expected: &RgbaImage) -> Result<(), String> {
    let (here, there) = (drawn.dimensions(), expected.dimensions());
    if here != there {
        return Err(format!("{here:?} pixels instead of {there:?}"));
    }
    let (mut sum, mut off) = (0.0, 0.0);
    for (a, b) in drawn.pixels().zip(expected.pixels()) {
        let channels = a.0.iter().zip(b.0).map(|(a, b)| a.abs_diff(b));
        off += f64::from(u8::from(channels.clone().any(|d| d > PIXEL_DIFFERENCE)));
        sum += channels.map(f64::from).sum::<f64>();
    }
    let pixels = f64::from(here.0) * f64::from(here.1);
    let (mean, off) = (sum / (4.0 * pixels), off / pixels);
    if mean < MEAN_DIFFERENCE && off < PIXELS_OFF {
        return Ok(());
    }
    Err(format!(
        "the mean difference is {mean:.2}/255, and {:.2} % of the pixels differ by more than {PIXEL_DIFFERENCE}/255",
        100.0 * off
    ))
}
