//! What became of the last command, or else what there is to say, in the height of a button: none moves for it.

use super::bar::PUSH;
use super::{Scene, field, flight};
use crate::command::{FlyCommand, Queue, ViewCommand};
use crate::state::{Outcome, Request};
use crate::{theme, units};
use egui::text::LayoutJob;
use egui::{
    Align, Color32, FontId, Id, Label, Layout, Rect, Response, RichText, Sense, TextStyle, Ui, UiBuilder,
    vec2,
};
use flight_plan::in_words;

/// Least width of the line, screen points: where the buttons leave less, it has a row of its own. What is cut there is read by a button.
const LEAST: f32 = 50.0;
/// Of two lines in the height of a button, screen points.
const SMALL: f32 = 11.5;

/// Draws it behind the commands: pending, accepted, or refused and why, until it is put aside. Without one, the remark on the commands.
pub fn show(ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
    let rect = place(ui);
    let p = theme::of(ui);
    let mut line = ui.new_child(UiBuilder::new().max_rect(rect).layout(Layout::left_to_right(Align::Center)));
    let Some(request) = last(scene) else {
        let remark = flight::remark(scene);
        close_other_card(ui, scene, remark.as_ref().map_or("", |(text, _)| text), queue);
        if let Some((text, is_caution)) = remark {
            say(&mut line, &text, if is_caution { p.caution } else { p.weak }, queue);
        }
        return;
    };
    let (text, colour) = match &request.outcome {
        Outcome::Pending => {
            (format!("⏳ {}: pending, {}", request.label, units::age(scene.now_s - request.sent_s)), p.text)
        }
        Outcome::Accepted => (format!("✔ {}: accepted{}", request.label, waits(scene)), p.good),
        Outcome::Refused(why) => {
            if field::small_button(&mut line, "✖", "Put this answer aside") {
                queue.fly(FlyCommand::PutAnswerAside);
            }
            (format!("{}: refused, {}", request.label, why_not(scene, request, why)), p.caution)
        }
    };
    close_other_card(ui, scene, &text, queue);
    let response = say(&mut line, &text, colour, queue);
    if let Outcome::Refused(why) = &request.outcome {
        with_codes(response, why);
    }
}

/// In one line or, smaller, in two. What takes more ends with a button that shows all of it over the map.
fn say(line: &mut Ui, text: &str, colour: Color32, queue: &mut Queue) -> Response {
    let own = TextStyle::Body.resolve(line.style());
    if line.painter().layout_no_wrap(text.to_owned(), own, colour).size().x <= line.available_width() {
        return line.label(RichText::new(text).color(colour));
    }
    let small = |width| {
        let mut job = LayoutJob::simple(text.to_owned(), FontId::proportional(SMALL), colour, width);
        job.wrap.max_rows = 2;
        job
    };
    let is_cut = line.painter().layout_job(small(line.available_width())).elided;
    if is_cut && field::small_button(line, "⋯", "Read all of this answer") {
        line.data_mut(|data| data.insert_temp(Id::unique(CARD), text.to_owned()));
        queue.view(ViewCommand::Notice(text.to_owned()));
    }
    line.add(Label::new(small(line.available_width())).wrap())
}

/// What the card over the map says of this line.
const CARD: &str = "card of the answer";

/// The card over the map that was opened for this line is closed when that says something else: it may be of another flight.
fn close_other_card(ui: &Ui, scene: &Scene<'_>, said: &str, queue: &mut Queue) {
    let opened: Option<String> = ui.data(|data| data.get_temp(Id::unique(CARD)));
    if opened.is_some_and(|opened| opened != said && scene.view.notice.as_ref() == Some(&opened)) {
        queue.view(ViewCommand::DismissNotice);
    }
}

/// `, waits until 40 m above home`: what was accepted is not done yet.
fn waits(scene: &Scene<'_>) -> String {
    if scene.vehicle.autopilot_silence_s(scene.now_s).is_some() {
        return ", waits until the autopilot is heard".to_owned();
    }
    until_height(scene).map_or_else(String::new, |height| format!(", waits {height}"))
}

/// `until 40 m above home`: before, what was asked for in the climb is not done.
pub fn until_height(scene: &Scene<'_>) -> Option<String> {
    let height_m = scene.vehicle.waits_for_height_m(scene.now_s)?;
    Some(format!("until {} above home", scene.units().altitude().show(height_m)))
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

/// It says why the last command was refused, until that is put aside.
pub fn is_refused(scene: &Scene<'_>) -> bool {
    last(scene).is_some_and(|request| matches!(request.outcome, Outcome::Refused(_)))
}

/// The last command, while it is pending, or was answered a short while ago. What is refused of a plan is not said of another one.
fn last<'a>(scene: &Scene<'a>) -> Option<&'a Request> {
    let last = scene.vehicle.requests.last().filter(|request| request.is_news(scene.now_s))?;
    let is_of_another = last.version.is_some_and(|version| version != scene.document.version());
    (!is_of_another || !matches!(last.outcome, Outcome::Refused(_))).then_some(last)
}

/// Why something was refused, in words and in the names of the plan that it is about.
pub fn why_not(scene: &Scene<'_>, request: &Request, why: &str) -> String {
    told(scene, request.label == PUSH, why)
}

/// What an agent says, with words in the place of what is for programs; of the plan that is pushed, or of the one aboard.
pub fn told(scene: &Scene<'_>, is_of_push: bool, said: &str) -> String {
    let words = in_words(said);
    match &scene.vehicle.aboard {
        Some(aboard) if !is_of_push => aboard.plan.in_names(&words),
        _ => scene.document.in_names(&words),
    }
}

/// Shows what is for programs to whoever points at the words, where there is any.
pub fn with_codes(response: Response, said: &str) -> Response {
    if in_words(said) == said { response } else { response.on_hover_text(said) }
}
