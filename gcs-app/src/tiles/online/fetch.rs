//! One tile from a server, by HTTP.

use super::MAX_BYTES;
use reqwest::header::{CACHE_CONTROL, ETAG, HeaderMap, HeaderName, IF_NONE_MATCH, RETRY_AFTER};
use reqwest::{Client, Response, StatusCode, Url, redirect};
use std::time::Duration;
use tokio::runtime::{Builder, Runtime};

/// Who asks.
const USER_AGENT: &str = concat!("legwork/", env!("CARGO_PKG_VERSION"));
/// A server that answers no sooner is not there.
const CONNECT: Duration = Duration::from_secs(10);
/// A tile that takes longer is not had.
const WHOLE: Duration = Duration::from_secs(30);
/// How long a tile is fresh when the server does not say, seconds: a week, as OpenStreetMap asks for.
const DEFAULT_S: u64 = 7 * 24 * 3600;
/// Whatever a server says, it is not asked again sooner than in an hour, and asked again after 30 days.
const LIMITS_S: (u64, u64) = (3600, 30 * 24 * 3600);
/// Longest mark of a tile's version that is kept, bytes.
const LONGEST_TAG: usize = 200;

/// What a server said.
#[derive(Debug)]
pub enum Fetched {
    /// A tile; without bytes, it has none there.
    Tile {
        /// A picture, if the server is right.
        bytes: Vec<u8>,
        /// The mark of its version.
        tag: String,
        /// It stays fresh for so long, seconds.
        lifetime_s: u64,
    },
    /// The tile of that mark is still the right one.
    Same {
        /// It stays fresh for so long from now, seconds.
        lifetime_s: u64,
    },
    /// It is larger than a tile has any reason to be.
    TooLarge,
}

/// Why there is no answer.
#[derive(Debug)]
pub struct Trouble {
    /// In words.
    pub why: String,
    /// The server asks for such a pause.
    pub asked: Duration,
}

impl From<reqwest::Error> for Trouble {
    fn from(error: reqwest::Error) -> Self {
        Self { why: error.to_string(), asked: Duration::ZERO }
    }
}

/// Something that can be asked for.
///
/// # Errors
/// It is no address of the web.
pub fn check(url: &str) -> Result<(), String> {
    let url = Url::parse(url).map_err(|error| format!("that is no address ({error})"))?;
    match url.scheme() {
        "http" | "https" if url.has_host() => Ok(()),
        _ => Err("the address must begin with https:// or http://".into()),
    }
}

/// Asks a server. Several threads may at a time.
pub struct Fetcher {
    client: Client,
    runtime: Option<Runtime>,
}

impl Fetcher {
    /// Asks this server.
    ///
    /// # Errors
    /// A sentence: this machine can't.
    pub fn new(host: &str) -> Result<Self, String> {
        // another part of the program may have installed one: it serves as well
        let _ = rustls::crypto::ring::default_provider().install_default();
        let builder = Client::builder()
            .user_agent(USER_AGENT)
            .connect_timeout(CONNECT)
            .timeout(WHOLE)
            .redirect(redirect::Policy::limited(3));
        let is_here = ["localhost", "127.0.0.1", "[::1]"].iter().any(|here| host.starts_with(here));
        let builder = if is_here { builder.no_proxy() } else { builder };
        let cannot = |error: String| format!("nothing can be asked of servers ({error})");
        let client = builder.build().map_err(|error| cannot(error.to_string()))?;
        let runtime =
            Builder::new_multi_thread().worker_threads(1).thread_name("online tiles").enable_all().build();
        Ok(Self { client, runtime: Some(runtime.map_err(|error| cannot(error.to_string()))?) })
    }

    /// Asks for a tile, unless it still has this mark.
    ///
    /// # Errors
    /// The server can't be reached, or does not give it now.
    pub fn fetch(&self, url: &str, tag: &str) -> Result<Fetched, Trouble> {
        let Some(runtime) = &self.runtime else {
            return Err(Trouble { why: "it has ended".into(), asked: Duration::ZERO });
        };
        runtime.block_on(async {
            let request = self.client.get(url);
            let request = if tag.is_empty() { request } else { request.header(IF_NONE_MATCH, tag) };
            let mut response = request.send().await?;
            let lifetime_s = lifetime_s(text(response.headers(), CACHE_CONTROL));
            match response.status() {
                StatusCode::OK => body(&mut response, lifetime_s).await,
                StatusCode::NOT_MODIFIED => Ok(Fetched::Same { lifetime_s }),
                StatusCode::NOT_FOUND | StatusCode::GONE | StatusCode::NO_CONTENT => {
                    Ok(Fetched::Tile { bytes: Vec::new(), tag: String::new(), lifetime_s })
                }
                status => {
                    let asked = text(response.headers(), RETRY_AFTER).parse::<u32>().unwrap_or(0);
                    Err(Trouble { why: status.to_string(), asked: Duration::from_secs(asked.into()) })
                }
            }
        })
    }
}

impl Drop for Fetcher {
    fn drop(&mut self) {
        // whoever drops it does not wait for a look-up of a name
        if let Some(runtime) = self.runtime.take() {
            runtime.shutdown_background();
        }
    }
}

async fn body(response: &mut Response, lifetime_s: u64) -> Result<Fetched, Trouble> {
    let tag = text(response.headers(), ETAG);
    let tag = if tag.len() <= LONGEST_TAG { tag.to_owned() } else { String::new() };
    let mut bytes = Vec::new();
    while let Some(chunk) = response.chunk().await? {
        if bytes.len() + chunk.len() > MAX_BYTES {
            return Ok(Fetched::TooLarge);
        }
        bytes.extend_from_slice(&chunk);
    }
    Ok(Fetched::Tile { bytes, tag, lifetime_s })
}

fn text(headers: &HeaderMap, name: HeaderName) -> &str {
    headers.get(name).and_then(|value| value.to_str().ok()).unwrap_or_default()
}

/// How long what a server sent stays fresh, from its `Cache-Control`.
fn lifetime_s(control: &str) -> u64 {
    let mut parts = control.split(',').map(str::trim);
    let stated = parts.clone().find_map(|part| part.strip_prefix("max-age=")?.trim_matches('"').parse().ok());
    let again = parts.any(|part| part == "no-cache" || part == "no-store");
    if again { LIMITS_S.0 } else { stated.unwrap_or(DEFAULT_S).clamp(LIMITS_S.0, LIMITS_S.1) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn freshness_is_what_the_server_says_within_limits() {
        for (control, expected) in [
            ("", DEFAULT_S),
            ("max-age=86400", 86_400),
            ("public, max-age=7200, stale-if-error=60", 7200),
            ("max-age=0", 3600),
            ("no-cache, max-age=86400", 3600),
            ("max-age=99999999999", 30 * 86_400),
            ("max-age=much", DEFAULT_S),
        ] {
            assert_eq!(lifetime_s(control), expected, "{control}");
        }
    }
}
