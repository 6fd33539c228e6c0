//! GeoJSON with any number of cells, in um or pixels.

use geojson::{Feature, FeatureCollection, GeoJson, Geometry, GeometryValue, JsonObject, Position};
use serde_json::{Value, json};

use super::{CoordinateUnit, NamedOutline, OutlineFileError, Raw};

/// Reads every polygon of a GeoJSON, or of a bare list of features as QuPath also writes.
pub(super) fn read(
    bytes: &[u8],
    silent_unit: CoordinateUnit,
    notes: &mut Vec<String>,
) -> Result<Vec<Raw>, OutlineFileError> {
    let failed = |reason: String| OutlineFileError::NotGeoJson { reason };
    let text = std::str::from_utf8(bytes).map_err(|error| failed(error.to_string()))?;
    let text = text.trim_start_matches('\u{feff}').trim_start();
    let (features, foreign) = if text.starts_with('[') {
        let features = serde_json::from_str::<Vec<Feature>>(text);
        (features.map_err(|error| failed(error.to_string()))?, None)
    } else {
        match text.parse().map_err(|error: geojson::Error| failed(error.to_string()))? {
            GeoJson::FeatureCollection(all) => (all.features, all.foreign_members),
            GeoJson::Feature(feature) => (vec![feature], None),
            GeoJson::Geometry(geometry) => (vec![geometry.into()], None),
        }
    };
    let whole_file = match foreign.as_ref().and_then(|members| members.get("unit")) {
        Some(unit) => unit_of(unit, "the collection")?,
        None => silent_unit,
    };
    let mut outlines = Vec::new();
    for (index, feature) in features.into_iter().enumerate() {
        let name = name(&feature, index);
        let unit = match (feature.property("unit"), feature.property("objectType")) {
            (Some(unit), _) => unit_of(unit, &name)?,
            (None, Some(_)) if foreign_unit(foreign.as_ref()).is_none() => CoordinateUnit::Pixel,
            _ => whole_file,
        };
        let mut polygons = Vec::new();
        if let Some(geometry) = feature.geometry {
            collect(geometry.value, &mut polygons, &mut |kind| {
                notes.push(format!("`{name}` is a {kind} and was left out"));
            });
        }
        let several = polygons.len() > 1;
        for (part, rings) in polygons.into_iter().enumerate() {
            let name = if several { format!("{name}-{}", part + 1) } else { name.clone() };
            outlines.push(Raw {
                name,
                unit,
                rings: rings.iter().map(|ring| points(ring)).collect(),
            });
        }
    }
    Ok(outlines)
}

fn foreign_unit(members: Option<&JsonObject>) -> Option<&Value> {
    members.and_then(|members| members.get("unit"))
}

fn unit_of(unit: &Value, name: &str) -> Result<CoordinateUnit, OutlineFileError> {
    let unit = unit.as_str().map_or_else(|| unit.to_string(), str::to_owned);
    match unit.as_str() {
        "um" | "µm" | "μm" | "micrometre" | "micrometer" | "micron" => {
            Ok(CoordinateUnit::Micrometre)
        }
        "pixel" | "pixels" | "px" => Ok(CoordinateUnit::Pixel),
        _ => Err(OutlineFileError::Unit { name: name.to_owned(), unit }),
    }
}

/// The property `name`, else the property or member `id`, else the position in the file, counted
/// from 1.
fn name(feature: &Feature, index: usize) -> String {
    let text = |value: &Value| match value {
        Value::String(text) if !text.trim().is_empty() => Some(text.trim().to_owned()),
        Value::Number(number) => Some(number.to_string()),
        _ => None,
    };
    let property = |key| feature.property(key).and_then(text);
    let id = || match &feature.id {
        Some(geojson::feature::Id::String(id)) => Some(id.clone()),
        Some(geojson::feature::Id::Number(id)) => Some(id.to_string()),
        None => None,
    };
    property("name")
        .or_else(|| property("id"))
        .or_else(id)
        .unwrap_or_else(|| (index + 1).to_string())
}

/// A local plane in um, as well-known text: the form of `crs` that GDAL, and with it geopandas, reads.
const MICROMETRES: &str =
    r#"LOCAL_CS["picture",UNIT["micrometre",1e-06],AXIS["x",EAST],AXIS["y",NORTH]]"#;

type Rings = Vec<Vec<Position>>;

fn collect(value: GeometryValue, polygons: &mut Vec<Rings>, left_out: &mut impl FnMut(&str)) {
    match value {
        GeometryValue::Polygon { coordinates } => polygons.push(coordinates),
        GeometryValue::MultiPolygon { coordinates } => polygons.extend(coordinates),
        GeometryValue::GeometryCollection { geometries } => {
            for Geometry { value, .. } in geometries {
                // The recursion is bounded by the parser's depth limit.
                collect(value, polygons, left_out);
            }
        }
        GeometryValue::Point { .. } => left_out("Point"),
        GeometryValue::MultiPoint { .. } => left_out("MultiPoint"),
        GeometryValue::LineString { .. } => left_out("LineString"),
        GeometryValue::MultiLineString { .. } => left_out("MultiLineString"),
    }
}

fn points(ring: &[Position]) -> Vec<[f64; 2]> {
    let at = |position: &Position, axis| position.as_slice().get(axis).copied().unwrap_or(f64::NAN);
    ring.iter().map(|position| [at(position, 0), at(position, 1)]).collect()
}

/// Writes outlines as a GeoJSON `FeatureCollection` in um, y upward, each with its name and `unit:
/// um`. Reading it back gives the same numbers.
///
/// # Example
/// ```
/// use myospring::mesh::built_in;
/// use myospring::microscopy::outlines::{NamedOutline, write_geojson};
/// let cell = NamedOutline { name: "a".to_owned(), outline: built_in::adult_ventricular() };
/// assert!(write_geojson(&[cell]).contains(r#""name":"a""#));
/// ```
pub fn write_geojson(cells: &[NamedOutline]) -> String {
    let feature = |cell: &NamedOutline| {
        let ring = |ring: &[[f64; 2]]| {
            ring.iter().chain(ring.first()).map(|&point| Position::from(point)).collect()
        };
        let coordinates = cell.outline.rings().map(ring).collect();
        let geometry = Some(Geometry::new(GeometryValue::Polygon { coordinates }));
        let mut feature = Feature { geometry, ..Feature::default() };
        feature.set_property("name", cell.name.clone());
        feature.set_property("unit", "um");
        feature
    };
    let features = cells.iter().map(feature).collect();
    // Without it, GIS programs read the coordinates as degrees.
    let crs = json!({ "type": "name", "properties": { "name": MICROMETRES } });
    let foreign_members = Some(JsonObject::from_iter([("crs".to_owned(), crs)]));
    GeoJson::from(FeatureCollection { bbox: None, features, foreign_members }).to_string()
}
