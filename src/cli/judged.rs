//! What every command that holds a model against a campaign takes.

use crate::log::Campaign;
use crate::model::Model;
use crate::prepare::read_campaign;
use crate::problem::{Result, visible};
use clap::builder::{PathBufValueParser, TypedValueParser};
use std::path::{Path, PathBuf};

/// A campaign and a model of its joint.
#[derive(Debug, clap::Args)]
pub struct Judged {
    /// Folder with a campaign.toml and its logs
    pub campaign: PathBuf,
    /// The model: a model.json, or the folder that holds it
    #[arg(long, value_parser = model_file())]
    pub model: PathBuf,
}

impl Judged {
    /// Both, read.
    pub fn read(&self) -> Result<(Campaign, Model)> {
        let model = Model::read(&self.model)?;
        Ok((campaign_for(&model, &self.campaign)?, model))
    }
}

/// Takes an argument that names a model: its file, or the model.json in the folder that it names.
pub fn model_file() -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().map(|named| {
        let inside = named.join("model.json");
        if inside.is_file() { inside } else { named }
    })
}

/// The campaign in `path`, with its clock where `model` goes by it.
pub fn campaign_for(model: &Model, path: &Path) -> Result<Campaign> {
    let campaign = read_campaign(path)?;
    if model.needs_clock() { campaign.with_clock() } else { Ok(campaign) }
}

/// What reports call the campaign: its folder's name, whatever the path that led there.
pub fn campaign_name(campaign: &Campaign) -> String {
    let folder = std::path::absolute(&campaign.folder).unwrap_or_else(|_| campaign.folder.clone());
    folder.file_name().map_or_else(|| campaign.joint.name.clone(), |name| visible(&name.to_string_lossy()).into_owned())
}

/// What reports call a model: its file with the folder that it stands in.
pub fn model_name(file: &Path) -> String {
    let tail: Vec<_> = file.components().rev().take(2).collect();
    visible(&tail.into_iter().rev().collect::<PathBuf>().to_string_lossy()).into_owned()
}
