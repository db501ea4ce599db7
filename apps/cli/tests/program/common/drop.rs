//! The file manager's side of drag and drop on X11 (the XDND protocol, version 5). This module drops a file on a window
//! without a mouse.

use std::path::Path;
use x11rb::connection::Connection;
use x11rb::protocol::Event;
use x11rb::protocol::xproto::{
    Atom, ClientMessageEvent, ConnectionExt as _, CreateWindowAux, EventMask, PropMode,
    SELECTION_NOTIFY_EVENT, SelectionNotifyEvent, SelectionRequestEvent, Window, WindowClass,
};
use x11rb::rust_connection::RustConnection;
use x11rb::wrapper::ConnectionExt as _;
use x11rb::{COPY_DEPTH_FROM_PARENT, COPY_FROM_PARENT, CURRENT_TIME};

/// Version of the protocol.
const VERSION: u32 = 5;

/// Drops a file on a window of a display. Returns once the window has accepted the file.
pub fn drop_file(display: &str, window: &str, file: &Path) {
    let (connection, screen) = RustConnection::connect(Some(display)).unwrap();
    let root = connection.setup().roots[screen].root;
    let hand = Hand::new(connection, root, window.parse().unwrap());
    hand.drop(&format!("file://{}\r\n", file.display()));
}

struct Hand {
    connection: RustConnection,
    own: Window,
    target: Window,
}

impl Hand {
    fn new(connection: RustConnection, root: Window, target: Window) -> Hand {
        let own = connection.generate_id().unwrap();
        connection
            .create_window(
                COPY_DEPTH_FROM_PARENT,
                own,
                root,
                0,
                0,
                1,
                1,
                0,
                WindowClass::INPUT_OUTPUT,
                COPY_FROM_PARENT,
                &CreateWindowAux::new(),
            )
            .unwrap();
        Hand {
            connection,
            own,
            target,
        }
    }

    fn atom(&self, name: &str) -> Atom {
        let asked = self.connection.intern_atom(false, name.as_bytes());
        asked.unwrap().reply().unwrap().atom
    }

    fn tell(&self, what: &str, data: [u32; 4]) {
        let [a, b, c, d] = data;
        let message =
            ClientMessageEvent::new(32, self.target, self.atom(what), [self.own, a, b, c, d]);
        let sent = self
            .connection
            .send_event(false, self.target, EventMask::NO_EVENT, message);
        sent.unwrap().check().unwrap();
    }

    fn drop(&self, list: &str) {
        let (selection, kind) = (self.atom("XdndSelection"), self.atom("text/uri-list"));
        let owned = self
            .connection
            .set_selection_owner(self.own, selection, CURRENT_TIME);
        owned.unwrap().check().unwrap();
        self.tell("XdndEnter", [VERSION << 24, kind, 0, 0]);
        let copy = self.atom("XdndActionCopy");
        self.tell("XdndPosition", [0, 400 << 16 | 300, CURRENT_TIME, copy]);
        self.answer(selection, kind, list);
        self.tell("XdndDrop", [0, CURRENT_TIME, 0, 0]);
        let finished = self.atom("XdndFinished");
        loop {
            let event = self.connection.wait_for_event().unwrap();
            if matches!(event, Event::ClientMessage(said) if said.type_ == finished) {
                return;
            }
        }
    }

    /// Sends the file names when the window requests them.
    fn answer(&self, selection: Atom, kind: Atom, list: &str) {
        let asked: SelectionRequestEvent = loop {
            if let Event::SelectionRequest(asked) = self.connection.wait_for_event().unwrap() {
                break asked;
            }
        };
        assert_eq!((asked.selection, asked.target), (selection, kind));
        let (mode, property) = (PropMode::REPLACE, asked.property);
        let list = list.as_bytes();
        let given = self
            .connection
            .change_property8(mode, asked.requestor, property, kind, list);
        given.unwrap().check().unwrap();
        let notice = SelectionNotifyEvent {
            response_type: SELECTION_NOTIFY_EVENT,
            sequence: 0,
            time: asked.time,
            requestor: asked.requestor,
            selection,
            target: kind,
            property,
        };
        let told = self
            .connection
            .send_event(false, asked.requestor, EventMask::NO_EVENT, notice);
        told.unwrap().check().unwrap();
    }
}
