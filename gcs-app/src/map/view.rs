//! Where things are on the screen. Positions are projected once, to the unit square of the Web
//! Mercator projection; a view then is one scale and one shift, in double precision, so that
//! nothing trembles at high zoom.

use egui::{Pos2, Rect, Vec2, pos2};
use geometry::LatLon;
use std::f64::consts::PI;
use walkers::{Projector, lat_lon};

/// A position in the unit square: x eastwards, y southwards from the north-west corner.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mercator {
    /// 0..1 from the antimeridian eastwards.
    pub x: f64,
    /// 0..1 from 85.05° north southwards.
    pub y: f64,
}

impl From<LatLon> for Mercator {
    fn from(p: LatLon) -> Self {
        let lat = p.lat_deg.clamp(-85.051, 85.051).to_radians();
        Self { x: (p.lon_deg / 180.0 + 1.0) / 2.0, y: (1.0 - lat.tan().asinh() / PI) / 2.0 }
    }
}

impl Mercator {
    /// Back to a position.
    pub fn to_geo(self) -> LatLon {
        LatLon::new(((1.0 - 2.0 * self.y) * PI).sinh().atan().to_degrees(), (2.0 * self.x - 1.0) * 180.0)
    }
}

/// A rectangle of the unit square.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Area {
    least: Mercator,
    most: Mercator,
}

impl Area {
    /// Around these places.
    pub fn around(places: &[Mercator]) -> Self {
        let none = Self {
            least: Mercator { x: f64::INFINITY, y: f64::INFINITY },
            most: Mercator { x: f64::NEG_INFINITY, y: f64::NEG_INFINITY },
        };
        places.iter().fold(none, |Self { least, most }, at| Self {
            least: Mercator { x: least.x.min(at.x), y: least.y.min(at.y) },
            most: Mercator { x: most.x.max(at.x), y: most.y.max(at.y) },
        })
    }

    /// It is in there, or on the edge.
    pub fn has(&self, at: Mercator) -> bool {
        (self.least.x..=self.most.x).contains(&at.x) && (self.least.y..=self.most.y).contains(&at.y)
    }

    /// They have something in common.
    pub fn overlaps(&self, other: &Self) -> bool {
        let apart = |a: &Self, b: &Self| a.most.x < b.least.x || a.most.y < b.least.y;
        !apart(self, other) && !apart(other, self)
    }
}

/// Free space around what is fitted, screen points.
const MARGIN: f32 = 48.0;
/// More of it at the bottom, where the strip of commands floats over the map, screen points.
const STRIP: f32 = 56.0;

/// The part of the world that is shown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    /// Where on the screen.
    pub rect: Rect,
    centre: Mercator,
    /// Screen points per unit of the unit square.
    scale: f64,
}

impl View {
    /// What walkers shows.
    pub fn of(projector: &Projector<'_>) -> Self {
        let rect = projector.clip_rect();
        let centre = projector.unproject(rect.center().to_vec2());
        Self {
            rect,
            centre: LatLon::new(centre.y(), centre.x()).into(),
            scale: 256.0 * 2f64.powf(projector.zoom()),
        }
    }

    /// The zoom level: the whole world is `256 · 2^zoom` points wide.
    pub fn zoom(&self) -> f64 {
        (self.scale / 256.0).log2()
    }

    /// How often the scale has doubled: views of the same octave differ by less than a factor of two.
    pub fn octave(&self) -> i32 {
        self.scale.max(1.0).log2().floor() as i32
    }

    /// How far what stands still on the ground has moved on the screen since another view; `None`: it is seen at another scale.
    pub fn moved_since(&self, before: &Self) -> Option<Vec2> {
        let here = |view: &Self| view.screen(self.centre);
        (self.scale == before.scale).then(|| here(self) - here(before))
    }

    /// With more around it, screen points.
    pub fn with_more(&self, around: f32) -> Self {
        Self { rect: self.rect.expand(around), ..*self }
    }

    /// On the screen.
    pub fn screen(&self, m: Mercator) -> Pos2 {
        let middle = self.rect.center();
        pos2(
            middle.x + ((m.x - self.centre.x) * self.scale) as f32,
            middle.y + ((m.y - self.centre.y) * self.scale) as f32,
        )
    }

    /// A position on the screen.
    pub fn place(&self, p: LatLon) -> Pos2 {
        self.screen(p.into())
    }

    /// The position under a point of the screen, in round figures: it may become one of a plan.
    pub fn geo(&self, at: Pos2) -> LatLon {
        flight_plan::figures::place(self.unit(at).to_geo())
    }

    /// The place in the unit square under a point of the screen.
    pub fn unit(&self, at: Pos2) -> Mercator {
        let d = at - self.rect.center();
        Mercator {
            x: self.centre.x + f64::from(d.x) / self.scale,
            y: self.centre.y + f64::from(d.y) / self.scale,
        }
    }

    /// What a part of the screen shows.
    pub fn area(&self, rect: Rect) -> Area {
        Area::around(&[self.unit(rect.left_top()), self.unit(rect.right_bottom())])
    }

    /// The middle of the view that has another scale (`factor` times this one) and the same position at a point.
    pub fn middle_after(&self, fixed: Pos2, factor: f64) -> LatLon {
        let away = fixed - self.rect.center();
        let share = (1.0 - 1.0 / factor) / self.scale;
        Mercator {
            x: self.centre.x + f64::from(away.x) * share,
            y: (self.centre.y + f64::from(away.y) * share).clamp(0.0, 1.0),
        }
        .to_geo()
    }

    /// Screen points per metre in the middle of the view.
    pub fn points_per_metre(&self) -> f64 {
        let latitude = self.centre.to_geo().lat_deg.to_radians();
        self.scale / (40_075_016.686 * latitude.cos())
    }

    /// Degrees of longitude per screen point.
    pub fn degrees_per_point(&self) -> f64 {
        360.0 / self.scale
    }

    /// Near enough to the screen to be drawn.
    pub fn is_near(&self, p: Pos2) -> bool {
        self.rect.expand(40.0).contains(p)
    }

    /// The map's middle and zoom level at which all of `points` are shown with a margin, clear of the strip of commands.
    pub fn fit(points: &[LatLon], size: egui::Vec2) -> Option<(walkers::Position, f64)> {
        let mut all = points.iter().filter(|p| p.is_valid());
        let first = *all.next()?;
        // the corners first, and only they on the map: of a hundred thousand places that is much less
        let (south_west, north_east) = all.fold((first, first), |(low, high), p| {
            (
                LatLon::new(low.lat_deg.min(p.lat_deg), low.lon_deg.min(p.lon_deg)),
                LatLon::new(high.lat_deg.max(p.lat_deg), high.lon_deg.max(p.lon_deg)),
            )
        });
        let (bottom_left, top_right) = (Mercator::from(south_west), Mercator::from(north_east));
        let low = Mercator { x: bottom_left.x, y: top_right.y };
        let high = Mercator { x: top_right.x, y: bottom_left.y };
        let room = |points: f32, extent: f64| f64::from((points - 2.0 * MARGIN).max(64.0)) / extent.max(1e-6);
        let scale = room(size.x, high.x - low.x).min(room(size.y - STRIP, high.y - low.y));
        let zoom = (scale / 256.0).log2().clamp(1.0, 17.0);
        let aside = f64::from(STRIP) / 2.0 / (256.0 * zoom.exp2());
        let middle = Mercator { x: (low.x + high.x) / 2.0, y: (low.y + high.y) / 2.0 + aside }.to_geo();
        Some((lat_lon(middle.lat_deg, middle.lon_deg), zoom))
    }

    /// The same; where one of the points would lie under what lies over the map's left, all are shown beside that. `over`: from the
    /// map's upper left corner.
    pub fn fit_beside(
        points: &[LatLon],
        size: egui::Vec2,
        over: Option<Rect>,
    ) -> Option<(walkers::Position, f64)> {
        let fitted = Self::fit(points, size)?;
        let is_hidden = |over: &Rect| {
            let over = over.expand(ROOM);
            points.iter().filter(|at| at.is_valid()).any(|at| over.contains(place_in(fitted, size, *at)))
        };
        let Some(over) = over.filter(is_hidden) else { return Some(fitted) };
        let (centre, zoom) = Self::fit(points, size - egui::vec2(over.right(), 0.0))?;
        let mut middle = Mercator::from(LatLon::new(centre.y(), centre.x()));
        middle.x -= f64::from(over.right()) / 2.0 / (256.0 * zoom.exp2());
        let middle = middle.to_geo();
        Some((lat_lon(middle.lat_deg, middle.lon_deg), zoom))
    }
}

/// Between a point and what lies over the map, screen points.
const ROOM: f32 = 12.0;

/// Where a place is on a map of this size, from its upper left corner.
fn place_in((centre, zoom): (walkers::Position, f64), size: egui::Vec2, at: LatLon) -> Pos2 {
    let (middle, at) = (Mercator::from(LatLon::new(centre.y(), centre.x())), Mercator::from(at));
    let points = |share: f64| (share * 256.0 * zoom.exp2()) as f32;
    pos2(points(at.x - middle.x), points(at.y - middle.y)) + size / 2.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::vec2;
    use walkers::{MapMemory, MercatorProjection};

    fn view(zoom: f64) -> (View, Projector<'static>) {
        let mut memory = MapMemory::default();
        assert!(memory.set_zoom(zoom).is_ok());
        let rect = Rect::from_min_size(pos2(100.0, 50.0), vec2(800.0, 600.0));
        let projector = Projector::new(rect, &MercatorProjection, &memory, lat_lon(36.5, -84.27));
        (View::of(&projector), projector)
    }

    #[test]
    fn a_view_agrees_with_the_map_widget_and_inverts() {
        for zoom in [3.0, 11.5, 17.0] {
            let (view, projector) = view(zoom);
            let p = LatLon::new(36.5005, -84.2693);
            let theirs = projector.project(lat_lon(p.lat_deg, p.lon_deg)).to_pos2();
            assert!(view.place(p).distance(theirs) < 0.3, "{zoom}: {:?} {theirs:?}", view.place(p));
            let back = view.geo(view.place(p));
            assert!(back.distance_m(p) < 1e-4 * view.rect.width() as f64 / view.points_per_metre());
            let metre = view.place(p.destination(90.0, 100.0)).x - view.place(p).x;
            assert!(
                (f64::from(metre) - 100.0 * view.points_per_metre()).abs() < 0.02 * f64::from(metre).max(1.0)
            );
        }
    }

    #[test]
    fn everything_fitted_is_on_the_screen() {
        let points = [LatLon::new(36.45, -84.36), LatLon::new(36.65, -84.18), LatLon::new(f64::NAN, 0.0)];
        let size = vec2(700.0, 500.0);
        let Some((centre, zoom)) = View::fit(&points, size) else { panic!("nothing fitted") };
        let mut memory = MapMemory::default();
        assert!(memory.set_zoom(zoom).is_ok());
        let rect = Rect::from_min_size(Pos2::ZERO, size);
        let view = View::of(&Projector::new(rect, &MercatorProjection, &memory, centre));
        let clear = Rect::from_min_max(rect.min, pos2(rect.max.x, rect.max.y - STRIP)).shrink(MARGIN - 1.0);
        for p in &points[..2] {
            assert!(clear.contains(view.place(*p)), "{:?}", view.place(*p));
            assert!(view.place(*p).distance(place_in((centre, zoom), size, *p)) < 0.3);
        }
        assert!(View::fit(&points[2..], size).is_none());
    }

    /// The legend lay over the path.
    #[test]
    fn what_is_fitted_lies_beside_the_legend() {
        let points = [LatLon::new(36.45, -84.36), LatLon::new(36.65, -84.0)];
        let size = vec2(700.0, 500.0);
        let over = Rect::from_min_max(pos2(6.0, 330.0), pos2(130.0, 470.0));
        let Some(plain) = View::fit(&points, size) else { panic!("nothing fitted") };
        assert!(over.expand(ROOM).contains(place_in(plain, size, points[0])), "it would lie there");
        let Some(beside) = View::fit_beside(&points, size, Some(over)) else { panic!("nothing fitted") };
        let places = points.map(|at| place_in(beside, size, at));
        assert!(places[0].x > over.right() + ROOM && places[1].x < size.x - MARGIN + 1.0, "{places:?}");
        let elsewhere = over.translate(vec2(0.0, -300.0));
        assert_eq!(
            View::fit_beside(&points, size, Some(elsewhere)),
            Some(plain),
            "nothing moves without need"
        );
    }
}
