//! The record of each frame, and the report at the end of a run.

use super::app::App;
use super::report::{EndPose, FrameLine, Report};
use super::save::trace_call;
use echomarch::glam::Vec3;
use echomarch::scene::{Listener, Scene, Source, Surface};
use echomarch_walk::World;
use std::time::SystemTime;

impl App {
    /// Writes the record of the frame just drawn, if requested.
    pub fn log_frame(&self, began: SystemTime) {
        let Some(log) = self.options.log_frames else {
            return;
        };
        let since_1970 = began.duration_since(SystemTime::UNIX_EPOCH);
        let line = FrameLine {
            frame: self.recorder.frames,
            began: since_1970.unwrap_or_default().as_secs_f64(),
            seconds: self.seconds(),
            traced: self.recorder.traced,
            heard: self.recorder.last_heard(),
            waves: self.choices.settings.waves,
            more_waves_asked: self.more_waves_asked(),
            fields: self.fields.cost(),
            adapts_waves: self.choices.adapt_waves,
            scene: &self.world.name,
            trying: self.tried_scene(),
            values: &self.world.values,
            mouse_looks: self.mouse_looks,
            paths_heard: self.paths.heard(),
            listener: place(self.world.now.listeners.first().map(|first| first.position)),
            sound: self.sound.is_heard,
            sources: self.in_full.as_ref().map(|_| &self.ears_status.sources[..]),
        };
        if let Ok(line) = serde_json::to_string(&line) {
            log(&line);
        }
    }

    /// The report of the run.
    pub fn report(&mut self) -> Report {
        let walker = self.world.now.listeners.first();
        let mut report = Report {
            scene: self.world.base.name.clone(),
            profile: self.choices.settings.profile().to_string(),
            waves: self.choices.settings.waves,
            more_waves_asked: self.more_waves_asked(),
            fields: self.fields.cost().copied(),
            iterations: self.choices.settings.iterations,
            renderer: self.renderer.clone(),
            seconds: self.seconds(),
            window: self.window,
            picture: self.drawn.size,
            sound: self.speaker.status(),
            listen: self.choices.listen().to_string(),
            in_full: self.in_full.as_ref().map(|_| self.ears_status.clone()),
            latency_ms: self.latency.parts(),
            counts: self.heard.as_ref().map(|f| f.counts).unwrap_or_default(),
            listener: EndPose {
                position: place(walker.map(|walker| walker.position)),
                yaw: walker.map_or(0.0, |walker| walker.yaw.to_degrees()),
                pitch: walker.map_or(0.0, |walker| walker.pitch.to_degrees()),
            },
            source: place(self.world.now.sources.first().map(|first| first.position)),
            gl_errors: self.gl_errors(),
            help: self.choices.help,
            mouse_looks: self.mouse_looks,
            adapts_waves: self.choices.adapt_waves,
            values: self.world.values.iter().cloned().collect(),
            paths_heard: self.paths.heard(),
            saved: self.saved.clone(),
            ..Report::default()
        };
        (report.trace_call, report.trace_call_is_exact) = self.call();
        std::mem::take(&mut self.recorder).fill(&mut report);
        report
    }

    /// Returns the `trace` call that best reproduces the current state, and whether the scene of that call is exact.
    pub fn call(&self) -> (String, bool) {
        let (world, settings) = (&self.world, &self.choices.settings);
        let time = world.moves().then(|| world.looped());
        let names = self.saved.last().into_iter().chain([&world.name]);
        let mut calls = names.map(|name| {
            let at_time = |scene: Scene| match time {
                Some(seconds) => scene.at(seconds),
                None => scene,
            };
            let loaded = World::load(name).map(|loaded| loaded.like(world));
            let sets = loaded.as_ref().map_or(&[][..], |loaded| &loaded.values);
            let call = trace_call(name, time, sets, settings);
            let is_exact = loaded.is_ok_and(|loaded| stands_as(&at_time(loaded.base), &world.now));
            (call, is_exact)
        });
        let first_exact = calls.find(|(_, is_exact)| *is_exact);
        first_exact.unwrap_or_else(|| {
            let call = trace_call(&world.name, time, &world.values, settings);
            (call, false)
        })
    }
}

/// A position for the report; the origin if the position is unknown.
fn place(position: Option<Vec3>) -> [f32; 3] {
    position.unwrap_or_default().to_array()
}

/// Whether two scenes have equal surfaces, air, sources and listeners. Angles may differ by the rounding of degrees.
/// The file names in surfaces may differ, because a saved scene names the same files from another folder.
fn stands_as(a: &Scene, b: &Scene) -> bool {
    let turn = |a: f32, b: f32| (a - b).sin().abs();
    let is_turned = |a: [f32; 2], b: [f32; 2]| turn(a[0], b[0]) + turn(a[1], b[1]) >= 1e-4;
    let sounds_as = |(a, b): (&Source, &Source)| {
        (a.position, a.level_db) == (b.position, b.level_db)
            && a.directivity == b.directivity
            && !is_turned([a.yaw, a.pitch], [b.yaw, b.pitch])
    };
    let is_heard_as = |(a, b): (&Listener, &Listener)| {
        a.position == b.position
            && a.radius == b.radius
            && !is_turned([a.yaw, a.pitch], [b.yaw, b.pitch])
    };
    let is_alike = |(a, b): (&Surface, &Surface)| a.is_alike(b);
    a.sources.len() == b.sources.len()
        && a.sources.iter().zip(&b.sources).all(sounds_as)
        && a.listeners.len() == b.listeners.len()
        && a.listeners.iter().zip(&b.listeners).all(is_heard_as)
        && (&a.materials, a.air) == (&b.materials, b.air)
        && a.surfaces.len() == b.surfaces.len()
        && a.surfaces.iter().zip(&b.surfaces).all(is_alike)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    /// Protects the `trace` call of a scene saved in another folder: its surfaces name the same files differently.
    #[test]
    fn a_scene_in_another_folder_stands_as_its_base() {
        let folder = tempfile::tempdir().unwrap();
        let text = "Scene(surfaces: [Surface(shape: Union(of: [Field(file: \"f.glsl\", lipschitz: 1, \
            size: (2, 2, 2)), Sphere(radius: 1)]))], source: Source(position: (0, 0, 5)), \
            listener: Listener(position: (5, 0, 0), radius: 1))";
        let field = "float field(vec3 p) { return p.x; }";
        let scene = |at: &str, field: &str| {
            let folder = folder.path().join(at);
            fs::create_dir_all(&folder).unwrap();
            fs::write(folder.join("f.glsl"), field).unwrap();
            fs::write(folder.join("a.ron"), text).unwrap();
            Scene::from_file(&folder.join("a.ron")).unwrap()
        };
        let one = scene("one", field);
        let other = scene("other", field);
        assert_ne!(one.surfaces, other.surfaces);
        assert!(stands_as(&one, &other));
        assert!(!stands_as(
            &one,
            &scene("third", "float field(vec3 p) { return p.y; }")
        ));
        let mut moved = other.clone();
        moved.surfaces[0].position.x = 1.0;
        assert!(!stands_as(&one, &moved));
        let mut warm = other.clone();
        warm.air = Some(echomarch::scene::Air::default());
        assert!(!stands_as(&one, &warm));
        let mut turned = other.clone();
        turned.sources[0].yaw = 1.0;
        assert!(!stands_as(&one, &turned));
        let mut directed = other.clone();
        directed.sources[0].directivity = echomarch::scene::Directivity::CARDIOID;
        assert!(!stands_as(&one, &directed));
        let mut two = other;
        two.sources.push(two.sources[0].clone());
        assert!(!stands_as(&one, &two));
    }
}
