//! `[mechanics]`.

use super::super::adhesion::ADHESION_ENDINGS;
use super::super::bounds::Bounds;
use super::super::content::CONTENT_ENDINGS;
use super::super::fibres::{Asked, FibreDirection};
use super::super::places::{FromPlaces, WORDS};
use super::super::problem::Problem;
use super::super::run::Run;
use super::super::sarcomeres::SARCOMERE_ENDINGS;
use super::super::setting::{Setting, ValueKind};
use super::super::value::Value;
use super::super::words::{Word, Worded, choose, worded};
use crate::integrate::Method;
use crate::mechanics::active::ActiveLaw;
use crate::mechanics::gel::{Adhesion, Gel};
use crate::mechanics::post::Post;
use crate::mechanics::support::SupportKind;
use crate::microscopy::fibres::{FibreSettings, Stain};
use crate::units::Dimension;

worded! { ActiveLaw {
    ActiveLaw::Fibre = "fibre": "Stress along the fibre in each triangle; internal.",
    ActiveLaw::Ends = "ends": "The paper's load on the end nodes along the long axis; external.",
} }

worded! { Stain {
    Stain::ZDisc = "z-disc":
        "Stripes that lie across the fibre: z-discs (alpha-actinin, titin's end), M-bands \
         (myomesin).",
    Stain::Filament = "filament": "Threads that run along the fibre: actin (phalloidin).",
} }

/// Which support holds the cell, without its numbers.
#[derive(Clone, Copy)]
enum SupportName {
    MassCentre,
    ClampedEnd,
    ClampedEnds,
    AfterloadedEnds,
    SpringHeldEnds,
    Posts,
    Gel,
    ElasticBed,
}

worded! { SupportName {
    SupportName::MassCentre = "mass-centre":
        "Mass centre and orientation fixed; otherwise free.",
    SupportName::ClampedEnd = "clamped-end": "The end where the long axis starts is clamped.",
    SupportName::ClampedEnds = "clamped-ends":
        "Both ends are clamped: an isometric contraction.",
    SupportName::AfterloadedEnds = "afterloaded-ends":
        "Both ends are held until the cell pulls harder than a load, against which it then shortens, as in a force \
         clamp; needs `afterload`, and quasi-static.",
    SupportName::SpringHeldEnds = "spring-held-ends":
        "A spring at either end, such as a carbon fibre: an auxotonic contraction; needs \
         `end_stiffness`.",
    SupportName::Posts = "posts":
        "A flexible post at either end, which a strip of tissue bends: an auxotonic contraction; needs `post_length`, \
         `post_width` and `post_modulus`.",
    SupportName::Gel = "gel":
        "The cell adheres to an elastic gel of `gel_modulus`, a half-space or a layer on glass, and pulls on it within the \
         plane; quasi-static unless an integrator is stated, since each step in time solves for the gel.",
    SupportName::ElasticBed = "elastic-bed":
        "Every point is tied to its resting position by `bed_stiffness`, as on pillars or a thin gel.",
} }

worded! { Adhesion {
    Adhesion::Everywhere = "everywhere": "The whole cell adheres.",
    Adhesion::Ends = "ends": "A fifth of its length at either end.",
    Adhesion::Rim = "rim": "What lies within 3 um of its outline.",
} }

/// Stiffness of a bed unless stated, kPa/um: a shear modulus of 5 kPa over 10 um. A run says that it was assumed.
const USUAL_BED: f64 = 0.5;

const FIBRE: &str = "mechanics.fibre";
const FIBRE_ANGLE: Bounds = Bounds::any(Dimension::Angle, "15 deg").from(-360.0).to(360.0);
const AUTO: &str = "auto";
const LONG_AXIS: &str = "long axis";
const PICTURE: &str = "picture";

pub(super) const ROWS: &[Setting] = &[
    Setting::new(
        "mechanics.active",
        "How the tension acts.",
        ValueKind::Words {
            words: ActiveLaw::WORDS,
            get: |run| Some(run.active.word()),
            set: |run, word| choose(&mut run.active, word),
        },
    )
    .option("--active", "LAW"),
    Setting::new(
        FIBRE,
        "Direction of the fibres: \"picture\" (read from the stripes or filaments of the picture), the \
         \"long axis\" of the cell, an angle counter-clockwise from x, or \"auto\": from a picture that shows \
         sarcomeres or the stated stain, and along the long axis elsewhere.",
        ValueKind::Written {
            bounds: Some(FIBRE_ANGLE),
            numbers: false,
            example: FIBRE_ANGLE.example,
            get: |run| {
                Some(match run.fibre {
                    FibreDirection::Auto(_) => Value::from(AUTO),
                    FibreDirection::LongAxis => Value::from(LONG_AXIS),
                    FibreDirection::Angle(degrees) => FIBRE_ANGLE.write(degrees),
                    FibreDirection::Picture(_) => Value::from(PICTURE),
                })
            },
            set: set_fibre,
        },
    )
    .option_saying(
        "--fibre",
        "DIRECTION",
        "Fibre direction: auto (from the picture where it shows sarcomeres, else the long axis), picture (from \
         its stripes or filaments), \"long axis\", or an angle (\"15 deg\")",
    ),
    Setting::new(
        "mechanics.stain",
        "What the picture shows: stripes across the fibre, or filaments along it.",
        ValueKind::Words {
            words: Stain::WORDS,
            get: |run| match &run.fibre {
                FibreDirection::Auto(asked) => asked.stain.map(|stain| stain.word()),
                FibreDirection::Picture(settings) => Some(settings.stain.word()),
                FibreDirection::LongAxis | FibreDirection::Angle(_) => None,
            },
            set: |run, word| {
                let stain = Stain::of_word(word)?;
                match &mut run.fibre {
                    FibreDirection::Auto(asked) => asked.stain = Some(stain),
                    FibreDirection::Picture(settings) => *settings = FibreSettings::of(stain),
                    FibreDirection::LongAxis | FibreDirection::Angle(_) => {}
                }
                Some(())
            },
        },
    )
    .otherwise("z-disc; auto uses it only if it finds sarcomeres")
    .option_saying(
        "--stain",
        "NAME",
        "What the picture shows: z-disc (stripes across the fibre, such as alpha-actinin) or filament (along \
         it, such as phalloidin)",
    ),
    Setting::quantity(
        "mechanics.fibre_smoothing",
        "Scale over which directions from the picture are averaged.",
        Bounds::any(Dimension::Length, "3 um").from(0.1).to(20.0),
        |run| match &run.fibre {
            FibreDirection::Auto(asked) => asked.smoothing_um,
            FibreDirection::Picture(settings) => Some(settings.smoothing_um),
            FibreDirection::LongAxis | FibreDirection::Angle(_) => None,
        },
        |run, scale| match &mut run.fibre {
            FibreDirection::Auto(asked) => asked.smoothing_um = Some(scale),
            FibreDirection::Picture(settings) => settings.smoothing_um = scale,
            FibreDirection::LongAxis | FibreDirection::Angle(_) => {}
        },
    )
    .otherwise("\"3 um\"")
    .option_saying(
        "--fibre-smoothing",
        "LENGTH",
        "Scale over which directions from the picture are averaged",
    ),
    Setting::new(
        "mechanics.myofibril_content",
        "Content of myofibrils in each place, to which tension is proportional: \"uniform\"; \"picture\", which \
         uses order times coverage of the fibres in the picture, relative to its mean, and 0 where \
         it shows none; or a file, relative to this one: a table (.csv) with the header content, a row for each \
         triangle, or x_um,y_um,content, used unchanged, or a picture of the same frame as the cell's, whose \
         grey values are used relative to their mean.",
        ValueKind::File {
            endings: CONTENT_ENDINGS,
            words: WORDS,
            example: "content.csv",
            get: |run| Some(run.myofibril_content.written().to_owned()),
            set: |run, text| run.myofibril_content = FromPlaces::of(text),
        },
    )
    .option_saying(
        "--myofibril-content",
        "WHAT",
        "Content of myofibrils by place, to which tension is proportional: uniform, picture (from the order of its \
         fibres), a table (.csv: content, or x_um,y_um,content), or a picture of the same frame",
    )
    .alias("--content"),
    Setting::new(
        "mechanics.sarcomere_length",
        "Length of the sarcomeres at rest in each place, for a model that depends on stretch: its stretch there is \
         this length divided by `sarcomere_reference`. \"uniform\": that length everywhere; \"picture\": as in the picture, \
         or as at the nearest place where it shows none; or a table (.csv), relative to this file, with \
         the header sarcomere_um, a row for each triangle, or x_um,y_um,sarcomere_um, such as fibres.csv. With a model for \
         each triangle (stretch_felt = \"triangle\"), each has its own; a single model has their mean.",
        ValueKind::File {
            endings: SARCOMERE_ENDINGS,
            words: WORDS,
            example: "fibres.csv",
            get: |run| Some(run.sarcomere_length.written().to_owned()),
            set: |run, text| run.sarcomere_length = FromPlaces::of(text),
        },
    )
    .option_saying(
        "--sarcomere-length",
        "WHAT",
        "Length of the sarcomeres at rest by place, for a model that depends on stretch: uniform, picture, or a table \
         (.csv: sarcomere_um, or x_um,y_um,sarcomere_um)",
    ),
    Setting::quantity(
        "mechanics.sarcomere_reference",
        "Length of the sarcomere at which the cell model's stretch is 1. It has not been measured for any model: isolated \
         rat cells rest at 1.71 um, the same cells within the heart at 1.95 um (Bub 2010).",
        Bounds::any(Dimension::Length, "1.71 um").from(1.0).to(3.0),
        |run| run.sarcomere_reference,
        |run, length| run.sarcomere_reference = Some(length),
    )
    .option_saying(
        "--sarcomere-reference",
        "LENGTH",
        "Length of the sarcomere at which the cell model's stretch is 1",
    ),
    Setting::quantity(
        "mechanics.helix_angle",
        "Angle by which the fibres of a thick cell turn from its lowest to its highest point, counter-clockwise as seen from above.",
        Bounds::any(Dimension::Angle, "40 deg").from(-180.0).to(180.0),
        |run| run.states_turn().then_some(run.helix_angle),
        |run, angle| run.helix_angle = angle,
    )
    .otherwise("0 deg")
    .option_saying(
        "--helix-angle",
        "ANGLE",
        "Angle by which the fibres of a thick cell turn from its lowest to its highest point",
    ),
    Setting::new(
        "mechanics.support",
        "The support of the cell.",
        ValueKind::Words {
            words: SupportName::WORDS,
            get: |run| Some(support_name(run.support).word()),
            set: |run, word| {
                run.support = support(SupportName::of_word(word)?);
                if let SupportKind::Gel(_) = run.support {
                    run.numerics.method = Method::QuasiStatic;
                }
                Some(())
            },
        },
    )
    .option("--support", "KIND"),
    Setting::quantity(
        "mechanics.end_stretch",
        "Distance between clamped or afterloaded ends before the beat, relative to the cell at rest.",
        Bounds::any(Dimension::Number, "1.1").from(0.5).to(1.5),
        |run| Some(run.end_stretch),
        |run, stretch| run.end_stretch = stretch,
    )
    .option_saying(
        "--end-stretch",
        "RATIO",
        "Distance between clamped or afterloaded ends before the beat, relative to the cell at rest",
    ),
    Setting::quantity(
        "mechanics.afterload",
        "Force against which the cell of \"afterloaded-ends\" shortens: 1 kPa on a section of 200 um^2 is 200 nN.",
        Bounds::any(Dimension::Force, "2000 nN").above(0.0).to(1e9),
        |run| match run.support {
            SupportKind::AfterloadedEnds { load } => Some(load),
            _ => None,
        },
        |run, value| {
            if let SupportKind::AfterloadedEnds { load } = &mut run.support {
                *load = value;
            }
        },
    )
    .option_saying(
        "--afterload",
        "FORCE",
        "Force against which a cell with afterloaded-ends shortens",
    ),
    Setting::quantity(
        "mechanics.end_stiffness",
        "Stiffness of each of the two springs of \"spring-held-ends\", such as carbon fibres.",
        Bounds::any(Dimension::Stiffness, "100 nN/um").above(0.0).to(1e8),
        |run| match run.support {
            SupportKind::SpringHeldEnds { stiffness } => Some(stiffness),
            _ => None,
        },
        |run, value| {
            if let SupportKind::SpringHeldEnds { stiffness } = &mut run.support {
                *stiffness = value;
            }
        },
    )
    .option_saying(
        "--end-stiffness",
        "STIFFNESS",
        "Stiffness of each spring of spring-held-ends, such as a carbon fibre",
    ),
    Setting::quantity(
        "mechanics.post_length",
        "Length of each of the posts of \"posts\", from foot to tip.",
        Bounds::any(Dimension::Length, "3000 um").from(1.0).to(1e5),
        |run| post(run).map(|post| post.length),
        |run, length| change_post(run, |post| post.length = length),
    )
    .option_saying("--post-length", "LENGTH", "Length of the posts of support posts"),
    Setting::quantity(
        "mechanics.post_load_height",
        "Height of the tissue above the foot of the posts, at most their length.",
        Bounds::any(Dimension::Length, "2500 um").from(1.0).to(1e5),
        |run| post(run).and_then(|post| post.load_height),
        |run, height| change_post(run, |post| post.load_height = Some(height)),
    )
    .otherwise("at the tip")
    .option_saying(
        "--post-load-height",
        "LENGTH",
        "Height of the tissue above the foot of the posts; unless stated at their tip",
    ),
    Setting::quantity(
        "mechanics.post_width",
        "Width of the posts across the tissue; of round posts their diameter.",
        Bounds::any(Dimension::Length, "1000 um").from(0.1).to(1e5),
        |run| post(run).map(|post| post.width),
        |run, width| change_post(run, |post| post.width = width),
    )
    .option_saying(
        "--post-width",
        "LENGTH",
        "Width of the posts across the tissue; of round posts their diameter",
    ),
    Setting::quantity(
        "mechanics.post_thickness",
        "Thickness of rectangular posts along the tissue, which bends them in it.",
        Bounds::any(Dimension::Length, "500 um").from(0.1).to(1e5),
        |run| post(run).and_then(|post| post.thickness),
        |run, thickness| change_post(run, |post| post.thickness = Some(thickness)),
    )
    .otherwise("round posts")
    .option_saying(
        "--post-thickness",
        "LENGTH",
        "Thickness of rectangular posts along the tissue; unless stated posts are round",
    ),
    Setting::quantity(
        "mechanics.post_modulus",
        "Young's modulus of the posts; that of silicone (PDMS) is 1 to 3 MPa.",
        Bounds::any(Dimension::Pressure, "1600 kPa").from(1e-3).to(1e9),
        |run| post(run).map(|post| post.modulus),
        |run, modulus| change_post(run, |post| post.modulus = modulus),
    )
    .option_saying("--post-modulus", "MODULUS", "Young's modulus of the posts"),
    Setting::quantity(
        "mechanics.bed_stiffness",
        "Stiffness of an \"elastic-bed\", traction per displacement: for a thin layer its shear \
         modulus divided by its thickness.",
        Bounds::any(Dimension::BedStiffness, "0.5 kPa/um").above(0.0).to(1e6),
        |run| match run.support {
            SupportKind::ElasticBed { stiffness } => Some(stiffness),
            _ => None,
        },
        |run, value| {
            if let SupportKind::ElasticBed { stiffness } = &mut run.support {
                *stiffness = value;
            }
        },
    )
    .otherwise("\"0.5 kPa/um\" for an elastic bed, with a warning")
    .option_saying(
        "--bed-stiffness",
        "STIFFNESS",
        "Stiffness of an elastic-bed, such as pillars, traction per displacement",
    ),
    Setting::quantity(
        "mechanics.gel_modulus",
        "Young's modulus of the gel under the cell of \"gel\".",
        Bounds::any(Dimension::Pressure, "10 kPa").from(1e-3).to(1e6),
        |run| gel(run).map(|gel| gel.modulus),
        |run, modulus| change_gel(run, |gel| gel.modulus = modulus),
    )
    .option_saying("--gel-modulus", "MODULUS", "Young's modulus of the gel of support gel"),
    Setting::quantity(
        "mechanics.gel_poisson",
        "Poisson's ratio of the gel: 0.49 of one that keeps its volume, 0.4 to 0.5 of polyacrylamide.",
        Bounds::any(Dimension::Number, "0.49").from(0.0).to(0.499),
        |run| gel(run).map(|gel| gel.poisson),
        |run, poisson| change_gel(run, |gel| gel.poisson = poisson),
    )
    .otherwise("0.49")
    .option_saying("--gel-poisson", "RATIO", "Poisson's ratio of the gel"),
    Setting::quantity(
        "mechanics.gel_thickness",
        "Thickness of the gel, which is bonded to glass; unless stated it is so thick that the glass is not felt.",
        Bounds::any(Dimension::Length, "50 um").from(0.1).to(1e5),
        |run| gel(run).and_then(|gel| gel.thickness),
        |run, thickness| change_gel(run, |gel| gel.thickness = Some(thickness)),
    )
    .option_saying("--gel-thickness", "LENGTH", "Thickness of the gel, bonded to glass"),
    Setting::new(
        "mechanics.adhesion",
        "Where the cell adheres to the gel: \"everywhere\"; \"ends\", a fifth of its length at either end; \"rim\", what lies \
         within 3 um of its outline; or a file, relative to this one: a picture of the same frame as the cell's, such as one \
         of stained focal adhesions, which adheres where it is not black, or a table (.csv) with the header adhesion, a row \
         for each node, or x_um,y_um,adhesion, which adheres where that is above 0. Grey values relative to the largest in \
         the cell, or the values of the table, are factors on `adhesion_stiffness`.",
        ValueKind::File {
            endings: ADHESION_ENDINGS,
            words: Adhesion::WORDS,
            example: "adhesions.tif",
            get: |run| {
                let word = gel(run)?.adhesion.word().to_owned();
                Some(run.adhesion.clone().unwrap_or(word))
            },
            set: |run, text| {
                let word = Adhesion::of_word(&text);
                run.adhesion = (word.is_none() && gel(run).is_some()).then_some(text);
                change_gel(run, |gel| gel.adhesion = word.unwrap_or(Adhesion::Everywhere));
            },
        },
    )
    .otherwise("everywhere")
    .option_saying(
        "--adhesion",
        "WHERE",
        "Where the cell adheres to the gel: everywhere, ends, rim, a picture of the same frame (where it is not black), or a \
         table (.csv: adhesion, or x_um,y_um,adhesion)",
    ),
    Setting::quantity(
        "mechanics.adhesion_stiffness",
        "Stiffness of what ties the cell to the gel, traction per distance; unless stated it does not give way.",
        Bounds::any(Dimension::BedStiffness, "5 kPa/um").from(1e-3).to(1e6),
        |run| gel(run).and_then(|gel| gel.adhesion_stiffness),
        |run, stiffness| change_gel(run, |gel| gel.adhesion_stiffness = Some(stiffness)),
    )
    .option_saying(
        "--adhesion-stiffness",
        "STIFFNESS",
        "Stiffness of what ties the cell to the gel, traction per distance",
    ),
];

/// A post of which nothing is known yet.
const NO_POST: Post =
    Post { length: 0.0, load_height: None, width: 0.0, thickness: None, modulus: 0.0 };

/// The posts at the ends, if there are any.
fn post(run: &Run) -> Option<Post> {
    match run.support {
        SupportKind::Posts(post) => Some(post),
        _ => None,
    }
}

fn change_post(run: &mut Run, change: impl FnOnce(&mut Post)) {
    if let SupportKind::Posts(post) = &mut run.support {
        change(post);
    }
}

/// The gel under the cell, if it is on one.
fn gel(run: &Run) -> Option<Gel> {
    match run.support {
        SupportKind::Gel(gel) => Some(gel),
        _ => None,
    }
}

fn change_gel(run: &mut Run, change: impl FnOnce(&mut Gel)) {
    if let SupportKind::Gel(gel) = &mut run.support {
        change(gel);
    }
}

fn set_fibre(run: &mut Run, value: &Value) -> Result<(), Problem> {
    let text = value.written();
    run.fibre = match text.as_str() {
        AUTO => FibreDirection::Auto(Asked::default()),
        LONG_AXIS => FibreDirection::LongAxis,
        PICTURE => FibreDirection::Picture(FibreSettings::of(Stain::ZDisc)),
        words if !words.contains(|c: char| c.is_ascii_digit()) => {
            let known = [AUTO, PICTURE, LONG_AXIS, "an angle like 15 deg"];
            return Err(Problem::unknown_word(FIBRE, words, known));
        }
        _ => FibreDirection::Angle(FIBRE_ANGLE.read(FIBRE, value)?),
    };
    Ok(())
}

fn support_name(support: SupportKind) -> SupportName {
    match support {
        SupportKind::MassCentre => SupportName::MassCentre,
        SupportKind::ClampedEnd => SupportName::ClampedEnd,
        SupportKind::ClampedEnds => SupportName::ClampedEnds,
        SupportKind::AfterloadedEnds { .. } => SupportName::AfterloadedEnds,
        SupportKind::SpringHeldEnds { .. } => SupportName::SpringHeldEnds,
        SupportKind::Posts(_) => SupportName::Posts,
        SupportKind::Gel(_) => SupportName::Gel,
        SupportKind::ElasticBed { .. } => SupportName::ElasticBed,
    }
}

/// The support with this name; the rules of run files require the stiffness of springs at the ends, the load, or the modulus
/// of the gel.
fn support(name: SupportName) -> SupportKind {
    match name {
        SupportName::MassCentre => SupportKind::MassCentre,
        SupportName::ClampedEnd => SupportKind::ClampedEnd,
        SupportName::ClampedEnds => SupportKind::ClampedEnds,
        SupportName::AfterloadedEnds => SupportKind::AfterloadedEnds { load: 0.0 },
        SupportName::SpringHeldEnds => SupportKind::SpringHeldEnds { stiffness: 0.0 },
        SupportName::Posts => SupportKind::Posts(NO_POST),
        SupportName::Gel => SupportKind::Gel(Gel::half_space(0.0)),
        SupportName::ElasticBed => SupportKind::ElasticBed { stiffness: USUAL_BED },
    }
}
