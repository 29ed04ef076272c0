//! Streams as programs write them, and what each says: worked out by hand from the manuals that the head of the module names.

use super::*;
use std::path::PathBuf;

const HOUR: f64 = 3600.0;

fn read(file: &str, text: &str, settings: &WeatherSettings) -> Result<StreamWeather, String> {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let path = folder.path().join(file);
    std::fs::write(&path, text).expect("writable");
    read_stream(&path, settings, &FuelMoisture::default(), 24.0 * HOUR)
}

fn with(dead_moisture: DeadMoisture) -> WeatherSettings {
    WeatherSettings { dead_moisture, ..WeatherSettings::default() }
}

const FW21: &str = "StationID,DateTime,Temperature(F),RelativeHumidity(%),Precipitation(in),WindSpeed(mph),\
                    WindAzimuth(degrees),SolarRadiation(W/m2),SnowFlag,GustSpeed(mph)\n\
                    7,2024-07-14T12:00:00-07:00,86,25,0.1,10,270,700,0,18\n\
                    7,2024-07-14T13:00:00-07:00,86,25,0.1,10,270,700,0,18\n";
const WXS_TEXT: &str = "RAWS_ELEVATION: 500\nRAWS_UNITS: English\nRAWS: 2\n\
                        Year Mth Day Time Temp RH HrlyPcp WindSpd WindDir CloudCov\n\
                        2024 7 14 1200 86 25 0.10 10 270 10\n2024 7 14 1300 86 25 0.10 10 270 10\n";
const CSV: &str = "time,temperature_c,humidity_pct,speed_mps,from_deg,rain_mm,cloud_pct\n\
                   2024-07-14 12:00,30,25,5,270,2.54,10\n2024-07-14 13:00,30,25,5,270,2.54,10\n";

/// A text with some words replaced.
fn edited(text: &str, edits: &[[&str; 2]]) -> String {
    edits.iter().fold(text.to_owned(), |text, [from, to]| {
        assert!(text.contains(from), "{from} is not in {text}");
        text.replace(from, to)
    })
}

/// m/s at 10 m, azimuth, C, %, mm, local hour: the values of all three texts.
const FW21_VALUES: [f64; 6] = [10.0 * 0.44704 * 1.15, 270.0, 30.0, 25.0, 2.54, 12.0];
const CSV_VALUES: [f64; 6] = [5.0, 270.0, 30.0, 25.0, 2.54, 12.0];
const METRIC_VALUES: [f64; 6] = [10.0 / 3.6, 270.0, 86.0 / 2.0, 25.0, 0.1, 12.0];

fn changed(values: [f64; 6], position: usize, value: f64) -> [f64; 6] {
    let mut values = values;
    values[position] = value;
    values
}

#[test]
fn streams_say_what_their_manuals_say() {
    let fw21 = |edits: &[[&str; 2]]| ("a.fw21", edited(FW21, edits), FW21_VALUES);
    let fw21_with =
        |edits: &[[&str; 2]], position, value| ("a.fw21", edited(FW21, edits), changed(FW21_VALUES, position, value));
    let wxs = |edits: &[[&str; 2]]| ("a.wxs", edited(WXS_TEXT, edits), FW21_VALUES);
    let csv = |edits: &[[&str; 2]]| ("a.csv", edited(CSV, edits), CSV_VALUES);
    let kmh = 10.0 / 3.6;
    let streams = [
        fw21(&[]),
        fw21(&[["WindSpeed(mph)", "WindSpeed(MPH)"]]),
        fw21(&[["WindSpeed(mph)", "WindSpeed(mi/h)"]]),
        fw21(&[["WindSpeed(mph)", "WindSpeed [miles/hour]"]]),
        fw21_with(&[["WindSpeed(mph)", "WindSpeed(kph)"]], 0, kmh),
        fw21_with(&[["WindSpeed(mph)", "WindSpeed(km/h)"]], 0, kmh),
        fw21_with(&[["WindSpeed(mph)", "WindSpeed(KMH)"]], 0, kmh),
        fw21_with(&[[",10,270", ",0,"]], 0, 0.0),
        fw21_with(&[[",10,270", ",10,360"]], 1, 360.0),
        fw21_with(&[[",10,270", ",10,0"]], 1, 0.0),
        fw21(&[["Temperature(F)", "Temperature(degF)"]]),
        fw21(&[["Temperature(F)", "Temperature(Fahrenheit)"]]),
        fw21_with(&[["Temperature(F)", "Temperature(C)"], [",86,", ",30,"]], 2, 30.0),
        fw21_with(&[["Temperature(F)", "Temperature(Celsius)"], [",86,", ",31,"]], 2, 31.0),
        fw21_with(&[["Temperature(F)", "Temperature (\u{b0}C)"], [",86,", ",-4,"]], 2, -4.0),
        fw21_with(&[["Temperature(F)", "Temperature(K)"], [",86,", ",300.15,"]], 2, 27.0),
        fw21_with(&[["Precipitation(in)", "Precipitation(mm)"]], 4, 0.1),
        fw21_with(&[["Precipitation(in)", "Precipitation(cm)"]], 4, 1.0),
        fw21(&[["Precipitation(in)", "Precip(inches)"]]),
        fw21(&[["RelativeHumidity(%)", "RELATIVEHUMIDITY(percent)"], ["WindAzimuth(degrees)", "windazimuth(deg)"]]),
        fw21(&[["(mph),", ","], ["(F)", ""], ["(in)", ""], ["(%)", ""], ["(degrees)", ""], ["(W/m2)", ""]]),
        fw21(&[["2024-07-14T1", "20240714T1"], [":00:00-07:00", "0000-0700"]]),
        fw21(&[[":00:00-07:00", ":00-07"]]),
        fw21(&[[":00:00-07:00", ":00:00.000-07:00"]]),
        fw21(&[["2024-07-14T", "2024/07/14 "], ["-07:00", " -07:00"]]),
        fw21(&[["-07:00", "+05:30"]]),
        fw21(&[["-07:00", ""]]),
        fw21(&[["T13:00:00-07:00", "T14:00:00-06:00"]]),
        fw21(&[[",", ";"]]),
        fw21(&[[",", "\t"]]),
        fw21(&[[",", "\",\""]]),
        fw21(&[["\n", "\r\n"]]),
        fw21(&[["StationID", "\u{feff}StationID"]]),
        fw21(&[["StationID,", "Temperature24(R),"]]),
        fw21(&[
            ["WindSpeed(mph)", "GustAzimuth"],
            ["GustSpeed(mph)", "WindSpeed(mph)"],
            [",10,270", ",99,270"],
            [",18", ",10"],
        ]),
        wxs(&[]),
        wxs(&[["English", "ENGLISH"], ["RAWS_UNITS:", "raws_units :"]]),
        wxs(&[["RAWS_UNITS: English\n", ""]]),
        wxs(&[["RAWS_ELEVATION: 500\nRAWS_UNITS: English\nRAWS: 2", "ENGLISH"]]),
        wxs(&[[" ", "\t"]]),
        wxs(&[
            ["RAWS: 2\n", "RAWS: 1\nRAWS_WINDS: Ave\n\n"],
            ["Year Mth Day Time Temp RH HrlyPcp WindSpd WindDir CloudCov\n", ""],
        ]),
        ("a.raws", WXS_TEXT.to_owned(), FW21_VALUES),
        ("stream.txt", WXS_TEXT.to_owned(), FW21_VALUES),
        ("a.wxs", edited(WXS_TEXT, &[["1200", "0"], ["1300", "100"]]), changed(FW21_VALUES, 5, 0.0)),
        ("a.wxs", edited(WXS_TEXT, &[["14 1200", "13 2400"], ["1300", "30"]]), changed(FW21_VALUES, 5, 0.0)),
        ("a.wxs", edited(WXS_TEXT, &[["English", "Metric"], [" 86 ", " 43 "]]), METRIC_VALUES),
        ("a.WXS", edited(WXS_TEXT, &[["English", "METRIC"], [" 86 ", " 43 "]]), METRIC_VALUES),
        ("a.wxs", edited(WXS_TEXT, &[["English", "metric"], [" 86 ", " 43 "], ["Time", "Hour"]]), METRIC_VALUES),
        csv(&[]),
        csv(&[["2024-07-14 ", "2024-07-14T"], [":00,", ":00-07:00,"]]),
        csv(&[[",", " ; "]]),
        csv(&[["time,", "note,time,"], ["2024", "dry,2024"]]),
        ("a.csv", edited(CSV, &[[",270,", ",-90,"]]), changed(CSV_VALUES, 1, -90.0)),
    ];
    for (file, text, expected) in streams {
        let stream = WeatherStream::parse(
            &PathBuf::from(file),
            text.trim_start_matches('\u{feff}'),
            &with(DeadMoisture::Tables),
            HOUR,
        );
        let stream = stream.unwrap_or_else(|error| panic!("{error}\n{text}"));
        let [first, second] = &stream.rows[..] else { panic!("two rows: {text}") };
        assert!(second.at_s == HOUR || text.contains(" 30 "), "{text}");
        use StreamQuantity::{From, Humidity, Rain, Speed, Temperature};
        let number = |quantity| stream.format.number(&first.row, quantity).unwrap_or(f64::NAN);
        let found = [number(Speed), number(From), number(Temperature), number(Humidity), number(Rain), first.hour()];
        let is_calm = found[0] == 0.0;
        for (position, (found, expected)) in found.into_iter().zip(expected).enumerate() {
            let is_right = (found - expected).abs() < 1e-9 || is_calm && position == 1;
            assert!(is_right, "{file}, value {position}: {found}, expected {expected}\n{text}");
        }
        let weather = read(file, &text, &with(DeadMoisture::Tables)).expect("it is right");
        assert_eq!(weather.winds[0].toward_deg, if is_calm { 270.0 } else { house_angle(expected[1]) }, "{text}");
    }
}

#[test]
fn what_no_manual_explains_is_refused_with_its_place() {
    let heights = "expected mph (at 20 ft) or km/h (at 10 m), or a CSV file with `speed_mps`";
    let fw21: &[(&[[&str; 2]], &str)] = &[
        (&[["WindSpeed(mph)", "WindSpeed(m/s)"]], heights),
        (&[["WindSpeed(mph)", "WindSpeed(knots)"]], "line 1: the unit of `WindSpeed(knots)` is not one of FW21"),
        (&[["WindSpeed(mph)", "WindSpeed(furlongs)"]], heights),
        (&[["Temperature(F)", "Temperature(R)"]], "expected F or C or K"),
        (&[["Precipitation(in)", "Precipitation(hundredths)"]], "expected in or mm or cm"),
        (&[["RelativeHumidity(%)", "RelativeHumidity(fraction)"]], "`RelativeHumidity(fraction)`"),
        (&[["WindAzimuth(degrees)", "WindAzimuth(rad)"]], "expected degrees"),
        (&[["DateTime", "DateTime(PST)"]], "the zone of `DateTime(PST)` is not UTC or local"),
        (&[["T13:00:00-07:00", "T20:00:00Z"]], "expected `weather.utc_offset_h`"),
        (&[["2:00:00-07:00", "9:00:00Z"], ["T13:00:00-07:00", "T20:00:00Z"]], "expected `weather.utc_offset_h`"),
        (&[["T12:00:00-07:00", "T19:00:00+00:00"], ["T13:00:00-07:00", "T20:00:00+00:00"]], "its times are UTC"),
        (&[["T13:00:00-07:00", "T13:00:00"]], "line 3: `DateTime` is 2024-07-14T13:00:00, expected a time with a zone"),
        (
            &[["T12:00:00-07:00", "T12:00:00"]],
            "line 3: `DateTime` is 2024-07-14T13:00:00-07:00, expected a time with no zone",
        ),
        (&[["-07:00", " PDT"]], "line 2: `DateTime` is 2024-07-14T12:00:00 PDT, expected a time such as"),
        (
            &[["T13:00:00-07:00", "T14:00:00-05:00"]],
            "line 3: `DateTime` is 2024-07-14T14:00:00-05:00, expected a time after",
        ),
        (&[["T13:00", "T12:00"]], "expected a time after that of the previous row"),
        (&[["T13:00", "T24:30"]], "line 3: `DateTime` is 2024-07-14T24:30:00-07:00"),
        (&[["2024-07-14T13", "2023-02-29T13"]], "line 3: `DateTime` is 2023-02-29"),
        (
            &[["\n7,2024-07-14T13", "\n8,2024-07-14T13"]],
            "line 3: `StationID` is 8, expected 7, the station of the first row",
        ),
        (&[[",10,270", ",M,270"]], "line 2: `WindSpeed(mph)` is M, expected a number from 0 to 150 m/s at 10 m"),
        (&[[",10,270", ",,270"]], "line 2: `WindSpeed(mph)` is empty"),
        (&[[",10,270", ",NaN,270"]], "`WindSpeed(mph)` is NaN"),
        (&[[",10,270", ",999,270"]], "`WindSpeed(mph)` is 999"),
        (&[[",10,270", ",10,-999"]], "`WindAzimuth(degrees)` is -999, expected a number from 0 to 360 degrees"),
        (&[[",10,270", ",10,NA"]], "`WindAzimuth(degrees)` is NA"),
        (&[[",86,25,", ",86,101,"]], "`RelativeHumidity(%)` is 101, expected a number from 0 to 100 %"),
        (&[[",86,25,", ",86,-1,"]], "`RelativeHumidity(%)` is -1"),
        (&[[",86,25,", ",86,,"]], "line 2: `RelativeHumidity(%)` is empty"),
        (&[[",86,25,", ",-999,25,"]], "`Temperature(F)` is -999, expected a number from -80 to 60 C"),
        (&[["Temperature(F)", "Temperature(C)"]], "`Temperature(C)` is 86"),
        (
            &[["WindSpeed", "Speed"], ["WindAzimuth", "Azimuth"]],
            "line 1: no columns `WindSpeed`, `WindAzimuth`; it has StationID",
        ),
        (&[["DateTime", "Date"]], "line 1: no column `DateTime`"),
        (&[["25,0.1,10", "25,0.1"]], "line 2: it has 9 cells, expected 10"),
    ];
    let wxs: &[(&[[&str; 2]], &str)] = &[
        (&[["English", "SI"]], "line 2: expected the units English or Metric"),
        (&[[" 10 270", " 10 -9999"]], "line 5: `from` is -9999"),
        (&[[" 10 270", " -99 270"]], "line 5: `speed` is -99"),
        (&[["7 14 1300", "13 14 1300"]], "line 6: `month` is 13"),
        (&[["7 14 1300", "6 31 1300"]], "line 6: `time` is 1300, expected a time of a day that exists"),
        (&[["1300", "1275"]], "line 6: `time` is 1275"),
        (&[[" 270 10\n2024", " 270\n2024"]], "line 5: it has 9 cells, expected 10"),
        (&[["2024 7 14 1200", "END"], ["2024 7 14 1300", "END"]], "it has no row"),
    ];
    let csv: &[(&[[&str; 2]], &str)] = &[
        (&[["time,", "when,"], ["speed_mps", "speed"]], "line 1: no columns `time`, `speed_mps`; it has when,"),
        (&[["temperature_c", "temperature_f"]], "no column `temperature_c`"),
        (&[[":00,30", ":00-08:00,30"], ["13:00-08:00", "13:00"]], "line 3: `time` is 2024-07-14 13:00"),
        (&[["2024-07-14", "14.07.2024"]], "line 2: `time` is 14.07.2024 12:00, expected a time such as"),
    ];
    for (file, text, cases) in [("a.fw21", FW21, fw21), ("a.wxs", WXS_TEXT, wxs), ("a.csv", CSV, csv)] {
        for (edits, expected) in cases {
            let error = read(file, &edited(text, edits), &with(DeadMoisture::Tables)).err();
            let error = error.unwrap_or_else(|| panic!("it is read: {edits:?}"));
            assert!(error.contains(expected) && error.contains(file), "{error}, expected {expected}");
        }
    }
    for (file, text) in
        [("a.wtr", "ENGLISH\n8 10 0 600 1500 48 99 94 11 2400\n"), ("a.fw13", "W130406092024071412R 86 25\n")]
    {
        assert!(
            read(file, text, &with(DeadMoisture::Fixed)).err().is_some_and(|error| error.contains("this is")),
            "{file}"
        );
    }
}

#[test]
fn what_a_run_does_not_need_may_be_missing() {
    let sparse = "DateTime,WindSpeed(kph),WindAzimuth\n2024-07-14T19:00:00Z,36,270\n2024-07-14T20:00:00Z,36,\n";
    let error = read("a.fw21", sparse, &with(DeadMoisture::Nelson)).err().expect("sticks need more");
    let missing = "no columns `Temperature`, `RelativeHumidity`, `Precipitation`, `SolarRadiation`; it has DateTime";
    assert!(error.contains(missing), "{error}");
    let error = read("a.fw21", sparse, &with(DeadMoisture::Fixed)).err().expect("wind has a direction");
    assert!(error.contains("line 3: `WindAzimuth` is empty"), "{error}");
    // Of two rows each run of half an hour needs only one.
    for (start_h, edit) in [(0.0, ["36,\n", "M,M\n"]), (1.0, ["19:00:00Z,36,270", "19:00:00Z,,"])] {
        let text = edited(sparse, &[edit, ["36,\n", "36,90\n"]][..if start_h == 0.0 { 1 } else { 2 }]);
        let settings = WeatherSettings { start_h, ..WeatherSettings::default() };
        let path = PathBuf::from("a.fw21");
        let stream = WeatherStream::parse(&path, &text, &settings, 0.5 * HOUR).expect("it is right");
        let winds = stream.winds(start_h * HOUR).expect("what it needs is there");
        assert_eq!((winds.len(), winds[0].speed_mps), (1, 10.0));
        assert_eq!(stream.format.notes, ["`WindAzimuth` has no unit; it is taken as degrees."]);
    }
    // Calm air keeps the direction before.
    let calm = edited(CSV, &[["13:00,30,25,5,270", "13:00,30,25,0,"]]);
    let winds = read("a.csv", &calm, &with(DeadMoisture::Fixed)).expect("it is right").winds;
    assert_eq!((winds[1].speed_mps, winds[1].toward_deg), (0.0, 0.0));
}

#[test]
fn local_hours_decide_and_zones_give_them() {
    let moisture = |text: &str, utc_offset_h: Option<f64>| {
        let settings = WeatherSettings { utc_offset_h, ..with(DeadMoisture::Tables) };
        read("a.fw21", text, &settings).expect("it is right").moistures.iter().map(|it| it.d1).collect::<Vec<_>>()
    };
    // 86 F and 25 %: 4 % in Rothermel's table; in the sun of July nothing is added from noon to four.
    let local = moisture(FW21, None);
    assert_eq!(local, [0.04, 0.04], "{local:?}");
    for (time, zone) in [("T19:00:00", "Z"), ("T19:00:00", "+00:00"), ("T14:00:00", "-05:00"), ("T19:00:00", "UTC")] {
        let later = format!("T{}:00:00", time[1..3].parse::<u32>().expect("digits") + 1);
        let utc = edited(
            FW21,
            &[["T12:00:00-07:00", &format!("{time}{zone}")], ["T13:00:00-07:00", &format!("{later}{zone}")]],
        );
        assert_eq!(moisture(&utc, Some(-7.0)), local, "{utc}");
    }
    let named = edited(
        FW21,
        &[["DateTime", "DateTime(UTC)"], ["T12:00:00-07:00", "T19:00:00"], ["T13:00:00-07:00", "T20:00:00"]],
    );
    assert_eq!(moisture(&named, Some(-7.0)), local);
    let unmoved = edited(FW21, &[["-07:00", ""]]);
    let settings = WeatherSettings { utc_offset_h: Some(-7.0), ..with(DeadMoisture::Tables) };
    let weather = read("a.fw21", &unmoved, &settings).expect("it is right");
    assert!(weather.moistures[0].d1 == local[0] && weather.notes[0].contains("`utc_offset_h` has no effect"));
    // In spring clocks skip an hour, in autumn they have one twice.
    for (first, second) in [
        ("2024-03-10T01:30:00-08:00", "2024-03-10T03:30:00-07:00"),
        ("2024-11-03T01:30:00-07:00", "2024-11-03T01:30:00-08:00"),
    ] {
        let text = edited(FW21, &[["2024-07-14T12:00:00-07:00", first], ["2024-07-14T13:00:00-07:00", second]]);
        let winds = read("a.fw21", &text, &with(DeadMoisture::Tables)).expect("it is right").winds;
        assert_eq!(winds[1].at_s, HOUR, "{first}");
    }
}

/// Rows of a CSV file from the beginning of 2000 on: dry days from 8 to 20, moist nights, and the hour as speed.
fn days(count: usize) -> String {
    let months =
        |year| [31, if year % 4 == 0 { 29 } else { 28 }, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31].into_iter().zip(1..);
    let dates = (2000..)
        .flat_map(|year| months(year).flat_map(move |(days, month)| (1..=days).map(move |day| [year, month, day])));
    let row = |[year, month, day]: [u32; 3], hour: u32| {
        let [temperature, humidity, solar] = if (8..20).contains(&hour) { [30, 20, 700] } else { [12, 80, 0] };
        format!("{year}-{month:02}-{day:02} {hour:02}:00,{temperature},{humidity},{hour},270,0,{solar}\n")
    };
    let rows = dates.take(count).flat_map(|date| (0..24).map(move |hour| row(date, hour)));
    "time,temperature_c,humidity_pct,speed_mps,from_deg,rain_mm,solar_w_m2\n".to_owned() + &rows.collect::<String>()
}

#[test]
fn days_are_dry_and_nights_are_moist_by_tables_and_by_sticks() {
    let text = days(3);
    for dead_moisture in [DeadMoisture::Tables, DeadMoisture::Nelson] {
        let settings = WeatherSettings { start_h: 36.0, ..with(dead_moisture) };
        let found = read("weather.csv", &text, &settings).expect("it is hourly").moistures;
        // It starts at noon and takes a day; the last hour of night is 19 hours later.
        let (noon, night) = (&found[2], &found[19]);
        assert_eq!((found.len(), night.at_s), (25, 19.0 * HOUR));
        assert!(noon.d1 < 0.08 && night.d1 > 0.12 && noon.d1 < noon.d10, "{dead_moisture:?}: {noon:?} {night:?}");
    }
    let holed = edited(&text, &[["2000-01-01 05:00", "2000-01-01 05:30"]]);
    let error = read("weather.csv", &holed, &with(DeadMoisture::Nelson)).err().expect("it is not hourly");
    assert!(error.contains("line 7: expected an hour after"), "{error}");
    let clouds = read("a.csv", CSV, &with(DeadMoisture::Nelson)).err().expect("it has no latitude");
    assert!(clouds.contains("expected `weather.latitude_deg`"), "{clouds}");
    let settings = WeatherSettings { latitude_deg: Some(40.0), ..with(DeadMoisture::Nelson) };
    let utc = edited(CSV, &[[":00,", ":00Z,"]]);
    assert!(read("a.csv", &utc, &settings).err().is_some_and(|error| error.contains("`weather.utc_offset_h`")));
    // At 40 degrees north on 21 June the sun of noon is 73 degrees high.
    let june = edited(CSV, &[["2024-07-14", "2026-06-21"]]);
    let stream = WeatherStream::parse(&PathBuf::from("a.csv"), &june, &settings, HOUR).expect("it is right");
    let noon = stream.rows[0].clear_sky_w_m2(40.0);
    assert!((noon - 990.0).abs() < 10.0 && through(1.0) == 0.25, "{noon}");
}

#[test]
fn only_the_rows_of_the_run_are_kept_however_long_a_stream_is() {
    let start_h = 50_000.0;
    let text = days(3653) + "and what comes after is not looked at\n";
    for dead_moisture in [DeadMoisture::Fixed, DeadMoisture::Tables, DeadMoisture::Nelson] {
        let settings = WeatherSettings { start_h, ..with(dead_moisture) };
        let stream = WeatherStream::parse(&PathBuf::from("a.csv"), &text, &settings, 5.5 * HOUR).expect("it is right");
        let history = if dead_moisture == DeadMoisture::Nelson { STICK_HISTORY } else { 1 };
        assert_eq!((stream.rows.len(), stream.first), (history + 5, history - 1));
        let winds = stream.winds(start_h * HOUR).expect("they are numbers");
        // 50,000 hours are 2,083 days and 8 hours: until the 14th of September 2005.
        let found: Vec<_> = winds.iter().map(|wind| (wind.at_s / HOUR, wind.speed_mps)).collect();
        assert_eq!(found, [(0.0, 8.0), (1.0, 9.0), (2.0, 10.0), (3.0, 11.0), (4.0, 12.0), (5.0, 13.0)]);
        assert_eq!(stream.rows[stream.first].month(), 9);
    }
    // Ranges are checked later.
    let wild = WeatherSettings { start_h: -1.0, utc_offset_h: Some(1e300), ..with(DeadMoisture::Tables) };
    let stream = WeatherStream::parse(&PathBuf::from("a.fw21"), FW21, &wild, -1e9).expect("it is right");
    assert_eq!((stream.rows.len(), stream.by_tables().map(|rows| rows.len())), (1, Ok(1)));
    // The last row holds, wherever after it a run begins.
    for start_h in [1.5, 99_999.0] {
        let weather =
            read("a.wxs", WXS_TEXT, &WeatherSettings { start_h, ..with(DeadMoisture::Tables) }).expect("it is right");
        assert_eq!((weather.winds.len(), weather.moistures.len(), weather.winds[0].at_s), (1, 1, 0.0));
        assert!(weather.notes.contains(&"Its last row, of hour 1, holds to the end of the run.".to_owned()));
    }
    let fine: String =
        (0..12_000).map(|at| format!("2024-07-14 {:02}:{:02}:{:02},1,0\n", at / 3600, at / 60 % 60, at % 60)).collect();
    let error = read("a.csv", &format!("time,speed_mps,from_deg\n{fine}"), &with(DeadMoisture::Fixed)).err();
    assert!(error.is_some_and(|error| error.contains("a.csv: a run would keep more than 10000 rows of it")));
}
