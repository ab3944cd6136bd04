//! The legs of a stage: from a flat list that refers to itself to legs inside legs.

use super::Reader;
use super::leg::{kind_of, named};
use super::listed::{listed, spaced};
use crate::mission::jumps;
use crate::mission::placed::leg;
use crate::xml::{Element, held};
use flight_plan::{Branch, DecideBefore, Id, IterativeForm, Leg, LegKind, TurnDirection, Value};
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// Deepest nest of loops.
const MAX_DEPTH: usize = 8;
/// When a decision is due, seconds before the fork.
const DECIDE_BEFORE_S: f64 = 30.0;

/// The legs of a stage as they are written, by their place in the document.
pub(super) struct Flat<'a> {
    pub(super) legs: Vec<&'a Element>,
    /// Their identifiers in the document, and in the plan.
    pub(super) names: Vec<String>,
    ids: Vec<Id>,
    pub(super) index: HashMap<String, usize>,
    known: HashSet<String>,
    /// The loop that each is in.
    inside: Vec<Option<usize>>,
    /// The bodies of the loops.
    bodies: HashMap<usize, Vec<usize>>,
    /// Legs that the stage ends with.
    pub(super) last: HashSet<usize>,
}

impl Flat<'_> {
    fn listed(&self, text: &str) -> Vec<String> {
        listed(text, &self.known)
    }

    /// How deep in loops a leg is.
    fn depth(&self, leg: usize) -> usize {
        std::iter::successors(Some(leg), |leg| self.inside.get(*leg).copied().flatten())
            .take(MAX_DEPTH + 2)
            .count()
    }

    /// A leg is in a loop, or is that loop.
    fn is_in(&self, leg: usize, outer: usize) -> bool {
        let mut way = std::iter::successors(Some(leg), |leg| self.inside.get(*leg).copied().flatten())
            .take(MAX_DEPTH + 2);
        way.any(|leg| leg == outer)
    }
}

/// Where it goes on behind a leg.
#[derive(Debug, Clone, Copy, PartialEq)]
enum After {
    /// With this leg of the same list.
    Leg(usize),
    /// Where the list ends.
    End,
}

impl Reader<'_> {
    /// The legs of a stage.
    pub(super) fn legs(&mut self, stage: &Element, of: &Id) -> Vec<Arc<Leg>> {
        let mut flat = self.flat(stage);
        let mut list: Vec<usize> =
            (0..flat.legs.len()).filter(|leg| flat.inside.get(*leg) == Some(&None)).collect();
        let initial = flat.listed(stage.text_of("initialLegs"));
        match initial.first() {
            Some(first) => self.first(&flat, &mut list, Some(first)),
            None => self.begin_by_next(&mut flat, &mut list, stage),
        }
        self.list(&flat, &list, of, false)
    }

    fn flat<'e>(&mut self, stage: &'e Element) -> Flat<'e> {
        let legs: Vec<&Element> = stage.children.iter().filter(|c| c.name == "leg").collect();
        let names: Vec<String> =
            legs.iter().map(|leg| spaced(leg.attribute("id").unwrap_or_default())).collect();
        let ids = names.iter().map(|name| self.names.take(name, "leg")).collect();
        let mut index = HashMap::new();
        for (at, name) in names.iter().enumerate() {
            if index.insert(name.clone(), at).is_some() {
                let place = legs.get(at).map_or(String::new(), |leg| leg.place());
                self.notes.push(
                    "same-id",
                    place,
                    format!("there are several legs `{name}`: the last one is meant"),
                );
            }
        }
        let known = names.iter().cloned().collect();
        let inside = vec![None; legs.len()];
        let mut flat =
            Flat { legs, names, ids, index, known, inside, bodies: HashMap::new(), last: HashSet::new() };
        let last = flat.listed(stage.text_of("finalLegs"));
        flat.last = last.iter().filter_map(|name| flat.index.get(name).copied()).collect();
        for at in 0..flat.legs.len() {
            self.body(&mut flat, at);
        }
        flat
    }

    /// Takes the legs of a loop into it.
    fn body(&mut self, flat: &mut Flat<'_>, at: usize) {
        let Some(element) = flat.legs.get(at).copied().filter(|leg| kind_of(leg) == "iterative") else {
            return;
        };
        let end = |name: &str| flat.index.get(&spaced(element.text_of(name))).copied();
        let mut members: Vec<usize> = self.found(flat, Some(element), "body").into_iter().flatten().collect();
        if members.is_empty() {
            members =
                end("first").zip(end("last")).map_or(Vec::new(), |(first, last)| (first..=last).collect());
        }
        let members = self.with_branches(flat, members, end("last"));
        for name in flat.listed(element.text_of("body")).iter().filter(|name| !flat.index.contains_key(*name))
        {
            self.unknown(element, name);
        }
        let mut body = Vec::new();
        for member in members {
            let taken = flat.inside.get(member).copied().flatten().is_some();
            if taken || flat.is_in(at, member) || flat.depth(at) > MAX_DEPTH {
                let name = flat.names.get(member).map_or("", String::as_str);
                let message = format!(
                    "leg `{name}` is in several loops, in itself or too deep: it stays outside of this one"
                );
                self.notes.push("bad-body", element.place(), message);
            } else if let Some(inside) = flat.inside.get_mut(member) {
                *inside = Some(at);
                body.push(member);
            }
        }
        self.first(flat, &mut body, Some(&spaced(element.text_of("first"))));
        flat.bodies.insert(at, body);
    }

    /// The legs that a child of a leg names; `None`: not one of this stage.
    pub(super) fn found(&self, flat: &Flat<'_>, element: Option<&Element>, list: &str) -> Vec<Option<usize>> {
        let text = element.map_or("", |element| element.text_of(list));
        flat.listed(text).iter().map(|name| flat.index.get(name).copied()).collect()
    }

    /// A name of a leg that the stage has not. Another stage may have it: that is where this one leads.
    fn unknown(&mut self, element: &Element, name: &str) {
        if !self.ids.iter().any(|id| *id == name) {
            self.notes.push(
                "unknown-leg",
                element.place(),
                format!("there is no leg `{name}` in this file: it is left out"),
            );
        }
    }

    /// Brings the leg that a list begins with to its front.
    pub(super) fn first(&mut self, flat: &Flat<'_>, list: &mut [usize], name: Option<&String>) {
        let first = name.and_then(|name| flat.index.get(name));
        if let Some(at) = first.and_then(|first| list.iter().position(|leg| leg == first))
            && let Some(front) = list.get_mut(..=at)
        {
            front.rotate_right(1);
        }
    }

    /// A list of legs: of the stage, or of a loop's body. `of`: whose list it is; empty if nothing in it is flown.
    fn list(&mut self, flat: &Flat<'_>, list: &[usize], of: &Id, is_body: bool) -> Vec<Arc<Leg>> {
        let made: Vec<(usize, Leg)> =
            list.iter().filter_map(|at| self.made(flat, *at).map(|leg| (*at, leg))).collect();
        if made.iter().all(|(_, leg)| matches!(leg.kind, LegKind::Intersection { .. })) {
            return Vec::new();
        }
        let order = self.order(flat, list, made.iter().map(|(at, _)| *at).collect(), is_body);
        let end = Id::new(&format!("{of}.end"));
        let mut legs: Vec<Leg> = Vec::new();
        for (number, (at, mut leg)) in made.into_iter().enumerate() {
            let behind = order.kept.get(number + 1).copied();
            let name = |after| order.named(flat, after, behind, &end);
            if let LegKind::Intersection { branches, .. } = &mut leg.kind {
                let heads = self.found(flat, flat.legs.get(at).copied(), "nextList");
                for (branch, head) in branches.iter_mut().zip(heads) {
                    if head.is_some_and(|head| !order.after.contains_key(&head)) {
                        let place = flat.legs.get(at).map_or(String::new(), |fork| fork.place());
                        let message = format!(
                            "branch `{}` leads into or out of a loop, which no branch can: it goes on where the legs around the fork end",
                            branch.id
                        );
                        self.notes.push("branch-across-loop", place, message);
                    }
                    branch.next = name(order.goal(head.map_or(After::End, After::Leg)));
                }
            } else {
                leg.next = name(order.goal(order.after.get(&at).copied().unwrap_or(After::End)));
            }
            legs.push(leg);
        }
        if legs.iter().any(|leg| leads_to(leg, &end)) {
            legs.push(merge(end));
        }
        legs.into_iter().map(Arc::new).collect()
    }

    /// Where it goes on behind each leg of a list.
    fn order(&mut self, flat: &Flat<'_>, list: &[usize], kept: Vec<usize>, is_body: bool) -> Order {
        let place: HashMap<usize, usize> = list.iter().enumerate().map(|(at, leg)| (*leg, at)).collect();
        let heads: HashSet<usize> = list.iter().flat_map(|leg| self.heads(flat, *leg)).collect();
        let mut after = HashMap::new();
        for (at, leg) in list.iter().enumerate() {
            let Some(element) = flat.legs.get(*leg) else { continue };
            let behind =
                list.get(at + 1).filter(|behind| !heads.contains(behind) && !flat.last.contains(leg));
            let named = spaced(next_of(element));
            let next = match (named.is_empty(), flat.index.get(&named)) {
                (true, _) => behind.copied(),
                (false, Some(next)) if place.contains_key(next) => Some(*next),
                (false, found) => {
                    if found.is_none() {
                        self.unknown(element, &named);
                    }
                    // a body says itself what its order is
                    behind.filter(|_| is_body).copied()
                }
            };
            after.insert(*leg, next.map_or(After::End, After::Leg));
        }
        Order { after, kept_ones: kept.iter().copied().collect(), kept }
    }

    /// A leg, with what is inside of it; where it leads is set later.
    fn made(&mut self, flat: &Flat<'_>, at: usize) -> Option<Leg> {
        let (element, id) = (*flat.legs.get(at)?, flat.ids.get(at)?.clone());
        let kind = match kind_of(element).as_str() {
            "iterative" => self.iterative(flat, at, element, &id)?,
            "intersection" => self.intersection(flat, element, &id),
            _ => return self.track(element, id),
        };
        self.unknown_parts(element);
        let mut made = leg(id, kind);
        made.name = held(named(element)).trim().to_owned();
        Some(made)
    }

    fn iterative(&mut self, flat: &Flat<'_>, at: usize, element: &Element, id: &Id) -> Option<LegKind> {
        let body = flat.bodies.get(&at).map_or(&[][..], Vec::as_slice);
        let body = self.list(flat, body, id, true);
        if body.is_empty() {
            let message = "a loop without a leg that can be flown is left out";
            self.notes.push("empty-loop", element.place(), message);
            return None;
        }
        let count = self.number(element, &["upperBound"]).filter(|count| *count >= 1.0);
        if count.is_none() {
            let message = format!("a loop without an upper bound is flown until `{}`", jumps::ENOUGH);
            self.notes.push("endless-loop", element.place(), message);
        }
        Some(LegKind::Iterative {
            form: IterativeForm::Forward,
            until: count.is_none().then(|| jumps::ENOUGH.into()),
            count: count.map(Value::Constant),
            turn: TurnDirection::Right,
            body,
        })
    }

    fn intersection(&mut self, flat: &Flat<'_>, element: &Element, id: &Id) -> LegKind {
        let names = flat.listed(element.text_of("nextList"));
        names
            .iter()
            .filter(|name| !flat.index.contains_key(*name))
            .for_each(|name| self.unknown(element, name));
        let branch = |name: &String| {
            let at = flat.index.get(name).copied();
            let label = at.and_then(|at| flat.legs.get(at)).map_or(name.as_str(), |leg| named(leg));
            let id = at.and_then(|at| flat.ids.get(at)).map_or_else(|| Id::new("on"), Id::clone);
            Branch { id, label: held(label).trim().to_owned(), next: None, when: None }
        };
        let branches: Vec<Branch> = names.iter().map(branch).collect();
        let default = branches.first().map(|branch| branch.id.clone());
        if branches.len() > 1 {
            let message = format!(
                "fork `{id}` takes its first branch unless somebody decides: the file names no default"
            );
            self.notes.push("default-branch", element.place(), message);
        }
        LegKind::Intersection { branches, default, decide_before: DecideBefore::Time(DECIDE_BEFORE_S) }
    }
}

/// Where it goes on in a list.
struct Order {
    after: HashMap<usize, After>,
    /// The legs that could be carried, in order.
    kept: Vec<usize>,
    kept_ones: HashSet<usize>,
}

impl Order {
    /// What follows, past legs that could not be carried.
    fn goal(&self, mut after: After) -> After {
        for _ in 0..self.after.len() {
            match after {
                After::Leg(leg) if !self.kept_ones.contains(&leg) => {
                    after = self.after.get(&leg).copied().unwrap_or(After::End);
                }
                found => return found,
            }
        }
        After::End
    }

    /// What a leg has to name to lead there, if that is not what stands behind it. `end`: where a list ends that goes on.
    fn named(&self, flat: &Flat<'_>, after: After, behind: Option<usize>, end: &Id) -> Option<Id> {
        match after {
            After::Leg(next) if Some(next) == behind => None,
            After::Leg(next) => flat.ids.get(next).cloned(),
            After::End => behind.map(|_| end.clone()),
        }
    }
}

/// The leg that comes after one, as its text names it: of the leg, or of its destination.
pub(super) fn next_of(element: &Element) -> &str {
    let next = element.text_of("next");
    if next.is_empty() { element.child("dest").map_or("", |dest| dest.text_of("next")) } else { next }
}

fn leads_to(leg: &Leg, end: &Id) -> bool {
    let branches =
        if let LegKind::Intersection { branches, .. } = &leg.kind { branches.as_slice() } else { &[] };
    leg.next.iter().chain(branches.iter().filter_map(|branch| branch.next.as_ref())).any(|next| next == end)
}

/// Where branches meet.
fn merge(id: Id) -> Leg {
    let decide_before = DecideBefore::Time(DECIDE_BEFORE_S);
    leg(id, LegKind::Intersection { branches: Vec::new(), default: None, decide_before })
}
