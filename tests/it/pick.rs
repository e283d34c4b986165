//! `/scenes/{id}/pick`.

use crate::client::Client;

#[tokio::test]
async fn the_middle_of_the_triangle_is_the_triangle() {
    let client = Client::new();
    client.put_triangle().await;
    let pick = client.get("/scenes/t/pick?x=16&y=12").await.json();
    assert_eq!(pick["instance"], "only");
    assert_eq!(pick["mesh"], "triangle");
    assert_eq!(pick["triangle"], 0);
    assert!((pick["depth"].as_f64().expect("a distance") - 3.0).abs() < 1e-6);
}

#[tokio::test]
async fn the_background_is_nothing() {
    let client = Client::new();
    client.put_triangle().await;
    let pick = client.get("/scenes/t/pick?x=0&y=0").await.json();
    for member in ["instance", "mesh", "triangle", "depth", "position"] {
        assert!(pick[member].is_null(), "{member}");
    }
}

#[tokio::test]
async fn a_pixel_must_be_named_and_lie_in_the_picture() {
    let client = Client::new();
    client.put_triangle().await;
    let problem = client.get("/scenes/t/pick?x=a").await.problem(422);
    assert_eq!(problem["errors"].as_array().map(Vec::len), Some(2), "{problem}");
    let problem = client.get("/scenes/t/pick?x=32&y=0").await.problem(422);
    assert_eq!(problem["errors"][0]["parameter"], "x");
    assert_eq!(client.get("/scenes/t/pick?x=32&y=0&width=64").await.status, 200);
}
