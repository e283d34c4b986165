//! `rasterd healthcheck`

use super::Failure;
use rasterd::settings::Settings;
use std::io::{Read, Write};
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr, TcpStream};
use std::time::Duration;

/// A server that takes longer is not well.
const PATIENCE: Duration = Duration::from_secs(3);

/// Takes the server's own flags and environment, so that it asks where the server listens.
#[derive(Debug, clap::Args)]
pub(super) struct Healthcheck {
    #[command(flatten)]
    settings: Box<Settings>,
}

impl Healthcheck {
    pub(super) fn run(&self) -> Result<(), Failure> {
        let address = reachable(self.settings.listen);
        let status = ask(address).map_err(|error| Failure::new(address, error))?;
        if status.starts_with("HTTP/1.1 200 ") || status.starts_with("HTTP/1.0 200 ") {
            return Ok(());
        }
        Err(Failure::new(address, format!("answers {status:?}")))
    }
}

/// The status line of `GET /healthz`.
fn ask(address: SocketAddr) -> std::io::Result<String> {
    let mut stream = TcpStream::connect_timeout(&address, PATIENCE)?;
    stream.set_read_timeout(Some(PATIENCE))?;
    stream.set_write_timeout(Some(PATIENCE))?;
    stream.write_all(b"GET /healthz HTTP/1.0\r\n\r\n")?;
    let mut reply = String::new();
    stream.take(4096).read_to_string(&mut reply)?;
    Ok(reply.lines().next().unwrap_or_default().to_owned())
}

/// A server that listens on every address is asked on loopback.
fn reachable(listen: SocketAddr) -> SocketAddr {
    let ip = match listen.ip() {
        IpAddr::V4(ip) if ip.is_unspecified() => IpAddr::V4(Ipv4Addr::LOCALHOST),
        IpAddr::V6(ip) if ip.is_unspecified() => IpAddr::V6(Ipv6Addr::LOCALHOST),
        ip => ip,
    };
    SocketAddr::new(ip, listen.port())
}
