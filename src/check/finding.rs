//! One thing compared: what stood there, what stands there now, and whether that matters.

/// What a finding is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Part {
    /// What `campaign.toml` declares.
    Setting,
    /// A trial: its declaration, its log.
    Data,
    /// A stage that ran, or refused to.
    Stage,
    /// A curve or form that was chosen.
    Choice,
    /// A number.
    Figure,
}

impl Part {
    /// The name used in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Setting => "setting",
            Self::Data => "data",
            Self::Stage => "stage",
            Self::Choice => "choice",
            Self::Figure => "figure",
        }
    }
}

/// Whether a difference matters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// No difference beyond rounding.
    Same,
    /// The data are the same except for rounding.
    Rounded,
    /// The data changed; by itself that is no regression.
    Changed,
    /// The data differ, and the figure moved within its confidence.
    Within,
    /// The data differ, and the figure moved, but is too loosely known to tell.
    Untold,
    /// The data differ, and an error shrank by more than its confidence.
    Better,
    /// It matters.
    Regressed,
}

impl Outcome {
    /// The name used in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Same => "same",
            Self::Rounded => "rounded",
            Self::Changed => "changed",
            Self::Within => "within_confidence",
            Self::Untold => "too_loosely_known",
            Self::Better => "better",
            Self::Regressed => "regressed",
        }
    }
}

/// What stood there.
#[derive(Debug, Clone, PartialEq)]
pub enum Held {
    /// Nothing.
    Nothing,
    /// A text.
    Text(String),
    /// A number; NaN where there is none.
    Number(f64),
}

/// One thing compared.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// What it is about.
    pub part: Part,
    /// Its name: a setting's, a file's, a figure's.
    pub name: String,
    /// The unit of numbers.
    pub unit: String,
    /// In the baseline.
    pub before: Held,
    /// Now.
    pub now: Held,
    /// What a number may move by, in its unit; infinite where it is too loosely known to tell, NaN of texts.
    pub allowed: f64,
    /// Whether it matters.
    pub outcome: Outcome,
    /// What there is to say of it.
    pub note: String,
}

impl Finding {
    /// Of two texts.
    pub(super) fn text(part: Part, name: &str, before: Held, now: Held, outcome: Outcome, note: &str) -> Self {
        let (name, unit, note) = (name.to_string(), String::new(), note.to_string());
        Self { part, name, unit, before, now, allowed: f64::NAN, outcome, note }
    }

    /// What a number moved by, in its unit; NaN of texts.
    pub fn moved(&self) -> f64 {
        match (&self.before, &self.now) {
            (Held::Number(before), Held::Number(now)) => now - before,
            _ => f64::NAN,
        }
    }

    /// The same in tolerances.
    pub fn tolerances(&self) -> f64 {
        self.moved().abs() / self.allowed
    }
}
