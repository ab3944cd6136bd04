//! What one call does to each leg of its procedure.

use super::placing::Placing;
use crate::expression::{self, substitute};
use crate::uses::SlotMut;
use crate::{Id, Leg, LegKind, Place, Problem, Value};
use geometry::LatLon;
use std::collections::HashMap;
use std::sync::Arc;

/// A call being instantiated.
pub(super) struct Frame {
    /// Of the legs' identifiers: the call's and a dot.
    pub prefix: String,
    /// Sources that replace parameters.
    pub arguments: HashMap<Id, Arc<str>>,
    pub placing: Placing,
}

impl Frame {
    /// Makes a leg of the procedure one of the call (not the legs inside it). Answers how many bytes of text that took; beyond
    /// `room` the rest stays as it is, and will not be flown.
    ///
    /// # Errors
    /// It has a position or number that can only be a constant, and the call's anchor or bearing is an expression.
    pub fn rewrite(&self, leg: &mut Leg, room: usize) -> Result<usize, Problem> {
        leg.id = self.id(&leg.id);
        leg.next = leg.next.as_ref().map(|next| self.id(next));
        if let LegKind::Intersection { branches, .. } = &mut leg.kind {
            branches.iter_mut().for_each(|b| b.next = b.next.as_ref().map(|next| self.id(next)));
        }
        let at = match leg.place() {
            Some(Place::Position(Value::Constant(p))) => Some(*p),
            _ => None,
        };
        let (mut bytes, mut fixed) = (leg.id.as_str().len(), false);
        leg.for_each_slot_mut(&mut |slot| match slot {
            _ if bytes > room => {}
            SlotMut::Number(name, value) => bytes += self.number(name, value, at),
            SlotMut::Optional(name, value) => {
                bytes += value.as_mut().map_or(0, |value| self.number(name, value, at));
            }
            SlotMut::Place(place) => bytes += self.place(place),
            SlotMut::Source(source, _) => bytes += self.source(source),
            SlotMut::Corner(corner) => match self.placing.position(*corner) {
                Value::Constant(p) => *corner = p,
                Value::Expression(_) => fixed = true,
            },
        });
        if fixed {
            let message = "an arc's centre or a polygon's corners can't follow an expression: call this procedure at a constant place and bearing, or bind the polygon to a variable";
            return Err(Problem::error("procedure-anchor", message));
        }
        Ok(bytes)
    }

    fn id(&self, id: &Id) -> Id {
        Id::new(&format!("{}{id}", self.prefix))
    }

    fn number(&self, name: &str, value: &mut Value<f64>, at: Option<LatLon>) -> usize {
        match value {
            Value::Expression(source) => self.source(source),
            Value::Constant(deg) if matches!(name, "course" | "heading" | "bearing") => {
                *value = self.placing.course(*deg, at);
                length(value)
            }
            Value::Constant(_) => 0,
        }
    }

    fn place(&self, place: &mut Place) -> usize {
        match place {
            Place::Fix(_) => 0,
            Place::Position(Value::Expression(source)) => self.source(source),
            Place::Position(value @ Value::Constant(_)) => {
                if let Value::Constant(p) = value {
                    *value = self.placing.position(*p);
                }
                length(value)
            }
        }
    }

    fn source(&self, source: &mut Arc<str>) -> usize {
        // what is too long is refused as it is
        if self.arguments.is_empty() || source.len() > expression::MAX_LENGTH {
            return 0;
        }
        let argument = |name: &str| self.arguments.get(name).map(|source| &**source);
        *source = substitute(source, &argument).into();
        source.len()
    }
}

fn length<T>(value: &Value<T>) -> usize {
    match value {
        Value::Constant(_) => 0,
        Value::Expression(source) => source.len(),
    }
}
