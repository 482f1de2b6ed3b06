//! Damaged files are refused or read, never a crash.

use super::files::{parquet, read_parquet};
use super::{CAMPAIGN, folder, read_first, sweep};
use proptest::prelude::*;
use tautline::document::Document;

/// `bytes` with some of them overwritten, removed or put in.
fn damage(bytes: &[u8], edits: &[(prop::sample::Index, u8, u8)]) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for (place, kind, byte) in edits {
        let place = place.index(bytes.len().max(1));
        match kind % 4 {
            0 if place < bytes.len() => bytes[place] = *byte,
            1 if place < bytes.len() => drop(bytes.remove(place)),
            2 => bytes.truncate(place),
            _ => bytes.insert(place, *byte),
        }
    }
    bytes
}

fn edits() -> impl Strategy<Value = Vec<(prop::sample::Index, u8, u8)>> {
    prop::collection::vec((any::<prop::sample::Index>(), 0_u8..8, any::<u8>()), 1..6)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn any_text_as_document(text in "[\\[\\]{}=.,\"'a-c0-9 \n_-]{0,60}") {
        let _ = Document::from_toml("x.toml".as_ref(), &text);
        let _ = Document::from_json("x.json".as_ref(), &text);
    }

    #[test]
    fn any_bytes_as_campaign(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        let folder = folder("", sweep());
        std::fs::write(folder.path().join("campaign.toml"), bytes).expect("writes");
        prop_assert!(read_first(folder.path()).is_err());
    }

    #[test]
    fn a_damaged_campaign(edits in edits()) {
        let folder = folder("", sweep());
        std::fs::write(folder.path().join("campaign.toml"), damage(CAMPAIGN.as_bytes(), &edits)).expect("writes");
        if let Err(problems) = read_first(folder.path()) {
            prop_assert!(!problems.0.is_empty());
        }
    }

    #[test]
    fn any_bytes_as_log(bytes in prop::collection::vec(any::<u8>(), 0..300), with_header in any::<bool>()) {
        let header: &[u8] = if with_header { b"t,pos,trq\n" } else { b"" };
        prop_assert!(read_first(folder(CAMPAIGN, [header, &bytes].concat()).path()).is_err());
    }

    #[test]
    fn a_damaged_log(edits in edits()) {
        let folder = folder(CAMPAIGN, damage(sweep().as_bytes(), &edits));
        match read_first(folder.path()) {
            Ok(log) => prop_assert!(log.time_s.is_sorted() && log.torque_nm.len() == log.time_s.len()),
            Err(problems) => prop_assert!(problems.0.iter().all(|problem| problem.file.ends_with("a.csv"))),
        }
    }

    // Cut short only: a page whose header gives a negative count makes Polars ask for more memory than there is.
    #[test]
    fn a_parquet_log_cut_short(cut in any::<prop::sample::Index>()) {
        let whole = parquet(|_, torque| Some(torque));
        prop_assert!(read_parquet(CAMPAIGN, &whole[..cut.index(whole.len())]).is_err());
    }

    #[test]
    fn numbers_of_any_size(numbers in prop::collection::vec(prop::num::f64::ANY, 60)) {
        let rows: String = numbers.chunks(3).map(|row| format!("{:e},{:e},{:e}\n", row[0], row[1], row[2])).collect();
        let _ = read_first(folder(CAMPAIGN, format!("t,pos,trq\n{rows}")).path());
    }

    #[test]
    fn positions_and_torques_of_any_size(numbers in prop::collection::vec(prop::num::f64::NORMAL, 1000)) {
        let row = |(index, pair): (usize, &[f64])| format!("{},{},{}\n", index as f64 * 1e-3, pair[0], pair[1]);
        let rows: String = numbers.chunks(2).enumerate().map(row).collect();
        let _ = read_first(folder(CAMPAIGN, format!("t,pos,trq\n{rows}")).path());
    }
}

proptest! {
    /// The reader's short cut for plain decimals rounds as the standard library does, to the last bit.
    #[test]
    fn decimals_read_to_the_last_bit(numbers in prop::collection::vec((any::<bool>(), 0u64..10_000_000, 0usize..9, 0u64..1_000_000_000), 40)) {
        let texts: Vec<String> = numbers
            .iter()
            .map(|(negative, whole, digits, decimals)| {
                let sign = if *negative { "-" } else { "" };
                let decimals: String = format!("{decimals:09}").chars().take(*digits).collect();
                format!("{sign}{whole}.{decimals}")
            })
            .collect();
        let rows = texts.iter().enumerate().map(|(i, x)| format!("{:.2},{i},{x}\n", i as f64 * 0.02));
        let log = read_first(folder(CAMPAIGN, format!("t,pos,trq\n{}", rows.collect::<String>())).path());
        let log = log.map_err(|problems| TestCaseError::fail(problems.to_string()))?;
        prop_assert_eq!(log.torque_nm.len(), texts.len());
        for (ours, text) in log.torque_nm.iter().zip(&texts) {
            prop_assert_eq!((-ours).to_bits(), text.parse::<f64>().unwrap().to_bits(), "{}", text);
        }
    }
}
