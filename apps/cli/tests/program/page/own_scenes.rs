//! Texts of the user: they have their own entry in the list of scenes, and are not lost.

use super::{escaped, on_page, wait, write_text};
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

/// Protects links: a link opens its scene with the name that the scene has in its text, or had in the list, and the text of
/// a built-in scene as this scene. A button copies the link.
#[test]
#[ignore = "scripts/browser-test.sh builds the page first"]
fn a_link_keeps_the_name_of_its_scene() {
    let named =
        |name: &str, distance| floor(distance).replacen('(', &format!("(name: \"{name}\", "), 1);
    on_page(|stage, browser| {
        let link = format!("#waves=1024&text={}", escaped(&named("yard", 5)));
        stage.load(browser, &link);
        wait_for_scene(browser, "yard", 5);
        write_text(browser, &named("garden", 7));
        wait_for_scene(browser, "garden", 7);
        wait(
            browser,
            "Object.defineProperty(navigator, 'clipboard', { value: { writeText: (text) => { window.copied = text; } } }); \
             document.getElementById('copy').click(); return true",
        );
        browser.wait_for("#copy", "Link copied");
        let copied = browser.run("return new URL(window.copied).hash");
        browser.run("sessionStorage.clear(); return 0");
        stage.load(browser, copied.as_str().unwrap());
        wait_for_scene(browser, "garden", 7);
        let link = format!("#scene=porch&waves=1024&text={}", escaped(&floor(6)));
        stage.load(browser, &link);
        wait_for_scene(browser, "porch", 6);
        wait(
            browser,
            "return echomarch.address().includes('scene=porch')",
        );
        choose(browser, "corner");
        let text = browser.run("return document.getElementById('text').value");
        let link = format!(
            "#scene=porch&waves=1024&text={}",
            escaped(text.as_str().unwrap())
        );
        stage.load(browser, &link);
        let named = "return document.getElementById('scene').value";
        assert_eq!(browser.run(named), "corner");
    });
}
