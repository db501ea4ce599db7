//! Connects full listening to the speakers, and decides when the player must be replaced.

use super::app::App;
use super::ears::Ears;
use super::state::InFull;
use echomarch::auralisation::Listen;
use echomarch::gl::ContextOptions;

impl App {
    /// Switches the speaker to the chosen listening mode.
    pub fn listen(&mut self) {
        if self.choices.listen() == Listen::Balance {
            if self.in_full.take().is_some() {
                self.speaker.play_balance();
            }
            // Before the first frame of waves, it is not known where the sound comes from.
            if self.heard.is_some() {
                self.speaker.begin();
            }
            return;
        }
        let ears = self
            .ears
            .get_or_insert_with(|| Ears::start(ContextOptions::default()));
        self.ears_status = ears.status();
        if let Some(reason) = self.ears_status.error.take() {
            self.choices.chosen_listen = Some(Listen::Balance);
            self.ears = None;
            self.tell(format!("only the balance is heard: {reason}"));
            return;
        }
        let scene = &self.world.now;
        ears.hear(scene, &self.choices.settings, self.choices.parts);
        let wanted = InFull {
            sound: self.choices.sound.clone(),
            sources: scene.sources.len(),
        };
        if self.in_full.as_ref() != Some(&wanted) {
            self.speaker.play_in_full(ears, scene, &wanted.sound);
            self.in_full = Some(wanted);
        }
    }
}
