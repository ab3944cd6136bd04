//! Legs of a list that become one: a loop or a call in their place.

use super::arrange::list_of;
use super::rearrange::{leads_to, led_to, replaced};
use crate::{Edit, FlightPlan, Id, Leg};
use std::sync::Arc;

/// Legs that become one.
pub(super) struct Gathered {
    /// The legs, in their order; the last names nothing that follows it.
    pub legs: Vec<Arc<Leg>>,
    /// What follows the one that they become, if it is not the next of its list.
    pub next: Option<Id>,
    /// The legs that led to the first of them lead to that one.
    pub led: Vec<Edit>,
}

/// Gathers legs of a list, in their order, into the leg `one`. `None`: a way leads out of their middle, or into it.
pub(super) fn gather(plan: &FlightPlan, legs: &[Id], one: &Id) -> Option<Gathered> {
    let (first, last) = (legs.first()?, legs.last()?);
    let (list, _) = list_of(plan, first)?;
    let is_among = |id: &Id| legs.contains(id);
    let (inside, outside): (Vec<_>, Vec<_>) = list.iter().cloned().partition(|leg| is_among(&leg.id));
    let leads_out = |leg: &Arc<Leg>| leads_to(leg).into_iter().any(|to| !is_among(to));
    let is_fork_or_before = |leg: &Arc<Leg>| leg.id != *last || leg.as_fork().is_some();
    let leads_inside = |leg: &Arc<Leg>| leads_to(leg).into_iter().any(|to| is_among(to) && to != first);
    if inside.iter().any(|leg| is_fork_or_before(leg) && leads_out(leg)) || outside.iter().any(leads_inside) {
        return None;
    }
    let next = inside.last()?.next.clone().filter(|next| !is_among(next));
    let freed = |leg: Arc<Leg>| match next.is_some() && leg.id == *last {
        true => Arc::new(Leg { next: None, ..leg.as_ref().clone() }),
        false => leg,
    };
    let led = outside.iter().filter(|leg| leads_to(leg).contains(&first));
    Some(Gathered {
        led: led.map(|leg| replaced(led_to(leg, first, one))).collect(),
        legs: inside.into_iter().map(freed).collect(),
        next,
    })
}
