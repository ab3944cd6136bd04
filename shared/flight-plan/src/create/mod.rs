//! New parts of a plan from what was drawn: legs of every kind, and things that legs use. Each gets an identifier that
//! nothing else has, and values with which it can be flown; whoever drew it goes on with edits.

mod arrange;
mod beside;
mod bind;
mod binding;
mod branch;
mod course;
mod descent;
mod gather;
mod kind;
mod land_on;
mod lay_runway;
mod leave;
mod leg;
mod rearrange;
mod runway;
mod thing;
mod trial;
mod ways;

pub use crate::template::WayHome;
pub use arrange::{
    delete_legs, delete_set, duplicate, fork_around, fork_behind, loop_around, procedure_of, shift, unloop,
};
pub use beside::like_beside;
pub use bind::{Numeric, bind, bound_to, named_variable, put_at, unbind, variable_of_fix, variable_of_leg};
pub use binding::{Binding, bindings, has_bindings, place_binding, place_name};
pub use branch::{Way, begin_way, delete_leg, insert};
pub use course::{Approach, arc_centre};
pub use kind::{LegChoice, Shape};
pub use land_on::land_on;
pub use lay_runway::{lay_runway, leading_to, with_approaches};
pub use leg::{Drawn, call, convert, leg};
pub use rearrange::{
    StageSpot, are_neighbours, into_branch, relocate, relocate_stage, relocate_thing, shift_legs, shift_thing,
};
pub use runway::{lying_there, other_direction, runway};
pub use thing::{
    add_stage, emergency_plan, fix, move_fix_into_legs, own_places, remove, shift_stage, variable, zone,
};
pub(crate) use thing::{every_leg, legs_in};
pub use trial::{RUN_UP_M, is_tried, trial};
pub use ways::{delete_branch, relocate_branch, rename_branch, shift_branch, ways};

use crate::edit::lists;
use crate::{FlightPlan, Id};

impl FlightPlan {
    /// A name as an identifier that nothing in the plan has, with a number where it is taken.
    pub fn unique_id(&self, name: &str) -> Id {
        let mut taken = lists::ids(self);
        taken.extend(self.variables.iter().map(|variable| variable.name.clone()));
        lists::fresh(&Id::new(name), &taken)
    }

    /// An identifier that nothing in the plan has: `<stem>1`, `<stem>2`, …, the first that is free.
    pub fn fresh_id(&self, stem: &str) -> Id {
        let taken = lists::ids(self);
        let is_free = |id: &Id| !taken.contains(id) && self.variable(id).is_none();
        // one more candidate than there are identifiers: one of them is free
        let most = taken.len() + self.variables.len() + 1;
        (1..=most).map(|n| Id::new(&format!("{stem}{n}"))).find(is_free).unwrap_or_else(|| Id::new(stem))
    }
}

#[cfg(test)]
pub(crate) mod tests;
