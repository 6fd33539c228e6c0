//! Outlines as text: GeoJSON read and written, lists of points read.

use geojson::{Feature, GeoJson, Geometry, GeometryValue, Position};

use super::{Outline, OutlineError};

impl Outline {
    /// Reads GeoJSON with exactly one `Polygon`: bare, in a `Feature`, a collection, or a
    /// `MultiPolygon` of one.
    ///
    /// Coordinates are micrometres, y upward. A property `unit`, where there is one, must say `um`.
    ///
    /// # Errors
    /// Text that is not GeoJSON, no polygon or several, another unit, or what [`Outline::new`]
    /// refuses.
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
    /// lines that start with `#` are skipped; comma, semicolon, tab or spaces part the columns.
    ///
    /// # Errors
    /// A line that is not two numbers, or what [`Outline::new`] refuses.
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
            } else if !(first && numbers.is_empty()) {
                let text = line.chars().take(60).collect();
                return Err(OutlineError::NotAPoint { line: index + 1, text });
            }
            first = false;
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

/// The name that GeoJSON gives to a kind of geometry.
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
