//! Contact sheets: what the window looks like in many ways, small enough to be kept in the repository, large enough that a
//! button that is gone or a label that changed is seen.

use crate::compare::{Mismatch, is_blessed};
use image::{ImageError, Rgb, RgbImage, RgbaImage, imageops};
use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;

/// So many pixels of a side become one, their mean: letters become grey strokes, and a small button 15 by 5 pixels.
const SHRUNK: u32 = 4;
/// Channels are kept in steps of this.
const STEP: u8 = 8;
/// Colours of a file, as many as one byte tells; the others become their nearest.
const COLOURS: usize = 256;
/// A channel of a pixel may differ by so much: half a step is lost in the file, and lines lie a little differently on other
/// machines. A word of grey letters differs from its ground by two or three times as much.
const CHANNEL: u8 = 12;
/// A colour that the file has not may have become one that is so far away.
const LOST: u8 = 48;
/// So many pixels of a square may differ by more: a digit of a clock or the caret of a text field, but no word.
const MOST: usize = 7;
/// Squares have twice this side, and lie half over each other, so that nothing small falls between two.
const HALF_SQUARE: u32 = 8;

/// Small copies of pictures, in rows.
#[derive(Debug, Default)]
pub struct Sheet {
    rows: Vec<Vec<RgbImage>>,
}

impl Sheet {
    /// The pictures from here on stand below those before.
    pub fn begin_row(&mut self) {
        self.rows.push(Vec::new());
    }

    /// Adds a copy of a picture at the end of the last row.
    pub fn add(&mut self, picture: &RgbaImage) {
        if self.rows.is_empty() {
            self.begin_row();
        }
        if let Some(row) = self.rows.last_mut() {
            row.push(shrunk(picture));
        }
    }

    /// Compares the sheet with its file; with `LEGWORK_BLESS` set, writes the file where they differ. A new sheet that
    /// differs is left in the folder `scratch`, and beside it one that shows in red what differs.
    ///
    /// # Errors
    /// They differ, or there is no such file.
    pub fn check(&self, path: &Path, scratch: &Path) -> Result<(), Mismatch> {
        let sheet = self.whole();
        let found = compare(&sheet, path, scratch);
        if found.is_err() && is_blessed() {
            return save(&sheet, path);
        }
        found
    }

    /// Where too much differs from another sheet, pixels.
    #[must_use]
    pub fn difference(&self, other: &Self) -> Option<(u32, u32)> {
        first_difference(&self.whole(), &other.whole())
    }

    fn whole(&self) -> RgbImage {
        let width = |row: &Vec<RgbImage>| row.iter().map(RgbImage::width).sum::<u32>();
        let height = |row: &Vec<RgbImage>| row.iter().map(RgbImage::height).max().unwrap_or_default();
        let all = (self.rows.iter().map(width).max().unwrap_or_default(), self.rows.iter().map(height).sum());
        let mut sheet = RgbImage::new(all.0, all.1);
        let mut top = 0;
        for row in &self.rows {
            let mut left = 0;
            for picture in row {
                imageops::replace(&mut sheet, picture, i64::from(left), i64::from(top));
                left += picture.width();
            }
            top += height(row);
        }
        sheet
    }
}

fn shrunk(picture: &RgbaImage) -> RgbImage {
    RgbImage::from_fn(picture.width() / SHRUNK, picture.height() / SHRUNK, |x, y| {
        let mut sums = [0u32; 3];
        for (across, down) in (0..SHRUNK).flat_map(|across| (0..SHRUNK).map(move |down| (across, down))) {
            let pixel = picture.get_pixel(x * SHRUNK + across, y * SHRUNK + down);
            for (sum, channel) in sums.iter_mut().zip(pixel.0) {
                *sum += u32::from(channel);
            }
        }
        Rgb(sums.map(|sum| (sum / (SHRUNK * SHRUNK)) as u8))
    })
}

fn compare(sheet: &RgbImage, path: &Path, scratch: &Path) -> Result<(), Mismatch> {
    let before = image::open(path).map_err(|why| Mismatch::NoFile(path.into(), why))?.to_rgb8();
    if before.dimensions() != sheet.dimensions() {
        return Err(Mismatch::Size(path.into(), before.dimensions(), sheet.dimensions()));
    }
    let Some(at) = first_difference(&before, sheet) else { return Ok(()) };
    let name = path.file_stem().unwrap_or(path.as_os_str()).to_string_lossy();
    let file = |end: &str| scratch.join(format!("{name}{end}.png"));
    let (new, difference) = (file(""), file("-difference"));
    std::fs::create_dir_all(scratch).map_err(|why| Mismatch::NoFile(scratch.into(), why.into()))?;
    save(sheet, &new)?;
    save(&marked(&before, sheet), &difference)?;
    Err(Mismatch::Place(path.into(), at, new, difference))
}

/// The middle of the uppermost square in which too much differs.
fn first_difference(before: &RgbImage, now: &RgbImage) -> Option<(u32, u32)> {
    let mut squares = BTreeMap::<(u32, u32), usize>::new();
    for (x, y) in differing(before, now) {
        let (column, row) = (x / HALF_SQUARE, y / HALF_SQUARE);
        for corner in [(row, column), (row, column + 1), (row + 1, column), (row + 1, column + 1)] {
            *squares.entry(corner).or_default() += 1;
        }
    }
    let (row, column) = squares.into_iter().find(|(_, differing)| *differing > MOST)?.0;
    Some((column * HALF_SQUARE, row * HALF_SQUARE))
}

/// Pixels whose colour is another, and would be another in the file.
fn differing(before: &RgbImage, now: &RgbImage) -> Vec<(u32, u32)> {
    let colours: Vec<[u8; 3]> = before.pixels().map(|p| p.0).collect::<BTreeSet<_>>().into_iter().collect();
    let is_other = |was: &Rgb<u8>, is: &Rgb<u8>| {
        let apart = apart(was.0, is.0);
        apart > CHANNEL && (apart > LOST || colours.get(nearest(is.0, &colours)) != Some(&was.0))
    };
    let pairs = before.enumerate_pixels().zip(now.pixels());
    pairs.filter(|((_, _, was), is)| is_other(was, is)).map(|((x, y, _), _)| (x, y)).collect()
}

/// The new sheet in grey, what differs in red.
fn marked(before: &RgbImage, now: &RgbImage) -> RgbImage {
    let mut marked = now.clone();
    marked.pixels_mut().for_each(|pixel| pixel.0 = [64 + pixel.0[1] / 2; 3]);
    differing(before, now).into_iter().for_each(|(x, y)| marked.put_pixel(x, y, Rgb([255, 0, 0])));
    marked
}

/// A byte for each pixel.
fn save(sheet: &RgbImage, path: &Path) -> Result<(), Mismatch> {
    let palette = palette(sheet);
    let mut indices = HashMap::new();
    let index = |pixel: &Rgb<u8>| {
        let colour = stepped(pixel);
        *indices.entry(colour).or_insert_with(|| nearest(colour, &palette) as u8)
    };
    let bytes: Vec<u8> = sheet.pixels().map(index).collect();
    let write = || -> Result<(), std::io::Error> {
        let file = BufWriter::new(File::create(path)?);
        let mut encoder = png::Encoder::new(file, sheet.width(), sheet.height());
        encoder.set_color(png::ColorType::Indexed);
        encoder.set_palette(palette.concat());
        encoder.set_compression(png::Compression::High);
        encoder.set_filter(png::Filter::NoFilter);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&bytes)?;
        Ok(writer.finish()?)
    };
    write().map_err(|why| Mismatch::NoFile(path.into(), ImageError::IoError(why)))
}

/// The colours that are seen most, and those that are far from them, so that none is far from all of them.
fn palette(sheet: &RgbImage) -> Vec<[u8; 3]> {
    let mut counts = HashMap::<[u8; 3], usize>::new();
    for pixel in sheet.pixels() {
        *counts.entry(stepped(pixel)).or_default() += 1;
    }
    let mut colours: Vec<([u8; 3], usize)> = counts.into_iter().collect();
    colours.sort_by_key(|(colour, count)| (Reverse(*count), *colour));
    let colours: Vec<[u8; 3]> = colours.into_iter().map(|(colour, _)| colour).collect();
    let mut palettes = (0..u8::MAX).step_by(STEP.into()).map(|distance| spread(&colours, distance));
    palettes.find(|palette| palette.len() <= COLOURS).unwrap_or_default()
}

/// The first ones, each farther than this from those before it.
fn spread(colours: &[[u8; 3]], distance: u8) -> Vec<[u8; 3]> {
    let mut spread: Vec<[u8; 3]> = Vec::new();
    for colour in colours {
        if spread.len() <= COLOURS && spread.iter().all(|other| apart(*other, *colour) > distance) {
            spread.push(*colour);
        }
    }
    spread
}

/// By the channel that differs most.
fn apart(a: [u8; 3], b: [u8; 3]) -> u8 {
    a.iter().zip(b).map(|(a, b)| a.abs_diff(b)).max().unwrap_or_default()
}

fn stepped(pixel: &Rgb<u8>) -> [u8; 3] {
    pixel.0.map(|channel| channel.saturating_add(STEP / 2) / STEP * STEP)
}

/// Which of them is the nearest to a colour.
fn nearest(colour: [u8; 3], colours: &[[u8; 3]]) -> usize {
    let nearest = colours.iter().enumerate().min_by_key(|(_, other)| apart(**other, colour));
    nearest.map_or(0, |(index, _)| index)
}

#[cfg(test)]
mod tests;
