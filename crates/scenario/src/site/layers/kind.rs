//! What layers hold: the names of their bands, and the values that they may have.

use wildfire_fire::fuel::{CustomFuels, FuelModel, custom_number};
use wildfire_grid::map_files::raster::Band;

/// Heights in metres between which all land lies, with room for the sea floor near it.
const LOWEST_M: f32 = -500.0;
const HIGHEST_M: f32 = 9000.0;

/// The azimuth by which files say that a cell is flat.
pub(super) const FLAT: f32 = -1.0;

/// What a layer holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LayerKind {
    Fuel,
    Elevation,
    Slope,
    Aspect,
    /// A layer of [`CanopyLayers`](wildfire_fire::CanopyLayers), by its place there.
    Canopy(usize),
}

/// The greatest number of each layer of trees, and what it holds.
pub(super) const CANOPY: [(f32, &str); 4] = [
    (1500.0, "the height of trees in tenths of metres, whole, from 0 to 1500"),
    (1500.0, "the height of the base of crowns in tenths of metres, whole, from 0 to 1500"),
    (1000.0, "the density of crowns in hundredths of kg/m3, whole, from 0 to 1000"),
    (100.0, "the cover of crowns in percent, whole, from 0 to 100"),
];

impl LayerKind {
    pub(super) const ALL: [Self; 8] = [
        Self::Elevation,
        Self::Slope,
        Self::Aspect,
        Self::Fuel,
        Self::Canopy(3),
        Self::Canopy(0),
        Self::Canopy(1),
        Self::Canopy(2),
    ];

    /// Returns the name that LANDFIRE's products have for the layer, and words for it.
    pub(super) fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Elevation => ("ELEV", "elevation"),
            Self::Slope => ("SLPD", "slope"),
            Self::Aspect => ("ASP", "aspect"),
            Self::Fuel => ("FBFM", "fuel models"),
            Self::Canopy(3) => ("CC", "cover of crowns"),
            Self::Canopy(0) => ("CH", "height of trees"),
            Self::Canopy(1) => ("CBH", "base height of crowns"),
            Self::Canopy(_) => ("CBD", "bulk density of crowns"),
        }
    }

    /// Returns what names of bands contain: codes of LANDFIRE's versions and words of GDAL, the preferred ones first.
    fn codes(self) -> &'static [&'static str] {
        match self {
            Self::Elevation => &["ELEV", "ELEVATION", "DEM"],
            Self::Slope => &["SLPD", "SLP", "SLOPE", PERCENT_SLOPE],
            Self::Aspect => &["ASP", "ASPECT"],
            Self::Fuel => &["FBFM40", "F40", "FBFM", "FBFM13", "F13", "FUEL MODELS", "FUEL MODEL", "FUEL"],
            Self::Canopy(3) => &["CC", "CANOPY COVER"],
            Self::Canopy(0) => &["CH", "CANOPY HEIGHT"],
            Self::Canopy(1) => &["CBH", "CANOPY BASE HEIGHT"],
            Self::Canopy(_) => &["CBD", "CANOPY BULK DENSITY"],
        }
    }

    /// Returns the band that holds this layer: by its name, such as `US_240FBFM40` or `LC22_F40_230`, or, where no band has a
    /// name, in the order of LANDFIRE's stacks.
    pub(super) fn band(self, bands: &[Band]) -> Option<TakenBand> {
        // Without names the order of landscape files decides, which have 5, 8 or 10 bands.
        if bands.iter().all(|band| band.name.is_none()) {
            let place = Self::ALL.iter().position(|kind| *kind == self)?;
            let number = Some(place).filter(|place| [5, 8, 10].contains(&bands.len()) && *place < bands.len())?;
            return Some(TakenBand { number, reason: String::new() });
        }
        let mut found: Vec<(usize, usize)> = Vec::new();
        for (number, name) in bands.iter().enumerate().filter_map(|(number, band)| Some((number, band.name.as_ref()?)))
        {
            found.extend(self.codes().iter().position(|code| has_code(name, code)).map(|rank| (rank, number)));
        }
        // By the rank of the code, so that the preferred one comes first wherever it is in the file.
        found.sort_unstable();
        let (&(rank, number), others) = found.split_first()?;
        let others: Vec<String> = others.iter().map(|(_, other)| (other + 1).to_string()).collect();
        let is_first = found.get(1).is_some_and(|second| second.0 == rank);
        let reason = match (others.is_empty(), is_first) {
            (true, _) => String::new(),
            (_, true) => format!(", the first of several (also band {})", others.join(", ")),
            (_, false) => format!(", preferred as {} (not band {})", self.codes()[rank], others.join(", ")),
        };
        Some(TakenBand { number, reason })
    }

    /// What stands in cells of the rim.
    pub(super) fn without_data(self) -> f32 {
        match self {
            Self::Elevation => f32::NAN,
            Self::Aspect => FLAT,
            _ => 0.0,
        }
    }

    /// Says that no band holds this layer.
    pub(super) fn absent(self, bands: &[Band]) -> String {
        let names: Vec<&str> = bands.iter().map(|band| band.name.as_deref().unwrap_or("without a name")).collect();
        let (band_name, text) = self.names();
        format!(
            "none of its {} bands is known to hold the {text} ({}); expected a band named {band_name}, or 5, 8 or 10 bands \
             without names in the order of LANDFIRE",
            bands.len(),
            names.join(", ")
        )
    }

    /// Returns what is expected instead of a value; `None` if the value is right.
    pub(super) fn expects(self, value: f32, custom_fuels: &CustomFuels) -> Option<&'static str> {
        match self {
            Self::Fuel if is_fuel_model(value, custom_fuels) => None,
            Self::Fuel if custom_number(value.max(0.0) as u32).is_some() && value.fract() == 0.0 => Some(
                "the number of a fuel model: 1 to 13, 91, 92, 93, 98, 99, or 101 to 204 (no custom fuel model has this one)",
            ),
            Self::Fuel => Some("the number of a fuel model: 1 to 13, 91, 92, 93, 98, 99, or 101 to 204"),
            Self::Elevation if (LOWEST_M..=HIGHEST_M).contains(&value) => None,
            Self::Elevation => Some("an elevation from -500 to 9000 m (are these feet?)"),
            Self::Slope if (0.0..90.0).contains(&value) => None,
            Self::Slope => Some("a slope from 0 to 90 degrees (is this percent?)"),
            Self::Aspect if value == FLAT || (0.0..=360.0).contains(&value) => None,
            Self::Aspect => Some("a compass azimuth from 0 to 360 degrees, or -1 where the ground is flat"),
            Self::Canopy(place) if value.fract() == 0.0 && (0.0..=CANOPY[place].0).contains(&value) => None,
            Self::Canopy(place) => Some(CANOPY[place].1),
        }
    }
}

/// Says whether a value is the number of a built-in or a custom fuel model.
fn is_fuel_model(value: f32, custom_fuels: &CustomFuels) -> bool {
    if value.fract() != 0.0 || !(0.0..1000.0).contains(&value) {
        return false;
    }
    match custom_number(value as u32) {
        Some(number) => custom_fuels.model(number).is_some(),
        None => value < 256.0 && FuelModel::by_number(value as u8).is_some(),
    }
}

/// A band of several, and why it was taken where others could have been.
pub(super) struct TakenBand {
    pub(super) number: usize,
    pub(super) reason: String,
}

/// The code of LANDFIRE's slopes in percent.
pub(super) const PERCENT_SLOPE: &str = "SLPP";

/// Says whether a name contains a code, perhaps between numbers, such as `US_240FBFM40`, or consists of these words.
pub(super) fn has_code(name: &str, code: &str) -> bool {
    let upper = name.to_ascii_uppercase();
    let parts = || upper.split(|letter: char| !letter.is_ascii_alphanumeric()).filter(|word| !word.is_empty());
    parts().any(|word: &str| {
        let rest = word.trim_start_matches(|letter: char| letter.is_ascii_digit()).strip_prefix(code);
        rest.is_some_and(|rest| rest.chars().all(|letter| letter.is_ascii_digit()))
    }) || code.contains(' ') && parts().eq(code.split(' '))
}
