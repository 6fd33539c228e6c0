//! Figures and thumbnails as addresses of images, so that nothing in them can act on the page.

use super::table::VerdictMark;
use crate::figure::{Figure, FigureError, Theme};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;

/// Bytes of an SVG above which a figure is embedded as pixels, and their dots per inch.
const LARGEST_SVG: usize = 400_000;
const DPI: f64 = 110.0;

/// A figure on a page.
#[derive(Debug, Clone, Serialize)]
pub struct Drawing {
    /// What it shows, for those who cannot see it.
    words: String,
    light: String,
    dark: String,
}

impl Drawing {
    /// A figure and what it shows, in a sentence.
    ///
    /// # Errors
    /// A figure that cannot be drawn.
    pub fn new(figure: &Figure, words: &str) -> Result<Self, FigureError> {
        let image = |theme| -> Result<String, FigureError> {
            let figure = figure.clone().themed(theme);
            let svg = figure.to_svg();
            if svg.len() <= LARGEST_SVG {
                return Ok(address("svg+xml", svg.as_bytes()));
            }
            Ok(address("png", &figure.to_png(DPI)?))
        };
        let words = words.to_owned();
        Ok(Self { words, light: image(Theme::Light)?, dark: image(Theme::Dark)? })
    }

    /// The first of some figures, from the finest on, whose lines are small enough to stay lines; or the last as pixels.
    ///
    /// # Errors
    /// No figure, or one that cannot be drawn.
    pub fn finest(
        figures: impl IntoIterator<Item = Result<Figure, FigureError>>,
        words: &str,
    ) -> Result<Self, FigureError> {
        let mut last = None;
        for figure in figures {
            let figure = figure?;
            let fits = figure.to_svg().len() <= LARGEST_SVG;
            last = Some(figure);
            if fits {
                break;
            }
        }
        Self::new(&last.ok_or(FigureError::Nothing { what: "figures" })?, words)
    }

    /// Bytes that it takes on a page.
    pub fn size(&self) -> usize {
        self.light.len() + self.dark.len()
    }
}

/// A small picture with its name.
#[derive(Debug, Clone, Serialize)]
pub struct Thumbnail {
    name: String,
    words: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    mark: Option<VerdictMark>,
    image: String,
}

impl Thumbnail {
    /// A PNG with its name, a few words below it, and what is to be known of it.
    pub fn new(name: &str, words: &str, mark: Option<VerdictMark>, png: &[u8]) -> Self {
        let (name, words) = (name.to_owned(), words.to_owned());
        Self { name, words, mark, image: address("png", png) }
    }

    /// Bytes that it takes on a page.
    pub fn size(&self) -> usize {
        self.image.len()
    }
}

/// An image as its own address.
pub(super) fn address(kind: &str, bytes: &[u8]) -> String {
    format!("data:image/{kind};base64,{}", STANDARD.encode(bytes))
}
