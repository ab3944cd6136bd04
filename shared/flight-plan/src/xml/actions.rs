//! Actions of a document, read and written: `<action on="start">` (or `end`, or `abeam` with a place; or `afterDistance`,
//! `afterTime`, `every` with a number) around one act.

use super::cursor::Element;
use super::read::Document;
use super::write::{Tag, Writer};
use crate::{Act, LegAction, Problem, Trigger};

const ACTS: &str = "photo, photoStop, videoStart, videoStop, set, invoke, wait";

#[derive(Clone, Copy)]
enum On {
    Start,
    End,
    Abeam,
}

pub(super) fn write(out: &mut Writer, action: &LegAction) {
    let tag = Tag::new("action");
    let tag = match &action.trigger {
        Trigger::Start => tag.with("on", "start"),
        Trigger::End => tag.with("on", "end"),
        Trigger::Abeam(place) => tag.with("on", "abeam").place(place, "at"),
        Trigger::Distance(metres) => tag.value("afterDistance", metres),
        Trigger::Every(metres) => tag.value("every", metres),
        Trigger::Time(seconds) => tag.value("afterTime", seconds),
    };
    out.element(tag, |out| out.leaf(act(&action.act)));
}

fn act(act: &Act) -> Tag {
    match act {
        Act::Photo => Tag::new("photo"),
        Act::PhotoSeries { every_m } => Tag::new("photo").value("every", every_m),
        Act::PhotoStop => Tag::new("photoStop"),
        Act::VideoStart => Tag::new("videoStart"),
        Act::VideoStop => Tag::new("videoStop"),
        Act::Set { variable, to } => Tag::new("set").with("variable", variable).source("to", to),
        Act::Invoke { service, operation, argument } => Tag::new("invoke")
            .with("service", service)
            .with("operation", operation)
            .text("argument", argument),
        Act::Wait { seconds } => Tag::new("wait").value("seconds", seconds),
    }
}

impl<'a> Document<'a> {
    pub(super) fn action(&mut self, element: Element<'a>) -> Option<LegAction> {
        let trigger = self.trigger(&element);
        let mut act = None;
        while let Some(child) = self.cursor.child(&element) {
            match self.act(&child) {
                Some(found) if act.is_none() => {
                    act = Some(found);
                    self.cursor.close(child);
                }
                Some(_) => self
                    .cursor
                    .refuse(child, "an <action> has exactly one act: give this one an <action> of its own"),
                None => self.cursor.unknown(child, "action", ACTS),
            }
        }
        self.cursor.finish(&element);
        if act.is_none() {
            let message = format!("say in <action> what is done: one of {ACTS}");
            self.cursor.report(Problem::error("missing-element", message).at(element.location));
        }
        Some(LegAction { trigger: trigger?, act: act? })
    }

    fn trigger(&mut self, element: &Element<'a>) -> Option<Trigger> {
        const ON: [(&str, On); 3] = [("start", On::Start), ("end", On::End), ("abeam", On::Abeam)];
        let on = self.choice(element, "on", &ON).map(|on| match on {
            On::Start => Trigger::Start,
            On::End => Trigger::End,
            On::Abeam => Trigger::Abeam(self.place(element, "at")),
        });
        let distance = self.value(element, "afterDistance").map(Trigger::Distance);
        let every = self.value(element, "every").map(Trigger::Every);
        let time = self.value(element, "afterTime").map(Trigger::Time);
        const WAYS: [&str; 4] = ["on", "afterDistance", "afterTime", "every"];
        if WAYS.iter().filter(|way| element.attributes.has(way)).count() != 1 {
            let message = "say when in exactly one way: `on`, `afterDistance`, `afterTime` or `every`";
            self.cursor.report(Problem::error("missing-attribute", message).at(element.location));
        }
        on.or(distance).or(every).or(time)
    }

    fn act(&mut self, element: &Element<'a>) -> Option<Act> {
        Some(match element.name {
            "photo" => match self.value(element, "every") {
                Some(every_m) => Act::PhotoSeries { every_m },
                None => Act::Photo,
            },
            "photoStop" => Act::PhotoStop,
            "videoStart" => Act::VideoStart,
            "videoStop" => Act::VideoStop,
            "set" => Act::Set {
                variable: self
                    .reference(element, "variable")
                    .unwrap_or_else(|| self.missing(element, "variable")),
                to: self.required_source(element, "to"),
            },
            "invoke" => Act::Invoke {
                service: self.required_text(element, "service"),
                operation: self.required_text(element, "operation"),
                argument: self.text(element, "argument"),
            },
            "wait" => Act::Wait { seconds: self.required_value(element, "seconds") },
            _ => return None,
        })
    }
}
