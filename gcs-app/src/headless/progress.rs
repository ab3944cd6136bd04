//! Progress on standard error, for work that takes longer than a moment. A terminal sees it, a file or a pipe doesn't.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

/// What is done sooner shows no progress.
const MOMENT: Duration = Duration::from_secs(1);
/// So often it moves.
const TICK: Duration = Duration::from_millis(120);
/// How work is shown that doesn't know how much of it there is.
const SPINNER: &str = "{spinner} {msg}, {elapsed}";

/// A bar of this looks.
pub fn bar(template: &str) -> ProgressBar {
    let bar = ProgressBar::new(0);
    // without its style the bar is plain
    bar.set_style(ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar()));
    bar
}

/// Does work of which only is known that it goes on; `what` is being done.
pub fn busy<T>(what: &'static str, work: impl FnOnce() -> T) -> T {
    let spinner = bar(SPINNER).with_message(what);
    shown(&spinner, work)
}

/// Does work, and shows its bar from a second on until it ends.
pub fn shown<T>(bar: &ProgressBar, work: impl FnOnce() -> T) -> T {
    bar.set_draw_target(ProgressDrawTarget::hidden());
    let (done, waiting) = channel::<()>();
    let result = std::thread::scope(|scope| {
        scope.spawn(move || {
            if waiting.recv_timeout(MOMENT) == Err(RecvTimeoutError::Timeout) {
                bar.set_draw_target(ProgressDrawTarget::stderr());
                bar.enable_steady_tick(TICK);
            }
        });
        let result = work();
        drop(done);
        result
    });
    // the thread has ended: nothing shows the bar again
    bar.finish_and_clear();
    result
}
