//! Samples on a regular grid: what every kind of elevation data is inside.

/// A value of a sample, metres.
pub(crate) trait Sample: Copy + PartialOrd + Into<f64> {
    /// Less than any elevation: nothing is known.
    const VOID: Self;
}

impl Sample for i16 {
    const VOID: Self = i16::MIN;
}

impl Sample for f32 {
    const VOID: Self = f32::NEG_INFINITY;
}

/// Samples a side of the blocks whose highest one is kept: 2.8 km at 3″.
const BLOCK: usize = 30;

/// Rows from north to south, columns from west to east.
#[derive(Clone, PartialEq, Eq)]
pub(crate) struct Grid<T> {
    width: usize,
    height: usize,
    /// [`Sample::VOID`] where nothing is known.
    samples_m: Vec<T>,
    /// Highest sample of each block, with its edges.
    blocks_m: Vec<T>,
}

impl<T: Sample> Grid<T> {
    /// A grid; samples that are missing at the end are void.
    pub fn new(width: usize, mut samples_m: Vec<T>) -> Self {
        let width = width.max(1);
        let height = samples_m.len().div_ceil(width);
        samples_m.resize(width * height, T::VOID);
        let blocks_m = blocks(&samples_m, width, height);
        Self { width, height, samples_m, blocks_m }
    }

    /// Columns and rows.
    pub fn size(&self) -> (usize, usize) {
        (self.width, self.height)
    }

    /// Something is known somewhere.
    pub fn knows_something(&self) -> bool {
        self.samples_m.iter().any(|s| *s > T::VOID)
    }

    /// Metres at a place between the samples, bilinear; `None` outside and where a sample that matters is void.
    pub fn at(&self, column: f64, row: f64) -> Option<f64> {
        let (right, bottom) = (last(self.width), last(self.height));
        if !(0.0..=right).contains(&column) || !(0.0..=bottom).contains(&row) {
            return None;
        }
        let (x, y) = (column.floor().min((right - 1.0).max(0.0)), row.floor().min((bottom - 1.0).max(0.0)));
        let (u, v) = (column - x, row - y);
        let (x, y) = (whole(x), whole(y));
        mix(self.blend(x, y, u), self.blend(x, y + 1, u), v)
    }

    /// Metres that nothing between these columns and rows is above; `None`: nothing is known there.
    pub fn highest(&self, columns: (f64, f64), rows: (f64, f64)) -> Option<f64> {
        let (right, bottom) = (last(self.width), last(self.height));
        if columns.1 < 0.0 || columns.0 > right || rows.1 < 0.0 || rows.0 > bottom {
            return None;
        }
        let block = |samples: f64, last: f64| whole(samples.clamp(0.0, last)) / BLOCK;
        let columns = block(columns.0, right)..=block(columns.1, right);
        let across = self.width.div_ceil(BLOCK);
        let blocks = (block(rows.0, bottom)..=block(rows.1, bottom))
            .flat_map(|row| columns.clone().map(move |column| row * across + column));
        let known = blocks.filter_map(|i| self.blocks_m.get(i)).filter(|m| **m > T::VOID);
        known.map(|m| (*m).into()).reduce(f64::max)
    }

    /// First and last column and row of what is known.
    pub fn known(&self) -> ((usize, usize), (usize, usize)) {
        let (mut columns, mut rows) = ((self.width, 0), (self.height, 0));
        for (i, _) in self.samples_m.iter().enumerate().filter(|(_, s)| **s > T::VOID) {
            let (row, column) = (i / self.width, i % self.width);
            columns = (columns.0.min(column), columns.1.max(column));
            rows = (rows.0.min(row), rows.1.max(row));
        }
        (columns, rows)
    }

    /// Between a sample and its eastern neighbour, `u` in 0..=1.
    fn blend(&self, column: usize, row: usize, u: f64) -> Option<f64> {
        mix(self.sample(column, row), self.sample(column + 1, row), u)
    }

    fn sample(&self, column: usize, row: usize) -> Option<f64> {
        if column >= self.width {
            return None;
        }
        let sample = *self.samples_m.get(row * self.width + column)?;
        (sample > T::VOID).then(|| sample.into())
    }
}

fn last(samples: usize) -> f64 {
    samples.saturating_sub(1) as f64
}

/// A number of samples, which is nowhere more than a grid has.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a cast of floats saturates")]
fn whole(samples: f64) -> usize {
    samples as usize
}

/// The highest sample of each block and of what lies on its edges.
fn blocks<T: Sample>(samples_m: &[T], width: usize, height: usize) -> Vec<T> {
    let across = width.div_ceil(BLOCK);
    let mut blocks = vec![T::VOID; across * height.div_ceil(BLOCK)];
    for (row, samples) in samples_m.chunks_exact(width).enumerate() {
        // the first row of a block is the last of the one before it too
        for block_row in row.saturating_sub(1) / BLOCK..=row / BLOCK {
            for (column, block) in blocks.iter_mut().skip(block_row * across).take(across).enumerate() {
                for sample in samples.iter().skip(column * BLOCK).take(BLOCK + 1) {
                    if *sample > *block {
                        *block = *sample;
                    }
                }
            }
        }
    }
    blocks
}

/// Linear between two values; a void counts only if it has weight.
fn mix(a: Option<f64>, b: Option<f64>, share_of_b: f64) -> Option<f64> {
    match (a, b) {
        (Some(a), Some(b)) => Some(a + (b - a) * share_of_b),
        (Some(a), None) if share_of_b == 0.0 => Some(a),
        (None, Some(b)) if share_of_b == 1.0 => Some(b),
        _ => None,
    }
}
