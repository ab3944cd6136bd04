//! Lines on standard output.

/// `println!` that gives an error where the line can't be written; a reader that has gone away (`legwork expand PLAN | head`) is
/// no failure.
macro_rules! say {
    ($($line:tt)*) => { stdio::line(format_args!($($line)*)) };
}
