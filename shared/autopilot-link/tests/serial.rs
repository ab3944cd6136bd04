//! Serial lines, over pseudo-terminals: what is sent and received, and what happens when one is unplugged.
#![cfg(test)]
#![cfg(unix)]

use autopilot_link::{Event, Link, Outbox};
use std::os::unix::fs::symlink;
use std::path::Path;
use std::time::Duration;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio_serial::{SerialPort, SerialStream};

const WITHIN: Duration = Duration::from_secs(20);

/// Plugs a device in at this path; gives its other end.
fn plug_in(at: &Path) -> SerialStream {
    let (far, device) = SerialStream::pair().unwrap();
    let name = device.name().unwrap();
    let _ = std::fs::remove_file(at);
    symlink(name, at).unwrap();
    far
}

async fn next(link: &mut Link) -> (Event, Vec<u8>) {
    let mut bytes = vec![];
    let event = tokio::time::timeout(WITHIN, link.next(&mut bytes, |_| false)).await.expect("an event");
    (event, bytes)
}

/// Everything that comes up to so many bytes.
async fn receive(link: &mut Link, length: usize) -> Vec<u8> {
    let mut all = vec![];
    while all.len() < length {
        let (event, bytes) = next(link).await;
        assert!(matches!(event, Event::Stream(_)), "{event:?}");
        all.extend(bytes);
    }
    all
}

#[tokio::test]
async fn every_byte_goes_through_both_ways_and_a_device_that_was_unplugged_is_found_again() {
    let directory = tempfile::tempdir().unwrap();
    let device = directory.path().join("autopilot");
    let address = format!("serial:{}:57600", device.display()).parse().unwrap();
    // it is not there yet
    let mut link = Link::open(&address).await.unwrap();
    let every: Vec<u8> = (0..=255).collect();
    for _ in 0..3 {
        let mut far = plug_in(&device);
        let (event, _) = next(&mut link).await;
        let Event::Connected(peer) = event else { panic!("{event:?}") };
        assert_eq!(link.peers(), [peer]);
        far.write_all(&every).await.unwrap();
        assert_eq!(receive(&mut link, every.len()).await, every);
        let mut outbox = Outbox::default();
        outbox.push(|bytes| bytes.extend(0..=255));
        link.send_all(0, &outbox);
        let mut sent = vec![0; every.len()];
        far.read_exact(&mut sent).await.unwrap();
        assert_eq!(sent, every);
        drop(far);
        std::fs::remove_file(&device).unwrap();
        assert_eq!(next(&mut link).await.0, Event::Gone(peer));
        assert_eq!(link.peers(), []);
    }
}

#[tokio::test]
async fn a_device_that_takes_nothing_in_loses_frames_and_not_its_connection() {
    let directory = tempfile::tempdir().unwrap();
    let device = directory.path().join("autopilot");
    let mut far = plug_in(&device);
    let address = format!("serial:{}:57600", device.display()).parse().unwrap();
    let mut link = Link::open(&address).await.unwrap();
    assert!(matches!(next(&mut link).await.0, Event::Connected(_)));
    let mut outbox = Outbox::default();
    (0..1000).for_each(|_| outbox.push(|bytes| bytes.extend([7; 250])));
    link.send_all(0, &outbox);
    assert!(link.stats().unsent > 500, "{:?}", link.stats());
    far.write_all(b"still there").await.unwrap();
    assert_eq!(receive(&mut link, 11).await, b"still there");
}
