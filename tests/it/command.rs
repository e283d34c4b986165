//! The command line.

use crate::client::{Client, TRIANGLE_OBJ, png_size, triangle};
use axum::body::Body;
use axum::http::Method;
use std::io::{BufRead, BufReader};
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};

/// A folder that is gone after the test.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str, files: &[(&str, &str)]) -> Self {
        let path = std::env::temp_dir().join(format!("rasterd-command-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&path).expect("a folder");
        for (file, text) in files {
            std::fs::write(path.join(file), text).expect("a file");
        }
        Self(path)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn rasterd() -> Command {
    Command::new(env!("CARGO_BIN_EXE_rasterd"))
}

fn render(folder: &Folder, arguments: &[&str]) -> Output {
    rasterd().arg("render").args(arguments).current_dir(&folder.0).output().expect("a run")
}

fn error(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[tokio::test]
async fn render_writes_the_bytes_that_the_server_sends() {
    let folder = Folder::new("same", &[("scene.json", &triangle().to_string()), ("m.obj", TRIANGLE_OBJ)]);
    let client = Client::new();
    client.put_triangle().await;

    let output = render(&folder, &["scene.json", "-o", "-", "--orbit", "-30,20", "--samples", "4"]);
    assert!(output.status.success(), "{}", error(&output));
    assert_eq!(output.stdout, client.get("/scenes/t/frame.png?orbit=-30,20&samples=4").await.body);

    let output = render(&folder, &["m.obj", "-o", "out.png", "--width=20", "--height=10", "--threads", "1"]);
    assert!(output.status.success(), "{}", error(&output));
    let written = std::fs::read(folder.0.join("out.png")).expect("a picture");
    assert_eq!(png_size(&written), (20, 10));
}

#[tokio::test]
async fn a_document_of_the_gallery_is_drawn_with_what_lies_beside_it() {
    let folder = Folder::new("gallery", &[]);
    let document = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/gallery/figure.json");
    let output = render(&folder, &[document, "-o", "-", "--width", "80", "--height", "60"]);
    assert!(output.status.success() && output.stderr.is_empty(), "{}", error(&output));
    let client = Client::new();
    let path = "/render.png?from=figure&width=80&height=60";
    assert_eq!(output.stdout, client.call(Method::POST, path, "", &[], Body::empty()).await.body);
}

#[tokio::test]
async fn the_ending_says_what_is_written() {
    let folder = Folder::new("endings", &[("scene.json", &triangle().to_string())]);
    let client = Client::new();
    client.put_triangle().await;
    for (file, flags, path) in [
        ("a.JPEG", &["--quality", "30"][..], "frame.jpg?quality=30"),
        ("a.webp", &[], "frame.webp"),
        ("a.exr", &[], "frame.exr"),
        ("a.hdr", &[], "frame.hdr"),
        ("a.gif", &["--frames", "3", "--orbit", "0,30"], "turntable.gif?frames=3&orbit=0,30"),
        ("a.apng", &["--frames", "2"], "turntable.png?frames=2"),
        ("a.zip", &["--outputs", "color,depth"], "frame.zip?outputs=color,depth"),
    ] {
        let output = render(&folder, &[&["scene.json", "-o", file], flags].concat());
        assert!(output.status.success(), "{file}: {}", error(&output));
        let sent = client.get(&format!("/scenes/t/{path}")).await;
        assert_eq!(sent.status, 200, "{path}");
        assert!(std::fs::read(folder.0.join(file)).expect("a file") == sent.body, "{file}");
    }
    let unknown = render(&folder, &["scene.json", "-o", "a.bmp"]);
    assert!(error(&unknown).contains(".png, .jpg, .webp, .exr, .hdr"), "{}", error(&unknown));
}

#[test]
fn bad_input_exits_1_with_the_servers_words() {
    let folder = Folder::new("bad", &[("broken.json", "{"), ("wrong.json", "{\"lamps\": {}, \"cam\": {}}")]);
    let run = |arguments: &[&str]| {
        let output = render(&folder, arguments);
        assert_eq!(output.status.code(), Some(1), "{arguments:?}");
        error(&output)
    };
    assert!(run(&["broken.json", "-o", "-"]).contains("not JSON: EOF while parsing"));
    assert!(run(&["wrong.json", "-o", "-"]).contains("/lamps: "));
    assert!(run(&["none.obj", "-o", "-"]).contains("none.obj"));
    assert!(run(&["wrong.json", "-o", "-", "--width", "0"]).contains("width: must lie in"));
    assert!(run(&["wrong.json", "-o", "x.gif", "--frames", "0"]).contains("frames: must lie in"));
}

#[test]
fn warnings_that_nobody_reads_stop_nothing() {
    let model = format!("{TRIANGLE_OBJ}\nmtllib missing.mtl\n");
    let folder = Folder::new("deaf", &[("m.obj", &model)]);
    let warned = render(&folder, &["m.obj", "-o", "heard.png", "--width=8", "--height=8"]);
    assert!(warned.status.success() && error(&warned).contains("missing.mtl"), "{}", error(&warned));
    for arguments in [["m.obj", "-o", "deaf.png"], ["m.obj", "-o", "none/deaf.png"]] {
        let (reader, writer) = std::io::pipe().expect("a pipe");
        drop(reader);
        let mut command = rasterd();
        command.arg("render").args(arguments).args(["--width=8", "--height=8"]);
        let status = command.current_dir(&folder.0).stderr(writer).status().expect("a run");
        assert_eq!(status.code(), Some(i32::from(arguments[2] == "none/deaf.png")), "{arguments:?}");
    }
}

#[test]
fn two_models_of_one_name_are_refused() {
    let folder = Folder::new("twice", &[("a.obj", TRIANGLE_OBJ)]);
    std::fs::create_dir_all(folder.0.join("d")).expect("a folder");
    std::fs::write(folder.0.join("d/a.obj"), TRIANGLE_OBJ).expect("a file");
    let output = render(&folder, &["a.obj", "d/a.obj", "-o", "-"]);
    assert_eq!(output.status.code(), Some(1));
    let error = error(&output);
    assert!(error.contains("two files are named \"a.obj\": a.obj and d/a.obj"), "{error}");
}

#[test]
fn wrong_usage_exits_2() {
    for arguments in [
        &["render"][..],
        &["--listen", "nowhere"],
        &["paint"],
        &["render", "a.obj", "-o", "-", "--simd", "mmx"],
        &["render", "a.obj", "-o", "-", "--elide", "shadow"],
        &["render", "a.obj", "-o", "a.bmp"],
        &["render", "a.obj", "-o", "a.png", "--frames", "3"],
    ] {
        let output = rasterd().args(arguments).output().expect("a run");
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {}", error(&output));
    }
}

#[test]
fn a_server_is_healthy_until_it_is_told_to_stop() {
    let mut server =
        rasterd().args(["--listen", "127.0.0.1:0"]).stderr(Stdio::piped()).spawn().expect("a server");
    let mut lines = BufReader::new(server.stderr.take().expect("its log")).lines();
    let address = lines
        .find_map(|line| Some(line.ok()?.split_once("address=")?.1.trim().to_owned()))
        .expect("an address");

    let check = || rasterd().args(["healthcheck", "--listen", &address]).status().expect("a run").code();
    assert_eq!(check(), Some(0));
    let stopped = Command::new("kill").args(["-TERM", &server.id().to_string()]).status().expect("a run");
    assert!(stopped.success());
    assert_eq!(server.wait().expect("an end").code(), Some(0));
    assert_eq!(check(), Some(1));
}

#[test]
fn a_selftest_prints_each_case_beside_its_bound() {
    let selftest = |arguments: &[&str]| {
        let output = rasterd().arg("selftest").args(arguments).output().expect("a run");
        (output.status.code(), String::from_utf8_lossy(&output.stdout).into_owned(), error(&output))
    };
    let (code, table, said) = selftest(&["b5", "B31", "--threads", "1"]);
    assert_eq!(code, Some(0), "{said}");
    assert!(table.starts_with("case  metric") && table.contains("\nB31 ") && table.contains("not offered"));
    let (code, rows, _) = selftest(&["B5", "--json"]);
    let rows: serde_json::Value = serde_json::from_str(&rows).expect("JSON");
    assert_eq!((code, &rows[0]["case"], &rows[0]["outcome"]), (Some(0), &"B5".into(), &"holds".into()));
    let (code, _, said) = selftest(&["B51"]);
    assert_eq!((code, said.contains("B51")), (Some(1), true), "{said}");
}
