//! What every picture of the ground shares, whether egui draws it on the screen or tiny-skia into a report: the shaded ground,
//! the zones, and where names stand. Pure: numbers in, places and colours out.

pub mod labels;
pub mod relief;
pub mod zones;

/// A place on a picture: rightwards and downwards, pixels or screen points.
pub type Point = (f32, f32);

/// A rectangle on a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Room {
    /// Its least x.
    pub left: f32,
    /// Its least y.
    pub top: f32,
    /// Its greatest x.
    pub right: f32,
    /// Its greatest y.
    pub bottom: f32,
}

impl Room {
    /// Of this width and height, about a middle.
    pub fn about((x, y): Point, (width, height): (f32, f32)) -> Self {
        let (half, up) = (width / 2.0, height / 2.0);
        Self { left: x - half, top: y - up, right: x + half, bottom: y + up }
    }

    /// Larger by so much on each side.
    pub fn grown(self, by: f32) -> Self {
        Self { left: self.left - by, top: self.top - by, right: self.right + by, bottom: self.bottom + by }
    }

    /// They have something in common.
    pub fn meets(&self, other: &Self) -> bool {
        self.left < other.right
            && self.right > other.left
            && self.top < other.bottom
            && self.bottom > other.top
    }

    /// The other one lies in it.
    pub fn holds(&self, other: &Self) -> bool {
        self.left <= other.left
            && self.right >= other.right
            && self.top <= other.top
            && self.bottom >= other.bottom
    }

    /// The point lies in it.
    pub fn contains(&self, (x, y): Point) -> bool {
        (self.left..self.right).contains(&x) && (self.top..self.bottom).contains(&y)
    }
}
