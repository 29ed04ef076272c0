//! Units of layers: those that files state are converted, and values that are likely in another one are doubted.

use super::kind::{CANOPY, FLAT, LayerKind, PERCENT_SLOPE, has_code};
use wildfire_base::geometry::ops;
use wildfire_grid::map_files::raster::crs::{FOOT_M, US_SURVEY_FOOT_M};
use wildfire_grid::map_files::raster::{Band, Raster};

/// Between which numbers the greatest of each layer of trees lies in a forest, the name and size of its unit, and the scale
/// that makes it of the likely other one.
const USUAL_CANOPY: [([f32; 2], &str, f64, &str); 4] = [
    ([60.0, 800.0], "m", 0.1, "10"),
    ([10.0, 400.0], "m", 0.1, "10"),
    ([3.0, 100.0], "kg/m3", 0.01, "100"),
    ([10.0, 100.0], "%", 1.0, "100"),
];

/// Kilogrammes per cubic metre in a pound per cubic foot.
const KG_M3_PER_LB_FT3: f64 = 16.018_463_373_960_14;

impl LayerKind {
    /// Returns the values of a band in the units of LANDFIRE: metres, degrees, percent, tenths of metres, hundredths of kg/m3.
    /// Without a unit they are in these.
    pub(super) fn converted(self, band: &Band) -> Result<Raster, String> {
        let of_name = band.name.as_ref().filter(|name| self == Self::Slope && has_code(name, PERCENT_SLOPE));
        let of_heights = band.height_unit.as_deref().filter(|_| self == Self::Elevation);
        let stated = band.unit.as_deref().or(of_heights).or(of_name.map(|_| "percent"));
        let mut raster = band.raster.clone();
        // Fuel numbers have no unit, whatever a file says.
        let Some(unit) = stated.filter(|unit| !unit.trim().is_empty() && self != Self::Fuel) else { return Ok(raster) };
        let convert = self.conversion(unit).ok_or_else(|| {
            let unit = wildfire_base::untrusted::visible_start(unit);
            format!(
                "its unit is `{unit}`, which is not known for the {}; expected {}, or none (gdal_edit.py -units NAME in.tif \
                 sets it)",
                self.names().1,
                match self {
                    Self::Slope => "degree or percent",
                    Self::Aspect => "degree",
                    Self::Canopy(2) => "kg/m3 or lb/ft3",
                    Self::Canopy(3) => "percent",
                    _ => "metre or foot",
                }
            )
        })?;
        for index in 0..raster.values.len() {
            let value = raster.values[index];
            // A converted NODATA value would be taken for data.
            if !raster.is_nodata(value) {
                raster.values[index] = convert(value.into()) as f32;
            }
        }
        Ok(raster)
    }

    /// Returns what makes values of the units of LANDFIRE out of those of a unit; `None` if it is not known.
    fn conversion(self, unit: &str) -> Option<Box<dyn Fn(f64) -> f64>> {
        let unit = unit.trim().to_lowercase();
        let (base, parts) = unit.rsplit_once(" x ").map_or((&unit[..], "1"), |(base, parts)| (base, parts));
        // A part that is not a number makes the size NaN, which is refused below.
        let size = length_m(base).map(|size| size / parts.parse::<f64>().unwrap_or(f64::NAN));
        let percent = ["%", "percent", "per cent"].contains(&base);
        let degrees = ["degree", "degrees", "deg", "\u{b0}", "azimuth degrees"].contains(&base);
        let radians = ["rad", "radian", "radians"].contains(&base);
        Some(match self {
            Self::Elevation => {
                let size = size.filter(|size| size.is_finite())?;
                Box::new(move |length| size * length)
            }
            Self::Canopy(0 | 1) => {
                // Canopy heights are whole tenths of metres here.
                let tenths = 10.0 * size.filter(|size| size.is_finite())?;
                Box::new(move |length| (tenths * length).round())
            }
            Self::Canopy(2) => {
                let size = match base {
                    "kg/m3" | "kg/m^3" | "kg m-3" | "kg/m\u{b3}" => 1.0,
                    "lb/ft3" | "lb/ft^3" => KG_M3_PER_LB_FT3,
                    _ => return None,
                };
                let hundredths = 100.0 * size / parts.parse::<f64>().ok()?;
                Box::new(move |density| (hundredths * density).round())
            }
            Self::Canopy(_) if ["fraction", "share", "1"].contains(&base) => Box::new(|share| (100.0 * share).round()),
            Self::Slope if percent => Box::new(|percent| ops::atan2(percent, 100.0).to_degrees()),
            Self::Slope | Self::Aspect if radians => Box::new(f64::to_degrees),
            // Counter-clockwise from east, 0 where the ground is flat (GRASS GIS, r.slope.aspect).
            Self::Aspect if base == "grass degrees" => {
                Box::new(|angle| if angle == 0.0 { FLAT.into() } else { (450.0 - angle) % 360.0 })
            }
            Self::Canopy(_) if percent => Box::new(|value| value),
            Self::Slope | Self::Aspect if degrees => Box::new(|value| value),
            Self::Fuel => Box::new(|value| value),
            _ => return None,
        })
    }
}

/// Returns the metres of a unit of length by its name in lower case.
fn length_m(unit: &str) -> Option<f64> {
    Some(match unit {
        "m" | "metre" | "metres" | "meter" | "meters" => 1.0,
        "dm" | "decimetre" | "decimetres" | "decimeter" | "decimeters" => 0.1,
        "cm" | "centimetre" | "centimetres" | "centimeter" | "centimeters" => 0.01,
        "mm" | "millimetre" | "millimetres" | "millimeter" | "millimeters" => 0.001,
        "km" | "kilometre" | "kilometres" | "kilometer" | "kilometers" => 1000.0,
        "ft" | "foot" | "feet" | "international foot" | "international feet" => FOOT_M,
        "us survey foot" | "us survey feet" | "us-ft" | "ftus" | "foot_us" | "us foot" | "us feet" => US_SURVEY_FOOT_M,
        _ => return None,
    })
}

/// Says that the trees of a raster without a unit are of another size than those of a forest.
pub(super) fn doubt_of_trees(place: usize, values: &[f32], name: &str) -> Option<String> {
    let (usual, unit, size, scale) = USUAL_CANOPY[place];
    let greatest = values.iter().copied().fold(0.0, f32::max);
    if greatest == 0.0 || (usual[0]..=usual[1]).contains(&greatest) {
        return None;
    }
    let found = (f64::from(greatest) * size * 100.0).round() / 100.0;
    let text = LayerKind::Canopy(place).names().1;
    let advice = if greatest < usual[0] {
        format!(
            "; if it is not in that unit, gdal_translate -a_scale {scale} in.tif out.tif converts {}",
            ["metres", "metres", "kg/m3", "shares"][place]
        )
    } else {
        String::new()
    };
    let of = CANOPY[place].1.split_once(" in ").and_then(|(_, unit)| unit.split(',').next()).unwrap_or_default();
    Some(format!("{name}: the greatest {text} is {found} {unit}, as the raster was read in {of}{advice}."))
}
