//! The door with real sockets, in front of a hub that only echoes batches.

use super::*;
use crate::inside::Inside;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::UnixListener;

const PATIENCE: Duration = Duration::from_secs(30);
const BATCH: [u8; 5] = [3, 0, b'a', b'b', b'c'];

/// A hub that gives everything back, and the number of connections that it has got.
fn echo(inside: &Inside) -> watch::Receiver<usize> {
    let listener = UnixListener::bind(inside.address().as_path()).unwrap();
    let (count, counted) = watch::channel(0);
    tokio::spawn(async move {
        while let Ok((mut client, _)) = listener.accept().await {
            count.send_modify(|count| *count += 1);
            tokio::spawn(async move {
                let (mut says, mut hears) = client.split();
                tokio::io::copy(&mut says, &mut hears).await
            });
        }
    });
    counted
}

async fn opened(inside: &Inside) -> (Door, String) {
    let probe = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let address = probe.local_addr().unwrap().to_string();
    drop(probe);
    (Door::open(&format!("tcp/{address}"), inside.address()).await.unwrap(), address)
}

async fn in_time<T>(what: impl Future<Output = T>) -> T {
    tokio::time::timeout(PATIENCE, what).await.expect("in time")
}

async fn let_in(address: &str) -> TcpStream {
    let mut client = TcpStream::connect(address).await.unwrap();
    for _ in 0..2 {
        client.write_all(&BATCH).await.unwrap();
        let mut answer = [0; BATCH.len()];
        in_time(client.read_exact(&mut answer)).await.unwrap();
        assert_eq!(answer, BATCH);
    }
    client
}

/// The other side has closed it.
async fn is_closed(client: &mut TcpStream) {
    let ended = in_time(client.read(&mut [0; 8])).await;
    assert!(ended.as_ref().is_ok_and(|n| *n == 0) || ended.is_err(), "{ended:?}");
}

#[tokio::test]
async fn who_is_let_in_is_served_while_idle_connections_are_closed_and_told() {
    let inside = Inside::new().unwrap();
    let counted = echo(&inside);
    let (mut door, address) = opened(&inside).await;
    let mut first = let_in(&address).await;
    let mut idle = Vec::new();
    for _ in 0..300 {
        idle.push(TcpStream::connect(&address).await.unwrap());
    }
    assert!(in_time(door.changed()).await, "a flood is told");
    let mut second = let_in(&address).await;
    for client in &mut idle {
        is_closed(client).await;
    }
    assert_eq!(*counted.borrow(), 2, "who says nothing never came to the hub");
    for client in [&mut first, &mut second] {
        client.write_all(&BATCH).await.unwrap();
        in_time(client.read_exact(&mut [0; BATCH.len()])).await.unwrap();
    }
}

#[tokio::test]
async fn what_the_hub_ends_is_ended_and_a_hub_that_is_not_there_too() {
    let inside = Inside::new().unwrap();
    let (_door, address) = opened(&inside).await;
    let mut early = TcpStream::connect(&address).await.unwrap();
    early.write_all(&BATCH).await.unwrap();
    is_closed(&mut early).await;
    let listener = UnixListener::bind(inside.address().as_path()).unwrap();
    let mut client = TcpStream::connect(&address).await.unwrap();
    client.write_all(&BATCH).await.unwrap();
    let (mut at_hub, _) = in_time(listener.accept()).await.unwrap();
    at_hub.write_all(&[1, 0, 7, 2, 0, 8, 9]).await.unwrap();
    in_time(client.read_exact(&mut [0; 7])).await.unwrap();
    drop(at_hub);
    is_closed(&mut client).await;
}

#[tokio::test]
async fn a_port_in_use_or_no_port_is_refused_in_words() {
    let inside = Inside::new().unwrap();
    let (_door, address) = opened(&inside).await;
    for (endpoint, told) in [
        (format!("tcp/{address}"), "check that nothing else listens there"),
        ("nonsense".into(), "tcp/127.0.0.1:7447"),
        ("tcp/nowhere:x".into(), "nowhere"),
    ] {
        let refused = Door::open(&endpoint, inside.address()).await.err().expect("refused");
        assert!(format!("{refused:#}").contains(told), "{refused:#}");
    }
}
