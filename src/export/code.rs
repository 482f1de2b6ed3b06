//! Lines of code that C99 and Rust share: expressions are written alike in both, since C's functions of `<math.h>` and those of
//! the `libm` crate have the same names; only statements differ.

/// A language.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Language {
    /// C99.
    C,
    /// Rust without its standard library.
    Rust,
}

/// A body of code being written.
#[derive(Debug, Clone)]
pub struct Code {
    pub language: Language,
    lines: Vec<String>,
    named: usize,
}

/// A number as both languages read it, without loss.
pub fn number(x: f64) -> String {
    let text = format!("{x:?}");
    if x < 0.0 { format!("({text})") } else { text }
}

impl Code {
    pub fn new(language: Language) -> Self {
        Self { language, lines: Vec::new(), named: 0 }
    }

    /// Keeps `expression` under a name of its own that begins with `stem`.
    pub fn keep(&mut self, stem: &str, expression: &str) -> String {
        self.named += 1;
        let name = format!("{stem}_{}", self.named);
        self.constant(&name, expression);
        name
    }

    /// Keeps `expression` as `name`.
    pub fn constant(&mut self, name: &str, expression: &str) {
        self.lines.push(match self.language {
            Language::C => format!("const double {name} = {expression};"),
            Language::Rust => format!("let {name} = {expression};"),
        });
    }

    /// Begins a variable.
    pub fn variable(&mut self, name: &str, expression: &str) {
        self.lines.push(match self.language {
            Language::C => format!("double {name} = {expression};"),
            Language::Rust => format!("let mut {name} = {expression};"),
        });
    }

    /// `name` becomes `name operator expression`; an operator of `=` sets it.
    pub fn change(&mut self, name: &str, operator: &str, expression: &str) {
        self.lines.push(format!("{name} {operator} {expression};"));
    }

    /// A line of words.
    pub fn remark(&mut self, words: &str) {
        self.lines.push(match self.language {
            Language::C => format!("/* {words} */"),
            Language::Rust => format!("// {words}"),
        });
    }

    /// One value or another.
    pub fn choice(&self, condition: &str, then: &str, otherwise: &str) -> String {
        match self.language {
            Language::C => format!("({condition} ? {then} : {otherwise})"),
            Language::Rust => format!("if {condition} {{ {then} }} else {{ {otherwise} }}"),
        }
    }

    /// A field of the sample that the code is given.
    pub fn of_sample(&self, field: &str) -> String {
        match self.language {
            Language::C => format!("x->{field}"),
            Language::Rust => format!("x.{field}"),
        }
    }

    /// The lines, indented.
    pub fn lines(&self) -> String {
        self.lines.iter().map(|line| format!("    {line}\n")).collect()
    }
}
