//! The prediction: the paper's model as one formula, never using the measured torque.
//!
//! The load term of (15) uses the cable's own tension (r1 T0 = y), so (4) is solved for y:
//!
//! y = [ (r1/r2) (G + M a) + Bd + K~ (Bu - Bd) ] / ( 1 - mu_down - K~ (mu_up - mu_down) )
//!
//! with Bu, Bd the unloaded parts of the two branches (`Friction::unloaded_nm`). At K~ = 1 and 0 this is (17) with A and
//! B of each direction.

use super::{Both, Direction, Model, combined};
use crate::dynamics::Motion;
use crate::effects::{Carried, Evaluated, Sample};
use crate::numerics::causal::Lag;
use crate::numerics::fill::fill;
use crate::numerics::resample::shifted;
use std::array::from_ref;

/// What a sample asks of the joint.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Asked<S = f64> {
    /// Gravity, inertia, Coriolis, measured load at the joint, N m.
    pub torque_nm: S,
    /// How gravity changes with the joint's position, N m/rad.
    pub slope_nm_rad: S,
}

/// Steps in which the lag of a stretched cable and the torque that stretches it settle: each gains a digit or more.
const SETTLING: usize = 3;

/// The model's terms at one sample, all as torques at the winch, N m.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Components<S = f64> {
    /// y, the predicted signal.
    pub torque_nm: S,
    /// (r1/r2) times the rigid-body torque: what the winch would see without friction.
    pub rigid_nm: S,
    /// The rest: friction, and what effects add.
    pub friction_nm: S,
}

impl<S: Evaluated> Model<S> {
    /// y for a rigid-body torque `joint_torque_nm` at the joint (gravity, inertia, measured load), at `velocity_rad_s` and
    /// with friction combined by `k_tilde`, without effects.
    pub fn torque_nm(&self, joint_torque_nm: S, velocity_rad_s: S::Given, k_tilde: S) -> Components<S> {
        let branch = |direction| self.branch_nm(direction, velocity_rad_s);
        // Fully on one branch, as nearly always, the other's exponentials are not needed.
        let friction_nm = match k_tilde {
            k if k.is_zero() => branch(Direction::Down),
            k if (k - 1.0).is_zero() => branch(Direction::Up),
            k => combined(Both::make(branch), k),
        };
        let rigid_nm = joint_torque_nm * self.joint.transmission();
        let torque_nm = self.balance_nm(rigid_nm, friction_nm, k_tilde);
        Components { torque_nm, rigid_nm, friction_nm: torque_nm - rigid_nm }
    }

    /// The balance of torques at the winch, solved for y: a load of `load_nm` there and unloaded friction of `friction_nm`, the
    /// branches combined by `k_tilde`.
    pub fn balance_nm(&self, load_nm: S, friction_nm: S, k_tilde: S) -> S {
        (load_nm + friction_nm) / self.friction.loss(k_tilde).named("loss")
    }

    /// The inverse: K~ at which `y_nm` balances a base of (r1/r2) G + Bd and a change of Bu - Bd.
    pub fn k_tilde_at(&self, y_nm: S, base_nm: S, change_nm: S) -> S {
        let Both { up, down } = &self.friction;
        (y_nm * down.loss() - base_nm) / (change_nm + y_nm * (up.mu_c - down.mu_c))
    }

    /// B(v) of (19): y of one branch without any load, N m.
    pub fn b_nm(&self, direction: Direction, speed_rad_s: S::Given) -> S {
        self.branch_nm(direction, speed_rad_s) / self.friction.of(direction).loss()
    }

    /// What mass and a measured load of `load_nm` ask of a joint that moves alone.
    pub fn asked_alone(&self, own: Motion<S::Given>, load_nm: S) -> Asked<S> {
        let (kind, dynamics) = (self.joint.kind, &self.dynamics);
        let rigid_nm = dynamics.gravity_nm(kind, own.position) + own.acceleration * dynamics.inertia_kg_m2;
        Asked { torque_nm: rigid_nm + load_nm, slope_nm_rad: dynamics.gravity_slope_nm_rad(kind, own.position) }
    }

    /// y with everything that the model's effects add to the joint, before the sensor: what `asked` and `sample` come to with
    /// friction combined by `k_tilde`. The formula is the one of `effects`.
    pub fn driven_nm(&self, sample: &Sample<'_, S::Given>, asked: Asked<S>, k_tilde: S) -> Components<S> {
        self.driven_by_nm(sample, asked, k_tilde, self.branches_nm(sample.own.velocity))
    }

    /// The unloaded friction of both branches at a speed, N m at the winch.
    pub fn branches_nm(&self, velocity_rad_s: S::Given) -> Both<S> {
        Both::make(|direction| self.branch_nm(direction, velocity_rad_s))
    }

    /// The unloaded friction of one branch at a speed, N m at the winch.
    pub fn branch_nm(&self, direction: Direction, velocity_rad_s: S::Given) -> S {
        let (r1, r2) = (self.joint.winch_radius_m, self.joint.pulley_radius_m);
        self.friction.of(direction).unloaded_nm(direction, velocity_rad_s, r1, r2)
    }

    /// [`Self::driven_nm`] with the branches known already: most of the work is in their exponentials.
    pub fn driven_by_nm(
        &self,
        sample: &Sample<'_, S::Given>,
        asked: Asked<S>,
        k_tilde: S,
        branches: Both<S>,
    ) -> Components<S> {
        let mut y_nm = [S::from(0.0)];
        self.drive_along(from_ref(sample), &[asked], &[k_tilde], &[branches], &mut y_nm);
        let [torque_nm] = y_nm;
        let rigid_nm = asked.torque_nm * self.joint.transmission();
        Components { torque_nm, rigid_nm, friction_nm: torque_nm - rigid_nm }
    }

    /// y of [`Self::driven_by_nm`] at `N` samples, each effect asked once for all of them, into `y_nm`, N m.
    pub fn drive_along<const N: usize>(
        &self,
        samples: &[Sample<'_, S::Given>; N],
        asked: &[Asked<S>; N],
        k_tilde: &[S; N],
        branches: &[Both<S>; N],
        y_nm: &mut [S; N],
    ) {
        let (none, transmission) = (S::from(0.0), self.joint.transmission());
        let (mut factor, mut asked_nm) = ([S::from(1.0); N], [none; N]);
        fill(&mut asked_nm, |i| asked[i].torque_nm);
        let mut joint_nm = asked_nm;
        for e in &self.effects {
            e.hooks().add_joint_torque(&e.parameters, samples, &asked_nm, &mut joint_nm);
            e.hooks().multiply_friction(&e.parameters, samples, &mut factor);
        }
        let mut carried = [Carried { load_nm: none, friction_nm: Both { up: none, down: none } }; N];
        for i in 0..N {
            joint_nm[i] = joint_nm[i].named("joint_nm");
            carried[i] = Carried { load_nm: (joint_nm[i] * transmission).named("load_nm"), friction_nm: branches[i] };
        }
        let (mut winch_nm, mut branches_nm, mut friction_nm) = ([none; N], *branches, [none; N]);
        if !self.effects.is_empty() {
            let own_nm = |i: usize| combined(branches[i], k_tilde[i]);
            fill(&mut asked_nm, |i| self.balance_nm(asked[i].torque_nm * transmission, own_nm(i), k_tilde[i]));
        }
        for e in &self.effects {
            e.hooks().add_winch_torque(&e.parameters, samples, &asked_nm, &mut winch_nm);
            e.hooks().add_friction(&e.parameters, samples, &carried, &mut branches_nm);
        }
        fill(&mut friction_nm, |i| {
            let Both { up, down } = branches_nm[i];
            let both = Both { up: up.named("up_nm"), down: down.named("down_nm") };
            (factor[i] * combined(both, k_tilde[i])).named("friction_nm")
        });
        let balance = |lag_rad: &[S; N], y_nm: &mut [S; N]| {
            fill(y_nm, |i| {
                let load_nm = (joint_nm[i] - asked[i].slope_nm_rad * lag_rad[i]) * transmission;
                self.balance_nm(load_nm, friction_nm[i], k_tilde[i]) + winch_nm[i]
            });
        };
        balance(&[none; N], y_nm);
        let settling = if self.effects.iter().any(|e| e.effect.lags()) { SETTLING } else { 0 };
        let mut pull_nm = [none; N];
        for _ in 0..settling {
            let mut lag_rad = [none; N];
            fill(&mut pull_nm, |i| y_nm[i] / transmission);
            self.effects.iter().for_each(|e| e.hooks().add_lag(&e.parameters, &joint_nm, &pull_nm, &mut lag_rad));
            balance(&lag_rad, y_nm);
        }
    }

    /// The sensor's reading of `torque_nm`, without its delay, N m.
    pub fn reading_nm(&self, sample: &Sample<'_, S::Given>, torque_nm: S) -> S {
        self.noisy_reading_nm(sample, torque_nm, S::from(0.0))
    }

    /// The same with the sensor's noise of `noise_nm`: noise is measured along with the torque, a range that ends clips both.
    pub fn noisy_reading_nm(&self, sample: &Sample<'_, S::Given>, torque_nm: S, noise_nm: S) -> S {
        let mut reading_nm = [torque_nm];
        self.read_by(false, from_ref(sample), &mut reading_nm);
        reading_nm[0] += noise_nm;
        self.read_by(true, from_ref(sample), &mut reading_nm);
        reading_nm[0]
    }

    /// Replaces `torque_nm` at each of `samples` by the sensor's reading of it, without its delay, N m.
    pub fn read_along(&self, samples: &[Sample<'_, S::Given>], torque_nm: &mut [S]) {
        self.read_by(false, samples, torque_nm);
        self.read_by(true, samples, torque_nm);
    }

    /// What of the reading is up to the effects that are the end of a range (`clips`), or to all others.
    fn read_by(&self, clips: bool, samples: &[Sample<'_, S::Given>], torque_nm: &mut [S]) {
        let effects = self.effects.iter().filter(|e| e.effect.clips() == clips);
        effects.for_each(|e| e.hooks().read(&e.parameters, samples, torque_nm));
    }

    /// How late the sensor's reading is, s.
    pub fn delay_s(&self) -> S {
        self.effects.iter().fold(S::from(0.0), |sum, e| sum + e.hooks().delay_s(&e.parameters))
    }

    /// The time constant with which the sensor follows, s.
    pub fn lag_s(&self) -> S {
        self.effects.iter().fold(S::from(0.0), |sum, e| sum + e.hooks().lag_s(&e.parameters))
    }

    /// A series of torques at `rate_hz` as the sensor gets them, late by [`Self::delay_s`] and [`Self::lag_s`], N m.
    pub fn late_nm(&self, mut torque_nm: Vec<S>, rate_hz: f64) -> Vec<S> {
        let (delay_s, lag_s) = (self.delay_s(), self.lag_s());
        if !delay_s.is_zero() {
            torque_nm = shifted(&torque_nm, delay_s * rate_hz);
        }
        if lag_s.value() > 0.0 {
            let mut lag = Lag::new(lag_s * rate_hz);
            torque_nm.iter_mut().for_each(|y| *y = lag.step(*y));
        }
        torque_nm
    }
}

impl Model {
    /// Whether any effect depends on the time since the campaign began.
    pub fn needs_clock(&self) -> bool {
        self.effects.iter().any(|e| e.effect.needs_clock(&e.parameters))
    }
}
