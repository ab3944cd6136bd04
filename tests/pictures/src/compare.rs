//! Pictures that tests make, and those in the repository.

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{DynamicImage, RgbaImage, imageops};
use std::fmt;
use std::path::{Path, PathBuf};

/// A channel of a pixel may differ by so much: fonts and lines are computed a little differently on other machines.
const CHANNEL: u8 = 48;
/// So many pixels may differ by more. On one machine none does: the same window is the same picture.
const MOST: usize = 20;

/// A picture that isn't as the one in the repository.
#[derive(Debug)]
pub enum Mismatch {
    /// There is none, or it can't be read or written.
    NoFile(PathBuf, image::ImageError),
    /// They have other sizes, pixels.
    Size(PathBuf, (u32, u32), (u32, u32)),
    /// So many pixels are not alike; the new picture lies there.
    Pixels(PathBuf, usize, PathBuf),
    /// Of a sheet, there, pixels; the new one lies there, and one that shows what differs.
    Place(PathBuf, (u32, u32), PathBuf, PathBuf),
}

impl fmt::Display for Mismatch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoFile(path, why) => write!(f, "{}: {why}", path.display())?,
            Self::Size(path, before, now) => {
                write!(f, "{}: was {before:?}, is {now:?} pixels", path.display())?
            }
            Self::Pixels(path, differing, new) => {
                write!(f, "{}: {differing} pixels differ from {}", path.display(), new.display())?;
            }
            Self::Place(path, at, new, difference) => {
                let (path, new, difference) = (path.display(), new.display(), difference.display());
                write!(f, "{path}: at {at:?} pixels it differs from {new}, see {difference}")?;
            }
        }
        write!(f, "; LEGWORK_BLESS=1 writes it anew")
    }
}

/// Compares a picture with the file of the same picture; with `LEGWORK_BLESS` set, writes the file where they differ.
/// A new picture that differs is left in `scratch`.
///
/// # Errors
/// They differ, or there is no such file.
pub fn check(picture: &RgbaImage, path: &Path, scratch: &Path) -> Result<(), Mismatch> {
    let found = compare(picture, path, scratch);
    if found.is_err() && is_blessed() {
        return save(picture, path);
    }
    found
}

/// What differs is to be written anew.
pub(crate) fn is_blessed() -> bool {
    std::env::var_os("LEGWORK_BLESS").is_some()
}

fn compare(picture: &RgbaImage, path: &Path, scratch: &Path) -> Result<(), Mismatch> {
    let before = image::open(path).map_err(|why| Mismatch::NoFile(path.into(), why))?.to_rgba8();
    if before.dimensions() != picture.dimensions() {
        return Err(Mismatch::Size(path.into(), before.dimensions(), picture.dimensions()));
    }
    let differing = before.pixels().zip(picture.pixels()).filter(|(a, b)| !are_alike(a.0, b.0)).count();
    if differing <= MOST {
        return Ok(());
    }
    let new = scratch.join(path.file_name().unwrap_or(path.as_os_str()));
    save(picture, &new)?;
    Err(Mismatch::Pixels(path.into(), differing, new))
}

/// Without alpha, and as small as can be: it stays in the repository for good.
fn save(picture: &RgbaImage, path: &Path) -> Result<(), Mismatch> {
    let file = std::fs::File::create(path).map_err(image::ImageError::IoError);
    let written = file.and_then(|file| {
        let encoder = PngEncoder::new_with_quality(file, CompressionType::Best, FilterType::Adaptive);
        DynamicImage::from(picture.clone()).into_rgb8().write_with_encoder(encoder)
    });
    written.map_err(|why| Mismatch::NoFile(path.into(), why))
}

fn are_alike(a: [u8; 4], b: [u8; 4]) -> bool {
    a.iter().zip(b).all(|(a, b)| a.abs_diff(b) <= CHANNEL)
}

/// The same picture at half its size: small enough to be kept, and everything can still be told.
pub fn halved(picture: &RgbaImage) -> RgbaImage {
    let (width, height) = (picture.width() / 2, picture.height() / 2);
    imageops::resize(picture, width.max(1), height.max(1), imageops::FilterType::Triangle)
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgba;

    #[test]
    fn few_pixels_may_differ_and_many_may_not() {
        let folder = std::env::temp_dir().join(format!("legwork-pictures-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let path = folder.join("kept.png");
        let scratch = folder.join("new");
        std::fs::create_dir_all(&scratch).unwrap();
        let mut picture = RgbaImage::from_pixel(100, 100, Rgba([10, 20, 30, 255]));
        assert!(matches!(compare(&picture, &path, &scratch), Err(Mismatch::NoFile(..))));
        picture.save(&path).unwrap();
        for x in 0..20 {
            picture.put_pixel(x, 5, Rgba([255, 20, 30, 255]));
        }
        assert!(compare(&picture, &path, &scratch).is_ok());
        for x in 0..20 {
            picture.put_pixel(x, 6, Rgba([255, 20, 30, 255]));
        }
        assert!(matches!(compare(&picture, &path, &scratch), Err(Mismatch::Pixels(_, 40, _))));
        assert!(scratch.join("kept.png").exists());
        assert!(matches!(compare(&halved(&picture), &path, &scratch), Err(Mismatch::Size(..))));
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
