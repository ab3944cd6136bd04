//! Where names stand: beside what they name, off the path and off each other.

use super::{Point, Room};

/// Places already taken.
#[derive(Debug)]
pub struct Labels {
    window: Room,
    /// Points that should stay visible.
    clear: Vec<Point>,
    taken: Grid,
}

/// Side of a cell of the grid.
const CELL: f32 = 64.0;
/// So many cells are side by side; the last one goes on beyond that.
const MOST_CELLS: usize = 128;

/// Rooms by the cells of a window in which they are: what is looked for is found among its neighbours. What lies outside is in
/// the cells at the edge.
#[derive(Debug)]
struct Grid {
    window: Room,
    columns: usize,
    cells: Vec<Vec<Room>>,
}

impl Grid {
    fn new(window: Room) -> Self {
        let cells = |length: f32| ((length / CELL) as usize + 1).min(MOST_CELLS);
        let (columns, rows) = (cells(window.right - window.left), cells(window.bottom - window.top));
        Self { window, columns, cells: vec![Vec::new(); columns * rows] }
    }

    /// Column and row of a place.
    fn cell(&self, (x, y): Point) -> (usize, usize) {
        let (column, row) = ((x - self.window.left) / CELL, (y - self.window.top) / CELL);
        // what is negative is 0
        let rows = self.cells.len() / self.columns;
        ((column as usize).min(self.columns - 1), (row as usize).min(rows - 1))
    }

    /// Column and row of each cell that a room is in.
    fn cells(&self, room: &Room) -> impl Iterator<Item = (usize, usize)> + use<> {
        let ((left, top), (right, bottom)) =
            (self.cell((room.left, room.top)), self.cell((room.right, room.bottom)));
        (top..=bottom).flat_map(move |row| (left..=right).map(move |column| (column, row)))
    }

    fn add(&mut self, room: Room) {
        for (column, row) in self.cells(&room) {
            if let Some(cell) = self.cells.get_mut(row * self.columns + column) {
                cell.push(room);
            }
        }
    }

    /// Those that a room meets, each once.
    fn met<'a>(&'a self, room: &'a Room) -> impl Iterator<Item = &'a Room> {
        self.cells(room).flat_map(move |cell| {
            let (column, row) = cell;
            let rooms = self.cells.get(row * self.columns + column).into_iter().flatten();
            // in the cell where what they have in common begins
            rooms.filter(move |taken| {
                let corner = (taken.left.max(room.left), taken.top.max(room.top));
                taken.meets(room) && self.cell(corner) == cell
            })
        })
    }
}

impl Labels {
    /// Nothing written yet, in a window.
    pub fn new(window: Room) -> Self {
        Self { window, clear: Vec::new(), taken: Grid::new(window) }
    }

    /// Something stands here.
    pub fn take(&mut self, room: Room) {
        self.taken.add(room);
    }

    /// A line that should not be written over.
    pub fn keep_clear(&mut self, line: &[Point]) {
        for pair in line.windows(2) {
            let [(ax, ay), (bx, by)] = pair else { continue };
            let steps = ((bx - ax).hypot(by - ay) / 4.0).ceil().clamp(1.0, 400.0);
            let point = |i: f32| (ax + (bx - ax) * i / steps, ay + (by - ay) * i / steps);
            self.clear.extend((0..steps as u32).map(|i| point(i as f32)));
        }
    }

    /// Nothing stands there yet.
    pub fn is_free(&self, room: &Room) -> bool {
        self.taken.met(room).next().is_none()
    }

    /// Of the middles given, the first at which a text of this size covers least; none if it is outside everywhere.
    pub fn best(&self, middles: &[Point], size: (f32, f32)) -> Option<Point> {
        let window = self.window.grown(-2.0);
        let inside = middles.iter().copied().filter(|at| window.holds(&Room::about(*at, size)));
        inside.min_by_key(|at| self.covers(&Room::about(*at, size)))
    }

    /// How much would be covered: another name counts as much as a long piece of the path.
    fn covers(&self, room: &Room) -> usize {
        self.taken.met(room).count() * 1000 + self.clear.iter().filter(|at| room.contains(**at)).count()
    }
}

/// Middles for a text of this size beside a point.
pub fn beside((x, y): Point, (width, height): (f32, f32)) -> Vec<Point> {
    let half = width / 2.0;
    let around = [12.0, 20.0].into_iter().flat_map(|gap| {
        let (side, up) = (half + gap, height / 2.0 + gap);
        let level = [(side, 0.0), (-side, 0.0), (0.0, -up), (0.0, up)];
        let corners = [(half, -up), (half, up), (-half, -up), (-half, up)];
        level.into_iter().chain(corners)
    });
    around.map(|(dx, dy)| (x + dx, y + dy)).collect()
}

/// Middles for a text of this size along a line, near its middle.
pub fn along(line: &[Point], (width, height): (f32, f32)) -> Vec<Point> {
    const SHARES: [f32; 7] = [0.5, 0.4, 0.6, 0.3, 0.7, 0.2, 0.8];
    let mut places = Vec::new();
    for share in SHARES {
        let here = ((line.len().saturating_sub(1)) as f32 * share) as usize;
        let (Some((ax, ay)), Some((bx, by))) = (line.get(here), line.get(here + 1)) else { continue };
        let length = (bx - ax).hypot(by - ay).max(0.01);
        let (nx, ny) = (-(by - ay) / length, (bx - ax) / length);
        // a text beside a line going up needs more room than one above it
        let gap = 8.0 + nx.abs() * width / 2.0 + ny.abs() * height / 2.0;
        places.extend([gap, -gap, gap * 1.6, -gap * 1.6].map(|gap| (ax + nx * gap, ay + ny * gap)));
    }
    places
}

/// Middles for a text at one of a ring's edges.
pub fn at_ring(ring: &[Point]) -> Vec<Point> {
    let edges = ring.iter().zip(ring.iter().cycle().skip(1));
    let middles = edges.map(|(a, b)| ((a.0 + b.0) / 2.0, (a.1 + b.1) / 2.0));
    middles.flat_map(|(x, y)| [(x, y + 13.0), (x, y - 13.0), (x + 30.0, y), (x - 30.0, y)]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: (f32, f32) = (40.0, 14.0);

    fn labels() -> Labels {
        Labels::new(Room { left: 0.0, top: 0.0, right: 400.0, bottom: 300.0 })
    }

    #[test]
    fn a_name_stands_beside_its_point_and_off_what_is_there() {
        let (mut labels, at) = (labels(), (200.0, 150.0));
        let first = labels.best(&beside(at, SIZE), SIZE);
        assert_eq!(first, Some((232.0, 150.0)), "on the right, where there is room");
        labels.take(Room::about((232.0, 150.0), SIZE));
        let second = labels.best(&beside(at, SIZE), SIZE);
        assert_eq!(second, Some((168.0, 150.0)), "else on the left");
        labels.keep_clear(&[(100.0, 150.0), (200.0, 150.0)]);
        let third = labels.best(&beside(at, SIZE), SIZE);
        assert!(third.is_some_and(|(_, y)| y != 150.0), "not on the line: {third:?}");
    }

    #[test]
    fn nothing_stands_outside_the_window() {
        let labels = labels();
        let (x, _) = labels.best(&beside((395.0, 150.0), SIZE), SIZE).unwrap();
        assert!(x < 380.0);
        assert_eq!(labels.best(&beside((600.0, 150.0), SIZE), SIZE), None);
        assert_eq!(labels.best(&along(&[(9.0, 9.0)], SIZE), SIZE), None, "a point is no line");
    }

    #[test]
    fn each_room_that_is_met_counts_once_wherever_it_is() {
        let mut labels = labels();
        let rooms: Vec<Room> = (0..200)
            .map(|n| {
                let (x, y) = ((n * 37 % 560) as f32 - 80.0, (n * 91 % 460) as f32 - 80.0);
                Room::about((x, y), ((n * 13 % 170) as f32, (n * 7 % 90) as f32))
            })
            .collect();
        rooms.iter().for_each(|room| labels.take(*room));
        for room in &rooms {
            let room = room.grown(3.0);
            let met = rooms.iter().filter(|taken| taken.meets(&room)).count();
            assert_eq!(labels.taken.met(&room).count(), met, "{room:?}");
        }
        assert!(labels.is_free(&Room::about((-900.0, 150.0), SIZE)), "far outside");
    }

    #[test]
    fn names_along_a_line_and_at_a_ring_are_near_it() {
        let line = [(100.0, 100.0), (200.0, 100.0), (300.0, 100.0)];
        let (_, y) = labels().best(&along(&line, SIZE), SIZE).unwrap();
        assert!((y - 100.0).abs() < 16.0, "{y}");
        let (x, y) = labels().best(&at_ring(&line), SIZE).unwrap();
        assert_eq!((x, y), (150.0, 113.0));
    }
}
