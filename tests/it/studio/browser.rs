//! A real browser, driven over the protocol of its developer tools.

use std::cell::RefCell;
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::rc::Rc;
use std::time::{Duration, Instant};

use serde_json::{json, Value};
use tempfile::TempDir;
use tungstenite::{Message, WebSocket};

use crate::data::skip;

/// Whatever is waited for comes within this time on a slow machine.
const PATIENCE: Duration = Duration::from_secs(150);
/// Work without a graphics card, leave the network alone.
const FLAGS: [&str; 10] = [
    "--headless=new",
    "--no-sandbox",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-quic",
    "--remote-debugging-port=0",
];

/// A browser with a fresh profile; it ends with this.
pub(crate) struct Browser {
    child: Child,
    profile: TempDir,
    wire: RefCell<Wire>,
}

struct Wire {
    socket: WebSocket<TcpStream>,
    next: u64,
}

/// One tab.
pub(crate) struct Page {
    browser: Rc<Browser>,
    session: String,
}

/// A browser, or none where none is installed, which is said aloud; in CI that is an error.
pub(crate) fn browser() -> Option<Rc<Browser>> {
    let names = ["chromium", "chromium-browser", "google-chrome"];
    let folders: Vec<PathBuf> = std::env::var_os("PATH")
        .map(|path| std::env::split_paths(&path).collect())
        .unwrap_or_default();
    let programs = names
        .iter()
        .flat_map(|name| folders.iter().map(move |f| f.join(name)));
    match programs.into_iter().find(|program| program.is_file()) {
        Some(program) => Some(Rc::new(Browser::start(&program))),
        None => {
            assert!(
                std::env::var_os("CI").is_none(),
                "no browser is installed; install chromium"
            );
            skip("no chromium is installed, so nothing was tested in a browser");
            None
        }
    }
}

impl Browser {
    fn start(program: &Path) -> Self {
        let profile = tempfile::tempdir().expect("a temporary folder");
        let mut child = Command::new(program)
            .args(FLAGS)
            .arg(format!("--user-data-dir={}", profile.path().display()))
            .arg("about:blank")
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("the browser starts");
        let (port, path) = wait_for("the browser's port", || {
            assert!(matches!(child.try_wait(), Ok(None)), "the browser ended");
            let text = std::fs::read_to_string(profile.path().join("DevToolsActivePort")).ok()?;
            let (port, path) = text.split_once('\n')?;
            (path.starts_with('/')).then(|| (port.to_owned(), path.trim().to_owned()))
        });
        let stream = TcpStream::connect(format!("127.0.0.1:{port}")).expect("the browser listens");
        stream
            .set_read_timeout(Some(PATIENCE))
            .expect("a stream takes a timeout");
        let url = format!("ws://127.0.0.1:{port}{path}");
        let (socket, _) = tungstenite::client(url, stream).expect("the browser speaks");
        Self {
            child,
            profile,
            wire: RefCell::new(Wire { socket, next: 1 }),
        }
    }

    fn call(&self, session: Option<&str>, method: &str, params: Value) -> Value {
        let mut wire = self.wire.borrow_mut();
        let id = wire.next;
        wire.next += 1;
        let mut request = json!({ "id": id, "method": method, "params": params });
        if let Some(session) = session {
            request["sessionId"] = json!(session);
        }
        wire.socket
            .send(Message::text(request.to_string()))
            .expect("the browser listens");
        loop {
            let message = wire.socket.read().expect("the browser answers");
            let Message::Text(text) = message else {
                continue;
            };
            let answer: Value = serde_json::from_str(&text).expect("the browser sends JSON");
            if answer["id"] == json!(id) {
                assert!(answer["error"].is_null(), "{method}: {}", answer["error"]);
                return answer["result"].clone();
            }
        }
    }

    /// Where downloads go.
    pub(crate) fn downloads(&self) -> PathBuf {
        self.profile.path().join("downloads")
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        // It may have ended by itself.
        drop(self.child.kill());
        drop(self.child.wait());
    }
}

impl Page {
    /// A new tab of some size at `url`.
    pub(crate) fn open(browser: &Rc<Browser>, url: &str, [width, height]: [u32; 2]) -> Self {
        let target = browser.call(None, "Target.createTarget", json!({ "url": "about:blank" }));
        let attach = json!({ "targetId": target["targetId"], "flatten": true });
        let attached = browser.call(None, "Target.attachToTarget", attach);
        let page = Self {
            browser: Rc::clone(browser),
            session: attached["sessionId"]
                .as_str()
                .expect("a session")
                .to_owned(),
        };
        page.size([width, height], 1.0);
        let folder = browser.downloads();
        std::fs::create_dir_all(&folder).expect("a folder");
        let behaviour = json!({ "behavior": "allow", "downloadPath": folder });
        browser.call(None, "Browser.setDownloadBehavior", behaviour);
        page.go(url);
        page
    }

    /// A command of the developer tools to this tab.
    pub(crate) fn call(&self, method: &str, params: Value) -> Value {
        self.browser.call(Some(&self.session), method, params)
    }

    /// The size of the page, in its own pixels, and how many of the screen's make one.
    pub(crate) fn size(&self, [width, height]: [u32; 2], ratio: f64) {
        let metrics = json!({ "width": width, "height": height, "deviceScaleFactor": ratio, "mobile": false });
        self.call("Emulation.setDeviceMetricsOverride", metrics);
    }

    pub(crate) fn prefer(&self, scheme: &str) {
        let media = json!({ "features": [{ "name": "prefers-color-scheme", "value": scheme }] });
        self.call("Emulation.setEmulatedMedia", media);
    }

    pub(crate) fn go(&self, url: &str) {
        self.call("Page.navigate", json!({ "url": url }));
    }

    /// The value of an expression, awaited where it is a promise.
    pub(crate) fn value(&self, expression: &str) -> Value {
        let params =
            json!({ "expression": expression, "awaitPromise": true, "returnByValue": true });
        let answer = self.call("Runtime.evaluate", params);
        assert!(
            answer["exceptionDetails"].is_null(),
            "{expression}: {}",
            answer["exceptionDetails"]
        );
        answer["result"]["value"].clone()
    }

    /// Waits until an expression holds.
    pub(crate) fn wait(&self, expression: &str) {
        let holds = format!(
            "Boolean((() => {{ try {{ return {expression}; }} catch {{ return false; }} }})())"
        );
        let began = Instant::now();
        while self.value(&holds) != json!(true) {
            if began.elapsed() > PATIENCE {
                let text = self.value("document.body.innerText");
                panic!("waited in vain for {expression}; the page says {text}");
            }
            std::thread::sleep(Duration::from_millis(30));
        }
    }

    /// Waits for everything that was asked for to be drawn.
    pub(crate) fn settle(&self) {
        self.value("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(true))))");
    }

    fn mouse(&self, kind: &str, [x, y]: [f64; 2], buttons: u32) {
        let button = if kind == "mouseMoved" && buttons == 0 {
            "none"
        } else {
            "left"
        };
        let event = json!({
            "type": kind, "x": x, "y": y, "button": button, "buttons": buttons, "clickCount": 1,
        });
        self.call("Input.dispatchMouseEvent", event);
    }

    pub(crate) fn click(&self, at: [f64; 2]) {
        self.mouse("mouseMoved", at, 0);
        self.mouse("mousePressed", at, 1);
        self.mouse("mouseReleased", at, 0);
    }

    /// Moves the pointer to a place.
    pub(crate) fn hover(&self, at: [f64; 2]) {
        self.mouse("mouseMoved", at, 0);
    }

    /// Presses at one place, moves in steps, and lets go at another.
    pub(crate) fn drag(&self, from: [f64; 2], to: [f64; 2]) {
        self.hold(from, to);
        self.let_go(to);
    }

    pub(crate) fn let_go(&self, at: [f64; 2]) {
        self.mouse("mouseReleased", at, 0);
    }

    /// Presses at one place and moves in steps to another.
    pub(crate) fn hold(&self, from: [f64; 2], to: [f64; 2]) {
        self.mouse("mouseMoved", from, 0);
        self.mouse("mousePressed", from, 1);
        for k in 1..=8 {
            let t = f64::from(k) / 8.0;
            self.mouse(
                "mouseMoved",
                [0, 1].map(|axis| from[axis] + t * (to[axis] - from[axis])),
                1,
            );
        }
    }

    /// Clicks the middle of the element that a selector names.
    pub(crate) fn press(&self, selector: &str) {
        let middle = format!(
            "(() => {{ const e = document.querySelector({selector:?}); \
             if (!e || e.disabled || e.hidden) return null; e.scrollIntoView({{ block: 'nearest' }}); \
             const r = e.getBoundingClientRect(); return [r.left + r.width / 2, r.top + r.height / 2]; }})()"
        );
        self.wait(&format!("{middle} !== null"));
        self.click(point(&self.value(&middle)));
    }

    /// Presses and releases a key.
    pub(crate) fn key(&self, key: &str, code: u32, modifiers: u32) {
        for kind in ["keyDown", "keyUp"] {
            let event = json!({
                "type": kind, "key": key, "windowsVirtualKeyCode": code, "modifiers": modifiers,
                "text": if kind == "keyDown" && modifiers == 0 && key.len() == 1 { key } else { "" },
            });
            self.call("Input.dispatchKeyEvent", event);
        }
    }

    /// Gives files to the page's file dialog.
    pub(crate) fn choose_file(&self, file: &Path) {
        let document = self.call("DOM.getDocument", json!({}));
        let node = json!({ "nodeId": document["root"]["nodeId"], "selector": "#file" });
        let node = self.call("DOM.querySelector", node);
        let files = json!({ "nodeId": node["nodeId"], "files": [file] });
        self.call("DOM.setFileInputFiles", files);
    }

    /// Drops a file from the desktop at a place.
    pub(crate) fn drop_files(&self, [x, y]: [f64; 2], files: &[PathBuf]) {
        let data = json!({ "items": [], "files": files, "dragOperationsMask": 1 });
        for kind in ["dragEnter", "dragOver", "drop"] {
            let event = json!({ "type": kind, "x": x, "y": y, "data": data });
            self.call("Input.dispatchDragEvent", event);
        }
    }

    /// Fingers at some places.
    pub(crate) fn touch(&self, kind: &str, at: &[[f64; 2]]) {
        let points: Vec<Value> = at
            .iter()
            .enumerate()
            .map(|(id, [x, y])| json!({ "x": x, "y": y, "id": id }))
            .collect();
        self.call(
            "Input.dispatchTouchEvent",
            json!({ "type": kind, "touchPoints": points }),
        );
    }

    /// Where downloads go.
    pub(crate) fn downloads(&self) -> PathBuf {
        self.browser.downloads()
    }

    /// A picture of the page as PNG.
    pub(crate) fn picture(&self) -> Vec<u8> {
        self.settle();
        let shot = self.call("Page.captureScreenshot", json!({ "format": "png" }));
        decode_base64(shot["data"].as_str().expect("a picture"))
    }
}

/// A pair of numbers.
pub(crate) fn point(value: &Value) -> [f64; 2] {
    [0, 1].map(|k| value[k].as_f64().expect("a number"))
}

/// Asks until there is an answer.
pub(crate) fn wait_for<T>(what: &str, mut ask: impl FnMut() -> Option<T>) -> T {
    let began = Instant::now();
    loop {
        if let Some(answer) = ask() {
            return answer;
        }
        assert!(began.elapsed() < PATIENCE, "waited in vain for {what}");
        std::thread::sleep(Duration::from_millis(30));
    }
}

fn decode_base64(text: &str) -> Vec<u8> {
    let value = |c: u8| match c {
        b'A'..=b'Z' => Some(c - b'A'),
        b'a'..=b'z' => Some(c - b'a' + 26),
        b'0'..=b'9' => Some(c - b'0' + 52),
        b'+' => Some(62),
        b'/' => Some(63),
        _ => None,
    };
    let digits: Vec<u8> = text.bytes().filter_map(value).collect();
    let bytes = digits.chunks(4).flat_map(|chunk| {
        let bits = chunk.iter().fold(0u32, |bits, &d| bits << 6 | u32::from(d));
        let n = chunk.len();
        let bits = bits << (6 * (4 - n));
        (0..n.saturating_sub(1)).map(move |k| (bits >> (16 - 8 * k)) as u8)
    });
    bytes.collect()
}
