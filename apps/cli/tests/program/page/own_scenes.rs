//! Texts of the user: they have their own entry in the list of scenes, and are not lost.

use super::{on_page, wait, write_text};
use crate::webdriver::Browser;

/// A floor, and a source at the given distance in front of the listener. The scene has no name.
fn floor(distance: u32) -> String {
    format!(
        "Scene(surfaces: [Surface(shape: Plane, position: (0, -2, 0))],\n\
         source: Source(position: (0, 0, -{distance})),\n\
         listener: Listener(position: (0, 0, 0), radius: 1))"
    )
}

fn choose(browser: &Browser, scene: &str) {
    let script = format!(
        "const list = document.getElementById('scene'); list.value = '{scene}'; \
         list.dispatchEvent(new Event('change')); return 0"
    );
    browser.run(&script);
}

fn wait_for_scene(browser: &Browser, name: &str, distance: u32) {
    let script = format!(
        "return document.getElementById('scene').value === '{name}' \
         && echomarch.page.sources()[2] === -{distance}"
    );
    wait(browser, &script);
}

/// Protects the work of users: a text stays in the list of scenes when another scene is chosen, also after the page was
/// loaded again. The text of a second scene does not replace it. Errors name it.
#[test]
#[ignore = "scripts/browser-test.sh builds the page first"]
fn own_texts_stay_in_the_list_of_scenes() {
    on_page(|stage, browser| {
        stage.load(browser, "#scene=corner&waves=1024");
        write_text(browser, &floor(5));
        wait_for_scene(browser, "your scene", 5);
        choose(browser, "corner");
        wait(
            browser,
            "return document.getElementById('text').value.includes('corner')",
        );
        // The built-in scene is chosen before its changed text is read.
        write_text(browser, &floor(7));
        choose(browser, "shoebox");
        choose(browser, "your scene");
        wait_for_scene(browser, "your scene", 5);
        choose(browser, "your scene 2");
        wait_for_scene(browser, "your scene 2", 7);
        choose(browser, "shoebox");
        wait(browser, "return location.hash.includes('scene=shoebox')");
        stage.load(browser, "#scene=corner&waves=1024");
        choose(browser, "your scene");
        wait_for_scene(browser, "your scene", 5);
        wait(browser, "return location.hash === echomarch.address()");
        // The link leads to the same entry, not to another one.
        let link = browser.run("return location.hash");
        stage.load(browser, link.as_str().unwrap());
        wait_for_scene(browser, "your scene", 5);
        let own = "return Array.from(document.getElementById('scene').options)\
                   .filter((option) => option.value.startsWith('your')).length";
        assert_eq!(browser.run(own), 2);
        // An invalid text is kept, and its error names it.
        write_text(browser, "Scene(\n  surfaces: 3");
        browser.wait_for("#error", "your scene:2:");
        choose(browser, "corner");
        wait(browser, "return document.getElementById('error').hidden");
        choose(browser, "your scene");
        browser.wait_for("#error", "your scene:2:");
        assert_eq!(
            browser.run("return document.getElementById('text').value"),
            "Scene(\n  surfaces: 3"
        );
    });
}

/// Protects the list of scenes from entries that are a built-in scene: a change that is undone leaves none.
#[test]
#[ignore = "scripts/browser-test.sh builds the page first"]
fn a_change_that_is_undone_leaves_the_scene() {
    on_page(|stage, browser| {
        stage.load(browser, "#scene=corner&waves=1024");
        let text = browser.run("return document.getElementById('text').value");
        let text = text.as_str().unwrap();
        let named = "return document.getElementById('scene').value";
        write_text(browser, &format!("{text} "));
        assert_eq!(browser.run(named), "your scene");
        write_text(browser, text);
        assert_eq!(browser.run(named), "corner");
        assert_eq!(
            browser.run("return echomarch.state.text"),
            serde_json::Value::Null
        );
    });
}
