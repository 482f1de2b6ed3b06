//! How large an input may be, and how much it may make the program allocate.
//!
//! A file is not trusted: it may declare more than it holds, or unpack to a thousand times its size. Every limit on that stands
//! here, far above what a log, a campaign or a URDF needs, and is checked before memory is allocated wherever the format
//! declares a size. Together they hold any input of under 10 MB to less than 1 GB of memory.

/// Bytes of numbers (8 each) that any file may become, however small: 16 million readings.
pub const UNPACKED_MIN_BYTES: u64 = 128 << 20;
/// Beyond that, bytes of numbers per byte of file. Recorded signals compress by 2 to 10.
pub const UNPACKED_PER_BYTE: u64 = 16;
/// Bytes that are unpacked and passed over (messages of other topics) take time but no memory: this many count as one that is kept.
pub const PASSED_OVER_PER_KEPT: u64 = 2;

/// Longest line of a CSV file or stream, bytes: 10,000 columns of 100 characters.
pub const LINE_BYTES: usize = 1 << 20;
/// Most columns of a table.
pub const COLUMNS: usize = 10_000;
/// Most columns that one matrix of a `.mat` gives: wider is a picture or a field, no log.
pub const MATRIX_COLUMNS: usize = 512;

/// Largest record or chunk of an MCAP recording, unpacked, bytes. Writers close a chunk at 1 to 8 MB.
pub const MCAP_RECORD_BYTES: usize = 64 << 20;
/// Most joints in one message.
pub const MESSAGE_JOINTS: usize = 4096;

/// Structures within structures of a `.mat` of version 7.3 that are looked into.
pub const STRUCTURE_DEPTH: usize = 4;
/// Most names that are looked at in an HDF5 file. Links may form a graph, in which every path counts.
pub const HDF5_LINKS: usize = 5_000;
/// Bytes that may be read of an HDF5 file in all, however small it is ...
pub const HDF5_READ_BYTES: u64 = 32 << 20;
/// ... and beyond that for each of its bytes: data are read once, headers and indexes several times.
pub const HDF5_READ_PER_BYTE: u64 = 16;
/// Largest page header of a Parquet file, bytes; with statistics of numbers it takes under 200.
pub const PAGE_HEADER_BYTES: usize = 1 << 16;

/// Largest TOML or JSON file, bytes: a campaign of 40,000 trials takes 5 MB; keys take the parser 0.3 s per MB.
pub const DOCUMENT_BYTES: u64 = 6 << 20;
/// Largest EtherCAT slave information file, bytes: makers with hundreds of devices publish some of 20 MB.
pub const ESI_BYTES: u64 = 64 << 20;
/// Largest URDF, bytes. Meshes are files of their own.
pub const URDF_BYTES: u64 = 8 << 20;
/// Most elements of a URDF: a humanoid's has 3,000.
pub const URDF_ELEMENTS: usize = 30_000;
/// Elements within elements of a URDF; the format itself needs 5, extensions of simulators some more. The parser recurses.
pub const URDF_DEPTH: usize = 64;

/// Faults of one kind in one file that are listed; the rest is counted: the reader has seen the pattern.
pub const FAULTS_LISTED: usize = 20;
/// Problems in all that are printed; the rest is counted, and is in the JSON.
pub const PROBLEMS_PRINTED: usize = 200;
/// Names listed in a message ...
pub const NAMES_LISTED: usize = 20;
/// ... and characters shown of each.
pub const NAME_CHARS: usize = 60;
/// Names that are searched for the one that was meant, and its longest, characters: the comparison takes their product.
pub const NAMES_COMPARED: usize = 1000;

/// What a file may still become, in bytes.
#[derive(Debug)]
pub struct Budget {
    file_bytes: u64,
    left: u64,
}

impl Budget {
    /// For a file of this size.
    pub fn of_file(file_bytes: u64) -> Self {
        Self { file_bytes, left: UNPACKED_MIN_BYTES.saturating_add(file_bytes.saturating_mul(UNPACKED_PER_BYTE)) }
    }

    /// Takes `bytes` before they are allocated. Errors: what is wrong, where no more may be.
    pub fn take(&mut self, bytes: u64) -> Result<(), String> {
        match self.left.checked_sub(bytes) {
            Some(left) => {
                self.left = left;
                Ok(())
            }
            None => {
                let megabytes = |bytes: u64| bytes as f64 / 1e6;
                let all = Self::of_file(self.file_bytes).left;
                Err(format!(
                    "unpacks to more than {:.0} MB from {:.3} MB, which no recording does",
                    megabytes(all),
                    megabytes(self.file_bytes)
                ))
            }
        }
    }

    /// Takes room for `count` numbers.
    pub fn take_numbers(&mut self, count: u64) -> Result<(), String> {
        self.take(count.saturating_mul(8))
    }
}

/// `name` as a message shows it: its beginning, where it is long.
pub fn shown(name: &str) -> String {
    match name.char_indices().nth(NAME_CHARS) {
        Some((end, _)) => format!("{}...", &name[..end]),
        None => name.to_string(),
    }
}

/// `names` as a message lists them: the first of them, and how many more there are.
pub fn listed<'a>(names: impl IntoIterator<Item = &'a str>) -> String {
    let mut names = names.into_iter();
    let first: Vec<&str> = names.by_ref().take(NAMES_LISTED).collect();
    and_more(&first, names.count())
}

fn and_more(first: &[&str], more: usize) -> String {
    let first = first.iter().map(|name| shown(name)).collect::<Vec<_>>().join(", ");
    if more == 0 { first } else { format!("{first} and {more} more") }
}
