//! What a file is called that a plan is saved in first.

/// The plan's name as the name of a file; letters that folders and shells read otherwise become dashes.
pub(super) fn file_name(plan: &str, extension: &str) -> String {
    let plain = |c: char| if c.is_alphanumeric() || " -_.()".contains(c) { c } else { '-' };
    let name: String = plan.trim().chars().take(60).map(plain).collect();
    let name = name.trim_matches(['.', '-', ' ']);
    format!("{}.{extension}", if name.is_empty() { "plan" } else { name })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plans_name_becomes_the_name_of_a_file() {
        for (plan, file) in [
            ("Fire watch", "Fire watch.xml"),
            ("", "plan.xml"),
            ("../a/b", "a-b.xml"),
            (" Überflug: 7 Türme? ", "Überflug- 7 Türme.xml"),
        ] {
            assert_eq!(file_name(plan, "xml"), file);
        }
    }
}
