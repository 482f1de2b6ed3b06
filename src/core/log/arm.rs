//! `[dynamics]` with a URDF: which recorded column moves which joint of the chain.

use super::columns::OtherColumn;
use super::place::{self, Found};
use crate::document::{Section, suggest};
use crate::dynamics::{Chain, JointKind};
use crate::model::ChainName;
use crate::problem::{Problem, Problems};
use crate::units::Unit;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The whole chain that a campaign's joint belongs to.
#[derive(Debug, Clone, PartialEq)]
pub struct Arm {
    /// The URDF as the campaign names it, relative to its folder.
    pub urdf: String,
    /// The bodies that matter for the joint.
    pub chain: Chain,
    /// Where each of the chain's other joints stands, in their order.
    pub others: Vec<Place>,
    /// Joints that rest, by name, rad or m.
    pub held_rad: BTreeMap<String, f64>,
}

impl Arm {
    /// The joint in its URDF.
    pub fn name(&self) -> ChainName {
        ChainName { urdf: self.urdf.clone(), joint: self.chain.joint().to_string() }
    }
}

/// Where a joint other than the campaign's own stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Place {
    /// In this one of the log's `other_position` columns.
    Column(usize),
    /// Always here, rad or m.
    Held(f64),
}

/// What `[dynamics]` says of the chain, before the columns are known.
pub(super) struct Declared {
    urdf: String,
    file: PathBuf,
    joint: String,
    held_rad: BTreeMap<String, f64>,
}

impl Declared {
    pub fn read(section: &Section<'_>, folder: &Path) -> Option<Self> {
        let (urdf, joint) = (section.need("urdf").text(), section.need("joint").text());
        let held_rad = section.may("held_rad").section(|held| {
            Some(held.keys().filter_map(|name| Some((name.to_string(), held.need(name).number()?))).collect())
        });
        for key in ["gravity_nm", "inertia_kg_m2"] {
            if section.may(key).number().is_some() {
                section.reject(key, "is given beside a URDF, which holds it already", "delete one of the two");
            }
        }
        let urdf = urdf?;
        match place::find(folder, &urdf) {
            Found::Outside => {
                let cure = "copy the URDF into the folder of campaign.toml and name it by its path from there";
                section.reject("urdf", format!("`{urdf}` lies outside the campaign"), cure);
                return None;
            }
            Found::Linked(real) => {
                let (what, cure) = place::of_link(&urdf, &real);
                section.doubt("urdf", what, cure);
            }
            Found::Here | Found::Absent(_) => {}
        }
        Some(Self { file: folder.join(&urdf), urdf, joint: joint?, held_rad: held_rad.unwrap_or_default() })
    }

    /// The chain with its joints matched to `columns`; faults of the URDF go to the campaign's list under `urdf` or `joint`.
    pub fn arm(self, section: &Section<'_>, kind: JointKind, columns: &[OtherColumn]) -> Option<Arm> {
        let chain = match Chain::read(&self.file, &self.joint) {
            Ok(chain) => chain,
            Err(Problems(found)) => {
                found
                    .iter()
                    .for_each(|p| section.reject("urdf", format!("{}: {}", self.urdf, told(p)), p.cure.clone()));
                return None;
            }
        };
        if chain.kind() != kind {
            let what = format!("is {} in the URDF, {} in [joint]", chain.kind().name(), kind.name());
            section.reject("joint", what, "name the joint that the campaign records, or correct [joint].kind");
        }
        let names: Vec<&str> = chain.others().map(|(name, _)| name).collect();
        for name in self.held_rad.keys().filter(|name| !names.contains(&name.as_str())) {
            let cure = suggest(name, "those that matter are", names.iter().copied());
            section.reject("held_rad", format!("`{name}` is no other joint of the chain of `{}`", self.joint), cure);
        }
        let others = self.places(section, &chain, columns)?;
        Some(Arm { urdf: self.urdf, chain, others, held_rad: self.held_rad })
    }

    /// Columns that name a joint which does not exist, or one that is declared to rest.
    fn check_named(&self, section: &Section<'_>, joints: &[(&str, JointKind)], columns: &[OtherColumn]) {
        for (column, joint) in columns.iter().filter_map(|c| Some((&c.column.name, c.joint.as_deref()?))) {
            if joints.iter().all(|(name, _)| *name != joint) {
                let what =
                    format!("column `{column}` is of joint `{joint}`, on which `{}` does not depend", self.joint);
                section.reject("urdf", what, suggest(joint, "it depends on", joints.iter().map(|(name, _)| *name)));
            } else if self.held_rad.contains_key(joint) {
                self.held_and_recorded(section, joint, column);
            }
        }
        for column in columns.iter().filter(|c| c.joint.is_none()).map(|c| &c.column.name) {
            if let Some(joint) = self.held_rad.keys().find(|joint| is_called(column, joint)) {
                self.held_and_recorded(section, joint, column);
            }
        }
    }

    fn held_and_recorded(&self, section: &Section<'_>, joint: &str, column: &str) {
        let what = format!("joint `{joint}` is held here, and recorded in column `{column}`");
        section.reject("held_rad", what, "delete one of the two");
    }

    /// A joint's place: held, or in the column that names it, or in the column called like it, or in what is left over, in order.
    fn places(&self, section: &Section<'_>, chain: &Chain, columns: &[OtherColumn]) -> Option<Vec<Place>> {
        let joints: Vec<(&str, JointKind)> = chain.others().collect();
        self.check_named(section, &joints, columns);
        let mut places: Vec<Option<Place>> =
            joints.iter().map(|(name, _)| Some(Place::Held(*self.held_rad.get(*name)?))).collect();
        let mut left: Vec<usize> = (0..columns.len()).collect();
        let named = |column: &OtherColumn, joint: &str| column.joint.as_deref() == Some(joint);
        let called =
            |column: &OtherColumn, joint: &str| column.joint.is_none() && is_called(&column.column.name, joint);
        for fits in [&named as &dyn Fn(&OtherColumn, &str) -> bool, &called] {
            for (place, (joint, _)) in places.iter_mut().zip(&joints).filter(|(place, _)| place.is_none()) {
                if let Some(at) = left.iter().position(|at| fits(&columns[*at], joint)) {
                    *place = Some(Place::Column(left.remove(at)));
                }
            }
        }
        left.retain(|at| columns[*at].joint.is_none());
        let open: Vec<usize> = (0..joints.len()).filter(|at| places[*at].is_none()).collect();
        if open.len() == left.len() {
            for (at, column) in open.iter().zip(&left) {
                places[*at] = Some(Place::Column(*column));
                let (joint, name) = (joints[*at].0, &columns[*column].column.name);
                let what = format!("column `{name}` is taken for joint `{joint}`, as no other matches better");
                section.doubt("urdf", what, format!("say so: add joint = \"{joint}\" to it under [columns]"));
            }
        }
        for (place, (joint, kind)) in places.iter().zip(&joints) {
            match place {
                None => {
                    let what =
                        format!("the position of joint `{joint}`, which `{}` depends on, is not recorded", self.joint);
                    let cure = format!(
                        "add other_position = {{ name = \"...\", unit = \"deg\", joint = \"{joint}\" }} under [columns], or \
                         held_rad = {{ {joint} = 0.0 }} under [dynamics] if it rests"
                    );
                    section.reject("urdf", what, cure);
                }
                Some(Place::Column(at)) if !suits(columns[*at].column.unit, *kind) => {
                    let what =
                        format!("column `{}` is in {}", columns[*at].column.name, columns[*at].column.unit.name());
                    section.reject(
                        "urdf",
                        format!("{what}, joint `{joint}` is {}", kind.name()),
                        "correct the unit, or the joint",
                    );
                }
                Some(_) => {}
            }
        }
        places.into_iter().collect()
    }
}

/// Whether a column's name is the joint's, alone or with its unit behind it.
fn is_called(column: &str, joint: &str) -> bool {
    let rest = column.strip_prefix(joint);
    rest.is_some_and(|rest| {
        matches!(rest, "" | "_deg" | "_rad" | "_m" | "_mm" | "_position" | ".position" | "/position")
    })
}

fn suits(unit: Unit, kind: JointKind) -> bool {
    let angle = matches!(unit, Unit::Radian | Unit::Degree);
    angle == (kind == JointKind::Revolute)
}

fn told(problem: &Problem) -> String {
    problem.column.as_ref().map_or(problem.what.clone(), |column| format!("`{column}`: {}", problem.what))
}
