//! The fibres of cells as comma-separated values, one row per triangle.

use crate::csv::{CsvError, number};

/// The fibre in one triangle of a mesh.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FibreRow {
    /// Centre of the triangle, um from the lower left corner of the picture, y upward.
    pub point_um: [f64; 2],
    /// Degrees counter-clockwise from x, y upward, above -90 and up to 90; `None` if the picture
    /// shows no direction.
    pub direction_deg: Option<f64>,
    /// Length of a sarcomere, um.
    pub sarcomere_um: Option<f64>,
    /// Whether that length is doubtful.
    pub sarcomere_doubtful: Option<bool>,
    /// How sharply the picture shows one direction and one period, 0 to 1.
    pub order: Option<f64>,
    /// Part of the neighbourhood within the cell that shows a direction, 0 to 1.
    pub coverage: Option<f64>,
}

/// Columns of `fibres.csv` in their order.
const COLUMNS: [&str; 7] =
    ["x_um", "y_um", "direction_deg", "sarcomere_um", "order", "coverage", "sarcomere_doubtful"];

/// The fibres of cells, each with its name, as the text of `fibres.csv`: one row per triangle, in
/// the order of the mesh. With several cells, the first column, `cell`, has their names. Unknown
/// values are empty.
///
/// # Errors
/// A row that cannot be written.
///
/// # Example
/// ```
/// use myospring::output::fibres::{FibreRow, to_csv};
/// let read = FibreRow { point_um: [1.5, 2.0], direction_deg: Some(-15.0), ..FibreRow::default() };
/// assert_eq!(
///     to_csv(&[("1", vec![read])])?,
///     "x_um,y_um,direction_deg,sarcomere_um,order,coverage,sarcomere_doubtful\n1.5,2,-15,,,,\n"
/// );
/// # Ok::<(), myospring::output::csv::CsvError>(())
/// ```
pub fn to_csv(cells: &[(&str, Vec<FibreRow>)]) -> Result<String, CsvError> {
    let named = cells.len() > 1;
    let mut writer = ::csv::Writer::from_writer(Vec::new());
    let header = named.then_some("cell").into_iter().chain(COLUMNS);
    writer.write_record(header).map_err(|source| CsvError::Row { row: 0, source })?;
    let rows = cells.iter().flat_map(|(name, rows)| rows.iter().map(move |row| (*name, row)));
    let mut written = 0;
    for (name, row) in rows {
        let [x, y] = row.point_um.map(Some);
        let doubtful = row.sarcomere_doubtful.map(|is| f64::from(u8::from(is)));
        let values = [x, y, row.direction_deg, row.sarcomere_um, row.order, row.coverage, doubtful];
        let values = values.map(|value| value.map_or_else(String::new, number));
        let name = named.then(|| name.to_owned());
        writer
            .write_record(name.into_iter().chain(values))
            .map_err(|source| CsvError::Row { row: written, source })?;
        written += 1;
    }
    let bytes = writer
        .into_inner()
        .map_err(|error| CsvError::Row { row: written, source: error.into_error().into() })?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn several_cells_have_a_column_with_their_names() {
        let row = FibreRow { coverage: Some(0.25), ..FibreRow::default() };
        let text = to_csv(&[("left, upper", vec![row; 2]), ("2", vec![row])]).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(
            lines[0],
            "cell,x_um,y_um,direction_deg,sarcomere_um,order,coverage,sarcomere_doubtful"
        );
        assert_eq!(lines[1], "\"left, upper\",0,0,,,,0.25,");
        assert_eq!(lines[3], "2,0,0,,,,0.25,");
        assert_eq!(lines.len(), 4);
    }
}
