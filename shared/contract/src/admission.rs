//! Who may ask, and in which version: what a service looks at before it looks at a request.

use crate::keys::SEGMENT_MAX;
use crate::{Refusal, is_segment};

/// The contract's major version. Programs of different major versions tell each other so, and do nothing else.
pub const VERSION: u32 = 1;

/// Code of the refusal of another version.
pub const OTHER_VERSION: &str = "version";

/// Name of the people at a ground station.
pub const OPERATOR: &str = "operator";

/// Who asks without a name. It is nobody's name: to say it is to say none.
pub const ANONYMOUS: &str = "anonymous";

/// Who asks, out of a request's parameter `from`; `None` is anonymous, who may only read.
///
/// # Errors
/// `bad-name` for what cannot be a name, `anonymous` where a name is needed.
pub fn check_caller(from: Option<&str>, reads_only: bool) -> Result<Option<&str>, Refusal> {
    match from.filter(|name| *name != ANONYMOUS) {
        Some(name) if is_segment(name) => Ok(Some(name)),
        Some(name) => Err(Refusal {
            code: "bad-name".into(),
            reason: format!(
                "`{}` is no name to ask under: `from` takes 1 to {SEGMENT_MAX} letters, digits, '-', '_' or '.'",
                name.chars().take(SEGMENT_MAX).collect::<String>()
            ),
        }),
        None if reads_only => Ok(None),
        None => Err(Refusal {
            code: ANONYMOUS.into(),
            reason: "a request without a name may only read: say who asks with the selector's parameter `from`, as in \
                     `?from=operator`"
                .into(),
        }),
    }
}

/// Whether a request speaks our version, out of its parameter `version`. A request that does not say one is taken at its word:
/// scripts by hand are welcome.
///
/// # Errors
/// `version`, with both versions.
pub fn check_version(version: Option<&str>) -> Result<(), Refusal> {
    let Some(theirs) = version else { return Ok(()) };
    let refuse = |reason| Err(Refusal { code: OTHER_VERSION.into(), reason });
    match theirs.parse::<u32>() {
        Ok(VERSION) => Ok(()),
        Ok(theirs) => refuse(format!(
            "this service speaks version {VERSION} of the contract, the request version {theirs}: update the older program"
        )),
        Err(_) => refuse(format!(
            "`version={}` is no version: write a whole number, as in `version={VERSION}`, or leave it out",
            theirs.chars().take(SEGMENT_MAX).collect::<String>()
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn code<T>(checked: Result<T, Refusal>) -> String {
        checked.map_or_else(|refusal| refusal.code, |_| "taken".to_owned())
    }

    #[test]
    fn who_says_no_name_may_only_read_and_a_bad_name_is_told() {
        let long = "x".repeat(65);
        // (from, when it reads, when it changes something)
        let cases = [
            (None, "taken", "anonymous"),
            (Some("anonymous"), "taken", "anonymous"),
            (Some("operator"), "taken", "taken"),
            (Some(""), "bad-name", "bad-name"),
            (Some("a b"), "bad-name", "bad-name"),
            (Some("a/b"), "bad-name", "bad-name"),
            (Some("*"), "bad-name", "bad-name"),
            (Some(long.as_str()), "bad-name", "bad-name"),
        ];
        for (from, reading, changing) in cases {
            assert_eq!(code(check_caller(from, true)), reading, "{from:?}");
            assert_eq!(code(check_caller(from, false)), changing, "{from:?}");
        }
        assert_eq!(check_caller(Some("camera"), false), Ok(Some("camera")));
        let refused = check_caller(None, false).unwrap_err();
        assert!(refused.reason.contains("?from="), "{refused}");
    }

    #[test]
    fn another_version_is_refused_with_both_and_none_is_taken() {
        let cases = [
            (None, "taken"),
            (Some("1"), "taken"),
            (Some("0"), "version"),
            (Some("2"), "version"),
            (Some("1.0"), "version"),
            (Some(""), "version"),
            (Some("-1"), "version"),
            (Some("99999999999999999999"), "version"),
        ];
        for (version, expected) in cases {
            assert_eq!(code(check_version(version)), expected, "{version:?}");
        }
        let refused = check_version(Some("2")).unwrap_err();
        assert!(refused.reason.contains("version 1") && refused.reason.contains("version 2"), "{refused}");
    }
}
