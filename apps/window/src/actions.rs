//! Performs the actions of keys and buttons.

use super::app::App;
use super::keys::Action;
use super::save::{free_file, save};
use echomarch::audio::PanningLaw;
use echomarch::auralisation::Listen;
use echomarch::tracer::Profile;
use echomarch_walk::Part;
use std::path::{Path, PathBuf};

impl App {
    /// Performs the given action.
    pub fn act(&mut self, action: Action) {
        match action {
            Action::Profile(profile) => {
                self.choices.set_profile(profile);
                self.say(format!("profile {profile}"));
            }
            Action::Waves(steps) => {
                // After a manual change, the number of waves no longer adapts to the frame time.
                self.choices.adapt_waves = false;
                self.choices.change_waves(steps);
                self.say(format!("{} waves", self.choices.settings.waves));
            }
            Action::Iterations(more) => {
                self.choices.change_iterations(more);
                self.say(format!("{} iterations", self.choices.settings.iterations));
            }
            Action::PickUp => self.pick_up(),
            Action::Pause => self.pause(),
            Action::StartOver => {
                self.world.start_over();
                self.say("back to the beginning");
            }
            Action::NextScene(steps) => self.next_scene(steps),
            Action::Scene(name) => self.change_scene(&name),
            Action::Set(name, value) => self.set(&name, value),
            Action::Save => self.save(),
            Action::Screenshot => {
                self.picture_wanted = free_file(Path::new(""), "echomarch", "png");
            }
            Action::Help => self.choices.help = !self.choices.help,
            Action::Panels => self.choices.panels = !self.choices.panels,
            Action::AdaptWaves => {
                self.choices.adapt_waves = !self.choices.adapt_waves;
                self.asked_waves = self.choices.settings.waves;
                self.say(match self.choices.adapt_waves {
                    true => "the number of waves follows the frame time",
                    false => "the number of waves stays",
                });
            }
            Action::FreeMouse if !self.mouse_looks => self.choices.help = false,
            Action::FreeMouse => self.look_by_mouse(false),
            Action::Quit => self.quit(),
            Action::Material(surface, name) => {
                self.world.set_material(surface, name);
            }
            Action::Sound(_)
            | Action::Listen
            | Action::Part(_)
            | Action::Law
            | Action::Mute
            | Action::Volume(_)
            | Action::Record => self.act_on_sound(action),
        }
    }

    fn act_on_sound(&mut self, action: Action) {
        if action == Action::Listen {
            return self.listen_otherwise();
        }
        let chosen = &mut self.choices;
        match action {
            Action::Sound(name) => match self.speaker.set_sound(&name) {
                Ok(()) => chosen.sound = name,
                Err(reason) => self.say(reason),
            },
            Action::Law => {
                chosen.chosen_law = Some(match chosen.law() {
                    PanningLaw::Linear => PanningLaw::ConstantPower,
                    PanningLaw::ConstantPower => PanningLaw::Linear,
                });
                let text = format!("panning law {}", chosen.law());
                self.say(text);
            }
            Action::Part(part) => self.switch(part),
            Action::Mute => chosen.muted = !chosen.muted,
            Action::Volume(steps) => {
                chosen.volume = (chosen.volume + 0.1 * steps as f32).clamp(0.0, 1.0);
                let text = format!("volume {:.0} %", 100.0 * chosen.volume);
                self.say(text);
            }
            Action::Record if self.sound.is_recording => self.record(None),
            Action::Record => {
                let path = free_file(Path::new(""), "echomarch", "wav");
                self.record(path);
            }
            _ => {}
        }
    }

    /// Switches between full listening and the balance.
    fn listen_otherwise(&mut self) {
        let chosen = &mut self.choices;
        chosen.chosen_listen = Some(match chosen.listen() {
            Listen::Full => Listen::Balance,
            Listen::Balance => Listen::Full,
        });
        let now = (chosen.listen(), chosen.settings.profile());
        self.say(match now {
            (_, Profile::Thesis) => "the thesis has only the balance: keys 2 and 3 have full sound",
            (Listen::Full, _) => "full sound: loudness, echoes, reverberation",
            (Listen::Balance, _) => "only the balance is heard",
        });
    }

    /// Switches a part of the sound in full listening.
    fn switch(&mut self, part: Part) {
        let chosen = &mut self.choices;
        let switch = chosen.parts.switch(part);
        *switch = !*switch;
        let state = if *switch { "on" } else { "off" };
        let heard = match chosen.listen() {
            Listen::Full => "",
            Listen::Balance => ": heard only in full sound (V)",
        };
        self.say(format!("{} {state}{heard}", part.name()));
    }

    fn pick_up(&mut self) {
        self.world.pick_up_or_put_down();
        self.say(if self.world.carrying {
            "carrying the source: F puts it down"
        } else {
            "the source is put down"
        });
    }

    fn pause(&mut self) {
        if !self.world.moves() {
            self.say("nothing moves by itself in this scene");
            return;
        }
        self.world.paused = !self.world.paused;
        self.say(match self.world.paused {
            true => "paused: P continues",
            false => "motion continues",
        });
    }

    fn save(&mut self) {
        let path = self.options.save.as_deref();
        let saved = save(&self.world, &self.choices.settings, path);
        match saved {
            Ok(path) => {
                let name = path.display().to_string();
                self.saved.push(name.clone());
                self.files.add(&name);
                let (call, is_exact) = self.call();
                (self.options.announce)(&format!("saved {name}"));
                (self.options.announce)(&call);
                self.say(if is_exact {
                    format!("saved {name}; the terminal shows the matching trace call")
                } else {
                    format!("saved {name}")
                });
            }
            Err(error) => self.say(error.to_string()),
        }
    }

    /// Begins a recording, or ends the one in progress.
    pub fn record(&mut self, path: Option<PathBuf>) {
        let told = match self.speaker.record(path.as_deref()) {
            Ok(lost) => match (path, lost) {
                (Some(path), _) if !self.sound.is_heard => format!(
                    "recording to {}: only silence, without a sound device",
                    path.display()
                ),
                (Some(path), _) => format!("recording to {}", path.display()),
                (None, 0) => "the recording is complete".to_owned(),
                (None, lost) => format!("the recording lacks {lost} frames: the disk was too slow"),
            },
            Err(reason) => {
                (self.options.announce)(&reason);
                reason
            }
        };
        self.say(told);
    }
}
