//! The table of keys. The window uses it for its actions and for the help.

use echomarch::tracer::Profile;
use echomarch_walk::{MoveInput, Part};
use std::collections::HashSet;
use winit::keyboard::KeyCode;

/// An action requested by a key or by a button of the panels.
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    /// Change the algorithm.
    Profile(Profile),
    /// Double (1) or halve (−1) the number of waves.
    Waves(i32),
    /// Raise or lower the number of iterations.
    Iterations(i32),
    /// Pick up the source, or put it down.
    PickUp,
    /// Pause all motion in the scene, or continue it.
    Pause,
    /// Reset the scene to its initial state.
    StartOver,
    /// Move by this number of steps in the list of built-in scenes and files; a negative number moves backwards.
    NextScene(i32),
    /// Open this scene.
    Scene(String),
    /// Set this named value of the scene, in the unit of its file.
    Set(String, f32),
    /// Play this sound.
    Sound(String),
    /// Switch between full listening and the balance.
    Listen,
    /// Switch a part of the sound in full listening off or on.
    Part(Part),
    /// Set the material of a surface, which is given by its index from 0. A surface without a material reflects all
    /// energy.
    Material(usize, Option<String>),
    /// Change the panning law.
    Law,
    /// Mute or unmute the sound.
    Mute,
    /// Raise (1) or lower (−1) the volume.
    Volume(i32),
    /// Begin or end a recording.
    Record,
    /// Save the scene.
    Save,
    /// Save a picture of the window.
    Screenshot,
    /// Open or close the help.
    Help,
    /// Open or close the panels.
    Panels,
    /// Start or stop adapting the number of waves to the frame time.
    AdaptWaves,
    /// Release the mouse.
    FreeMouse,
    /// Close the window.
    Quit,
}

/// The keys as listed in the help: the key and its effect.
pub const HELP: [(&str, &[(&str, &str)]); 3] = [
    (
        "Walk",
        &[
            ("W A S D  Q E", "walk, down, up, run with Shift"),
            ("Arrow keys", "turn and look"),
            ("Click", "look with the mouse; Esc frees it"),
            ("F", "pick up the source, put it down"),
            ("P  Space", "pause, continue"),
            ("Backspace  Home", "back to the beginning"),
        ],
    ),
    (
        "Hear what changes",
        &[
            ("1  2  3", "thesis, march, hybrid"),
            ("[  ]  PgDn PgUp", "half, twice the waves"),
            (",  .", "fewer, more iterations"),
            ("T", "number of waves follows frame time"),
            ("N  B", "next, previous scene"),
            ("Drop a file", "that scene, or that sound"),
            ("V", "full sound, or balance only"),
            ("L", "panning law of the balance"),
            ("4  5  6  7  8", "parts of the full sound off, on"),
            ("M  −  +", "mute, softer, louder"),
        ],
    ),
    (
        "Keep",
        &[
            ("F5  Ctrl+S", "save the scene, print the call"),
            ("F9", "record the sound, stop"),
            ("F12", "picture of the window"),
            ("Tab", "show or hide the panels"),
            ("F1  H", "this help"),
            ("Ctrl+Q", "quit"),
        ],
    ),
];

/// The hint line at the lower edge of the window.
pub const HINT: &str =
    "WASD walk    click look    F carry source    1 2 3 profile    F5 save    F1 help";

/// The action of a key press.
pub fn action(key: KeyCode, control: bool) -> Option<Action> {
    if control {
        return match key {
            // Ctrl+W does not quit, because W walks.
            KeyCode::KeyQ => Some(Action::Quit),
            KeyCode::KeyS => Some(Action::Save),
            _ => None,
        };
    }
    Some(match key {
        KeyCode::Digit1 | KeyCode::Numpad1 => Action::Profile(Profile::Thesis),
        KeyCode::Digit2 | KeyCode::Numpad2 => Action::Profile(Profile::March),
        KeyCode::Digit3 | KeyCode::Numpad3 => Action::Profile(Profile::Hybrid),
        KeyCode::Digit4 | KeyCode::Numpad4 => Action::Part(Part::Diffraction),
        KeyCode::Digit5 | KeyCode::Numpad5 => Action::Part(Part::Transmission),
        KeyCode::Digit6 | KeyCode::Numpad6 => Action::Part(Part::Mirrored),
        KeyCode::Digit7 | KeyCode::Numpad7 => Action::Part(Part::Late),
        KeyCode::Digit8 | KeyCode::Numpad8 => Action::Part(Part::LeastLevel),
        KeyCode::BracketLeft | KeyCode::PageDown => Action::Waves(-1),
        KeyCode::BracketRight | KeyCode::PageUp => Action::Waves(1),
        KeyCode::Comma => Action::Iterations(-1),
        KeyCode::Period => Action::Iterations(1),
        KeyCode::KeyF => Action::PickUp,
        KeyCode::KeyP | KeyCode::Space => Action::Pause,
        KeyCode::Backspace | KeyCode::Home => Action::StartOver,
        KeyCode::KeyN => Action::NextScene(1),
        KeyCode::KeyB => Action::NextScene(-1),
        KeyCode::KeyV => Action::Listen,
        KeyCode::KeyL => Action::Law,
        KeyCode::KeyM => Action::Mute,
        KeyCode::Minus | KeyCode::NumpadSubtract => Action::Volume(-1),
        KeyCode::Equal | KeyCode::NumpadAdd => Action::Volume(1),
        KeyCode::KeyT => Action::AdaptWaves,
        KeyCode::F5 => Action::Save,
        KeyCode::F9 => Action::Record,
        KeyCode::F12 => Action::Screenshot,
        KeyCode::F1 | KeyCode::KeyH => Action::Help,
        KeyCode::Tab => Action::Panels,
        KeyCode::Escape => Action::FreeMouse,
        _ => return None,
    })
}

/// The keys that are held down.
#[derive(Clone, Debug, Default)]
pub struct PressedKeys(HashSet<KeyCode>);

impl PressedKeys {
    /// Handles a key press. A key pressed while Control is held is a command and is never treated as held, whichever of
    /// the two keys is released first.
    pub fn press(&mut self, key: KeyCode) {
        if !self.control() {
            self.0.insert(key);
        }
    }

    /// Whether a key is held down.
    pub fn is_down(&self, key: KeyCode) -> bool {
        self.0.contains(&key)
    }

    /// Handles a key release.
    pub fn release(&mut self, key: KeyCode) {
        self.0.remove(&key);
    }

    /// Releases all keys, because the window receives no release events while another window has the keyboard focus.
    pub fn clear(&mut self) {
        self.0.clear();
    }

    /// Whether either of two keys is down.
    fn either(&self, keys: [KeyCode; 2]) -> bool {
        keys.iter().any(|key| self.0.contains(key))
    }

    /// Whether a control key is down.
    pub fn control(&self) -> bool {
        self.either([KeyCode::ControlLeft, KeyCode::ControlRight])
    }

    /// The movement requested by the held keys.
    pub fn input(&self) -> MoveInput {
        if self.control() {
            return MoveInput::default();
        }
        let axis = |more: KeyCode, less: KeyCode| {
            f32::from(self.0.contains(&more)) - f32::from(self.0.contains(&less))
        };
        MoveInput {
            forward: axis(KeyCode::KeyW, KeyCode::KeyS),
            right: axis(KeyCode::KeyD, KeyCode::KeyA),
            up: axis(KeyCode::KeyE, KeyCode::KeyQ),
            turn: axis(KeyCode::ArrowRight, KeyCode::ArrowLeft),
            tilt: axis(KeyCode::ArrowUp, KeyCode::ArrowDown),
            run: self.either([KeyCode::ShiftLeft, KeyCode::ShiftRight]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects saving with Ctrl+S: it does not walk backwards. Also checks that opposite keys cancel each other.
    #[test]
    fn held_keys_make_a_wish() {
        let mut pressed = PressedKeys::default();
        pressed.press(KeyCode::KeyS);
        pressed.press(KeyCode::ArrowLeft);
        assert_eq!(
            (pressed.input().forward, pressed.input().turn),
            (-1.0, -1.0)
        );
        pressed.press(KeyCode::KeyW);
        assert_eq!(pressed.input().forward, 0.0);
        pressed.press(KeyCode::ControlLeft);
        assert!(pressed.input().is_rest());
        assert_eq!(action(KeyCode::KeyS, pressed.control()), Some(Action::Save));
        pressed.press(KeyCode::KeyD);
        pressed.release(KeyCode::ControlLeft);
        assert_eq!(pressed.input().right, 0.0);
        pressed.clear();
        assert!(pressed.input().is_rest() && !pressed.control());
    }

    /// Protects the keys 4 to 8: each part has one of them, in the order of all parts. The help lists the keys in one
    /// line, and the panel has the number of each key before the name of its part.
    #[test]
    fn each_part_has_a_key() {
        let keys = [
            KeyCode::Digit4,
            KeyCode::Digit5,
            KeyCode::Digit6,
            KeyCode::Digit7,
            KeyCode::Digit8,
        ];
        let actions = keys.map(|key| action(key, false));
        assert_eq!(actions, Part::ALL.map(|part| Some(Action::Part(part))));
        let mut listed = HELP.iter().flat_map(|(_, keys)| keys.iter());
        let is_line = |(keys, _): &(&str, &str)| {
            ["4", "5", "6", "7", "8"]
                .iter()
                .all(|key| keys.contains(key))
        };
        assert!(listed.any(is_line));
    }

    /// Protects the keys 1, 2 and 3: the help lists the profiles in the order of these keys.
    #[test]
    fn the_help_names_the_profiles_in_the_order_of_their_keys() {
        let keys = [KeyCode::Digit1, KeyCode::Digit2, KeyCode::Digit3];
        let names = keys.map(|key| match action(key, false) {
            Some(Action::Profile(profile)) => profile.to_string(),
            other => panic!("{other:?}"),
        });
        let listed = HELP.iter().flat_map(|(_, keys)| keys.iter());
        let line = listed.clone().find(|(keys, _)| keys.contains('1')).unwrap();
        assert_eq!(line.1, names.join(", "));
        assert!(HINT.contains("F1") && HINT.contains("F5") && HINT.contains("WASD"));
    }
}
