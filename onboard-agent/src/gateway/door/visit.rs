//! One connection at the port: its bytes go to the hub and back, once it has said something.

use super::batches::Batches;
use super::guests::{Id, Input};
use crate::inside::{Address, Stream};
use std::io;
use std::time::Duration;
use tokio::io::{AsyncRead, AsyncReadExt, AsyncWrite, AsyncWriteExt};
use tokio::net::TcpStream;
use tokio::sync::mpsc::Sender;

/// Bytes that are on their way in one direction of a connection.
const CHUNK: usize = 16 << 10;
/// Batches by which the hub lets somebody in: its answers to the two halves of the handshake.
const LET_IN: u32 = 2;
/// Who takes nothing for so long is gone.
const STUCK: Duration = Duration::from_secs(10);

/// A connection until its end.
pub struct Visit {
    pub id: Id,
    pub client: TcpStream,
    pub hub: Address,
    pub reports: Sender<Input>,
}

impl Visit {
    /// Serves it. It ends by itself, or is dropped.
    pub async fn attend(mut self) -> io::Result<()> {
        self.client.set_nodelay(true)?;
        let Some(mut hub) = self.handshake().await? else { return Ok(()) };
        self.report(Input::LetIn(self.id)).await;
        let (client_says, client_hears) = self.client.split();
        let (hub_says, hub_hears) = hub.split();
        // whoever ends first, ends both: Zenoh has no use for half a connection
        tokio::select! {
            ended = carry(client_says, hub_hears) => ended,
            ended = carry(hub_says, client_hears) => ended,
        }
    }

    /// Carries bytes until the hub lets it in. A stranger who says nothing costs the hub nothing.
    async fn handshake(&mut self) -> io::Result<Option<Stream>> {
        let (mut said, mut answered) = (vec![0; CHUNK], vec![0; CHUNK]);
        let mut count = self.client.read(&mut said).await?;
        if count == 0 {
            return Ok(None);
        }
        let mut hub = self.hub.connect().await?;
        let mut batches = Batches::default();
        loop {
            if count > 0 {
                self.report(Input::Spoke(self.id)).await;
                hub.write_all(said.get(..count).unwrap_or_default()).await?;
            }
            tokio::select! {
                read = self.client.read(&mut said) => match read? {
                    0 => return Ok(None),
                    more => count = more,
                },
                read = hub.read(&mut answered) => {
                    count = 0;
                    let bytes = answered.get(..read?).unwrap_or_default();
                    if bytes.is_empty() {
                        return Ok(None);
                    }
                    self.client.write_all(bytes).await?;
                    batches.take(bytes);
                    if batches.whole() >= LET_IN {
                        return Ok(Some(hub));
                    }
                }
            }
        }
    }

    async fn report(&self, what: Input) {
        // without a door there is nobody to be told
        let _ = self.reports.send(what).await;
    }
}

/// One direction. What is read waits until it is taken, so that a slow reader slows the writer down.
async fn carry(mut from: impl AsyncRead + Unpin, mut to: impl AsyncWrite + Unpin) -> io::Result<()> {
    let mut bytes = vec![0; CHUNK];
    loop {
        let count = from.read(&mut bytes).await?;
        if count == 0 {
            return Ok(());
        }
        let mut rest = bytes.get(..count).unwrap_or_default();
        while !rest.is_empty() {
            let taken = tokio::time::timeout(STUCK, to.write(rest)).await??;
            if taken == 0 {
                return Err(io::ErrorKind::WriteZero.into());
            }
            rest = rest.get(taken..).unwrap_or_default();
        }
    }
}
