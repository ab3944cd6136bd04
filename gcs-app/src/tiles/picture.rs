//! A tile's bytes as a picture. Its size is known from the header before memory is taken for it.

use egui::ColorImage;
use image::{ImageReader, Limits};
use std::io::Cursor;

/// Most bytes of a tile in its file.
pub const MAX_BYTES: usize = 4 << 20;
/// Most pixels along a side.
const MAX_SIDE: u32 = 4096;
/// Most bytes that decoding it may take.
const MAX_DECODED: u64 = 16 << 20;
/// A larger picture is made as small as this, pixels along a side: a tile is 256 points on the screen.
const SIDE: u32 = 512;

/// PNG, JPEG or WebP; `None`: it is none of them, damaged, or larger than a tile has any reason to be.
pub fn decode(bytes: &[u8]) -> Option<ColorImage> {
    if bytes.len() > MAX_BYTES {
        return None;
    }
    let header = ImageReader::new(Cursor::new(bytes)).with_guessed_format().ok()?;
    let (width, height) = header.into_dimensions().ok()?;
    let decoded = u64::from(width) * u64::from(height) * 4;
    if width == 0 || height == 0 || width.max(height) > MAX_SIDE || decoded > MAX_DECODED {
        return None;
    }
    let mut reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format().ok()?;
    let mut limits = Limits::default();
    (limits.max_image_width, limits.max_image_height) = (Some(MAX_SIDE), Some(MAX_SIDE));
    limits.max_alloc = Some(4 * MAX_DECODED);
    reader.limits(limits);
    let picture = reader.decode().ok()?;
    let picture = if width.max(height) > SIDE { picture.thumbnail(SIDE, SIDE) } else { picture };
    let pixels = picture.into_rgba8();
    let size = [pixels.width() as usize, pixels.height() as usize];
    Some(ColorImage::from_rgba_unmultiplied(size, pixels.as_raw()))
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use image::{DynamicImage, ImageFormat, Rgba, RgbaImage};
    use proptest::prelude::*;

    /// A tile of one colour.
    pub(crate) fn tile(side: u32, colour: [u8; 4], format: ImageFormat) -> Vec<u8> {
        let picture = RgbaImage::from_pixel(side, side, Rgba(colour));
        let picture = match format {
            ImageFormat::Jpeg => DynamicImage::ImageRgba8(picture).into_rgb8().into(),
            _ => DynamicImage::ImageRgba8(picture),
        };
        let mut bytes = Cursor::new(Vec::new());
        picture.write_to(&mut bytes, format).unwrap();
        bytes.into_inner()
    }

    #[test]
    fn the_three_formats_are_read_and_large_ones_become_small() {
        for format in [ImageFormat::Png, ImageFormat::Jpeg, ImageFormat::WebP] {
            let picture = decode(&tile(256, [200, 100, 50, 255], format)).unwrap();
            assert_eq!(picture.size, [256, 256]);
            assert!(picture.pixels[1000].r().abs_diff(200) < 4, "{format:?}");
        }
        assert_eq!(decode(&tile(1024, [1, 2, 3, 255], ImageFormat::Png)).unwrap().size, [512, 512]);
    }

    #[test]
    fn a_picture_that_would_fill_the_memory_is_refused_by_its_header() {
        // a kilobyte of PNG that claims 60,000 by 60,000 pixels
        let mut bomb = tile(16, [0; 4], ImageFormat::Png);
        bomb[16..20].copy_from_slice(&60_000u32.to_be_bytes());
        bomb[20..24].copy_from_slice(&60_000u32.to_be_bytes());
        assert!(decode(&bomb).is_none());
        // one colour only: small in the file, large in memory
        assert!(decode(&tile(4000, [9; 4], ImageFormat::Png)).is_none());
        assert!(decode(&vec![0; MAX_BYTES + 1]).is_none());
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn damaged_bytes_never_panic(cut in 0usize..600, at in 0usize..600, value in any::<u8>(), kind in 0usize..3) {
            let format = [ImageFormat::Png, ImageFormat::Jpeg, ImageFormat::WebP][kind];
            let mut bytes = tile(24, [7, 8, 9, 200], format);
            let length = bytes.len();
            bytes[at % length] = value;
            bytes.truncate(length - cut % length);
            let _ = decode(&bytes);
        }
    }
}
