//! Heavy work of a handler, on a thread where it blocks no other request.

use super::problem::Problem;
use crate::jobs::{CancelOnDrop, Renderer};
use std::sync::atomic::Ordering;
use tokio::sync::Semaphore;

/// Scenes that are compiled at the same time: each may hold gigabytes while it is.
static COMPILATIONS: Semaphore = Semaphore::const_new(4);

/// Compiles a scene when its turn comes, on threads that `renderer` has for it. Once the caller has left it
/// does not begin any more.
pub(super) async fn compile<T, E>(
    renderer: &Renderer,
    task: impl FnOnce() -> Result<T, E> + Send + 'static,
) -> Result<T, Problem>
where
    T: Send + 'static,
    E: Into<Problem> + Send + 'static,
{
    let turn = COMPILATIONS.acquire().await.map_err(|_| Problem::internal())?;
    let renderer = renderer.clone();
    run(move || {
        let _turn = turn;
        renderer.build(task)
    })
    .await
}

/// Runs what takes its time but little memory: no turn is needed. Once the caller has left it does not
/// begin any more.
pub(super) async fn run<T, E>(task: impl FnOnce() -> Result<T, E> + Send + 'static) -> Result<T, Problem>
where
    T: Send + 'static,
    E: Into<Problem> + Send + 'static,
{
    let caller = CancelOnDrop::default();
    let gone = caller.flag();
    // Nobody waits for the error of a caller that has left.
    let unless_gone = move || match gone.load(Ordering::Relaxed) {
        false => task().map_err(Into::into),
        true => Err(Problem::internal()),
    };
    tokio::task::spawn_blocking(unless_gone).await.map_err(|_| Problem::internal())?
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;
    use std::sync::atomic::AtomicBool;
    use std::sync::mpsc;

    #[test]
    fn work_whose_caller_has_left_does_not_begin() {
        let runtime = tokio::runtime::Builder::new_current_thread().max_blocking_threads(1).build();
        let runtime = runtime.expect("a runtime");
        let begun = Arc::new(AtomicBool::new(false));
        let renderer = Renderer::new(&crate::settings::Settings::default()).expect("threads");
        let (go, gate) = mpsc::channel::<()>();
        runtime.block_on(async {
            let busy = tokio::task::spawn_blocking(move || gate.recv());
            let work = {
                let begun = Arc::clone(&begun);
                async move {
                    let task = move || {
                        begun.store(true, Ordering::Relaxed);
                        Ok::<_, Problem>(())
                    };
                    compile(&renderer, task).await
                }
            };
            let caller = tokio::spawn(work);
            tokio::task::yield_now().await; // the work now waits for the one thread
            caller.abort();
            assert!(caller.await.is_err());
            go.send(()).expect("a waiting thread");
            busy.await.expect("no panic").expect("let go");
            run(|| Ok::<_, Problem>(())).await.expect("the next one runs");
        });
        assert!(!begun.load(Ordering::Relaxed));
    }
}
