//! A formula as lines of C99 or of Rust: expressions are written alike in both, since C's functions of `<math.h>` and those of the
//! `libm` crate have the same names; only statements and choices differ.

use crate::numerics::expression::{Expression, Node, Operand, Tape};
use std::collections::{BTreeMap, HashSet};

/// A language.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Language {
    /// C99.
    C,
    /// Rust without its standard library.
    Rust,
}

/// Longer expressions are cut into several lines, characters.
const LONG: usize = 90;

/// How tightly an expression holds together, the loosest first: a choice, a sum, a product, a single thing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Binding {
    Choice,
    Sum,
    Product,
    Single,
}

/// A number as both languages read it, without loss.
pub fn number(x: f64) -> String {
    let text = format!("{x:?}");
    if x < 0.0 { format!("({text})") } else { text }
}

impl Language {
    /// A member of what the code has a pointer to, or a reference: `x->load_nm`, `x.load_nm`.
    pub fn member(self, of: &str, name: &str) -> String {
        match self {
            Self::C => format!("{of}->{name}"),
            Self::Rust => format!("{of}.{name}"),
        }
    }

    /// A line that keeps `expression` as `name`.
    fn constant(self, name: &str, expression: &str) -> String {
        match self {
            Self::C => format!("    const double {name} = {expression};\n"),
            Self::Rust => format!("    let {name} = {expression};\n"),
        }
    }

    fn choice(self, condition: &str, then: &str, otherwise: &str) -> String {
        match self {
            Self::C => format!("{condition} > 0.0 ? {then} : {otherwise}"),
            Self::Rust => format!("if {condition} > 0.0 {{ {then} }} else {{ {otherwise} }}"),
        }
    }
}

/// Lines that compute `result`, a formula on `tape`, and keep it as `name`.
pub fn lines(tape: &Tape, result: Expression<'_>, name: &str, language: Language) -> String {
    let (nodes, names) = tape.steps();
    let mut printer = Printer { language, nodes: &nodes, texts: BTreeMap::new(), lines: String::new() };
    let used = printer.uses(result.operand());
    let mut taken: HashSet<String> = HashSet::new();
    for (at, uses) in used {
        let (text, binding) = printer.text_of(&nodes[at]);
        let named = names.get(&at).map(|name| (*name).to_string());
        let keeps = named.is_some() || uses > 1 || text.len() > LONG;
        let kept = if keeps && !matches!(nodes[at], Node::Input(_)) {
            let stem = named.unwrap_or_else(|| "part".to_string());
            let mut name = stem.clone();
            for i in 2.. {
                if taken.insert(name.clone()) {
                    break;
                }
                name = format!("{stem}_{i}");
            }
            printer.lines += &language.constant(&name, &text);
            (name, Binding::Single)
        } else {
            (text, binding)
        };
        printer.texts.insert(at, kept);
    }
    let (text, _) = printer.operand(result.operand());
    printer.lines + &language.constant(name, &text)
}

/// `result`, a formula on `tape`, in one expression that may stand anywhere.
pub fn inline(tape: &Tape, result: Expression<'_>, language: Language) -> String {
    let (nodes, _) = tape.steps();
    let mut printer = Printer { language, nodes: &nodes, texts: BTreeMap::new(), lines: String::new() };
    for at in printer.uses(result.operand()).into_keys() {
        let text = printer.text_of(&nodes[at]);
        printer.texts.insert(at, text);
    }
    printer.at_least(Binding::Single, result.operand())
}

struct Printer<'n> {
    language: Language,
    nodes: &'n [Node],
    /// What stands for each step further on.
    texts: BTreeMap<usize, (String, Binding)>,
    lines: String,
}

impl Printer<'_> {
    /// The steps that `result` needs, in order, and how often each is used.
    fn uses(&self, result: Operand) -> BTreeMap<usize, usize> {
        let mut uses = BTreeMap::new();
        let mut open = vec![result];
        while let Some(operand) = open.pop() {
            let Operand::Node(at) = operand else { continue };
            let count = uses.entry(at).or_insert(0);
            *count += 1;
            if *count == 1 {
                match &self.nodes[at] {
                    Node::Input(_) => {}
                    Node::Negated(a) => open.push(*a),
                    Node::Operation(_, a, b) => open.extend([*a, *b]),
                    Node::Call(_, given) => open.extend(given),
                    Node::Choice(a, b, c) => open.extend([*a, *b, *c]),
                }
            }
        }
        uses
    }

    fn operand(&self, operand: Operand) -> (String, Binding) {
        match operand {
            Operand::Number(bits) => (number(f64::from_bits(bits)), Binding::Single),
            Operand::Node(at) => self.texts[&at].clone(),
        }
    }

    /// `operand`, in parentheses where it holds together less than `binding`.
    fn at_least(&self, binding: Binding, operand: Operand) -> String {
        let (text, own) = self.operand(operand);
        if own < binding { format!("({text})") } else { text }
    }

    fn text_of(&self, node: &Node) -> (String, Binding) {
        match node {
            Node::Input(text) => (text.clone(), Binding::Single),
            Node::Negated(a) => (format!("(-{})", self.at_least(Binding::Single, *a)), Binding::Single),
            Node::Operation(sign, a, b) => {
                let (own, right) = match sign {
                    '+' | '-' => (Binding::Sum, Binding::Product),
                    _ => (Binding::Product, Binding::Single),
                };
                (format!("{} {sign} {}", self.at_least(own, *a), self.at_least(right, *b)), own)
            }
            Node::Call(function, given) => {
                let given: Vec<String> = given.iter().map(|operand| self.operand(*operand).0).collect();
                (format!("{function}({})", given.join(", ")), Binding::Single)
            }
            Node::Choice(condition, then, otherwise) => {
                let condition = self.at_least(Binding::Sum, *condition);
                let (then, otherwise) = (self.at_least(Binding::Sum, *then), self.at_least(Binding::Sum, *otherwise));
                (self.language.choice(&condition, &then, &otherwise), Binding::Choice)
            }
        }
    }
}
