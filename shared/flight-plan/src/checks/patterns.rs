//! `bad-pattern`: radii, counts, widths or routes that give no pattern.

use super::Inspection;
use super::remedy::changed;
use super::spacings::spacing_m;
use super::step::Step;
use crate::{Edit, Leg, LegKind, Pattern, Place, Problem, Value};

/// Radii and widths beyond this are mistakes, metres.
pub(super) const LARGEST_M: f64 = 200_000.0;
/// Most points of a route, passes, loops or turns.
const MAX_POINTS: usize = 10_000;
const MAX_PASSES: f64 = 12.0;
const MAX_LOOPS: f64 = 10_000.0;
const MAX_TURNS: f64 = 1e6;
/// Two points of a route that are nearer than this are one, metres.
const SAME_PLACE_M: f64 = 1.0;

pub(super) fn check(view: &Inspection, step: &Step, problems: &mut Vec<Problem>) {
    let LegKind::Pattern(pattern) = &step.leg.kind else { return };
    let leg = &step.leg;
    for (message, fix) in Faults::of(view, step, pattern) {
        problems.push(Problem::error("bad-pattern", message).of(&leg.id).perhaps_fixed_by(fix));
    }
}

/// What is wrong with one pattern.
struct Faults<'a> {
    view: &'a Inspection<'a>,
    step: &'a Step,
    leg: &'a Leg,
    found: Vec<(String, Option<Edit>)>,
}

impl<'a> Faults<'a> {
    fn of(view: &'a Inspection<'a>, step: &'a Step, pattern: &Pattern) -> Vec<(String, Option<Edit>)> {
        let mut faults = Self { view, step, leg: &step.leg, found: Vec::new() };
        faults.pattern(pattern);
        faults.found
    }

    fn pattern(&mut self, pattern: &Pattern) {
        match pattern {
            Pattern::Spiral { inner_radius_m, outer_radius_m, .. } => {
                self.size("outer radius", outer_radius_m);
                self.spiral(inner_radius_m, outer_radius_m);
            }
            Pattern::ExpandingSquare { radius_m, .. } => self.size("radius", radius_m),
            Pattern::Sector { radius_m, sectors, passes, .. } => {
                self.size("radius", radius_m);
                self.sectors(sectors);
                self.whole("passes", passes, MAX_PASSES);
            }
            Pattern::TrackLine { route, .. } => {
                self.route(route);
                self.beside();
            }
            Pattern::Corridor { route, width_m, .. } => {
                self.route(route);
                self.size("width", width_m);
            }
            Pattern::Contour { loops, inward, .. } => match loops {
                Some(loops) => self.whole("loops", loops, MAX_LOOPS),
                None if !inward => self.report("say how many `loops` there are outside the area".into()),
                None => {}
            },
            Pattern::FigureEight { radius_m, turns, .. } => {
                self.size("radius", radius_m);
                self.whole("turns", turns, MAX_TURNS);
            }
        }
    }

    fn report(&mut self, message: String) {
        self.found.push((message, None));
    }

    fn size(&mut self, what: &str, value: &Value<f64>) {
        if let Some(m) = self.view.number(value).filter(|m| !(*m > 0.0 && *m <= LARGEST_M)) {
            self.report(format!("make the {what} more than 0 m and at most {LARGEST_M:.0} m, not {m} m"));
        }
    }

    /// How far from a route its passes are; another rule reports a spacing of 0 m.
    fn beside(&mut self) {
        if spacing_m(self.view, self.step).is_some_and(|m| m > LARGEST_M) {
            self.report(format!("make the spacing at most {LARGEST_M:.0} m"));
        }
    }

    fn spiral(&mut self, inner: &Value<f64>, outer: &Value<f64>) {
        let Some((inner_m, outer_m)) = self.view.number(inner).zip(self.view.number(outer)) else { return };
        if inner_m < 0.0 || inner_m >= outer_m && outer_m > 0.0 {
            let message = format!(
                "make the inner radius 0 m or more and less than the outer one: they are {inner_m} and {outer_m} m"
            );
            let swap = inner_m > outer_m;
            self.found.push((message, changed(self.leg, |kind| repaired_spiral(kind, swap))));
        }
    }

    fn sectors(&mut self, sectors: &Value<f64>) {
        let allowed = [3.0, 4.0, 6.0];
        if let Some(n) = self.view.number(sectors).filter(|n| !allowed.contains(n)) {
            let nearest = allowed.into_iter().min_by(|a, b| (a - n).abs().total_cmp(&(b - n).abs()));
            let fix = nearest.and_then(|n| changed(self.leg, |kind| with_sectors(kind, n)));
            self.found.push((format!("a sector search has 3, 4 or 6 sectors, not {n}"), fix));
        }
    }

    fn whole(&mut self, what: &'static str, value: &Value<f64>, most: f64) {
        let wrong = |n: &f64| n.fract() != 0.0 || !(1.0..=most).contains(n);
        if let Some(n) = self.view.number(value).filter(wrong) {
            let message = format!("make the number of {what} a whole one from 1 to {most}, not {n}");
            let fix = changed(self.leg, |kind| with_count(kind, n.round().clamp(1.0, most)));
            self.found.push((message, fix));
        }
    }

    fn route(&mut self, route: &[Place]) {
        if route.len() < 2 || route.len() > MAX_POINTS {
            let n = route.len();
            return self.report(format!("give the route 2 to {MAX_POINTS} points: it has {n}"));
        }
        let places: Vec<_> = route.iter().map(|p| self.view.place(p)).collect();
        let same = places.windows(2).position(|pair| match pair {
            [Some(a), Some(b)] => a.distance_m(*b) < SAME_PLACE_M,
            _ => false,
        });
        if let Some(index) = same {
            let message = format!("point {} of the route lies on the one before it: remove one", index + 2);
            self.found.push((message, changed(self.leg, |kind| without_point(kind, index + 1))));
        }
    }
}

fn repaired_spiral(kind: &mut LegKind, swap: bool) -> Option<()> {
    let LegKind::Pattern(Pattern::Spiral { inner_radius_m, outer_radius_m, .. }) = kind else { return None };
    if swap {
        std::mem::swap(inner_radius_m, outer_radius_m);
    } else {
        *inner_radius_m = Value::Constant(0.0);
    }
    Some(())
}

fn with_sectors(kind: &mut LegKind, n: f64) -> Option<()> {
    let LegKind::Pattern(Pattern::Sector { sectors, .. }) = kind else { return None };
    *sectors = Value::Constant(n);
    Some(())
}

/// The count of a pattern that has one.
fn with_count(kind: &mut LegKind, n: f64) -> Option<()> {
    match kind {
        LegKind::Pattern(Pattern::Sector { passes, .. }) => *passes = Value::Constant(n),
        LegKind::Pattern(Pattern::FigureEight { turns, .. }) => *turns = Value::Constant(n),
        LegKind::Pattern(Pattern::Contour { loops, .. }) => *loops = Some(Value::Constant(n)),
        _ => return None,
    }
    Some(())
}

fn without_point(kind: &mut LegKind, index: usize) -> Option<()> {
    let (LegKind::Pattern(Pattern::TrackLine { route, .. })
    | LegKind::Pattern(Pattern::Corridor { route, .. })) = kind
    else {
        return None;
    };
    (route.len() > 2 && index < route.len()).then(|| drop(route.remove(index)))
}

#[cfg(test)]
mod tests {
    use crate::checks::testing::{check_legs, fixed_legs};

    fn about(kind: &str, attributes: &str) -> String {
        format!(r#"<{kind} id="p" turn="left" {attributes}><centre fix="A"/></{kind}>"#)
    }

    fn spiral(inner: i32, outer: i32) -> String {
        let radii =
            format!(r#"innerRadius="{inner}" outerRadius="{outer}" spacing="300" direction="inward""#);
        about("spiral", &radii)
    }

    fn route(fixes: &[&str]) -> String {
        let points: String = fixes.iter().map(|f| format!(r#"<point fix="{f}"/>"#)).collect();
        format!(r#"<corridor id="p" width="600" spacing="300"><route>{points}</route></corridor>"#)
    }

    fn line(spacing: f64) -> String {
        format!(
            r#"<trackLine id="p" spacing="{spacing}"><route><point fix="A"/><point fix="B"/></route></trackLine>"#
        )
    }

    fn contour(attributes: &str) -> String {
        format!(
            r#"<contour id="p" spacing="150" turn="left" {attributes}><area fix="A" radius="900"/></contour>"#
        )
    }

    #[test]
    fn parameters_give_a_pattern() {
        let bad: &[&str] = &["bad-pattern"];
        check_legs(&[
            (&spiral(0, 900), &[]),
            (&spiral(900, 300), bad),
            (&spiral(-1, 300), bad),
            (&spiral(0, 0), bad),
            (&about("sector", r#"radius="2000" sectors="4" passes="2""#), &[]),
            (&about("sector", r#"radius="2000" sectors="5""#), bad),
            (&about("sector", r#"radius="2000" passes="0.5""#), bad),
            (&about("sector", r#"radius="0""#), bad),
            (&about("expandingSquare", r#"radius="-3" spacing="300""#), bad),
            (&about("figureEight", r#"radius="300" turns="1.5""#), bad),
            (&route(&["A", "B", "C"]), &[]),
            (&route(&["A"]), bad),
            (&route(&["A", "B", "B"]), bad),
            (&line(2000.0), &[]),
            (&line(300_000.0), bad),
            (&line(1e300), bad),
            (&contour(r#"direction="inward""#), &[]),
            (&contour(r#"direction="outward""#), bad),
            (&contour(r#"direction="outward" loops="2""#), &[]),
            (&contour(r#"direction="inward" loops="0""#), bad),
        ]);
    }

    #[test]
    fn most_are_repaired() {
        let cases = [
            spiral(900, 300),
            spiral(-1, 300),
            about("sector", r#"radius="2000" sectors="5""#),
            about("sector", r#"radius="2000" passes="0.5""#),
            route(&["A", "B", "B"]),
            contour(r#"direction="inward" loops="0""#),
        ];
        cases.iter().for_each(|legs| fixed_legs(&[(legs, "bad-pattern")]));
    }
}
