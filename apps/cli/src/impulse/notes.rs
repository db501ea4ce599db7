//! Notes on missing or inexact figures of a response, with remedies.

use super::super::options::Common;
use super::flutter;
use super::missing;
use super::pairs::NamedPair;
use echomarch::response::{HeardPath, Response};
use echomarch::scene::{Pair, Scene, Surface, Warning};

/// The note on a scene in which nothing absorbs. The note is printed before tracing, which takes long if sound does not
/// decay.
const NOTHING_ABSORBS: &str = "note: no surface absorbs in this scene: where sound cannot leave it, it does not decay, and figures will be missing; give its surfaces a material (docs/scene-format.md)";

/// The note on a scene in which only the air absorbs.
const ONLY_AIR_ABSORBS: &str = "note: no surface absorbs in this scene, only the air does, so the air alone limits the decays; give its surfaces a material (docs/scene-format.md)";

/// One sentence about a response.
#[derive(Clone, Debug, PartialEq)]
struct Note {
    /// Whether the note is about inexact figures.
    is_warning: bool,
    text: String,
}

/// Returns the notes on a response for the JSON output. The notes include the one on surfaces without a material, which
/// the text output prints when the scene is loaded.
pub fn texts(pair: Pair, response: &Response) -> Vec<String> {
    let notes = all(pair, response).into_iter().map(|note| note.text);
    let of_scene = pair.scene().warnings().into_iter();
    let of_decay = of_scene.filter(|warning| matches!(warning, Warning::NoMaterial { .. }));
    notes.chain(of_decay.map(|w| w.to_string())).collect()
}

/// Prints a note before tracing if no decay can be estimated.
pub fn tell_first(common: &Common, scene: &Scene) {
    if !scene.has_materials() {
        common.note(match scene.air {
            None => NOTHING_ABSORBS,
            Some(_) => ONLY_AIR_ABSORBS,
        });
    }
}

/// Prints the notes on the responses. Each note is printed once, with the pairs to which it applies.
pub fn tell(common: &Common, heard: &[(NamedPair, Response)]) {
    let mut told: Vec<(Note, Vec<String>)> = Vec::new();
    for (pair, response) in heard {
        let name = format!("source {}, listener {}", pair.source, pair.listener);
        for note in all(pair.pair, response) {
            match told.iter_mut().find(|(known, _)| *known == note) {
                Some((_, pairs)) => pairs.push(name.clone()),
                None => told.push((note, vec![name.clone()])),
            }
        }
    }
    for (note, pairs) in told {
        let kind = if note.is_warning { "warning" } else { "note" };
        let of = match pairs.len() > 1 && pairs.len() == heard.len() {
            true => "all pairs".to_owned(),
            false => pairs.join("; "),
        };
        common.note(&format!("{kind}: {of}: {}", note.text));
    }
}

fn all(pair: Pair, response: &Response) -> Vec<Note> {
    let scene = pair.scene();
    let note = |text: String| Note {
        is_warning: false,
        text,
    };
    let mut notes = warnings(response);
    if response.counts.arrivals == 0 && response.paths.is_empty() {
        notes.push(note("nothing arrives".to_owned()));
    }
    if response.left_out > 0 {
        notes.push(note(format!(
            "{:.1} % of the energy arrived on paths of few reflections that were not searched, because there are too many: this energy is in the late part",
            100.0 * response.left_out_share
        )));
    }
    if response.search_left_out_share > 0.0 {
        notes.push(note(format!(
            "{:.0} % of the directions were not searched for exact paths over planes, because too many surfaces hide each other: weak paths may be missing",
            (100.0 * response.search_left_out_share).max(1.0)
        )));
    }
    if response.direct().is_some_and(|direct| direct.path.is_focus) {
        notes.push(note(format!(
            "the source is so close that the size of the listener's sphere ({} m) limits the direct sound: its level is that at the sphere, not that at a point",
            pair.listener().radius
        )));
    }
    let gathered = |heard: &HeardPath| heard.path.is_focus && !heard.is_direct();
    if response.paths.iter().any(gathered) {
        notes.push(note(
            "sound is focused: after repeated focusing, rounding determines the paths, and ± of late decays does not include that error".to_owned(),
        ));
    }
    let gathers = |surface: &Surface| surface.shape.gathers_sound();
    if scene.surfaces.iter().any(gathers) {
        notes.push(note(
            "a concave surface focuses sound: if the energy of exact paths at the listener's centre differs from the energy that reaches its sphere, ± includes the difference; for reflections beyond --order the difference is unknown, so compare with a larger --order and a smaller listener".to_owned(),
        ));
    }
    notes.extend(missing::reasons(scene, response).into_iter().map(note));
    notes.extend(flutter::notes(scene, response).into_iter().map(note));
    notes
}

fn warnings(response: &Response) -> Vec<Note> {
    let counts = &response.counts;
    let mut texts = Vec::new();
    if counts.step_limit_reached > 0 {
        texts.push(format!(
            "waves that are dead because their march reached the step limit: {}",
            counts.step_limit_reached
        ));
    }
    if counts.cut_off > 0 {
        let what_of_it = match response.followed_s {
            Some(seconds) => format!(
                "after {seconds:.2} s the response is too weak, and figures are computed from the part before"
            ),
            None => "their energy is negligible".to_owned(),
        };
        texts.push(format!(
            "tracing of {} waves stopped after {} iterations: {what_of_it}",
            counts.cut_off, counts.iterations
        ));
    }
    let warning = |text: String| Note {
        is_warning: true,
        text,
    };
    texts.into_iter().map(warning).collect()
}
