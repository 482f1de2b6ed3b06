//! An effect as people type it: `id:name=value,name=value`.

use crate::document::suggest;
use crate::effects::{Added, LIBRARY, Parameter, Role, find};
use crate::problem::{Problem, Problems, Result};

/// Where such a text comes from, for messages.
const SOURCE: &str = "command line";

impl Added {
    /// Reads `id:name=value,name=value`. A strength that is not named is 0; one at least must be, and all other parameters.
    ///
    /// Errors: every name that does not exist, every value that is missing or makes no sense.
    pub fn parse(text: &str) -> Result<Self> {
        let (id, pairs) = text.split_once(':').unwrap_or((text, ""));
        let Some(effect) = find(id.trim()) else {
            let cure = suggest(id, "there are", LIBRARY.map(|effect| effect.about().id));
            return Problem::error(SOURCE, format!("there is no effect `{id}`"), cure).alone();
        };
        let known = effect.about().parameters;
        let mut given = Given { id: effect.about().id, known, values: vec![None; known.len()], problems: Vec::new() };
        pairs.split(',').filter(|pair| !pair.trim().is_empty()).for_each(|pair| given.take(pair));
        given.finish().map(|parameters| Self { effect, parameters })
    }
}

/// What was read so far.
struct Given {
    id: &'static str,
    known: &'static [Parameter],
    values: Vec<Option<f64>>,
    problems: Vec<Problem>,
}

impl Given {
    fn refuse(&mut self, what: String, cure: String) {
        self.problems.push(Problem::error(SOURCE, format!("effect `{}`: {what}", self.id), cure));
    }

    fn take(&mut self, pair: &str) {
        let Some((name, value)) = pair.split_once('=').map(|(name, value)| (name.trim(), value.trim())) else {
            return self.refuse(format!("`{pair}` is no name=value"), format!("it takes {}", self.names()));
        };
        let Some(at) = self.known.iter().position(|p| p.name == name) else {
            let cure = suggest(name, "it takes", self.known.iter().map(|p| p.name));
            return self.refuse(format!("has no parameter `{name}`"), cure);
        };
        let (low, high) = self.known[at].bounds;
        match value.parse::<f64>() {
            Ok(x) if !self.known[at].allows(x) => {
                self.refuse(format!("{name} is {x}"), format!("expected {low} to {high}"));
            }
            Ok(_) if self.values[at].is_some() => {
                self.refuse(format!("{name} is given twice"), "leave one out".to_string());
            }
            Ok(x) => self.values[at] = Some(x),
            Err(_) => self.refuse(format!("{name} is `{value}`"), "expected a number".to_string()),
        }
    }

    fn finish(mut self) -> Result<Vec<f64>> {
        if self.problems.is_empty() {
            let is_strength = |p: &Parameter| p.role == Role::Strength;
            let are_given = || self.known.iter().zip(&self.values).filter(|(_, value)| value.is_some());
            if self.known.iter().any(is_strength) && !are_given().any(|(p, _)| is_strength(p)) {
                let strengths: Vec<&str> = self.known.iter().filter(|p| is_strength(p)).map(|p| p.name).collect();
                self.refuse("has no strength".to_string(), format!("give one of {}", strengths.join(", ")));
            }
            for at in 0..self.known.len() {
                if self.values[at].is_none() && self.known[at].default.is_none() {
                    let optional = |p: &&Parameter| p.default.is_some();
                    let may_miss: Vec<&str> = self.known.iter().filter(optional).map(|p| p.name).collect();
                    let cure = format!("it takes {}; only {} may be left out", self.names(), may_miss.join(", "));
                    self.refuse(format!("{} is missing", self.known[at].name), cure);
                }
            }
        }
        let default = |(value, p): (&Option<f64>, &Parameter)| value.or(p.default).unwrap_or(0.0);
        let parameters = self.values.iter().zip(self.known).map(default).collect();
        Problems(self.problems).unless_errors(parameters)
    }

    fn names(&self) -> String {
        self.known.iter().map(|p| p.name).collect::<Vec<_>>().join(", ")
    }
}
