//! Somebody with an example plan beside the window.

use super::super::{Window, creating};
use super::reading::{Next, next};
use super::rows::row_of;
use egui::accesskit::Role;
use egui::{Key, Modifiers, Pos2, vec2};
use egui_kittest::kittest::Queryable;
use flight_plan::create::{LegChoice, Shape};
use flight_plan::describe::{Draft, Subject};
use flight_plan::{
    Area, EmergencyPlan, FlightPlan, Id, Leg, LegKind, Pattern, Place, Procedure, Scan, Stage, StageKind,
    Value, VariableValue, ZoneKind, ZoneShape, compile,
};
use gcs_app::assets;
use geometry::LatLon;
use std::sync::Arc;

/// So tall that nothing has to be scrolled.
const SIZE: egui::Vec2 = vec2(1500.0, 2000.0);

pub struct Author {
    window: Window,
    example: FlightPlan,
}

impl Author {
    /// An empty window, near where the example flies.
    pub fn begin(example: &str) -> Self {
        let example = flight_plan::read(example).plan;
        let mut window = Window::open_with(creating::EMPTY, SIZE, None);
        window.steps(3);
        let at = example.runways[0].threshold;
        window.fill_in(Role::TextInput, "Place", &format!("{}, {}", at.lat_deg, at.lon_deg));
        Self { window, example }
    }

    pub fn write_plan(&mut self) {
        let example = self.example.clone();
        self.runways();
        self.fixes();
        example.stages.iter().for_each(|stage| self.stage(stage));
        self.variables();
        self.window.press(Key::F);
        self.window.click_role(Role::Button, "Zoom out");
        self.zones();
        example.emergency_plans.iter().for_each(|plan| self.emergency_plan(plan));
        self.fixes_of_others();
        // a stage may name an emergency plan
        for stage in &example.stages {
            self.select(&stage.id);
            self.fill(Subject::Stage(stage.id.clone()), Subject::Stage(stage.id.clone()));
        }
        example.procedures.iter().for_each(|procedure| self.procedure(procedure));
        for stage in example.stages.iter().filter(|stage| !stage.legs.is_empty()) {
            self.select(&stage.id);
            self.legs(&stage.legs);
        }
        self.window.press(Key::Escape);
        self.fill(Subject::Plan, Subject::Plan);
    }

    /// The same program came out.
    pub fn compare(&self) {
        let (made, example) = (self.window.plan(), &self.example);
        assert_eq!(made, *example);
        let profile = aircraft::Profile::by_name(&example.aircraft).unwrap();
        let hash = |plan: &FlightPlan| {
            let program = compile(plan.clone(), &profile, assets::demo_terrain().as_ref()).unwrap();
            program.hash().to_string()
        };
        assert_eq!(hash(&made), hash(example));
    }

    /// Makes a part like that of the example which it is to be.
    fn fill(&mut self, made: Subject, to_be: Subject) {
        let wanted = Draft::of(&self.example, &to_be).unwrap();
        let mut subject = made;
        for _ in 0..100 {
            let plan = self.window.plan();
            let now = Draft::of(&plan, &subject).unwrap_or_else(|| panic!("{subject:?} is gone"));
            let Some(gesture) = next(&plan, &now, &wanted) else { return };
            let notice = self.window.app().view().notice.clone();
            if subject == Subject::Plan {
                // its figures come with the forecast, and move the fields below them
                self.window.until_analysed();
            }
            self.perform(&gesture);
            if Draft::of(&self.window.plan(), &subject).is_none() {
                subject = to_be.clone();
            }
            assert_eq!(self.window.app().view().notice, notice, "{gesture:?}");
        }
        panic!("no end of {to_be:?}");
    }

    fn perform(&mut self, gesture: &Next) {
        match gesture {
            Next::Click(name) => self.window.click_role(Role::Button, name),
            Next::Tick(name) => self.window.click_role(Role::CheckBox, name),
            Next::Begin(name) => self.give_own(name),
            Next::Choose(list, option) => self.window.choose_option(list, option),
            Next::Write(name, text) => self.window.fill_in(Role::TextInput, name, text),
            Next::Number(name, text) => self.window.fill_in(Role::SpinButton, name, text),
        }
    }

    /// Gives a value of its own what inherits it, else what has none.
    fn give_own(&mut self, name: &str) {
        let own = format!("Own {}", name.trim_end_matches(": ").to_lowercase());
        match self.window.harness.query_by_role_and_label(Role::Button, &own).is_some() {
            true => self.window.click_role(Role::Button, &own),
            false => self.window.click_beginning(name),
        }
    }

    /// What was made last.
    fn made(&self) -> Id {
        self.window.selected().as_str().into()
    }

    fn select(&mut self, id: &Id) {
        let (row, which) = row_of(&self.window.plan(), id);
        self.window.select_row((&row, which));
    }

    fn menu(&mut self, id: &Id, entry: &str) {
        let (row, which) = row_of(&self.window.plan(), id);
        self.window.row_menu((&row, which), entry);
    }

    /// Takes a tool, clicks these places of the map, and goes back to selecting.
    fn draw(&mut self, tool: &str, figure: &str, kind: &str, at: &[Pos2], closes: bool) {
        self.window.click_role(Role::Button, tool);
        for choice in [figure, kind].into_iter().filter(|choice| !choice.is_empty()) {
            self.window.click_role(Role::Button, choice);
        }
        let map = self.window.harness.get_by_label("Map").rect();
        assert!(at.iter().all(|at| map.contains(*at)), "{at:?} is beyond {map:?}");
        let before = self.window.selected();
        at.iter().for_each(|at| self.window.tap_at(*at));
        if closes {
            self.window.press(Key::Enter);
        }
        assert_ne!(self.window.selected(), before, "{tool}: nothing came of {at:?} on {map:?}");
        self.window.click_role(Role::Button, "Select and move (V)");
    }

    /// Where a place of the ground is on the screen, as two fixes show it.
    fn on_screen(&self, at: LatLon) -> Pos2 {
        let fixes = &self.example.fixes;
        let far = |a: &&flight_plan::Fix| {
            let from = fixes[0].position;
            (a.position.lat_deg - from.lat_deg).abs().min((a.position.lon_deg - from.lon_deg).abs())
        };
        let other = fixes.iter().max_by(|a, b| far(a).total_cmp(&far(b))).unwrap();
        let (a, b) = (fixes[0].position, other.position);
        let plan = self.window.plan();
        let shown = |id: &Id| self.window.centre(&format!("Fix {}", plan.label(id)));
        let (from, to) = (shown(&fixes[0].id), shown(&other.id));
        let share = |x: f64, a: f64, b: f64| ((x - a) / (b - a)) as f32;
        from + vec2(
            (to.x - from.x) * share(at.lon_deg, a.lon_deg, b.lon_deg),
            (to.y - from.y) * share(at.lat_deg, a.lat_deg, b.lat_deg),
        )
    }

    fn runways(&mut self) {
        for runway in self.example.runways.clone() {
            let middle = self.window.centre("Map");
            let both = if self.window.plan().runways.is_empty() { "Both directions" } else { "" };
            self.window.click_role(Role::Button, "Draw a runway (R)");
            if !both.is_empty() {
                self.window.click_role(Role::CheckBox, both);
            }
            self.draw("Draw a runway (R)", "", "", &[middle, middle + vec2(60.0, -30.0)], false);
            let made = self.made();
            self.fill(Subject::Runway(made), Subject::Runway(runway.id.clone()));
        }
    }

    fn fixes(&mut self) {
        for (n, fix) in self.example.fixes.clone().into_iter().enumerate() {
            let at = self.window.centre("Map") + vec2(40.0 * n as f32 - 200.0, 200.0);
            self.draw("Place a fix (X)", "", "", &[at], false);
            let made = self.made();
            self.fill(Subject::Fix(made), Subject::Fix(fix.id.clone()));
        }
    }

    /// Fixes that came with an emergency plan.
    fn fixes_of_others(&mut self) {
        for fix in self.window.plan().fixes {
            if self.example.fix(&fix.id).is_none() {
                self.window.row_menu((&format!("FIX {}", fix.id), 0), "Delete");
            }
        }
    }

    fn variables(&mut self) {
        for variable in self.example.variables.clone() {
            let entry = match variable.initial {
                VariableValue::Number(_) => "Number",
                VariableValue::Bool(_) => "Yes or no",
                VariableValue::Text(_) => "Text",
                VariableValue::Position(_) => "Position",
                VariableValue::Polygon(_) => "Area",
            };
            self.window.add_to("variables", entry);
            let made = self.made();
            self.fill(Subject::Variable(made), Subject::Variable(variable.name.clone()));
        }
    }

    fn zones(&mut self) {
        self.window.click_role(Role::Button, "Zoom out");
        for zone in self.example.zones.clone() {
            let kind = match zone.kind {
                ZoneKind::KeepIn => "keep in",
                ZoneKind::KeepOut => "keep out",
            };
            let tool = "Draw a zone (Z)";
            match &zone.shape {
                // it reaches beyond the map: the corners are typed
                ZoneShape::Polygon(_) => {
                    let around = [vec2(-200.0, 200.0), vec2(-200.0, -200.0), vec2(200.0, -200.0)];
                    let middle = self.window.centre("Map");
                    self.draw(tool, "outline", kind, &around.map(|by| middle + by), true);
                }
                ZoneShape::Circle { centre, .. } => {
                    let centre = self.on_screen(*centre);
                    self.draw(tool, "circle", kind, &[centre, centre + vec2(40.0, 0.0)], false);
                }
            }
            let made = self.made();
            self.fill(Subject::Zone(made), Subject::Zone(zone.id.clone()));
        }
        self.window.click_role(Role::Button, "Zoom in");
    }

    fn stage(&mut self, stage: &Stage) {
        let entry = match stage.kind {
            StageKind::TakeOff => "Take-off stage",
            StageKind::Departure => "Departure stage",
            StageKind::EnRoute => "En-route stage",
            StageKind::Mission => "Mission stage",
            StageKind::Arrival => "Arrival stage",
            StageKind::Approach => "Approach stage",
            StageKind::Land => "Landing stage",
        };
        self.window.add_to("main plan", entry);
        self.window.fill_in(Role::TextInput, "Identifier", stage.id.as_str());
    }

    fn emergency_plan(&mut self, wanted: &EmergencyPlan) {
        self.window.add_to("emergency plans", &format!("Land on {}", wanted.runway));
        let made = self.window.plan().emergency_plans.last().unwrap().clone();
        for leg in made.stages.iter().flat_map(|stage| &stage.legs) {
            self.menu(&leg.id, "Delete");
        }
        self.select(&made.id);
        self.fill(Subject::EmergencyPlan(made.id), Subject::EmergencyPlan(wanted.id.clone()));
        for stage in &made.stages {
            match wanted.stages.iter().find(|other| other.kind == stage.kind) {
                None => self.menu(&stage.id, "Delete"),
                Some(wanted) => {
                    self.select(&stage.id);
                    self.fill(Subject::Stage(stage.id.clone()), Subject::Stage(wanted.id.clone()));
                    self.legs(&wanted.legs);
                }
            }
        }
    }

    /// Drawn into a stage, made a procedure of, and the call that this leaves deleted.
    fn procedure(&mut self, procedure: &Procedure) {
        let stage = self.example.stages.iter().find(|stage| stage.kind == StageKind::Mission).unwrap();
        let id = stage.id.clone();
        self.select(&id);
        let mut made = Vec::new();
        for leg in &procedure.legs {
            self.draw_leg(leg);
            made.push(self.made());
        }
        self.select(&made[0].clone());
        for leg in &made[1..] {
            let (row, which) = row_of(&self.window.plan(), leg);
            self.window.select_row_with((&row, which), Modifiers::COMMAND);
        }
        self.menu(&made[0].clone(), "Make a procedure of them");
        let call = self.made();
        let new = self.window.plan().procedures.last().unwrap().id.clone();
        self.select(&new);
        self.fill(Subject::Procedure(new), Subject::Procedure(procedure.id.clone()));
        for (made, wanted) in made.into_iter().zip(&procedure.legs) {
            self.select(&made);
            self.fill(Subject::Leg(made), Subject::Leg(wanted.id.clone()));
        }
        self.menu(&call, "Delete");
    }

    /// Behind what is selected, or into it.
    fn legs(&mut self, legs: &[Arc<Leg>]) {
        for leg in legs.iter().filter(|leg| leg.as_fork().is_none()) {
            self.leg(leg);
        }
        for pair in legs.windows(2).filter(|pair| pair[0].as_fork().is_some()) {
            self.menu(&pair[1].id, "Fork before it");
            let made = self.made();
            self.fill(Subject::Leg(made), Subject::Leg(pair[0].id.clone()));
        }
    }

    fn leg(&mut self, leg: &Leg) {
        let Some((first, rest)) = leg.body().split_first() else {
            self.draw_leg(leg);
            let made = self.made();
            return self.fill(Subject::Leg(made), Subject::Leg(leg.id.clone()));
        };
        self.leg(first);
        self.menu(&first.id, "Put into a loop");
        let made = self.made();
        self.fill(Subject::Leg(made), Subject::Leg(leg.id.clone()));
        self.select(&first.id);
        self.legs(rest);
        self.select(&leg.id);
    }

    fn draw_leg(&mut self, leg: &Leg) {
        let choice = LegChoice::of(&leg.kind);
        let (tool, figure, closes) = match choice.shape() {
            Shape::Line => ("Draw a line to follow (L)", "", true),
            Shape::Area if self.area_of(leg).is_some() => ("Draw an area to scan (A)", "outline", true),
            Shape::Area => ("Draw an area to scan (A)", "circle", false),
            Shape::Circle => ("Draw a circle or search (O)", "", false),
            Shape::Place => ("Draw legs (T)", "", false),
            Shape::Nothing => panic!("{} is not drawn", leg.id),
        };
        let at = self.outline(leg);
        self.window.click_role(Role::Button, tool);
        self.window.choose_kind(&choice.name());
        self.draw(tool, figure, "", &at, closes);
    }

    /// Where a leg's figure is on the screen.
    fn outline(&self, leg: &Leg) -> Vec<Pos2> {
        let circle = |centre: &Place| {
            let middle = self.on_screen(self.place(centre));
            vec![middle, middle + vec2(60.0, 0.0)]
        };
        match &leg.kind {
            LegKind::Scan(Scan { area: Area::Circle { centre, .. }, .. }) | LegKind::Orbit { centre, .. } => {
                circle(centre)
            }
            LegKind::Pattern(
                Pattern::ExpandingSquare { centre, .. }
                | Pattern::Sector { centre, .. }
                | Pattern::FigureEight { centre, .. },
            ) => circle(centre),
            LegKind::Pattern(Pattern::Corridor { route, .. } | Pattern::TrackLine { route, .. }) => {
                route.iter().map(|place| self.on_screen(self.place(place))).collect()
            }
            LegKind::Call(call) => vec![self.on_screen(self.place(call.anchor.as_ref().unwrap()))],
            _ => match self.area_of(leg) {
                Some(corners) => corners.into_iter().map(|at| self.on_screen(at)).collect(),
                None => vec![self.on_screen(self.place(leg.place().unwrap()))],
            },
        }
    }

    fn area_of(&self, leg: &Leg) -> Option<Vec<LatLon>> {
        match &leg.kind {
            LegKind::Scan(Scan { area: Area::Polygon { corners, .. }, .. }) => Some(corners.clone()),
            _ => None,
        }
    }

    fn place(&self, place: &Place) -> LatLon {
        match place {
            Place::Fix(id) => self.example.fix(id).unwrap().position,
            Place::Position(Value::Constant(at)) => *at,
            Place::Position(Value::Expression(name)) => {
                match self.example.variable(&name.as_ref().into()).unwrap().initial {
                    VariableValue::Position(at) => at,
                    _ => panic!("{name} is no position"),
                }
            }
        }
    }
}
