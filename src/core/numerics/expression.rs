//! Numbers that remember how they came about, so that a formula can be printed as code.

use super::scalar::Scalar;
use std::cell::RefCell;
use std::collections::HashMap;
use std::fmt;
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

/// What a node is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Operand {
    /// A number, by its bits.
    Number(u64),
    /// Another node, by its place on the tape.
    Node(usize),
}

/// One step of a formula.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum Node {
    /// Something that the code is given, as it is written there.
    Input(String),
    /// The other sign.
    Negated(Operand),
    /// `+`, `-`, `*` or `/`.
    Operation(char, Operand, Operand),
    /// A function, by its name in C, and what it is given.
    Call(String, Vec<Operand>),
    /// The second where the first is above 0, else the third.
    Choice(Operand, Operand, Operand),
}

/// All steps of a formula, each before those that use it, equal ones once.
#[derive(Default)]
pub struct Tape {
    nodes: RefCell<Vec<Node>>,
    places: RefCell<HashMap<Node, usize>>,
    names: RefCell<HashMap<usize, &'static str>>,
}

/// A number that is known, or a step on a tape.
#[derive(Clone, Copy)]
pub enum Expression<'t> {
    /// A number.
    Number(f64),
    /// A step.
    Node(&'t Tape, usize),
}

impl Tape {
    /// Something that the code is given, written as `text`.
    pub fn input(&self, text: impl Into<String>) -> Expression<'_> {
        self.push(Node::Input(text.into()))
    }

    /// A `function` of the code's own, called with what is `given`.
    pub fn call<'t>(&'t self, function: &str, given: &[Expression<'t>]) -> Expression<'t> {
        self.push(Node::Call(function.to_string(), given.iter().map(|x| x.operand()).collect()))
    }

    /// The steps, and the names that some of them have.
    pub fn steps(&self) -> (Vec<Node>, HashMap<usize, &'static str>) {
        (self.nodes.borrow().clone(), self.names.borrow().clone())
    }

    fn push(&self, node: Node) -> Expression<'_> {
        let mut nodes = self.nodes.borrow_mut();
        let at = *self.places.borrow_mut().entry(node.clone()).or_insert(nodes.len());
        if at == nodes.len() {
            nodes.push(node);
        }
        Expression::Node(self, at)
    }
}

impl fmt::Debug for Expression<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(x) => write!(f, "{x:?}"),
            Self::Node(_, at) => write!(f, "step {at}"),
        }
    }
}

impl<'t> Expression<'t> {
    /// What a step that uses it holds.
    pub fn operand(self) -> Operand {
        match self {
            Self::Number(x) => Operand::Number(x.to_bits()),
            Self::Node(_, at) => Operand::Node(at),
        }
    }

    /// A function of one, by its name in C.
    fn of_one(self, name: &str, number: fn(f64) -> f64) -> Self {
        match self {
            Self::Number(x) => Self::Number(number(x)),
            Self::Node(tape, _) => tape.call(name, &[self]),
        }
    }

    /// A function of two, by its name in C.
    fn of_two(self, other: Self, name: &str, number: fn(f64, f64) -> f64) -> Self {
        match (self, other) {
            (Self::Number(a), Self::Number(b)) => Self::Number(number(a, b)),
            (Self::Node(tape, _), _) | (_, Self::Node(tape, _)) => {
                tape.push(Node::Call(name.to_string(), vec![self.operand(), other.operand()]))
            }
        }
    }

    fn operation(self, sign: char, other: Self, number: fn(f64, f64) -> f64) -> Self {
        match (self, other) {
            (Self::Number(a), Self::Number(b)) => Self::Number(number(a, b)),
            (Self::Node(tape, _), _) | (_, Self::Node(tape, _)) => {
                tape.push(Node::Operation(sign, self.operand(), other.operand()))
            }
        }
    }

    fn is_number(self, x: f64) -> bool {
        matches!(self, Self::Number(own) if own == x)
    }
}

impl From<f64> for Expression<'_> {
    fn from(x: f64) -> Self {
        Self::Number(x)
    }
}

impl Neg for Expression<'_> {
    type Output = Self;

    fn neg(self) -> Self {
        match self {
            Self::Number(x) => Self::Number(-x),
            Self::Node(tape, _) => tape.push(Node::Negated(self.operand())),
        }
    }
}

impl Add for Expression<'_> {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        match (self, other) {
            (zero, other) | (other, zero) if zero.is_zero() => other,
            _ => self.operation('+', other, |a, b| a + b),
        }
    }
}

impl Sub for Expression<'_> {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        match (self, other) {
            (_, zero) if zero.is_zero() => self,
            (zero, _) if zero.is_zero() => -other,
            _ => self.operation('-', other, |a, b| a - b),
        }
    }
}

impl Mul for Expression<'_> {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        match (self, other) {
            (zero, _) | (_, zero) if zero.is_zero() => Self::Number(0.0),
            (one, other) | (other, one) if one.is_number(1.0) => other,
            _ => self.operation('*', other, |a, b| a * b),
        }
    }
}

impl Div for Expression<'_> {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        match (self, other) {
            (_, one) if one.is_number(1.0) => self,
            (zero, Self::Node(..)) if zero.is_zero() => zero,
            _ => self.operation('/', other, |a, b| a / b),
        }
    }
}

impl Add<f64> for Expression<'_> {
    type Output = Self;

    fn add(self, other: f64) -> Self {
        self + Self::Number(other)
    }
}

impl Sub<f64> for Expression<'_> {
    type Output = Self;

    fn sub(self, other: f64) -> Self {
        self - Self::Number(other)
    }
}

impl Mul<f64> for Expression<'_> {
    type Output = Self;

    fn mul(self, other: f64) -> Self {
        self * Self::Number(other)
    }
}

impl Div<f64> for Expression<'_> {
    type Output = Self;

    fn div(self, other: f64) -> Self {
        self / Self::Number(other)
    }
}

impl AddAssign for Expression<'_> {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl SubAssign for Expression<'_> {
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl MulAssign for Expression<'_> {
    fn mul_assign(&mut self, other: Self) {
        *self = *self * other;
    }
}

impl Scalar for Expression<'_> {
    type Given = Self;

    fn value(self) -> f64 {
        if let Self::Number(x) = self { x } else { f64::NAN }
    }

    fn is_zero(self) -> bool {
        self.is_number(0.0)
    }

    fn sin(self) -> Self {
        self.of_one("sin", f64::sin)
    }

    fn cos(self) -> Self {
        self.of_one("cos", f64::cos)
    }

    fn tanh(self) -> Self {
        self.of_one("tanh", f64::tanh)
    }

    fn atan(self) -> Self {
        self.of_one("atan", f64::atan)
    }

    fn exp(self) -> Self {
        self.of_one("exp", f64::exp)
    }

    fn ln(self) -> Self {
        self.of_one("log", f64::ln)
    }

    fn sqrt(self) -> Self {
        self.of_one("sqrt", f64::sqrt)
    }

    fn abs(self) -> Self {
        self.of_one("fabs", f64::abs)
    }

    fn powf(self, exponent: Self) -> Self {
        if exponent.is_number(1.0) { self } else { self.of_two(exponent, "pow", f64::powf) }
    }

    fn hypot(self, other: Self) -> Self {
        if other.is_zero() { self.abs() } else { self.of_two(other, "hypot", f64::hypot) }
    }

    fn min(self, other: Self) -> Self {
        self.of_two(other, "fmin", f64::min)
    }

    fn max(self, other: Self) -> Self {
        self.of_two(other, "fmax", f64::max)
    }

    fn if_positive(self, then: impl FnOnce() -> Self, otherwise: impl FnOnce() -> Self) -> Self {
        match self {
            Self::Number(x) if x > 0.0 => then(),
            Self::Number(_) => otherwise(),
            Self::Node(tape, _) => tape.push(Node::Choice(self.operand(), then().operand(), otherwise().operand())),
        }
    }

    fn named(self, name: &'static str) -> Self {
        if let Self::Node(tape, at) = self {
            tape.names.borrow_mut().entry(at).or_insert(name);
        }
        self
    }
}
