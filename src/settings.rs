//! Flags and environment → [`Settings`]. A flag goes before its variable, that before the default.

mod simd;

pub use simd::Simd;

use crate::limits::Limits;
use crate::plan::Elisions;
use std::net::{SocketAddr, ToSocketAddrs};
use std::num::NonZeroUsize;
use std::time::Duration;

/// What every command has in common: the machine's part in drawing. None of it changes a picture.
#[derive(Clone, Debug, clap::Args)]
pub struct Machine {
    /// Threads that draw [default: as many as the machine runs at once]
    #[arg(long, env = "RASTERD_THREADS", value_name = "N")]
    pub threads: Option<NonZeroUsize>,

    /// SIMD level: sse2, sse4.2, avx2, avx512, neon, or scalar in builds that carry it [default:
    /// the best the machine has]
    #[arg(long, env = "RASTERD_SIMD", value_name = "LEVEL")]
    pub simd: Option<Simd>,

    /// What may be left out where the picture stays the same: all, none, or names with commas between
    #[arg(long, env = "RASTERD_ELIDE", value_name = "all|none|LIST", default_value = "all")]
    pub elide: Elisions,
}

/// Everything a server can be told at its start.
#[derive(Clone, Debug, clap::Args)]
pub struct Settings {
    /// Address and port to listen on
    #[arg(long, env = "RASTERD_LISTEN", value_name = "ADDR", default_value = "127.0.0.1:8080", value_parser = address)]
    pub listen: SocketAddr,

    /// What threads and instructions to draw with.
    #[command(flatten)]
    pub machine: Machine,

    /// Frames drawn at the same time; they share the threads
    #[arg(long, env = "RASTERD_RENDERS", value_name = "N", default_value = "2")]
    pub renders: NonZeroUsize,

    /// Frames that may wait for their turn; one more is answered 503
    #[arg(long, env = "RASTERD_QUEUE", value_name = "N", default_value_t = 64)]
    pub queue: u16,

    /// Seconds a frame may take, waiting included; beyond is a 504
    #[arg(long, env = "RASTERD_FRAME_SECONDS", value_name = "S", default_value = "30", value_parser = seconds)]
    pub frame_seconds: Duration,

    /// Seconds a client may take to send a request's headers
    #[arg(long, env = "RASTERD_HEADER_SECONDS", value_name = "S", default_value = "10", value_parser = seconds)]
    pub header_seconds: Duration,

    /// Seconds a client may take to send a request's body; beyond is a 408
    #[arg(long, env = "RASTERD_BODY_SECONDS", value_name = "S", default_value = "60", value_parser = seconds)]
    pub body_seconds: Duration,

    /// Connections open at the same time; further ones wait
    #[arg(long, env = "RASTERD_CONNECTIONS", value_name = "N", default_value = "1024")]
    pub connections: NonZeroUsize,

    /// Host names served while listening on loopback, beside localhost (a proxy's, for example)
    #[arg(long, env = "RASTERD_ALLOW_HOSTS", value_name = "NAMES", value_delimiter = ',')]
    pub allow_hosts: Vec<String>,

    /// Bytes of a request's body
    #[arg(long, env = "RASTERD_MAX_BODY_BYTES", value_name = "N", default_value_t = Limits::default().body_bytes)]
    pub max_body_bytes: u64,

    /// Bytes of working memory for one frame
    #[arg(long, env = "RASTERD_MAX_FRAME_BYTES", value_name = "N", default_value_t = Limits::default().frame_bytes)]
    pub max_frame_bytes: u64,

    /// Bytes of the decoded meshes and textures of one scene
    #[arg(long, env = "RASTERD_MAX_SCENE_BYTES", value_name = "N", default_value_t = Limits::default().scene_bytes)]
    pub max_scene_bytes: u64,

    /// Bytes of all scenes together; beyond is a 507
    #[arg(long, env = "RASTERD_MAX_TOTAL_BYTES", value_name = "N", default_value_t = Limits::default().total_bytes)]
    pub max_total_bytes: u64,
}

impl Settings {
    /// The limits as these settings move them.
    #[must_use]
    pub fn limits(&self) -> Limits {
        Limits {
            body_bytes: self.max_body_bytes,
            frame_bytes: self.max_frame_bytes,
            scene_bytes: self.max_scene_bytes,
            total_bytes: self.max_total_bytes,
            ..Limits::default()
        }
    }
}

impl Settings {
    /// What the environment says, and the defaults where it says nothing.
    ///
    /// # Errors
    /// A variable that makes no sense.
    pub fn from_environment() -> Result<Self, clap::Error> {
        use clap::{Args, Command, FromArgMatches};
        let command = Self::augment_args(Command::new("rasterd"));
        Self::from_arg_matches(&command.try_get_matches_from(["rasterd"])?)
    }
}

/// For tests and embedding: the defaults, whatever the environment says.
impl Default for Settings {
    fn default() -> Self {
        let limits = Limits::default();
        Self {
            listen: SocketAddr::from(([127, 0, 0, 1], 8080)),
            machine: Machine::default(),
            renders: NonZeroUsize::MIN.saturating_add(1),
            queue: 64,
            frame_seconds: Duration::from_secs(30),
            header_seconds: Duration::from_secs(10),
            body_seconds: Duration::from_secs(60),
            connections: NonZeroUsize::MIN.saturating_add(1023),
            allow_hosts: Vec::new(),
            max_body_bytes: limits.body_bytes,
            max_frame_bytes: limits.frame_bytes,
            max_scene_bytes: limits.scene_bytes,
            max_total_bytes: limits.total_bytes,
        }
    }
}

impl Default for Machine {
    fn default() -> Self {
        Self { threads: None, simd: None, elide: Elisions::ALL }
    }
}

/// An address with a port, or a host name with one that resolves to an address.
fn address(text: &str) -> Result<SocketAddr, String> {
    let mut addresses = text.to_socket_addrs().map_err(|error| error.to_string())?;
    addresses.next().ok_or_else(|| "resolves to no address".to_owned())
}

/// Seconds above 0, fractions allowed, at most a day: beyond, a bound is none.
fn seconds(text: &str) -> Result<Duration, String> {
    let seconds: f64 = text.parse().map_err(|_| "must be a number of seconds".to_owned())?;
    if seconds > 0.0 && seconds <= 86_400.0 {
        Ok(Duration::from_secs_f64(seconds))
    } else {
        Err("must lie in (0, 86400]".to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    #[derive(Parser)]
    struct Flags {
        #[command(flatten)]
        settings: Settings,
    }

    #[test]
    fn no_flags_give_the_defaults() {
        let flags = Flags::try_parse_from(["rasterd"]).expect("the defaults parse").settings;
        assert_eq!(format!("{flags:?}"), format!("{:?}", Settings::default()));
    }

    #[test]
    fn seconds_are_positive_and_finite() {
        assert_eq!(seconds("0.5"), Ok(Duration::from_millis(500)));
        for text in ["0", "-1", "nan", "inf", "1e300", "soon"] {
            assert!(seconds(text).is_err(), "{text}");
        }
    }

    #[test]
    fn limits_follow_their_settings() {
        let settings = Settings { max_body_bytes: 7, max_total_bytes: 9, ..Settings::default() };
        assert_eq!(settings.limits(), Limits { body_bytes: 7, total_bytes: 9, ..Limits::default() });
    }
}
