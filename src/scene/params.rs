//! Named parameters: expressions that may refer to each other, evaluated on first use.

use super::ast::Entries;
use super::expr::Quantity;
use super::fault::with_names;
use super::reader::Reader;
use super::source::{Field, Raw};
use super::units::Unit;
use crate::diag::Diagnostic;
use std::collections::BTreeMap;

/// Longest chain of parameters that refer to each other: bounds the stack.
const MAX_CHAIN: usize = 200;

/// The parameters of a scene.
#[derive(Default)]
pub(super) struct Params<'a> {
    entries: BTreeMap<String, Param<'a>>,
    /// Their names in the order of the file, in which chains of any length that refer to earlier ones need no depth.
    order: Vec<String>,
    /// Whether some could not be read, so that a name that is not known may be one of them.
    is_incomplete: bool,
    /// Parameters being evaluated, outermost first.
    chain: Vec<String>,
}

struct Param<'a> {
    text: Text<'a>,
    state: State,
}

#[derive(Clone)]
enum Text<'a> {
    Scene(Raw<'a>),
    CommandLine(String),
}

#[derive(Clone, Copy)]
enum State {
    New,
    Busy,
    Faulty,
    Done(Quantity),
}

impl<'a> Reader<'a> {
    /// Reads the `params` map, replaces those set from outside, and evaluates all.
    pub fn load_params(&mut self, field: Field<'a>, overrides: &[(String, String)]) {
        let entries = field.0.and_then(|raw| self.read::<Entries>(raw));
        self.params.is_incomplete = field.0.is_some() && entries.is_none();
        for (key, value) in entries.map_or(Vec::new(), |e| e.0) {
            let Some(name) = self.read::<String>(key) else {
                self.params.is_incomplete = true;
                continue;
            };
            if Unit::named(&name).is_some() || ["deg", "rad"].contains(&name.as_str()) {
                let message = format!(
                    "the parameter `{name}` has the name of a unit: behind a number it is the unit, by itself the parameter"
                );
                let warning = Diagnostic::warning("parameter-like-unit", message).at(self.span(key));
                self.warnings.push(warning.hint("give it another name"));
            }
            let is_name = !name.starts_with(|c: char| c.is_ascii_digit())
                && name.chars().all(|c| c.is_alphanumeric() || c == '_')
                && !["", "pi"].contains(&name.as_str());
            if !is_name {
                self.params.is_incomplete = true;
                let hint = "names are letters, digits and `_`, not beginning with a digit; `pi` is taken";
                self.fail::<()>(key, "bad-name", format!("`{name}` cannot be the name of a parameter"), hint);
            } else if self.params.entries.insert(name.clone(), Param { text: Text::Scene(value), state: State::New }).is_some()
            {
                let message = format!("the parameter `{name}` is given twice");
                self.fail::<()>(key, "duplicate-name", message, "take out one of them");
            } else {
                self.params.order.push(name);
            }
        }
        for (name, value) in overrides {
            match self.params.entries.get_mut(name) {
                Some(param) => param.text = Text::CommandLine(value.clone()),
                // It may be among those that cannot be read.
                None if self.params.is_incomplete => {}
                None => {
                    let mut fault =
                        self.params.unknown(name).hint("only parameters of the scene can be set from the command line");
                    fault.message = format!("--set {name}={value}: {}", fault.message);
                    self.fault(fault);
                }
            }
        }
        for name in std::mem::take(&mut self.params.order) {
            if let Err(Some(fault)) = self.param(&name) {
                self.fault(fault);
            }
        }
    }

    /// The value of a parameter. Errors: none of this name, a cycle, too long a chain; `None` if the fault is reported already.
    pub fn param(&mut self, name: &str) -> Result<Quantity, Option<Diagnostic>> {
        let Some(param) = self.params.entries.get_mut(name) else {
            return Err((!self.params.is_incomplete && !self.is_full()).then(|| self.params.unknown(name)));
        };
        match param.state {
            State::Done(quantity) => return Ok(quantity),
            State::Faulty => return Err(None),
            State::Busy => return Err(Some(self.params.cycle(name))),
            State::New => param.state = State::Busy,
        }
        let text = param.text.clone();
        if self.params.chain.len() == MAX_CHAIN {
            param.state = State::Faulty;
            let fault = Diagnostic::error("too-deep", format!("more than {MAX_CHAIN} parameters refer to each other"));
            return Err(Some(fault.hint("shorten the chain: write numbers, or refer to earlier ones")));
        }
        self.params.chain.push(name.to_owned());
        let value = match text {
            Text::Scene(raw) => self.quantity(name, raw),
            Text::CommandLine(text) => self.expression(name, &text, None).and_then(|quantity| {
                if quantity.value.is_finite() {
                    return Some(quantity);
                }
                let message = format!("--set {name}={text}: `{name}` is not finite: it is {}", quantity.value);
                self.fault(Diagnostic::error("not-finite", message).hint(super::reader::NOT_FINITE));
                None
            }),
        };
        self.params.chain.pop();
        if let Some(param) = self.params.entries.get_mut(name) {
            param.state = value.map_or(State::Faulty, State::Done);
        }
        value.ok_or(None)
    }
}

impl Params<'_> {
    fn unknown(&self, name: &str) -> Diagnostic {
        let diagnostic = Diagnostic::error("unknown-parameter", format!("there is no parameter `{name}`"));
        with_names(diagnostic, name, self.entries.keys().map(String::as_str))
    }

    fn cycle(&self, name: &str) -> Diagnostic {
        let from = self.chain.iter().position(|link| link == name).unwrap_or(0);
        let cycle = self.chain[from..].join(" -> ");
        Diagnostic::error("cyclic-reference", format!("parameters refer to each other in a circle: {cycle} -> {name}"))
            .hint("give one of them a number")
    }
}
