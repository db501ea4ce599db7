//! The page of `apps/page` in a headless browser whose WebGL is a software renderer: counts compared with the
//! program's, sound, keys, links, and invalid texts.
//!
//! `scripts/browser-test.sh` builds the page and runs these tests. Otherwise they are skipped, because the build needs
//! another compiler target.

mod first_visit;
mod own_scenes;
mod sound;

use crate::common::cli::{argument, json};
use crate::webdriver::{Browser, Driver};
use serde_json::Value;
use std::fmt::Write as _;
use std::io::{BufRead, BufReader};
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Maximum wait before a test fails. The limit exceeds the time that any machine needs.
const TIMEOUT: Duration = Duration::from_secs(300);

/// Maximum difference of a count of 65,536 waves between two renderers. The rounding of two renderers differs, so that
/// about 120 waves (in `cave`, docs/portability.md) end elsewhere. Gains and losses of a count nearly cancel: √120 is
/// 11.
const MAY_DIFFER: u64 = 16;

/// SwiftShader, which Chromium includes, and a clock instead of a sound card. The sound may start without a click.
const FLAGS: [&str; 3] = [
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--autoplay-policy=no-user-gesture-required",
];

/// A file server for the page, and a WebDriver that opens browsers.
struct Stage {
    // Fields are dropped in declaration order.
    server: Child,
    driver: Driver,
    address: String,
    folder: TempDir,
}

impl Drop for Stage {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

impl Stage {
    fn new() -> Stage {
        let page = std::env::var_os("ECHOMARCH_PAGE")
            .map(PathBuf::from)
            .expect("ECHOMARCH_PAGE names the folder that scripts/browser.sh made");
        let mut server = Command::new("python3")
            .args([
                "-u",
                "-m",
                "http.server",
                "0",
                "--bind",
                "127.0.0.1",
                "--directory",
            ])
            .arg(&page)
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("no python3");
        let mut line = String::new();
        let out = server.stdout.take().unwrap();
        BufReader::new(out).read_line(&mut line).unwrap();
        let port = line
            .split_whitespace()
            .nth(5)
            .expect("the server prints its port");
        Stage {
            address: format!("http://127.0.0.1:{port}/"),
            server,
            driver: Driver::start(),
            folder: tempfile::tempdir().unwrap(),
        }
    }

    /// Opens a browser with these flags.
    fn open_with(&self, flags: &[&str]) -> Browser<'_> {
        let folder = self.folder.path();
        self.driver.open_with(folder, folder, flags)
    }

    /// Reloads the page with a link, and waits for its first frame.
    fn load(&self, browser: &Browser, link: &str) {
        browser.visit("about:blank");
        browser.visit(&format!("{}{link}", self.address));
        wait(browser, "return window.echomarch?.page.frame().length > 0");
    }
}

/// Runs a test on the page in a browser that supports it. The console must contain no errors.
fn on_page(test: impl FnOnce(&Stage, &Browser)) {
    let stage = Stage::new();
    let browser = stage.open_with(&FLAGS);
    test(&stage, &browser);
    assert_eq!(browser.errors(), Vec::<String>::new());
}

/// Waits until `script`, the body of a function, returns true. Returns the time that it took.
fn wait(browser: &Browser, script: &str) -> Duration {
    let began = Instant::now();
    while browser.run(script) != Value::Bool(true) {
        let shown = browser.run("return document.body?.innerText ?? ''");
        assert!(
            began.elapsed() < TIMEOUT,
            "never: {script}; the page says {shown}"
        );
        std::thread::sleep(Duration::from_millis(50));
    }
    began.elapsed()
}

/// Returns the counts of waves at the listener, dead, and travelling.
fn counts_of_page(browser: &Browser) -> [u64; 3] {
    let frame = browser.run("return Array.from(echomarch.page.frame())");
    [0, 1, 2].map(|index| frame[index].as_f64().unwrap() as u64)
}

fn counts_of_program(scene: &str) -> [u64; 3] {
    let told = json(&["trace", scene, "--waves", "65536", "--iterations", "8"]);
    ["listener_hits", "dead", "travelling"].map(|name| told[name].as_u64().unwrap())
}

/// Returns the selected values of the page's controls.
fn chosen(browser: &Browser) -> Value {
    browser.run(
        "return ['scene', 'profile', 'waves', 'iterations', 'listen', 'sound', 'volume']\
         .map((id) => document.getElementById(id).value).join()",
    )
}

/// Replaces the scene's text as if a user had edited it.
fn write_text(browser: &Browser, text: &str) {
    let script = format!(
        "const area = document.getElementById('text'); area.value = {}; \
         area.dispatchEvent(new Event('input')); return 0",
        Value::from(text)
    );
    browser.run(&script);
}

/// Percent-encodes a text for a link.
fn escaped(text: &str) -> String {
    let mut escaped = String::new();
    for byte in text.bytes() {
        write!(escaped, "%{byte:02X}").unwrap();
    }
    escaped
}

/// A room with 64 balls, which are stored in cells.
fn many_balls() -> String {
    let mut text = String::from("Scene(surfaces: [Surface(shape: Room(size: (40, 10, 40))),\n");
    for ball in 0..64 {
        let (x, z) = (ball % 8 * 4 - 14, ball / 8 * 4 - 14);
        writeln!(
            text,
            "Surface(shape: Sphere(radius: 0.9), position: ({x}, 0, {z})),"
        )
        .unwrap();
    }
    text += "], source: Source(position: (0, 1, 0.5)), listener: Listener(position: (8, 0.5, 8), radius: 1))";
    text
}

/// Protects the waves: the page gives the same counts as the program for the same scenes, except for rounding.
#[test]
#[ignore = "scripts/browser-test.sh builds the page first"]
fn a_page_counts_what_the_program_counts() {
    on_page(|stage, browser| {
        let file = stage.folder.path().join("balls.ron");
        std::fs::write(&file, many_balls()).unwrap();
        let balls = format!("scene=corner&text={}", escaped(&many_balls()));
        let cases = [
            ("corner", "scene=corner"),
            ("obstacles", "scene=obstacles"),
            (argument(&file), &balls),
            ("cave", "scene=cave"),
            ("menger", "scene=menger"),
        ];
        for (scene, link) in cases {
            let link = format!("#{link}&profile=hybrid&waves=65536&iterations=8");
            stage.load(browser, &link);
            let (page, program) = (counts_of_page(browser), counts_of_program(scene));
            println!("{scene}: page {page:?}, program {program:?}");
            assert_eq!(page.iter().sum::<u64>(), 65_536);
            let differ = |(page, program): (&u64, &u64)| page.abs_diff(*program) > MAY_DIFFER;
            assert!(
                !page.iter().zip(&program).any(differ),
                "{scene}: {page:?}, {program:?}"
            );
            assert!(page[0] > 0, "{scene}: no hits");
        }
        let milliseconds = browser.run("return Array.from(echomarch.page.frame())[6]");
        let renderer = browser.run("return echomarch.page.renderer()");
        println!("{renderer}: {milliseconds} ms until a frame is heard");
    });
}

/// Protects walking and links: a key moves the listener, and the link contains the new position. A page loaded with
/// that link has the same position and choices.
#[test]
#[ignore = "scripts/browser-test.sh builds the page first"]
fn keys_walk_and_a_link_leads_back() {
    on_page(|stage, browser| {
        stage.load(
        browser,
        "#scene=corner&profile=march&waves=8192&iterations=5&listen=balance&sound=sine:220&volume=0.25",
    );
        let z = |browser: &Browser| {
            browser
                .run("return echomarch.page.listener()[2]")
                .as_f64()
                .unwrap()
        };
        let before = z(browser);
        browser.click("h1");
        browser.hold("w", Duration::from_millis(1500));
        wait(
            browser,
            "return Math.abs(echomarch.page.listener()[2] - 8) > 0.2",
        );
        assert!(z(browser) < before, "forward is along -z");
        wait(browser, "return location.hash === echomarch.address()");
        let link = browser
            .run("return location.hash")
            .as_str()
            .unwrap()
            .to_owned();
        let there = z(browser);
        stage.load(browser, &link);
        assert!((z(browser) - there).abs() < 0.002, "{} {there}", z(browser));
        assert_eq!(chosen(browser), "corner,march,8192,5,balance,sine:220,0.25");
    });
}

/// Protects users who open a link with invalid choices: each invalid choice is reported, and its default is used.
#[test]
#[ignore = "scripts/browser-test.sh builds the page first"]
fn what_a_link_says_wrongly_is_told() {
    on_page(|stage, browser| {
        stage.load(
            browser,
            "#scene=castle&profile=x&waves=&iterations=2.5&listen=loud&sound=bell&volume=9&listener=1,2\
             &value.a=b&wavs=3&late=maybe&least=-31",
        );
        for part in [
            "no scene \"castle\"",
            "no profile \"x\"",
            "waves has to be",
            "iterations has to be",
            "no listen \"loud\"",
            "no sound \"bell\"",
            "volume has to be",
            "listener has to be 5 numbers",
            "value.a has to be",
            "late has to be on or off",
            "no least \"-31\"",
            "no setting \"wavs\"",
        ] {
            browser.wait_for("#message", part);
        }
        assert_eq!(
            chosen(browser),
            "open-pillars,hybrid,65536,8,full,speech,0.5"
        );
        for (key, waves) in [("[", "2048"), ("]", "4096")] {
            stage.load(browser, "#scene=corner&waves=3000&value.none=1");
            assert_eq!(chosen(browser), "corner,hybrid,3000,8,full,speech,0.5");
            browser.wait_for("#message", "none");
            browser.click("h1");
            browser.press(key);
            let is_set = format!("return document.getElementById('waves').value === '{waves}'");
            wait(browser, &is_set);
        }
    });
}

/// Protects a walk from a single picture that cannot be drawn: the error is reported, and the following pictures are
/// drawn.
#[test]
#[ignore = "scripts/browser-test.sh builds the page first"]
fn a_page_goes_on_after_a_failed_picture() {
    on_page(|stage, browser| {
        stage.load(browser, "#scene=corner&waves=8192");
        browser.run("echomarch.page.trace = () => { throw new Error('a trial'); }; return 0");
        browser.wait_for("#message", "a trial");
        browser.run("delete echomarch.page.trace; return 0");
        wait(browser, "return document.getElementById('message').hidden");
        browser.run("document.getElementById('iterations').value = 0; return 0");
        browser.run(
            "document.getElementById('iterations').dispatchEvent(new Event('change')); return 0",
        );
        browser.wait_for(
            "#message",
            "iterations has to be a whole number from 1 to 64",
        );
        assert_eq!(chosen(browser), "corner,hybrid,8192,8,full,speech,0.5");
    });
}

/// Protects users who edit a scene: an invalid text shows its error with the line, and the last valid scene stays.
#[test]
#[ignore = "scripts/browser-test.sh builds the page first"]
fn a_bad_text_is_told_and_the_scene_goes_on() {
    let of = |shape: &str| {
        format!(
            "Scene(surfaces: [Surface(shape: {shape}, position: (0, -2, 0))],\n\
             source: Source(position: (0, 0, -5)),\n\
             listener: Listener(position: (0, 0, 3), radius: 1))"
        )
    };
    on_page(|stage, browser| {
        stage.load(browser, "#scene=corner&waves=8192");
        let before = counts_of_page(browser);
        write_text(
            browser,
            "Scene(\n  surfaces: [Surface(shape: Spere(radius: 1))],\n)",
        );
        browser.wait_for("#error", "2:");
        let error = browser.text("#error");
        assert!(error.contains("did you mean Sphere?"), "{error}");
        assert_eq!(counts_of_page(browser), before);
        let image = of("HeightField(image: \"hill.png\", size: (9, 1, 9))");
        write_text(browser, &image);
        browser.wait_for("#error", "there are no files in a browser");
        write_text(browser, &of("Mesh(file: \"hill.obj\")"));
        browser.wait_for("#error", "hill.obj: there are no files in a browser");
        write_text(browser, &of("Plane"));
        wait(
            browser,
            "return document.getElementById('error').hidden && echomarch.page.sources()[2] === -5 \
             && echomarch.page.listener()[2] === 3",
        );
    });
}

/// Protects users without WebGL 2: the page shows a message instead of staying empty.
#[test]
#[ignore = "scripts/browser-test.sh builds the page first"]
fn a_browser_without_webgl_is_told_so() {
    let stage = Stage::new();
    let browser = stage.open_with(&["--disable-3d-apis"]);
    browser.visit(&stage.address);
    browser.wait_for("#message", "This page needs WebGL 2");
    assert_eq!(browser.errors(), Vec::<String>::new());
}

/// Protects users whose WebGL 2 cannot render to float textures: the page shows a message instead of staying empty.
#[test]
#[ignore = "scripts/browser-test.sh builds the page first"]
fn a_browser_without_float_targets_is_told_so() {
    on_page(|stage, browser| {
        browser.before_load(
            "const kind = WebGL2RenderingContext.prototype;
             const get = kind.getExtension;
             kind.getExtension = function (name) {
                 return name === 'EXT_color_buffer_float' ? null : get.call(this, name);
             };",
        );
        browser.visit(&stage.address);
        browser.wait_for(
            "#message",
            "needs the WebGL extension EXT_color_buffer_float",
        );
    });
}
