//! Which kind of file bytes are, by how they start.

use image::ImageFormat;

use super::PictureError;

/// Kinds that are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Png,
    Tiff,
}

/// Files of microscopes and of programs beside them: where their mark stands, the mark, the name.
const CONTAINERS: [(usize, &[u8], &str); 10] = [
    (0, b"ZISRAWFILE", "Zeiss CZI"),
    (0, b"\xda\xce\xbe\x0a", "Nikon ND2"),
    (0, b"\0\0\0\x0cjP  ", "JPEG 2000 (or old Nikon ND2)"),
    (8, b"\x2a", "Leica LIF"),
    (0, b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", "Olympus OIB or Zeiss ZVI"),
    (0, b"OLYMPUSRAWFORMAT", "Olympus OIR"),
    (128, b"DICM", "DICOM"),
    (0, b"\x89HDF\r\n\x1a\n", "HDF5 (Imaris IMS)"),
    (0, b"NRRD", "NRRD"),
    (0, b"\x93NUMPY", "NumPy"),
];

/// Start of a Leica LIF; its second mark is in the table.
const LIF: &[u8] = b"\x70\0\0\0";

/// Tells what the bytes are.
pub(super) fn recognise(bytes: &[u8]) -> Result<Kind, PictureError> {
    let starts = |start: &[u8]| bytes.starts_with(start);
    if starts(b"\x89PNG\r\n\x1a\n") {
        return Ok(Kind::Png);
    }
    if [b"II*\0", b"MM\0*", b"II+\0", b"MM\0+"].iter().any(|start| starts(*start)) {
        return Ok(Kind::Tiff);
    }
    for (at, mark, format) in CONTAINERS {
        let marked = bytes.get(at..).is_some_and(|rest| rest.starts_with(mark));
        if marked && (format != "Leica LIF" || starts(LIF)) {
            return Err(PictureError::Container { format });
        }
    }
    match image::guess_format(bytes) {
        Ok(format) if format != ImageFormat::Png && format != ImageFormat::Tiff => {
            Err(PictureError::Format { format: format!("{format:?}").to_uppercase() })
        }
        _ => {
            let start = format!("{:?}", String::from_utf8_lossy(&bytes[..bytes.len().min(8)]));
            Err(PictureError::NotAPicture { bytes: bytes.len(), start })
        }
    }
}
