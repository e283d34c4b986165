//! `rasterd [serve]`

use super::Failure;
use rasterd::http::{App, serve::serve};
use rasterd::jobs::Renderer;
use rasterd::scene::demo;
use rasterd::scene::{ModelOptions, NewScene, Precondition, UpAxis};
use rasterd::settings::Settings;
use std::io::IsTerminal;
use tokio::net::TcpListener;
use tokio::signal::unix::{Signal, SignalKind, signal};
use tracing_subscriber::EnvFilter;

/// The id of the scene built in at start.
const DEMO: &str = "demo";

/// Serves until SIGTERM or SIGINT; a second one exits at once.
pub(super) fn run(settings: Settings) -> Result<(), Failure> {
    log_to_stderr();
    let runtime = tokio::runtime::Builder::new_multi_thread()
        .enable_all()
        .build()
        .map_err(|error| Failure::new("cannot start", error))?;
    runtime.block_on(listen_and_serve(settings))?;
    // Blocking threads whose frames were cut off end with the process, not before it.
    runtime.shutdown_background();
    Ok(())
}

async fn listen_and_serve(settings: Settings) -> Result<(), Failure> {
    let address = settings.listen;
    let listener = TcpListener::bind(address)
        .await
        .map_err(|error| Failure::new(format!("cannot listen on {address}"), error))?;
    let renderer = Renderer::new(&settings).map_err(|error| Failure::new("cannot start threads", error))?;
    let app = App::new(settings, renderer);
    put_demo(&app)?;
    let stop = stop_signals().map_err(|error| Failure::new("cannot take signals", error))?;
    // The port may have been 0, "any".
    let address = listener.local_addr().unwrap_or(address);
    tracing::info!(%address, "listening");
    serve(listener, app, first_of(stop)).await;
    tracing::info!("stopped");
    Ok(())
}

fn put_demo(app: &App) -> Result<(), Failure> {
    let new = NewScene {
        document: Some(demo::document()),
        files: Some(demo::files()),
        options: ModelOptions { up: UpAxis::Y, floor: false },
    };
    app.renderer.build(|| app.store.put(DEMO, new, &Precondition::None))?;
    Ok(())
}

fn stop_signals() -> std::io::Result<[Signal; 2]> {
    Ok([signal(SignalKind::terminate())?, signal(SignalKind::interrupt())?])
}

/// Ends with the first signal, and leaves a task behind that exits with the second.
async fn first_of(mut signals: [Signal; 2]) {
    next_of(&mut signals).await;
    tracing::info!("going down");
    tokio::spawn(async move {
        next_of(&mut signals).await;
        std::process::exit(1);
    });
}

async fn next_of([terminate, interrupt]: &mut [Signal; 2]) {
    tokio::select! {
        _ = terminate.recv() => {}
        _ = interrupt.recv() => {}
    }
}

/// One line for each event; `RASTERD_LOG` filters them (`info` without).
fn log_to_stderr() {
    let filter = EnvFilter::try_from_env("RASTERD_LOG").unwrap_or_else(|_| EnvFilter::new("info"));
    let colours = std::io::stderr().is_terminal();
    tracing_subscriber::fmt().with_env_filter(filter).with_writer(std::io::stderr).with_ansi(colours).init();
}
