//! What a batch does: a list (`batch/1`), every campaign below a folder, or every one that a pattern finds.

use super::life::Limit;
use super::table::parameter_names;
use crate::document::{Document, Section, suggest};
use crate::prepare::read_campaign;
use crate::problem::{Problem, Result};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

const FORMAT: &str = "batch/1";
const CAMPAIGN: &str = "campaign.toml";
/// The condition that everything over time is confounded with, degC.
pub(super) const TEMPERATURE: &str = "temperature_degc";
/// What a limit may be of beside a parameter.
const LIMITED: [&str; 4] = ["friction_nm", "backlash_m", "change_over_m", "rmse_nm"];

/// What to do.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Batch {
    /// The campaigns, each with a name of its own.
    pub entries: Vec<Entry>,
    /// Dates at which each joint's cables were retensioned, in order.
    pub retensioned: BTreeMap<String, Vec<String>>,
    /// What no joint is to exceed.
    pub limits: Vec<Limit>,
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
    /// Whether the list names it as its joint's reference.
    pub is_reference: bool,
    /// Named conditions under which it was recorded, numbers or words.
    pub conditions: BTreeMap<String, String>,
    /// The campaign that it is diagnosed against; `None` where that is itself, or `model` is given.
    pub against: Option<Reference>,
}

/// A campaign that others of its joint are held against.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Reference {
    /// Its name.
    pub name: String,
    /// Its folder.
    pub path: PathBuf,
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
            batch.limits.extend(found.limits);
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
            None => {
                batch.refer();
                Ok(batch)
            }
        }
    }

    /// Says for each campaign which one it is held against: of its joint the one that the list names as reference, the latest
    /// that is not later than itself; else the first since the cables were last retensioned.
    fn refer(&mut self) {
        let mut of_joint: BTreeMap<String, Vec<usize>> = BTreeMap::new();
        for (at, entry) in self.entries.iter().enumerate() {
            // A campaign that cannot be read fails later, with the reason.
            let own = || Some(read_campaign(&entry.path).ok()?.joint.name);
            if let Some(joint) = entry.joint.clone().or_else(own) {
                of_joint.entry(joint).or_default().push(at);
            }
        }
        for (joint, mut of) in of_joint {
            let is_dated = of.iter().all(|at| self.entries[*at].date.is_some());
            if is_dated {
                of.sort_by_key(|at| self.entries[*at].date.clone());
            }
            let dates = self.retensioned.get(&joint).filter(|_| is_dated).cloned().unwrap_or_default();
            for place in 0..of.len() {
                let against = self.reference(&of, place, &dates);
                let found = &self.entries[against];
                let reference = Reference { name: found.name.clone(), path: found.path.clone() };
                let entry = &mut self.entries[of[place]];
                entry.against = (entry.model.is_none() && against != of[place]).then_some(reference);
            }
        }
    }

    /// The campaign that number `place` of a joint's campaigns `of`, in time, is held against; `dates` are its retensionings.
    fn reference(&self, of: &[usize], place: usize, dates: &[String]) -> usize {
        let date = |at: &usize| self.entries[*at].date.as_ref();
        let is_named = |at: &&usize| self.entries[**at].is_reference;
        let named = of[..=place].iter().rev().find(is_named).or_else(|| of.iter().find(is_named));
        let last = dates.iter().rev().find(|retensioned| date(&of[place]) >= Some(*retensioned));
        let since = of.iter().find(|at| last.is_none() || date(at) >= last);
        *named.or(since).unwrap_or(&of[place])
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
            let limits = root.may("limits").sections(limit).unwrap_or_default();
            Some(Self { entries: entries?, retensioned, limits })
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
        Self {
            name,
            path: folder.to_path_buf(),
            joint: None,
            date: None,
            model: None,
            is_reference: false,
            conditions: BTreeMap::new(),
            against: None,
        }
    }

    fn read(section: &Section<'_>, folder: &Path) -> Option<Self> {
        let path = section.need("path").such_as("\"elbow/2026-03-02\"", "the campaign's folder").text();
        let (name, joint, date) = (section.may("name").text(), section.may("joint").text(), section.may("date").date());
        let model = section.may("model").text().map(|model| folder.join(model));
        let is_reference = section.may("reference").flag().unwrap_or(false);
        let read = |s: &Section<'_>| {
            let one = |key: &str| {
                let value = s.may(key).word()?;
                if key == TEMPERATURE && value.parse::<f64>().is_err() {
                    s.reject(key, "is not a number", "write the temperature in degC, or leave it out");
                }
                Some((key.to_string(), value))
            };
            Some(s.keys().filter_map(one).collect::<BTreeMap<String, String>>())
        };
        let conditions = section.may("conditions").section(read).unwrap_or_default();
        let path = path?;
        let model = model.map(|model| if model.is_dir() { model.join("model.json") } else { model });
        Some(Self {
            name: name.unwrap_or_else(|| path.clone()),
            path: folder.join(&path),
            joint,
            date,
            model,
            is_reference,
            conditions,
            against: None,
        })
    }
}

/// One of `[[limits]]`.
fn limit(s: &Section<'_>) -> Option<Limit> {
    let what = s.need("what").such_as("\"friction_nm\"", "what is limited").text();
    let (joint, speed_rad_s) = (s.may("joint").text(), s.may("speed_rad_s").positive());
    let (most, least) = (s.may("at_most").positive(), s.may("at_least").positive());
    if let Some(what) = &what {
        let names = parameter_names();
        let known = || LIMITED.into_iter().chain(names.iter().map(String::as_str));
        if !known().any(|name| name == what) {
            s.reject("what", format!("`{what}` is not a tracked quantity"), suggest(what, "it may be", known()));
        } else if speed_rad_s.is_some() && what != LIMITED[0] {
            s.reject("speed_rad_s", "belongs to `friction_nm` alone", "leave it out");
        }
    }
    let (value, is_upper) = match (most, least) {
        (Some(value), None) => (value, true),
        (None, Some(value)) => (value, false),
        _ => {
            s.reject("at_most", "one of `at_most` and `at_least` is needed", "say what its magnitude is not to pass");
            return None;
        }
    };
    Some(Limit { joint, what: what?, speed_rad_s, value, is_upper })
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
