//! Controls a headless Chromium with the WebDriver protocol (W3C 2018), as far as the tests need it. The Debian
//! packages `chromium` and `chromium-driver` are required.

use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Maximum wait before a test fails. The limit exceeds the time that any machine needs.
const TIMEOUT: Duration = Duration::from_secs(300);

/// The JSON key for an element reference in the protocol.
const ELEMENT: &str = "element-6066-11e4-a52e-4f735466cecf";

/// The driver's process. Dropping it ends the process.
pub struct Driver {
    process: Child,
    port: u16,
}

/// A browser with one window. Dropping it closes the browser.
pub struct Browser<'a> {
    driver: &'a Driver,
    session: String,
}

impl Driver {
    /// Starts the driver. Chromedriver requests the same free port on IPv4 and IPv6, and exits if another program uses
    /// one of them. The driver is then started again.
    pub fn start() -> Driver {
        const STARTS: usize = 8;
        let mut said = String::new();
        for _ in 0..STARTS {
            match Driver::start_once() {
                Ok(driver) => return driver,
                Err(why) => said = why,
            }
        }
        panic!("chromedriver failed to start {STARTS} times; its last output: {said}");
    }

    /// Starts the driver once. The error is the output of the driver before it exited.
    fn start_once() -> Result<Driver, String> {
        let mut process = Command::new("chromedriver")
            .arg("--port=0")
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("no chromedriver: install chromium and chromium-driver");
        let lines = BufReader::new(process.stdout.take().unwrap()).lines();
        let mut said = Vec::new();
        for line in lines.map_while(Result::ok) {
            let port = line
                .split_once("started successfully on port ")
                .and_then(|(_, rest)| rest.trim_end_matches('.').parse().ok());
            if let Some(port) = port {
                return Ok(Driver { process, port });
            }
            said.push(line);
        }
        let _ = process.wait();
        Err(said.join("\n"))
    }

    /// Opens a browser without GPU acceleration, which keeps its data in `profile` and its downloads in `downloads`.
    pub fn open(&self, profile: &Path, downloads: &Path) -> Browser<'_> {
        self.open_with(profile, downloads, &["--disable-gpu"])
    }

    /// Opens a browser with these additional Chromium flags.
    pub fn open_with(&self, profile: &Path, downloads: &Path, flags: &[&str]) -> Browser<'_> {
        let data = format!("--user-data-dir={}", profile.display());
        let arguments = [
            "--headless",
            "--no-sandbox",
            "--disable-quic",
            "--disable-dev-shm-usage",
            "--no-first-run",
            "--disable-background-networking",
            "--disable-component-update",
            "--disable-sync",
            "--mute-audio",
            "--window-size=1200,900",
            &data,
        ];
        let arguments = [&arguments[..], flags].concat();
        let options = json!({
            "args": arguments,
            "prefs": { "download.default_directory": downloads, "download.prompt_for_download": false },
        });
        let wanted = json!({ "capabilities": { "alwaysMatch": {
            "goog:chromeOptions": options,
            "goog:loggingPrefs": { "browser": "ALL" },
        } } });
        let answer = self.ask("POST", "/session", Some(&wanted));
        let session = answer["sessionId"].as_str().unwrap().to_owned();
        Browser {
            driver: self,
            session,
        }
    }

    /// Sends one request and returns the `value` of the response. An error causes a panic with the driver's message.
    fn ask(&self, method: &str, path: &str, body: Option<&Value>) -> Value {
        let body = body.map(Value::to_string).unwrap_or_default();
        let mut stream = TcpStream::connect(("127.0.0.1", self.port)).unwrap();
        stream.set_read_timeout(Some(TIMEOUT)).unwrap();
        write!(
            stream,
            "{method} {path} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\
             Content-Type: application/json\r\nContent-Length: {}\r\n\r\n{body}",
            body.len()
        )
        .unwrap();
        let mut reader = BufReader::new(stream);
        let mut length = 0;
        loop {
            let mut line = String::new();
            reader.read_line(&mut line).unwrap();
            if line.trim().is_empty() {
                break;
            }
            if let Some(value) = line.to_ascii_lowercase().strip_prefix("content-length:") {
                length = value.trim().parse().unwrap();
            }
        }
        let mut answer = vec![0; length];
        reader.read_exact(&mut answer).unwrap();
        let mut answer: Value = serde_json::from_slice(&answer).unwrap();
        let value = answer["value"].take();
        assert!(value["error"].is_null(), "{method} {path}: {value}");
        value
    }
}

impl Drop for Driver {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

impl Browser<'_> {
    fn ask(&self, method: &str, path: &str, body: Option<&Value>) -> Value {
        let path = format!("/session/{}{path}", self.session);
        self.driver.ask(method, &path, body)
    }

    pub fn go(&self, file: &Path) {
        self.visit(&format!("file://{}", file.display()));
    }

    pub fn visit(&self, url: &str) {
        self.ask("POST", "/url", Some(&json!({ "url": url })));
    }

    /// Runs a script in every page that is loaded later, before the scripts of that page.
    pub fn before_load(&self, script: &str) {
        let command = json!({
            "cmd": "Page.addScriptToEvaluateOnNewDocument",
            "params": { "source": script },
        });
        self.ask("POST", "/goog/cdp/execute", Some(&command));
    }

    fn element(&self, css: &str) -> String {
        let wanted = json!({ "using": "css selector", "value": css });
        let found = self.ask("POST", "/element", Some(&wanted));
        found[ELEMENT].as_str().unwrap().to_owned()
    }

    /// Clicks a visible, uncovered element, as a user does.
    pub fn click(&self, css: &str) {
        let element = self.element(css);
        self.ask(
            "POST",
            &format!("/element/{element}/click"),
            Some(&json!({})),
        );
    }

    /// Clicks at an offset from the centre of an element, in pixels to the right and down.
    pub fn click_at(&self, css: &str, right: i32, down: i32) {
        let origin = json!({ ELEMENT: self.element(css) });
        let actions = json!({ "actions": [{
            "type": "pointer", "id": "mouse",
            "actions": [
                { "type": "pointerMove", "origin": origin, "x": right, "y": down },
                { "type": "pointerDown", "button": 0 },
                { "type": "pointerUp", "button": 0 },
            ],
        }] });
        self.ask("POST", "/actions", Some(&actions));
    }

    /// Presses keys one after the other, at the current focus.
    pub fn press(&self, keys: &str) {
        let strokes = keys
            .chars()
            .flat_map(|key| ["keyDown", "keyUp"].map(|kind| json!({ "type": kind, "value": key })));
        let strokes: Vec<Value> = strokes.collect();
        let actions = json!({ "actions": [{ "type": "key", "id": "keys", "actions": strokes }] });
        self.ask("POST", "/actions", Some(&actions));
    }

    /// Holds a key for `time`, at the current focus.
    pub fn hold(&self, key: &str, time: Duration) {
        let actions = json!({ "actions": [{ "type": "key", "id": "keys", "actions": [
            { "type": "keyDown", "value": key },
            { "type": "pause", "duration": time.as_millis() as u64 },
            { "type": "keyUp", "value": key },
        ] }] });
        self.ask("POST", "/actions", Some(&actions));
    }

    /// Makes the browser one with a touch screen, for pages that are loaded later.
    pub fn emulate_touch(&self) {
        let command = json!({
            "cmd": "Emulation.setTouchEmulationEnabled",
            "params": { "enabled": true, "maxTouchPoints": 2 },
        });
        self.ask("POST", "/goog/cdp/execute", Some(&command));
    }

    /// Puts a finger on the centre of an element and moves it by an offset in pixels to the right and down. The finger
    /// stays until `lift`.
    pub fn touch(&self, css: &str, right: i32, down: i32) {
        let origin = json!({ ELEMENT: self.element(css) });
        let actions = json!({ "actions": [{
            "type": "pointer", "id": "finger", "parameters": { "pointerType": "touch" },
            "actions": [
                { "type": "pointerMove", "origin": origin, "x": 0, "y": 0 },
                { "type": "pointerDown", "button": 0 },
                { "type": "pointerMove", "origin": origin, "x": right, "y": down },
            ],
        }] });
        self.ask("POST", "/actions", Some(&actions));
    }

    /// Lifts the finger of `touch`.
    pub fn lift(&self) {
        self.ask("DELETE", "/actions", None);
    }

    /// Types into an element. For a file field, `text` is a path.
    pub fn type_into(&self, css: &str, text: &str) {
        let path = format!("/element/{}/value", self.element(css));
        self.ask("POST", &path, Some(&json!({ "text": text })));
    }

    /// Runs the body of a function and returns its result.
    pub fn run(&self, script: &str) -> Value {
        let call = json!({ "script": script, "args": [] });
        self.ask("POST", "/execute/sync", Some(&call))
    }

    pub fn text(&self, css: &str) -> String {
        let element = self.element(css);
        let text = self.ask("GET", &format!("/element/{element}/text"), None);
        text.as_str().unwrap().to_owned()
    }

    /// Waits until the element's text contains `part`.
    pub fn wait_for(&self, css: &str, part: &str) {
        let began = Instant::now();
        while !self.text(css).contains(part) {
            let found = self.text(css);
            assert!(
                began.elapsed() < TIMEOUT,
                "{css}: no {part:?} but {found:?}"
            );
            std::thread::sleep(Duration::from_millis(50));
        }
    }

    /// Returns the errors logged by the console since the last call.
    pub fn errors(&self) -> Vec<String> {
        let log = self.ask("POST", "/se/log", Some(&json!({ "type": "browser" })));
        let lines = log.as_array().unwrap().iter();
        let errors = lines.filter(|line| line["level"] == "SEVERE");
        errors.map(|line| line["message"].to_string()).collect()
    }
}

impl Drop for Browser<'_> {
    /// Closes the browser as a user does, so that it saves its data. After a failed test, the driver's response is
    /// ignored.
    fn drop(&mut self) {
        if !std::thread::panicking() {
            self.ask("DELETE", "", None);
        } else if let Ok(mut stream) = TcpStream::connect(("127.0.0.1", self.driver.port)) {
            let _ = stream.set_read_timeout(Some(TIMEOUT));
            let head = format!(
                "DELETE /session/{} HTTP/1.1\r\nHost: localhost",
                self.session
            );
            let _ = write!(stream, "{head}\r\nConnection: close\r\n\r\n");
            let _ = stream.read(&mut [0; 256]);
        }
    }
}
