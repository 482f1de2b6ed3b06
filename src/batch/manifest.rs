//! What a batch does: a list (`batch/1`), every campaign below a folder, or every one that a pattern finds.

use crate::document::{Document, Section};
use crate::problem::{Problem, Result};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

const FORMAT: &str = "batch/1";
const CAMPAIGN: &str = "campaign.toml";

/// What to do.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Batch {
    /// The campaigns, each with a name of its own.
    pub entries: Vec<Entry>,
    /// Dates at which each joint's cables were retensioned, in order.
    pub retensioned: BTreeMap<String, Vec<String>>,
}

/// One campaign.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// What it is called: its path as listed, or from the folder searched.
    pub name: String,
    /// Its folder.
    pub path: PathBuf,
    /// The joint that it is of, where that is not what its `campaign.toml` says.
    pub joint: Option<String>,
    /// When it was recorded, ISO 8601.
    pub date: Option<String>,
    /// The model that it is held against in place of its own.
    pub model: Option<PathBuf>,
}

impl Batch {
    /// Reads `named`, each a list (`*.toml`), a folder with campaigns somewhere below it, or a pattern of such folders
    /// (`fleet/*/2026-*`).
    ///
    /// Errors: nothing is there; all that is wrong with a list; two campaigns of one name.
    pub fn read(named: &[PathBuf]) -> Result<Self> {
        let mut batch = Self::default();
        for path in named {
            let found = match path {
                path if path.is_dir() => Self::below(path, named.len() > 1)?,
                path if path.is_file() => Self::listed(path)?,
                path => Self::matching(path)?,
            };
            batch.entries.extend(found.entries);
            for (joint, dates) in found.retensioned {
                batch.retensioned.entry(joint).or_default().extend(dates);
            }
        }
        batch.retensioned.values_mut().for_each(|dates| dates.sort());
        let mut names = BTreeSet::new();
        match batch.entries.iter().find(|entry| !names.insert(&entry.name)) {
            Some(twice) => {
                let what = format!("`{}` is there twice", twice.name);
                Problem::error(&twice.path, what, "list it once, or give each a `name`").alone()
            }
            None => Ok(batch),
        }
    }

    fn listed(file: &Path) -> Result<Self> {
        if file.file_name().is_some_and(|name| name == CAMPAIGN) {
            let folder = file.parent().unwrap_or(Path::new(""));
            return Ok(Self { entries: vec![Entry::new(folder, folder)], ..Self::default() });
        }
        let folder = file.parent().unwrap_or(Path::new(""));
        Document::open(file)?.read(|root| {
            root.need("format").choice(&[(FORMAT, ())]);
            let means = "one for each campaign, with its path";
            let mut listed = 0;
            let entries = root.need("campaigns").such_as("[[campaigns]]", means).sections(|s| {
                listed += 1;
                Entry::read(s, folder)
            });
            if entries.is_some() && listed == 0 {
                root.reject("campaigns", "lists no campaign", "add `[[campaigns]]` with its path");
            }
            let one = |s: &Section<'_>| s.need("joint").text().zip(s.need("date").date());
            let mut retensioned: BTreeMap<String, Vec<String>> = BTreeMap::new();
            for (joint, date) in root.may("retensioned").sections(one).unwrap_or_default() {
                retensioned.entry(joint).or_default().push(date);
            }
            Some(Self { entries: entries?, retensioned })
        })
    }

    fn below(folder: &Path, among_others: bool) -> Result<Self> {
        let pattern = Path::new(&glob::Pattern::escape(&folder.to_string_lossy())).join("**").join(CAMPAIGN);
        let base = if among_others { Path::new("") } else { folder };
        let entries: Vec<Entry> =
            paths(folder, &pattern)?.iter().filter_map(|p| Some(Entry::new(p.parent()?, base))).collect();
        match entries.is_empty() {
            true => {
                Problem::error(folder, format!("holds no {CAMPAIGN}"), "name a folder with campaigns below it").alone()
            }
            false => Ok(Self { entries, ..Self::default() }),
        }
    }

    fn matching(pattern: &Path) -> Result<Self> {
        let found = paths(pattern, pattern)?;
        let folder = |p: &PathBuf| match p.is_dir() {
            true => Some(p.clone()).filter(|p| p.join(CAMPAIGN).is_file()),
            false => p.parent().filter(|_| p.file_name().is_some_and(|name| name == CAMPAIGN)).map(Path::to_path_buf),
        };
        let entries: Vec<Entry> = found.iter().filter_map(folder).map(|p| Entry::new(&p, Path::new(""))).collect();
        match entries.is_empty() {
            true => {
                let cure = "name a list (batch/1), a folder, or a pattern that matches campaigns' folders";
                Problem::error(pattern, "there is no such file or campaign", cure).alone()
            }
            false => Ok(Self { entries, ..Self::default() }),
        }
    }
}

impl Entry {
    /// The campaign in `folder`, called by its path from `base`.
    fn new(folder: &Path, base: &Path) -> Self {
        let name = folder.strip_prefix(base).unwrap_or(folder).to_string_lossy().into_owned();
        // The folder searched may itself be a campaign.
        let name =
            if name.is_empty() { folder.file_name().unwrap_or_default().to_string_lossy().into_owned() } else { name };
        Self { name, path: folder.to_path_buf(), joint: None, date: None, model: None }
    }

    fn read(section: &Section<'_>, folder: &Path) -> Option<Self> {
        let path = section.need("path").such_as("\"elbow/2026-03-02\"", "the campaign's folder").text();
        let (name, joint, date) = (section.may("name").text(), section.may("joint").text(), section.may("date").date());
        let model = section.may("model").text().map(|model| folder.join(model));
        let path = path?;
        let model = model.map(|model| if model.is_dir() { model.join("model.json") } else { model });
        Some(Self { name: name.unwrap_or_else(|| path.clone()), path: folder.join(&path), joint, date, model })
    }
}

/// What `pattern` finds, in alphabetical order; `named` is what messages call it.
fn paths(named: &Path, pattern: &Path) -> Result<Vec<PathBuf>> {
    let found = glob::glob(&pattern.to_string_lossy()).or_else(|error| {
        Problem::error(named, format!("is no pattern: {}", error.msg), "use * ? [abc] and **, as shells do").alone()
    })?;
    found
        .map(|path| {
            path.or_else(|error| {
                Problem::error(error.path(), format!("cannot be read: {}", error.error()), "check its permissions")
                    .alone()
            })
        })
        .collect()
}
