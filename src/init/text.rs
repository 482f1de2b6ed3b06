//! The draft of `campaign.toml`: what was found, why, and the questions that no data answer, each on the line that waits for it.

use super::Survey;
use super::answers::Answers;
use super::columns::Choice;
use super::measure::Measure;
use super::trials::{DraftTrial, digits};
use crate::dynamics::JointKind;
use crate::log::MARK;
use crate::model::Drive;
use crate::problem::acts;
use crate::trajectory::Protocol;
use crate::units::{Quantity, Unit};
use std::collections::BTreeMap;
use std::fmt::Write;
use toml::Value;

/// Cut-off of the low-pass where the rate allows it, Hz: joints move slower, motors' ripple is faster.
const LOWPASS_HZ: f64 = 5.0;
/// The cut-off is at most this share of the rate.
const LOWPASS_SHARE: f64 = 0.2;
/// A zero that the data shift by less than this is as good as declared, rad.
const ZERO_NEGLIGIBLE_RAD: f64 = 0.0175;

/// What no data tell.
#[derive(Debug, Clone, PartialEq)]
pub struct Question {
    /// Where the answer goes.
    pub key: String,
    /// What is asked.
    pub asks: String,
    /// What the data suggest, where they do.
    pub suggested: Option<String>,
}

/// A draft of `campaign.toml`.
#[derive(Debug, Clone, PartialEq)]
pub struct Draft {
    /// The file's text.
    pub text: String,
    /// What is still to be answered.
    pub questions: Vec<Question>,
}

/// The draft of the campaign that `survey` found, with the answers given so far.
pub fn draft(survey: &Survey, answers: &Answers) -> Draft {
    let mut writer = Writer { text: String::new(), questions: Vec::new(), answers };
    writer.head(survey);
    writer.files(survey);
    writer.joint(survey);
    writer.dynamics(survey);
    writer.signal(survey);
    writer.columns(survey);
    writer.trials(survey);
    Draft { text: writer.text, questions: writer.questions }
}

struct Writer<'a> {
    text: String,
    questions: Vec<Question>,
    answers: &'a Answers,
}

impl Writer<'_> {
    fn line(&mut self, line: impl AsRef<str>) {
        self.text.push_str(line.as_ref());
        self.text.push('\n');
    }

    /// `key = value`, given or as a question about `asks`; `place` holds the place.
    fn number(&mut self, section: &str, key: &str, place: f64, asks: &str, suggested: Option<f64>) {
        let id = format!("{section}.{key}");
        match self.answers.number(&id) {
            Some(value) => {
                let value = if key == "torque_sign" { Value::from(value as i64) } else { Value::from(value) };
                self.line(format!("{key} = {value}"));
            }
            None => {
                let value = suggested.unwrap_or(place);
                let value = if key == "torque_sign" { Value::from(value as i64) } else { Value::from(value) };
                self.line(format!("{key} = {value} {MARK} {asks}"));
                let suggested = suggested.map(|value| value.to_string());
                self.questions.push(Question { key: id, asks: asks.to_string(), suggested });
            }
        }
    }

    fn head(&mut self, survey: &Survey) {
        self.line(format!("# Draft by tautline init. Lines with `{MARK}` ask what no data can tell: write the value and delete the mark."));
        let forms: BTreeMap<&str, usize> = survey.sources.iter().fold(BTreeMap::new(), |mut forms, source| {
            *forms.entry(source.form.as_str()).or_default() += 1;
            forms
        });
        for (form, count) in forms {
            self.line(format!("# {count} files: {form}"));
        }
        for note in &survey.chosen.notes {
            self.line(format!("# {note}"));
        }
        self.line("format = \"campaign/1\"");
    }

    fn files(&mut self, survey: &Survey) {
        if survey.chosen.lacks_time {
            self.line("\n[files]");
            self.number(
                "files",
                "rate_hz",
                1000.0,
                "sample rate in Hz: no column holds time; --rate-hz also gives the speeds below",
                None,
            );
        }
    }

    fn joint(&mut self, survey: &Survey) {
        let Answers { name, drive, .. } = self.answers;
        // A number names a joint only among others: `column_2` is no joint 2.
        let is_name = |joint: &String| survey.chosen.joints.len() > 1 || joint.chars().any(char::is_alphabetic);
        let of_files = Some(survey.chosen.joint.clone()).filter(|joint| !joint.is_empty() && is_name(joint));
        let name = name.clone().or(of_files).unwrap_or_else(|| "joint".to_string());
        self.line("\n[joint]");
        self.line(format!("name = {}", quoted(&name)));
        self.line(format!("kind = \"{}\"", survey.chosen.kind.name()));
        match (drive, survey.chosen.kind) {
            (Drive::Cable, JointKind::Revolute) => {
                self.number(
                    "joint",
                    "winch_radius_m",
                    1.0,
                    "radius of the winch, m; a joint without cable: --drive gear, direct or screw",
                    None,
                );
                self.number("joint", "pulley_radius_m", 1.0, "radius of the pulley at the joint, m", None);
            }
            (Drive::Cable, JointKind::Prismatic) => {
                self.line("winch_radius_m = 1.0");
                self.line("pulley_radius_m = 1.0");
            }
            (other, _) => self.line(format!("drive = \"{}\"", other.name())),
        }
        if *drive == Drive::Gear {
            self.number("joint", "gear_ratio", 1.0, "turns of the motor for one of the joint", None);
        }
        if *drive == Drive::Screw {
            self.number("joint", "lead_m", 1.0, "travel of the slide for one turn of the screw, m", None);
        }
        let (key, given) = match drive {
            Drive::Cable => ("backlash_m", self.answers.number("joint.backlash_m")),
            _ => ("backlash_rad", self.answers.number("joint.backlash_rad")),
        };
        match given {
            Some(backlash) => self.line(format!("{key} = {}", Value::from(backlash))),
            None => {
                self.line(format!("{key} = 0.0  # clearance; identify --estimate-backlash finds it from the reversals"))
            }
        }
        let of_current = survey.chosen.of(Quantity::Torque).is_none() && !survey.chosen.is_position_alone();
        match self.answers.number("joint.torque_constant_nm_a") {
            Some(constant) if of_current => self.line(format!("torque_constant_nm_a = {}", Value::from(constant))),
            None if of_current => {
                self.line("# torque_constant_nm_a = 0.05  # torque per ampere; left out, all torques are known up to one factor");
            }
            _ => {}
        }
    }

    fn dynamics(&mut self, survey: &Survey) {
        self.line("\n[dynamics]");
        let asks = match survey.chosen.kind {
            JointKind::Revolute => {
                "torque of gravity about the joint at 90 deg, N m: mass * 9.81 * distance; 0 for a horizontal one"
            }
            JointKind::Prismatic => "force of gravity along the slide, N; 0 for a horizontal one",
        };
        self.number("dynamics", "gravity_nm", 0.0, asks, None);
        let inertia = self.answers.number("dynamics.inertia_kg_m2").unwrap_or(0.0);
        self.line(format!("inertia_kg_m2 = {}  # 0 leaves inertia out", Value::from(inertia)));
    }

    fn signal(&mut self, survey: &Survey) {
        self.line("\n[signal]");
        let asks = match survey.hints.torque_sign {
            Some(sign) => format!(
                "1 or -1? With {sign:.0} friction opposes motion in these data, with {:.0} it would drive it",
                -sign
            ),
            None => {
                "1 or -1, so that y = torque_sign * recorded torque is larger moving up than moving down".to_string()
            }
        };
        match survey.chosen.is_position_alone() {
            true => self.line("torque_sign = 1  # a controller pulls towards its command"),
            false => self.number("signal", "torque_sign", 1.0, &asks, survey.hints.torque_sign),
        }
        let rate_hz = if survey.rate_hz > 0.0 { survey.rate_hz } else { f64::INFINITY };
        self.line(format!("lowpass_hz = {}", Value::from(digits(LOWPASS_HZ.min(LOWPASS_SHARE * rate_hz), 2))));
        self.line("lowpass_order = 4");
        if survey.chosen.is_position_alone() {
            self.controller();
        }
    }

    /// The torque follows from command and position; without a stiffness up to one factor.
    fn controller(&mut self) {
        self.line("\n[controller]  # torque = stiffness (command - position) - damping velocity, at the joint");
        let keys = [
            ("stiffness_nm_rad", "20.0", "N m/rad; left out, all torques are known up to one factor"),
            ("damping_nm_s_rad", "0.5", "N m s/rad; 0 where left out"),
            (
                "speed_filter_s",
                "0.003",
                "s, time constant of the filter through which it has its velocity; 0 where left out",
            ),
            ("torque_limit_nm", "4.0", "N m"),
        ];
        for (key, example, means) in keys {
            match self.answers.number(&format!("controller.{key}")) {
                Some(value) => self.line(format!("{key} = {}", Value::from(value))),
                None => self.line(format!("# {key} = {example}  # {means}")),
            }
        }
    }

    fn columns(&mut self, survey: &Survey) {
        self.line("\n[columns]");
        for choice in &survey.chosen.columns {
            self.column(choice, survey);
        }
        for (quantity, what) in [
            (Quantity::Position, "the joint's position"),
            (Quantity::Torque, "its torque, its motor's current, or its command"),
        ] {
            let is_there = survey.chosen.of(quantity).is_some()
                || quantity == Quantity::Torque
                    && (survey.chosen.of(Quantity::Current).is_some() || survey.chosen.is_position_alone());
            if !is_there {
                let names: Vec<String> = survey.sources[0].columns.iter().map(|series| series.name.clone()).collect();
                let held = crate::limits::listed(names.iter().map(String::as_str));
                let key = quantity.name();
                self.line(format!(
                    "{key} = {{ name = \"\", unit = \"\" }} {MARK} which column holds {what}? The files hold {held}"
                ));
                let asks = format!("which column holds {what}? The files hold {held}");
                self.questions.push(Question { key: format!("columns.{key}"), asks, suggested: None });
            }
        }
    }

    fn column(&mut self, choice: &Choice, survey: &Survey) {
        let id = format!("columns.{}", choice.key);
        let mut asks: Vec<String> = Vec::new();
        if let Some(question) = &choice.question {
            asks.push(question.clone());
            let suggested = Some(choice.measure.to_string());
            self.questions.push(Question { key: id.clone(), asks: question.clone(), suggested });
        }
        let Measure { scale, unit } = choice.measure;
        let mut table = format!("name = {}, unit = {}", quoted(&choice.name), quoted(unit.name()));
        if scale != 1.0 {
            let _ = write!(table, ", scale = {}", Value::from(scale));
        }
        let is_angle = survey.chosen.kind == JointKind::Revolute && choice.key == Quantity::Position.name();
        if is_angle {
            let offset_key = format!("{id}.offset");
            match self.answers.number(&offset_key) {
                Some(0.0) => {}
                Some(offset) => _ = write!(table, ", offset = {}", Value::from(offset)),
                None => {
                    let (question, suggested) = zero(survey, unit);
                    asks.push(question.clone());
                    let offset = suggested.unwrap_or(0.0);
                    let _ = write!(table, ", offset = {}", Value::from(offset));
                    let suggested = suggested.map(|offset| offset.to_string());
                    self.questions.push(Question { key: offset_key, asks: question, suggested });
                }
            }
        }
        let comment = match (asks.is_empty(), choice.why.is_empty()) {
            (false, _) => format!(" {MARK} {}", asks.join("; ")),
            (true, false) => format!("  # {}", choice.why),
            (true, true) => String::new(),
        };
        self.line(format!("{} = {{ {table} }}{comment}", choice.key));
    }

    fn trials(&mut self, survey: &Survey) {
        for DraftTrial { source, rows, protocol, repeat, trajectory, found } in &survey.trials {
            self.line(format!("\n[[trials]]  # {found}"));
            self.line(format!("file = {}", quoted(&survey.sources[*source].log_name())));
            if let Some(rows) = rows {
                self.line(format!("rows = [{}, {}]", rows.start, rows.end));
            }
            self.line(format!("protocol = \"{}\"", protocol.name()));
            if let Protocol::Uniform { speed_rad_s } = protocol {
                self.line(format!("speed_rad_s = {}", Value::from(*speed_rad_s)));
            }
            self.line(format!("repeat = {repeat}"));
            if let Some(trajectory) = trajectory {
                self.line(format!("trajectory = {}", quoted(trajectory)));
            }
        }
    }
}

/// `text` as a TOML string, what acts instead of being shown by its code.
fn quoted(text: &str) -> String {
    let signs = text.chars().map(|sign| match sign {
        '"' | '\\' => format!("\\{sign}"),
        sign if acts(sign) => format!("\\U{:08X}", sign as u32),
        sign => sign.to_string(),
    });
    format!("\"{}\"", signs.collect::<String>())
}

/// The question about the zero of the position, and what the data suggest, in `unit`.
fn zero(survey: &Survey, unit: Unit) -> (String, Option<f64>) {
    let asks = "zero: what is to be added so that gravity's torque is 0 at 0 and grows with the position?";
    match survey.hints.zero_rad {
        Some(zero_rad) if zero_rad.abs() < ZERO_NEGLIGIBLE_RAD => {
            (format!("{asks} Nothing, as the data have it"), Some(0.0))
        }
        Some(zero_rad) => {
            let offset = digits(zero_rad / unit.factor(), 3);
            (
                format!("{asks} As the data have it {offset} {}, if gravity alone loads the joint", unit.name()),
                Some(offset),
            )
        }
        None => (asks.to_string(), None),
    }
}
