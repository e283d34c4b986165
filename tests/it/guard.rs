//! Calls that another site makes through a visitor's browser.

use crate::client::{Client, settings};
use axum::http::Method;
use rasterd::settings::Settings;
use std::net::SocketAddr;

async fn post(client: &Client, headers: &[(&str, &str)]) -> u16 {
    client.call(Method::POST, "/scenes", "application/json", headers, "{}").await.status.as_u16()
}

#[tokio::test]
async fn changes_from_another_site_are_refused() {
    let client = Client::new();
    let host = ("host", "localhost:8080");
    for (headers, status) in [
        (vec![host], 201),
        (vec![host, ("sec-fetch-site", "same-origin")], 201),
        (vec![host, ("sec-fetch-site", "none")], 201),
        (vec![host, ("origin", "http://localhost:8080")], 201),
        (vec![host, ("sec-fetch-site", "cross-site")], 403),
        (vec![host, ("sec-fetch-site", "same-site")], 403),
        (vec![host, ("origin", "http://evil.example")], 403),
        (vec![host, ("origin", "http://localhost:9090")], 403),
        (vec![host, ("origin", "null")], 403),
    ] {
        assert_eq!(post(&client, &headers).await, status, "{headers:?}");
    }
}

#[tokio::test]
async fn reading_from_another_site_is_not_a_change() {
    let client = Client::new();
    assert_eq!(client.get_with("/scenes", &[("sec-fetch-site", "cross-site")]).await.status, 200);
}

#[tokio::test]
async fn on_loopback_only_loopbacks_names_are_served() {
    let client = Client::new();
    for host in ["localhost", "localhost:8080", "127.0.0.1:8080", "127.1.2.3", "[::1]:8080"] {
        assert_eq!(client.get_with("/scenes", &[("host", host)]).await.status, 200, "{host}");
    }
    for host in ["evil.example", "evil.example:8080", "192.168.0.1", "not a host"] {
        client.get_with("/scenes", &[("host", host)]).await.problem(403);
    }
    client.get("http://evil.example/scenes").await.problem(403);
    assert_eq!(client.get("/scenes").await.status, 200);
}

#[tokio::test]
async fn further_names_can_be_allowed() {
    let client = Client::with(Settings { allow_hosts: vec!["render.example".to_owned()], ..settings() });
    assert_eq!(client.get_with("/scenes", &[("host", "Render.example")]).await.status, 200);
    client.get_with("/scenes", &[("host", "evil.example")]).await.problem(403);
}

#[tokio::test]
async fn beyond_loopback_any_name_is_served() {
    let client = Client::with(Settings { listen: SocketAddr::from(([0, 0, 0, 0], 8080)), ..settings() });
    assert_eq!(client.get_with("/scenes", &[("host", "render.example")]).await.status, 200);
}
