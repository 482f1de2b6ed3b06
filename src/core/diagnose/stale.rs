//! Groups of the model's own parameters that go stale together, in each of the ways in which that happens.

use super::parameter_ref::ParameterRef;
use super::perturbation::{Mode, Perturbation, matters};
use crate::dynamics::Direction;
use crate::effects::Extent;
use crate::model::{Group, Model, Term, groups};

/// How Coulomb and viscous friction move together: a line per direction.
pub const WHOLE_LINE: &str = "each direction separately, level and slope";

/// How gravity and inertia of a chain move.
pub const PAYLOAD: &str = "payload on the last link";

/// How Coulomb friction moves where one direction gains what the other loses: as by a bias of the sensor.
pub const SAME_TORQUE: &str = "up and down by the same torque";

/// How a parameter moves that moves in one direction alone.
pub const UP_ONLY: &str = "up only";
/// See [`UP_ONLY`].
pub const DOWN_ONLY: &str = "down only";

/// A group of the model's own parameters that may have gone stale, in one of the ways in which that happens.
#[derive(Debug, Clone, PartialEq)]
pub struct Stale {
    /// The group's name in a verdict.
    pub name: &'static str,
    /// How: "both directions alike", "up only" ...
    pub how: &'static str,
    /// What moves.
    pub moves: Vec<Perturbation>,
}

/// The unit of a load coefficient that is 0.
const LOAD_UNIT: f64 = 0.1;

/// The terms that a Stribeck curve is in proportion to.
const AMPLITUDES: [Term; 2] = [Term::CableStribeck, Term::JointStribeck];

/// A parameter without prior; one step changes it by at most half of its unit.
fn free(turns: Vec<(ParameterRef, Mode)>) -> Perturbation {
    Perturbation { stride: 0.5, ..Perturbation::of(turns, f64::INFINITY) }
}

/// `parameter` in proportion to `times` what it is in `model`.
fn scaled(model: &Model, parameter: ParameterRef, times: f64) -> (ParameterRef, Mode) {
    (parameter, Mode::Add(times * parameter.value(model)))
}

/// A term of friction moving up and down.
fn both(term: Term) -> [ParameterRef; 2] {
    Direction::BOTH.map(|d| ParameterRef::Friction(d, term))
}

/// Its mean size over both directions.
fn size(model: &Model, term: Term) -> f64 {
    both(term).iter().map(|parameter| parameter.value(model).abs()).sum::<f64>() / 2.0
}

/// The unit in which `term` moves: its size or, where that is more, what changes friction by the range of torque that was measured. A
/// parameter that was next to nothing must come as far as any other.
fn unit(model: &Model, term: Term, extent: &Extent) -> f64 {
    let range_nm = extent.torque_nm.1 - extent.torque_nm.0;
    let range = match term {
        Term::Load => return if size(model, term) > 0.0 { size(model, term) } else { LOAD_UNIT },
        Term::Viscous => range_nm / extent.speed_rad_s.1.max(f64::MIN_POSITIVE),
        _ => range_nm,
    };
    size(model, term).max(range / model.joint.winch_radius_m)
}

/// The groups that `model` has, in a campaign that moves over `extent`.
pub fn stale(model: &Model, extent: &Extent) -> Vec<Stale> {
    // The prediction is exactly in proportion to it.
    let whole =
        |parameter: ParameterRef| Perturbation { stride: f64::INFINITY, ..free(vec![scaled(model, parameter, 1.0)]) };
    let curved = |parameter| Perturbation { is_linear: false, ..free(vec![(parameter, Mode::Scale)]) };
    let of_one = [
        (&groups::GRAVITY, ParameterRef::Gravity, whole(ParameterRef::Gravity)),
        (&groups::INERTIA, ParameterRef::Inertia, whole(ParameterRef::Inertia)),
        (&groups::BACKLASH_WIDTH, ParameterRef::Backlash, curved(ParameterRef::Backlash)),
    ];
    let of_one = of_one.into_iter().filter(|(_, parameter, _)| matters(model, *parameter));
    of_one
        .map(|(group, _, way)| Stale { name: group.name, how: "", moves: vec![way] })
        .chain([Term::Coulomb, Term::Viscous, Term::Load].into_iter().flat_map(|term| of_term(model, term, extent)))
        .chain(whole_line(model, extent))
        .chain(of_stribeck(model))
        .chain(payload(model, extent))
        .collect()
}

/// Whether `parameter` belongs to the group `name` where that moves as `how` says.
pub fn holds((name, how): (&str, &str), parameter: ParameterRef) -> bool {
    let group = match parameter {
        ParameterRef::Payload(_) => return how == PAYLOAD,
        ParameterRef::Friction(_, Term::Coulomb | Term::Viscous) if how == WHOLE_LINE => return true,
        ParameterRef::Gravity => &groups::GRAVITY,
        ParameterRef::Inertia => &groups::INERTIA,
        ParameterRef::Backlash => &groups::BACKLASH_WIDTH,
        ParameterRef::Friction(_, term) => Group::of_term(term),
        ParameterRef::Curve | ParameterRef::Effect(..) => return false,
    };
    group.name == name && how != PAYLOAD
}

/// The name of `group` where it made `after` of `before`, over `extent`: of a whole line of friction the one to which most of the change
/// belongs, its level or its slope; where there was no slope its level only makes room for one.
pub fn named(group: &Stale, (before, after): (&Model, &Model), extent: &Extent) -> &'static str {
    if group.how != WHOLE_LINE {
        return group.name;
    }
    let change = |term: Term| -> f64 {
        both(term).iter().map(|parameter| (parameter.value(after) - parameter.value(before)).abs()).sum()
    };
    // Over speeds up to the fastest a slope counts half as much as at its end.
    let is_level =
        size(before, Term::Viscous) > 0.0 && change(Term::Coulomb) > change(Term::Viscous) * extent.speed_rad_s.1 / 2.0;
    if is_level { groups::COULOMB.name } else { groups::VISCOUS.name }
}

/// The ways in which `term` of both directions moves.
fn of_term(model: &Model, term: Term, extent: &Extent) -> Vec<Stale> {
    let mut found = Vec::new();
    let mut add = |how, moves| found.push(Stale { name: Group::of_term(term).name, how, moves });
    let [up, down] = both(term);
    let (unit, size) = (unit(model, term, extent), size(model, term));
    let present = |parameter: ParameterRef| parameter.value(model) != 0.0;
    let by = |parameter: ParameterRef| (parameter, Mode::Add(unit));
    let alike = |parameter: ParameterRef| match size > 0.0 {
        true => scaled(model, parameter, unit / size),
        false => by(parameter),
    };
    // A model may lack viscous friction altogether.
    if present(up) == present(down) && (present(up) || term == Term::Viscous) {
        add("both directions alike", vec![free([up, down].map(alike).to_vec())]);
    }
    for (parameter, how) in [(up, UP_ONLY), (down, DOWN_ONLY)] {
        if present(parameter) {
            add(how, vec![free(vec![by(parameter)])]);
        }
    }
    if term == Term::Coulomb && present(up) && present(down) {
        add(SAME_TORQUE, vec![free(vec![by(up), by(down)])]);
    }
    if (present(up) || present(down)) != (term == Term::Load) {
        add("each direction separately", [up, down].map(|parameter| free(vec![by(parameter)])).to_vec());
    }
    found
}

/// A model without a Stribeck curve has a line per direction, if only a level one: its two numbers, fitted together, compensate for
/// each other, so that neither is right where the other is not.
fn whole_line(model: &Model, extent: &Extent) -> Option<Stale> {
    let is_line = |d: Direction| AMPLITUDES.iter().all(|term| model.friction.of(d).lacks(*term));
    let of = |term: Term| both(term).map(|parameter| free(vec![(parameter, Mode::Add(unit(model, term, extent)))]));
    (Direction::BOTH.into_iter().all(is_line) && size(model, Term::Coulomb) > 0.0).then(|| Stale {
        name: groups::VISCOUS.name,
        how: WHOLE_LINE,
        moves: [of(Term::Viscous), of(Term::Coulomb)].concat(),
    })
}

/// What the last link of a chain carries beyond its URDF: in units of what hangs on the joint, so that what the motion does not show stays
/// near nothing.
fn payload(model: &Model, extent: &Extent) -> Option<Stale> {
    let units = extent.payload.filter(|_| model.chain.is_some())?.numbers();
    let of = |(at, unit)| Perturbation { stride: 1.0, ..free(vec![(ParameterRef::Payload(at), Mode::Add(unit))]) };
    let name = if extent.payload_weighs { groups::GRAVITY.name } else { groups::INERTIA.name };
    Some(Stale { name, how: PAYLOAD, moves: units.into_iter().enumerate().map(of).collect() })
}

/// The ways in which the size of the Stribeck terms moves.
fn of_stribeck(model: &Model) -> Vec<Stale> {
    let amplitudes =
        Direction::BOTH.map(|d| AMPLITUDES.map(|term| scaled(model, ParameterRef::Friction(d, term), 1.0)));
    if amplitudes.iter().flatten().all(|(parameter, _)| parameter.value(model) == 0.0) {
        return Vec::new();
    }
    let of = |how, moves| Stale { name: groups::STRIBECK_LEVEL.name, how, moves };
    vec![
        of("both directions alike", vec![free(amplitudes.concat())]),
        of("each direction separately", amplitudes.map(|turns| free(turns.to_vec())).to_vec()),
    ]
}

#[cfg(test)]
mod tests {
    use super::{WHOLE_LINE, stale};
    use crate::diagnose::data::tests::bundled;
    use crate::diagnose::perturbation::Mode;
    use crate::model::groups;

    #[test]
    fn viscous_friction_that_a_model_lacks_is_tried_too() {
        let (data, mut model) = bundled();
        model.friction.up.d = 0.0;
        model.friction.down.d = 0.0;
        let groups_of = |model: &_| stale(model, &data.extent);
        let ways: Vec<&str> = groups_of(&model)
            .iter()
            .filter(|group| group.name == groups::VISCOUS.name)
            .map(|group| group.how)
            .collect();
        assert_eq!(ways, ["both directions alike", WHOLE_LINE]);
    }

    #[test]
    fn one_step_of_friction_reaches_half_the_range_of_torque_whatever_its_size() {
        let (data, model) = bundled();
        let range_nm = data.extent.torque_nm.1 - data.extent.torque_nm.0;
        let fastest_rad_s = data.extent.speed_rad_s.1;
        let separate = |group: &&super::Stale| group.how == "each direction separately" || group.how == WHOLE_LINE;
        let all = stale(&model, &data.extent);
        let viscous = all.iter().filter(separate).find(|group| group.name == groups::VISCOUS.name).unwrap();
        for way in &viscous.moves[..2] {
            let Mode::Add(unit) = way.turns[0].1 else { panic!("friction moves in proportion to its number") };
            let step_nm = way.stride * unit * model.joint.winch_radius_m * fastest_rad_s;
            assert!(step_nm >= 0.499 * range_nm, "{step_nm} of {range_nm} N m");
        }
    }
}
