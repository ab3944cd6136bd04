use super::*;
use crate::tiles::picture::tests::tile as picture;
use image::ImageFormat;
use std::io::{BufRead, BufReader, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::mpsc::{Receiver, channel};

/// What a server answers to one request: head and body.
type Reply = Box<dyn FnOnce(&mut TcpStream) + Send>;

fn reply(head: &str, body: &[u8]) -> Reply {
    let head = format!("HTTP/1.1 {head}\r\nConnection: close\r\nContent-Length: {}\r\n\r\n", body.len());
    let all = [head.as_bytes(), body].concat();
    // the client may hang up on what it does not want
    Box::new(move |stream| drop(stream.write_all(&all)))
}

/// A server on this machine that gives these replies, one for each request, and is gone then. What it was asked can be
/// received.
fn server(replies: Vec<Reply>) -> (Template, Receiver<String>) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap();
    let (asked, requests) = channel();
    std::thread::spawn(move || {
        for reply in replies {
            let (mut stream, _) = listener.accept().unwrap();
            let lines = BufReader::new(stream.try_clone().unwrap()).lines().map_while(Result::ok);
            let request: Vec<String> = lines.take_while(|line| !line.is_empty()).collect();
            let _ = asked.send(request.join("\n").to_lowercase());
            reply(&mut stream);
        }
    });
    (Template::new(&format!("http://{address}/tiles/{{z}}/{{x}}/{{y}}.png")).unwrap(), requests)
}

const TILE: TileId = TileId { zoom: 9, x: 136, y: 200 };

struct Setup {
    reader: Online,
    health: Arc<Health>,
    folder: tempfile::TempDir,
}

fn setup(template: &Template) -> Setup {
    let folder = tempfile::tempdir().unwrap();
    let kept = Folder::default();
    kept.set(folder.path().join("tiles")).unwrap();
    let health = Arc::<Health>::default();
    let reader = Online::open(template.clone(), kept, &health).unwrap().remove(0);
    Setup { reader, health, folder }
}

impl Setup {
    fn read(&mut self, tile: TileId) -> Answer {
        self.reader.read(Wanted { tile, dark: false })
    }

    /// Another run of the program, with what this one kept.
    fn again(&self, template: &Template) -> Self {
        let kept = Folder::default();
        kept.set(self.folder.path().join("tiles")).unwrap();
        let reader = Online::open(template.clone(), kept, &self.health).unwrap().remove(0);
        Self { reader, health: self.health.clone(), folder: tempfile::tempdir().unwrap() }
    }

    /// What is kept of a tile was fetched long ago.
    fn make_old(&self, tile: TileId) {
        let cache = &self.reader.0.cache;
        let stored = cache.get(tile).unwrap();
        cache.put(tile, &Stored { fetched_s: 0, ..stored });
    }
}

fn png() -> Vec<u8> {
    picture(64, [10, 20, 200, 255], ImageFormat::Png)
}

#[test]
fn a_tile_is_asked_for_once_by_name_and_kept_for_the_next_run() {
    let (template, requests) = server(vec![reply("200 OK\r\nCache-Control: max-age=86400", &png())]);
    let mut setup = setup(&template);
    assert!(matches!(setup.read(TILE), Answer::Picture(p) if p.size == [64, 64]));
    let request = requests.recv().unwrap();
    assert!(request.starts_with("get /tiles/9/136/200.png "), "{request}");
    assert!(request.contains(concat!("user-agent: legwork/", env!("CARGO_PKG_VERSION"))), "{request}");
    assert!(matches!(setup.again(&template).read(TILE), Answer::Picture(_)));
    assert!(requests.recv().is_err(), "it was not asked again");
    assert!(!setup.health.is_offline());
}

#[test]
fn an_old_tile_is_asked_for_with_its_mark_and_stays_when_it_is_the_same() {
    let first = reply("200 OK\r\nETag: \"7\"\r\nCache-Control: max-age=3600", &png());
    let (template, requests) = server(vec![first, reply("304 Not Modified", b"")]);
    let mut setup = setup(&template);
    setup.read(TILE);
    setup.make_old(TILE);
    assert!(matches!(setup.read(TILE), Answer::Picture(_)));
    assert!(requests.iter().nth(1).unwrap().contains("if-none-match: \"7\""));
    assert!(setup.reader.0.cache.get(TILE).unwrap().is_fresh(cache::now_s()));
}

#[test]
fn a_tile_that_is_not_there_is_nothing_and_garbage_is_unreadable() {
    let (template, _) = server(vec![reply("404 Not Found", b"none"), reply("200 OK", b"<html>log in")]);
    let mut setup = setup(&template);
    assert!(matches!(setup.read(TILE), Answer::Nothing));
    assert!(matches!(setup.read(TILE), Answer::Nothing), "it is remembered");
    let other = TileId { x: 137, ..TILE };
    assert!(matches!(setup.read(other), Answer::Unreadable));
    assert!(setup.reader.0.cache.get(other).is_none(), "garbage is not kept");
}

#[test]
fn a_body_without_end_is_left_where_it_is_too_large() {
    let endless: Reply = Box::new(|stream| {
        let _ = stream.write_all(b"HTTP/1.1 200 OK\r\nConnection: close\r\n\r\n");
        while stream.write_all(&[7; 65_536]).is_ok() {}
    });
    let (template, _) = server(vec![endless]);
    assert!(matches!(setup(&template).read(TILE), Answer::Unreadable));
}

#[test]
fn without_the_server_old_tiles_are_shown_and_it_is_asked_after_a_pause_only() {
    let (template, requests) =
        server(vec![reply("200 OK", &png()), reply("503 Busy\r\nRetry-After: 60", b"")]);
    let mut setup = setup(&template);
    setup.read(TILE);
    setup.make_old(TILE);
    assert!(matches!(setup.read(TILE), Answer::Picture(_)) && setup.health.is_offline());
    assert!(matches!(setup.read(TileId { x: 1, ..TILE }), Answer::Later));
    assert_eq!(requests.iter().count(), 2, "nothing was asked during the pause");
    // in the next run it is gone
    let mut next = setup.again(&template);
    assert!(matches!(next.read(TILE), Answer::Picture(_)) && next.health.is_offline());
    assert!(matches!(next.read(TileId { x: 1, ..TILE }), Answer::Later));
}

#[test]
fn the_pause_doubles_within_bounds() {
    let (mut pause, now) = (Pause::default(), Instant::now());
    let trouble = |asked| Trouble { why: String::new(), asked: Duration::from_secs(asked) };
    let after = |pause: &Pause, seconds| pause.is_on(now + Duration::from_secs(seconds));
    pause.begin(now, &trouble(0));
    assert!(after(&pause, 3) && !after(&pause, 4));
    pause.begin(now, &trouble(0));
    assert!(after(&pause, 7) && !after(&pause, 8));
    pause.begin(now, &trouble(u64::from(u32::MAX)));
    assert!(after(&pause, 299) && !after(&pause, 300));
    (0..40).for_each(|_| pause.begin(now, &trouble(0)));
    assert!(!after(&pause, 300));
    pause.end();
    assert!(!pause.is_on(now));
}

#[test]
fn an_address_that_is_none_is_told_with_what_to_write() {
    for (text, expected) in [
        ("https://tile.example.org/{z}/{x}/{y}.png", None),
        ("http://localhost:8080/{z}/{x}/{y}?key=1", None),
        ("https://tile.example.org/{z}/{x}.png", Some("has no {y}")),
        ("https://{s}.example.org/{z}/{x}/{y}.png", Some("only")),
        ("file:///{z}/{x}/{y}.png", Some("must begin with")),
        ("tile.example.org/{z}/{x}/{y}.png", Some("no address")),
        ("", Some("has no {z}")),
    ] {
        match (Template::new(text), expected) {
            (Ok(template), None) => assert!(!template.host().is_empty()),
            (Err(why), Some(expected)) => assert!(why.contains(expected), "{text}: {why}"),
            (result, _) => panic!("{text}: {result:?}"),
        }
    }
    assert_eq!(Template::new("https://a.example.org/{z}/{x}/{y}").unwrap().host(), "a.example.org");
}
