//! Values of the scene: numbers, points, axes, names, each checked, each fault at its place. `None` means that a fault was
//! reported; callers read all fields of a node before they give up, so that all its faults are.

use super::ast;
use super::expr::{self, Kind, Quantity, name_of};
use super::fault::decimal_commas;
use super::fields::Written;
use super::motion::unit_vector;
use super::params::Params;
use super::source::{Field, Raw, Source};
use super::units::Unit;
use crate::diag::{Diagnostic, Span, short};
use crate::geom::Vec3;

/// Largest coordinate and length, in the scene's unit. With the smallest one, products of three stay far from overflow and
/// underflow, as exact predicates need.
pub(super) const MAX_LENGTH: f64 = 1e9;
/// Smallest size, in the scene's unit.
pub(super) const MIN_SIZE: f64 = 1e-9;
/// What to do about numbers that no model needs.
const LARGER_UNIT: &str = "check the units; `units` should be one in which the model has handy numbers";
/// What to do about infinities and what is no number.
pub(super) const NOT_FINITE: &str =
    "check the expression and its parameters: a division by 0, or a root or arc cosine of what has none";
/// Faults reported in one run; more help nobody.
const MAX_FAULTS: usize = 200;

/// Reads values, and collects what is wrong with them.
pub(super) struct Reader<'a> {
    pub source: Source<'a>,
    pub unit: Unit,
    pub params: Params<'a>,
    faults: Vec<Diagnostic>,
    pub warnings: Vec<Diagnostic>,
}

/// What to write for a quantity of this kind.
fn wanted_unit(kind: Kind) -> &'static str {
    match kind {
        Kind::Plain => "write it without unit",
        Kind::Angle => "write a plain number of degrees, or `deg` or `rad` behind it",
        Kind::Length(1) => "write a plain number, which is in the scene's unit, or a unit behind it: \"12.5 mm\"",
        Kind::Length(_) => "write a plain number, or a unit with its power: \"2 mm^2\", \"0.5 mm^3\"",
    }
}

/// A node of the scene, for messages.
#[derive(Clone, Copy)]
pub(super) struct Owner<'a> {
    pub kind: &'static str,
    pub raw: Raw<'a>,
}

impl<'a> Reader<'a> {
    /// A reader of `text`; the scene's unit and parameters are set later.
    pub fn new(text: &'a str, unit: Unit) -> Self {
        let params = Params::default();
        Self { source: Source::new(text), unit, params, faults: Vec::new(), warnings: Vec::new() }
    }

    /// Reports a fault; copies say theirs again and again, which must not leave others without room.
    pub fn fault(&mut self, diagnostic: Diagnostic) {
        if !self.is_full() && !self.faults.contains(&diagnostic) {
            self.faults.push(diagnostic);
        }
    }
    /// Reports a fault at `raw`; gives `None` for the caller to return.
    pub fn fail<T>(
        &mut self,
        raw: Raw<'a>,
        code: &'static str,
        message: impl Into<String>,
        hint: impl Into<String>,
    ) -> Option<T> {
        let diagnostic = Diagnostic::error(code, message).at(self.source.span(raw)).hint(hint);
        self.fault(diagnostic);
        None
    }
    /// All faults so far, in the order of their places.
    pub fn take_faults(&mut self) -> Vec<Diagnostic> {
        let mut faults = std::mem::take(&mut self.faults);
        faults.sort_by_key(|d| d.span);
        faults.dedup();
        faults
    }
    /// Whether anything was wrong.
    pub fn has_faults(&self) -> bool {
        !self.faults.is_empty()
    }
    /// Whether further faults are not kept: then their hints, which may be costly, need not be made.
    pub fn is_full(&self) -> bool {
        self.faults.len() >= MAX_FAULTS
    }
    /// Where `raw` stands.
    pub fn span(&self, raw: Raw<'a>) -> Span {
        self.source.span(raw)
    }

    /// A value of type `T`.
    pub fn read<T: Written<'a>>(&mut self, raw: Raw<'a>) -> Option<T> {
        let mut value: T = self.source.read(raw).map_err(|diagnostic| self.fault(diagnostic)).ok()?;
        for stray in value.take_strays(raw) {
            let span = self.span(stray.name);
            self.fault(stray.fault.at(span));
        }
        Some(value)
    }
    /// The value of a field, or a default if it is absent.
    pub fn read_or<T: Written<'a>>(&mut self, field: Field<'a>, default: T) -> Option<T> {
        field.0.map_or(Some(default), |raw| self.read(raw))
    }
    /// The value of a field that may be absent.
    pub fn maybe<T>(&mut self, field: Field<'a>, read: impl FnOnce(&mut Self, Raw<'a>) -> Option<T>) -> Option<Option<T>> {
        field.0.map_or(Some(None), |raw| read(self, raw).map(Some))
    }
    /// The text of a field that must be there.
    pub fn need(&mut self, owner: Owner<'a>, label: &str, field: Field<'a>) -> Option<Raw<'a>> {
        let message = || format!("{} needs the field `{label}`", owner.kind);
        let hint = || format!("write `{label}: ...` between its parentheses");
        field.0.or_else(|| self.fail(owner.raw, "missing-field", message(), hint()))
    }

    /// A number of any kind; `label` says of what.
    pub fn quantity(&mut self, label: &str, raw: Raw<'a>) -> Option<Quantity> {
        let quantity = if raw.0.starts_with(['"', 'r']) {
            let text: String = self.read(raw)?;
            self.expression(label, &text, Some(raw))?
        } else {
            Quantity { value: self.read::<f64>(raw)?, kind: Kind::Plain }
        };
        if !quantity.value.is_finite() {
            let hint = if raw.0.starts_with(['"', 'r']) { NOT_FINITE } else { "write a number from -1e9 to 1e9" };
            return self.fail(raw, "not-finite", format!("`{label}` is not finite: it is {}", quantity.value), hint);
        }
        Some(Quantity { value: quantity.value + 0.0, ..quantity })
    }

    /// The value of an expression that stands in the scene at `raw`, or came from the command line for the parameter `label`.
    pub fn expression(&mut self, label: &str, text: &str, raw: Option<Raw<'a>>) -> Option<Quantity> {
        let unit = self.unit;
        match expr::evaluate(text, unit, &mut |name| self.param(name)) {
            Ok(quantity) => Some(quantity),
            Err(None) => None,
            Err(Some((at, mut diagnostic))) => {
                // Behind the quote; exact unless the string has escapes.
                if raw.is_none() {
                    diagnostic.message = format!("--set {label}={text}: {}", diagnostic.message);
                }
                diagnostic.span = raw.map(|raw| {
                    let is_plain = raw.0.get(1..).is_some_and(|inner| inner.starts_with(text));
                    self.source.span_at(self.source.offset(raw) + if is_plain { 1 + at } else { 0 })
                });
                self.fault(diagnostic);
                None
            }
        }
    }

    /// A number of kind `kind`, or a plain one.
    fn number(&mut self, label: &str, raw: Raw<'a>, kind: Kind) -> Option<f64> {
        let quantity = self.quantity(label, raw)?;
        if quantity.kind == kind || quantity.kind == Kind::Plain {
            return Some(quantity.value);
        }
        let message = format!("`{label}` must be {}, not {}", name_of(kind), name_of(quantity.kind));
        self.fail(raw, "wrong-unit", message, wanted_unit(kind))
    }
    /// A plain number.
    pub fn plain(&mut self, label: &str, raw: Raw<'a>) -> Option<f64> {
        self.number(label, raw, Kind::Plain)
    }
    /// An angle in degrees.
    pub fn degrees(&mut self, label: &str, raw: Raw<'a>) -> Option<f64> {
        self.number(label, raw, Kind::Angle)
    }
    /// A coordinate.
    pub fn length(&mut self, label: &str, raw: Raw<'a>) -> Option<f64> {
        let value = self.number(label, raw, Kind::Length(1))?;
        if value.abs() > MAX_LENGTH {
            let message = format!("`{label}` is {value:e}; lengths go up to 1e9 units");
            return self.fail(raw, "out-of-range", message, LARGER_UNIT);
        }
        Some(value)
    }
    /// A positive number of kind `kind`.
    pub fn positive(&mut self, label: &str, raw: Raw<'a>, kind: Kind) -> Option<f64> {
        let value = self.number(label, raw, kind)?;
        if value > 0.0 {
            return Some(value);
        }
        let hint = "write a number above 0, and check the parameters that it comes from";
        self.fail(raw, "not-positive", format!("`{label}` must be positive, it is {value}"), hint)
    }
    /// A positive length.
    pub fn size(&mut self, label: &str, raw: Raw<'a>) -> Option<f64> {
        let value = self.positive(label, raw, Kind::Length(1))?;
        if !(MIN_SIZE..=MAX_LENGTH).contains(&value) {
            let message = format!("`{label}` is {value:e}; sizes go from 1e-9 to 1e9 units");
            return self.fail(raw, "out-of-range", message, LARGER_UNIT);
        }
        Some(value)
    }
    /// A positive length that must be there.
    pub fn needed_size(&mut self, owner: Owner<'a>, label: &str, field: Field<'a>) -> Option<f64> {
        let raw = self.need(owner, label, field)?;
        self.size(label, raw)
    }
    /// A radius, given as such or as a diameter.
    pub fn radius(&mut self, owner: Owner<'a>, radius: Field<'a>, diameter: Field<'a>) -> Option<f64> {
        match (radius.0, diameter.0) {
            (Some(_), Some(raw)) => {
                self.fail(raw, "conflict", format!("{} has both `radius` and `diameter`", owner.kind), "leave out one of them")
            }
            (None, Some(raw)) => Some(0.5 * self.size("diameter", raw)?),
            _ => self.needed_size(owner, "radius", radius),
        }
    }
    /// A whole number from `least` to `most`.
    pub fn count(&mut self, label: &str, raw: Raw<'a>, least: u32, most: u32) -> Option<u32> {
        let value = self.plain(label, raw)?;
        if value == libm::rint(value) && (f64::from(least)..=f64::from(most)).contains(&value) {
            return Some(value as u32);
        }
        let code = if value == libm::rint(value) { "out-of-range" } else { "not-whole" };
        let hint = match value > f64::from(most) {
            true => "write a smaller number".to_owned(),
            false if value < f64::from(least) => format!("write {least} or more"),
            false => format!("write {} or {}, or use round(..) in the expression", libm::floor(value), libm::ceil(value)),
        };
        self.fail(raw, code, format!("`{label}` must be a whole number from {least} to {most}, it is {}", short(value)), hint)
    }

    /// The values of a tuple of known length.
    pub fn tuple<const N: usize>(&mut self, label: &str, raw: Raw<'a>) -> Option<[Raw<'a>; N]> {
        let form = &["(x, y)", "(x, y, z)"][usize::from(N == 3)];
        if !raw.0.starts_with('(') {
            let message = format!("`{label}` must be {N} values in parentheses: {form}");
            return self.fail(raw, "wrong-type", message, format!("write {form}, round parentheses and commas"));
        }
        let values = self.read::<ast::Values>(raw)?.0;
        let count = values.len();
        values.try_into().ok().or_else(|| {
            let message = format!("`{label}` must be {N} values, {form}; here are {count}");
            let hint = decimal_commas(raw.0, count.saturating_sub(N));
            let form = || "points of space are (x, y, z), those of a plane (x, y)".to_owned();
            self.fail(raw, "wrong-length", message, hint.unwrap_or_else(form))
        })
    }
    /// A point of space.
    pub fn point(&mut self, label: &str, raw: Raw<'a>) -> Option<Vec3> {
        let [x, y, z] = self.tuple(label, raw)?.map(|c| self.length(label, c));
        Some(Vec3::new(x?, y?, z?))
    }
    /// A point of space; the origin if absent.
    pub fn point_or_origin(&mut self, label: &str, field: Field<'a>) -> Option<Vec3> {
        field.0.map_or(Some(Vec3::zeros()), |raw| self.point(label, raw))
    }
    /// Three positive lengths.
    pub fn sizes(&mut self, label: &str, raw: Raw<'a>) -> Option<Vec3> {
        let [x, y, z] = self.tuple(label, raw)?.map(|c| self.size(label, c));
        Some(Vec3::new(x?, y?, z?))
    }
    /// A point of the plane.
    pub fn point2(&mut self, label: &str, raw: Raw<'a>) -> Option<[f64; 2]> {
        let [x, y] = self.tuple(label, raw)?.map(|c| self.length(label, c));
        Some([x?, y?])
    }
    /// A point of the plane; the origin if absent.
    pub fn point2_or_origin(&mut self, label: &str, field: Field<'a>) -> Option<[f64; 2]> {
        field.0.map_or(Some([0.0; 2]), |raw| self.point2(label, raw))
    }
    /// A direction of length 1: X, Y, Z or a vector.
    pub fn axis(&mut self, label: &str, raw: Raw<'a>) -> Option<Vec3> {
        if !raw.0.starts_with(|c: char| c == '(' || c.is_alphabetic()) {
            let message = format!("`{label}` must be X, Y, Z or a vector (x, y, z)");
            return self.fail(raw, "wrong-type", message, "write Z without quotes, or (0, 0, 1)");
        }
        if !raw.0.starts_with('(') {
            return Some(match self.read::<ast::Axis>(raw)? {
                ast::Axis::X => Vec3::x(),
                ast::Axis::Y => Vec3::y(),
                ast::Axis::Z => Vec3::z(),
            });
        }
        let vector = self.point(label, raw)?;
        match unit_vector(vector) {
            Some(unit) => Some(unit),
            None => {
                let hint = "write X, Y, Z or a vector of any length but 0";
                self.fail(raw, "zero-axis", format!("`{label}` has no direction: it is (0, 0, 0)"), hint)
            }
        }
    }
    /// A direction; z if absent.
    pub fn axis_or_z(&mut self, field: Field<'a>) -> Option<Vec3> {
        field.0.map_or(Some(Vec3::z()), |raw| self.axis("axis", raw))
    }

    /// A name that solvers and TetGen can carry: ASCII letters, digits and signs without blanks and `|`.
    pub fn name(&mut self, label: &str, raw: Raw<'a>) -> Option<String> {
        let name: String = self.read(raw)?;
        // Longer names are cut by some solvers.
        let is_good =
            !name.is_empty() && name.len() <= 64 && name.chars().all(|c| c.is_ascii_graphic() && !"|\"\\".contains(c));
        if is_good {
            return Some(name);
        }
        let hint = "names are 1 to 64 printable ASCII characters without blanks, `|`, quotes and `\\`";
        self.fail(raw, "bad-name", format!("`{name}` cannot be the {label}"), hint)
    }

    /// A name that interfaces are called by: any but `outer`.
    pub fn name_of_interfaces(&mut self, label: &str, raw: Raw<'a>) -> Option<String> {
        let name = self.name(label, raw)?;
        if name != "outer" {
            return Some(name);
        }
        let hint =
            "`outer` stands for what lies outside of all parts, as in `air|outer`: choose another one, `outer1` for instance";
        self.fail(raw, "bad-name", format!("`outer` cannot be the {label}"), hint)
    }
}
