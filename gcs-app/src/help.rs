//! The documents shipped inside, by topics: each heading begins one. Nothing is fetched from anywhere.

use crate::actions;
use crate::command::Selection;
use crate::panels::Scene;
use flight_plan::Id;
use std::sync::LazyLock;

/// The documents, the first to be read first.
const DOCUMENTS: &[(&str, &str)] = &[
    ("guide.md", include_str!("../../assets/docs/guide.md")),
    ("tutorial.md", include_str!("../../assets/docs/tutorial.md")),
    ("plan-language.md", include_str!("../../assets/docs/plan-language.md")),
    ("examples.md", include_str!("../../assets/docs/examples.md")),
    ("gateway-states.md", include_str!("../../assets/docs/gateway-states.md")),
    ("flight-tests.md", include_str!("../../assets/docs/flight-tests.md")),
    ("recordings.md", include_str!("../../assets/docs/recordings.md")),
];

macro_rules! pictures {
    ($($name:literal),* $(,)?) => {
        /// The pictures of the documents: each by the name that the documents call it by.
        pub const PICTURES: &[(&str, &[u8])] = &[$((
            concat!("pictures/", $name, ".png"),
            include_bytes!(concat!("../../assets/docs/pictures/", $name, ".png")),
        )),*];
    };
}

#[rustfmt::skip]
pictures!(
    "actions", "call", "cf", "contour", "corridor", "creeping-line", "criss-cross", "df", "expanding-square", "fa",
    "figure-eight", "ha", "hf", "hm", "intersection", "iterative-forward", "iterative-reverse", "orbit",
    "plan-alternates", "plan-coast-patrol", "plan-navaid-inspection", "plan-pipeline", "plan-search", "rf",
    "scan-interleaved", "scan", "sector", "spiral", "tf", "track-line", "tutorial-departure", "tutorial-emergency",
    "tutorial-look", "tutorial-ridge", "tutorial-scan", "tutorial-zones", "variables", "zones",
    "guide-new", "guide-drawn", "guide-plan", "guide-palette", "guide-flying", "guide-alternates", "guide-import",
    "guide-considered", "guide-decision", "guide-emergency",
);

/// What stands below one heading.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Topic {
    /// `FILE#HEADING`, as links say it.
    pub key: String,
    /// Its heading.
    pub title: String,
    /// 1 for a document, more for its parts.
    pub level: usize,
    /// Markdown, its heading included; its links lead to topics by their keys.
    pub text: String,
}

/// All topics, in reading order. They are cut out once: actions ask for them in every frame.
pub fn topics() -> &'static [Topic] {
    static TOPICS: LazyLock<Vec<Topic>> = LazyLock::new(cut);
    &TOPICS
}

fn cut() -> Vec<Topic> {
    let mut topics: Vec<Topic> = DOCUMENTS.iter().flat_map(|(file, text)| split(file, text)).collect();
    let keys: Vec<String> = topics.iter().map(|topic| topic.key.clone()).collect();
    for topic in &mut topics {
        let file = topic.key.split('#').next().unwrap_or_default();
        topic.text = with_links(&topic.text, |target| resolve(file, target, &keys));
    }
    topics.push(keys_of_actions());
    topics
}

/// The keys as they are, whatever the documents say.
fn keys_of_actions() -> Topic {
    let lines = actions::keys().map(|(name, keys)| format!("- **{keys}**: {name}\n"));
    let text = format!("# Keys\n\n{}", lines.collect::<String>());
    Topic { key: "keys".into(), title: "Keys".into(), level: 1, text }
}

/// A document, cut at its headings.
fn split(file: &str, text: &str) -> Vec<Topic> {
    let mut topics: Vec<Topic> = Vec::new();
    let mut in_code = false;
    for line in text.lines() {
        in_code ^= line.starts_with("```");
        let level = line.bytes().take_while(|b| *b == b'#').count();
        if level > 0 && !in_code {
            let title = line.trim_start_matches('#').trim();
            let key = format!("{file}#{}", anchor(title));
            let same = topics.iter().filter(|topic| topic.title == title.replace('`', "")).count();
            let key = if same == 0 { key } else { format!("{key}-{same}") };
            topics.push(Topic { key, title: title.replace('`', ""), level, text: String::new() });
        }
        if let Some(topic) = topics.last_mut() {
            topic.text.push_str(line);
            topic.text.push('\n');
        }
    }
    topics
}

/// What links call a heading.
fn anchor(title: &str) -> String {
    let kept = title.to_lowercase();
    let kept = kept.chars().filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
    kept.map(|c| if c == ' ' { '-' } else { c }).collect()
}

/// The topic that a link of a document leads to.
fn resolve(file: &str, target: &str, keys: &[String]) -> Option<String> {
    let (path, heading) = target.split_once('#').unwrap_or((target, ""));
    let wanted = format!("{}#{heading}", if path.is_empty() { file } else { path });
    keys.iter().find(|key| key.starts_with(&wanted) && (heading.is_empty() || **key == wanted)).cloned()
}

/// The text with each link's target replaced; one that leads nowhere becomes plain text, one into the web stays.
fn with_links(text: &str, to: impl Fn(&str) -> Option<String>) -> String {
    let mut out = String::new();
    let mut rest = text;
    while let Some((before, name, target, after)) = next_link(rest) {
        out.push_str(before);
        let is_picture = before.ends_with('!');
        let kept =
            if is_picture || target.starts_with("https:") { Some(target.to_owned()) } else { to(target) };
        match kept {
            Some(target) => out.push_str(&format!("[{name}]({target})")),
            None => out.push_str(name),
        }
        rest = after;
    }
    out + rest
}

/// What is before the next link, its name, its target, and what is after it.
fn next_link(text: &str) -> Option<(&str, &str, &str, &str)> {
    let middle = text.find("](")?;
    let start = text.get(..middle)?.rfind('[')?;
    let end = middle + text.get(middle..)?.find(')')?;
    Some((text.get(..start)?, text.get(start + 1..middle)?, text.get(middle + 2..end)?, text.get(end + 1..)?))
}

/// The topics that have these words, those with them in their titles first; without words, all.
pub fn search<'a>(topics: &'a [Topic], words: &str) -> Vec<&'a Topic> {
    let words: Vec<String> = words.to_lowercase().split_whitespace().map(Into::into).collect();
    let has = |text: &str| {
        let text = text.to_lowercase();
        words.iter().all(|word| text.contains(word))
    };
    let mut found: Vec<&Topic> = topics.iter().filter(|topic| has(&topic.text)).collect();
    if !words.is_empty() {
        found.sort_by_key(|topic| !has(&topic.title));
    }
    found
}

/// The key of the topic about what the operator is busy with.
pub fn topic_of(scene: &Scene<'_>) -> String {
    let heading = match &scene.view.selection {
        Some(Selection::Leg(id)) => return topic_of_leg(scene, id),
        Some(Selection::Stage(_)) => "stages",
        Some(Selection::Emergency(_)) => "emergency-plans",
        Some(Selection::Fix(_) | Selection::Runway(_)) => "fixes-and-runways",
        Some(Selection::Variable(_)) => "variables",
        Some(Selection::Zone(_)) => "zones",
        Some(Selection::Procedure(_)) => "procedures",
        None if scene.vehicle.received_s.is_some() => return "guide.md#fly".into(),
        None => return "guide.md#a-first-day-with-legwork".into(),
    };
    format!("plan-language.md#{heading}")
}

/// Legs are headed by what they are called in the document.
fn topic_of_leg(scene: &Scene<'_>, id: &Id) -> String {
    let kind = scene.document.plan().leg(id).map_or("", |context| context.leg.kind_name());
    let quoted = format!("### `{kind}`");
    let headed = topics().iter().find(|topic| topic.text.starts_with(&quoted));
    headed.map_or_else(|| "plan-language.md#legs".into(), |topic| topic.key.clone())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn every_topic_has_a_key_of_its_own_and_every_picture_is_inside() {
        let topics = topics();
        let keys: BTreeSet<&str> = topics.iter().map(|t| t.key.as_str()).collect();
        assert!(topics.len() == keys.len() && keys.len() > 80, "{} {}", topics.len(), keys.len());
        for topic in topics {
            let mut rest = topic.text.as_str();
            while let Some((before, _, target, after)) = next_link(rest) {
                let known = if before.ends_with('!') {
                    PICTURES.iter().any(|(name, _)| *name == target)
                } else {
                    keys.contains(target) || target.starts_with("https:")
                };
                assert!(known, "{}: {target}", topic.key);
                rest = after;
            }
        }
    }

    /// So that none of them goes stale.
    #[test]
    fn every_picture_of_the_window_is_made_by_a_test() {
        let tests = include_str!("../tests/window/looks.rs");
        for (name, _) in PICTURES.iter().filter(|(name, _)| name.starts_with("pictures/guide-")) {
            let made = name.trim_start_matches("pictures/").trim_end_matches(".png");
            assert!(tests.contains(&format!("\"{made}\"")), "{made}");
        }
    }

    #[test]
    fn keys_are_those_of_the_actions() {
        let topics = topics();
        let keys = &topics.iter().find(|topic| topic.key == "keys").unwrap().text;
        assert!(keys.contains("- **Ctrl+Z**: Undo\n"), "{keys}");
        let moves = keys.lines().find(|line| line.ends_with("Move what is selected up")).unwrap();
        assert!(moves.contains("Ctrl+") && moves.contains(" or Alt+"), "{moves}");
    }

    #[test]
    fn links_lead_to_topics_and_what_is_not_inside_is_no_link() {
        let keys = ["a.md#top".to_owned(), "a.md#part".to_owned(), "b.md#b".to_owned()];
        let text = "[x](#part) [y](b.md) [z](../c.xml) [w](https://w) ![p](p.png)";
        let made = with_links(text, |target| resolve("a.md", target, &keys));
        assert_eq!(made, "[x](a.md#part) [y](b.md#b) z [w](https://w) ![p](p.png)");
    }

    #[test]
    fn words_in_a_title_are_found_first() {
        let topics = topics();
        let found = search(topics, "hold until released");
        assert_eq!(found.first().map(|t| t.key.as_str()), Some("plan-language.md#hm-hold-until-released"));
        assert!(search(topics, "no such zebra").is_empty());
        assert_eq!(search(topics, "").len(), topics.len());
    }
}
