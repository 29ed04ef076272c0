//! Moisture of fine dead fuel from the tables of Rothermel (1983): a reference by temperature and humidity, and a correction
//! by season, shade, place and time of day.
//!
//! Rothermel, R.C. 1983. How to predict the spread and intensity of forest and range fires. USDA Forest Service, General
//! Technical Report INT-143. The tables are for the day, 8:00 to 19:59. In two cells of February to April they are those of
//! BEHAVE, where the NWCG's field guides have one percent more: on gentle eastern slopes at 16:00 above the weather station,
//! and on steep ones at 18:00 below it.

/// Percent of the dry weight, by temperature (10-29, 30-49, 50-69, 70-89, 90-109 degrees Fahrenheit, and above) and relative
/// humidity (0-4, 5-9, ..., 95-99 %, 100 %).
const REFERENCE: [[u8; 21]; 6] = [
    [1, 2, 2, 3, 4, 5, 5, 6, 7, 8, 8, 8, 9, 9, 10, 11, 12, 12, 13, 13, 14],
    [1, 2, 2, 3, 4, 5, 5, 6, 7, 7, 7, 8, 9, 9, 10, 10, 11, 12, 13, 13, 13],
    [1, 2, 2, 3, 4, 5, 5, 6, 6, 7, 7, 8, 8, 9, 9, 10, 11, 12, 12, 12, 13],
    [1, 1, 2, 2, 3, 4, 5, 5, 6, 7, 7, 8, 8, 8, 9, 10, 10, 11, 12, 12, 13],
    [1, 1, 2, 2, 3, 4, 4, 5, 6, 7, 7, 8, 8, 8, 9, 10, 10, 11, 12, 12, 13],
    [1, 1, 2, 2, 3, 4, 4, 5, 6, 7, 7, 8, 8, 8, 9, 10, 10, 11, 12, 12, 12],
];

/// Percent to add, a digit each: by season and shade, then by aspect, then slope, time of day and elevation.
const CORRECTION: [[&[u8; 36]; 4]; 6] = [
    [
        b"234111001001111234344122112112122344",
        b"223111001001112344122001001112234456",
        b"233111001001111233233112011011112233",
        b"234112001001011233456234112001001122",
    ],
    [
        b"455345334334345455455345334334345455",
        b"445345334344345456445345334344345456",
        b"445345334334345455445345334334345455",
        b"456345334334345445456345334334345445",
    ],
    [
        b"345123112112123345345334234234334345",
        b"345123111112123345334111111123345356",
        b"345122111111123345345122011011122345",
        b"345123111111123345456345123111111334",
    ],
    [
        b"456455345345455456456455345345455456",
        b"456345345345456456456345345345456456",
        b"456345345345345456456345345345345456",
        b"456456345345345456456456345345345456",
    ],
    [
        b"456345234234345456456456456456456456",
        b"456344233233345456456234223344456456",
        b"456345233223344456456233112112233456",
        b"456345233233344456456456344223234456",
    ],
    [b"456456456456456456456456456456456456"; 4],
];

/// Returns the moisture that the correction is added to, in percent of the dry weight, for classes of temperature (0 to 5) and
/// relative humidity (0 to 20), counted as in Rothermel's table A; `None` if there is no such class.
pub fn reference_pct(temperature: usize, humidity: usize) -> Option<u8> {
    REFERENCE.get(temperature)?.get(humidity).copied()
}

/// The conditions of a correction, as classes counted from 0: May to July, the months between, or November to January;
/// exposed or shaded; north, east, south, west; up to 30 percent or steeper; from 8:00 in steps of two hours; the fuel 1000
/// to 2000 ft below the weather station, level with it, or above.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CorrectionClass {
    pub season: usize,
    pub shade: usize,
    pub aspect: usize,
    pub slope: usize,
    pub time: usize,
    pub elevation: usize,
}

impl CorrectionClass {
    /// Returns what is added to [`reference_pct`]; `None` if a class does not exist.
    pub fn correction_pct(self) -> Option<u8> {
        let Self { season, shade, aspect, slope, time, elevation } = self;
        if season > 2 || shade > 1 || aspect > 3 || slope > 1 || time > 5 || elevation > 2 {
            return None;
        }
        Some(CORRECTION[2 * season + shade][aspect][18 * slope + 3 * time + elevation] - b'0')
    }
}

/// Returns the moisture of fine dead fuel in the sun on gentle ground that faces south, as a fraction, in this month (from 1)
/// and hour (0 to 23). Before 8:00 the correction is that of 8:00, from 20:00 on that of 18:00: the tables have no night.
pub fn fine_dead_moisture(temperature_c: f64, humidity: f64, month: u32, hour: u32) -> f64 {
    // Classes of temperature begin at 10 degrees Fahrenheit and are 20 wide, those of humidity 5 percent.
    let class = |number: f64, last: f64| number.clamp(0.0, last) as usize;
    let reference = reference_pct(class((1.8 * temperature_c + 22.0) / 20.0, 5.0), class(20.0 * humidity, 20.0));
    let season = match month {
        5..=7 => 0,
        2..=4 | 8..=10 => 1,
        _ => 2,
    };
    let time = (hour.clamp(8, 19) - 8) as usize / 2;
    let correction = CorrectionClass { season, shade: 0, aspect: 2, slope: 0, time, elevation: 1 }.correction_pct();
    let [reference, correction] = [reference, correction].map(|pct| pct.expect("the classes are within the tables"));
    f64::from(reference + correction) / 100.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fine_fuel_is_wetter_in_humid_air_in_the_shade_and_in_winter() {
        // 80 F and 20 %, on a level meadow in July at 14:00; the same under trees; the same in December.
        let site = CorrectionClass { season: 0, shade: 0, aspect: 2, slope: 0, time: 3, elevation: 1 };
        let corrections = [site, CorrectionClass { shade: 1, ..site }, CorrectionClass { season: 2, ..site }]
            .map(CorrectionClass::correction_pct);
        assert_eq!((reference_pct(3, 4), corrections), (Some(3), [Some(0), Some(3), Some(2)]));
        // 80 F and 20 % on that meadow; and by night in December, when the air is cold and moist.
        let found =
            [(26.7, 0.2, 7, 14), (-30.0, 1.0, 12, 23)].map(|(c, h, month, at)| fine_dead_moisture(c, h, month, at));
        assert_eq!(found, [0.03, 0.19]);
        let beyond = [
            CorrectionClass { season: 3, ..site },
            CorrectionClass { slope: 2, ..site },
            CorrectionClass { time: 6, elevation: 3, ..site },
        ];
        assert_eq!((beyond.map(CorrectionClass::correction_pct), reference_pct(6, 0)), ([None; 3], None));
    }
}
