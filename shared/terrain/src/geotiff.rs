//! GeoTIFF elevations (OGC 19-008r4): one sample a pixel, north up, in degrees, UTM, another transverse Mercator or
//! Web Mercator. What the header claims is checked before anything of its size is allocated.
// the bytes come from outside
#![warn(clippy::indexing_slicing)]

use crate::grid::Grid;
use crate::projection::{Projection, Transverse};
use crate::raster::Raster;
use std::io::{Read, Seek};
use tiff::decoder::{ChunkType, Decoder, DecodingResult, Limits};
use tiff::tags::Tag;
use tiff::{ColorType, TiffError};

/// Most samples that are taken: 160 MB.
const MAX_SAMPLES: u64 = 40_000_000;
/// Most bytes that one strip or tile may become.
const MAX_CHUNK: usize = 256 << 20;
/// Elevations on Earth's land, metres; what is outside counts as void.
const PLAUSIBLE_M: std::ops::RangeInclusive<f64> = -500.0..=9000.0;

/// Why a file is no elevations that can be used.
#[derive(Debug, thiserror::Error)]
pub enum RasterError {
    /// It is no TIFF, it is cut off, or it is compressed in an unknown way.
    #[error(
        "it can't be read as a GeoTIFF ({0}): get it again, or convert it with gdal_translate -co COMPRESS=DEFLATE"
    )]
    Unreadable(String),
    /// It has too many samples.
    #[error(
        "it has {0} × {1} samples, more than the 40 million that are taken: cut out the area of the flight (gdal_translate -projwin), or make it coarser (-outsize)"
    )]
    TooLarge(u32, u32),
    /// It has colours.
    #[error(
        "it is a picture and no elevations: its pixels are {0}. Make map tiles of it (gdal_translate -of MBTiles)"
    )]
    Picture(String),
    /// Its projection is none of those that are understood.
    #[error("its projection is {0}, which is not understood: convert it with gdalwarp -t_srs EPSG:4326")]
    Projection(String),
    /// It doesn't say where it is, or it lies askew.
    #[error("it doesn't say where it is{0}: convert it with gdalwarp -t_srs EPSG:4326")]
    Nowhere(&'static str),
    /// Nothing but voids.
    #[error("it holds no elevation at all: get it again")]
    Empty,
}

impl From<TiffError> for RasterError {
    fn from(error: TiffError) -> Self {
        Self::Unreadable(error.to_string())
    }
}

impl Raster {
    /// Reads a GeoTIFF.
    ///
    /// # Errors
    /// It is no GeoTIFF of elevations, too large, or in a projection that is not understood.
    pub fn from_geotiff(bytes: impl Read + Seek) -> Result<Self, RasterError> {
        let mut limits = Limits::default();
        limits.decoding_buffer_size = MAX_CHUNK;
        let mut tiff = Decoder::new(bytes)?.with_limits(limits);
        let (width, height) = tiff.dimensions()?;
        if u64::from(width) * u64::from(height) > MAX_SAMPLES {
            return Err(RasterError::TooLarge(width, height));
        }
        match tiff.colortype()? {
            ColorType::Gray(_) => {}
            other => return Err(RasterError::Picture(format!("{other:?}"))),
        }
        let keys = Keys::read(&mut tiff)?;
        let (origin, step) = place(&mut tiff, keys.value(RASTER_TYPE) == Some(POINTS))?;
        let projection = keys.projection()?;
        let scale = keys.metres_per_vertical_unit();
        let grid = Grid::new(width as usize, samples(&mut tiff, (width, height), scale)?);
        if !grid.knows_something() {
            return Err(RasterError::Empty);
        }
        Ok(Self { grid, projection, origin, step })
    }
}

/// All samples, metres, row by row.
fn samples<R: Read + Seek>(
    tiff: &mut Decoder<R>,
    (width, height): (u32, u32),
    metres: f64,
) -> Result<Vec<f32>, RasterError> {
    let void = tiff.find_tag(Tag::GdalNodata)?.and_then(|v| v.into_string().ok());
    let void = void.and_then(|text| text.trim().parse::<f64>().ok());
    let metres_of = |value: f64| {
        let known = void.is_none_or(|void| value != void) && PLAUSIBLE_M.contains(&(value * metres));
        #[expect(clippy::cast_possible_truncation, reason = "an elevation to a millimetre")]
        if known { (value * metres) as f32 } else { f32::NEG_INFINITY }
    };
    let chunks = match tiff.get_chunk_type() {
        ChunkType::Strip => tiff.strip_count()?,
        ChunkType::Tile => tiff.tile_count()?,
    };
    let (across, down) = tiff.chunk_dimensions();
    if across == 0 || down == 0 {
        return Err(RasterError::Unreadable("its tiles are empty".into()));
    }
    // what is allocated for a chunk before its data are looked at
    let tall = if tiff.get_chunk_type() == ChunkType::Strip { down.min(height) } else { down };
    if u64::from(across) * u64::from(tall) * 8 > MAX_CHUNK as u64 {
        return Err(RasterError::Unreadable(format!("its parts of {across} by {down} are too large")));
    }
    let number = width.div_ceil(across);
    let mut all = vec![f32::NEG_INFINITY; width as usize * height as usize];
    for chunk in 0..chunks.min(number * height.div_ceil(down)) {
        let (columns, _) = tiff.chunk_data_dimensions(chunk);
        let (left, top) = (chunk % number * across, chunk / number * down);
        let values: Vec<f32> = numbers(tiff.read_chunk(chunk)?)?.into_iter().map(metres_of).collect();
        for (row, values) in values.chunks(columns.max(1) as usize).enumerate() {
            let start = (top as usize + row) * width as usize + left as usize;
            let targets = all.iter_mut().skip(start).take((width - left) as usize);
            targets.zip(values).for_each(|(target, value)| *target = *value);
        }
    }
    Ok(all)
}

/// Samples of any kind as numbers.
fn numbers(samples: DecodingResult) -> Result<Vec<f64>, RasterError> {
    Ok(match samples {
        DecodingResult::U8(v) => v.into_iter().map(f64::from).collect(),
        DecodingResult::U16(v) => v.into_iter().map(f64::from).collect(),
        DecodingResult::U32(v) => v.into_iter().map(f64::from).collect(),
        DecodingResult::I8(v) => v.into_iter().map(f64::from).collect(),
        DecodingResult::I16(v) => v.into_iter().map(f64::from).collect(),
        DecodingResult::I32(v) => v.into_iter().map(f64::from).collect(),
        DecodingResult::F32(v) => v.into_iter().map(f64::from).collect(),
        DecodingResult::F64(v) => v,
        _ => return Err(RasterError::Unreadable("its samples are of an unusual kind".into())),
    })
}

/// East and north, or to the east and to the south.
type Pair = (f64, f64);

/// Where the middle of the first sample is, and the steps to its neighbours.
fn place<R: Read + Seek>(tiff: &mut Decoder<R>, points: bool) -> Result<(Pair, Pair), RasterError> {
    let mut doubles = |tag| -> Result<Vec<f64>, RasterError> {
        Ok(tiff.find_tag(tag)?.map(tiff::decoder::ifd::Value::into_f64_vec).transpose()?.unwrap_or_default())
    };
    let scale = doubles(Tag::ModelPixelScaleTag)?;
    let tie = doubles(Tag::ModelTiepointTag)?;
    let matrix = doubles(Tag::ModelTransformationTag)?;
    let (corner, step) = match (scale.as_slice(), tie.as_slice(), matrix.as_slice()) {
        ([x, y, ..], [i, j, _, east, north, _], _) => ((east - i * x, north + j * y), (*x, *y)),
        (_, _, [x, skew_x, _, east, skew_y, y, _, north, ..]) if *skew_x == 0.0 && *skew_y == 0.0 => {
            ((*east, *north), (*x, -*y))
        }
        (_, _, [_, _, ..]) => return Err(RasterError::Nowhere(" with north up")),
        _ => return Err(RasterError::Nowhere("")),
    };
    let numbers = [corner.0, corner.1, step.0, step.1];
    if numbers.iter().any(|n| !n.is_finite()) || step.0 <= 0.0 || step.1 <= 0.0 {
        return Err(RasterError::Nowhere(" with north up"));
    }
    // a sample that stands for its area is in the middle of it
    let half = if points { 0.0 } else { 0.5 };
    Ok(((corner.0 + half * step.0, corner.1 - half * step.1), step))
}

// keys of the standard, and values of theirs
const MODEL_TYPE: u16 = 1024;
const RASTER_TYPE: u16 = 1025;
const POINTS: u16 = 2;
const CITATION: u16 = 1026;
const GEOGRAPHIC: u16 = 2048;
const PROJECTED: u16 = 3072;
const METHOD: u16 = 3075;
const TRANSVERSE_MERCATOR: u16 = 1;
const LENGTH_UNIT: u16 = 3076;
const VERTICAL_UNIT: u16 = 4099;
const METRE: u16 = 9001;
const USER_DEFINED: u16 = 32767;

/// The file's geo keys.
struct Keys {
    /// Key, the tag that its value is in (0: the value itself), value or index.
    entries: Vec<(u16, u16, u16)>,
    doubles: Vec<f64>,
}

impl Keys {
    fn read<R: Read + Seek>(tiff: &mut Decoder<R>) -> Result<Self, RasterError> {
        let directory = tiff.find_tag(Tag::GeoKeyDirectoryTag)?.ok_or(RasterError::Nowhere(""))?;
        let directory = directory.into_u16_vec()?;
        let entries = directory.as_chunks::<4>().0.iter().skip(1).map(|[key, tag, _, v]| (*key, *tag, *v));
        let doubles = tiff.find_tag(Tag::GeoDoubleParamsTag)?;
        let doubles = doubles.map(tiff::decoder::ifd::Value::into_f64_vec).transpose()?.unwrap_or_default();
        Ok(Self { entries: entries.collect(), doubles })
    }

    fn find(&self, key: u16) -> Option<(u16, u16)> {
        self.entries.iter().find(|(k, _, _)| *k == key).map(|(_, tag, value)| (*tag, *value))
    }

    fn value(&self, key: u16) -> Option<u16> {
        self.find(key).filter(|(tag, _)| *tag == 0).map(|(_, value)| value)
    }

    fn double(&self, key: u16) -> Option<f64> {
        let (tag, index) = self.find(key)?;
        (tag == Tag::GeoDoubleParamsTag.to_u16()).then(|| self.doubles.get(usize::from(index)).copied())?
    }

    fn projection(&self) -> Result<Projection, RasterError> {
        let code = match self.value(MODEL_TYPE) {
            Some(1) => self.value(PROJECTED),
            Some(2) => self.value(GEOGRAPHIC),
            _ => return Err(RasterError::Nowhere("")),
        };
        let unknown = |text: String| Err(RasterError::Projection(text));
        match code {
            Some(code) if code != USER_DEFINED => {
                Projection::of_epsg(code).map_or_else(|| unknown(format!("EPSG:{code}")), Ok)
            }
            _ => match self.value(METHOD) {
                Some(TRANSVERSE_MERCATOR) => self.transverse(),
                Some(method) => unknown(format!("number {method} of GeoTIFF's methods")),
                None if self.find(CITATION).is_some() => unknown("one with a name and no number".into()),
                None => unknown("not given".into()),
            },
        }
    }

    /// A transverse Mercator by its numbers, in metres on WGS84 or what is as good as that.
    fn transverse(&self) -> Result<Projection, RasterError> {
        let unknown = |text: &str| Err(RasterError::Projection(text.into()));
        if self.value(LENGTH_UNIT).is_some_and(|unit| unit != METRE) {
            return unknown("a transverse Mercator in another unit than metres");
        }
        if self.value(GEOGRAPHIC).and_then(Projection::of_epsg) != Some(Projection::Geographic) {
            return unknown("a transverse Mercator on another ellipsoid than WGS84");
        }
        let number = |key, default: f64| self.double(key).unwrap_or(default);
        let transverse = Transverse {
            meridian_deg: number(3080, 0.0),
            latitude_deg: number(3081, 0.0),
            scale: number(3092, 1.0),
            false_east_m: number(3082, 0.0),
            false_north_m: number(3083, 0.0),
        };
        if !transverse.is_plausible() {
            return unknown("a transverse Mercator of impossible numbers");
        }
        Ok(Projection::Transverse(transverse))
    }

    /// Metres unless it says feet: international or of the US survey.
    fn metres_per_vertical_unit(&self) -> f64 {
        match self.value(VERTICAL_UNIT) {
            Some(9002) => 0.3048,
            Some(9003) => 1200.0 / 3937.0,
            _ => 1.0,
        }
    }
}
