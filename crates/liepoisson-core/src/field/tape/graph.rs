//! From the instructions of a tape to the shortest list of power-series rules that computes the same outputs.
//!
//! Every register becomes an affine form in *nodes*: components of the state and results of nonlinear rules. So
//! constants fold, factors leave products, and linear combinations are formed where they are used, all by themselves.
//! A node is made once for equal operands (value numbering); nodes that no output needs are dropped at the end.

use super::instruction::Instruction;
use std::collections::HashMap;

/// Index of a node.
pub(super) type Node = usize;

/// A function of one variable: what it is at order 0; the rule that uses it knows its derivative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Function {
    Power(f64),
    Exp,
    Log,
    Tanh,
    Asin,
    Acos,
    Atan,
}

/// How one node follows from others, as power series in time.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Rule {
    /// A component of the state.
    Component(usize),
    Affine(Affine),
    Product(Node, Node),
    Square(Node),
    /// `b z = a`; `None` for `a = 1`.
    Quotient(Option<Node>, Node),
    /// `z^2 = a`
    Sqrt(Node),
    /// `z' = factor w a'`. The coefficients of `w` below the current order suffice, so `w` may depend on `z`.
    Integral {
        function: Function,
        of: Node,
        derivative: Node,
        factor: f64,
    },
    /// `d z' = factor a'`
    DividedIntegral {
        function: Function,
        of: Node,
        divisor: Node,
        factor: f64,
    },
    /// Sine and cosine, or their hyperbolic sisters; the second of the pair is the next node.
    Pair {
        of: Node,
        hyperbolic: bool,
    },
    /// The second node of the pair before it.
    Second,
}

impl Rule {
    /// The nodes that the rule reads.
    fn operands(&self, this: Node) -> Vec<Node> {
        match *self {
            Rule::Component(_) => vec![],
            Rule::Affine(ref form) => form.terms.iter().map(|&(node, _)| node).collect(),
            Rule::Product(a, b) | Rule::Quotient(Some(a), b) => vec![a, b],
            Rule::Square(a) | Rule::Sqrt(a) | Rule::Quotient(None, a) => vec![a],
            Rule::Integral { of, derivative: other, .. } | Rule::DividedIntegral { of, divisor: other, .. } => {
                vec![of, other]
            }
            Rule::Pair { of, .. } => vec![of, this + 1],
            Rule::Second => vec![this - 1],
        }
    }

    /// The nodes whose tangent parts the tangent part of the rule reads: `dz = w da` needs that of `a` alone.
    fn tangent_operands(&self, this: Node) -> Vec<Node> {
        match *self {
            Rule::Integral { of, .. } | Rule::DividedIntegral { of, .. } | Rule::Pair { of, .. } => vec![of],
            _ => self.operands(this),
        }
    }

    fn renumber(&mut self, new: &[Node]) {
        match self {
            Rule::Component(_) | Rule::Second => {}
            Rule::Affine(form) => form.renumber(new),
            Rule::Product(a, b) | Rule::Quotient(Some(a), b) => (*a, *b) = (new[*a], new[*b]),
            Rule::Square(a) | Rule::Sqrt(a) | Rule::Quotient(None, a) | Rule::Pair { of: a, .. } => *a = new[*a],
            Rule::Integral { of, derivative: other, .. } | Rule::DividedIntegral { of, divisor: other, .. } => {
                (*of, *other) = (new[*of], new[*other]);
            }
        }
    }
}

/// `constant + sum c_i node_i`, nodes ascending, no coefficient zero.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Affine {
    pub(super) constant: f64,
    pub(super) terms: Vec<(Node, f64)>,
}

impl Affine {
    fn constant(constant: f64) -> Affine {
        Affine { constant, terms: vec![] }
    }

    fn node(node: Node) -> Affine {
        Affine { constant: 0.0, terms: vec![(node, 1.0)] }
    }

    fn scaled(&self, factor: f64) -> Affine {
        let mut scaled = self.clone();
        scaled.constant *= factor;
        scaled.terms.iter_mut().for_each(|(_, c)| *c *= factor);
        scaled.terms.retain(|&(_, c)| c != 0.0);
        scaled
    }

    fn as_constant(&self) -> Option<f64> {
        self.terms.is_empty().then_some(self.constant)
    }

    /// `c` and the node, of `c node`.
    fn as_multiple(&self) -> Option<(Node, f64)> {
        (self.constant == 0.0 && self.terms.len() == 1).then(|| self.terms[0])
    }

    /// Sum of multiples of forms.
    fn combination<'f>(constant: f64, parts: impl Iterator<Item = (&'f Affine, f64)>) -> Affine {
        let (mut sum, mut terms) = (constant, Vec::new());
        for (form, factor) in parts {
            sum += factor * form.constant;
            terms.extend(form.terms.iter().map(|&(node, c)| (node, c * factor)));
        }
        terms.sort_by_key(|&(node, _)| node); // stable: equal nodes add up in the order in which they came
        terms.dedup_by(|later, first| {
            let same = later.0 == first.0;
            if same {
                first.1 += later.1;
            }
            same
        });
        terms.retain(|&(_, c)| c != 0.0);
        Affine { constant: sum, terms }
    }

    fn renumber(&mut self, new: &[Node]) {
        self.terms.iter_mut().for_each(|(node, _)| *node = new[*node]);
    }
}

/// What the tape came to.
pub(super) struct Graph {
    /// In an order in which they can be computed.
    pub(super) rules: Vec<Rule>,
    /// Which nodes need a tangent part.
    pub(super) has_tangent: Vec<bool>,
    /// The derivative of each component.
    pub(super) outputs: Vec<Affine>,
}

/// A form used more than once is kept as a node when it has more terms than this: forming it anew costs more.
const TERMS_TO_REPEAT: usize = 4;

/// Largest integer exponent that is taken apart into products, which need no nonzero base.
const LARGEST_INTEGER_POWER: f64 = 1024.0;

impl Graph {
    /// Reads instructions that have been checked.
    pub(super) fn new(n_components: usize, instructions: &[Instruction], outputs: &[usize]) -> Graph {
        let mut uses = vec![0_usize; n_components + instructions.len()];
        let read = instructions.iter().flat_map(|instruction| instruction.registers());
        read.chain(outputs.iter().copied()).for_each(|register| uses[register] += 1);
        let mut builder = Builder::default();
        let mut values: Vec<Affine> =
            (0..n_components).map(|i| Affine::node(builder.push(Rule::Component(i)))).collect();
        for instruction in instructions {
            let mut value = builder.evaluate(instruction, &values);
            if uses[values.len()] > 1 && value.terms.len() > TERMS_TO_REPEAT {
                value = Affine::node(builder.materialise(&value));
            }
            values.push(value);
        }
        let outputs = outputs.iter().map(|&register| values[register].clone()).collect();
        Graph::without_dead_nodes(builder.rules, outputs)
    }

    /// Nodes at whose zeros a series can go over to another branch: roots, and the arguments of powers. All are kept as series,
    /// for the products in their rules or as divisors. A logarithm is singular there, which its series tells.
    pub(super) fn branches(&self) -> impl Iterator<Item = Node> {
        self.rules.iter().enumerate().filter_map(|(z, rule)| match *rule {
            Rule::Sqrt(_) => Some(z),
            Rule::Integral { function: Function::Power(exponent), of, .. } if has_branches(exponent) => Some(of),
            _ => None,
        })
    }

    /// The arguments of exponentials and of their kin.
    pub(super) fn exponents(&self) -> impl Iterator<Item = Node> {
        self.rules.iter().filter_map(|rule| match *rule {
            Rule::Integral { function: Function::Exp | Function::Tanh, of, .. }
            | Rule::Pair { of, hyperbolic: true } => Some(of),
            _ => None,
        })
    }

    /// The order up to which derivatives tell that a rule is not constant, the largest of all rules, given what a component and an
    /// exponential count. A component counts one; an exponential can be below round-off with all its derivatives and large nearby, so
    /// it counts infinitely many, or none where its argument is known not to change much. Sines with their cosines are never small
    /// together; a sine is level to the second order at most. Roots, quotients and logarithms vary as a power of the distance from
    /// where they are singular, which does not hide them; elsewhere `a/b` is as near to a number c as `a - c b` is to zero.
    ///
    /// With nothing for components and one for an exponential: how many exponentials are multiplied.
    pub(super) fn degree(&self, component: f64, exponential: f64) -> f64 {
        let mut degrees: Vec<f64> = Vec::with_capacity(self.rules.len());
        for rule in &self.rules {
            let degree = match *rule {
                Rule::Component(_) => component,
                Rule::Affine(ref form) => form.terms.iter().map(|&(node, _)| degrees[node]).fold(0.0, f64::max),
                Rule::Product(a, b) => degrees[a] + degrees[b],
                Rule::Quotient(Some(a), b) => f64::max(degrees[a], degrees[b]),
                Rule::Square(a) => 2.0 * degrees[a],
                Rule::Quotient(None, a) | Rule::Sqrt(a) | Rule::DividedIntegral { of: a, .. } => degrees[a],
                Rule::Integral { function: Function::Power(exponent), of, .. } => exponent.abs().max(1.0) * degrees[of],
                Rule::Integral { .. } | Rule::Pair { hyperbolic: true, .. } => exponential,
                Rule::Pair { of, .. } => 2.0 * degrees[of],
                Rule::Second => degrees.last().copied().unwrap_or(exponential),
            };
            degrees.push(degree);
        }
        degrees.into_iter().fold(0.0, f64::max)
    }

    /// The outputs as linear combinations of components, if they are such.
    pub(super) fn affine_outputs(&self) -> Option<Vec<Affine>> {
        let component = |&(node, c): &(Node, f64)| match self.rules[node] {
            Rule::Component(component) => Some((component, c)),
            _ => None,
        };
        let form = |output: &Affine| {
            let terms = output.terms.iter().map(component).collect::<Option<_>>()?;
            Some(Affine { constant: output.constant, terms })
        };
        self.outputs.iter().map(form).collect()
    }

    /// Whether the rule of `node` has a tangent part: for a pair, if either of the two needs one.
    pub(super) fn has_tangent_part(&self, node: Node) -> bool {
        self.has_tangent[node] || (matches!(self.rules[node], Rule::Pair { .. }) && self.has_tangent[node + 1])
    }

    fn without_dead_nodes(rules: Vec<Rule>, mut outputs: Vec<Affine>) -> Graph {
        let needed = reachable(&rules, &outputs, Rule::operands);
        let mut with_tangent = reachable(&rules, &outputs, Rule::tangent_operands);
        let mut new = vec![usize::MAX; rules.len()];
        let mut kept = Vec::new();
        let mut has_tangent = Vec::new();
        for (node, rule) in rules.into_iter().enumerate().filter(|&(node, _)| needed[node]) {
            new[node] = kept.len();
            kept.push(rule);
            has_tangent.push(std::mem::take(&mut with_tangent[node]));
        }
        kept.iter_mut().for_each(|rule| rule.renumber(&new));
        outputs.iter_mut().for_each(|form| form.renumber(&new));
        Graph { rules: kept, has_tangent, outputs }
    }
}

/// Which nodes the outputs lead to.
fn reachable(rules: &[Rule], outputs: &[Affine], operands: impl Fn(&Rule, Node) -> Vec<Node>) -> Vec<bool> {
    let mut reached = vec![false; rules.len()];
    let mut pending: Vec<Node> = outputs.iter().flat_map(|form| form.terms.iter().map(|&(node, _)| node)).collect();
    while let Some(node) = pending.pop() {
        if !std::mem::replace(&mut reached[node], true) {
            pending.extend(operands(&rules[node], node));
        }
    }
    reached
}

/// Whether the series of `|u|^m` to this power is that of an odd power of `u`, for an even `m`: beyond the zero it is the
/// negative of the power. Otherwise it has none there, or the same.
fn has_branches(exponent: f64) -> bool {
    (2..=64).step_by(2).any(|m| {
        let power = f64::from(m) * exponent;
        let whole = libm::rint(power);
        (power - whole).abs() <= 8.0 * f64::EPSILON * power.abs() && libm::fmod(whole, 2.0) != 0.0
    })
}

#[derive(Default)]
struct Builder {
    rules: Vec<Rule>,
    /// Nodes by what computes them: a tag, operands, bits of numbers.
    known: HashMap<Vec<u64>, Node>,
}

impl Builder {
    fn push(&mut self, rule: Rule) -> Node {
        self.rules.push(rule);
        self.rules.len() - 1
    }

    /// The node for `key`; where there is none yet, the one that `make` adds.
    fn once(&mut self, key: Vec<u64>, make: impl FnOnce(&mut Builder) -> Node) -> Node {
        if let Some(&node) = self.known.get(&key) {
            return node;
        }
        let node = make(self);
        self.known.insert(key, node);
        node
    }

    fn evaluate(&mut self, instruction: &Instruction, values: &[Affine]) -> Affine {
        match *instruction {
            Instruction::Linear { ref terms, constant } => {
                Affine::combination(constant, terms.iter().map(|&(register, c)| (&values[register], c)))
            }
            Instruction::Product(a, b) => self.product(&values[a], &values[b]),
            Instruction::Quotient(a, b) => self.quotient(&values[a], &values[b]),
            Instruction::Power(a, exponent) => self.power(&values[a], exponent),
            Instruction::Sqrt(a) => self.sqrt(&values[a]),
            Instruction::Exp(a) => self.function(Function::Exp, &values[a], |builder, a| {
                let z = builder.rules.len();
                builder.push(Rule::Integral { function: Function::Exp, of: a, derivative: z, factor: 1.0 })
            }),
            Instruction::Log(a) => self.function(Function::Log, &values[a], |builder, a| {
                builder.push(Rule::DividedIntegral { function: Function::Log, of: a, divisor: a, factor: 1.0 })
            }),
            Instruction::Sin(a) => self.pair(&values[a], false, 0, libm::sin),
            Instruction::Cos(a) => self.pair(&values[a], false, 1, libm::cos),
            Instruction::Sinh(a) => self.pair(&values[a], true, 0, libm::sinh),
            Instruction::Cosh(a) => self.pair(&values[a], true, 1, libm::cosh),
            Instruction::Tanh(a) => self.function(Function::Tanh, &values[a], Builder::tanh),
            Instruction::Asin(a) => {
                self.function(Function::Asin, &values[a], |builder, a| builder.arc(Function::Asin, a, 1.0))
            }
            Instruction::Acos(a) => {
                self.function(Function::Acos, &values[a], |builder, a| builder.arc(Function::Acos, a, -1.0))
            }
            Instruction::Atan(a) => self.function(Function::Atan, &values[a], |builder, a| {
                let square = builder.square(a);
                let divisor = builder.materialise(&Affine { constant: 1.0, terms: vec![(square, 1.0)] });
                builder.push(Rule::DividedIntegral { function: Function::Atan, of: a, divisor, factor: 1.0 })
            }),
        }
    }

    /// A node for `form` itself.
    fn materialise(&mut self, form: &Affine) -> Node {
        if let Some((node, 1.0)) = form.as_multiple() {
            return node;
        }
        let numbers = form.terms.iter().flat_map(|&(node, c)| [node as u64, c.to_bits()]);
        let key = [0, form.constant.to_bits()].into_iter().chain(numbers).collect();
        self.once(key, |builder| builder.push(Rule::Affine(form.clone())))
    }

    /// A node and a factor whose product is `form`; opposite forms give the same node.
    fn factored(&mut self, form: &Affine) -> (Node, f64) {
        match form.as_multiple() {
            Some(multiple) => multiple,
            None if form.terms[0].1 < 0.0 => (self.materialise(&form.scaled(-1.0)), -1.0),
            None => (self.materialise(form), 1.0),
        }
    }

    fn square(&mut self, a: Node) -> Node {
        self.once(vec![1, a as u64], |builder| builder.push(Rule::Square(a)))
    }

    fn product(&mut self, a: &Affine, b: &Affine) -> Affine {
        if let Some(factor) = a.as_constant() {
            return b.scaled(factor);
        }
        if let Some(factor) = b.as_constant() {
            return a.scaled(factor);
        }
        let ((mut i, ca), (mut j, cb)) = (self.factored(a), self.factored(b));
        let mut factor = ca * cb;
        if !(factor.is_finite() && factor != 0.0) {
            // the factors together leave the range of numbers: leave each where it was
            (i, j, factor) = (self.materialise(a), self.materialise(b), 1.0);
        }
        let (i, j) = (i.min(j), i.max(j));
        let node = if i == j {
            self.square(i)
        } else {
            self.once(vec![2, i as u64, j as u64], |builder| builder.push(Rule::Product(i, j)))
        };
        Affine::node(node).scaled(factor)
    }

    fn quotient(&mut self, a: &Affine, b: &Affine) -> Affine {
        if let Some(divisor) = b.as_constant() {
            let divided = Affine { constant: a.constant / divisor, terms: a.terms.clone() };
            return Affine { terms: divided.terms.iter().map(|&(node, c)| (node, c / divisor)).collect(), ..divided };
        }
        let (mut j, cb) = self.factored(b);
        let (numerator, ca) = match a.as_constant() {
            Some(0.0) => return Affine::constant(0.0),
            Some(constant) => (None, constant),
            None => {
                let (node, factor) = self.factored(a);
                (Some(node), factor)
            }
        };
        let mut factor = ca / cb;
        let mut numerator = numerator;
        if !(factor.is_finite() && factor != 0.0) {
            j = self.materialise(b);
            (numerator, factor) =
                if numerator.is_some() { (Some(self.materialise(a)), 1.0) } else { (None, a.constant) };
        }
        let key = quotient_key(numerator, j);
        Affine::node(self.once(key, |builder| builder.push(Rule::Quotient(numerator, j)))).scaled(factor)
    }

    fn sqrt(&mut self, a: &Affine) -> Affine {
        if let Some(constant) = a.as_constant() {
            return Affine::constant(constant.sqrt());
        }
        let a = self.materialise(a);
        Affine::node(self.once(vec![4, a as u64], |builder| builder.push(Rule::Sqrt(a))))
    }

    /// Integer powers by repeated squaring; other powers by `z' = p w a'`, `w = z / a`.
    fn power(&mut self, a: &Affine, exponent: f64) -> Affine {
        if exponent == 0.5 {
            return self.sqrt(a);
        }
        if exponent != exponent.trunc() || exponent.abs() > LARGEST_INTEGER_POWER {
            return self.function(Function::Power(exponent), a, |builder, a| {
                let function = Function::Power(exponent);
                let z = builder.rules.len();
                builder.push(Rule::Integral { function, of: a, derivative: z + 1, factor: exponent });
                builder.once(quotient_key(Some(z), a), |builder| builder.push(Rule::Quotient(Some(z), a)));
                z
            });
        }
        let (mut rest, mut square, mut result) = (exponent.abs() as u32, a.clone(), Affine::constant(1.0));
        while rest > 0 {
            if rest % 2 == 1 {
                result = self.product(&result, &square);
            }
            rest /= 2;
            if rest > 0 {
                square = self.product(&square, &square);
            }
        }
        if exponent < 0.0 { self.quotient(&Affine::constant(1.0), &result) } else { result }
    }

    /// Sine, cosine or a hyperbolic sister: both of the pair at once, since each is the derivative of the other.
    fn pair(&mut self, a: &Affine, hyperbolic: bool, which: usize, value: fn(f64) -> f64) -> Affine {
        if let Some(constant) = a.as_constant() {
            return Affine::constant(value(constant));
        }
        // f(-a) = -f(a) for the first, f(-a) = f(a) for the second
        let is_negative = a.terms[0].1 < 0.0;
        let sign = if is_negative { -1.0 } else { 1.0 };
        let of = self.materialise(&a.scaled(sign));
        let first = self.once(vec![5, u64::from(hyperbolic), of as u64], |builder| {
            let first = builder.push(Rule::Pair { of, hyperbolic });
            builder.push(Rule::Second);
            first
        });
        Affine::node(first + which).scaled(if which == 0 { sign } else { 1.0 })
    }

    fn function(&mut self, function: Function, a: &Affine, make: impl FnOnce(&mut Builder, Node) -> Node) -> Affine {
        if let Some(constant) = a.as_constant() {
            return Affine::constant(function.value(constant));
        }
        let a = self.materialise(a);
        Affine::node(self.once(function.key(a), |builder| make(builder, a)))
    }

    /// `z' = (1 - z^2) a'`
    fn tanh(&mut self, a: Node) -> Node {
        let z = self.rules.len();
        self.push(Rule::Integral { function: Function::Tanh, of: a, derivative: z + 2, factor: 1.0 });
        let square = self.square(z);
        self.materialise(&Affine { constant: 1.0, terms: vec![(square, -1.0)] });
        z
    }

    /// `z' = factor a' / sqrt(1 - a^2)`
    fn arc(&mut self, function: Function, a: Node, factor: f64) -> Node {
        let square = self.square(a);
        let divisor = self.sqrt(&Affine { constant: 1.0, terms: vec![(square, -1.0)] }).terms[0].0;
        self.push(Rule::DividedIntegral { function, of: a, divisor, factor })
    }
}

fn quotient_key(a: Option<Node>, b: Node) -> Vec<u64> {
    vec![3, a.map_or(u64::MAX, |node| node as u64), b as u64]
}

impl Function {
    /// Its value: the same bits on every platform.
    pub(super) fn value(self, x: f64) -> f64 {
        match self {
            Function::Power(exponent) => libm::pow(x, exponent),
            Function::Exp => libm::exp(x),
            Function::Log => libm::log(x),
            Function::Tanh => libm::tanh(x),
            Function::Asin => libm::asin(x),
            Function::Acos => libm::acos(x),
            Function::Atan => libm::atan(x),
        }
    }

    fn key(self, a: Node) -> Vec<u64> {
        let [tag, number] = self.code();
        vec![tag, number, a as u64]
    }

    /// The function as two numbers, the first of which is 6 or more.
    pub(super) fn code(self) -> [u64; 2] {
        match self {
            Function::Power(exponent) => [6, exponent.to_bits()],
            Function::Exp => [7, 0],
            Function::Log => [8, 0],
            Function::Tanh => [9, 0],
            Function::Asin => [10, 0],
            Function::Acos => [11, 0],
            Function::Atan => [12, 0],
        }
    }

    /// The function with this code.
    pub(super) fn from_code(tag: u64, number: u64) -> Function {
        match tag {
            6 => Function::Power(f64::from_bits(number)),
            7 => Function::Exp,
            8 => Function::Log,
            9 => Function::Tanh,
            10 => Function::Asin,
            11 => Function::Acos,
            12 => Function::Atan,
            _ => unreachable!("no function has the code {tag}"),
        }
    }
}
