//! Recordings of other programs: every bit counts, and no row is dropped unsaid.

use super::makers::{doubles, joint_state, mat, packed, recording, variable};
use super::{imported, reference, values, written};
use proptest::prelude::*;
use std::path::Path;
use tautline::import::{picked, read};

/// An LZ4 recording of two joints: 400 messages in chunks with CRCs.
fn joint_states(compression: Option<mcap::Compression>) -> Vec<u8> {
    let names = ["elbow".to_string(), "wrist".to_string()];
    let state = |at: i32| joint_state(at, &names, &[(f64::from(at) * 0.1).sin(), f64::from(at)]);
    recording(compression, &(1..=400).map(state).collect::<Vec<_>>(), &[])
}

#[test]
fn a_flipped_bit_in_a_recording_is_found() {
    for compression in [None, Some(mcap::Compression::Lz4), Some(mcap::Compression::Zstd)] {
        let whole = joint_states(compression);
        let truth = imported("a.mcap", &whole).unwrap();
        assert_eq!(values(&truth, "elbow.position").len(), 400);
        for at in (8..whole.len() - 8).step_by(whole.len() / 400) {
            let mut damaged = whole.clone();
            damaged[at] ^= 1 << (at % 8);
            if let Ok(found) = imported("a.mcap", &damaged) {
                assert_eq!(found, truth, "{compression:?}: bit {} of byte {at} went unseen", at % 8);
            }
        }
    }
}

#[test]
fn a_flipped_bit_in_a_packed_mat_is_found() {
    let positions: Vec<f64> = (0..500).map(|i| (f64::from(i) * 0.1).sin()).collect();
    let whole = mat(&[packed(&doubles("t", &positions))]);
    let truth = imported("a.mat", &whole).unwrap();
    for at in (136..whole.len()).step_by(11) {
        let mut damaged = whole.clone();
        damaged[at] ^= 1 << (at % 8);
        if let Ok(found) = imported("a.mat", &damaged) {
            assert!(found == truth || found.is_empty(), "bit {} of byte {at} went unseen", at % 8);
        }
    }
    let cut = imported("a.mat", &whole[..whole.len() - 30]).unwrap_err();
    assert!(cut.contains("cut off"), "{cut}");
}

#[test]
fn hdf5_checksums_of_data_are_verified() {
    let positions: Vec<f64> = (0..2000).map(|i| (f64::from(i) * 0.1).sin()).collect();
    let mut builder = hdf5_pure::FileBuilder::new();
    builder.create_dataset("q").with_f64_data(&positions).with_chunks(&[500]).with_fletcher32();
    let whole = builder.finish().unwrap();
    assert_eq!(values(&imported("a.mat", &whole).unwrap(), "q"), positions);
    let needle = positions[700].to_le_bytes();
    let at = whole.windows(8).position(|bytes| bytes == needle).expect("is there");
    let mut damaged = whole;
    damaged[at + 5] ^= 4;
    let said = imported("a.mat", &damaged).unwrap_err();
    assert!(said.contains("`q`"), "{said}");
}

#[test]
fn whole_numbers_of_every_kind_are_read() {
    let bytes = |values: &[i32], size: usize| -> Vec<u8> {
        values.iter().flat_map(|x| i64::from(*x).to_le_bytes()[..size].to_vec()).collect()
    };
    let signed = [-70_000, -1, 0, 2_000_000_000];
    let small = [-7, -1, 0, 100];
    let file = mat(&[
        variable("int32", 12, 5, 4, &bytes(&signed, 4)),
        variable("narrow", 12, 3, 4, &bytes(&small, 2)),
        variable("int64", 14, 12, 4, &bytes(&signed, 8)),
        variable("int8", 8, 1, 4, &bytes(&small, 1)),
        variable("as_int8", 6, 1, 4, &bytes(&small, 1)),
        variable("uint32", 13, 6, 2, &[0xff, 0xff, 0xff, 0xff, 1, 0, 0, 0]),
        packed(&variable("packed", 12, 5, 4, &bytes(&signed, 4))),
    ]);
    let all = imported("a.mat", &file).unwrap();
    for name in ["int32", "int64", "packed"] {
        assert_eq!(values(&all, name), signed.map(f64::from), "{name}");
    }
    for name in ["narrow", "int8", "as_int8"] {
        assert_eq!(values(&all, name), small.map(f64::from), "{name}");
    }
    assert_eq!(values(&all, "uint32"), [4294967295.0, 1.0]);
}

/// What is picked of `t` and `q`, or the refusal; and the warnings.
fn picked_of(q: &[f64]) -> Result<(usize, String), String> {
    let t: Vec<f64> = (0..q.len()).map(|i| i as f64 * 0.01).collect();
    let (_folder, file) = written("a.mat", &mat(&[doubles("t", &t), doubles("q", q)]));
    let all = read(&file).unwrap().unwrap();
    let picked = picked(&file, &all, &["t", "q"]).map_err(|problems| problems.to_string())?;
    let told: Vec<String> = picked.warnings.iter().map(ToString::to_string).collect();
    Ok((picked.columns[1].len(), told.join("\n")))
}

#[test]
fn missing_readings_are_refused_by_row_and_what_fills_the_end_is_told() {
    let motion: Vec<f64> = (0..50).map(f64::from).collect();
    assert_eq!(picked_of(&motion), Ok((50, String::new())));
    assert!(picked(Path::new("a.mat"), &[], &[]).unwrap_err().to_string().contains("no column of it is named"));
    for fault in [f64::NAN, f64::INFINITY] {
        let mut holed = motion.clone();
        holed[6] = fault;
        let said = picked_of(&holed).unwrap_err();
        assert!(said.contains("a.mat, row 7, `q`: holds ") && said.contains("; mend or cut"), "{said}");
    }
    let mut padded = motion.clone();
    padded[40..].fill(f64::NAN);
    let (rows, told) = picked_of(&padded).unwrap();
    assert!(rows == 40 && told.contains("row 41: the last 10 of 50 rows hold no reading"), "{rows}: {told}");
    let mut many = motion;
    many[..45].fill(f64::NAN);
    let said = picked_of(&many).unwrap_err();
    assert!(said.lines().count() == 21 && said.contains("and 25 more rows"), "{said}");
}

#[test]
fn joints_that_report_apart_have_their_own_times() {
    let names = |name: &str| vec![name.to_string()];
    let state = |at: i32| joint_state(at, &names(if at % 4 == 0 { "gripper" } else { "elbow" }), &[f64::from(at)]);
    let (_folder, file) = written("a.mcap", &recording(None, &(1..=8).map(state).collect::<Vec<_>>(), &[]));
    let all = read(&file).unwrap().unwrap();
    let of = |joint: &str| -> Vec<Vec<i64>> {
        let columns = picked(&file, &all, &["time", joint]).unwrap().columns;
        columns.iter().map(|values| values.iter().map(|value| value.round() as i64).collect()).collect()
    };
    assert_eq!(of("elbow.position"), [[0, 1, 2, 4, 5, 6], [1, 2, 3, 5, 6, 7]]);
    assert_eq!(of("gripper.position"), [[3, 7], [4, 8]]);
}

#[test]
fn exports_of_the_scope_are_whole_or_refused() {
    let whole = String::from_utf8(reference("scope_tabs.csv")).unwrap();
    let lines: Vec<&str> = whole.split_inclusive('\n').collect();
    for kept in [40, 200, lines.len() - 4] {
        let said = imported("a.csv", lines[..kept].concat().as_bytes()).unwrap_err();
        assert!(said.contains("it was cut"), "{kept}: {said}");
    }
    let picked_of = |text: &str| {
        let (_folder, file) = written("a.csv", text.as_bytes());
        let all = read(&file).map_err(|problems| problems.to_string())?.unwrap();
        picked(&file, &all, &["time", "position"]).map(|found| found.columns).map_err(|problems| problems.to_string())
    };
    for (text, expected) in [
        ("Name;position\n0;1\n1;nan\n2;3\n", "row 3, `position`: holds no number"),
        ("Name;position\n0;1\n1;\n2;3\n", "row 3, `position`: holds no number"),
        ("Name;position\n0;1\n\n2;3\n", "row 3: is blank"),
        ("Name;position\n0;1\n1;2;3\n", "row 3: has more numbers"),
        ("Name;position;Name;b\n0;1;0;1\n1;2;;2\n2;3;;\n", "`b` goes on where its times have ended, in line 3"),
        ("Name;position\n0;1\n1;2\nEOF\n2;3\n", "row 5: goes on behind EOF"),
    ] {
        let said = picked_of(text).unwrap_err();
        assert!(said.contains(expected), "{text}: {said}");
    }
    assert_eq!(picked_of("Name;position\n0;1\n1;2\n\nEOF\n").unwrap()[1], [1.0, 2.0]);
}

proptest! {
    /// A row cut anywhere is refused, or said to be left out.
    #[test]
    fn a_cut_export_is_never_shortened_unsaid(cut in 1500usize..9500) {
        let whole = reference("scope_tabs.csv");
        let (_folder, file) = written("a.csv", &whole[..cut]);
        if let Ok(Some(all)) = read(&file) {
            let found = picked(&file, &all, &["time", "position", "torque"]);
            prop_assert!(found.is_err() || !found.unwrap().warnings.is_empty() || cut + 40 > whole.len());
        }
    }
}
