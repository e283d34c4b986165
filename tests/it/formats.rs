//! Pictures in every format.

use crate::client::{Client, Counts, endless, settings, triangle};
use axum::http::Method;
use exr::prelude as openexr;
use image::ImageFormat;
use rasterd::math::colour::srgb_from_linear;
use serde_json::json;
use std::io::Cursor;
use std::sync::Arc;
use std::sync::atomic::Ordering;

const STILLS: [(&str, &str); 5] = [
    ("png", "image/png"),
    ("jpg", "image/jpeg"),
    ("webp", "image/webp"),
    ("exr", "image/x-exr"),
    ("hdr", "image/vnd.radiance"),
];

/// A service with a lit sphere before a gradient: smooth shades and a sharp edge.
async fn sphere() -> Client {
    let client = Client::new();
    let document = json!({
        "camera": { "position": [0, 0, 3] },
        "meshes": { "ball": { "type": "sphere" } },
        "instances": { "ball": { "mesh": "ball", "scale": 2 } },
        "lights": { "sun": { "type": "directional", "direction": [-1, -1, -2], "color": [1, 0.7, 0.4] } },
        "render": { "width": 160, "height": 120, "samples": 4 },
    });
    client.json(Method::PUT, "/scenes/t", &document).await;
    client
}

async fn picture(client: &Client, path: &str) -> bytes::Bytes {
    let reply = client.get(&format!("/scenes/t/{path}")).await;
    assert_eq!(reply.status, 200, "{path}: {}", String::from_utf8_lossy(&reply.body));
    reply.body
}

fn rgba(bytes: &[u8], format: ImageFormat) -> image::RgbaImage {
    image::load_from_memory_with_format(bytes, format).expect("a picture").into_rgba8()
}

/// 20·log10(255 / RMSE) over red, green and blue.
fn psnr_db(a: &image::RgbaImage, b: &image::RgbaImage) -> f64 {
    assert_eq!(a.dimensions(), b.dimensions());
    let differences =
        a.pixels().zip(b.pixels()).flat_map(|(a, b)| [0, 1, 2].map(|c| f64::from(a[c].abs_diff(b[c]))));
    let mean = differences.map(|d| d * d).sum::<f64>() / (3 * a.pixels().len()) as f64;
    10.0 * (255.0 * 255.0 / mean).log10()
}

/// Straight from the file: red, green, blue, and alpha where it has one.
fn exr_pixels(bytes: &[u8]) -> (bool, Vec<[f32; 4]>) {
    use openexr::{ReadChannels, ReadLayers};
    let image = openexr::read()
        .no_deep_data()
        .largest_resolution_level()
        .rgba_channels(
            |size, channels| (channels.3.is_some(), size.width(), vec![[0.0; 4]; size.area()]),
            |(_, width, pixels), at, (r, g, b, a): (f32, f32, f32, f32)| {
                pixels[at.1 * *width + at.0] = [r, g, b, a]
            },
        )
        .first_valid_layer()
        .all_attributes()
        .from_buffered(Cursor::new(bytes))
        .expect("an EXR picture");
    let (has_alpha, _, pixels) = image.layer_data.channel_data.pixels;
    (has_alpha, pixels)
}

#[tokio::test]
async fn each_format_has_its_type_and_an_etag_of_its_own() {
    let client = Client::new();
    client.put_triangle().await;
    let mut tags = Vec::new();
    for (extension, content_type) in STILLS {
        let path = format!("/scenes/t/frame.{extension}");
        let reply = client.get(&path).await;
        assert_eq!((reply.status.as_u16(), reply.header("content-type")), (200, content_type));
        assert!(reply.header("server-timing").contains("encode;dur="));
        let head = client.call(Method::HEAD, &path, "", &[], "").await;
        assert_eq!(
            (head.body.len(), head.header("content-length")),
            (0, reply.body.len().to_string().as_str())
        );
        let accept = [("accept", content_type)];
        assert_eq!(client.get_with(&path, &accept).await.status, 200);
        client.get_with(&path, &[("accept", "text/html")]).await.problem(406);
        tags.push(reply.header("etag").to_owned());
    }
    tags.push(client.get("/scenes/t/frame.jpg?quality=81").await.header("etag").to_owned());
    assert_eq!(client.get("/scenes/t/frame.jpg?quality=80").await.header("etag"), tags[1]);
    assert_eq!(client.get("/scenes/t/frame.png?quality=81").await.header("etag"), tags[0]);
    let all = tags.len();
    tags.sort();
    tags.dedup();
    assert_eq!(tags.len(), all);
}

#[tokio::test]
async fn known_files_are_answered_without_drawing() {
    let counts = Arc::new(Counts::default());
    let (client, idle) = (Client::new(), Client::drawing_with(settings(), endless(&counts)));
    client.put_triangle().await;
    idle.put_triangle().await;
    for path in [
        "frame.jpg?quality=55",
        "frame.exr",
        "frame.zip?outputs=depth,color",
        "turntable.gif?frames=3",
        "turntable.png?frames=2",
    ] {
        let path = format!("/scenes/t/{path}");
        let tag = client.get(&path).await.header("etag").to_owned();
        assert_eq!(idle.get_with(&path, &[("if-none-match", &tag)]).await.status, 304, "{path}");
    }
    assert_eq!(counts.begun.load(Ordering::SeqCst), 0);
}

#[tokio::test]
async fn webp_has_the_pixels_of_the_png() {
    let client = sphere().await;
    for query in ["", "?background=transparent", "?output=normal", "?output=albedo"] {
        let png = rgba(&picture(&client, &format!("frame.png{query}")).await, ImageFormat::Png);
        let webp = rgba(&picture(&client, &format!("frame.webp{query}")).await, ImageFormat::WebP);
        assert!(png == webp, "{query}");
    }
}

#[tokio::test]
async fn jpeg_is_close_at_a_high_quality_and_small_at_a_low_one() {
    let client = sphere().await;
    let png = rgba(&picture(&client, "frame.png").await, ImageFormat::Png);
    let fine = picture(&client, "frame.jpg?quality=90").await;
    let psnr = psnr_db(&png, &rgba(&fine, ImageFormat::Jpeg));
    assert!(psnr > 35.0, "{psnr} dB");
    let coarse = picture(&client, "frame.jpg?quality=20").await;
    assert!(coarse.len() * 2 < fine.len(), "{} and {} bytes", coarse.len(), fine.len());
    assert_eq!(picture(&client, "frame.jpg").await, picture(&client, "frame.jpg?quality=80").await);
}

#[tokio::test]
async fn a_jpeg_of_values_shows_them_in_eight_bits() {
    let client = sphere().await;
    let png = picture(&client, "frame.png?output=depth").await;
    let png = image::load_from_memory_with_format(&png, ImageFormat::Png).expect("a picture").into_luma16();
    let jpeg = rgba(&picture(&client, "frame.jpg?output=depth&quality=100").await, ImageFormat::Jpeg);
    for (exact, shown) in png.pixels().zip(jpeg.pixels()) {
        let exact = f64::from(exact[0]) / 257.0;
        assert!((exact - f64::from(shown[0])).abs() < 3.0 && shown[0] == shown[2], "{exact} and {shown:?}");
    }
    let reply = client.get("/scenes/t/frame.jpg?output=depth").await;
    assert!(!reply.header("render-depth-range").is_empty());
    let ids = picture(&client, "frame.jpg?output=ids").await;
    assert_eq!(picture(&client, "frame.jpg?output=instance").await, ids);
}

#[tokio::test]
async fn stages_are_pictures_in_every_format_of_colours() {
    let client = sphere().await;
    for stage in ["ids", "shadow_map", "tiles", "shaded"] {
        let png = rgba(&picture(&client, &format!("frame.png?output={stage}")).await, ImageFormat::Png);
        let webp = rgba(&picture(&client, &format!("frame.webp?output={stage}")).await, ImageFormat::WebP);
        assert!(png == webp, "{stage}");
        let jpeg = picture(&client, &format!("frame.jpg?output={stage}&quality=95")).await;
        assert!(psnr_db(&png, &rgba(&jpeg, ImageFormat::Jpeg)) > 25.0, "{stage}");
        client.get(&format!("/scenes/t/frame.exr?output={stage}")).await.problem(422);
    }
}

#[tokio::test]
async fn a_transparent_jpeg_lies_over_white() {
    let client = sphere().await;
    let jpeg = picture(&client, "frame.jpg?background=transparent&quality=95").await;
    let white = picture(&client, "frame.png?background=ffffff").await;
    let psnr = psnr_db(&rgba(&jpeg, ImageFormat::Jpeg), &rgba(&white, ImageFormat::Png));
    assert!(psnr > 38.0, "{psnr} dB");
}

#[tokio::test]
async fn exr_holds_the_light_that_the_png_encodes() {
    let client = sphere().await;
    let (has_alpha, exr) = exr_pixels(&picture(&client, "frame.exr").await);
    assert!(!has_alpha);
    let png = rgba(&picture(&client, "frame.png").await, ImageFormat::Png);
    for (linear, codes) in exr.iter().zip(png.pixels()) {
        for c in 0..3 {
            let code = 255.0 * srgb_from_linear(f64::from(linear[c]).clamp(0.0, 1.0));
            assert!((code - f64::from(codes[c])).abs() <= 0.5001, "{linear:?}, {codes:?}");
        }
    }
}

#[tokio::test]
async fn a_transparent_exr_is_premultiplied_and_a_transparent_hdr_over_black() {
    let client = sphere().await;
    let (has_alpha, exr) = exr_pixels(&picture(&client, "frame.exr?background=transparent").await);
    assert!(has_alpha);
    let (_, black) = exr_pixels(&picture(&client, "frame.exr?background=000000").await);
    assert!(exr.iter().any(|pixel| pixel[3] > 0.0 && pixel[3] < 1.0));
    for (over, black) in exr.iter().zip(&black) {
        for c in 0..3 {
            assert!((over[c] - black[c]).abs() <= 1e-6, "{over:?}, {black:?}");
        }
    }
    let hdr = |query: &'static str| picture(&client, query);
    let [transparent, black] =
        [hdr("frame.hdr?background=transparent").await, hdr("frame.hdr?background=000000").await];
    assert!(transparent == black);
}

#[tokio::test]
async fn hdr_is_the_exr_within_its_precision() {
    let client = sphere().await;
    let (_, exr) = exr_pixels(&picture(&client, "frame.exr").await);
    let bytes = picture(&client, "frame.hdr").await;
    let hdr = image::load_from_memory_with_format(&bytes, ImageFormat::Hdr).expect("a picture").into_rgb32f();
    assert_eq!(hdr.dimensions(), (160, 120));
    for (exr, hdr) in exr.iter().zip(hdr.pixels()) {
        let greatest = exr[0].max(exr[1]).max(exr[2]);
        assert!((0..3).all(|c| (exr[c] - hdr[c]).abs() <= greatest / 256.0), "{exr:?}, {hdr:?}");
    }
}

#[tokio::test]
async fn a_patch_and_a_one_shot_give_every_format() {
    let client = Client::new();
    client.put_triangle().await;
    for (extension, content_type) in STILLS {
        let path = format!("/scenes/t/frame.{extension}");
        let patched = client.json(Method::POST, &path, &json!({})).await;
        let once = client.json(Method::POST, &format!("/render.{extension}"), &triangle()).await;
        let frame = client.get(&path).await;
        assert_eq!((once.status.as_u16(), once.header("content-type")), (200, content_type));
        assert!(patched.body == frame.body && once.body == frame.body, "{extension}");
    }
}

#[tokio::test]
async fn an_unknown_format_is_a_406_that_names_those_there_are() {
    let client = Client::new();
    client.put_triangle().await;
    let refused = |problem: serde_json::Value| problem["detail"].as_str().expect("a detail").to_owned();
    let detail = refused(client.get("/scenes/t/frame.bmp").await.problem(406));
    assert_eq!(detail, "pictures come as .png, .jpg, .webp, .exr, .hdr, not as .bmp");
    client.json(Method::POST, "/scenes/t/frame.bmp", &json!({})).await.problem(406);
    client.json(Method::POST, "/render.gif", &triangle()).await.problem(406);
    let detail = refused(client.get("/scenes/t/turntable.webp").await.problem(406));
    assert_eq!(detail, "turntables come as .gif, .png, not as .webp");
    client.get("/scenes/t/frame").await.problem(404);
}

#[tokio::test]
async fn what_a_format_cannot_hold_is_refused_by_name() {
    let client = Client::new();
    client.put_triangle().await;
    for path in ["frame.webp?output=depth", "frame.webp?output=instance", "turntable.gif?output=depth"] {
        let problem = client.get(&format!("/scenes/t/{path}")).await.problem(406);
        let detail = problem["detail"].as_str().expect("a detail");
        assert!(detail.contains("16-bit") && detail.ends_with("ask for .png"), "{detail}");
    }
    for path in ["frame.exr?output=normal", "frame.hdr?output=depth"] {
        let problem = client.get(&format!("/scenes/t/{path}")).await.problem(422);
        assert_eq!(problem["errors"][0]["parameter"], "output");
        let detail = problem["errors"][0]["detail"].as_str().expect("a detail");
        assert!(detail.starts_with("must be color, is "), "{detail}");
    }
    // Refused before a scene is looked at for nothing, and also where the client names a known file.
    client.get_with("/scenes/t/frame.webp?output=depth", &[("if-none-match", "*")]).await.problem(406);
}
