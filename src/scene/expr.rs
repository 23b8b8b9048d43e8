//! Expressions in strings: `"0.8 mm"`, `"gap/2 + 3 mm"`, `"sin(30) * r"`.
//!
//! ```text
//! sum     = product { ("+" | "-") product }
//! product = sign { ("*" | "/") sign }
//! sign    = { "+" | "-" } power
//! power   = postfix [ "^" sign ]
//! postfix = literal [ unit ] | primary [ unit ]        unit = mm, .., mm^2, mm^3, deg, rad
//! primary = name | function "(" sum { "," sum } ")" | "(" sum ")"
//! ```
//! Every quantity is a plain number, a power of a length or an angle. Plain numbers go with everything (they are in the scene's
//! unit, or degrees); lengths and angles do not go with each other.

use super::fault::{decimal_comma, decimal_point};
use super::units::{UNITS, Unit};
use crate::diag::Diagnostic;
use std::f64::consts::PI;

/// What a quantity measures.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Kind {
    /// A number without unit.
    Plain,
    /// A power of a length, in the scene's unit.
    Length(i32),
    /// An angle in degrees.
    Angle,
}

/// A number and what it measures.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Quantity {
    pub value: f64,
    pub kind: Kind,
}

/// What is wrong at a byte of the expression; `None` if it was reported elsewhere (a faulty parameter).
pub(super) type Fault = Option<(usize, Diagnostic)>;

/// Depth of parentheses, signs and powers: bounds the stack.
const MAX_DEPTH: u32 = 100;
/// How numbers are written.
const DECIMAL: &str = "numbers are decimal with a point: 12.5, 1e-3; at most 800 digits";
const FUNCTIONS: [&str; 16] = [
    "sin", "cos", "tan", "asin", "acos", "atan", "atan2", "sqrt", "hypot", "abs", "min", "max", "floor", "ceil", "round", "mod",
];

/// The value of an expression. `lookup` gives the value of a parameter.
pub(super) fn evaluate(
    text: &str,
    unit: Unit,
    lookup: &mut dyn FnMut(&str) -> Result<Quantity, Option<Diagnostic>>,
) -> Result<Quantity, Fault> {
    let mut parser = Parser { text, at: 0, depth: 0, unit, lookup };
    let value = parser.sum()?;
    parser.blanks();
    match parser.peek() {
        None => Ok(value),
        Some(c) => {
            let hint = match decimal_comma(text, parser.at) {
                Some((_, number)) => decimal_point(number),
                None => {
                    "between two quantities stands + - * / or ^, between arguments a comma; the decimal sign is a point".into()
                }
            };
            parser.fail("expression", format!("unexpected `{c}` in the expression \"{text}\""), &hint)
        }
    }
}

struct Parser<'t, 'l> {
    text: &'t str,
    at: usize,
    depth: u32,
    unit: Unit,
    lookup: &'l mut dyn FnMut(&str) -> Result<Quantity, Option<Diagnostic>>,
}

type Value = Result<Quantity, Fault>;

fn plain(value: f64) -> Quantity {
    Quantity { value, kind: Kind::Plain }
}

fn length(value: f64, power: i32) -> Quantity {
    Quantity { value, kind: if power == 0 { Kind::Plain } else { Kind::Length(power) } }
}

impl<'t> Parser<'t, '_> {
    fn rest(&self) -> &'t str {
        self.text.get(self.at..).unwrap_or("")
    }
    fn peek(&self) -> Option<char> {
        self.rest().chars().next()
    }
    fn blanks(&mut self) {
        self.at += self.rest().len() - self.rest().trim_start().len();
    }
    fn eat(&mut self, c: char) -> bool {
        self.blanks();
        let found = self.peek() == Some(c);
        self.at += if found { c.len_utf8() } else { 0 };
        found
    }
    fn fail<T>(&self, code: &'static str, message: impl Into<String>, hint: &str) -> Result<T, Fault> {
        self.fail_at(self.at, Diagnostic::error(code, message).hint(hint))
    }
    fn fail_at<T>(&self, at: usize, diagnostic: Diagnostic) -> Result<T, Fault> {
        Err(Some((at, diagnostic)))
    }
    fn wrong_unit<T>(&self, at: usize, message: String) -> Result<T, Fault> {
        self.fail_at(
            at,
            Diagnostic::error("wrong-unit", message)
                .hint("a unit belongs to the number or parenthesis right before it: \"(pi/2) rad\", \"(1/2) mm\""),
        )
    }

    fn deeper(&mut self, inner: impl FnOnce(&mut Self) -> Value) -> Value {
        if self.depth == MAX_DEPTH {
            return self.fail("expression", "the expression is nested too deeply", "give pieces of it names in `params`");
        }
        self.depth += 1;
        let value = inner(self);
        self.depth -= 1;
        value
    }

    fn sum(&mut self) -> Value {
        let mut left = self.product()?;
        loop {
            let sign = if self.eat('+') {
                1.0
            } else if self.eat('-') {
                -1.0
            } else {
                return Ok(left);
            };
            let at = self.at;
            let right = self.product()?;
            left = Quantity { value: left.value + sign * right.value, kind: self.common(at, left, right)? };
        }
    }

    /// The kind of a sum; equal, or one is plain.
    fn common(&self, at: usize, a: Quantity, b: Quantity) -> Result<Kind, Fault> {
        match (a.kind, b.kind) {
            (kind, Kind::Plain) | (Kind::Plain, kind) => Ok(kind),
            (x, y) if x == y => Ok(x),
            (x, y) => self.wrong_unit(at, format!("{} and {} cannot be added or compared", name_of(x), name_of(y))),
        }
    }

    fn product(&mut self) -> Value {
        let mut left = self.sign()?;
        loop {
            let is_quotient = if self.eat('*') {
                false
            } else if self.eat('/') {
                true
            } else {
                return Ok(left);
            };
            let at = self.at;
            let right = self.sign()?;
            left = self.multiplied(at, left, right, is_quotient)?;
        }
    }

    fn multiplied(&self, at: usize, a: Quantity, b: Quantity, is_quotient: bool) -> Value {
        let sign = if is_quotient { -1 } else { 1 };
        let power = |k: Kind| match k {
            Kind::Length(n) => n,
            _ => 0,
        };
        let value = if is_quotient { a.value / b.value } else { a.value * b.value };
        match (a.kind, b.kind) {
            (Kind::Angle, Kind::Angle) if is_quotient => Ok(plain(value)),
            (Kind::Angle, Kind::Plain) => Ok(Quantity { value, kind: Kind::Angle }),
            (Kind::Plain, Kind::Angle) if !is_quotient => Ok(Quantity { value, kind: Kind::Angle }),
            (Kind::Angle, _) | (_, Kind::Angle) => {
                self.wrong_unit(at, format!("{} and {} cannot be multiplied or divided", name_of(a.kind), name_of(b.kind)))
            }
            (x, y) => Ok(length(value, power(x).saturating_add(sign * power(y)))),
        }
    }

    fn sign(&mut self) -> Value {
        if self.eat('-') {
            let q = self.deeper(Self::sign)?;
            return Ok(Quantity { value: -q.value, ..q });
        }
        if self.eat('+') {
            return self.deeper(Self::sign);
        }
        let base = self.postfix()?;
        if !self.eat('^') {
            return Ok(base);
        }
        let at = self.at;
        let exponent = self.deeper(Self::sign)?;
        if exponent.kind != Kind::Plain {
            return self.wrong_unit(at, "an exponent has no unit".into());
        }
        let value = libm::pow(base.value, exponent.value);
        match base.kind {
            Kind::Plain => Ok(plain(value)),
            // Beyond this power no quantity of the scene has a meaning.
            Kind::Length(n) if exponent.value == libm::rint(exponent.value) && exponent.value.abs() <= 16.0 => {
                Ok(length(value, n.saturating_mul(exponent.value as i32)))
            }
            kind => self.wrong_unit(at, format!("{} has no such power", name_of(kind))),
        }
    }

    fn postfix(&mut self) -> Value {
        self.blanks();
        let start = self.at;
        if self.peek().is_some_and(|c| c.is_ascii_digit() || c == '.') {
            let literal = self.literal();
            return self.with_unit(start, Some(literal), None);
        }
        let primary = self.primary()?;
        self.with_unit(start, None, Some(primary))
    }

    /// The characters of a decimal literal.
    fn literal(&mut self) -> &'t str {
        let bytes = self.rest().as_bytes();
        let digits = |from: usize| from + bytes[from..].iter().take_while(|b| b.is_ascii_digit() || **b == b'.').count();
        let mut end = digits(0);
        if bytes.get(end).is_some_and(|b| b.eq_ignore_ascii_case(&b'e')) {
            let signed = end + 1 + usize::from(bytes.get(end + 1).is_some_and(|b| matches!(b, b'+' | b'-')));
            if bytes.get(signed).is_some_and(u8::is_ascii_digit) {
                end = digits(signed);
            }
        }
        let literal = &self.rest()[..end];
        self.at += end;
        literal
    }

    /// Reads the unit behind a literal or a primary, if there is one, and converts.
    fn with_unit(&mut self, start: usize, literal: Option<&str>, primary: Option<Quantity>) -> Value {
        let Some(number) = primary.or_else(|| literal.and_then(|l| l.parse().ok()).map(plain)) else {
            return self.fail_at(start, Diagnostic::error("expression", "this is not a number").hint(DECIMAL));
        };
        self.blanks();
        let at = self.at;
        let name = self.name();
        if name.is_empty() {
            return Ok(number);
        }
        if number.kind != Kind::Plain {
            return self.wrong_unit(at, format!("`{name}` stands behind a quantity that has a unit"));
        }
        match name {
            "deg" => return Ok(Quantity { kind: Kind::Angle, ..number }),
            // Divided first, so that "pi/2 rad" and "(pi/6) rad" give whole degrees.
            "rad" => return Ok(Quantity { value: number.value / PI * 180.0, kind: Kind::Angle }),
            _ => {}
        }
        let Some(unit) = Unit::named(name) else {
            let diagnostic = Diagnostic::error("wrong-unit", format!("unknown unit `{name}`"));
            let known = UNITS.iter().map(|u| u.name).chain(["deg", "rad"]);
            return self.fail_at(at, super::fault::with_names(diagnostic, name, known));
        };
        let power = if self.eat('^') {
            match self.literal().parse() {
                Ok(power @ 1..=3) => power,
                _ => return self.fail("wrong-unit", "a unit has the power 1, 2 or 3", "write mm, mm^2 or mm^3"),
            }
        } else {
            1u32
        };
        let text = match literal {
            Some(literal) => literal.to_owned(),
            None => format!("{:e}", number.value.abs()),
        };
        let sign = if number.value < 0.0 { -1.0 } else { 1.0 };
        match unit.convert(&text, power, self.unit) {
            Some(value) => Ok(length(sign * value, power as i32)),
            None => self.fail_at(start, Diagnostic::error("expression", "this number cannot be converted").hint(DECIMAL)),
        }
    }

    fn name(&mut self) -> &'t str {
        let rest = self.rest();
        let starts = rest.starts_with(|c: char| c.is_alphabetic() || c == '_');
        let end = rest.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(rest.len());
        let name = if starts { &rest[..end] } else { "" };
        self.at += name.len();
        name
    }

    fn primary(&mut self) -> Value {
        let start = self.at;
        let name = self.name();
        if name.is_empty() {
            if !self.eat('(') {
                let found = self.peek().map_or("its end".to_owned(), |c| format!("`{c}`"));
                let message = format!("expected a number or a name, found {found}");
                return self.fail("expression", message, "write a number with or without unit, a parameter or a function");
            }
            let value = self.deeper(Self::sum)?;
            return if self.eat(')') { Ok(value) } else { self.fail("expression", "a `)` is missing", "close each `(`") };
        }
        if self.eat('(') {
            return self.call(start, name);
        }
        if name == "pi" {
            return Ok(plain(PI));
        }
        (self.lookup)(name).map_err(|fault| fault.map(|diagnostic| (start, diagnostic)))
    }

    fn call(&mut self, start: usize, name: &str) -> Value {
        if !FUNCTIONS.contains(&name) {
            let diagnostic = Diagnostic::error("expression", format!("unknown function `{name}`"));
            return self.fail_at(start, super::fault::with_names(diagnostic, name, FUNCTIONS));
        }
        let mut arguments = vec![self.deeper(Self::sum)?];
        while self.eat(',') {
            arguments.push(self.deeper(Self::sum)?);
        }
        if !self.eat(')') {
            return self.fail("expression", "a `)` is missing", "close each `(`; between arguments stands a comma");
        }
        self.apply(start, name, &arguments)
    }

    fn apply(&self, start: usize, name: &str, arguments: &[Quantity]) -> Value {
        let angle = |value: f64| Quantity { value, kind: Kind::Angle };
        let (x, y) = match arguments {
            [x] => (*x, None),
            [x, y] => (*x, Some(*y)),
            _ => return self.wrong_count(start, name, "one or two numbers"),
        };
        let is_length = matches!(x.kind, Kind::Length(_));
        match (name, y) {
            ("sin" | "cos" | "tan", None) if !is_length => {
                let (s, c) = super::motion::sin_cos(x.value);
                Ok(plain(match name {
                    "sin" => s,
                    "cos" => c,
                    _ => s / c,
                }))
            }
            ("asin", None) if x.kind == Kind::Plain => Ok(angle(libm::asin(x.value) / PI * 180.0)),
            ("acos", None) if x.kind == Kind::Plain => Ok(angle(libm::acos(x.value) / PI * 180.0)),
            ("atan", None) if x.kind == Kind::Plain => Ok(angle(libm::atan(x.value) / PI * 180.0)),
            ("sqrt", None) => match x.kind {
                Kind::Length(n) if n % 2 == 0 => Ok(length(libm::sqrt(x.value), n / 2)),
                Kind::Plain => Ok(plain(libm::sqrt(x.value))),
                kind => self.wrong_unit(start, format!("{} has no square root here", name_of(kind))),
            },
            ("abs", None) => Ok(Quantity { value: x.value.abs(), ..x }),
            ("floor", None) => Ok(Quantity { value: libm::floor(x.value), ..x }),
            ("ceil", None) => Ok(Quantity { value: libm::ceil(x.value), ..x }),
            ("round", None) => Ok(Quantity { value: libm::round(x.value), ..x }),
            ("atan2" | "hypot" | "min" | "max" | "mod", Some(y)) => {
                let kind = self.common(start, x, y)?;
                Ok(match name {
                    "atan2" => angle(libm::atan2(x.value, y.value) / PI * 180.0),
                    "hypot" => Quantity { value: libm::hypot(x.value, y.value), kind },
                    "min" => Quantity { value: x.value.min(y.value), kind },
                    "max" => Quantity { value: x.value.max(y.value), kind },
                    _ => Quantity { value: x.value - y.value * libm::floor(x.value / y.value), kind },
                })
            }
            ("sin" | "cos" | "tan" | "asin" | "acos" | "atan", None) => {
                self.wrong_unit(start, format!("`{name}` of {}", name_of(x.kind)))
            }
            (_, Some(_)) => self.wrong_count(start, name, "one number"),
            _ => self.wrong_count(start, name, "two numbers"),
        }
    }

    fn wrong_count(&self, start: usize, name: &str, count: &str) -> Value {
        let fault = Diagnostic::error("expression", format!("`{name}` takes {count}"));
        self.fail_at(start, fault.hint("arguments are separated by commas; the decimal sign is a point"))
    }
}

/// A kind in words.
pub(super) fn name_of(kind: Kind) -> String {
    match kind {
        Kind::Plain => "a plain number".into(),
        Kind::Length(1) => "a length".into(),
        Kind::Length(2) => "an area".into(),
        Kind::Length(3) => "a volume".into(),
        Kind::Length(n) => format!("a length to the power {n}"),
        Kind::Angle => "an angle".into(),
    }
}
