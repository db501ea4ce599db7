//! The user's choices: all settings that keys and panels change, except the scene.

use super::DemoOptions;
use echomarch::audio::PanningLaw;
use echomarch::auralisation::Listen;
use echomarch::tracer::{Profile, Settings};
use echomarch_walk::Parts;
use std::collections::HashMap;

/// Properties of the player in full listening. If one of them changes, the player must be replaced.
#[derive(Clone, Debug, PartialEq)]
pub struct InFull {
    pub sound: String,
    pub sources: usize,
}

/// The scene and the settings on which the time of a frame of waves depends. A number of waves that adapts is not
/// included.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    pub scene: String,
    pub profile: Profile,
    pub iterations: u32,
    /// The number of waves, if it is fixed.
    pub fixed: Option<u32>,
}

impl Measured {
    /// Whether both have the same scene, profile and iterations. The number of waves may differ.
    pub fn is_of_march(&self, other: &Measured) -> bool {
        let march = |of: &Measured| (of.profile, of.iterations);
        self.scene == other.scene && march(self) == march(other)
    }
}

/// The current choices.
#[derive(Clone, Debug, PartialEq)]
pub struct Choices {
    /// The current settings of the waves.
    pub settings: Settings,
    /// The last settings of each other profile.
    others: HashMap<Profile, Settings>,
    /// Number of pictures per frame of waves.
    pub trace_every: u32,
    /// Whether the number of waves adapts to the frame time.
    pub adapt_waves: bool,
    /// The picture's resolution divided by the window's, along one side; `None` to adapt this ratio to the frame time.
    pub picture_scale: Option<f32>,
    /// The sound's name.
    pub sound: String,
    /// Loudness, 0 to 1.
    pub volume: f32,
    /// Whether the sound is muted.
    pub muted: bool,
    /// The listening mode chosen by the user, if any.
    pub chosen_listen: Option<Listen>,
    /// The parts of the sound in full listening that are heard.
    pub parts: Parts,
    /// The panning law chosen by the user, if any.
    pub chosen_law: Option<PanningLaw>,
    /// Whether the help is open.
    pub help: bool,
    /// Whether the panels are open.
    pub panels: bool,
    /// Whether the paths of waves are drawn in the plan.
    pub paths: bool,
    /// The size of texts and panels, relative to the size for the screen.
    pub text_size: f32,
    /// Whether the size is being changed; it applies afterwards.
    pub is_sizing: bool,
}

impl Choices {
    /// The initial choices.
    pub fn of(options: &DemoOptions) -> Choices {
        Choices {
            settings: options.settings.clone(),
            others: HashMap::new(),
            trace_every: options.trace_every.max(1),
            adapt_waves: options.adapt_waves,
            picture_scale: options.picture_scale,
            sound: options.sound.clone(),
            volume: options.volume,
            muted: false,
            chosen_listen: options.listen,
            parts: options.parts,
            chosen_law: options.law,
            help: options.help,
            panels: true,
            paths: true,
            text_size: options.text_size,
            is_sizing: false,
        }
    }

    /// Changes to another profile, and restores the constants that it last had. The numbers of waves and iterations and
    /// the directions stay.
    pub fn set_profile(&mut self, profile: Profile) {
        if profile == self.settings.profile() {
            return;
        }
        let known = self.others.remove(&profile);
        let old = &self.settings;
        let mut new = known.unwrap_or_else(|| Settings::new(profile));
        new.waves = old.waves;
        new.iterations = old.iterations;
        new.seed = old.seed;
        new.directions = old.directions;
        new.sum_on_gpu = old.sum_on_gpu;
        let old = std::mem::replace(&mut self.settings, new);
        self.others.insert(old.profile(), old);
    }

    /// Doubles the number of waves `steps` times, or halves it if `steps` is negative. The number then no longer adapts
    /// to the frame time.
    pub fn change_waves(&mut self, steps: i32) {
        self.adapt_waves = false;
        let waves = f64::from(self.settings.waves) * 2f64.powi(steps);
        self.settings.waves = (waves.round() as u32).clamp(64, Settings::MAX_WAVES / 4);
    }

    /// Changes the number of iterations by `more`.
    pub fn change_iterations(&mut self, more: i32) {
        let iterations = self.settings.iterations.saturating_add_signed(more);
        self.settings.iterations = iterations.clamp(1, Settings::MAX_ITERATIONS);
    }

    /// The panning law: the user's choice, or otherwise the default of the profile.
    pub fn law(&self) -> PanningLaw {
        let usual = PanningLaw::for_profile(self.settings.profile());
        self.chosen_law.unwrap_or(usual)
    }

    /// The listening mode: the user's choice, or otherwise the default of the profile. The profile `thesis` has only
    /// the balance.
    pub fn listen(&self) -> Listen {
        let profile = self.settings.profile();
        let usual = Listen::for_profile(profile);
        match profile {
            Profile::Thesis => usual,
            _ => self.chosen_listen.unwrap_or(usual),
        }
    }

    /// The effective loudness: 0 if the sound is muted.
    pub fn loudness(&self) -> f32 {
        if self.muted { 0.0 } else { self.volume }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use echomarch::tracer::{Algorithm, ThesisOptions};

    /// Protects a change of the profile: the new profile has its own constants, and the number of waves stays.
    #[test]
    fn a_profile_brings_its_constants_and_keeps_the_waves() {
        let mut choices = Choices::of(&DemoOptions::default());
        choices.settings.waves = 1000;
        choices.settings.seed = 5;
        choices.set_profile(Profile::Thesis);
        let expected = Settings::thesis().with_waves(1000).with_seed(5);
        assert_eq!(choices.settings, expected);
        let fine: Algorithm = ThesisOptions::default().with_min_distance(0.01).into();
        choices.settings.algorithm = fine;
        choices.change_waves(2);
        choices.set_profile(Profile::March);
        assert_eq!(choices.settings.waves, 4000);
        choices.set_profile(Profile::Thesis);
        assert_eq!(choices.settings.algorithm, fine);
        choices.change_iterations(-100);
        assert_eq!(
            (choices.settings.waves, choices.settings.iterations),
            (4000, 1)
        );
        assert!(choices.settings.validate().is_ok());
    }

    /// Protects the loudness: the panning law is the profile's default until the user chooses a law, which then stays.
    #[test]
    fn the_panning_law_is_the_profile_s_until_it_is_chosen() {
        let mut choices = Choices::of(&DemoOptions::default());
        assert_eq!(choices.law(), PanningLaw::ConstantPower);
        choices.set_profile(Profile::Thesis);
        assert_eq!(choices.law(), PanningLaw::Linear);
        choices.set_profile(Profile::March);
        assert_eq!(choices.law(), PanningLaw::ConstantPower);
        choices.chosen_law = Some(PanningLaw::Linear);
        choices.set_profile(Profile::Hybrid);
        assert_eq!(choices.law(), PanningLaw::Linear);
    }
}
