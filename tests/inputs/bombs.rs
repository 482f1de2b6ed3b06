//! Small files that would become large ones.

use super::imported;
use super::makers::{doubles, joint_state, linked_to_itself, mat, packed, recording, variable};

#[test]
fn a_recording_that_unpacks_without_end_is_refused() {
    // 1 GB of zeros in some 100 kB, and joint states that are well.
    let names = ["elbow".to_string()];
    let states: Vec<Vec<u8>> = (1..20).map(|at| joint_state(at, &names, &[0.1])).collect();
    let bomb = recording(Some(mcap::Compression::Zstd), &states, &[1 << 24; 64]);
    assert!(bomb.len() < 2_000_000, "{}", bomb.len());
    let said = imported("a.mcap", &bomb).unwrap_err();
    assert!(said.contains("unpacks to more than"), "{said}");
}

#[test]
fn a_joint_of_its_own_for_each_message_is_refused_before_it_fills_the_memory() {
    // A column for each joint, as long as all messages, would be 8 GB.
    let state = |at: i32| {
        let names: Vec<String> = (0..400).map(|joint| format!("{at}_{joint}")).collect();
        joint_state(at, &names, &[0.0; 400])
    };
    let bomb = recording(Some(mcap::Compression::Zstd), &(0..1000).map(state).collect::<Vec<_>>(), &[]);
    match imported("a.mcap", &bomb) {
        Err(said) => assert!(said.contains("unpacks to more than"), "{said}"),
        Ok(all) => assert_eq!(all.iter().map(|series| series.values.len()).max(), Some(1)),
    }
}

#[test]
fn a_mat_that_unpacks_without_end_is_refused() {
    let zeros = packed(&doubles("x", &vec![0.0; 4_000_000]));
    assert!(zeros.len() < 50_000);
    assert_eq!(imported("a.mat", &mat(std::slice::from_ref(&zeros))).unwrap()[0].values.len(), 4_000_000);
    let said = imported("a.mat", &mat(&vec![zeros; 30])).unwrap_err();
    assert!(said.contains("unpacks to more than"), "{said}");
    // Small whole numbers, which become eight times as large.
    let bytes = packed(&variable("x", 8, 1, 100_000_000, &vec![0; 100_000_000]));
    assert!(
        imported("a.mat", &mat(&[bytes]))
            .unwrap_err()
            .contains("`x`: cannot be read as MATLAB's: unpacks to more than")
    );
    // Packed within packed within packed.
    let nested = (0..20_000).fold(doubles("x", &[1.0, 2.0]), |inner, _| {
        [&15u32.to_le_bytes()[..], &(inner.len() as u32).to_le_bytes(), &inner].concat()
    });
    assert!(imported("a.mat", &mat(&[nested])).is_err());
}

#[test]
fn sizes_that_a_mat_only_declares_are_not_allocated() {
    for (rows, bytes) in [(1usize << 30, 1usize << 33), (1 << 20, 8), (usize::MAX >> 33, 16)] {
        let mut file = mat(&[variable("x", 6, 9, rows, &[0; 16])]);
        let at = file.len() - 20;
        file[at..at + 4].copy_from_slice(&(bytes as u32).to_le_bytes());
        assert!(imported("a.mat", &file).is_err(), "{rows}");
    }
}

#[test]
fn an_hdf5_file_that_links_to_itself_is_refused() {
    let bomb = linked_to_itself(250);
    assert!(bomb.len() < 10_000);
    let said = imported("a.mat", &bomb).unwrap_err();
    assert!(said.contains("links to more than") || said.contains("refer to each other without end"), "{said}");
    assert_eq!(imported("a.mat", &linked_to_itself(2)), Ok(Vec::new()));
}

#[test]
fn hdf5_that_unpacks_without_end_is_refused() {
    let build = |count: usize, chunk: u64| {
        let mut builder = hdf5_pure::FileBuilder::new();
        let zeros = vec![0u8; count];
        builder.create_dataset("x").with_u8_data(&zeros).with_chunks(&[chunk]).with_deflate(9);
        builder.finish().unwrap()
    };
    let bomb = build(40_000_000, 1 << 22);
    assert!(bomb.len() < 100_000, "{}", bomb.len());
    let said = imported("a.mat", &bomb).unwrap_err();
    assert!(said.contains("`x`: unpacks to more than"), "{said}");
}

/// Room for a chunk is made by its declared size: 4 GB in a file of 15 kB.
#[test]
fn hdf5_that_declares_more_than_it_holds_is_refused_before_it_is_read() {
    let bomb = include_bytes!("../fuzz/corpus/mat73/chunk_of_4_gb");
    let said = imported("a.mat", bomb).unwrap_err();
    assert!(said.contains("`t`: the file declares more of it than it holds"), "{said}");
}
