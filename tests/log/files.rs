//! Logs: forms of CSV that are accepted, faults that are told, Parquet as good as CSV.

use super::{CAMPAIGN, faults, folder, read_first, sweep, with_row};
use polars::prelude::{Column, DataFrame, ParquetWriter};
use std::f64::consts::PI;
use tautline::dynamics::JointKind;
use tautline::log::{Campaign, Log};
use tautline::problem::Result;
use tautline::units::{Quantity, Unit};

#[test]
fn a_log_comes_in_si_and_with_its_sign() {
    let log = read_first(folder(CAMPAIGN, sweep()).path()).expect("reads");
    assert!((log.rate_hz - 1000.0).abs() < 1e-9, "{}", log.rate_hz);
    assert_eq!((log.time_s.len(), log.time_s[999]), (1000, 0.999));
    assert!((log.position_rad[999] - 999.0 * 0.03 * PI / 180.0).abs() < 1e-15);
    assert_eq!(log.torque_nm[3], -(3.0_f64 * 0.7).sin());
    assert!(log.warnings.is_empty() && log.clipped.is_empty());
}

#[test]
fn other_forms_of_the_same_log_read_the_same() {
    let plain = sweep();
    let with_more_columns = plain.lines().map(|line| format!("text,{line},\"a, b\"\n")).collect();
    let commas = |text: &str| text.replace(',', ";").replace('.', ",");
    let forms: [(&str, String); 15] = [
        ("semicolons", plain.replace(',', ";")),
        ("tabs", plain.replace(',', "\t")),
        ("semicolons and decimal commas", commas(&plain)),
        ("lines before the header", format!("Test 12\nby,me,\n\n{plain}")),
        ("a row of units", plain.replacen("trq\n", "trq\ns,\u{b0},[Nm]\n", 1)),
        ("rows of units and of types", plain.replacen("trq\n", "trq\ns,\u{b0},[Nm]\nFloat64,Float64,Float64\n", 1)),
        ("blanks between, header behind a sign of comment", format!("# {}", plain.replace(',', " "))),
        ("tabs, decimal commas, units, lines before", {
            let text = commas(&plain.replacen("trq\n", "trq\ns,deg,N m\n", 1)).replace(';', "\t");
            format!("Rig;3\n\n{text}")
        }),
        ("two-byte row ends", plain.replace('\n', "\r\n")),
        ("byte order mark", format!("\u{feff}{plain}")),
        ("blanks", plain.replace(',', " ,\t ")),
        ("blank rows", plain.replace("\n0.5", "\n\n\n0.5")),
        ("exponents", with_row(&plain, 3, |_| "1e-3,3.0E-2,6.44217687237691e-1\n".to_string())),
        ("quotes", plain.replacen("t,pos,trq", "\"t\",\"pos\",\" trq \"", 1).replacen("0.0010,", "\"0.0010\",", 1)),
        ("more columns", with_more_columns),
    ];
    let expected = read_first(folder(CAMPAIGN, &plain).path()).expect("reads");
    for (form, text) in forms {
        let mut log = read_first(folder(CAMPAIGN, &text).path()).unwrap_or_else(|found| panic!("{form}: {found}"));
        log.file = expected.file.clone();
        assert!(log == expected, "{form}");
    }
}

#[test]
fn other_encodings_read_the_same() {
    let campaign = CAMPAIGN.replace("\"pos\"", "\"Winkel \u{b0}\"");
    let text = sweep().replacen("pos", "Winkel \u{b0}", 1);
    let expected = read_first(folder(&campaign, &text).path()).expect("reads");
    let utf_16 = |bytes: fn(u16) -> [u8; 2]| -> Vec<u8> {
        "\u{feff}".encode_utf16().chain(text.encode_utf16()).flat_map(bytes).collect()
    };
    let latin: Vec<u8> = text.chars().map(|sign| u32::from(sign) as u8).collect();
    for bytes in [latin, utf_16(u16::to_le_bytes), utf_16(u16::to_be_bytes)] {
        let mut log = read_first(folder(&campaign, bytes).path()).expect("reads");
        log.file = expected.file.clone();
        assert!(log == expected);
    }
}

#[test]
fn scale_offset_rate_and_rows_are_applied() {
    let scaled = CAMPAIGN.replace("unit = \"N m\"", "unit = \"N m\", scale = 2.0, offset = 0.5");
    let (plain, log) =
        (read_first(folder(CAMPAIGN, sweep()).path()).unwrap(), read_first(folder(&scaled, sweep()).path()).unwrap());
    assert!(plain.torque_nm.iter().zip(&log.torque_nm).all(|(a, b)| (2.0 * a - 0.5 - b).abs() < 1e-12));

    let columns = CAMPAIGN.replace("time = { name = \"t\", unit = \"s\" }\n", "");
    let rated = columns.replace("[joint]", "[files]\nrate_hz = 1000.0\n\n[joint]");
    let untimed: String = sweep().lines().map(|line| line.split_once(',').unwrap().1.to_string() + "\n").collect();
    let log = read_first(folder(&rated, &untimed).path()).expect("reads");
    assert!((log.rate_hz - 1000.0).abs() < 1e-9 && log.torque_nm == plain.torque_nm, "{}", log.rate_hz);

    let part = CAMPAIGN.replace("file = \"a.csv\"", "file = \"a.csv\"\nrows = [100, 900]");
    let log = read_first(folder(&part, sweep()).path()).expect("reads");
    assert!(log.torque_nm == plain.torque_nm[100..900] && (log.time_s[0] - 0.1).abs() < 1e-12);
    let bytes = parquet(|_, torque| Some(torque));
    assert!(read_parquet(&part, &bytes).expect("reads").torque_nm == plain.torque_nm[100..900]);
    // A fault is told by its row in the file.
    let damaged = with_row(&sweep(), 500, |_| "0.498,abc,0.1\n".to_string());
    assert_eq!(faults(&part, &damaged)[0].row, Some(500));
}

#[test]
fn torque_comes_from_current_by_its_constant() {
    let of_current =
        CAMPAIGN.replace("torque = { name = \"trq\", unit = \"N m\" }", "current = { name = \"trq\", unit = \"mA\" }");
    let plain = read_first(folder(CAMPAIGN, sweep()).path()).unwrap();
    let known = of_current.replace("backlash_m", "torque_constant_nm_a = 0.05\ngear_ratio = 4.0\nbacklash_m");
    let log = read_first(folder(&known, sweep()).path()).expect("reads");
    assert!(plain.torque_nm.iter().zip(&log.torque_nm).all(|(y, i)| (i - 2e-4 * y).abs() < 1e-12));
    let unknown = Campaign::read(folder(&of_current, sweep()).path()).expect("reads");
    assert!(unknown.warnings.iter().any(|problem| problem.what.contains("up to one factor")), "{:?}", unknown.warnings);
}

#[test]
fn each_fault_is_named_with_row_column_and_cure() {
    let good = sweep();
    let field = |row: usize, place: usize, text: &str| {
        with_row(&good, row, |line| {
            let mut fields: Vec<&str> = line.split(',').collect();
            fields[place] = text;
            fields.join(",") + "\n"
        })
    };
    let every = |change: &dyn Fn(&[&str]) -> String| {
        let one = |line: &str| change(&line.split(',').collect::<Vec<_>>()) + "\n";
        format!("t,pos,trq\n{}", good.lines().skip(1).map(one).collect::<String>())
    };
    let without = |from: usize, to: usize| -> String {
        let kept = good.lines().enumerate().filter(|(index, _)| !(from..=to).contains(&(index + 1)));
        kept.map(|(_, line)| format!("{line}\n")).collect()
    };
    let cases: Vec<(String, Option<u64>, Option<&str>, &str)> = vec![
        (String::new(), None, None, "is empty"),
        ("t,pos,trq\n".to_string(), None, None, "holds no row of numbers"),
        ("# rig 3\n# by jo\nt;pos;trq\n".to_string(), None, None, "holds no row of numbers"),
        (without(17, 1001), None, None, "has 15 samples"),
        (without(300, 1001), None, Some("t"), "record for 0.400 s or longer"),
        (field(7, 2, "abc"), Some(7), Some("trq"), "holds `abc`"),
        (field(7, 2, "1,5"), Some(7), None, "4 fields where the header has 3"),
        (field(7, 2, ""), Some(7), Some("trq"), "is empty"),
        (field(7, 1, "NaN"), Some(7), Some("pos"), "holds `NaN`"),
        (field(7, 0, "-inf"), Some(7), Some("t"), "holds `-inf`"),
        (field(7, 1, "1e999"), Some(7), Some("pos"), "holds `1e999`"),
        (field(7, 1, "0x10"), Some(7), Some("pos"), "expected a number in deg"),
        (field(7, 2, "\"1.0"), Some(7), Some("trq"), "holds `1.0"),
        (with_row(&good, 7, |_| "0.0050\n".to_string()), Some(7), None, "1 fields where"),
        (field(8, 0, "0.0050"), Some(8), Some("t"), "0.005 s comes after 0.005 s"),
        (field(8, 0, "0.0040"), Some(8), Some("t"), "time must grow"),
        (without(500, 502), Some(500), Some("t"), "a gap of 0.004000 s before this row: 4.0 sample periods"),
        (good.replacen("trq", "torque", 1), Some(1), Some("trq"), "t, pos, torque"),
        (good.replacen("trq", "trq1", 1), Some(1), Some("trq"), "did you mean `trq1`?"),
        (good.replacen("pos,trq", "trq,trq", 1), Some(1), Some("trq"), "twice"),
        (good.replacen("t,pos,trq\n", "", 1), Some(1), Some("t"), "add a header"),
        (every(&|at| format!("{},{},0.5", at[0], at[1])), None, Some("trq"), "reads 0.5 N m throughout"),
        (every(&|at| format!("{},10,{}", at[0], at[2])), None, Some("pos"), "reads 10 deg throughout"),
        (
            every(&|at| format!("{}00,{},{}", at[0].replace('.', ""), at[1], at[2])),
            None,
            Some("t"),
            "too slowly for a low-pass",
        ),
    ];
    for (log, row, column, words) in cases {
        let found = faults(CAMPAIGN, &log);
        let Some(problem) = found.iter().find(|problem| problem.to_string().contains(words)) else {
            panic!("{words}: {found:#?}")
        };
        assert_eq!((problem.row, problem.column.as_deref()), (row, column), "{problem}");
        assert!(problem.file.ends_with("a.csv") && !problem.cure.is_empty(), "{problem}");
    }
}

#[test]
fn rows_are_right_beyond_blank_rows_and_two_byte_row_ends() {
    for end in ["\n", "\r\n"] {
        let text =
            with_row(&sweep(), 7, |line| format!("\n\n{line}\n")).replace("0.0090,", "0.0080,").replace('\n', end);
        let found = faults(CAMPAIGN, &text);
        assert_eq!((found.len(), found[0].row), (1, Some(13)), "{found:?}");
    }
}

#[test]
fn a_long_list_of_faults_is_cut_short_with_its_count() {
    let found = faults(CAMPAIGN, sweep().replace(",0.", ",?0."));
    let last = found.last().expect("faults").to_string();
    assert_eq!(found.len(), 21);
    assert!(last.contains("more rows with no number"), "{last}");
}

#[test]
fn a_log_of_another_kind_is_refused() {
    let folder = folder(&CAMPAIGN.replace("a.csv", "a.mat"), "");
    std::fs::write(folder.path().join("a.mat"), "").expect("writes");
    let found = read_first(folder.path()).expect_err("refused").to_string();
    assert!(found.contains(".csv or .parquet"), "{found}");
}

#[test]
fn every_unit_reads_as_the_same_si_value() {
    let unit_cases = [JointKind::Revolute, JointKind::Prismatic].map(|kind| (kind, Quantity::Position.units(kind)));
    for (kind, unit) in unit_cases.iter().flat_map(|(kind, units)| units.iter().map(move |unit| (kind, unit))) {
        let mut campaign = CAMPAIGN.replace("\"deg\"", &format!("\"{}\"", unit.name()));
        if *kind == JointKind::Prismatic {
            campaign = campaign.replace("0.012\np", "1.0\np").replace("0.040", "1.0").replace("N m", "N");
            campaign = campaign.replace("revolute", "prismatic").replace("uniform", "free");
            campaign = campaign.replace("speed_rad_s = 0.5\n", "");
        }
        let text = super::csv(1000, |row| (row as f64 * 1e-3 / unit.factor(), (row as f64 * 0.7).sin()));
        let log = read_first(folder(&campaign, text).path()).expect("reads");
        assert!((log.position_rad[500] - 0.5).abs() < 1e-15, "{}", unit.name());
    }
    assert!((Unit::Rpm.factor() * 60.0 - 2.0 * PI).abs() < 1e-15);
    assert!(Unit::ALL.iter().all(|unit| unit.factor() > 0.0 && !unit.name().is_empty()));
}

/// The sweep as Parquet, its torque first put through `change`.
pub(super) fn parquet(change: impl Fn(usize, f64) -> Option<f64>) -> Vec<u8> {
    let rows = |place: usize| -> Vec<f64> {
        let number = |line: &str| line.split(',').nth(place).and_then(|field| field.parse().ok());
        sweep().lines().skip(1).filter_map(number).collect()
    };
    let torque: Vec<Option<f64>> = rows(2).into_iter().enumerate().map(|(row, torque)| change(row, torque)).collect();
    let names: Vec<String> = rows(0).iter().map(f64::to_string).collect();
    let columns = [
        Column::new("text".into(), names),
        Column::new("trq".into(), torque),
        Column::new("pos".into(), rows(1)),
        Column::new("t".into(), rows(0)),
    ];
    let mut frame = DataFrame::new_infer_height(columns.into()).expect("a frame");
    let mut bytes = Vec::new();
    ParquetWriter::new(&mut bytes).finish(&mut frame).expect("writes");
    bytes
}

/// What comes of these bytes as a Parquet log.
pub(super) fn read_parquet(campaign: &str, bytes: &[u8]) -> Result<Log> {
    let folder = folder(&campaign.replace("a.csv", "a.parquet"), "");
    std::fs::write(folder.path().join("a.parquet"), bytes).expect("writes");
    read_first(folder.path())
}

#[test]
fn parquet_reads_like_csv() {
    let expected = read_first(folder(CAMPAIGN, sweep()).path()).expect("reads");
    let mut log = read_parquet(CAMPAIGN, &parquet(|_, torque| Some(torque))).expect("reads");
    log.file = expected.file.clone();
    assert!(log == expected);
}

#[test]
fn parquet_holes_and_texts_are_faults() {
    for hole in [None, Some(f64::NAN), Some(f64::INFINITY)] {
        let bytes = parquet(|row, torque| if row == 5 { hole } else { Some(torque) });
        let found = read_parquet(CAMPAIGN, &bytes).expect_err("a fault").0;
        assert_eq!((found.len(), found[0].row, found[0].column.as_deref()), (1, Some(7), Some("trq")));
    }
    let found = read_parquet(&CAMPAIGN.replace("\"trq\"", "\"text\""), &parquet(|_, torque| Some(torque)));
    let found = found.expect_err("a fault").to_string();
    assert!(found.contains("`text`: holds str; expected numbers in N m"), "{found}");
}

#[test]
fn dates_and_times_are_time_stamps() {
    let plain = read_first(folder(CAMPAIGN, sweep()).path()).unwrap();
    let text = sweep();
    let mut lines = text.lines();
    let header = lines.next().unwrap();
    let stamped = |line: &str| {
        let (t, rest) = line.split_once(',').unwrap();
        format!("2025-03-04T12:00:{:07.4}Z,{rest}\n", 10.0 + t.parse::<f64>().unwrap())
    };
    let log = read_first(folder(CAMPAIGN, format!("{header}\n{}", lines.map(stamped).collect::<String>())).path());
    let log = log.expect("reads");
    assert!((log.rate_hz - 1000.0).abs() < 1e-3 && log.torque_nm == plain.torque_nm, "{}", log.rate_hz);

    // As pandas writes it: datetime64[us], and timedelta64[us], a count in the unit that the campaign names.
    let bytes = std::fs::read("tests/reference/import/datetime.parquet").unwrap();
    for column in ["name = \"t\", unit = \"s\"", "name = \"elapsed\", unit = \"us\""] {
        let campaign = CAMPAIGN.replace("name = \"t\", unit = \"s\"", column);
        let log = read_parquet(&campaign, &bytes).expect("reads");
        assert!((log.rate_hz - 1000.0).abs() < 1e-3, "{column}: {}", log.rate_hz);
    }
}
