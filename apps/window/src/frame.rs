//! One frame: setup, waves, picture, panels, swap.

use super::DemoError;
use super::adapt::{SCALES, SHARE_OF_WAVES, scale_costs};
use super::app::{App, Stage};
use super::error::sentence;
use super::overlay::{self, HudState};
use super::report::FrameTimes;
use echomarch::internals::sampling::{mean, median};
use echomarch::picture::{Drawn, RgbaImage, save_png};
use echomarch_walk::PATH_ITERATIONS;
use std::path::Path;
use std::time::{Duration, Instant};

/// Number of frames between two updates of the paths in the plan.
const PATHS_EVERY: u64 = 6;
/// Number of recent frames that decide whether a frame of waves fits the frame time.
const FRAMES_LOOKED_AT: usize = 10;
/// Display time of a message.
const MESSAGE: Duration = Duration::from_secs(4);
/// Number of frames shown in the panels.
const FRAMES_SHOWN: usize = 100;

/// Time of a frame except its waves, in milliseconds.
fn without_waves(times: &FrameTimes) -> f64 {
    times.work - times.waves - times.read_back
}

fn milliseconds(from: Instant) -> f64 {
    from.elapsed().as_secs_f64() * 1e3
}

impl App {
    /// Traces and draws one frame. The last frame also saves a screenshot, if requested.
    pub fn frame(&mut self, is_last: bool) -> Result<(), DemoError> {
        let Some(mut stage) = self.stage.take() else {
            return Ok(());
        };
        let drawn = self.frame_on(&mut stage, is_last);
        self.stage = Some(stage);
        drawn
    }

    fn frame_on(&mut self, stage: &mut Stage, is_last: bool) -> Result<(), DemoError> {
        let began = Instant::now();
        let passed = began.duration_since(self.last).as_secs_f64();
        self.last = began;
        self.reread(stage);
        self.try_new(stage)?;
        self.world.pass(&self.pressed.input(), passed);
        let size = stage.window.size();
        self.window = size;
        if size[0] == 0 || size[1] == 0 {
            // The window is not visible, but the sound continues.
            let mut times = FrameTimes::default();
            self.waves(stage, &mut times)?;
            self.recorder.frame(times, self.seconds());
            return Ok(());
        }
        if self.recorder.frames == 0 {
            // The ears compile their programs while this frame compiles its own.
            self.hear();
        }
        let mut times = FrameTimes {
            whole: 1e3 * passed,
            ..FrameTimes::default()
        };
        if let Err(error) = self.world_on(stage, size, &mut times) {
            self.fall_back(error)?;
        }
        self.panels(stage, size, &mut times)?;
        self.pictures(stage, size, is_last)?;
        let swapping = Instant::now();
        stage.window.gl.swap()?;
        times.swap = milliseconds(swapping);
        self.check(stage);
        times.work = milliseconds(began);
        self.recorder.frame(times, self.seconds());
        self.adapt(times);
        self.looked = began;
        Ok(())
    }

    /// Switches to a chosen scene after its users' fields were tried. The previous scene is shown until then. The new
    /// scene is checked only now, because the trial determines which parts of its fields are solid.
    fn try_new(&mut self, stage: &mut Stage) -> Result<(), DemoError> {
        if let Some(mut coming) = self.coming.take() {
            match coming.poll() {
                None => self.coming = Some(coming),
                Some(Ok(())) => self.arrive(coming),
                Some(Err(error)) => {
                    self.tell(format!("{}: {}", coming.world.name, sentence(&error)));
                }
            }
        }
        if self.previous.is_none() {
            return Ok(());
        }
        let (scene, settings) = (&self.world.base, &self.choices.settings);
        match stage.tracer.check(scene, settings) {
            Ok(()) => Ok(()),
            Err(error) => self.fall_back(error.into()),
        }
    }

    /// Traces, draws and plays the scene.
    fn world_on(
        &mut self,
        stage: &mut Stage,
        size: [u32; 2],
        times: &mut FrameTimes,
    ) -> Result<(), DemoError> {
        self.waves(stage, times)?;
        let scale = match self.choices.picture_scale {
            // A scale set by the user is applied exactly.
            Some(fixed) => (fixed, false),
            None => (SCALES[self.scale_step], true),
        };
        let drawing = Instant::now();
        self.drawn = stage.view.draw(self.world.pair()?, size, scale)?;
        // On a graphics card, the call returns long before the picture is drawn.
        times.picture = if stage.window.gl.context().is_software() {
            milliseconds(drawing)
        } else {
            self.drawn.milliseconds
        };
        if self.choices.paths && self.choices.panels {
            let following = Instant::now();
            self.follow_paths(stage)?;
            times.paths = milliseconds(following);
        }
        // The frame of waves begun in this call may already be finished.
        self.collect(stage, false, times)?;
        self.previous = None;
        Ok(())
    }

    /// Returns to the previous scene if the current one cannot be drawn. Returns the error if there is no previous
    /// scene.
    fn fall_back(&mut self, error: DemoError) -> Result<(), DemoError> {
        let Some(before) = self.previous.take() else {
            return Err(error);
        };
        let why = sentence(&error);
        let refused = std::mem::replace(&mut self.world, before.world);
        match before.other {
            None => self.refuse(why),
            Some(follower) => {
                self.follower = follower;
                self.is_another_world();
                self.tell(format!("{}: {why}", refused.name));
            }
        }
        self.begins_anew = true;
        self.drawn = Drawn::default();
        Ok(())
    }

    /// Collects the finished waves of the last frame and begins new waves. Waves that take longer than one frame are
    /// continued instead.
    fn waves(&mut self, stage: &mut Stage, times: &mut FrameTimes) -> Result<(), DemoError> {
        let every = u64::from(self.choices.trace_every.max(1));
        let is_due = self.recorder.frames.is_multiple_of(every);
        let is_marching = stage.tracer.frame_marching_for().is_some();
        let is_stale = self.begins_anew || self.under_way != self.choices.settings;
        if !is_marching {
            self.collect(stage, is_due, times)?;
        }
        self.measure_new();
        let tracing = Instant::now();
        if is_due && !is_marching || is_marching && is_stale {
            self.latency.trace_begins(tracing);
            let settings = &self.choices.settings;
            stage.tracer.frame_begin(self.world.pair()?, settings)?;
            if self.begins_anew || self.under_way != *settings {
                // The time of these waves has not been measured yet.
                self.on_waves = 0.0;
            }
            self.under_way = settings.clone();
            self.begins_anew = false;
        }
        if stage.tracer.is_frame_pending() {
            stage.tracer.frame_advance(self.time_for_waves())?;
        }
        if let Some(spent) = stage.tracer.frame_marching_for() {
            self.on_waves = self.on_waves.max(spent);
            let share = stage.tracer.frame_share_marched().unwrap_or_default();
            self.part_traced(spent, share);
        }
        if stage.window.gl.context().is_software() {
            // On a graphics card, the card measures the time. The time is read when the frame is collected.
            times.waves += milliseconds(tracing);
        }
        Ok(())
    }

    /// Time available for waves in each frame, in milliseconds. If a whole frame of waves fits beside all other work,
    /// this is the time of that frame. Otherwise it is a fixed share of the frame time.
    fn time_for_waves(&self) -> f64 {
        let target = self.options.frame_milliseconds;
        let share = SHARE_OF_WAVES * target;
        let others: Vec<f64> = self
            .recorder
            .last(FRAMES_LOOKED_AT)
            .iter()
            .map(without_waves)
            .collect();
        if median(others) + self.on_waves <= target {
            // The predicted time of the waves, with a margin.
            return share.max(2.0 * self.on_waves);
        }
        share
    }

    /// Passes the panning of a finished frame of waves to the speakers.
    fn collect(
        &mut self,
        stage: &mut Stage,
        wait: bool,
        times: &mut FrameTimes,
    ) -> Result<(), DemoError> {
        let frame = if wait {
            stage.tracer.frame_wait()?
        } else {
            stage.tracer.frame_poll()?
        };
        // A frame of waves that belongs to a replaced scene is discarded.
        let Some(frame) = frame.filter(|_| !self.begins_anew) else {
            return Ok(());
        };
        self.speaker.set_panning(frame.panning);
        self.latency.read_back(Instant::now());
        let spent = &frame.milliseconds;
        self.on_waves = spent.initialise + spent.march + spent.pan + spent.read_back;
        if !stage.window.gl.context().is_software() {
            times.waves += spent.initialise + spent.march + spent.pan;
        }
        times.read_back += spent.read_back;
        self.frame_traced(self.on_waves);
        let seconds = self.seconds();
        self.recorder
            .heard(&frame, self.under_way.profile(), seconds);
        self.heard = Some(frame);
        Ok(())
    }

    fn follow_paths(&mut self, stage: &mut Stage) -> Result<(), DemoError> {
        let pair = self.world.pair()?;
        let chosen = &self.choices.settings;
        let iterations = chosen.iterations.min(PATH_ITERATIONS);
        let settings = chosen.clone().with_iterations(iterations);
        let is_due = self.recorder.frames.is_multiple_of(PATHS_EVERY);
        if is_due || self.paths.are_none() {
            self.paths.follow(&mut stage.path_tracer, pair, &settings)?;
        }
        Ok(())
    }

    fn panels(
        &mut self,
        stage: &mut Stage,
        size: [u32; 2],
        times: &mut FrameTimes,
    ) -> Result<(), DemoError> {
        let drawing = Instant::now();
        self.hear();
        self.follow_fields();
        self.message.take_if(|(_, at)| at.elapsed() > MESSAGE);
        let renderer = stage.window.gl.context().renderer().to_owned();
        let refusal = self.refusal().map(str::to_owned);
        let trying = self.trying();
        let hud = HudState {
            world: &self.world,
            files: self.files.all(),
            heard: self.heard.as_ref(),
            paths: self.paths.states(),
            times: self.recorder.last(FRAMES_SHOWN),
            target: self.options.frame_milliseconds,
            drawn: self.drawn,
            more_waves_asked: self.more_waves_asked(),
            fields: self.fields.cost(),
            window: size,
            latency: self.latency.parts(),
            sound: &self.sound,
            levels: self.speaker.levels(),
            played_pan: self.speaker.played_pan(),
            ears: self.in_full.is_some().then_some(&self.ears_status),
            gl_errors: self.gl_errors(),
            message: self
                .message
                .as_ref()
                .map(|(text, _)| text)
                .or(trying.as_ref())
                .map(String::as_str),
            refusal: refusal.as_deref(),
            mouse_looks: self.mouse_looks,
            renderer: &renderer,
        };
        let before = self.choices.settings.clone();
        let (chosen, plan) = (&mut self.choices, &mut self.plan);
        let mut actions = Vec::new();
        stage
            .window
            .draw_panels(|ui| actions.extend(overlay::draw(ui, &hud, chosen, plan)));
        times.overlay = milliseconds(drawing);
        // A click outside all panels is a click on the picture.
        let on_picture = |at: &[f64; 2]| !stage.window.is_panel_at(*at);
        let looks = std::mem::take(&mut self.presses).iter().any(on_picture);
        if let Err(error) = self.choices.settings.validate() {
            self.choices.settings = before;
            self.say(error.to_string());
        }
        for action in actions {
            self.latency.input(self.looked);
            self.act(action);
        }
        if looks {
            self.mouse_looks = stage.window.capture_mouse(true);
        }
        Ok(())
    }

    /// Passes the user's choices to the speakers, and reads the status of the speakers.
    fn hear(&mut self) {
        self.speaker.set_law(self.choices.law());
        self.speaker.set_volume(self.choices.loudness());
        self.listen();
        self.sound = self.speaker.status();
        self.latency
            .sound(self.sound.gains_to_buffer, self.sound.buffer_to_device);
    }

    /// Saves the requested screenshots.
    fn pictures(&mut self, stage: &Stage, size: [u32; 2], is_last: bool) -> Result<(), DemoError> {
        if let Some(path) = self.picture_wanted.take() {
            keep_picture(stage, size, &path)?;
            self.say(format!("saved {}", path.display()));
        }
        if let Some(path) = self.options.screenshot.as_ref().filter(|_| is_last) {
            keep_picture(stage, size, path)?;
            (self.options.announce)(&format!("saved {}", path.display()));
        }
        Ok(())
    }

    fn check(&mut self, stage: &Stage) {
        if self.checks_gl() && stage.window.gl.context().check("a frame").is_err() {
            self.recorder.gl_errors += 1;
        }
    }

    /// Chooses the picture's scale and, if requested, the number of waves for the following frames.
    fn adapt(&mut self, times: FrameTimes) {
        let every = self.choices.trace_every.max(1) as usize;
        let last = self.recorder.last(every);
        let mean_of = |of: fn(&FrameTimes) -> f64| mean(last.iter().map(of)).unwrap_or(0.0);
        let (work, others) = (mean_of(|t| t.work), mean_of(without_waves));
        let on_waves = self.on_waves;
        self.watch_waves();
        // Only one of the two is changed at a time, because each change invalidates the measurements of the other.
        if self.adapt_picture(work, times.picture) {
            self.wave_control.forget();
        } else if on_waves > 0.0 && self.adapt_waves(others, on_waves / every as f64) {
            self.scale_control.forget();
        }
    }

    /// Adapts the picture's scale; returns whether it changed.
    fn adapt_picture(&mut self, work: f64, on_picture: f64) -> bool {
        // A frame that did not redraw the picture does not measure its time.
        if !self.drawn.anew || self.choices.picture_scale.is_some() {
            return false;
        }
        let (before, target) = (self.scale_step, self.options.frame_milliseconds);
        self.scale_control.add(work, on_picture);
        self.scale_step = self.scale_control.choose(&scale_costs(), before, target);
        self.scale_step != before
    }
}

fn keep_picture(stage: &Stage, [width, height]: [u32; 2], path: &Path) -> Result<(), DemoError> {
    let mut pixels = stage.window.gl.read_rgba8(width, height)?;
    // Sets the alpha channel to opaque; otherwise the content behind the window would show through in the file.
    for pixel in pixels.chunks_exact_mut(4) {
        pixel[3] = 255;
    }
    let Some(picture) = RgbaImage::from_raw(width, height, pixels) else {
        return Ok(());
    };
    save_png(path, &picture).map_err(|error| DemoError::Failed(error.into()))
}
