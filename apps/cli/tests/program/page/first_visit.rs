//! A first visit to the page: a scene that stands still, the sound after a click, an error beside the text,
//! fingers instead of keys.

use super::{FLAGS, Stage, on_page, wait, write_text};

/// Protects a first visit: the scene stands still until P is pressed, one sentence says what the page is, and the focus
/// is visible. A link without this choice moves.
#[test]
#[ignore = "scripts/browser-test.sh builds the page first"]
fn the_first_scene_stands_still() {
    const COUNT: &str = "
        window.pictures = 0;
        const count = () => { window.pictures += 1; requestAnimationFrame(count); };
        requestAnimationFrame(count);
        return 0";
    on_page(|stage, browser| {
        stage.load(browser, "");
        browser.run(COUNT);
        wait(browser, "return window.pictures > 5");
        assert_eq!(browser.run("return echomarch.page.seconds()"), 0.0);
        assert!(browser.text("#about").contains("hear it"));
        assert!(browser.text("#about").contains("text editor"));
        wait(browser, "return echomarch.address().includes('motion=off')");
        browser.click("h1");
        browser.press("p");
        wait(browser, "return echomarch.page.seconds() > 0");
        wait(browser, "return echomarch.address().includes('motion=on')");
        browser.press("\u{e004}");
        let outlined = "return getComputedStyle(document.activeElement).outlineStyle";
        assert_eq!(browser.run(outlined), "solid");
        stage.load(browser, "#scene=open-field&waves=1024");
        wait(browser, "return echomarch.page.seconds() > 0");
    });
}

/// Protects the first second of sound: after the click the button says that the sound is computed until it is heard, and
/// the first levels that are played are silence.
#[test]
#[ignore = "scripts/browser-test.sh builds the page first"]
fn play_says_that_the_sound_is_computed_until_it_is_heard() {
    const WATCH: &str = "
        window.said = [];
        window.played = [];
        const watch = () => {
            const text = document.getElementById('play').textContent;
            if (window.said.at(-1) !== text) window.said.push(text);
            const level = Math.max(...echomarch.levels());
            if (window.played.at(-1) !== level) window.played.push(level);
            setTimeout(watch, 5);
        };
        watch();
        return 0";
    on_page(|stage, browser| {
        stage.load(browser, "#scene=corner&waves=65536&sound=noise");
        browser.run(WATCH);
        browser.click("#play");
        wait(
            browser,
            "return echomarch.isHeard() && echomarch.levels()[0] > -60",
        );
        browser.wait_for("#play", "Stop sound");
        let said = browser.run("return window.said.join('|')");
        assert_eq!(said, "Play sound|Computing…|Stop sound");
        let first = browser.run("return window.played[0]");
        assert_eq!(first.as_f64(), Some(-120.0));
        browser.wait_for("#limiter", "rests");
    });
}

/// Protects a first visit, at which shaders are compiled for seconds: the page says so until its first picture is drawn,
/// and until the first response is traced.
#[test]
#[ignore = "scripts/browser-test.sh builds the page first"]
fn the_page_says_that_it_compiles_shaders() {
    const WATCH: &str = "
        window.said = [];
        new MutationObserver(() => {
            for (const id of ['starting', 'compiling']) {
                const text = document.getElementById(id)?.textContent;
                if (text && !window.said.includes(text)) window.said.push(text);
            }
        }).observe(document, { childList: true, subtree: true });";
    on_page(|stage, browser| {
        browser.before_load(WATCH);
        stage.load(browser, "#scene=corner&waves=1024");
        browser.click("#play");
        wait(browser, "return echomarch.isHeard()");
        let said = browser.run("return window.said.join('|')");
        println!("{said}");
        for part in ["Loading …", "Compiling shaders …"] {
            assert!(said.as_str().unwrap().contains(part), "{said}");
        }
        wait(
            browser,
            "return ['starting', 'compiling'].every((id) => document.getElementById(id).hidden)",
        );
    });
}

/// Protects users who write a scene: the error is beside the text, names the line, and the line is marked.
#[test]
#[ignore = "scripts/browser-test.sh builds the page first"]
fn an_error_is_shown_beside_the_text_with_its_line() {
    on_page(|stage, browser| {
        stage.load(browser, "#scene=corner&waves=1024");
        write_text(browser, "Scene(\n    surfaces: [Surface(shape: Plain)],\n)");
        browser.wait_for("#error", "line 2: surfaces: [Surface(shape: Plain)]");
        assert_eq!(browser.text("#lines .bad"), "2");
        // Text, error and levels are visible together.
        let seen = "return ['error', 'lines', 'left'].every((id) => {
            const box = document.getElementById(id).getBoundingClientRect();
            return box.bottom > 0 && box.top < innerHeight;
        })";
        wait(browser, seen);
        // A long line is wrapped, and so is the place of its number.
        write_text(browser, &format!("// {}\n\n", "long ".repeat(100)));
        let is_wrapped = "const text = document.getElementById('text'); \
            const [long, short] = document.querySelectorAll('#lines div'); \
            return text.scrollWidth <= text.clientWidth && long.offsetHeight > 2 * short.offsetHeight \
            && document.getElementById('lines').scrollHeight === text.scrollHeight";
        wait(browser, is_wrapped);
    });
}

/// Protects a walk during the reading of a changed text: the place stays, even if the scene gets another name. A key that
/// is released before the next picture walks too. Warnings about the scene are beside its text.
#[test]
#[ignore = "scripts/browser-test.sh builds the page first"]
fn a_walk_after_an_edit_stays() {
    const ROOMS: &str = "Scene(name: \"two halls\", surfaces: [Surface(shape: Rooms(of: [
        (name: \"hall\", from: (-30, -2, -30), to: (30, 9, 30)),
        (name: \"closed\", from: (40, 0, 0), to: (50, 3, 9)),
    ]))],
    source: Source(position: (0, 0, -5)), listener: Listener(position: (0, 0, 5), radius: 0.3))";
    const PRESS: &str = "for (const kind of ['keydown', 'keyup']) {
        document.body.dispatchEvent(new KeyboardEvent(kind, { code: 'KeyD', bubbles: true }));
    }
    return 0";
    on_page(|stage, browser| {
        stage.load(browser, "#scene=open-pillars&waves=1024&motion=off");
        browser.run("document.getElementById('editor').open = true; return 0");
        let start = browser.run("return echomarch.page.listener()[0]");
        write_text(browser, ROOMS);
        browser.run(PRESS);
        wait(browser, "return echomarch.state.scene === 'two halls'");
        wait(
            browser,
            &format!(
                "return echomarch.page.has_walked() && echomarch.page.listener()[0] > {start}"
            ),
        );
        browser.wait_for("#warnings", "closed has no way to the first box");
        // The plan shows both boxes.
        wait(browser, "return echomarch.page.plan().bounds[2] > 50");
    });
}

/// A hall with two named sources side by side, and two listeners.
const NAMED: &str = "Scene(
    surfaces: [Surface(shape: Room(size: (20, 6, 20)))],
    sources: [Source(name: \"flute\", position: (0, 0, -5)), Source(name: \"drum\", position: (0.4, 0, -5))],
    listeners: [Listener(name: \"you\", position: (0, 0, 5), radius: 0.3),
        Listener(name: \"stalls\", position: (1, 0, 5), radius: 0.3)])";

/// Protects the plan: sources and listeners are named, and no two names overlap.
#[test]
#[ignore = "scripts/browser-test.sh builds the page first"]
fn the_plan_names_sources_and_listeners() {
    on_page(|stage, browser| {
        let link = format!("#waves=1024&text={}", super::escaped(NAMED));
        stage.load(browser, &link);
        wait(browser, "return echomarch.named()?.length === 4");
        let names = browser.run("return echomarch.named().map(({ name }) => name).sort().join()");
        assert_eq!(names, "drum,flute,stalls,you");
        let overlap = "return echomarch.named().some((a, i) => echomarch.named().some((b, j) => i < j &&
            a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height))";
        assert_eq!(browser.run(overlap), false);
    });
}

/// Protects visitors without a keyboard: a hint names the gestures, a drag turns the gaze, the stick walks, and buttons do
/// what the keys F, P and Home do.
#[test]
#[ignore = "scripts/browser-test.sh builds the page first"]
fn fingers_look_and_walk() {
    let stage = Stage::new();
    let browser = stage.open_with(&FLAGS);
    browser.emulate_touch();
    stage.load(&browser, "#scene=open-field&waves=1024&motion=off");
    assert!(browser.text("#touch").contains("push the stick"));
    let listener = || browser.run("return Array.from(echomarch.page.listener())");
    let start = listener();
    browser.touch("#picture", 80, 0);
    browser.lift();
    // The hint goes after the first drag.
    wait(&browser, "return document.getElementById('touch').hidden");
    let turned = listener();
    let yaw = |of: &serde_json::Value| of[3].as_f64().unwrap();
    assert!(yaw(&turned) < yaw(&start) - 0.2, "{start} {turned}");
    assert_eq!(turned[2], start[2]);
    browser.touch("#stick", 0, -50);
    let before = start[2].as_f64().unwrap();
    wait(
        &browser,
        &format!("return echomarch.page.listener()[2] < {before} - 0.3"),
    );
    browser.lift();
    browser.click("#pause");
    wait(&browser, "return echomarch.page.seconds() > 0");
    wait(
        &browser,
        "return document.getElementById('pause').textContent === 'pause'",
    );
    browser.click("#carry");
    wait(&browser, "return echomarch.page.placed_source().length > 0");
    browser.click("#restart");
    wait(
        &browser,
        "return !echomarch.page.has_walked() && echomarch.page.placed_source().length === 0",
    );
    assert_eq!(browser.errors(), Vec::<String>::new());
}
