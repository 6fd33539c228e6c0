//! Recognises the kind of a file by its first bytes.

use super::PictureError;

/// Supported kinds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Png,
    Tiff,
}

/// Signatures of a kind of file, each with its offset, and the name of the kind.
type Marks = (&'static [(usize, &'static [u8])], &'static str);

/// File formats of microscopes and their software.
const CONTAINERS: [Marks; 10] = [
    (&[(0, b"ZISRAWFILE")], "Zeiss CZI"),
    (&[(0, b"\xda\xce\xbe\x0a")], "Nikon ND2"),
    (&[(0, b"\0\0\0\x0cjP  ")], "JPEG 2000 (or old Nikon ND2)"),
    (&[(0, b"\x70\0\0\0"), (8, b"\x2a")], "Leica LIF"),
    (&[(0, b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1")], "Olympus OIB or Zeiss ZVI"),
    (&[(0, b"OLYMPUSRAWFORMAT")], "Olympus OIR"),
    (&[(128, b"DICM")], "DICOM"),
    (&[(0, b"\x89HDF\r\n\x1a\n")], "HDF5 (Imaris IMS)"),
    (&[(0, b"NRRD")], "NRRD"),
    (&[(0, b"\x93NUMPY")], "NumPy"),
];

/// Common picture formats.
const PICTURES: [Marks; 10] = [
    (&[(0, b"\xff\xd8\xff")], "JPEG"),
    (&[(0, b"GIF8")], "GIF"),
    (&[(0, b"BM")], "BMP"),
    (&[(0, b"RIFF"), (8, b"WEBP")], "WEBP"),
    (&[(4, b"ftypavif")], "AVIF"),
    (&[(4, b"ftyphei")], "HEIC"),
    (&[(0, b"\x76\x2f\x31\x01")], "OPENEXR"),
    (&[(0, b"P2")], "PNM"),
    (&[(0, b"P5")], "PNM"),
    (&[(0, b"P6")], "PNM"),
];

/// Endings of microscope formats, in lower case.
const CONTAINER_ENDINGS: [(&str, &str); 18] = [
    ("czi", "Zeiss CZI"),
    ("zvi", "Zeiss ZVI"),
    ("lsm", "Zeiss LSM"),
    ("nd2", "Nikon ND2"),
    ("lif", "Leica LIF"),
    ("lof", "Leica LOF"),
    ("xlef", "Leica XLEF"),
    ("oib", "Olympus OIB"),
    ("oif", "Olympus OIF"),
    ("oir", "Olympus OIR"),
    ("vsi", "Olympus VSI"),
    ("ims", "Imaris IMS"),
    ("stk", "MetaMorph STK"),
    ("dv", "DeltaVision"),
    ("dcm", "DICOM"),
    ("h5", "HDF5"),
    ("npy", "NumPy"),
    ("zarr", "Zarr"),
];
const PICTURE_ENDINGS: [(&str, &str); 9] = [
    ("jpg", "JPEG"),
    ("jpeg", "JPEG"),
    ("gif", "GIF"),
    ("bmp", "BMP"),
    ("webp", "WEBP"),
    ("heic", "HEIC"),
    ("avif", "AVIF"),
    ("jp2", "JPEG 2000"),
    ("pgm", "PNM"),
];

/// Endings of meshes of tetrahedra, and of surfaces.
const SURFACE_ENDINGS: [(&str, &str); 4] =
    [("stl", "STL"), ("obj", "OBJ"), ("ply", "PLY"), ("vtp", "VTK")];
const MESH_ENDINGS: [(&str, &str); 6] = [
    ("vtk", "VTK"),
    ("vtu", "VTK"),
    ("msh", "Gmsh"),
    ("inp", "Abaqus"),
    ("xdmf", "XDMF"),
    ("mesh", "Medit"),
];

/// The error for a file with this ending, if it is an unsupported format of pictures or meshes.
pub(super) fn unread(ending: &str) -> Option<PictureError> {
    let ending = ending.to_lowercase();
    let named = |kinds: &[(&str, &'static str)]| {
        kinds.iter().find(|(known, _)| *known == ending).map(|(_, format)| *format)
    };
    let container = named(&CONTAINER_ENDINGS).map(|format| PictureError::Container { format });
    let picture = || named(&PICTURE_ENDINGS).map(|format| PictureError::Format { format });
    let mesh = || named(&MESH_ENDINGS).map(|format| PictureError::Mesh { format });
    let surface = || named(&SURFACE_ENDINGS).map(|format| PictureError::Surface { format });
    container.or_else(picture).or_else(mesh).or_else(surface)
}

/// Recognises what the bytes are.
pub(super) fn recognise(bytes: &[u8]) -> Result<Kind, PictureError> {
    let starts = |start: &[u8]| bytes.starts_with(start);
    if starts(b"\x89PNG\r\n\x1a\n") {
        return Ok(Kind::Png);
    }
    if [b"II*\0", b"MM\0*", b"II+\0", b"MM\0+"].iter().any(|start| starts(*start)) {
        return Ok(Kind::Tiff);
    }
    let marked = |marks: &[(usize, &[u8])]| {
        marks.iter().all(|&(at, mark)| bytes.get(at..).is_some_and(|rest| rest.starts_with(mark)))
    };
    let known = |kinds: &[Marks]| Some(kinds.iter().find(|(marks, _)| marked(marks))?.1);
    if let Some(format) = known(&CONTAINERS) {
        return Err(PictureError::Container { format });
    }
    if let Some(format) = known(&PICTURES) {
        return Err(PictureError::Format { format });
    }
    let start = format!("{:?}", String::from_utf8_lossy(&bytes[..bytes.len().min(8)]));
    Err(PictureError::NotAPicture { bytes: bytes.len(), start })
}
