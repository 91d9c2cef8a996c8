//! OpenEXR: linear RGB in single precision, further named images beside it, and text attributes.

use super::image::{Image, ImageError, MAX_DECODED_BYTES};
use exr::block::reader::Reader;
use exr::prelude::{
    AnyChannel, AnyChannels, Compression, Encoding, FlatSamples, Layer, LayerAttributes, ReadChannels, ReadLayers, Text, WritableImage,
};
use exr::{image::Image as ExrImage, meta::attribute::AttributeValue};
use std::io::{Read, Seek, Write};

/// A picture, the images named beside it (AOVs), and what to note in the header, such as `("seed", "1")`.
///
/// `beside` become channels `name.R`, `name.G`, `name.B`; all images have the main one's size.
#[derive(Debug, Clone, Copy)]
pub struct ExrContents<'a> {
    pub image: &'a Image,
    pub beside: &'a [(&'a str, &'a Image)],
    pub attributes: &'a [(&'a str, String)],
}

impl ExrContents<'_> {
    /// Writes 32-bit float channels with lossless compression. Attributes get the prefix `pathspace.`; characters beyond
    /// Latin-1, which the format cannot hold, become '?'.
    pub fn write(&self, to: impl Write + Seek) -> Result<(), ImageError> {
        let mut channels = rgb_channels("", self.image).to_vec();
        channels.extend(self.beside.iter().flat_map(|(name, image)| rgb_channels(&format!("{name}."), image)));
        let mut attributes =
            LayerAttributes { software_name: Some(latin1(concat!("pathspace ", env!("CARGO_PKG_VERSION")))), ..Default::default() };
        for (key, value) in self.attributes {
            attributes.other.insert(latin1(&format!("pathspace.{key}")), AttributeValue::Text(latin1(value)));
        }
        let encoding = Encoding { compression: Compression::ZIP16, ..Encoding::FAST_LOSSLESS };
        let size = (self.image.width as usize, self.image.height as usize);
        let layer = Layer::new(size, attributes, encoding, AnyChannels::sort(channels.into()));
        ExrImage::from_layer(layer).write().to_buffered(to).map_err(|error| ImageError::Encoding { reason: error.to_string() })
    }
}

fn rgb_channels(prefix: &str, image: &Image) -> [AnyChannel<FlatSamples>; 3] {
    std::array::from_fn(|i| {
        let samples = image.pixels.iter().map(|pixel| pixel[i]).collect();
        AnyChannel::new(latin1(&format!("{prefix}{}", ["R", "G", "B"][i])), FlatSamples::F32(samples))
    })
}

fn latin1(text: &str) -> Text {
    Text::new_or_panic(text.chars().map(|c| if (c as u32) < 256 { c } else { '?' }).collect::<String>())
}

/// A file that [`ExrContents::write`] has written.
pub struct ExrFile {
    pub image: Image,
    channels: Vec<(String, Vec<f32>)>,
    attributes: Vec<(String, String)>,
}

impl ExrFile {
    /// # Errors
    /// A reason without the file's name.
    pub fn read(from: impl Read + Seek) -> Result<Self, String> {
        let file = exr::prelude::read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .first_valid_layer()
            .all_attributes()
            .from_buffered(from)
            .map_err(|error| error.to_string())?;
        let image = rgb_image(&file.layer_data).ok_or("it has no channels R, G, B")?;
        let channels = file.layer_data.channel_data.list.iter();
        let text = |(key, value): (&Text, &AttributeValue)| match value {
            AttributeValue::Text(value) => Some((key.to_string(), value.to_string())),
            _ => None,
        };
        Ok(Self {
            image,
            channels: channels.map(|channel| (channel.name.to_string(), channel.sample_data.values_as_f32().collect())).collect(),
            attributes: file.layer_data.attributes.other.iter().filter_map(text).collect(),
        })
    }

    /// One of the images beside the main one.
    pub fn beside(&self, name: &str) -> Option<Image> {
        let channel = |part: &str| self.channels.iter().find(|(n, _)| *n == format!("{name}.{part}")).map(|(_, values)| values);
        let (r, g, b) = (channel("R")?, channel("G")?, channel("B")?);
        let pixels = r.iter().zip(g).zip(b).map(|((&r, &g), &b)| [r, g, b]).collect();
        Some(Image::new(self.image.width, self.image.height, pixels))
    }

    /// What was noted under `key`.
    pub fn attribute(&self, key: &str) -> Option<&str> {
        self.attributes.iter().find(|(k, _)| *k == format!("pathspace.{key}")).map(|(_, value)| value.as_str())
    }
}

/// Reads the first part that has channels R, G and B, or one of brightness alone (Y, or a single channel), of any sample
/// type and in any order. The error is a reason without the file's name.
pub(super) fn read(from: impl Read + Seek) -> Result<Image, String> {
    let chunks = Reader::read_from_buffered(from, false).map_err(|error| error.to_string())?;
    let bytes: u64 = chunks.headers().iter().map(|header| header.layer_size.area() as u64 * header.channels.bytes_per_pixel as u64).sum();
    if bytes > MAX_DECODED_BYTES {
        return Err(format!("its header claims {bytes} bytes of pixels; at most {MAX_DECODED_BYTES} are read"));
    }
    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .all_layers()
        .all_attributes()
        .from_chunks(chunks)
        .map_err(|error| error.to_string())?;
    image.layer_data.iter().find_map(rgb_image).ok_or_else(|| {
        let names = image.layer_data.iter().flat_map(|layer| &layer.channel_data.list).map(|channel| channel.name.to_string());
        format!("it has neither channels R, G, B nor Y, but {}", names.collect::<Vec<_>>().join(", "))
    })
}

fn rgb_image(layer: &Layer<AnyChannels<FlatSamples>>) -> Option<Image> {
    let channels = &layer.channel_data.list;
    let find = |name: &str| channels.iter().find(|channel| channel.name.eq_case_insensitive(name)).map(|channel| &channel.sample_data);
    let brightness = || find("Y").or(if let [only] = channels.as_slice() { Some(&only.sample_data) } else { None });
    let [r, g, b] = match (find("R"), find("G"), find("B")) {
        (Some(r), Some(g), Some(b)) => [r, g, b],
        _ => [brightness()?; 3],
    };
    let rows = r.values_as_f32().zip(g.values_as_f32()).zip(b.values_as_f32());
    let pixels: Vec<[f32; 3]> = rows.map(|((r, g), b)| [r, g, b]).collect();
    // Subsampled channels have fewer values than pixels.
    (pixels.len() == layer.size.area()).then(|| Image::new(layer.size.width() as u32, layer.size.height() as u32, pixels))
}

#[cfg(test)]
mod tests {
    use super::*;
    use half::f16;
    use rand::{Rng, SeedableRng};
    use std::io::Cursor;

    fn ramp() -> Image {
        Image::new(5, 3, (0..15u16).map(|i| [f32::from(i) * 0.1, f32::from(i) * 1e-7, f32::from(i) * -1e6]).collect())
    }

    fn written() -> Vec<u8> {
        let normal = Image::new(5, 3, vec![[0.0, 1.0, 0.0]; 15]);
        let mut bytes = Cursor::new(Vec::new());
        ExrContents { image: &ramp(), beside: &[("normal", &normal)], attributes: &[("command", "render ✓".to_owned())] }
            .write(&mut bytes)
            .unwrap();
        bytes.into_inner()
    }

    #[test]
    fn exr_keeps_every_bit_and_the_attributes() {
        let bytes = written();
        assert_eq!(read(Cursor::new(&bytes)).unwrap(), ramp());
        let chunks = Reader::read_from_buffered(Cursor::new(&bytes), true).unwrap();
        let header = &chunks.headers()[0];
        assert_eq!(header.channels.list.len(), 6);
        assert_eq!(header.own_attributes.other[&latin1("pathspace.command")], AttributeValue::Text(latin1("render ?")));
    }

    fn read_back<const N: usize>(size: (usize, usize), channels: [(&str, FlatSamples); N]) -> Image {
        let list: Vec<_> = channels.map(|(name, samples)| AnyChannel::new(latin1(name), samples)).to_vec();
        let mut bytes = Cursor::new(Vec::new());
        ExrImage::from_channels(size, AnyChannels::sort(list.into())).write().to_buffered(&mut bytes).unwrap();
        bytes.set_position(0);
        read(bytes).unwrap()
    }

    #[test]
    fn exr_of_half_floats_in_any_channel_order_is_read() {
        let half = |value: f32| FlatSamples::F16(vec![f16::from_f32(value); 4]);
        let channels = [("A", half(1.0)), ("b", half(3.0)), ("R", FlatSamples::F32(vec![1.0; 4])), ("G", FlatSamples::U32(vec![2; 4]))];
        assert_eq!(read_back((2, 2), channels).pixels, [[1.0, 2.0, 3.0]; 4]);
    }

    #[test]
    fn exr_of_one_channel_is_grey() {
        assert_eq!(read_back((4, 1), [("depth", FlatSamples::F32(vec![7.0; 4]))]), Image::new(4, 1, vec![[7.0; 3]; 4]));
    }

    #[test]
    fn damaged_exr_files_are_errors_or_pictures_but_never_panics() {
        let whole = written();
        let mut rng = rand_pcg::Pcg32::seed_from_u64(1);
        for _ in 0..2000 {
            let mut bytes = whole.clone();
            for _ in 0..rng.random_range(1..4) {
                let at = rng.random_range(0..bytes.len());
                bytes[at] = rng.random();
            }
            bytes.truncate(rng.random_range(bytes.len() / 2..=bytes.len()));
            read(Cursor::new(bytes)).ok();
        }
    }
}
