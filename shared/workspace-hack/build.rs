//! No code: a build script is what makes Cargo unite the features of build dependencies.

fn main() {}
