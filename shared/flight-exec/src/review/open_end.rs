//! What a flight goes round in for ever unless somebody or a condition ends it.

use flight_plan::{Id, Leg, LegKind, LegPath, Program};

/// Around a leg, or the leg itself: the loop without a count, the holding without laps, or the intersection whose default leads
/// back to it. `None`: it ends by itself.
pub fn open_end<'p>(program: &'p Program, leg: &Id) -> Option<&'p Leg> {
    let mut path = program.path(leg)?;
    let around = program.chain(&path);
    let is_open = |leg: &&Leg| {
        matches!(leg.kind, LegKind::Iterative { count: None, .. } | LegKind::Hm { max_laps: None, .. })
    };
    if let Some(open) = around.into_iter().find(is_open) {
        return Some(open);
    }
    while !path.indices.is_empty() {
        if let Some(fork) = leads_back(program, &path) {
            return Some(fork);
        }
        path.indices.pop();
    }
    None
}

/// The first intersection on the way that leads from a leg back to it, if nobody decides.
fn leads_back<'p>(program: &'p Program, path: &LegPath) -> Option<&'p Leg> {
    let (list, start) = (program.list(path)?, *path.indices.last()?);
    // `next` names a sibling
    let known = |next: &Id| program.path(next)?.indices.pop();
    let (mut index, mut fork) = (start, None);
    for _ in 0..list.len() {
        let leg = list.get(index)?.as_ref();
        let next = match leg.as_fork().filter(|fork| !fork.branches.is_empty()) {
            None => &leg.next,
            Some(ways) => {
                fork = fork.or(Some(leg));
                &ways.branches.iter().find(|branch| Some(&branch.id) == ways.default)?.next
            }
        };
        index = next.as_ref().map_or(Some(index + 1), known)?;
        if index == start {
            return fork;
        }
    }
    None
}

/// The conditions that end it, as they are written.
pub fn ending_conditions(open: &Leg) -> Vec<&str> {
    match &open.kind {
        LegKind::Iterative { until, .. } | LegKind::Hm { until, .. } => {
            until.as_deref().into_iter().collect()
        }
        LegKind::Intersection { branches, .. } => branches.iter().filter_map(|b| b.when.as_deref()).collect(),
        _ => Vec::new(),
    }
}
