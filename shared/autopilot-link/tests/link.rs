//! Links over real sockets on loopback: who is believed, and what happens when a connection breaks.
#![cfg(test)]

use autopilot_link::{Event, Link, Outbox, Partners};
use std::net::UdpSocket;
use std::time::Duration;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::{TcpListener, TcpStream};

const WITHIN: Duration = Duration::from_secs(20);

/// What happens next: the event, and the bytes that came with it.
async fn next(link: &mut Link) -> (Event, Vec<u8>) {
    let mut bytes = vec![];
    let own = |datagram: &[u8]| datagram.starts_with(b"own");
    let event = tokio::time::timeout(WITHIN, link.next(&mut bytes, own)).await.expect("an event");
    (event, bytes)
}

fn outbox(frames: &[&[u8]]) -> Outbox {
    let mut outbox = Outbox::default();
    frames.iter().for_each(|f| outbox.push(|bytes| bytes.extend_from_slice(f)));
    outbox
}

#[tokio::test]
async fn the_return_path_of_datagrams_belongs_to_the_autopilot_and_strangers_are_counted() {
    let mut link = Link::open(&"udp:127.0.0.1:0".parse().unwrap()).await.unwrap();
    let at = link.local_address().unwrap();
    let [stranger, own] = [(); 2].map(|()| UdpSocket::bind("127.0.0.1:0").unwrap());
    stranger.send_to(b"hello", at).unwrap();
    stranger.send_to(b"garbage", at).unwrap();
    own.send_to(b"own 1", at).unwrap();
    let (event, bytes) = next(&mut link).await;
    let Event::Datagram(peer) = event else { panic!("{event:?}") };
    assert_eq!((bytes.as_slice(), link.peers()), (&b"own 1"[..], vec![peer]));
    stranger.send_to(b"own, too", at).unwrap();
    own.send_to(b"anything", at).unwrap();
    assert_eq!(next(&mut link).await.1, b"anything", "there is only one autopilot");
    assert_eq!((link.stats().strangers, link.stats().stranger_bytes), (3, 5 + 7 + 8));

    link.send_all(0, &outbox(&[b"to you", b"and again"]));
    own.set_read_timeout(Some(WITHIN)).unwrap();
    let mut buffer = [0; 300];
    for expected in [&b"to you"[..], b"and again"] {
        let (length, _) = own.recv_from(&mut buffer).unwrap();
        assert_eq!(&buffer[..length], expected, "a frame is a datagram");
    }
    stranger.set_nonblocking(true).unwrap();
    assert!(stranger.recv_from(&mut buffer).is_err(), "a stranger hears nothing");
}

#[tokio::test]
async fn what_an_autopilot_says_before_its_first_heartbeat_is_no_strangers() {
    let mut link = Link::open(&"udp:127.0.0.1:0".parse().unwrap()).await.unwrap();
    let at = link.local_address().unwrap();
    let [stranger, own] = [(); 2].map(|()| UdpSocket::bind("127.0.0.1:0").unwrap());
    stranger.send_to(b"hello", at).unwrap();
    for _ in 0..30 {
        own.send_to(b"attitude", at).unwrap();
    }
    own.send_to(b"own", at).unwrap();
    assert_eq!(next(&mut link).await.1, b"own");
    assert_eq!((link.stats().strangers, link.stats().stranger_bytes), (1, 5));
}

#[tokio::test]
async fn an_autopilot_that_is_silent_gives_up_its_place_to_one_that_is_recognised() {
    let socket = tokio::net::UdpSocket::bind("127.0.0.1:0").await.unwrap();
    let mut link = Link::udp(socket, Partners::Recognised { most: 1, silent: Duration::ZERO });
    let at = link.local_address().unwrap();
    let [first, stranger, second] = [(); 3].map(|()| UdpSocket::bind("127.0.0.1:0").unwrap());
    first.send_to(b"own 1", at).unwrap();
    let (a, _) = next(&mut link).await;
    stranger.send_to(b"hello", at).unwrap();
    second.send_to(b"own 2", at).unwrap();
    let (b, bytes) = next(&mut link).await;
    assert_eq!((bytes.as_slice(), link.stats().strangers), (&b"own 2"[..], 1));
    assert_ne!(a, b);
    assert_eq!(link.peers().len(), 1);
}

#[tokio::test]
async fn a_tcp_connection_that_breaks_is_told_and_made_again() {
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let address = format!("tcp:{}", listener.local_addr().unwrap()).parse().unwrap();
    let mut link = Link::open(&address).await.unwrap();
    for text in [&b"one"[..], b"two", b"three"] {
        // the link only moves while somebody waits for its events
        let serve = async {
            let (mut stream, _) = listener.accept().await.unwrap();
            stream.write_all(text).await.unwrap();
        };
        let follow = async {
            assert!(matches!(next(&mut link).await.0, Event::Connected(_)));
            let (event, bytes) = next(&mut link).await;
            assert!(matches!(event, Event::Stream(_)) && bytes == text, "{event:?}");
            assert!(matches!(next(&mut link).await.0, Event::Gone(_)));
        };
        tokio::join!(follow, serve);
    }
    link.send_all(0, &outbox(&[b"nobody hears this"]));
    assert_eq!(link.peers(), []);
}

#[tokio::test]
async fn one_client_at_a_time_is_served_and_hears_what_is_sent_to_it() {
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let mut link = Link::listen(listener);
    let at = link.local_address().unwrap();
    let mut client = TcpStream::connect(at).await.unwrap();
    let (event, _) = next(&mut link).await;
    let Event::Connected(peer) = event else { panic!("{event:?}") };
    let mut second = TcpStream::connect(at).await.unwrap();
    let turned_away = async { matches!(second.read(&mut [0; 1]).await, Ok(0) | Err(_)) };
    tokio::select! {
        closed = turned_away => assert!(closed, "one client a port"),
        (event, _) = next(&mut link) => panic!("{event:?}"),
    }
    client.write_all(b"hello").await.unwrap();
    assert_eq!(next(&mut link).await, (Event::Stream(peer), b"hello".to_vec()));
    link.send_all(0, &outbox(&[b"an", b"swer"]));
    let mut answer = [0; 6];
    client.read_exact(&mut answer).await.unwrap();
    assert_eq!(&answer, b"answer");
    drop(client);
    assert_eq!(next(&mut link).await.0, Event::Gone(peer));
}
