//! The stretch of each triangle at rest, from the length of its sarcomeres.
//!
//! The stretch of a cell model is relative to a reference length of the sarcomere, which must be
//! stated. Sarcomeres of another length have the stretch `length / reference` in the cell at rest.
//! The shape at rest is that of the picture: longer sarcomeres do not change it, but their
//! myofilaments start at another point of the force-length relation.

use super::fibres::Fibres;
use super::places::{self, Column, FromPlaces, Part, PlacesError};
use crate::mesh::Mesh;
use std::io;

/// Endings of files with lengths of sarcomeres, without the dot.
pub const SARCOMERE_ENDINGS: &[&str] = &["csv"];

const COLUMN: Column = Column {
    name: "sarcomere_um",
    of: "the length of sarcomeres",
    within: 0.5..=5.0,
    must: "a length from 0.5 to 5 um",
    part: Part::Triangle,
};

/// Why the stretch at rest cannot be determined.
#[derive(Debug, thiserror::Error)]
pub enum SarcomereError {
    /// There is no sarcomere length from which to determine it.
    #[error(
        "the length of sarcomeres cannot be taken from the picture, because none was read from it{reason}; use \
         --sarcomere-length uniform, or a table"
    )]
    NotRead {
        /// Why, after a colon; may be empty.
        reason: String,
    },
    /// The table is not valid.
    #[error(transparent)]
    Table(#[from] PlacesError),
    /// A stretch out of range.
    #[error(
        "sarcomeres of {length_um} um are {stretch:.2} times sarcomere_reference = {reference_um} um; it must be 0.5 to \
         1.5 of it"
    )]
    Stretch {
        /// The length, um.
        length_um: f64,
        /// The reference, um.
        reference_um: f64,
        /// Their ratio.
        stretch: f64,
    },
}

/// The stretch of each triangle at rest, and a note; `None` if it is 1 everywhere.
pub(super) fn resting_stretch(
    lengths: &FromPlaces,
    reference_um: f64,
    mesh: &Mesh,
    fibres: &Fibres,
    read: impl Fn(&str) -> io::Result<Vec<u8>>,
) -> Result<Option<(Vec<f64>, String)>, SarcomereError> {
    let lengths = match lengths {
        FromPlaces::Uniform => return Ok(None),
        FromPlaces::Picture => of_fibres(fibres, mesh)?,
        FromPlaces::File(path) => places::read_table(path, &COLUMN, mesh, read)?,
    };
    let wrong = lengths.iter().find(|length| !(0.5..=1.5).contains(&(*length / reference_um)));
    if let Some(&length_um) = wrong {
        let stretch = length_um / reference_um;
        return Err(SarcomereError::Stretch { length_um, reference_um, stretch });
    }
    let of = |most: fn(f64, f64) -> f64| lengths.iter().copied().reduce(most).unwrap_or_default();
    let [least, most] = [of(f64::min), of(f64::max)];
    let told = format!(
        "sarcomeres at rest are {least:.2} to {most:.2} um, {:.3} to {:.3} of the {reference_um} um at which the \
         myofilaments' stretch is assumed to be 1",
        least / reference_um,
        most / reference_um
    );
    Ok(Some((lengths.into_iter().map(|length| length / reference_um).collect(), told)))
}

fn of_fibres(fibres: &Fibres, mesh: &Mesh) -> Result<Vec<f64>, SarcomereError> {
    let seen = fibres.seen.iter().flat_map(|seen| &seen.triangles);
    let centres = Part::Triangle.places(mesh);
    let read =
        centres.iter().zip(seen).filter_map(|(centre, place)| Some((*centre, place.sarcomere_um?)));
    let (points, lengths): (Vec<_>, Vec<_>) = read.unzip();
    if points.is_empty() {
        let reason = fibres.not_read.map(|reason| format!(": {reason}")).unwrap_or_default();
        return Err(SarcomereError::NotRead { reason });
    }
    Ok(places::nearest(&points, &lengths, &centres))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::lattice;
    use crate::settings::FibreDirection;

    #[test]
    fn lengths_over_the_reference_are_the_stretch_at_rest_and_gaps_take_the_nearest() {
        let mesh = lattice::rectangle(2, 1, 1.0).unwrap();
        let fibres = FibreDirection::LongAxis.on(&mesh, None).unwrap();
        let lengths = FromPlaces::of("fibres.csv".to_owned());
        let stretch = |text: &'static str, reference: f64| {
            resting_stretch(&lengths, reference, &mesh, &fibres, |_| Ok(text.into()))
        };
        // As the program writes fibres.csv, with a place that was not read.
        let text = "x_um,y_um,direction_deg,sarcomere_um,order,coverage\n0.5,0.5,0,1.9,0.8,1\n\
                    0.9,0.5,0,,0.1,0\n1.5,0.5,0,1.7,0.8,1\n";
        let (found, told) = stretch(text, 1.9).unwrap().unwrap();
        for (triangle, found) in mesh.simplices.iter().zip(found) {
            let left = mesh.centre(triangle)[0] < 1.0;
            assert_eq!(found, if left { 1.0 } else { 1.7 / 1.9 });
        }
        assert!(told.contains("1.70 to 1.90 um, 0.895 to 1.000 of the 1.9 um"), "{told}");
        for (text, message) in [
            (
                "x_um,y_um,sarcomere_um\n0.5,0.5,19\n",
                "line 2: sarcomere_um is 19; it must be a length",
            ),
            ("x_um,y_um,sarcomere_um\n0.5,0.5,0.8\n", "0.42 times sarcomere_reference = 1.9 um"),
            ("x_um,y_um,sarcomere_um\n0.5,0.5,\n", "has 0 rows"),
            ("sarcomere_um\n1.9\n", "the mesh has 8 triangles"),
            ("length\n1.9\n", "has the header `sarcomere_um`"),
        ] {
            let error = stretch(text, 1.9).unwrap_err().to_string();
            assert!(error.contains(message), "{message}: {error}");
        }
        let picture = FromPlaces::Picture;
        let error = resting_stretch(&picture, 1.9, &mesh, &fibres, |_| Ok(Vec::new())).unwrap_err();
        assert!(error.to_string().contains("none was read from it"), "{error}");
        let uniform = FromPlaces::Uniform;
        assert!(
            resting_stretch(&uniform, 1.9, &mesh, &fibres, |_| Ok(Vec::new())).unwrap().is_none()
        );
    }
}
