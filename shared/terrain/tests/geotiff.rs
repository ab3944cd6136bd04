//! GeoTIFFs as tools write them, and as nobody should.
#![cfg(test)]

use geometry::LatLon;
use proptest::prelude::*;
use std::io::Cursor;
use terrain::{Raster, RasterError, Terrain};
use tiff::encoder::{TiffEncoder, colortype};
use tiff::tags::Tag;

/// What a file says of itself.
struct Header {
    keys: Vec<u16>,
    doubles: Vec<f64>,
    scale: (f64, f64),
    corner: (f64, f64),
    void: Option<&'static str>,
}

/// Degrees, areas, from 10° E 50° N, a hundredth of a degree a pixel.
fn geographic() -> Header {
    Header {
        keys: vec![1024, 0, 1, 2, 1025, 0, 1, 1, 2048, 0, 1, 4326],
        doubles: vec![],
        scale: (0.01, 0.01),
        corner: (10.0, 50.0),
        void: None,
    }
}

/// Metres in a projection of EPSG, points, 30 m apart.
fn projected(code: u16, corner: (f64, f64)) -> Header {
    Header {
        keys: vec![1024, 0, 1, 1, 1025, 0, 1, 2, 3072, 0, 1, code],
        doubles: vec![],
        scale: (30.0, 30.0),
        corner,
        void: None,
    }
}

/// The bytes of a file whose samples are `f(column, row)`.
fn file(header: &Header, (width, height): (u32, u32), f: impl Fn(u32, u32) -> f32) -> Vec<u8> {
    let samples: Vec<f32> = (0..width * height).map(|i| f(i % width, i / width)).collect();
    let mut bytes = Cursor::new(Vec::new());
    let mut encoder = TiffEncoder::new(&mut bytes).unwrap();
    let mut image = encoder.new_image::<colortype::Gray32Float>(width, height).unwrap();
    image.rows_per_strip(7).unwrap();
    let tags = image.encoder();
    let mut directory = vec![1, 1, 0, (header.keys.len() / 4) as u16];
    directory.extend(&header.keys);
    tags.write_tag(Tag::GeoKeyDirectoryTag, &directory[..]).unwrap();
    if !header.doubles.is_empty() {
        tags.write_tag(Tag::GeoDoubleParamsTag, &header.doubles[..]).unwrap();
    }
    tags.write_tag(Tag::ModelPixelScaleTag, &[header.scale.0, header.scale.1, 0.0][..]).unwrap();
    let tie = [0.0, 0.0, 0.0, header.corner.0, header.corner.1, 0.0];
    tags.write_tag(Tag::ModelTiepointTag, &tie[..]).unwrap();
    if let Some(void) = header.void {
        tags.write_tag(Tag::GdalNodata, void).unwrap();
    }
    image.write_data(&samples).unwrap();
    bytes.into_inner()
}

fn read(bytes: &[u8]) -> Result<Raster, RasterError> {
    Raster::from_geotiff(Cursor::new(bytes))
}

#[test]
fn degrees_lie_in_the_middle_of_their_areas() {
    let bytes = file(&geographic(), (40, 30), |column, row| (column * 3 + row * 2) as f32);
    let raster = read(&bytes).unwrap();
    assert_eq!(raster.size(), (40, 30));
    let at = |lat, lon| raster.elevation_m(LatLon::new(lat, lon));
    assert!(at(49.995, 10.005).unwrap().abs() < 1e-3);
    assert!((at(49.895, 10.105).unwrap() - 50.0).abs() < 1e-3);
    assert!((at(49.89, 10.11).unwrap() - 52.5).abs() < 1e-3, "between four samples");
    assert_eq!(at(50.5, 10.1), None);
    let (south_west, north_east) = raster.known_box().unwrap();
    assert!(south_west.distance_m(LatLon::new(49.705, 10.005)) < 1.0);
    assert!(north_east.distance_m(LatLon::new(49.995, 10.395)) < 1.0);
}

#[test]
fn utm_and_a_transverse_mercator_by_its_numbers_agree() {
    let utm = projected(32632, (500_000.0, 5_300_000.0));
    let by_numbers = Header {
        keys: vec![
            1024, 0, 1, 1, 1025, 0, 1, 2, 2048, 0, 1, 4258, 3072, 0, 1, 32767, 3075, 0, 1, 1, 3076, 0, 1,
            9001, 3080, 34736, 1, 0, 3081, 34736, 1, 1, 3082, 34736, 1, 2, 3083, 34736, 1, 3, 3092, 34736, 1,
            4,
        ],
        doubles: vec![9.0, 0.0, 500_000.0, 0.0, 0.9996],
        ..projected(0, utm.corner)
    };
    let ground = |column: u32, row: u32| 400.0 + column as f32 + 2.0 * row as f32;
    let (a, b) = (file(&utm, (60, 60), ground), file(&by_numbers, (60, 60), ground));
    let (a, b) = (read(&a).unwrap(), read(&b).unwrap());
    // on the central meridian, 30 rows down
    let p = LatLon::new(0.0, 9.0).destination(0.0, (5_300_000.0 - 900.0) / 0.9996);
    assert!((a.elevation_m(p).unwrap() - 460.0).abs() < 0.1, "{:?}", a.elevation_m(p));
    let p = p.destination(60.0, 700.0);
    assert!((a.elevation_m(p).unwrap() - b.elevation_m(p).unwrap()).abs() < 1e-6);
    assert_eq!(a.elevation_m(LatLon::new(47.0, -171.0)), None, "the far side of the Earth");
}

#[test]
fn nothing_in_a_box_is_above_what_is_said_of_it() {
    let hills = |column: u32, row: u32| ((column * 7919 + row * 104_729) % 2000) as f32;
    for header in [projected(32632, (650_000.0, 6_700_000.0)), geographic()] {
        let bytes = file(&header, (200, 200), hills);
        let raster = read(&bytes).unwrap();
        let (from, to) = raster.known_box().unwrap();
        for (south, west, size) in [(0.1, 0.2, 0.1), (0.5, 0.5, 0.02), (0.9, 0.9, 0.3), (-0.5, -0.5, 2.0)] {
            let place = |u: f64, v: f64| {
                LatLon::new(
                    from.lat_deg + (to.lat_deg - from.lat_deg) * (south + size * u),
                    from.lon_deg + (to.lon_deg - from.lon_deg) * (west + size * v),
                )
            };
            let most_m = raster.at_most_m(place(0.0, 0.0), place(1.0, 1.0)).unwrap();
            for i in 0..=900 {
                let p = place(f64::from(i % 31) / 30.0, f64::from(i / 31) / 30.0);
                assert!(raster.elevation_m(p).is_none_or(|m| m <= most_m), "{p:?} {most_m}");
            }
        }
        let far = raster.at_most_m(LatLon::new(-10.0, -10.0), LatLon::new(-9.9, -9.9));
        assert_eq!(far, Some(f64::NEG_INFINITY));
    }
}

#[test]
fn voids_and_feet_are_understood() {
    let mut header = geographic();
    header.void = Some("-32767");
    header.keys.extend([4099, 0, 1, 9002]);
    let bytes = file(&header, (20, 20), |column, _| if column < 10 { -32767.0 } else { 1000.0 });
    let raster = read(&bytes).unwrap();
    assert_eq!(raster.elevation_m(LatLon::new(49.9, 10.05)), None);
    assert!((raster.elevation_m(LatLon::new(49.9, 10.15)).unwrap() - 304.8).abs() < 0.01);
    let nothing = file(&header, (20, 20), |_, _| -32767.0);
    assert!(matches!(read(&nothing), Err(RasterError::Empty)));
}

#[test]
fn what_is_not_understood_says_what_to_do() {
    let lambert = file(&projected(2154, (700_000.0, 6_600_000.0)), (10, 10), |_, _| 1.0);
    let text = read(&lambert).unwrap_err().to_string();
    assert!(text.contains("EPSG:2154") && text.contains("gdalwarp"), "{text}");
    let mut plain = Cursor::new(Vec::new());
    let mut encoder = TiffEncoder::new(&mut plain).unwrap();
    encoder.write_image::<colortype::Gray16>(4, 4, &[7; 16]).unwrap();
    assert!(matches!(read(plain.get_ref()), Err(RasterError::Nowhere(_))));
    let mut picture = Cursor::new(Vec::new());
    let mut encoder = TiffEncoder::new(&mut picture).unwrap();
    encoder.write_image::<colortype::RGB8>(4, 4, &[7; 48]).unwrap();
    assert!(matches!(read(picture.get_ref()), Err(RasterError::Picture(_))));
    assert!(matches!(read(b"II*\0"), Err(RasterError::Unreadable(_))));
    assert!(matches!(read(b"no TIFF at all"), Err(RasterError::Unreadable(_))));
}

/// The same file with another value of a tag of its first directory.
fn with_tag(mut bytes: Vec<u8>, tag: Tag, value: u32) -> Vec<u8> {
    let number = |bytes: &[u8], at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
    let directory = number(&bytes, 4) as usize;
    let entries = u16::from_le_bytes([bytes[directory], bytes[directory + 1]]) as usize;
    for i in 0..entries {
        let at = directory + 2 + i * 12;
        if u16::from_le_bytes([bytes[at], bytes[at + 1]]) == tag.to_u16() {
            // a long, whatever it was
            bytes[at + 2..at + 4].copy_from_slice(&4u16.to_le_bytes());
            bytes[at + 8..at + 12].copy_from_slice(&value.to_le_bytes());
        }
    }
    bytes
}

#[test]
fn a_header_that_claims_gigapixels_is_refused_before_anything_is_allocated() {
    let small = file(&geographic(), (16, 16), |_, _| 5.0);
    let wide = with_tag(small.clone(), Tag::ImageWidth, 4_000_000_000);
    let bomb = with_tag(wide, Tag::ImageLength, 4_000_000_000);
    assert!(
        matches!(read(&bomb), Err(RasterError::Unreadable(_))),
        "more strips than are listed: {:?}",
        read(&bomb)
    );
    // as many strips as are listed: one
    let one_strip = [Tag::ImageWidth, Tag::ImageLength, Tag::RowsPerStrip]
        .into_iter()
        .fold(file(&geographic(), (7, 7), |_, _| 5.0), |file, tag| with_tag(file, tag, 4_000_000_000));
    let refused = read(&one_strip);
    assert!(matches!(refused, Err(RasterError::TooLarge(4_000_000_000, 4_000_000_000))), "{refused:?}");
    let tall = with_tag(small, Tag::ImageLength, 2_000_000);
    assert!(read(&tall).is_err(), "the strips are not there");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]
    #[test]
    fn damaged_bytes_never_panic(cut in 0usize..6000, changes in prop::collection::vec((0usize..6000, any::<u8>()), 0..8)) {
        let mut bytes = file(&geographic(), (30, 30), |column, row| (column * row) as f32);
        for (at, value) in changes {
            let at = at % bytes.len();
            bytes[at] = value;
        }
        bytes.truncate(bytes.len().saturating_sub(cut % 700));
        if let Ok(raster) = read(&bytes) {
            let (columns, rows) = raster.size();
            prop_assert!(columns as u64 * rows as u64 <= 40_000_000);
            let _ = raster.elevation_m(LatLon::new(49.9, 10.1));
        }
    }
}
