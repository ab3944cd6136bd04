//! Lines on standard output.

/// `println!` for which a reader that has gone away (`legwork expand PLAN | head`) is no failure.
macro_rules! say {
    ($($line:tt)*) => {{
        use std::io::Write;
        // nobody reads any more: nothing to do about it
        let _ = writeln!(std::io::stdout().lock(), $($line)*);
    }};
}
