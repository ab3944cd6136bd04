//! The ground seen from above, lit from the north-west, 45° high: the map-maker's usual.

use std::f64::consts::FRAC_1_SQRT_2;

/// Elevations at the pixels of a picture; rows run southwards, columns eastwards.
#[derive(Debug)]
pub struct Grid {
    width: usize,
    height: usize,
    /// Metres of ground per pixel.
    spacing_m: f64,
    elevations_m: Vec<Option<f64>>,
}

/// How a picture shows the ground.
#[derive(Debug, Clone, Copy)]
pub struct Style {
    /// Elevations, metres AMSL, ascending, and the colours of level ground there: red, green, blue.
    pub tints: [(f64, [f64; 3]); 5],
    /// Slopes are shown so many times as steep as they are.
    pub exaggeration: f64,
    /// How much lighter and darker slopes are than level ground; 1 is Lambert's law.
    pub contrast: f64,
    /// Least and greatest light, level ground being 1.
    pub light: (f64, f64),
    /// Metres between contour lines.
    pub contour_m: Option<f64>,
    /// Ground over which a slope is measured, metres: below the spacing of the data its squares would show.
    pub slope_m: f64,
}

/// How much darker a contour line is.
const CONTOUR: f64 = 0.9;

impl Grid {
    /// Asks for the elevation at each pixel (column, row).
    pub fn sample(
        (width, height): (usize, usize),
        spacing_m: f64,
        elevation_m: impl Fn(usize, usize) -> Option<f64>,
    ) -> Self {
        let at = |i: usize| elevation_m(i % width, i / width);
        let elevations_m = (0..width * height).map(at).collect();
        Self { width, height, spacing_m, elevations_m }
    }

    /// Row by row the colour of each pixel: red, green, blue; `None` where nothing is known.
    pub fn paint<'a>(&'a self, style: &'a Style) -> impl Iterator<Item = Option<[u8; 3]>> + 'a {
        let reach = (style.slope_m / self.spacing_m / 2.0).ceil().clamp(1.0, 1000.0) as usize;
        (0..self.width * self.height)
            .map(move |i| self.colour((i % self.width, i / self.width), reach, style))
    }

    fn colour(&self, (column, row): (usize, usize), reach: usize, style: &Style) -> Option<[u8; 3]> {
        let here = self.at(column, row)?;
        let (west, east) = (column.saturating_sub(reach), (column + reach).min(self.width - 1));
        let (north, south) = (row.saturating_sub(reach), (row + reach).min(self.height - 1));
        let run_m = |pixels: usize| pixels.max(1) as f64 * self.spacing_m / style.exaggeration;
        let eastwards = (self.at(east, row)? - self.at(west, row)?) / run_m(east - west);
        let northwards = (self.at(column, north)? - self.at(column, south)?) / run_m(south - north);
        let (darkest, lightest) = style.light;
        let light = 1.0 + (brightness(eastwards, northwards) - 1.0) * style.contrast;
        let line = if self.on_contour(here, (column, row), style) { CONTOUR } else { 1.0 };
        Some(
            tint(here, &style.tints)
                .map(|c| (c * light.clamp(darkest, lightest) * line).clamp(0.0, 255.0) as u8),
        )
    }

    /// The next pixel eastwards or southwards lies between another pair of contour lines.
    fn on_contour(&self, here: f64, (column, row): (usize, usize), style: &Style) -> bool {
        let Some(step) = style.contour_m else { return false };
        let band = |elevation_m: f64| (elevation_m / step).floor();
        let next = [self.at(column + 1, row), self.at(column, row + 1)];
        next.into_iter().flatten().any(|next| band(next) != band(here))
    }

    fn at(&self, column: usize, row: usize) -> Option<f64> {
        (column < self.width).then(|| self.elevations_m.get(row * self.width + column).copied().flatten())?
    }
}

/// Lambert's law on a slope (rise per run eastwards and northwards); level ground is 1.
fn brightness(eastwards: f64, northwards: f64) -> f64 {
    // towards the light, and the slope's normal, which is longer than 1 by the root
    let towards = (eastwards - northwards) * 0.5 + FRAC_1_SQRT_2;
    let normal = (eastwards * eastwards + northwards * northwards + 1.0).sqrt();
    (towards / normal / FRAC_1_SQRT_2).max(0.0)
}

/// The colour of level ground.
fn tint(elevation_m: f64, tints: &[(f64, [f64; 3]); 5]) -> [f64; 3] {
    let mut colour = tints[0].1;
    for ((low, a), (high, b)) in tints.iter().zip(tints.iter().skip(1)) {
        if elevation_m >= *low {
            let share = ((elevation_m - low) / (high - low)).min(1.0);
            colour = std::array::from_fn(|i| a[i] + (b[i] - a[i]) * share);
        }
    }
    colour
}

#[cfg(test)]
mod tests {
    use super::*;

    const STYLE: Style = Style {
        tints: [
            (0.0, [0.0; 3]),
            (100.0, [100.0; 3]),
            (200.0, [110.0; 3]),
            (300.0, [120.0; 3]),
            (400.0, [130.0; 3]),
        ],
        exaggeration: 1.0,
        contrast: 1.0,
        light: (0.2, 1.5),
        contour_m: None,
        slope_m: 20.0,
    };

    /// The first channel of the pixel in the middle of 5 × 5, 10 m apart.
    fn middle(style: &Style, elevation_m: impl Fn(usize, usize) -> Option<f64>) -> Option<u8> {
        let grid = Grid::sample((5, 5), 10.0, elevation_m);
        let pixels: Vec<_> = grid.paint(style).collect();
        assert_eq!(pixels.len(), 25);
        pixels[12].map(|[red, ..]| red)
    }

    #[test]
    fn slopes_towards_the_light_are_brighter() {
        assert!((brightness(0.0, 0.0) - 1.0).abs() < 1e-12);
        assert!(brightness(0.5, 0.0) > 1.0, "a slope that rises eastwards faces west");
        assert!(brightness(0.0, -0.5) > 1.0, "one that falls northwards faces north");
        assert!(brightness(-0.5, 0.5) < 1.0);
        assert!(brightness(1e9, -1e9) <= 1.42 && brightness(-1e9, 1e9) >= 0.0);
        let slope = |east: f64, south: f64| {
            middle(&STYLE, |c, r| Some(150.0 + (c as f64 - 2.0) * east + (r as f64 - 2.0) * south))
        };
        assert_eq!(slope(0.0, 0.0), Some(105));
        assert!(slope(2.0, 2.0) > Some(120) && slope(-2.0, -2.0) < Some(90));
        assert_eq!(slope(-1000.0, -1000.0), Some(21), "no darker than that");
    }

    #[test]
    fn elevations_have_the_tints_between_and_beyond_those_given() {
        let tint = |m| tint(m, &STYLE.tints)[0];
        assert_eq!(
            [-500.0, 0.0, 50.0, 100.0, 250.0, 400.0, 9000.0].map(tint),
            [0.0, 0.0, 50.0, 100.0, 115.0, 130.0, 130.0]
        );
    }

    #[test]
    fn contours_are_darker_and_unknown_ground_has_no_colour() {
        let style = Style { contour_m: Some(50.0), ..STYLE };
        let step = |c: usize, _: usize| Some(if c <= 2 { 149.99 } else { 150.01 });
        assert!(middle(&style, step) < middle(&STYLE, step));
        assert_eq!(middle(&STYLE, |c, r| ((c, r) != (2, 2)).then_some(150.0)), None);
        assert_eq!(middle(&STYLE, |c, _| (c != 3).then_some(150.0)), None, "nothing is known of its slope");
    }
}
