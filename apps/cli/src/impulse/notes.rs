//! Notes on responses, and on scenes without absorption, in the program's output.

use super::super::options::Common;
use super::pairs::NamedPair;
use echomarch::response::{Note, Response};
use echomarch::scene::{Pair, Scene, Warning};

/// The note on a scene in which nothing absorbs. The note is printed before tracing, which takes long if sound does not
/// decay.
const NOTHING_ABSORBS: &str = "note: no surface absorbs in this scene: where sound cannot leave it, it does not decay, and figures will be missing; give its surfaces a material (docs/scene-format.md)";

/// The note on a scene in which only the air absorbs.
const ONLY_AIR_ABSORBS: &str = "note: no surface absorbs in this scene, only the air does, so the air alone limits the decays; give its surfaces a material (docs/scene-format.md)";

/// Returns the notes on a response for the JSON output. The notes include the one on surfaces without a material, which
/// the text output prints when the scene is loaded.
pub fn texts(pair: Pair, response: &Response) -> Vec<String> {
    let notes = response.notes(pair).into_iter().map(|n| n.to_string());
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
        for note in response.notes(pair.pair) {
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
        common.note(&format!("{kind}: {of}: {note}"));
    }
}
