//! Films: what their files say, frames that are missing, damaged or of another size.

use myospring::microscopy::film::{Film, FilmError};
use myospring::microscopy::picture::Selection;

use super::common::shared_data;

/// A chunk of a RIFF file.
fn chunk(name: [u8; 4], content: &[u8]) -> Vec<u8> {
    let mut bytes = name.to_vec();
    bytes.extend((content.len() as u32).to_le_bytes());
    bytes.extend(content);
    if content.len() % 2 == 1 {
        bytes.push(0);
    }
    bytes
}

fn list(kind: [u8; 4], chunks: &[Vec<u8>]) -> Vec<u8> {
    chunk(*b"LIST", &[kind.to_vec(), chunks.concat()].concat())
}

fn words(numbers: &[u32]) -> Vec<u8> {
    numbers.iter().flat_map(|number| number.to_le_bytes()).collect()
}

/// An AVI with these bits per pixel, compression and frames, 25 frames a second.
fn avi(size: [u32; 2], bits: u32, compression: [u8; 4], frames: &[Vec<u8>]) -> Vec<u8> {
    let count = frames.len() as u32;
    let header =
        chunk(*b"avih", &words(&[40_000, 0, 0, 16, count, 0, 1, 0, size[0], size[1], 0, 0, 0, 0]));
    let stream = [b"vids".to_vec(), words(&[0, 0, 0, 0, 1, 25, 0, count, 0, 0, 0, 0, 0])].concat();
    let code = u32::from_le_bytes(compression);
    let mut format = words(&[40, size[0], size[1], 1 | bits << 16, code, 0, 0, 0, 0, 0]);
    if bits == 8 {
        // A palette that turns grey over.
        format.extend((0..256_u32).flat_map(|k| (0x0001_0101 * (255 - k)).to_le_bytes()));
    }
    let stream = list(*b"strl", &[chunk(*b"strh", &stream), chunk(*b"strf", &format)]);
    let frames: Vec<Vec<u8>> = frames.iter().map(|frame| chunk(*b"00db", frame)).collect();
    let inside = [b"AVI ".to_vec(), list(*b"hdrl", &[header, stream]), list(*b"movi", &frames)];
    chunk(*b"RIFF", &inside.concat())
}

fn read(bytes: Vec<u8>) -> Result<Film, FilmError> {
    Film::read(bytes, &Selection::default())
}

#[test]
fn an_avi_of_grey_values_is_read_from_below_through_its_palette() {
    // Three pixels a row, padded to four; rows from below.
    let frames: Vec<Vec<u8>> = (0..4).map(|k| vec![10 + k, 11, 12, 0, 20, 21, 22, 0]).collect();
    let film = read(avi([3, 2], 8, *b"\0\0\0\0", &frames)).unwrap();
    assert_eq!((film.len(), film.size(), film.frames_per_second), (4, [3, 2], Some(25.0)));
    let wanted: Vec<f32> = [20, 21, 22, 12, 11, 12].map(|index| 255.0 - index as f32).to_vec();
    assert_eq!(film.frame(2).unwrap().values(), wanted);
    assert!(film.notes.is_empty(), "{:?}", film.notes);
}

#[test]
fn an_avi_of_colours_is_read_as_their_luminance() {
    let grey = [7, 7, 7, 9, 9, 9, 0, 0];
    let red = [0, 0, 200, 0, 0, 0, 0, 0];
    let frames = [grey.to_vec(), red.to_vec(), grey.to_vec()];
    let film = read(avi([2, 1], 24, *b"\0\0\0\0", &frames)).unwrap();
    assert_eq!(film.frame(0).unwrap().values(), [7.0, 9.0]);
    // ITU-R BT.709.
    assert!((film.frame(1).unwrap().values()[0] - 0.2126 * 200.0).abs() < 1e-3);
}

#[test]
fn an_avi_that_is_cut_off_has_the_frames_before_and_says_so() {
    let frames: Vec<Vec<u8>> = (0..6).map(|k| vec![k; 400]).collect();
    let whole = avi([20, 20], 8, *b"Y800", &frames);
    for (cut, left) in [(100, 5), (500, 4), (1000, 3)] {
        let film = read(whole[..whole.len() - cut].to_vec()).unwrap();
        assert_eq!(film.len(), left);
        let note =
            format!("the film is cut off: {left} complete frames of the 6 declared ones were read");
        assert_eq!(film.notes, [note]);
        assert_eq!(film.frame(left - 1).unwrap().at(3, 3), (left - 1) as f32);
    }
    let error = read(whole[..whole.len() - 1700].to_vec()).unwrap_err();
    assert_eq!(error, FilmError::TooFew { frames: 1 });
    for cut in 0..whole.len() {
        // Whatever is missing, there is an answer.
        read(whole[..cut].to_vec()).ok();
    }
}

#[test]
fn dropped_frames_repeat_the_one_before() {
    let frames = [vec![1; 4], vec![], vec![3; 4], vec![4; 4]];
    let film = read(avi([2, 2], 8, *b"Y800", &frames)).unwrap();
    assert_eq!(film.frame(1).unwrap().values(), [1.0; 4]);
    assert_eq!(film.notes, ["1 frames were dropped by the camera; each repeats the one before it"]);
}

/// A film with whatever is between its header and its end.
fn with_pictures(pictures: &[u8]) -> Vec<u8> {
    let whole = avi([2, 2], 8, *b"Y800", &[]);
    // Its list of pictures is the last that it has, and empty.
    let inside = [&whole[8..whole.len() - 12], pictures].concat();
    chunk(*b"RIFF", &inside)
}

#[test]
fn lists_that_are_nested_without_end_are_refused() {
    // Outermost first: each holds all that follow.
    let nested = (0..100_000_u32)
        .rev()
        .flat_map(|inner| [&b"LIST"[..], &(12 * inner + 4).to_le_bytes(), b"rec "].concat());
    let nested: Vec<u8> = nested.collect();
    let film = with_pictures(&list(*b"movi", &[nested]));
    let said = read(film).unwrap_err().to_string();
    assert!(said.contains("nested more than 8 deep"), "{said}");
    let one = list(*b"rec ", &[chunk(*b"00db", &[1; 4]), chunk(*b"00db", &[2; 4])]);
    assert_eq!(read(with_pictures(&list(*b"movi", &[one.clone(), one]))).unwrap().len(), 4);
}

#[test]
fn a_million_empty_frames_take_a_moment() {
    let begun = std::time::Instant::now();
    let empty = chunk(*b"00db", &[]).repeat(1_000_000);
    let all = [chunk(*b"00db", &[1; 4]), empty.clone(), chunk(*b"00db", &[2; 4])];
    let film = read(with_pictures(&list(*b"movi", &all))).unwrap();
    assert_eq!(film.len(), 1_000_002);
    for frame in (0..1_000_000).step_by(100) {
        assert_eq!(film.frame(frame).unwrap().values(), [1.0; 4]);
    }
    // Before the first picture there is none to repeat.
    let all = [&[empty][..], &[1, 2, 3].map(|grey| chunk(*b"00db", &[grey; 4]))].concat();
    assert_eq!(read(with_pictures(&list(*b"movi", &all))).unwrap().len(), 3);
    // A second on a busy machine; they took minutes.
    assert!(begun.elapsed() < std::time::Duration::from_secs(20), "{:?}", begun.elapsed());
}

#[test]
fn compression_that_is_not_read_is_named() {
    let frames = [vec![1; 4], vec![2; 4], vec![3; 4]];
    let error = read(avi([2, 2], 24, *b"XVID", &frames)).unwrap_err();
    assert_eq!(error, FilmError::Codec { codec: "XVID".to_owned() });
    assert!(error.to_string().contains("save the film uncompressed"), "{error}");
    // What claims to be JPEG and is none fails where it is looked at, with the frame's number.
    let film = read(avi([2, 2], 24, *b"MJPG", &frames)).unwrap();
    assert!(film.frame(1).unwrap_err().to_string().starts_with("frame 1: the JPEG picture cannot"));
}

#[test]
fn jpeg_frames_of_a_real_film_are_read() {
    let Some(path) = shared_data("films/sarcgraph_sample_2.avi") else { return };
    let bytes = std::fs::read(path).unwrap();
    let film = read(bytes.clone()).unwrap();
    let mean = |frame: usize| {
        let plane = film.frame(frame).unwrap();
        plane.values().iter().map(|&value| f64::from(value)).sum::<f64>() / 160_000.0
    };
    // As ffmpeg decodes it: 31.3 over the film.
    assert!((mean(0) - 31.0).abs() < 2.0, "{}", mean(0));
    let half = read(bytes[..bytes.len() / 2].to_vec()).unwrap();
    assert!(half.len() > 60 && half.len() < 80 && half.notes[0].starts_with("the film is cut off"));
}

fn png(width: u32, height: u32, value: u8) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut writer = png::Encoder::new(&mut bytes, width, height).write_header().unwrap();
    writer.write_image_data(&vec![value; (width * height) as usize]).unwrap();
    writer.finish().unwrap();
    bytes
}

#[test]
fn pictures_are_frames_in_natural_order() {
    let named = |name: &str, value| (name.to_owned(), png(4, 3, value));
    let files = vec![named("t10.png", 10), named("t9.png", 9), named("t1.png", 1)];
    let film = Film::of_pictures(files, &Selection::default()).unwrap();
    let values: Vec<f32> = (0..3).map(|k| film.frame(k).unwrap().at(0, 0)).collect();
    assert_eq!((values, film.frames_per_second), (vec![1.0, 9.0, 10.0], None));
}

#[test]
fn frames_of_another_size_are_named() {
    let files = [("a1.png", 4), ("a2.png", 4), ("a3.png", 5)]
        .map(|(name, width)| (name.to_owned(), png(width, 3, 1)));
    let film = Film::of_pictures(files.to_vec(), &Selection::default()).unwrap();
    let error = film.frame(2).unwrap_err().to_string();
    assert_eq!(
        error,
        "frame 2 (`a3.png`) has 5 x 3 pixels, but the first has 4 x 3; give frames of one size"
    );
}

#[test]
fn one_picture_or_two_are_no_film() {
    for count in 0..3 {
        let files = (0..count).map(|k| (format!("{k}.png"), png(4, 3, 1))).collect();
        let error = Film::of_pictures(files, &Selection::default()).unwrap_err();
        assert_eq!(error, FilmError::TooFew { frames: count });
    }
    let error = read(png(4, 3, 1)).unwrap_err().to_string();
    assert!(error.starts_with("there is only one frame; at least 3 are needed"), "{error}");
    assert!(
        read(b"no film".to_vec()).unwrap_err().to_string().starts_with("this is not a picture")
    );
}

/// A TIFF of floating point with these frames and this description.
fn tiff(description: &str, frames: &[[f32; 12]]) -> Vec<u8> {
    use tiff::encoder::{TiffEncoder, colortype::Gray32Float};
    use tiff::tags::Tag;
    let mut bytes = std::io::Cursor::new(Vec::new());
    let mut encoder = TiffEncoder::new(&mut bytes).unwrap();
    for (at, frame) in frames.iter().enumerate() {
        let mut image = encoder.new_image::<Gray32Float>(4, 3).unwrap();
        if at == 0 && !description.is_empty() {
            image.encoder().write_tag(Tag::ImageDescription, description).unwrap();
        }
        image.write_data(frame).unwrap();
    }
    bytes.into_inner()
}

#[test]
fn stacks_say_how_fast_they_are() {
    let frames = [[1.0; 12], [2.0; 12], [3.0; 12]];
    let rate = |description: &str| read(tiff(description, &frames)).unwrap().frames_per_second;
    assert_eq!(rate(""), None);
    let imagej = "ImageJ=1.54\nimages=3\nframes=3\nhyperstack=true\nfinterval=0.02\nfps=7.0\n";
    assert_eq!(rate(imagej), Some(50.0));
    assert_eq!(rate("ImageJ=1.54\nimages=3\nframes=3\nfps=40.0\n"), Some(40.0));
    let ome = |more: &str, planes: &str| {
        format!(
            "<?xml version=\"1.0\"?><OME xmlns=\"http://www.openmicroscopy.org/Schemas/OME/2016-06\"><Image \
             ID=\"Image:0\"><Pixels ID=\"Pixels:0\" DimensionOrder=\"XYCZT\" SizeX=\"4\" SizeY=\"3\" SizeC=\"1\" \
             SizeZ=\"1\" SizeT=\"3\" Type=\"float\" {more}><TiffData/>{planes}</Pixels></Image></OME>"
        )
    };
    assert_eq!(rate(&ome("TimeIncrement=\"25\" TimeIncrementUnit=\"ms\"", "")), Some(40.0));
    let planes = "<Plane TheC=\"0\" TheZ=\"0\" TheT=\"0\" DeltaT=\"1.5\"/><Plane TheC=\"0\" TheZ=\"0\" TheT=\"2\" \
                  DeltaT=\"1.6\"/>";
    let found = rate(&ome("", planes)).unwrap();
    assert!((found - 20.0).abs() < 1e-9, "{found}");
}

#[test]
fn a_frame_with_pixels_that_are_no_number_is_named() {
    let mut frames = [[1.0_f32; 12]; 4];
    frames[2][7] = f32::NAN;
    let film = read(tiff("", &frames)).unwrap();
    assert_eq!(film.len(), 4);
    let error = film.frame(2).unwrap_err().to_string();
    assert!(error.starts_with("frame 2: 1 pixels are infinite or not a number"), "{error}");
    assert!(error.contains("column 3, row 1"), "{error}");
}

#[test]
fn a_frame_is_a_picture_of_its_own() {
    for scale in [1.0, 100.0, 0.3] {
        let frames = [[1.0; 12], [2.0; 12], [3.0; 12]].map(|frame| frame.map(|v: f32| v * scale));
        let film = read(tiff("", &frames)).unwrap();
        let bytes = film.picture(2).unwrap();
        let picture =
            myospring::microscopy::read::read_picture(&bytes, &Selection::default()).unwrap();
        assert_eq!(picture.plane, film.frame(2).unwrap());
    }
}
