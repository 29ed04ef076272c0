//! Coordinate systems of map files: what their numbers measure, and what makes metres of them.
//!
//! Sources: Open Geospatial Consortium, "OGC GeoTIFF Standard", version 1.1, 2019, chapter 7; IOGP, "EPSG Geodetic Parameter
//! Dataset", version 12.029, 2025, for the lists of numbers; J. P. Snyder, "Map Projections: A Working Manual", U.S.
//! Geological Survey Professional Paper 1395, 1987, chapters 7 and 8.

use std::ops::RangeInclusive;

use wildfire_base::geometry::ops;

use super::GeoKeys;

/// The international foot in metres, by definition.
pub const FOOT_M: f64 = 0.3048;
/// The US survey foot in metres, by definition.
pub const US_SURVEY_FOOT_M: f64 = 1200.0 / 3937.0;

/// The radius of the sphere of the web's Mercator projection, metres.
const WEB_RADIUS_M: f64 = 6_378_137.0;

/// Numbers of the web's Mercator projection: EPSG's, retired ones, and Esri's.
const WEB_MERCATOR: [u32; 5] = [3857, 3785, 900_913, 102_100, 102_113];
/// Other projections of the whole Earth onto a cylinder about the equator.
const CYLINDERS: [u32; 13] = [3395, 3832, 3410, 3786, 3975, 4087, 4088, 6933, 32_662, 32_663, 41_001, 54_001, 54_004];

/// Geo keys, and their values.
const MODEL_TYPE: u16 = 1024;
const GEOGRAPHIC_SYSTEM: u16 = 2048;
const PROJECTED_SYSTEM: u16 = 3072;
const PROJECTION_METHOD: u16 = 3075;
const LINEAR_UNITS: u16 = 3076;
const VERTICAL_SYSTEM: u16 = 4096;
const VERTICAL_UNITS: u16 = 4099;
const PROJECTED: u16 = 1;
const METRE: u16 = 9001;
const FOOT: u16 = 9002;
const US_SURVEY_FOOT: u16 = 9003;
/// Methods of projection: Mercator's, equirectangular, cylindrical of equal area.
const CYLINDER_METHODS: [u16; 3] = [7, 17, 28];
/// What stands for a custom value, and for none.
const USER_DEFINED: u16 = 32_767;
const UNDEFINED: u16 = 0;

/// Heights in feet: national and local vertical systems of the United States, Hong Kong and the Cayman Islands.
const HEIGHTS_IN_FEET: [u16; 7] = [5614, 6130, 6131, 6132, 8050, 8051, 8228];
const HEIGHTS_IN_US_SURVEY_FEET: [u16; 8] = [5702, 6358, 6359, 6360, 8052, 8053, 8897, 10_919];

/// What pairs of coordinates measure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Coordinates {
    /// Longitude and latitude.
    Degrees,
    /// Lengths on the ground, or nearly so, in units of so many metres.
    Lengths { unit_m: f64 },
    /// Metres of the web's Mercator projection, which are shorter on the ground by the cosine of the latitude.
    WebMercator,
    /// A projection of the whole Earth whose scale depends on the place, or lengths in a rare unit.
    Unusable,
}

/// The description of a coordinate system, as far as a text gives it.
#[derive(Clone, Copy, Debug, Default)]
pub struct SpatialReference {
    pub coordinates: Option<Coordinates>,
    /// The unit of heights in metres.
    pub height_unit_m: Option<f64>,
}

impl Coordinates {
    pub const METRES: Self = Self::Lengths { unit_m: 1.0 };

    /// Returns what the system of this number in the list of EPSG measures; metres if the list has no such system.
    pub fn of_epsg(number: u32) -> Self {
        let is_in = |list: &str| list.split(' ').filter_map(span).any(|span| span.contains(&number));
        match number {
            _ if WEB_MERCATOR.contains(&number) => Self::WebMercator,
            _ if CYLINDERS.contains(&number) || is_in(OTHER_UNITS) => Self::Unusable,
            _ if is_in(GEOGRAPHIC) => Self::Degrees,
            _ if is_in(FEET) => Self::Lengths { unit_m: FOOT_M },
            _ if is_in(US_SURVEY_FEET) => Self::Lengths { unit_m: US_SURVEY_FOOT_M },
            _ => Self::METRES,
        }
    }

    /// Returns what the system of a name measures, such as `urn:ogc:def:crs:EPSG::32611`, `EPSG:2227`, `CRS84`, or the address
    /// of a description; `None` for a name that is not known.
    pub fn of_name(name: &str) -> Option<Self> {
        let upper = name.to_ascii_uppercase();
        if ["CRS84", "CRS83", "CRS27"].iter().any(|datum| upper.contains(datum)) {
            return Some(Self::Degrees);
        }
        epsg_of_name(name).map(Self::of_epsg)
    }

    /// Reads the text of a `.prj` file, or another description of a system as well-known text.
    pub fn of_text(text: &str) -> SpatialReference {
        let upper = text.trim().to_ascii_uppercase();
        // ArcInfo's older descriptions have lines of keywords instead of brackets.
        if upper.starts_with("PROJECTION") {
            return of_arc_info(&upper);
        }
        // A compound system has a second part for heights, with a unit that is not that of lengths on the ground.
        let vertical = ["VERT_CS[", "VERTCS[", "VERTCRS["].iter().find_map(|start| upper.find(start));
        let (horizontal, heights) = upper.split_at(vertical.unwrap_or(upper.len()));
        // Units further in, such as the degrees of its datum, come before that of its lengths.
        let last_unit = |part: &str| {
            let (_, unit) = part.rsplit_once("LENGTHUNIT[").or_else(|| part.rsplit_once("UNIT["))?;
            unit.split([',', ']']).nth(1)?.trim().parse::<f64>().ok()
        };
        let method = ["PROJECTION[\"", "METHOD[\""].iter().find_map(|start| horizontal.split_once(start));
        let method = method.map_or("", |(_, rest)| rest.split('"').next().unwrap_or_default()).replace('_', " ");
        let is_cylinder = ["EQUIRECTANGULAR", "PLATE CARREE", "EQUIDISTANT CYLINDRICAL", "CYLINDRICAL EQUAL AREA"];
        let coordinates = if !["PROJCS[", "PROJCRS["].iter().any(|start| horizontal.contains(start)) {
            ["GEOGCS[", "GEOGCRS[", "GEODCRS["].iter().any(|start| horizontal.contains(start)).then_some(Self::Degrees)
        } else if method.contains("AUXILIARY SPHERE") || method.contains("PSEUDO MERCATOR") {
            // Before the other kinds of Mercator, as its methods are called Mercator too.
            Some(Self::WebMercator)
        } else if method.starts_with("MERCATOR") || is_cylinder.iter().any(|method_name| method.contains(method_name)) {
            Some(Self::Unusable)
        } else {
            last_unit(horizontal).map(|unit_m| Self::Lengths { unit_m })
        };
        SpatialReference { coordinates, height_unit_m: last_unit(heights) }
    }

    /// Says why cells with these coordinates cannot be used, and which command helps; `None` if they are measured in metres.
    /// The corner is that of the cells, in the coordinates.
    pub(super) fn refusal(self, corner: [f64; 2]) -> Option<String> {
        let (found, degrees) = match self {
            Self::Lengths { unit_m } if (unit_m - 1.0).abs() < 1e-9 => return None,
            Self::Lengths { unit_m } => (format!("not measured in metres but in {}", unit_name(unit_m)), None),
            Self::Degrees => ("measured in degrees".to_owned(), Some(corner)),
            Self::WebMercator => {
                let [longitude, latitude] = degrees_of_web_mercator(corner);
                let share = ops::cos(latitude.to_radians());
                let found = format!(
                    "measured in metres of a Mercator projection of the whole Earth, each of which is {share:.3} m on the \
                     ground there"
                );
                (found, Some([longitude, latitude]))
            }
            Self::Unusable => {
                ("measured in metres of a projection of the whole Earth, or in a rare unit".to_owned(), None)
            }
        };
        let command = degrees.map_or_else(|| "gdalwarp -t_srs EPSG:NUMBER".to_owned(), gdalwarp_at);
        Some(format!("its cells are {found}; {command} in.tif out.tif converts it to a grid in metres"))
    }
}

/// Returns the beginning of the command that makes a grid in metres of one in degrees at a place.
pub(super) fn gdalwarp_at(degrees: [f64; 2]) -> String {
    let zone = utm_at(degrees).map_or_else(|| "NUMBER".to_owned(), |number| number.to_string());
    format!("gdalwarp -t_srs EPSG:{zone}")
}

/// Returns the number in the list of EPSG that a name of a coordinate system has, such as `urn:ogc:def:crs:EPSG::32611`.
pub fn epsg_of_name(name: &str) -> Option<u32> {
    let upper = name.to_ascii_uppercase();
    // Of the numbers of Esri's list only those of the web's Mercator projection are known here.
    let place = upper.find("EPSG").or_else(|| upper.find("ESRI:1021"))?;
    // A compound system, such as EPSG:32611+5703, names its horizontal part first.
    let rest = upper[place..].split('+').next()?;
    // Versions in names of this kind, such as 0 or 9.8, have fewer digits than systems.
    rest.split(|letter: char| !letter.is_ascii_digit()).filter(|number| number.len() > 2).find_map(|it| it.parse().ok())
}

/// Converts metres of the web's Mercator projection into longitude and latitude in degrees.
pub fn degrees_of_web_mercator([x, y]: [f64; 2]) -> [f64; 2] {
    let latitude = 2.0 * ops::atan(ops::exp(y / WEB_RADIUS_M)) - std::f64::consts::FRAC_PI_2;
    [(x / WEB_RADIUS_M).to_degrees(), latitude.to_degrees()]
}

/// Returns the number of the zone of WGS 84 / UTM at a place in degrees.
fn utm_at([longitude, latitude]: [f64; 2]) -> Option<u32> {
    let is_there = (-180.0..=180.0).contains(&longitude) && (-80.0..=84.0).contains(&latitude);
    let zone = (((longitude + 180.0) / 6.0).floor() as u32 + 1).min(60);
    is_there.then_some(if latitude < 0.0 { 32_700 + zone } else { 32_600 + zone })
}

/// Names a unit of length.
pub fn unit_name(unit_m: f64) -> String {
    match unit_m {
        _ if (unit_m - FOOT_M).abs() < 1e-9 => "feet".to_owned(),
        _ if (unit_m - US_SURVEY_FOOT_M).abs() < 1e-9 => "US survey feet".to_owned(),
        _ => format!("units of {unit_m} m"),
    }
}

/// Says whether numbers without a coordinate system are degrees in all likelihood: the cells are smaller than any of a
/// landscape in metres, and lie on the Earth.
pub(super) fn are_likely_degrees([west, south]: [f64; 2], size: [f64; 2], cell: f64) -> bool {
    let is_on_earth = west >= -180.0 && west + size[0] <= 360.0 && south >= -90.0 && south + size[1] <= 90.0;
    // A field of its own in metres begins at 0; larger cells are not those of maps in degrees.
    let is_at_a_place = west != 0.0 && south != 0.0;
    is_on_earth && (cell < 0.01 || cell < 0.5 && is_at_a_place)
}

/// Reads a description in the key words of ArcInfo: `Projection UTM`, `Units METERS`, `Zunits FEET`.
fn of_arc_info(upper: &str) -> SpatialReference {
    let value = |key: &str| {
        let lines = upper.lines().map(|line| line.split_ascii_whitespace().collect::<Vec<_>>());
        lines
            .filter(|tokens| tokens.first() == Some(&key))
            .find_map(|tokens| tokens.get(1).map(|word| (*word).to_owned()))
    };
    let units = value("UNITS").unwrap_or_default();
    let coordinates = match value("PROJECTION").unwrap_or_default().as_str() {
        "GEOGRAPHIC" => Some(Coordinates::Degrees),
        "MERCATOR" | "EQUIRECTANGULAR" => Some(Coordinates::Unusable),
        _ if units == "DD" => Some(Coordinates::Degrees),
        _ => unit_of_word(&units).map(|unit_m| Coordinates::Lengths { unit_m }),
    };
    SpatialReference { coordinates, height_unit_m: value("ZUNITS").and_then(|word| unit_of_word(&word)) }
}

/// Returns the metres of a unit of length in a file of a projection.
fn unit_of_word(word: &str) -> Option<f64> {
    match word {
        "METERS" | "METRES" | "1.0" => Some(1.0),
        "FEET" | "US_FEET" | "SURVEY_FEET" => Some(US_SURVEY_FOOT_M),
        "INT_FEET" => Some(FOOT_M),
        other => other.parse().ok(),
    }
}

impl GeoKeys {
    /// Returns the value of a key that is a number in the directory itself.
    pub(super) fn short(&self, key: u16) -> Option<u16> {
        let keys = self.directory.get(4..)?.chunks_exact(4);
        keys.into_iter().find(|entry| entry[0] == key && entry[1] == 0).map(|entry| entry[3])
    }

    /// Returns a number that stands for a system or a unit, not for a custom one or none.
    fn listed(&self, key: u16) -> Option<u16> {
        self.short(key).filter(|&number| number != USER_DEFINED && number != UNDEFINED)
    }

    /// Returns the number of the projected coordinate system in the list of EPSG, if the keys name one.
    pub fn epsg(&self) -> Option<u16> {
        self.listed(PROJECTED_SYSTEM)
    }

    /// Returns what the coordinates measure; `None` if the keys do not say.
    pub(super) fn coordinates(&self) -> Option<Coordinates> {
        let model = self.short(MODEL_TYPE);
        let is_projected = model == Some(PROJECTED) || model.is_none() && self.epsg().is_some();
        let is_geographic = model.is_some_and(|model| model > PROJECTED && model != USER_DEFINED);
        if is_geographic || !is_projected && self.listed(GEOGRAPHIC_SYSTEM).is_some() {
            return Some(Coordinates::Degrees);
        }
        let of_epsg = self.epsg().map(|number| Coordinates::of_epsg(number.into()));
        let text = self.ascii.split_once("ESRI PE String = ").map(|(_, text)| text);
        let named = of_epsg.or_else(|| Coordinates::of_text(text?).coordinates);
        let is_cylinder = self.listed(PROJECTION_METHOD).is_some_and(|method| CYLINDER_METHODS.contains(&method));
        // The system comes before its unit: metres of a projection of the whole Earth are not those on the ground.
        match self.listed(LINEAR_UNITS) {
            _ if matches!(named, Some(Coordinates::WebMercator | Coordinates::Unusable)) => named,
            _ if is_cylinder => Some(Coordinates::Unusable),
            Some(METRE) => Some(Coordinates::METRES),
            Some(FOOT) => Some(Coordinates::Lengths { unit_m: FOOT_M }),
            Some(US_SURVEY_FOOT) => Some(Coordinates::Lengths { unit_m: US_SURVEY_FOOT_M }),
            Some(_) => Some(Coordinates::Unusable),
            None => named,
        }
    }

    /// Returns the unit of heights in metres, if the keys give one.
    pub(super) fn height_unit_m(&self) -> Option<f64> {
        let system = self.listed(VERTICAL_SYSTEM);
        match self.listed(VERTICAL_UNITS) {
            Some(METRE) => Some(1.0),
            Some(FOOT) => Some(FOOT_M),
            Some(US_SURVEY_FOOT) => Some(US_SURVEY_FOOT_M),
            _ if HEIGHTS_IN_FEET.contains(&system?) => Some(FOOT_M),
            _ => HEIGHTS_IN_US_SURVEY_FEET.contains(&system?).then_some(US_SURVEY_FOOT_M),
        }
    }
}

/// Reads a number, or the first and the last of several.
fn span(text: &str) -> Option<RangeInclusive<u32>> {
    let (first, last) = text.split_once('-').unwrap_or((text, text));
    Some(first.parse().ok()?..=last.parse().ok()?)
}

/// Systems of longitude and latitude, and geocentric ones.
const GEOGRAPHIC: &str = "\
    3819-3824 3887-3889 3906 4000-4025 4027-4036 4039-4047 4052-4055 4073-4081 4120-4216 4218-4389 4463-4466 \
    4468-4470 4472-4473 4475-4483 4490 4555-4558 4600-4646 4657-4765 4801-4811 4813-4821 4823-4824 4882-5013 5132 \
    5228-5233 5244-5246 5250-5252 5262-5264 5322-5324 5332 5340-5342 5352-5354 5358-5360 5363-5365 5368-5381 \
    5391-5393 5451 5464 5467 5487-5489 5524-5527 5544-5546 5558 5560-5561 5591-5593 5681 5828-5830 5884-5886 \
    6133-6135 6207 6309-6311 6317-6325 6363-6365 6666-6668 6704-6706 6781-6783 6881-6883 6892-6894 6934 6978-6983 \
    6985-6990 7034-7042 7071-7073 7084-7088 7133-7139 7371-7373 7656-7686 7789 7796-7798 7815-7816 7842-7844 \
    7879-7881 7884-7886 7900-7931 8042-8043 8084-8086 8227-8255 8351 8397-8431 8449 8541-8545 8683-8685 8694-8818 \
    8860-8902 8905-8907 8915-8949 8972-9019 9053-9140 9146-9148 9151-9153 9182-9184 9248 9251 9253 9266-9267 \
    9292-9294 9299 9307-9309 9331-9333 9364 9372 9378-9384 9403 9453 9468-9470 9474-9475 9545-9547 9694-9696 \
    9700-9702 9739 9753-9758 9763 9775-9784 9866 9871 9892-9893 9939 9964 9969 9974 9988-10158 10175-10178 10185 \
    10191 10196 10204 10209 10214 10219 10224 10229 10237 10249 10252 10256 10260 10265 10268 10272 10277 \
    10282-10284 10297-10305 10307-10312 10326-10328 10345-10414 10468 10473-10475 10569-10571 10604-10606 10623 \
    10628 10634-10639 10669-10673 10688-10690 10723-10725 10734-10739 10758 10760-10762 10779-10785 10789-10791 \
    10798-10800 10805-10807 10829-10831 10849 10860 10873-10898 10908-10910 10939-10941 10950-10968 11041-11043 \
    20033-20041 20044-20046";

/// Systems in feet of 0.3048 m.
const FEET: &str = "\
    2222-2224 2251-2253 2256 2265-2266 2269-2270 2273 2280-2282 2867-2869 2896-2898 2901 2909-2910 2913-2914 \
    2921-2923 2992 2994 3080 3359 3361 3479 3481 3483 3588 3590 3593 3605 3634 3636 3644 3646 3648 3656 3676 3679 \
    3682 5588 6128-6141 6391 6405 6407 6409 6494 6496 6499 6515 6545 6547 6557 6559 6561 6570 6785 6787 6789 6791 \
    6793 6795 6797 6799 6801 6803 6805 6807 6809 6811 6813 6815 6817 6819 6821 6823 6825 6827 6829 6831 6833 6835 \
    6837 6839 6841 6843 6845 6847 6849 6851 6853 6855 6857 6859 6861 6863 6868 6885 6887 7119-7127 8065-8068 8312 \
    8314 8316 8318 8320 8322 8324 8326 8328 8330 8332 8334 8336 8338 8340 8342 8344 8346 8348 10980-10987 20050";

/// Systems in US survey feet.
const US_SURVEY_FEET: &str = "\
    2155 2194 2204 2225-2250 2254-2255 2257-2264 2267-2268 2271-2272 2274-2279 2283-2289 2870-2895 2899-2900 \
    2902-2908 2911-2912 2915-2920 2924-2930 2964-2968 3089 3091 3102 3363 3365 3404 3417-3438 3441-3446 3451-3459 \
    3485 3487 3490 3492 3494 3496 3498 3500 3502 3504 3506 3508 3510 3512 3515 3517 3519 3521 3523 3525 3527 3529 \
    3531 3533 3535 3537 3539 3541 3543 3545 3547 3549 3551 3553 3560-3570 3582 3584 3586 3598 3600 3608 3610 3612 \
    3614 3616 3618 3620 3622 3624 3626 3628 3630 3632 3640 3642 3650 3652 3654 3658 3660 3662 3664 3668 3670 3672 \
    3674 3677 3680 3683 3686 3688 3690 3692 3696 3698 3700 3728-3739 3753-3760 3991-3992 4217 4399-4413 4418-4433 \
    4438-4457 5623-5625 5646 5654-5655 6200-6202 6411 6413 6416 6418 6420 6422 6424 6426 6428 6430 6432 6434 6436 \
    6438 6441 6443 6445 6447 6449 6451 6453 6455 6457 6459 6461 6463 6465 6467 6469 6471 6473 6475 6477 6479 6484 \
    6486 6488 6490 6492 6501 6503 6505 6507 6510 6517 6519 6521 6523 6525 6527 6529 6531 6533 6535 6537 6539 6541 \
    6543 6549 6551 6553 6555 6563 6565 6568 6572 6574 6576 6578 6582 6584 6586 6588 6590 6593 6595 6597 6599 6601 \
    6603 6605 6607 6609 6612 6614 6616 6618 6625-6627 6633 6880 6923 6925 6966 6997 7057-7070 7128 7132 7258 7260 \
    7262 7264 7266 7268 7270 7272 7274 7276 7278 7280 7282 7284 7286 7288 7290 7292 7294 7296 7298 7300 7302 7304 \
    7306 7308 7310 7312 7314 7316 7318 7320 7322 7324 7326 7328 7330 7332 7334 7336 7338 7340 7342 7344 7346 7348 \
    7350 7352 7354 7356 7358 7360 7362 7364 7366 7368 7370 7587-7645 8035-8036 8091 8093 8096 8098 8100 8102 8104 \
    8106 8108 8110 8112 8114 8116 8118 8120 8122 8124 8126 8128 8130 8132 8134 8136 8138 8140 8142 8144 8146 8148 \
    8150 8152 8154 8156 8158 8160 8162 8164 8166 8168 8170 8172 8177 8180 8182 8185 8189 8193 8197 8200 8202 8204 \
    8206 8208 8210 8213 8216 8220 8224 8226 8380 8382 8384 8387 8518-8540 9748-9749 10481-10516 10622 10911-10916 \
    23301-23333 26729-26813 26847-26870 32001-32058 32064-32077 32099 32164-32167 32664-32667";

/// Systems in links, yards, chains and other feet.
const OTHER_UNITS: &str = "\
    2066 2136 2159-2160 2314 3139-3140 3167 3407 5472 5589 22300 24100 24370-24374 24382 24571 27291-27292 \
    29371-29385 29871-29872 30200";

#[cfg(test)]
mod tests {
    use super::*;

    const FEET_IN: Coordinates = Coordinates::Lengths { unit_m: FOOT_M };
    const US_FEET_IN: Coordinates = Coordinates::Lengths { unit_m: US_SURVEY_FOOT_M };

    #[test]
    fn systems_are_found_by_number_and_by_name() {
        for (number, expected) in [
            (32_611, Coordinates::METRES),
            (5070, Coordinates::METRES),
            (2227, US_FEET_IN),
            (2222, FEET_IN),
            (4326, Coordinates::Degrees),
            (4269, Coordinates::Degrees),
            (3857, Coordinates::WebMercator),
            (3395, Coordinates::Unusable),
        ] {
            assert_eq!(Coordinates::of_epsg(number), expected, "{number}");
            for name in [
                format!("EPSG:{number}"),
                format!("urn:ogc:def:crs:EPSG:6.18.3:{number}"),
                format!("epsg:{number}+5703"),
            ] {
                assert_eq!(Coordinates::of_name(&name), Some(expected), "{name}");
            }
        }
        assert_eq!(Coordinates::of_name("urn:ogc:def:crs:OGC:1.3:CRS84"), Some(Coordinates::Degrees));
        assert_eq!(Coordinates::of_name("my farm"), None);
    }

    #[test]
    fn texts_of_all_ages_say_what_coordinates_and_heights_measure() {
        let utm = |unit: &str, more: &str| {
            format!(
                "PROJCS[\"UTM\",GEOGCS[\"WGS 84\",UNIT[\"Degree\",0.0174532925199433]],PROJECTION[\"Transverse_Mercator\"],\
                 PARAMETER[\"False_Easting\",500000.0],UNIT[{unit}]]{more}"
            )
        };
        let heights = ",VERTCS[\"NAVD88\",PARAMETER[\"Direction\",1.0],UNIT[\"Foot_US\",0.3048006096012192]]";
        let by_sphere = utm("\"Meter\",1.0", "").replace("Transverse_Mercator", "Mercator_Auxiliary_Sphere");
        for (text, expected, height_unit) in [
            (utm("\"Meter\",1.0", ""), Some(Coordinates::METRES), false),
            (utm("\"Meter\",1.0", heights), Some(Coordinates::METRES), true),
            (utm("\"Foot\",0.3048", ""), Some(FEET_IN), false),
            (by_sphere, Some(Coordinates::WebMercator), false),
            ("GEOGCS[\"WGS 84\",UNIT[\"Degree\",0.01745]]".to_owned(), Some(Coordinates::Degrees), false),
            ("Projection    UTM\nZone 11\nUnits METERS\nZunits FEET\n".to_owned(), Some(Coordinates::METRES), true),
            ("Projection GEOGRAPHIC\nUnits DD".to_owned(), Some(Coordinates::Degrees), false),
            ("hello".to_owned(), None, false),
        ] {
            let SpatialReference { coordinates, height_unit_m } = Coordinates::of_text(&text);
            assert_eq!(
                (coordinates, height_unit_m.is_some_and(|it| (it - US_SURVEY_FOOT_M).abs() < 1e-9)),
                (expected, height_unit),
                "{text}"
            );
        }
    }

    #[test]
    fn numbers_that_can_only_be_degrees_are_distinguished_from_small_fields() {
        assert!(are_likely_degrees([-117.0, 36.0], [0.016, 0.011], 1.0 / 3600.0));
        assert!(are_likely_degrees([10.0, -40.0], [5.0, 5.0], 0.05));
        assert!(!are_likely_degrees([0.0, 0.0], [3.0, 2.0], 0.05), "a burning table");
        assert!(!are_likely_degrees([0.0, 0.0], [15.0, 10.0], 5.0));
        assert!(!are_likely_degrees([500_000.0, 4e6], [1.0, 1.0], 0.005));
        let [longitude, latitude] = degrees_of_web_mercator([1_113_194.907_932_735_7, 8_399_737.889_818_357]);
        assert!((longitude - 10.0).abs() < 1e-9 && (latitude - 60.0).abs() < 1e-9);
        assert_eq!((utm_at([-117.5, 36.0]), utm_at([17.0, -36.0])), (Some(32_611), Some(32_733)));
    }
}
