//! Files over loopback: complete or absent, with the faults that threaten that.
#![cfg(test)]

mod common;

use common::*;
use std::sync::{Arc, Mutex};
use std::time::Duration;
use usal::contract::FileManifest;
use usal::{FILE_BYTES_MAX, FileError, SessionError};
use zenoh::Wait;
use zenoh::bytes::Encoding;
use zenoh::query::Queryable;

const KEY: &str = "legwork/uav1/photo/file/shot";
/// SHA-256 of the empty text.
const EMPTY_SHA256: &str = "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855";

fn content(bytes: usize) -> Vec<u8> {
    (0..bytes).map(|i| (i * 31 % 251) as u8).collect()
}

/// Somebody else's sender. Serves the first `served` chunks of `bytes` and notes what it served;
/// is silent about the others.
fn sender(
    session: &zenoh::Session,
    manifest: &FileManifest,
    bytes: Vec<u8>,
    served: u32,
) -> (Queryable<()>, Arc<Mutex<Vec<u32>>>) {
    let manifest = serde_json::to_vec(manifest).unwrap();
    let size = serde_json::from_slice::<FileManifest>(&manifest).unwrap().chunk_bytes as usize;
    let asked: Arc<Mutex<Vec<u32>>> = Arc::default();
    let noted = asked.clone();
    let queryable = session.declare_queryable(KEY).callback(move |query| {
        let Some(number) = query.parameters().get("chunk").map(|n| n.parse::<u32>().unwrap()) else {
            query.reply(KEY, manifest.clone()).encoding(Encoding::APPLICATION_JSON).wait().unwrap();
            return;
        };
        if number < served {
            noted.lock().unwrap().push(number);
            query.reply(KEY, bytes.chunks(size).nth(number as usize).unwrap_or(&[])).wait().unwrap();
        }
    });
    (queryable.wait().unwrap(), asked)
}

#[tokio::test(flavor = "multi_thread")]
async fn empty_small_and_large_files_arrive_whole_at_two_receivers() {
    let net = Net::open().await;
    let (a, b, c) = (net.client().await, net.client().await, net.client().await);
    let offer = a.offer("photo", "shot").unwrap();
    for size in [0, 1, 31_999, 32_000, 32_001, 700_000] {
        offer.set(0.0, content(size)).unwrap();
        let fetch = |s: usal::Session| async move { s.fetch("photo", "shot", DEADLINE).await.unwrap() };
        let (at_b, at_c) = tokio::join!(fetch(b.clone()), fetch(c.clone()));
        assert!(at_b == content(size) && at_c == content(size), "{size}");
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn new_version_is_announced_and_a_stale_chunk_is_refused() {
    let net = Net::open().await;
    let (client, outside) = (net.client().await, outside_client(&net.endpoint).await);
    let mut versions = client.follow_file("photo", "shot").unwrap();
    let offer = net.hub.offer("photo", "shot").unwrap();
    let none = client.fetch("photo", "shot", DEADLINE).await.unwrap_err();
    assert!(matches!(none, FileError::Refused(r) if r.code == "no-file"));
    offer.set(0.0, content(10)).unwrap();
    let old = within(versions.changed()).await.unwrap().stamped.value.sha256.clone();
    offer.set(1.0, Vec::new()).unwrap();
    until(async || versions.changed().await.unwrap().stamped.value.sha256 == EMPTY_SHA256).await;
    for (hash, code) in [(old.as_str(), "replaced"), (EMPTY_SHA256, "bad-request")] {
        let replies = outside.get(format!("{KEY}?hash={hash};chunk=0")).await.unwrap();
        let reply = within(replies.recv_async()).await.unwrap();
        let told = reply.result().unwrap_err().payload().to_bytes().into_owned();
        assert!(String::from_utf8_lossy(&told).contains(code), "{code}");
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn file_replaced_during_its_download_never_mixes() {
    let net = Net::open().await;
    let client = net.client().await;
    let offer = net.hub.offer("photo", "shot").unwrap();
    offer.set(0.0, vec![0; 400_000]).unwrap();
    let replacing = tokio::task::spawn_blocking(move || {
        for version in 1..=10 {
            offer.set(0.0, vec![version; 400_000]).unwrap();
        }
        offer
    });
    let fetched = client.fetch("photo", "shot", DEADLINE).await.unwrap();
    assert!(fetched.len() == 400_000 && fetched.iter().all(|b| *b == fetched[0]));
    let _offer = replacing.await.unwrap();
    assert_eq!(client.fetch("photo", "shot", DEADLINE).await.unwrap(), vec![10; 400_000]);
}

#[tokio::test(flavor = "multi_thread")]
async fn sender_that_died_midway_and_came_back_is_asked_only_for_what_is_missing() {
    let net = Net::open().await;
    let (client, outside) = (net.client().await, outside_client(&net.endpoint).await);
    // the manifest of a true offer
    let offer = net.hub.offer("photo", "shot").unwrap();
    offer.set(0.0, content(300_000)).unwrap();
    let mut versions = client.follow_file("photo", "shot").unwrap();
    let manifest = within(versions.changed()).await.unwrap().stamped.value.clone();
    drop(offer);
    let (dying, _) = sender(&outside, &manifest, content(300_000), 3);
    let mut download = client.download("photo", "shot").unwrap();
    let error = download.resume(Duration::from_secs(2)).await.unwrap_err();
    assert!(matches!(error, FileError::Incomplete { received: 3, chunks: 10, .. }), "{error}");
    dying.undeclare().await.unwrap();
    let (_back, asked) = sender(&outside, &manifest, content(300_000), 10);
    assert!(download.resume(DEADLINE).await.unwrap() == content(300_000));
    let mut asked = asked.lock().unwrap().clone();
    asked.sort_unstable();
    asked.dedup();
    assert_eq!(asked, (3..10).collect::<Vec<_>>());
}

#[tokio::test(flavor = "multi_thread")]
async fn wrong_content_and_absurd_manifests_are_refused() {
    let net = Net::open().await;
    let (client, outside) = (net.client().await, outside_client(&net.endpoint).await);
    let manifest = |size_bytes, chunk_bytes, chunks, sha256: &str| FileManifest {
        size_bytes,
        chunk_bytes,
        chunks,
        sha256: sha256.into(),
    };
    let huge = FILE_BYTES_MAX as u64 + 1;
    let cases = [
        (manifest(2000, 1024, 2, EMPTY_SHA256), 2000, "does not have the hash"),
        (manifest(2000, 1024, 2, EMPTY_SHA256), 1500, "476 bytes, not 976"),
        (manifest(huge, 32_000, 2098, EMPTY_SHA256), 0, "are more than"),
        (manifest(u64::MAX, u32::MAX, u32::MAX, EMPTY_SHA256), 0, "are more than"),
        (manifest(2000, 0, 2, EMPTY_SHA256), 0, "chunks of 0 bytes"),
        (manifest(2000, 1, 2000, EMPTY_SHA256), 0, "chunks of 1 bytes"),
        (manifest(2000, 1024, u32::MAX, EMPTY_SHA256), 0, "do not make"),
        (manifest(0, 1024, 0, "?chunk=1"), 0, "hash is not"),
    ];
    for (manifest, size, told) in cases {
        let (queryable, _) = sender(&outside, &manifest, content(size), 2);
        let error = client.fetch("photo", "shot", DEADLINE).await.unwrap_err();
        assert!(matches!(error, FileError::Unsound { .. }) && error.to_string().contains(told), "{error}");
        queryable.undeclare().await.unwrap();
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn what_cannot_be_offered_or_reached_is_told() {
    let net = Net::open().await;
    let offer = net.hub.offer("photo", "shot").unwrap();
    assert!(matches!(offer.set(0.0, vec![0; FILE_BYTES_MAX + 1]), Err(FileError::TooLarge(_))));
    assert!(matches!(net.hub.offer("photo", "a/b"), Err(SessionError::Key(_))));
    let absent = net.hub.fetch("photo", "absent", Duration::from_millis(200)).await.unwrap_err();
    assert!(matches!(absent, FileError::Unreachable { .. }), "{absent}");
}
