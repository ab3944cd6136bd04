//! Power series of the geodesics through a point: Legendre's, as in Jordan's Handbuch der
//! Vermessungskunde III, and their reversion. Derived again by computer algebra from
//! dφ/ds = cos α / M, dλ/ds = sin α / (N cos φ), dα/ds = tan φ sin α / N.
//!
//! Everything is in units of N: x is north-like (latitude difference or northing), y east-like
//! (longitude difference × cos φ, or easting). `t` = tan φ, `h` = e'² cos² φ at the origin.
//! Orders one to four are those of the ellipsoid; of order five the parts without `h`.

/// A series in x and y that is even in y.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Even {
    /// x to x⁴.
    y0: [f64; 4],
    /// y² to x³y².
    y2: [f64; 4],
    /// y⁴ and xy⁴.
    y4: [f64; 2],
}

/// A series in x and y that is odd in y.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Odd {
    /// xy to x⁴y; y itself has the factor 1.
    y1: [f64; 4],
    /// y³ to x²y³.
    y3: [f64; 3],
    /// y⁵.
    y5: f64,
}

impl Even {
    pub fn at(&self, x: f64, y: f64) -> f64 {
        let ([a1, a2, a3, a4], [b0, b1, b2, b3], [c0, c1]) = (self.y0, self.y2, self.y4);
        let yy = y * y;
        x * (a1 + x * (a2 + x * (a3 + x * a4)))
            + yy * (b0 + x * (b1 + x * (b2 + x * b3)) + yy * (c0 + x * c1))
    }
}

impl Odd {
    pub fn at(&self, x: f64, y: f64) -> f64 {
        let ([a1, a2, a3, a4], [b0, b1, b2]) = (self.y1, self.y3);
        let yy = y * y;
        y * (1.0 + x * (a1 + x * (a2 + x * (a3 + x * a4))) + yy * (b0 + x * (b1 + x * b2) + yy * self.y5))
    }
}

/// Latitude difference by northing and easting.
pub(super) fn latitude(t: f64, h: f64) -> Even {
    let (v, tt) = (1.0 + h, t * t);
    let x4 = (35.0 * tt - 19.0) * h * h + (15.0 * tt - 23.0) * h - 4.0;
    let x2y2 = (45.0 * tt - 17.0) * h * h - (9.0 * tt + 13.0) * h + 6.0 * tt + 4.0;
    let xy2 = 9.0 * h * tt - h - 3.0 * tt - 1.0;
    Even {
        y0: [v, -1.5 * h * t * v, h * v * (5.0 * h * tt - h + tt - 1.0) / 2.0, -h * t * v * x4 / 8.0],
        y2: [-t * v / 2.0, v * xy2 / 6.0, -t * v * x2y2 / 12.0, -(15.0 * tt * tt + 15.0 * tt + 2.0) / 30.0],
        y4: [-t * v * xy2 / 24.0, (45.0 * tt * tt + 30.0 * tt + 1.0) / 120.0],
    }
}

/// Longitude difference × cos φ by northing and easting.
pub(super) fn longitude(t: f64, h: f64) -> Odd {
    let tt = t * t;
    let x2y = h + 3.0 * tt + 1.0;
    Odd {
        y1: [t, x2y / 3.0, t * (h - h * h + 3.0 * tt + 2.0) / 3.0, (15.0 * tt * tt + 15.0 * tt + 2.0) / 15.0],
        y3: [-tt / 3.0, -t * x2y / 3.0, -(30.0 * tt * tt + 20.0 * tt + 1.0) / 15.0],
        y5: tt * (3.0 * tt + 1.0) / 15.0,
    }
}

/// Northing by latitude and longitude difference.
pub(super) fn north(t: f64, h: f64) -> Even {
    let (v, tt) = (1.0 + h, t * t);
    let x4 = (20.0 * tt + 11.0) * h * h - (15.0 * tt - 7.0) * h - 4.0;
    Even {
        y0: [
            1.0 / v,
            1.5 * h * t / (v * v),
            h * (4.0 * h * tt + h - tt + 1.0) / (2.0 * v * v * v),
            h * t * x4 / (8.0 * v * v * v * v),
        ],
        y2: [
            t / 2.0,
            (1.0 + h - 3.0 * tt) / (6.0 * v),
            -t * (9.0 * h * tt - h * h + 3.0 * h + 4.0) / (12.0 * v * v),
            -2.0 / 45.0,
        ],
        y4: [t * (1.0 + h - tt) / 24.0, (15.0 * tt * tt - 50.0 * tt + 7.0) / 360.0],
    }
}

/// Easting by latitude and longitude difference.
pub(super) fn east(t: f64, h: f64) -> Odd {
    let (v, tt) = (1.0 + h, t * t);
    Odd {
        y1: [
            -t / v,
            -(9.0 * h * tt + 2.0 * h + 2.0) / (6.0 * v * v),
            -h * t * (12.0 * h * tt + 7.0 * h - 3.0 * tt + 7.0) / (6.0 * v * v * v),
            -1.0 / 45.0,
        ],
        y3: [-tt / 6.0, t * (tt - h - 1.0) / (6.0 * v), 2.0 * (5.0 * tt - 1.0) / 45.0],
        y5: tt * (tt - 3.0) / 120.0,
    }
}
