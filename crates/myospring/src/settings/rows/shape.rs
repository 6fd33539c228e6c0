//! `[shape]`.

use super::super::bounds::{Bounds, Whole};
use super::super::problem::Problem;
use super::super::run::Run;
use super::super::setting::{Setting, ValueKind};
use super::super::shape::{
    OUTLINE_ENDINGS, PICTURE_ENDINGS, PictureSource, STACK_ENDINGS, Slices, Source,
};
use super::super::words::{Word, Worded, worded};
use crate::integrate::Method;
use crate::mechanics::material::of_thick_cell;
use crate::mesh::built_in;
use crate::mesh::pixel_size::PixelSize;
use crate::mesh::profile::Profile;
use crate::mesh::thick::Form;
use crate::microscopy::cells::PictureOptions;
use crate::microscopy::segment::{Choice, LARGEST_LABEL};
use crate::microscopy::stack::{FirstSlice, Stain};
use crate::units::Dimension;

/// A flat cell, or how the thickness of a thick one varies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum ProfileName {
    Flat,
    Round,
    Dome,
    Slab,
}

impl ProfileName {
    fn of(form: Option<Form>) -> Self {
        match form.map(|form| form.profile) {
            None => Self::Flat,
            Some(Profile::Round) => Self::Round,
            Some(Profile::Dome) => Self::Dome,
            Some(Profile::Slab) => Self::Slab,
        }
    }

    fn profile(self) -> Option<Profile> {
        match self {
            Self::Flat => None,
            Self::Round => Some(Profile::Round),
            Self::Dome => Some(Profile::Dome),
            Self::Slab => Some(Profile::Slab),
        }
    }
}

worded! { ProfileName {
    ProfileName::Flat = "flat": "A flat cell: a sheet of constant thickness that contracts in its plane.",
    ProfileName::Round = "round":
        "A thick cell, rounded above and below: its section is an ellipse.",
    ProfileName::Dome = "dome":
        "A thick cell with a flat underside, rounded above, as it lies on a gel or on glass.",
    ProfileName::Slab = "slab": "A thick cell of the same thickness everywhere.",
} }

worded! { FirstSlice {
    FirstSlice::Bottom = "bottom": "At the bottom, where the cell stands on its support.",
    FirstSlice::Top = "top": "At the top.",
} }

worded! { Stain {
    Stain::Auto = "auto": "Determined from the brightness at the surface and inside.",
    Stain::Filled = "filled": "The inside: cytosol, calcium dye, myofibrils.",
    Stain::Membrane = "membrane": "The membrane alone.",
} }

pub(super) const ROWS: &[Setting] = &[
    Setting::new(
        "shape.built_in",
        "A built-in cell.",
        ValueKind::Text {
            get: |run| match run.shape.source {
                Source::BuiltIn(cell) => Some(cell.name.to_owned()),
                _ => None,
            },
            set: set_built_in,
        },
    ),
    Setting::new(
        "shape.picture",
        "Picture of the cell from a microscope, or its mask: PNG, TIFF or OME-TIFF; relative to \
         this file.",
        ValueKind::File {
            endings: PICTURE_ENDINGS,
            words: &[],
            example: "cell.png",
            get: |run| path(run, false),
            set: |run, path| run.shape.source = picture(path, None),
        },
    ),
    Setting::new(
        "shape.stack",
        "Stack of pictures of the cell in depth, one per slice: a TIFF, OME-TIFF or ImageJ stack of fluorescence, a mask or labels; \
         relative to this file. The cell is thick, and has the form that the stack shows.",
        ValueKind::File {
            endings: STACK_ENDINGS,
            words: &[],
            example: "cell.tif",
            get: |run| path(run, true),
            set: |run, path| {
                make_thick(run);
                run.shape.source = picture(path, Some(Slices::default()));
            },
        },
    )
    .option_saying(
        "--stack",
        "FILE",
        "Stack of pictures of the cell in depth (TIFF): fluorescence, a mask or labels; gives a thick cell",
    ),
    Setting::quantity(
        "shape.z_step",
        "Distance of two slices of a stack. What the file states are steps of the stage; through a dry objective the focus \
         moves further.",
        Bounds::any(Dimension::Length, "0.5 um")
            .from(PixelSize::SMALLEST_UM)
            .to(PixelSize::LARGEST_UM),
        |run| run.shape.slices().and_then(|slices| slices.z_step),
        |run, step| change_slices(run, |slices| slices.z_step = Some(step)),
    )
    .otherwise("the stack's own")
    .option_saying("--z-step", "LENGTH", "Distance of two slices of a stack"),
    Setting::new(
        "shape.first_slice",
        "Where the first slice of a stack lies: bottom, where the cell stands on its support, or top.",
        ValueKind::Words {
            words: FirstSlice::WORDS,
            get: |run| run.shape.slices().map(|slices| slices.first.word()),
            set: |run, word| {
                let first = FirstSlice::of_word(word)?;
                change_slices(run, |slices| slices.first = first);
                Some(())
            },
        },
    )
    .otherwise("bottom")
    .option_saying("--first-slice", "PLACE", "Where the first slice of a stack lies: bottom or top"),
    Setting::new(
        "shape.stack_stain",
        "What of the cell is bright in a stack.",
        ValueKind::Words {
            words: Stain::WORDS,
            get: |run| run.shape.slices().map(|slices| slices.stain.word()),
            set: |run, word| {
                let stain = Stain::of_word(word)?;
                change_slices(run, |slices| slices.stain = stain);
                Some(())
            },
        },
    )
    .otherwise("auto")
    .option_saying("--stack-stain", "STAIN", "What of the cell is bright in a stack: auto, filled or membrane"),
    Setting::new(
        "shape.outline",
        "Outline of the cell: GeoJSON (.geojson, .json), points in um (.csv), ImageJ's .roi or \
         RoiSet .zip, Cellpose's _outlines.txt; relative to this file.",
        ValueKind::File {
            endings: OUTLINE_ENDINGS,
            words: &[],
            example: "cell.geojson",
            get: |run| match &run.shape.source {
                Source::Outline { path, .. } => Some(path.clone()),
                _ => None,
            },
            set: |run, path| {
                let choice = Choice::Largest;
                run.shape.source = Source::Outline { path, pixel_size: None, choice };
            },
        },
    ),
    Setting::quantity(
        "shape.pixel_size",
        "Side of one pixel of a picture, or of an outline in pixels. Never guessed.",
        Bounds::any(Dimension::Length, "0.27 um")
            .from(PixelSize::SMALLEST_UM)
            .to(PixelSize::LARGEST_UM),
        |run| match &run.shape.source {
            Source::BuiltIn(_) => None,
            Source::Picture(picture) => picture.options.pixel_size.map(PixelSize::um),
            Source::Outline { pixel_size, .. } => pixel_size.map(PixelSize::um),
        },
        |run, size| match &mut run.shape.source {
            Source::BuiltIn(_) => {}
            // The bounds of this row are those of the type.
            Source::Picture(picture) => picture.options.pixel_size = PixelSize::new(size).ok(),
            Source::Outline { pixel_size, .. } => *pixel_size = PixelSize::new(size).ok(),
        },
    )
    .otherwise("the picture's own")
    .option_saying("--pixel-size", "LENGTH", "Side of one pixel of a picture"),
    Setting::new(
        "shape.label",
        "In a label mask, the grey value of the cell.",
        ValueKind::Whole {
            bounds: Whole { minimum: 1, maximum: LARGEST_LABEL, example: 3 },
            get: |run| match run.shape.source.choice() {
                Some(Choice::Label(label)) => Some(label),
                _ => None,
            },
            set: |run, label| {
                if let Some(choice) = run.shape.source.choice_mut() {
                    *choice = Choice::Label(label);
                }
            },
        },
    )
    .otherwise("the largest cell")
    .option("--label", "N"),
    Setting::new(
        "shape.any_size",
        "Accepts a cell whose size is impossible for a heart cell: longer than 400 um, shorter than 15 um, or with an area outside \
         of `min_area` to `max_area`. Such a size usually means a wrong pixel size.",
        ValueKind::Flag {
            get: |run| (!matches!(run.shape.source, Source::BuiltIn(_))).then_some(run.shape.any_size),
            set: |run, any| run.shape.any_size = any,
        },
    )
    .option_saying(
        "--any-size",
        "",
        "Accept a cell whose size is impossible for a heart cell (longer than 400 um, shorter than 15 um, or of an unusual area)",
    ),
    Setting::quantity(
        "shape.rotate",
        "Rotates an outline or built-in cell counter-clockwise before it is meshed.",
        Bounds::any(Dimension::Angle, "30 deg").from(-360.0).to(360.0),
        |run| (!matches!(run.shape.source, Source::Picture(_))).then_some(run.shape.rotate),
        |run, angle| run.shape.rotate = angle,
    )
    .option_saying(
        "--rotate",
        "ANGLE",
        "Rotate an outline or the built-in cell counter-clockwise",
    ),
    Setting::new(
        "shape.profile",
        "Section of the cell across its plane. A thick cell is made of cubes; its greatest thickness is `thickness` in \
         [material], and what a picture does not show of it is assumed.",
        ValueKind::Words {
            words: ProfileName::WORDS,
            get: |run| {
                run.shape.slices().is_none().then(|| ProfileName::of(run.shape.form).word())
            },
            set: set_profile,
        },
    )
    .option_saying(
        "--profile",
        "NAME",
        "Section of the cell across its plane: flat, or of a thick cell round, dome (flat underside) or slab; its greatest \
         thickness is --thickness",
    ),
    Setting::quantity(
        "shape.spacing",
        "Distance between neighbouring masses.",
        // The mesh checks it against the shape.
        Bounds::any(Dimension::Length, "1.1 um").above(0.0).to(1000.0),
        |run| run.shape.spacing,
        |run, spacing| run.shape.spacing = Some(spacing),
    )
    .otherwise("such that a flat cell has about 2000 of them, a thick one about 4000 and 4 cubes across its thickness")
    .option("--spacing", "LENGTH"),
];

/// The file of the picture, or of the stack.
fn path(run: &Run, of_stack: bool) -> Option<String> {
    let picture = run.shape.source.picture()?;
    (picture.slices.is_some() == of_stack).then(|| picture.path.clone())
}

fn picture(path: String, slices: Option<Slices>) -> Source {
    Source::Picture(Box::new(PictureSource {
        path,
        outline: None,
        options: PictureOptions::default(),
        choice: Choice::Largest,
        allow_cut: false,
        slices,
    }))
}

fn change_slices(run: &mut Run, change: impl FnOnce(&mut Slices)) {
    if let Some(slices) = run.shape.source.picture_mut().and_then(|it| it.slices.as_mut()) {
        change(slices);
    }
}

/// A thick cell moves along its equilibria unless stated, and its material is that of a solid.
fn make_thick(run: &mut Run) {
    if !run.shape.is_thick() {
        run.material = of_thick_cell(&run.material);
        run.numerics.method = Method::QuasiStatic;
    }
}

fn set_profile(run: &mut Run, word: &str) -> Option<()> {
    let Some(profile) = ProfileName::of_word(word)?.profile() else {
        run.shape.form = None;
        return Some(());
    };
    make_thick(run);
    run.shape.form = Some(Form { profile, thickness: run.material.thickness });
    Some(())
}

fn set_built_in(run: &mut Run, name: &str) -> Result<(), Problem> {
    let known = built_in::CELLS.iter().map(|cell| cell.name);
    let cell =
        built_in::find(name).ok_or_else(|| Problem::unknown_word("shape.built_in", name, known))?;
    run.shape.source = Source::BuiltIn(cell);
    Ok(())
}
