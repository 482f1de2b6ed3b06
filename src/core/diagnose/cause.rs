//! What is known of a cause, whether an effect of the library or a group of the model's own parameters.

use super::candidates::Cause;
use crate::effects::{CONTACT, Effect, Excitation, Family, LIBRARY, Region, Starts, find};
use crate::model::Group;

impl Cause {
    /// Torque from outside, in bursts.
    pub const CONTACT: Self = Self::Effect(CONTACT);

    /// The effect that it is.
    pub fn effect(self) -> Option<&'static dyn Effect> {
        if let Self::Effect(id) = self { find(id) } else { None }
    }

    /// Whether it is a law of time, not of the motion.
    pub fn is_of_time(self) -> bool {
        self.effect().is_some_and(|effect| effect.about().of_time)
    }

    /// Whether `other` is another form of it: the same behaviour by another formula. Both are never named together.
    pub fn is_alike(self, other: Self) -> bool {
        self.effect().is_some_and(|effect| effect.about().alike.contains(&other.name()))
    }

    /// Whether a verdict may name both: another cause, not of another form of it, and not another kind of ripple. One line over position is
    /// one cause, and with two kinds of ripple free to share it what is misfit of the one is taken for the other.
    pub fn may_stand_beside(self, other: Self) -> bool {
        let is_ripple = |cause: Self| {
            cause.effect().is_some_and(|effect| matches!(effect.about().starts, Starts::PositionLines { .. }))
        };
        self != other && !self.is_alike(other) && !(is_ripple(self) && is_ripple(other))
    }

    /// The group of the model's own parameters that it is.
    pub fn group(self) -> Option<&'static Group> {
        if let Self::Stale(name) = self { Group::find(name) } else { None }
    }

    /// What it means, in a few words without its name.
    pub fn means(self) -> &'static str {
        match self {
            Self::Effect(id) => find(id).map_or(id, |effect| effect.about().means),
            Self::Stale(name) => Group::find(name).map_or(name, |group| group.means),
        }
    }

    /// Where it lies; `None` for the model's own parameters.
    pub fn family(self) -> Option<Family> {
        self.effect().map(|effect| effect.about().family)
    }

    /// Where it shows by its nature.
    pub fn signature(self) -> Region {
        let of_group = || self.group().map(|group| group.signature);
        self.effect().map(|effect| effect.about().signature).or_else(of_group).unwrap_or(Region::Everywhere)
    }
}

/// How the cause called `name` is checked by hand, without the joint's motion.
pub fn by_hand(name: &str) -> Option<&'static str> {
    let of_group = || Group::find(name).and_then(|group| group.by_hand);
    find(name).and_then(|effect| effect.about().by_hand).or_else(of_group)
}

/// What tells the causes called `a` and `b` apart, where no motion does.
pub fn told_apart(a: &str, b: &str) -> Option<&'static str> {
    let of = |one: &str, other: &str| {
        let known = match (find(one), Group::find(one)) {
            (Some(effect), _) => effect.about().told_apart,
            (None, Some(group)) => group.told_apart,
            (None, None) => &[],
        };
        known.iter().find(|(name, _)| *name == other).map(|(_, how)| *how)
    };
    of(a, b).or_else(|| of(b, a))
}

/// Names of the causes that only show in motion with `excitation`: effects in the library's order, then groups.
pub fn needing(excitation: Excitation) -> Vec<&'static str> {
    let effects = LIBRARY.into_iter().map(|effect| (effect.about().id, effect.about().needs));
    let groups = Group::ALL.into_iter().map(|group| (group.name, group.needs));
    let mut found: Vec<&'static str> = Vec::new();
    for (name, needs) in effects.chain(groups) {
        if needs.contains(&excitation) && !found.contains(&name) {
            found.push(name);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::Cause;

    #[test]
    fn a_verdict_names_no_two_forms_of_one_thing_and_no_two_kinds_of_ripple() {
        let may = |a: &'static str, b: &'static str| Cause::Effect(a).may_stand_beside(Cause::Effect(b));
        assert!(!may("torque_ripple", "friction_ripple") && !may("friction_ripple", "torque_ripple"));
        assert!(!may("presliding", "reversal_transition") && !may("warm_up", "warm_up"));
        assert!(may("torque_ripple", "presliding") && may("friction_ripple", "warm_up"));
        assert!(Cause::Effect("torque_ripple").may_stand_beside(Cause::Stale("coulomb")));
    }
}
