//! `/scenes/{id}/files`.

use crate::client::Client;
use axum::body::Body;
use axum::http::Method;

#[tokio::test]
async fn a_file_is_added_read_replaced_and_removed() {
    let client = Client::new();
    client.put_triangle().await;
    let path = "/scenes/t/files/some%20notes.txt";
    let put = |text: &'static str| client.call(Method::PUT, path, "application/octet-stream", &[], text);
    let added = put("one").await;
    assert_eq!((added.status.as_u16(), added.header("location")), (201, path));
    assert_eq!(client.get("/scenes/t/files").await.json()[0]["name"], "some notes.txt");
    assert_eq!(put("two!").await.status, 200);

    let read = client.get(path).await;
    assert_eq!(&read.body[..], b"two!");
    assert_eq!(read.header("content-type"), "application/octet-stream");
    assert_eq!(read.header("x-content-type-options"), "nosniff");
    let again = client.get_with(path, &[("if-none-match", read.header("etag"))]).await;
    assert_eq!(again.status, 304);

    let remove = || client.call(Method::DELETE, path, "", &[], Body::empty());
    assert_eq!(remove().await.status, 204);
    remove().await.problem(404);
    client.get(path).await.problem(404);
}

#[tokio::test]
async fn a_file_changes_under_the_scenes_etag() {
    let client = Client::new();
    let etag = client.put_triangle().await.header("etag").to_owned();
    let put = |tag: &str| {
        let (client, tag) = (client.clone(), tag.to_owned());
        async move { client.call(Method::PUT, "/scenes/t/files/a", "", &[("if-match", tag.as_str())], "a").await }
    };
    assert_eq!(put(&etag).await.status, 201);
    put(&etag).await.problem(412);
}

#[tokio::test]
async fn if_none_match_keeps_a_file_from_being_replaced() {
    let client = Client::new();
    client.put_triangle().await;
    let headers = [("if-none-match", "*")];
    let put = || client.call(Method::PUT, "/scenes/t/files/a", "", &headers, "a");
    assert_eq!(put().await.status, 201);
    put().await.problem(412);
}

#[tokio::test]
async fn a_name_with_a_path_in_it_is_refused() {
    let client = Client::new();
    client.put_triangle().await;
    for name in ["a%2Fb", "..%5Cb", "a%0Ab"] {
        client.call(Method::PUT, &format!("/scenes/t/files/{name}"), "", &[], "x").await.problem(422);
    }
}
