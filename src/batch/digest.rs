//! What a result depends on, as one number: if it is the same, the result would be.

use super::manifest::Entry;
use super::work::Settings;
use crate::prepare::read_campaign;
use std::fs::File;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::Read;
use std::path::{Path, PathBuf};

/// Bytes read at a time.
const CHUNK: usize = 1 << 16;

/// Of this version, `settings` and every file that `entry` is worked out from, as 16 hexadecimal digits.
///
/// SipHash of 64 bits: nobody forges campaigns, and of a million changes one in 10^13 is missed.
pub fn of(entry: &Entry, settings: &Settings) -> String {
    let mut hasher = DefaultHasher::new();
    env!("CARGO_PKG_VERSION").hash(&mut hasher);
    format!("{settings:?}").hash(&mut hasher);
    for file in files(entry) {
        add(&mut hasher, &file);
    }
    if let Some(reference) = entry.against.as_ref().filter(|_| settings.diagnose) {
        reference.name.hash(&mut hasher);
        files_of(&reference.path).iter().for_each(|file| add(&mut hasher, file));
    }
    format!("{:016x}", hasher.finish())
}

/// A text as 16 hexadecimal digits.
pub fn of_text(text: &str) -> String {
    let mut hasher = DefaultHasher::new();
    text.hash(&mut hasher);
    format!("{:016x}", hasher.finish())
}

fn files(entry: &Entry) -> Vec<PathBuf> {
    let mut files = files_of(&entry.path);
    files.extend(entry.model.clone());
    files
}

/// The files of the campaign in `folder`.
fn files_of(folder: &Path) -> Vec<PathBuf> {
    let mut files = vec![folder.join("campaign.toml")];
    // A campaign that cannot be read fails, and failed campaigns are tried again anyway.
    if let Ok(campaign) = read_campaign(folder) {
        files.extend(campaign.trials.iter().map(|trial| campaign.folder.join(&trial.file)));
        files.extend(campaign.arm.iter().map(|arm| campaign.folder.join(&arm.urdf)));
    }
    files
}

/// Adds what `file` holds and how long it is; a file that cannot be read counts as one that is not there.
fn add(hasher: &mut DefaultHasher, file: &Path) {
    let mut chunk = vec![0; CHUNK];
    let mut length = 0u64;
    if let Ok(mut file) = File::open(file) {
        while let Ok(read @ 1..) = file.read(&mut chunk) {
            hasher.write(&chunk[..read]);
            length += read as u64;
        }
    }
    length.hash(hasher);
}
