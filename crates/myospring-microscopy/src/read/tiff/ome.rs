//! OME-XML: the description of an OME-TIFF (Open Microscopy Environment, schema 2016-06).
//!
//! Only the first image is read. Entities defined in the document are not expanded.

use std::borrow::Cow;

use quick_xml::events::{BytesStart, Event};
use quick_xml::{Reader, XmlVersion};

use super::planes::{Axis, CHANNEL_FIRST, MOST_PLANES, Planes, Run};
use crate::picture::PixelSizeSource;
use crate::read::PictureError;
use crate::read::error::damaged_tiff;
use crate::read::pixel_size::{Stated, unit_um};

/// Longest accepted description, bytes.
const MOST_XML: usize = 64 << 20;

/// The needed content of the document.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Ome {
    /// The file's own identifier.
    uuid: Option<String>,
    /// Number of images described; the first is read.
    pub(super) images: usize,
    /// Numbers of channels, slices and frames; colour samples count as channels.
    sizes: [u64; 3],
    order: String,
    /// Sides of a pixel and distance of slices, each with its unit.
    sides: [Option<f64>; 3],
    units: [Option<String>; 3],
    /// Time between two frames as set, s.
    increment_s: Option<f64>,
    /// Number and time of the first and of the last frame that has a time, s.
    times: [Option<(u64, f64)>; 2],
    data: Vec<Data>,
}

/// One `TiffData` element.
#[derive(Debug, Clone, PartialEq, Default)]
struct Data {
    page: Option<u64>,
    first: [u64; 3],
    count: Option<u64>,
    file: Option<String>,
    uuid: Option<String>,
}

/// Whether a description is OME-XML with the pixels described in this file.
pub(super) fn is_ome(description: &str) -> bool {
    description.trim_start().starts_with('<')
        && description.contains("<OME")
        && description.contains("Pixels")
}

impl Ome {
    /// Reads the document.
    pub(super) fn read(xml: &str) -> Result<Self, PictureError> {
        let unclear = |error: String| damaged_tiff(format!("its OME-XML is damaged ({error})"));
        if xml.len() > MOST_XML {
            return Err(unclear(format!("{} bytes, at most {MOST_XML} are read", xml.len())));
        }
        let mut reader = Reader::from_str(xml);
        reader.config_mut().check_end_names = false;
        let mut ome = Self::default();
        let mut in_uuid = false;
        loop {
            match reader.read_event().map_err(|error| unclear(error.to_string()))? {
                Event::Eof => break,
                Event::Start(element) | Event::Empty(element) => {
                    in_uuid = element.local_name().as_ref() == "UUID";
                    ome.element(&element).map_err(unclear)?;
                }
                Event::Text(text) if in_uuid => {
                    if let Some(data) = ome.data.last_mut() {
                        data.uuid = Some(text.trim().to_owned());
                    }
                }
                Event::End(_) => in_uuid = false,
                _ => {}
            }
        }
        Ok(ome)
    }

    fn element(&mut self, element: &BytesStart) -> Result<(), String> {
        let name = element.local_name();
        let is_first = self.images == 1;
        match name.as_ref() {
            "OME" => self.uuid = attribute(element, "UUID")?.map(Cow::into_owned),
            "Image" => self.images += 1,
            "Pixels" if is_first => self.pixels(element)?,
            "TiffData" if is_first => {
                let first = ["FirstC", "FirstZ", "FirstT"];
                let mut data = Data {
                    page: number(element, "IFD")?,
                    count: number(element, "PlaneCount")?,
                    ..Data::default()
                };
                for (first, name) in data.first.iter_mut().zip(first) {
                    *first = number(element, name)?.unwrap_or(0);
                }
                self.data.push(data);
            }
            "Plane" if is_first => self.plane(element)?,
            "UUID" if is_first => {
                let file = attribute(element, "FileName")?.map(Cow::into_owned);
                if let Some(data) = self.data.last_mut() {
                    data.file = file;
                }
            }
            _ => {}
        }
        Ok(())
    }

    fn pixels(&mut self, element: &BytesStart) -> Result<(), String> {
        for (size, name) in self.sizes.iter_mut().zip(["SizeC", "SizeZ", "SizeT"]) {
            *size = number(element, name)?.unwrap_or(1);
            if !(1..=MOST_PLANES).contains(size) {
                return Err(format!("{name} is {size}, outside 1 to {MOST_PLANES}"));
            }
        }
        self.order = attribute(element, "DimensionOrder")?.unwrap_or_default().into_owned();
        let names = [
            ("PhysicalSizeX", "PhysicalSizeXUnit"),
            ("PhysicalSizeY", "PhysicalSizeYUnit"),
            ("PhysicalSizeZ", "PhysicalSizeZUnit"),
        ];
        for (axis, (name, unit)) in names.into_iter().enumerate() {
            self.sides[axis] = attribute(element, name)?.and_then(|text| text.trim().parse().ok());
            self.units[axis] = attribute(element, unit)?.map(Cow::into_owned);
        }
        self.increment_s = seconds(element, "TimeIncrement", "TimeIncrementUnit")?;
        Ok(())
    }

    /// Records the time at which a plane was taken.
    fn plane(&mut self, element: &BytesStart) -> Result<(), String> {
        let time = seconds(element, "DeltaT", "DeltaTUnit")?;
        let other = |name| Ok::<_, String>(number(element, name)?.unwrap_or(0) > 0);
        if let (Some(time), false, false) = (time, other("TheC")?, other("TheZ")?) {
            let taken = (number(element, "TheT")?.unwrap_or(0), time);
            let [first, last] = &mut self.times;
            *first = first.filter(|first| first.0 <= taken.0).or(Some(taken));
            *last = last.filter(|last| last.0 >= taken.0).or(Some(taken));
        }
        Ok(())
    }

    /// Time between two frames, s: as set, else the mean of the recorded intervals.
    pub(super) fn frame_interval_s(&self) -> Option<f64> {
        let taken = || {
            let [Some((first, start)), Some((last, end))] = self.times else { return None };
            (last > first).then(|| (end - start) / (last - first) as f64)
        };
        self.increment_s.filter(|interval| *interval > 0.0).or_else(taken)
    }

    /// Which plane each page contains, if each page has `samples` channels.
    pub(super) fn planes(&self, pages: u64, samples: u64) -> Option<Planes> {
        let mut sizes = self.sizes;
        if sizes[0].is_multiple_of(samples) {
            sizes[0] /= samples;
        }
        let mut planes = Planes::new(sizes, self.order())?;
        if self.data.is_empty() {
            planes.add([0; 3], Run { page: 0, count: pages, elsewhere: None });
        }
        let own_file = self.data.iter().find_map(|data| data.file.as_deref());
        for data in &self.data {
            let mut first = data.first;
            if first[0] >= sizes[0] {
                first[0] /= samples;
            }
            if (0..3).any(|axis| first[axis] >= sizes[axis]) {
                continue;
            }
            let is_other = match (&self.uuid, &data.uuid) {
                (Some(own), Some(named)) => own != named,
                _ => data.file.as_deref() != own_file,
            };
            let elsewhere =
                is_other.then(|| data.file.clone().unwrap_or_else(|| "unnamed".to_owned()));
            // An element without a page number refers to all pages, one with a number to that page
            // alone.
            let count = data.count.unwrap_or(if data.page.is_some() { 1 } else { pages });
            planes.add(first, Run { page: data.page.unwrap_or(0), count, elsewhere });
        }
        Some(planes)
    }

    fn order(&self) -> [Axis; 3] {
        match self.order.as_str() {
            "XYCTZ" => [Axis::Channel, Axis::Frame, Axis::Slice],
            "XYZCT" => [Axis::Slice, Axis::Channel, Axis::Frame],
            "XYZTC" => [Axis::Slice, Axis::Frame, Axis::Channel],
            "XYTCZ" => [Axis::Frame, Axis::Channel, Axis::Slice],
            "XYTZC" => [Axis::Frame, Axis::Slice, Axis::Channel],
            _ => CHANNEL_FIRST,
        }
    }

    /// Size of a pixel; micrometres if no unit is stated.
    pub(super) fn pixel_size(&self) -> Option<Stated> {
        let x_um = self.side_um(0)?;
        let y_um = self.side_um(1).unwrap_or(x_um);
        Some(Stated { x_um, y_um, source: PixelSizeSource::OmeXml })
    }

    /// Distance of two slices, um; micrometres if no unit is stated.
    pub(super) fn z_step_um(&self) -> Option<f64> {
        self.side_um(2)
    }

    fn side_um(&self, axis: usize) -> Option<f64> {
        let um = unit_um(self.units[axis].as_deref().unwrap_or("um"))?;
        self.sides[axis].map(|side| side * um).filter(|side| side.is_finite())
    }
}

fn attribute<'a>(element: &'a BytesStart, name: &str) -> Result<Option<Cow<'a, str>>, String> {
    let found = element.try_get_attribute(name).map_err(|error| error.to_string())?;
    found
        .map(|value| value.normalized_value(XmlVersion::Implicit1_0))
        .transpose()
        .map_err(|error| format!("{name}: {error}"))
}

/// A time, s; seconds are also the default unit.
fn seconds(element: &BytesStart, name: &str, unit: &str) -> Result<Option<f64>, String> {
    let time = attribute(element, name)?.and_then(|text| text.trim().parse::<f64>().ok());
    let unit = attribute(element, unit)?;
    let scale = match unit.as_deref() {
        None | Some("s") => 1.0,
        Some("ms") => 1e-3,
        Some("\u{b5}s" | "\u{3bc}s" | "us") => 1e-6,
        Some("min") => 60.0,
        Some(_) => return Ok(None),
    };
    Ok(time.map(|time| time * scale))
}

fn number(element: &BytesStart, name: &str) -> Result<Option<u64>, String> {
    let text = attribute(element, name)?;
    text.map(|text| text.trim().parse().map_err(|_| format!("{name} is `{text}`, not a number")))
        .transpose()
}
