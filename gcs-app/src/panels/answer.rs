//! What became of the last command, in one line: no button moves for it.

use super::bar::PUSH;
use super::{Scene, field};
use crate::command::{FlyCommand, Queue};
use crate::state::{Outcome, Request};
use crate::{theme, units};
use egui::{Align, Label, Layout, Rect, RichText, Sense, Ui, UiBuilder, vec2};

/// Least width of the line, screen points: where the buttons leave less, it has a row of its own.
const LEAST: f32 = 120.0;

/// Draws it behind the commands: pending, accepted, or refused and why, until it is put aside.
pub fn show(ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
    let rect = place(ui);
    let Some(request) = last(scene) else { return };
    let p = theme::of(ui);
    let mut line = ui.new_child(UiBuilder::new().max_rect(rect).layout(Layout::left_to_right(Align::Center)));
    let (text, colour) = match &request.outcome {
        Outcome::Pending => {
            (format!("⏳ {}: pending, {}", request.label, units::age(scene.now_s - request.sent_s)), p.text)
        }
        Outcome::Accepted => (format!("✔ {}: accepted", request.label), p.good),
        Outcome::Refused(why) => {
            if field::small_button(&mut line, "✖", "Put this answer aside") {
                queue.fly(FlyCommand::PutAnswerAside);
            }
            (format!("{}: refused, {}", request.label, why_not(scene, request, why)), p.caution)
        }
    };
    line.add(Label::new(RichText::new(text).color(colour)).truncate());
}

/// It is taken, whatever is said there: nothing moves under the pointer when something is.
fn place(ui: &mut Ui) -> Rect {
    let mut width = ui.available_size_before_wrap().x;
    if width < LEAST {
        ui.end_row();
        width = ui.available_size_before_wrap().x;
    }
    ui.allocate_exact_size(vec2(width - 1.0, ui.spacing().interact_size.y), Sense::hover()).0
}

/// The last command, while it is pending, or was answered a short while ago. What is refused of a plan is not said of another one.
fn last<'a>(scene: &Scene<'a>) -> Option<&'a Request> {
    let last = scene.vehicle.requests.last().filter(|request| request.is_news(scene.now_s))?;
    let is_of_another = last.version.is_some_and(|version| version != scene.document.version());
    (!is_of_another || !matches!(last.outcome, Outcome::Refused(_))).then_some(last)
}

/// In the names of the plan that it is about.
pub fn why_not(scene: &Scene<'_>, request: &Request, why: &str) -> String {
    let quoted = quoted(why);
    match &scene.vehicle.aboard {
        Some(aboard) if request.label != PUSH => aboard.plan.in_names(&quoted),
        _ => scene.document.in_names(&quoted),
    }
}

/// Problems as an agent lists them (`35:7: error [too-steep] o2: climb earlier; …`) without what is for programs: `` `o2`: climb earlier ``.
fn quoted(why: &str) -> String {
    let problems = why.split("; ").map(|part| problem(part).unwrap_or_else(|| part.to_owned()));
    problems.collect::<Vec<_>>().join("; ")
}

fn problem(listed: &str) -> Option<String> {
    let (place, rest) = listed.split_once(" [").filter(|(place, _)| place.ends_with("error"))?;
    let is_place = place.chars().all(|c| c.is_ascii_digit() || ": error".contains(c));
    let (_code, said) = rest.split_once("] ").filter(|_| is_place)?;
    Some(match said.split_once(": ") {
        Some((subject, said)) if !subject.contains([' ', '`']) => format!("`{subject}`: {said}"),
        _ => said.to_owned(),
    })
}

#[cfg(test)]
mod tests {
    use super::quoted;

    #[test]
    fn what_is_for_programs_is_left_out_of_a_refusal() {
        for (why, told) in [
            (
                "35:7: error [too-steep] o2: climb earlier: it is 20 % too steep; error [energy] land it; and 3 more",
                "`o2`: climb earlier: it is 20 % too steep; land it; and 3 more",
            ),
            ("the flight is over; propose it again", "the flight is over; propose it again"),
            ("no [brackets] here: none", "no [brackets] here: none"),
        ] {
            assert_eq!(quoted(why), told);
        }
    }
}
