//! What a drawn figure holds, as others' readers of XML and PNG see it.

use std::io::Cursor;

use myospring::output::figure::Figure;
use png::{ColorType, Decoder};
use roxmltree::Document;

/// Width and height in px at 96 px per inch; fails unless the figure is a whole SVG.
pub(crate) fn size(figure: &Figure) -> [f64; 2] {
    let svg = figure.to_svg();
    let document = Document::parse(&svg).unwrap();
    let root = document.root_element();
    assert!(root.has_tag_name(("http://www.w3.org/2000/svg", "svg")));
    ["width", "height"].map(|key| {
        let mm: f64 = root.attribute(key).unwrap().strip_suffix("mm").unwrap().parse().unwrap();
        mm * 96.0 / 25.4
    })
}

/// The pixels of a figure.
pub(crate) struct Pixels {
    pub(crate) size: [usize; 2],
    pub(crate) colours: Vec<[u8; 3]>,
}

impl Pixels {
    pub(crate) fn of(figure: &Figure, dpi: f64) -> Self {
        let png = figure.to_png(dpi).unwrap();
        let mut reader = Decoder::new(Cursor::new(png)).read_info().unwrap();
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut bytes).unwrap();
        assert_eq!(info.color_type, ColorType::Rgb);
        let colours = bytes.chunks_exact(3).map(|rgb| [rgb[0], rgb[1], rgb[2]]).collect();
        Self { size: [info.width, info.height].map(|length| length as usize), colours }
    }

    /// The colour in a column and row.
    pub(crate) fn at(&self, [column, row]: [usize; 2]) -> [u8; 3] {
        self.colours[row * self.size[0] + column]
    }
}
