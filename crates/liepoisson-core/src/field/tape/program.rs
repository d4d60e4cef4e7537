//! A graph of rules laid out in memory: which series are kept, and the steps that extend them.

use super::graph::{Graph, Node, Rule};
use super::steps::{Convolution, Form, Joint, JointForm, Kind, Slot, Step, Tangent, TangentStep};

/// Numbers of series and of single registers.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Size {
    pub(super) series: usize,
    pub(super) singles: usize,
}

impl Size {
    fn series(&mut self) -> usize {
        self.series += 1;
        self.series - 1
    }

    fn singles(&mut self, n: usize) -> usize {
        self.singles += n;
        self.singles - n
    }

    fn slot(&mut self, is_series: bool) -> Slot {
        let index = if is_series { self.series() } else { self.singles(1) };
        Slot { index, is_series }
    }
}

#[derive(Clone, Debug)]
pub(super) struct Program {
    pub(super) convolutions: Vec<Convolution>,
    pub(super) steps: Vec<Step>,
    pub(super) tangent_steps: Vec<TangentStep>,
    /// The same steps, those of state and tangent vector together where there is a rule for both.
    pub(super) joints: Vec<Joint>,
    /// Convolutions that no joint step forms.
    pub(super) separate: Vec<usize>,
    pub(super) outputs: Vec<JointForm>,
    pub(super) tangent_outputs: Vec<Form>,
    /// Registers for the state, and for each tangent vector.
    pub(super) state: Size,
    pub(super) tangent: Size,
    /// Single register that is not finite if anything at order 0 is not.
    pub(super) defect: usize,
    /// Series that must not pass through zero.
    pub(super) branches: Vec<usize>,
    /// The series of `j a_j` for each argument `a` of an exponential.
    pub(super) exponents: Vec<usize>,
}

/// Which nodes' series the sums of products read.
struct Uses {
    state: Vec<bool>,
    weighted: Vec<bool>,
    tangent: Vec<bool>,
}

impl Uses {
    fn of(graph: &Graph) -> Uses {
        let none = vec![false; graph.rules.len()];
        let mut uses = Uses { state: none.clone(), weighted: none.clone(), tangent: none };
        for (z, rule) in graph.rules.iter().enumerate() {
            let (state, tangent): (&[Node], &[Node]) = match *rule {
                Rule::Component(_) | Rule::Affine(_) | Rule::Second => (&[], &[]),
                Rule::Product(a, b) => (&[a, b], &[a, b]),
                Rule::Square(a) => (&[a], &[a]),
                Rule::Quotient(_, b) => (&[b, z], &[b, z]),
                Rule::Sqrt(_) => (&[z], &[z]),
                Rule::Integral { of, derivative, .. } => (&[derivative], &[of]),
                Rule::DividedIntegral { divisor, .. } => (&[divisor], &[z]),
                Rule::Pair { of, .. } => (&[z, z + 1], &[of]),
            };
            state.iter().for_each(|&node| uses.state[node] = true);
            if graph.has_tangent_part(z) {
                tangent.iter().for_each(|&node| uses.tangent[node] = true);
            }
            match *rule {
                Rule::Integral { of, .. } | Rule::Pair { of, .. } => uses.weighted[of] = true,
                Rule::DividedIntegral { .. } => uses.weighted[z] = true,
                _ => {}
            }
        }
        uses
    }
}

impl Program {
    pub(super) fn new(graph: &Graph) -> Program {
        let uses = Uses::of(graph);
        let (mut state, mut tangent) = (Size::default(), Size::default());
        let n = graph.rules.len();
        let defect = state.singles(1);
        let slots: Vec<Slot> = (0..n).map(|z| state.slot(uses.state[z])).collect();
        let weighted: Vec<usize> = (0..n).map(|z| if uses.weighted[z] { state.series() } else { 0 }).collect();
        let tangents: Vec<Slot> =
            (0..n)
                .map(|z| {
                    if graph.has_tangent[z] {
                        tangent.slot(uses.tangent[z])
                    } else {
                        Slot { index: 0, is_series: false }
                    }
                })
                .collect();
        let tangent_outputs: Vec<Form> = graph.outputs.iter().map(|output| Form::linear(output, &tangents)).collect();
        let outputs = graph.outputs.iter().zip(&tangent_outputs);
        let outputs = outputs.map(|(output, tangent)| JointForm::new(&Form::new(output, &slots), tangent)).collect();
        let mut layout = Layout {
            graph,
            slots,
            weighted,
            tangents,
            is_weighed: vec![false; n],
            pending: vec![],
            pending_until: 0,
            program: Program {
                convolutions: vec![],
                steps: vec![],
                tangent_steps: vec![],
                joints: vec![],
                separate: vec![],
                outputs,
                tangent_outputs,
                state,
                tangent,
                defect,
                branches: vec![],
                exponents: vec![],
            },
        };
        for (z, rule) in graph.rules.iter().enumerate() {
            let before = [layout.program.steps.len(), layout.program.tangent_steps.len()];
            let convolutions = layout.program.convolutions.len();
            layout.add(z, rule);
            layout.join(z, rule, before, convolutions);
        }
        layout.program.branches = graph.branches().map(|node| layout.slots[node].index).collect();
        layout.program.exponents = graph.exponents().map(|node| layout.weighted[node]).collect();
        layout.program.exponents.dedup();
        layout.program
    }
}

struct Layout<'g> {
    graph: &'g Graph,
    slots: Vec<Slot>,
    weighted: Vec<usize>,
    tangents: Vec<Slot>,
    is_weighed: Vec<bool>,
    /// Tangent steps that wait for a later node of the state, and which one.
    pending: Vec<usize>,
    pending_until: Node,
    program: Program,
}

impl Layout<'_> {
    /// Reserves the registers of a convolution for node `z`: those of the state and those of a tangent vector. The
    /// tangent operands are `left` and `right`.
    fn convolution(
        &mut self,
        z: Node,
        kind: Kind,
        left: usize,
        right: [usize; 2],
        tangent: impl FnOnce(&[Slot]) -> (usize, usize),
    ) -> (usize, usize) {
        let width = if kind == Kind::Pair { 4 } else { 2 };
        let sums = self.program.state.singles(width);
        let (mut tangent_sums, mut part) = (0, None);
        if self.graph.has_tangent_part(z) {
            tangent_sums = self.program.tangent.singles(width);
            let (left, right) = tangent(&self.tangents);
            part = Some(Tangent { left, right, sums: tangent_sums });
        }
        self.program.convolutions.push(Convolution { kind, left, right, sums, tangent: part });
        (sums, tangent_sums)
    }

    /// The series of `j a_j`, made by the first that needs it.
    fn weigh(&mut self, a: Node) -> usize {
        let to = self.weighted[a];
        if !std::mem::replace(&mut self.is_weighed[a], true) {
            self.program.steps.push(Step::Weigh { a: self.slots[a], to });
        }
        to
    }

    fn add(&mut self, z: Node, rule: &Rule) {
        let (to, dto) = (self.slots[z], self.tangents[z]);
        let (step, tangent_step) = match *rule {
            Rule::Component(from) => (Step::Component { from, to }, TangentStep::Component { from, to: dto }),
            Rule::Affine(ref form) => (
                Step::Affine { form: Form::new(form, &self.slots), to },
                TangentStep::Affine { form: Form::linear(form, &self.tangents), to: dto },
            ),
            Rule::Product(a, b) => self.product(z, a, b),
            Rule::Square(a) => {
                let series = self.slots[a].index;
                let (sums, dsums) =
                    self.convolution(z, Kind::Square, series, [series; 2], |d| (d[a].index, d[a].index));
                let da = self.tangents[a].index;
                (Step::Square { a: series, sums, to }, TangentStep::Square { a: series, da, sums: dsums, to: dto })
            }
            Rule::Quotient(a, b) => self.quotient(z, a, b),
            Rule::Sqrt(a) => {
                let (sums, dsums) =
                    self.convolution(z, Kind::Square, to.index, [to.index; 2], |d| (d[z].index, d[z].index));
                let (inverse, to) = (self.program.state.singles(1), to.index);
                let (a, da) = (self.slots[a], self.tangents[a]);
                let tangent = TangentStep::Sqrt { da, z: to, sums: dsums, inverse, to: dto.index };
                (Step::Sqrt { a, sums, inverse, to }, tangent)
            }
            Rule::Integral { function, of, derivative, factor } => {
                let (weighted, w) = (self.weigh(of), self.slots[derivative].index);
                let (sums, dsums) = self.convolution(z, Kind::Single, weighted, [w; 2], |d| (d[of].index, 0));
                let (a, da) = (self.slots[of], self.tangents[of].index);
                (
                    Step::Integral { function, a, weighted, derivative: w, factor, sums, to },
                    TangentStep::Integral { w, da, factor, sums: dsums, to: dto },
                )
            }
            Rule::DividedIntegral { function, of, divisor, factor } => {
                let (weighted, divisor) = (self.weighted[z], self.slots[divisor].index);
                let (sums, dsums) = self.convolution(z, Kind::Single, weighted, [divisor; 2], |d| (d[z].index, 0));
                let inverse = self.program.state.singles(1);
                self.is_weighed[z] = true;
                let (a, da) = (self.slots[of], self.tangents[of]);
                (
                    Step::DividedIntegral { function, a, factor, divisor, weighted, sums, inverse, to },
                    TangentStep::DividedIntegral { da, factor, divisor, sums: dsums, inverse, to: dto.index },
                )
            }
            Rule::Pair { of, hyperbolic } => return self.pair(z, of, hyperbolic),
            Rule::Second => return,
        };
        self.push(z, step, tangent_step);
    }

    /// Lists the steps of node `z`, those from `before` on, for the joint run.
    ///
    /// Where the rule of a tangent part reads a node of the state that comes later, it waits for that, and so do the
    /// tangent parts of all nodes up to there.
    fn join(&mut self, z: Node, rule: &Rule, before: [usize; 2], convolutions: usize) {
        if let Rule::Integral { derivative, .. } = *rule {
            self.pending_until = self.pending_until.max(derivative);
        }
        let program = &mut self.program;
        let (steps, tangents) = (before[0]..program.steps.len(), before[1]..program.tangent_steps.len());
        let waits = self.pending_until > z || !self.pending.is_empty();
        let last = steps.end.saturating_sub(1);
        let both = (!waits && !steps.is_empty())
            .then(|| Joint::of(&program.steps[last], &program.tangent_steps[tangents.clone()]));
        if let Some(joint) = both.flatten() {
            for step in steps.start..last {
                program.joints.push(Joint::of_state(step, &program.steps[step]));
            }
            program.joints.push(joint);
        } else {
            for step in steps {
                program.joints.push(Joint::of_state(step, &program.steps[step]));
            }
            program.separate.extend(convolutions..program.convolutions.len());
            self.pending.extend(tangents);
            if self.pending_until <= z {
                program.joints.extend(self.pending.drain(..).map(Joint::Tangent));
            }
        }
    }

    fn push(&mut self, z: Node, step: Step, tangent_step: TangentStep) {
        self.program.steps.push(step);
        if self.graph.has_tangent[z] {
            self.program.tangent_steps.push(tangent_step);
        }
    }

    fn product(&mut self, z: Node, a: Node, b: Node) -> (Step, TangentStep) {
        let (left, right) = (self.slots[a].index, self.slots[b].index);
        let (sums, dsums) = self.convolution(z, Kind::Product, left, [right; 2], |d| (d[a].index, d[b].index));
        let (da, db) = (self.tangents[a].index, self.tangents[b].index);
        (
            Step::Product { a: left, b: right, sums, to: self.slots[z] },
            TangentStep::Product { a: left, b: right, da, db, sums: dsums, to: self.tangents[z] },
        )
    }

    fn quotient(&mut self, z: Node, a: Option<Node>, b: Node) -> (Step, TangentStep) {
        let (divisor, to) = (self.slots[b].index, self.slots[z].index);
        let (sums, dsums) = self.convolution(z, Kind::Product, divisor, [to; 2], |d| (d[b].index, d[z].index));
        let inverse = self.program.state.singles(1);
        let tangent = TangentStep::Quotient {
            da: a.map(|a| self.tangents[a]),
            b: divisor,
            z: to,
            db: self.tangents[b].index,
            sums: dsums,
            inverse,
            to: self.tangents[z].index,
        };
        (Step::Quotient { a: a.map(|a| self.slots[a]), b: divisor, sums, inverse, to }, tangent)
    }

    /// `first' = second a'`, `second' = -first a'` (plus for the hyperbolic pair).
    fn pair(&mut self, z: Node, of: Node, hyperbolic: bool) {
        let weighted = self.weigh(of);
        let (first, second) = (self.slots[z].index, self.slots[z + 1].index);
        let (sums, dsums) = self.convolution(z, Kind::Pair, weighted, [second, first], |d| (d[of].index, 0));
        self.program.steps.push(Step::Pair { a: self.slots[of], hyperbolic, weighted, first, second, sums });
        let sign = if hyperbolic { 1.0 } else { -1.0 };
        let da = self.tangents[of].index;
        for (node, w, factor, sums) in [(z, second, 1.0, dsums), (z + 1, first, sign, dsums + 2)] {
            if self.graph.has_tangent[node] {
                let to = self.tangents[node];
                self.program.tangent_steps.push(TangentStep::Integral { w, da, factor, sums, to });
            }
        }
    }
}
