//! Outlines as text: reads and writes GeoJSON, reads lists of points.

use geojson::{Feature, GeoJson, Geometry, GeometryValue, Position};

use super::error::CURVE;
use super::{Outline, OutlineError};

/// From this number of points on, an outline cannot run in one direction only.
const ONE_WAY: usize = 8;

impl Outline {
    /// Reads GeoJSON with exactly one `Polygon`: bare, in a `Feature`, a collection, or a
    /// `MultiPolygon` of one.
    ///
    /// Coordinates are micrometres, y upward. A property `unit`, if present, must be `um`.
    ///
    /// # Errors
    /// Text that is not GeoJSON, no polygon or several, another unit, or what [`Outline::new`]
    /// rejects.
    ///
    /// # Example
    /// ```
    /// use myospring::mesh::outline::Outline;
    /// let text = r#"{"type": "Polygon", "coordinates": [[[0,0], [9,0], [9,9], [0,9], [0,0]]]}"#;
    /// assert_eq!(Outline::from_geojson(text).unwrap().area(), 81.0);
    /// ```
    pub fn from_geojson(text: &str) -> Result<Self, OutlineError> {
        let parsed: GeoJson = text.parse().map_err(|error: geojson::Error| {
            OutlineError::NotGeoJson { reason: error.to_string() }
        })?;
        let mut polygons = Vec::new();
        let mut kinds = Vec::new();
        match parsed {
            GeoJson::Geometry(geometry) => collect(geometry, &mut polygons, &mut kinds),
            GeoJson::Feature(feature) => collect_feature(feature, &mut polygons, &mut kinds)?,
            GeoJson::FeatureCollection(all) => {
                for feature in all.features {
                    collect_feature(feature, &mut polygons, &mut kinds)?;
                }
            }
        }
        let found = polygons.len();
        let (Some(rings), 1) = (polygons.pop(), found) else {
            let kinds = if kinds.is_empty() { "no geometry".to_owned() } else { kinds.join(", ") };
            return Err(OutlineError::NotOnePolygon { found, kinds });
        };
        let mut rings = rings.into_iter().map(|ring| {
            ring.iter()
                .map(|position| {
                    let at = |axis| position.as_slice().get(axis).copied().unwrap_or(f64::NAN);
                    [at(0), at(1)]
                })
                .collect::<Vec<_>>()
        });
        let exterior = rings.next().unwrap_or_default();
        Self::new(exterior, rings.collect())
    }

    /// Reads a list of points, one `x,y` per line in um, y upward; a header line, blank lines and
    /// lines that start with `#` are skipped; comma, semicolon, tab or spaces separate the columns.
    /// A header must name x and y.
    ///
    /// # Errors
    /// A header of other columns, a line that is not two numbers, points that run in one direction
    /// only, or what [`Outline::new`] rejects.
    ///
    /// # Example
    /// ```
    /// use myospring::mesh::outline::Outline;
    /// let outline = Outline::from_csv("x_um,y_um\n0,0\n9,0\n9,9\n0,9\n").unwrap();
    /// assert_eq!(outline.perimeter(), 36.0);
    /// ```
    pub fn from_csv(text: &str) -> Result<Self, OutlineError> {
        let mut points = Vec::new();
        let mut first = true;
        for (index, line) in text.trim_start_matches('\u{feff}').lines().enumerate() {
            let line = line.trim();
            if line.is_empty() || line.starts_with('#') {
                continue;
            }
            let fields: Vec<&str> = line
                .split([',', ';', '\t', ' '])
                .map(|field| field.trim().trim_matches('"'))
                .filter(|field| !field.is_empty())
                .collect();
            let numbers: Vec<f64> = fields.iter().filter_map(|field| field.parse().ok()).collect();
            if let (2, [x, y]) = (fields.len(), numbers.as_slice()) {
                points.push([*x, *y]);
            } else if first && numbers.is_empty() {
                check_header(line)?;
            } else {
                let text = line.chars().take(60).collect();
                return Err(OutlineError::NotAPoint { line: index + 1, text });
            }
            first = false;
        }
        let steps = || points.windows(2).map(|pair| pair[1][0] - pair[0][0]);
        if points.len() >= ONE_WAY
            && (steps().all(|step| step > 0.0) || steps().all(|step| step < 0.0))
        {
            return Err(OutlineError::OneWay { points: points.len() });
        }
        Self::new(points, Vec::new())
    }

    /// Writes the outline as a GeoJSON `Feature` with the property `unit: um`.
    ///
    /// # Example
    /// ```
    /// use myospring::mesh::{built_in, outline::Outline};
    /// let cell = built_in::adult_ventricular();
    /// assert_eq!(Outline::from_geojson(&cell.to_geojson()).unwrap(), cell);
    /// ```
    pub fn to_geojson(&self) -> String {
        let coordinates = self
            .rings()
            .map(|ring| {
                ring.iter().chain(ring.first()).map(|&point| Position::from(point)).collect()
            })
            .collect();
        let mut feature = Feature {
            geometry: Some(Geometry::new(GeometryValue::Polygon { coordinates })),
            ..Feature::default()
        };
        feature.set_property("unit", "um");
        feature.to_string()
    }
}

/// Rejects a header that does not name x and y in um.
fn check_header(line: &str) -> Result<(), OutlineError> {
    let parted = |by: &[char]| -> Vec<String> {
        let names = line.split(by).map(|name| name.trim().trim_matches('"'));
        names.filter(|name| !name.is_empty()).map(str::to_owned).collect()
    };
    let mut names = parted(&[',', ';', '\t']);
    if names.len() == 1 {
        names = parted(&[' ']);
    }
    let plain: Vec<String> = names
        .iter()
        .map(|name| name.to_lowercase().chars().filter(|c| c.is_alphanumeric()).collect())
        .collect();
    let is = |name: &String, axis: &str| {
        let of_other_unit =
            ["mm", "nm", "px", "pixel", "pixels"].iter().any(|unit| name.ends_with(unit));
        name.starts_with(axis) && !of_other_unit
    };
    if let [x, y] = plain.as_slice()
        && is(x, "x")
        && is(y, "y")
    {
        return Ok(());
    }
    let in_time =
        plain.first().is_some_and(|name| name.starts_with('t') || name.starts_with("frame"));
    let columns = names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
    Err(OutlineError::Columns { columns, curve: if in_time { CURVE } else { "" } })
}

fn collect_feature(
    feature: Feature,
    polygons: &mut Vec<Vec<Vec<Position>>>,
    kinds: &mut Vec<&'static str>,
) -> Result<(), OutlineError> {
    if let Some(unit) = feature.property("unit") {
        let unit = unit.as_str().map_or_else(|| unit.to_string(), str::to_owned);
        if !["um", "µm", "μm", "micrometre", "micrometer", "micron"].contains(&unit.as_str()) {
            return Err(OutlineError::Unit { unit });
        }
    }
    if let Some(geometry) = feature.geometry {
        collect(geometry, polygons, kinds);
    }
    Ok(())
}

fn collect(
    geometry: Geometry,
    polygons: &mut Vec<Vec<Vec<Position>>>,
    kinds: &mut Vec<&'static str>,
) {
    kinds.push(kind(&geometry.value));
    match geometry.value {
        GeometryValue::Polygon { coordinates } => polygons.push(coordinates),
        GeometryValue::MultiPolygon { coordinates } => polygons.extend(coordinates),
        GeometryValue::GeometryCollection { geometries } => {
            for member in geometries {
                collect(member, polygons, kinds);
            }
        }
        _ => {}
    }
}

/// GeoJSON's name of a kind of geometry.
fn kind(value: &GeometryValue) -> &'static str {
    match value {
        GeometryValue::Point { .. } => "Point",
        GeometryValue::MultiPoint { .. } => "MultiPoint",
        GeometryValue::LineString { .. } => "LineString",
        GeometryValue::MultiLineString { .. } => "MultiLineString",
        GeometryValue::Polygon { .. } => "Polygon",
        GeometryValue::MultiPolygon { .. } => "MultiPolygon",
        GeometryValue::GeometryCollection { .. } => "GeometryCollection",
    }
}
