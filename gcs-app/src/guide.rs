//! The guide to a new plan: what was answered so far, and what of it is being drawn on the map.
//!
//! Answers come from the card (`panels/start.rs`) and from the map (`map/tools/guided.rs`); both see the same state.

use crate::airfields::{self, Landing};
use flight_plan::Runway;
use flight_plan::figures;
use flight_plan::template::{Extent, Outline, Template};
use geometry::LatLon;
use geometry::geodesy::normalise_180;

/// The mission lies so far beside the runway, metres from its nearer edge.
const ASIDE_M: f64 = 2000.0;
/// Shortest and longest runway that is taken from a drawing, metres.
const LENGTH_M: (f64, f64) = (50.0, 5000.0);

/// So far from the runway no aircraft here comes to a mission and back, metres.
const FARTHEST_M: f64 = 500_000.0;

/// What was answered so far.
#[derive(Debug, Clone, PartialEq)]
pub struct Guide {
    /// What the flight is for.
    pub template: Template,
    /// Name of the aircraft's profile.
    pub aircraft: String,
    /// The runway's landing threshold; nothing else can be answered before.
    pub threshold: Option<LatLon>,
    /// The runway's direction, degrees true.
    pub heading_deg: f64,
    /// The runway's length, metres.
    pub length_m: f64,
    /// `None`: beside the runway.
    pub extent: Option<Extent>,
    /// From the mission's middle to its edge where it is not drawn, metres.
    pub radius_m: f64,
    /// Of the mission above the runway, metres.
    pub height_m: f64,
    /// What the next clicks on the map answer.
    pub drawing: Option<Drawing>,
    /// What was typed and is no place yet.
    pub search: Option<Search>,
    /// The card was closed.
    pub closed: bool,
    /// A plan was made of it. Undo leads back to these answers, another new mission begins without them.
    pub is_made: bool,
}

/// A text that says no place, or several.
#[derive(Debug, Clone, PartialEq)]
pub struct Search {
    /// Into which field it was typed.
    pub field: &'static str,
    /// The text.
    pub typed: String,
    /// What it may mean.
    pub named: Vec<Named>,
}

/// A place that has a name.
#[derive(Debug, Clone, PartialEq)]
pub struct Named {
    /// The name, of an airport with its code.
    pub name: String,
    /// What is near, for people.
    pub region: String,
    /// Where it is.
    pub at: LatLon,
}

/// An answer that is given on the map.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Drawing {
    /// Where to fly: a click.
    Place,
    /// The runway: its threshold and its other end.
    Runway,
    /// The mission: what its template asks for.
    Mission,
}

/// What a template asks for on the map.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MissionFigure {
    /// The outline of an area.
    Area,
    /// A line of two points or more.
    Line,
    /// A middle and a rim.
    Circle,
}

impl MissionFigure {
    /// `None`: it asks for nothing.
    pub fn of(template: Template) -> Option<Self> {
        match template {
            Template::Survey => Some(Self::Area),
            Template::Corridor | Template::Patrol => Some(Self::Line),
            Template::Search | Template::FireWatch => Some(Self::Circle),
            Template::Circuit => None,
        }
    }

    /// For people.
    pub fn name(self) -> &'static str {
        match self {
            Self::Area => "area",
            Self::Line => "line",
            Self::Circle => "circle",
        }
    }
}

/// An answer.
#[derive(Debug, Clone, PartialEq)]
pub enum Answer {
    /// Where to fly: the runway's threshold, until it is drawn.
    Place(LatLon),
    /// A runway from its landing threshold to its other end.
    Runway(LatLon, LatLon),
    /// Where the mission is.
    Mission(Extent),
    /// What is drawn of it so far, if that is enough, or else what was before: it counts if the plan is made now.
    Begun(Option<Extent>),
    /// Whatever the card's fields say.
    Form(Box<Guide>),
    /// The next clicks on the map answer this, or nothing.
    Draw(Option<Drawing>),
    /// No answer: the card is closed.
    Close,
}

impl Default for Guide {
    fn default() -> Self {
        Self {
            template: Template::Survey,
            aircraft: "trainer".into(),
            threshold: None,
            heading_deg: 52.0,
            length_m: 600.0,
            extent: None,
            radius_m: 800.0,
            height_m: 150.0,
            drawing: Some(Drawing::Place),
            search: None,
            closed: false,
            is_made: false,
        }
    }
}

impl Guide {
    /// Takes an answer.
    pub fn take(&mut self, answer: Answer) {
        let is_drawn = matches!(answer, Answer::Runway(..));
        let before = self.threshold;
        match answer {
            Answer::Place(at) => (self.threshold, self.drawing, self.search) = (Some(at), None, None),
            Answer::Runway(threshold, end) => self.take_runway(threshold, end),
            Answer::Mission(extent) => (self.extent, self.drawing) = (Some(extent), None),
            Answer::Begun(extent) => self.extent = extent,
            Answer::Form(form) => *self = *form,
            Answer::Draw(drawing) => self.drawing = drawing,
            Answer::Close => (self.closed, self.drawing) = (true, None),
        }
        // who means an airport means its runway
        if let Some(runway) =
            self.threshold.filter(|at| !is_drawn && before != Some(*at)).and_then(airfields::at)
        {
            self.take_runway(runway.threshold, runway.end);
        }
    }

    /// The airport's runway that it is, where it is one.
    pub fn landing(&self) -> Option<Landing> {
        let (_, landings) = airfields::near(self.threshold?)?;
        landings.into_iter().find(|landing| self.is(landing))
    }

    /// The runway is this one of an airport, in this direction.
    pub fn is(&self, landing: &Landing) -> bool {
        let off_deg = normalise_180(landing.threshold.bearing_deg(landing.end) - self.heading_deg);
        self.threshold.is_some_and(|at| at.distance_m(landing.threshold) < 1.0) && off_deg.abs() < 1.0
    }

    /// Opens the card again; what was answered before stays, unless it has become a plan: then only the aircraft is the same.
    pub fn open(&mut self) {
        if self.is_made {
            *self = Self { aircraft: std::mem::take(&mut self.aircraft), ..Self::default() };
        }
        self.closed = false;
        self.drawing = self.threshold.is_none().then_some(Drawing::Place);
    }

    /// A place that an answer brings in, to be shown.
    pub fn new_place(&self, answer: &Answer) -> Option<LatLon> {
        match answer {
            Answer::Place(at) => Some(*at),
            Answer::Form(form) => {
                let middle = form.extent.as_ref().map(Extent::centre);
                let is_new = |at: &LatLon| self.extent().map(|e| e.centre()) != Some(*at);
                let threshold = form.threshold.filter(|_| form.threshold != self.threshold);
                middle.filter(is_new).or(threshold)
            }
            _ => None,
        }
    }

    /// With a mission that was drawn before any place was said: the runway lies beside it.
    pub fn begun_by(&self, template: Template, points: Vec<LatLon>) -> Self {
        let mut begun = self.clone();
        begun.choose(template);
        let extent = Extent::Drawn(points.clone());
        let centre = extent.centre();
        let reach_m = points.iter().map(|at| centre.distance_m(*at)).fold(0.0, f64::max);
        let half_way = centre.destination(begun.heading_deg - 90.0, reach_m + ASIDE_M);
        begun.threshold = Some(half_way.destination(begun.heading_deg + 180.0, begun.length_m / 2.0));
        (begun.extent, begun.drawing, begun.search) = (Some(extent), None, None);
        begun
    }

    fn take_runway(&mut self, threshold: LatLon, end: LatLon) {
        let way = threshold.inverse(end);
        self.threshold = Some(threshold);
        self.heading_deg = figures::direction_deg(way.bearing_start_deg.rem_euclid(360.0));
        self.length_m = way.distance_m.clamp(LENGTH_M.0, LENGTH_M.1).round();
        self.drawing = None;
    }

    /// Another template; a drawing that it doesn't ask for is forgotten.
    pub fn choose(&mut self, template: Template) {
        if MissionFigure::of(template) != MissionFigure::of(self.template) {
            self.extent = None;
            self.drawing = self.drawing.filter(|drawing| *drawing != Drawing::Mission);
        }
        self.template = template;
    }

    /// Where the mission is; `None` as long as no place is known.
    pub fn extent(&self) -> Option<Extent> {
        self.extent.clone().or_else(|| {
            Some(Extent::Around { centre: self.beside(self.threshold?), radius_m: self.radius_m })
        })
    }

    /// How far the mission is from the runway, metres; `None` as long as no place is known.
    pub fn way_m(&self) -> Option<f64> {
        Some(self.threshold?.distance_m(self.extent()?.centre()))
    }

    /// Nobody flies so far.
    pub fn is_too_far(&self) -> bool {
        self.way_m().is_some_and(|way_m| way_m > FARTHEST_M)
    }

    /// Abeam of the runway, clear of it.
    fn beside(&self, threshold: LatLon) -> LatLon {
        let half_way = threshold.destination(self.heading_deg, self.length_m / 2.0);
        half_way.destination(self.heading_deg + 90.0, self.radius_m + ASIDE_M)
    }

    /// What the plan is made of; `None` as long as no place is known. The runway's elevation is looked up when the plan is made.
    pub fn outline(&self) -> Option<Outline> {
        let name = self.landing().map(|landing| format!("R{}", landing.name));
        let runway = Runway {
            id: name.unwrap_or_else(|| runway_name(self.heading_deg)).as_str().into(),
            threshold: self.threshold?,
            elevation_amsl_m: 0.0,
            heading_deg: self.heading_deg,
            length_m: self.length_m,
            priority: 1,
            approach_entry: None,
        };
        Some(Outline {
            template: self.template,
            aircraft: self.aircraft.clone(),
            runway,
            extent: self.extent()?,
            height_m: self.height_m,
        })
    }
}

/// As runways are called: a tenth of the heading, 01 to 36.
fn runway_name(heading_deg: f64) -> String {
    let tenth = (heading_deg / 10.0).round().rem_euclid(36.0);
    format!("R{:02}", if tenth < 1.0 { 36.0 } else { tenth })
}

#[cfg(test)]
mod tests {
    use super::*;

    const HERE: LatLon = LatLon::new(36.3, -84.2);

    #[test]
    fn runways_are_called_by_their_heading() {
        for (heading_deg, name) in [(0.0, "R36"), (4.0, "R36"), (52.0, "R05"), (90.0, "R09"), (358.0, "R36")]
        {
            assert_eq!(runway_name(heading_deg), name, "{heading_deg}");
        }
    }

    #[test]
    fn another_mission_begins_without_the_places_of_the_last() {
        let mut guide = Guide { aircraft: "foam-wing".into(), ..Guide::default() };
        guide.take(Answer::Place(HERE));
        guide.open();
        assert_eq!(guide.threshold, Some(HERE), "it was only closed");
        guide.is_made = true;
        guide.open();
        assert_eq!((guide.threshold, guide.is_made, guide.aircraft.as_str()), (None, false, "foam-wing"));
        assert_eq!(guide.drawing, Some(Drawing::Place));
    }

    #[test]
    fn mission_lies_beside_the_runway_until_it_is_drawn() {
        let mut guide = Guide::default();
        assert_eq!(guide.outline(), None);
        guide.take(Answer::Place(HERE));
        let away_m = guide.outline().unwrap().extent.centre().distance_m(HERE);
        assert!((2700.0..3000.0).contains(&away_m), "{away_m}");
        let drawn = Extent::Drawn(vec![HERE, HERE.destination(0.0, 900.0), HERE.destination(90.0, 900.0)]);
        guide.take(Answer::Mission(drawn.clone()));
        assert_eq!(guide.outline().unwrap().extent, drawn);
    }

    #[test]
    fn an_airport_that_is_meant_gives_its_runway() {
        let mut guide = Guide::default();
        let girona = LatLon::new(41.901, 2.761);
        guide.take(Answer::Place(girona));
        let runway = guide.outline().unwrap().runway;
        assert_eq!((runway.id.as_str(), runway.length_m), ("R01", 2401.0));
        assert!((runway.heading_deg - 16.0).abs() < 2.0, "{}", runway.heading_deg);
        let there = guide.threshold.unwrap();
        guide.take(Answer::Form(Box::new(Guide { heading_deg: 90.0, ..guide.clone() })));
        assert_eq!(
            (guide.threshold, guide.heading_deg),
            (Some(there), 90.0),
            "what is typed is not taken back"
        );
        assert_eq!(guide.outline().unwrap().runway.id.as_str(), "R09");
    }

    #[test]
    fn runway_is_drawn_by_its_two_ends() {
        let mut guide = Guide::default();
        guide.take(Answer::Draw(Some(Drawing::Runway)));
        guide.take(Answer::Runway(HERE, HERE.destination(130.0, 712.0)));
        let runway = guide.outline().unwrap().runway;
        assert_eq!((runway.threshold, runway.length_m, runway.id.as_str()), (HERE, 712.0, "R13"));
        assert!((runway.heading_deg - 130.0).abs() < 0.01 && guide.drawing.is_none());
    }

    #[test]
    fn drawing_is_forgotten_with_the_template_that_asked_for_it() {
        let mut guide = Guide::default();
        guide.take(Answer::Place(HERE));
        let line = Extent::Drawn(vec![HERE, HERE.destination(0.0, 900.0)]);
        guide.choose(Template::Corridor);
        guide.take(Answer::Mission(line.clone()));
        guide.choose(Template::Patrol);
        assert_eq!(guide.extent, Some(line), "a patrol flies along a line, too");
        guide.choose(Template::Survey);
        assert_eq!(guide.extent, None);
    }
}
