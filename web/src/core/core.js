// @ts-check
/**
 * The core of liepoisson in WebAssembly: memory handling and typed calls.  No formula, no step rule and no invariant is
 * here; the core computes all of it.
 *
 * Numbers go in and come out as `Float64Array`, flat and row-major, with the shapes that the comments say.  A call that is
 * refused throws a `Refusal`, whose `kind` is the name of the exception that Python raises.  A mistake in the core throws
 * `CoreStopped`; the instance is then of no use any more, and a new one has to be started.  Calls block: long ones belong
 * into a worker, cut into pieces that go on from one another.
 */

/** @typedef {ArrayLike<number>} Numbers */
/** @typedef {string | [string, ...any[]]} Written an expression: a name, or a list that begins with what it is */
/** @typedef {{names: string[], energy: Written | null, rates: Written[] | null, tensor: [number, number, Written][] | null}} SystemWritten */
/** @typedef {{kind: "top", inertia: Numbers, a: Numbers, b: Numbers, epsilon: number}} TopDescription */
/** @typedef {{kind: "quadratic" | "tape" | "pieces", n_components: number}} OtherDescription as Python writes it */
/** @typedef {TopDescription | OtherDescription} FieldDescription */
/** @typedef {string | number} Exact a number, or the text of one: "1/3", "sqrt(2)/2" */
/**
 * @typedef {{name: "canonical", n: number} | {name: "canonical", coordinates: string[], momenta?: string[]}
 *   | {name: "so3" | "e3"} | {name: "semidirect", n: number} | {name: "leibniz", n: number, epsilon?: Exact}
 *   | {name: "lie_poisson", coordinates: string[], constants: [number, number, number, Exact][]}
 *   | {name: "lie_poisson", fields: Record<string, string[]>, constants: [number, number, number, Exact][]}
 *   | {name: "tensor", coordinates: string[], entries: [number, number, string][]}
 *   | {name: "known", fields: Record<string, string[]>, terms: [number, number, number, string][]}} BracketDescription
 *   constants (i, j, k, c) with [e_i, e_j] = sum of c e_k, i < j, counted from 0; entries (i, j, c) with {x_i, x_j} = c, a
 *   formula; terms (i, j, m, c) with {x_i, x_j} = sum of c x_m, of brackets that the package has written
 */
/**
 * @typedef {{bracket: BracketDescription, hamiltonian: string,
 *   parameters?: Record<string, Exact | Exact[] | Exact[][]>, declared?: string[]}} SystemDescription
 *   parameters with their values; those without are declared, as "epsilon" or "a[3]"
 */
/**
 * @typedef {{n_components: number, instructions: readonly [string, number[], number[]][], outputs: number[],
 *   guard?: number | null}} FunctionsDescription
 *   where there is a guard, it is positive on the surface that the first function is zero on, and is the second function
 */
/**
 * @typedef {{kind: "taylor", tol?: number, order?: number | null, max_steps?: number}
 *   | {kind: "splitting", order?: number, step: number, max_steps?: number}} MethodDescription
 */
/**
 * @typedef {object} Ends How each trajectory ended, shapes (member,), endState (member, component).
 * @property {string[]} outcome
 * @property {Float64Array} endTime
 * @property {Float64Array} nSteps
 * @property {Float64Array} endState
 */
/** @typedef {Ends & {state: Float64Array, tangent: Float64Array}} Orbits state (member, time, component) */
/** @typedef {Ends & {exponent: Float64Array}} Exponents (member, time), at the times after the first */
/** @typedef {Ends & {growth: Float64Array, frame: Float64Array, nComplete: Float64Array}} Frames growth (member, interval, vector) */
/** @typedef {{count: Float64Array, time: Float64Array, state: Float64Array}} Points those of member 0 first */
/**
 * @typedef {Ends & {crossings: Points & {sign: Float64Array}, touches: Points, side: Float64Array, seenTo: Float64Array,
 *   unresolvedTime: Float64Array, undefinedTime: Float64Array, unboundedSteps: Float64Array, unseenSteps: Float64Array,
 *   inSurface: Float64Array}} Section what the fields mean, `liepoisson.section` says
 */

/** A call that the core refused. */
export class Refusal extends Error {
  /** @param {string} kind @param {string} message @param {number} place where in the text of a formula, or -1 */
  constructor(kind, message, place = -1) {
    super(message);
    this.name = "Refusal";
    this.kind = kind;
    this.place = place;
  }
}

/** A mistake in the core, or no memory: the instance has stopped. */
export class CoreStopped extends Error {
  /** @param {string} message */
  constructor(message) {
    super(message);
    this.name = "CoreStopped";
  }
}

/** The version of the interface that this file is written for. */
const INTERFACE = 6;

/** What has a place in the memory of the core, which is given back by `free`, or when nothing refers to it any more. */
class Held {
  /** @param {Core} core @param {number} handle */
  constructor(core, handle) {
    this.core = core;
    this.handle = handle;
    core.watch(this, handle);
  }

  /** Gives the memory back; the object is of no use afterwards. */
  free() {
    this.core.release(this, this.handle);
    this.handle = 0;
  }
}

/** A vector field. */
export class Field extends Held {
  /** Components of its state. */
  get nComponents() {
    return this.core.count("lp_n_components", this.handle);
  }
}

/** Functions on phase space. */
export class Functions extends Held {
  /** Whether the second is positive on the surface of section that the first is zero on. */
  hasGuard = false;

  /** Components of their state. */
  get nComponents() {
    return this.core.count("lp_n_components", this.handle);
  }

  /** How many functions. */
  get nFunctions() {
    return this.core.count("lp_n_functions", this.handle);
  }

  /**
   * Their values at states (state, component): (state, function); NaN or infinite where a function has none.
   * @param {Numbers} states
   */
  values(states) {
    const core = this.core;
    return core.with([states], ([at]) => core.take(core.call("lp_values", this.handle, at)));
  }
}

/**
 * A Hamiltonian system that is typed.  A formula that is refused throws a `Refusal` of the kind "ExpressionError", whose `place`
 * is where in the text it is wrong.
 */
export class System extends Held {
  /** Its coordinates and their rates of change as formulas. @returns {{name: string, rate: string}[]} */
  get equations() {
    const lines = this.core.text(this.core.call("lp_system_equations", this.handle)).split("\n");
    return lines.map((line) => line.split("\t")).map(([name, rate]) => ({ name, rate }));
  }

  /** Its coordinates, and as trees its Hamiltonian, equations and Poisson tensor; null where they are very long. @returns {SystemWritten} */
  get written() {
    return JSON.parse(this.core.text(this.core.call("lp_system_written", this.handle)));
  }

  /** The record of its field, for another instance. @returns {FieldDescription} */
  get fieldRecord() {
    return JSON.parse(this.core.text(this.core.call("lp_system_field_record", this.handle)));
  }

  /** The record of functions on its phase space. @param {...string} texts @returns {FunctionsDescription} */
  functionsRecord(...texts) {
    const call = (/** @type {number} */ at) => this.core.call("lp_system_functions_record", this.handle, at);
    return JSON.parse(this.core.text(this.core.written({ functions: texts }, call)));
  }

  /** Its field. */
  field() {
    return new Field(this.core, this.core.call("lp_system_field", this.handle));
  }

  /** Functions on its phase space, such as a surface of section. @param {...string} texts */
  functions(...texts) {
    const call = (/** @type {number} */ at) => this.core.call("lp_system_functions", this.handle, at);
    return new Functions(this.core, this.core.written({ functions: texts }, call));
  }
}

/** A method of integration. */
export class Method extends Held {}

/** One orbit with dense output. */
export class DenseOrbit extends Held {
  /** @param {Core} core @param {number} handle */
  constructor(core, handle) {
    super(core, handle);
    this.ends = core.ends(handle);
    /** Times at which its steps begin. */
    this.stepTimes = core.part(handle, 6);
  }

  /**
   * States (time, component), NaN beyond the end; times in order are quickest.
   * @param {Numbers} times
   */
  at(times) {
    const core = this.core;
    return core.with([times], ([at]) => core.take(core.call("lp_states_at", this.handle, at)));
  }
}

/** One instance of the core. */
export class Core {
  /**
   * Starts an instance.
   * @param {BufferSource | WebAssembly.Module} source the program `core.wasm`, or what was compiled from it
   * @returns {Promise<Core>}
   */
  static async start(source) {
    const module = source instanceof WebAssembly.Module ? source : await WebAssembly.compile(source);
    return new Core(await WebAssembly.instantiate(module, {}));
  }

  /** @param {WebAssembly.Instance} instance */
  constructor(instance) {
    /** @type {any} */
    this.exports = instance.exports;
    /** @type {CoreStopped | null} */
    this.stopped = null;
    this.registry = new FinalizationRegistry((/** @type {number} */ handle) => {
      if (!this.stopped) this.exports.lp_free(handle);
    });
    const version = this.call("lp_start");
    if (version !== INTERFACE) throw new CoreStopped(`core.wasm has interface ${version}; wanted ${INTERFACE}`);
    /** @type {string[]} */
    this.refusals = this.text(this.call("lp_refusals")).split("\n");
    /** Names of outcomes. @type {string[]} */
    this.outcomes = this.text(this.call("lp_outcomes")).split("\n");
  }

  /** @param {FieldDescription | string} description as `liepoisson.compile.field.record_of` makes it, or its JSON */
  field(description) {
    return new Field(this, this.described("lp_field", description));
  }

  /** @param {FunctionsDescription | string} description */
  functions(description) {
    const { guard = null, ...rest } = typeof description === "string" ? JSON.parse(description) : description;
    if (guard === null) return new Functions(this, this.described("lp_functions", description));
    const [first, ...others] = rest.outputs;
    const found = new Functions(this, this.described("lp_functions", { ...rest, outputs: [first, guard, ...others] }));
    found.hasGuard = true;
    return found;
  }

  /** @param {SystemDescription | string} description */
  system(description) {
    return new System(this, this.described("lp_system", description));
  }

  /** The names in a formula that are not those of functions. @param {string} formula @returns {string[]} */
  names(formula) {
    return this.text(this.described("lp_names", { formula })).split("\n").filter(Boolean);
  }

  /** @param {MethodDescription | string} description */
  method(description) {
    return new Method(this, this.described("lp_method", description));
  }

  /**
   * Rates of change at states (state, component): the arrows of the vector field.
   * @param {Field} field @param {Method} method @param {Numbers} states
   */
  rates(field, method, states) {
    return this.with([states], ([x]) => this.take(this.call("lp_rates", field.handle, method.handle, x)));
  }

  /**
   * The state nearest to first order at which each of the functions has its value, by Newton's method, and how far each is
   * from it, relative to what must cancel: at most 1e-13 at a solution.  As many of the first components move as there are
   * units, which lengths are measured in.
   * @param {Functions} functions @param {Numbers} state @param {Numbers} values @param {Numbers} units
   * @returns {{state: Float64Array, residual: Float64Array}}
   */
  project(functions, state, values, units) {
    return this.with([state, values, units], ([x, c, u]) => {
      const run = this.call("lp_project", functions.handle, x, c, u);
      return this.result(run, () => ({ state: this.part(run, 0), residual: this.part(run, 1) }));
    });
  }

  /**
   * Orbits from states (member, component) at `times`, the first of which is that of the states, perhaps with tangent vectors
   * (member, vector, component).
   * @param {Field} field @param {Method} method @param {Numbers} states @param {Numbers} times
   * @param {{tangents?: Numbers, nTangents?: number}} [options]
   * @returns {Orbits}
   */
  orbits(field, method, states, times, { tangents = [], nTangents = 0 } = {}) {
    return this.with([states, tangents, times], ([x, v, t]) => {
      const run = this.call("lp_orbits", field.handle, method.handle, x, v, nTangents, t, 0);
      return this.result(run, () => ({ ...this.ends(run), state: this.part(run, 4), tangent: this.part(run, 5) }));
    });
  }

  /**
   * One orbit with dense output, by the Taylor method.
   * @param {Field} field @param {Method} method @param {Numbers} state @param {number} from @param {number} to
   */
  orbit(field, method, state, from, to) {
    return this.with([state, [], [from, to]], ([x, v, t]) => {
      return new DenseOrbit(this, this.call("lp_orbits", field.handle, method.handle, x, v, 0, t, 1));
    });
  }

  /**
   * Finite-time exponents of one tangent vector per member (member, component).
   * @param {Field} field @param {Method} method @param {Numbers} states @param {Numbers} tangents @param {Numbers} times
   * @returns {Exponents}
   */
  exponents(field, method, states, tangents, times) {
    return this.with([states, tangents, times], ([x, v, t]) => {
      const run = this.call("lp_exponents", field.handle, method.handle, x, v, t);
      return this.result(run, () => ({ ...this.ends(run), exponent: this.part(run, 4) }));
    });
  }

  /**
   * Carries orthonormal frames (member, component, vector) over intervals.  `endState`, `endTime` and `frame` are what the next
   * call goes on with; the sum of the growth over the time is the exponent.
   * @param {Field} field @param {Method} method @param {Numbers} states @param {Numbers} frames
   * @param {{nVectors: number, elapsed: Numbers, duration: number, nIntervals: number}} course
   * @returns {Frames}
   */
  frames(field, method, states, frames, { nVectors, elapsed, duration, nIntervals }) {
    return this.with([states, frames, elapsed], ([x, q, t]) => {
      const run = this.call("lp_frames", field.handle, method.handle, x, q, nVectors, t, duration, nIntervals);
      const parts = () => ({ growth: this.part(run, 4), frame: this.part(run, 5), nComplete: this.part(run, 6) });
      return this.result(run, () => ({ ...this.ends(run), ...parts() }));
    });
  }

  /**
   * Natural units of time, NaN of an orbit that has none, and of each component, along the orbits from states (member, component).
   * @param {Field} field @param {Method} method @param {Numbers} states @param {Numbers} periods of circles, else infinite
   * @returns {{time: Float64Array, component: Float64Array}}
   */
  units(field, method, states, periods) {
    return this.with([states, periods], ([x, p]) => {
      const run = this.call("lp_units", field.handle, method.handle, x, p);
      return this.result(run, () => ({ time: this.part(run, 0), component: this.part(run, 1) }));
    });
  }

  /**
   * Regular (-1), chaotic (1) or undecided (0), by the rule of `liepoisson.decide`; indicators (member, 4): growth power, MEGNO,
   * SALI, change of averages.
   * @param {Field} field @param {Method} method @param {Numbers} states
   * @param {{tangents: Numbers, units: Numbers, periods: Numbers, naturalTimes: Numbers, end: number, isPlane: boolean}} course
   *   tangents (member, 3, component), units (member, component)
   * @returns {{outcome: string[], kind: Float64Array, exponent: Float64Array, indicators: Float64Array}}
   */
  decide(field, method, states, { tangents, units, periods, naturalTimes, end, isPlane }) {
    return this.with([states, tangents, units, periods, naturalTimes], ([x, v, u, p, t]) => {
      const run = this.call("lp_decide", field.handle, method.handle, x, v, u, p, t, end, isPlane ? 1 : 0);
      const outcomes = () => Array.from(this.part(run, 0), (code) => this.outcomes[code]);
      return this.result(run, () => ({ outcome: outcomes(), kind: this.part(run, 1), exponent: this.part(run, 2), indicators: this.part(run, 3) }));
    });
  }

  /**
   * Crossings of the surface where the first of the functions is zero and the guard, if there is one, is positive; of each the
   * values of the others are kept, or the state where there are none.  `sides` and `from`, the `side` and `endTime` of a section before, let it go on.
   * @param {Field} field @param {Method} method @param {Functions} functions @param {Numbers} states
   * @param {{from?: number, to: number, direction?: -1 | 0 | 1, nCrossings?: number, sides?: Numbers}} course
   * @returns {Section}
   */
  section(field, method, functions, states, { from = 0, to, direction = 0, nCrossings = 0, sides = [] }) {
    return this.with([states, sides, [from, to]], ([x, s, t]) => {
      const handles = [field.handle, method.handle, functions.handle];
      const run = this.call("lp_section", ...handles, Number(functions.hasGuard), direction, nCrossings, x, s, t);
      return this.result(run, () => {
        const part = (/** @type {number} */ index) => this.part(run, index);
        return {
          ...this.ends(run),
          crossings: { count: part(4), time: part(5), state: part(6), sign: part(7) },
          touches: { count: part(8), time: part(9), state: part(10) },
          side: part(11),
          seenTo: part(12),
          unresolvedTime: part(13),
          undefinedTime: part(14),
          unboundedSteps: part(15),
          unseenSteps: part(16),
          inSurface: part(17),
        };
      });
    });
  }

  // What follows is for the classes of this file.

  /** Calls an export: a handle or a number. @param {string} name @param {...number} operands @returns {number} */
  call(name, ...operands) {
    if (this.stopped) throw this.stopped;
    let answer;
    try {
      answer = this.exports[name](...operands);
    } catch (error) {
      const said = this.said();
      // memory that cannot be had stops it without a word
      const why = said.startsWith("panicked") ? said : `${error}, perhaps for want of memory`;
      this.stopped = new CoreStopped(`the core stopped: ${why}; a new instance has to be started`);
      throw this.stopped;
    }
    if (answer < 0) throw new Refusal(this.refusals[-1 - answer], this.said(), this.exports.lp_message_place());
    return answer;
  }

  /** The same for what is no handle: a number without sign. @param {string} name @param {...number} operands */
  count(name, ...operands) {
    return this.exports[name](...operands) >>> 0;
  }

  /** @param {object} thing @param {number} handle */
  watch(thing, handle) {
    this.registry.register(thing, handle, thing);
  }

  /** @param {object} thing @param {number} handle */
  release(thing, handle) {
    this.registry.unregister(thing);
    if (!this.stopped) this.exports.lp_free(handle);
  }

  /** The last message. */
  said() {
    const [at, length] = [this.count("lp_message"), this.count("lp_message_length")];
    return new TextDecoder().decode(new Uint8Array(this.exports.memory.buffer, at, length));
  }

  /** @param {string} name @param {object | string} description @returns {number} */
  described(name, description) {
    return this.written(description, (handle) => this.call(name, handle));
  }

  /** Puts a description into memory for one call. @param {object | string} description @param {(handle: number) => number} use */
  written(description, use) {
    const json = typeof description === "string" ? description : JSON.stringify(description);
    const bytes = new TextEncoder().encode(json);
    const handle = this.call("lp_bytes", bytes.length);
    try {
      new Uint8Array(this.exports.memory.buffer, this.count("lp_pointer", handle), bytes.length).set(bytes);
      return use(handle);
    } finally {
      this.forget(handle);
    }
  }

  /** Puts arrays into memory for one call. @template R @param {Numbers[]} arrays @param {(handles: number[]) => R} use @returns {R} */
  with(arrays, use) {
    /** @type {number[]} */
    const handles = [];
    try {
      for (const numbers of arrays) {
        const handle = this.call("lp_numbers", numbers.length);
        handles.push(handle);
        const at = this.count("lp_pointer", handle);
        new Float64Array(this.exports.memory.buffer, at, numbers.length).set(numbers);
      }
      return use(handles);
    } finally {
      handles.forEach((handle) => this.forget(handle));
    }
  }

  /** Reads a result and gives it back. @template R @param {number} run @param {() => R} read @returns {R} */
  result(run, read) {
    try {
      return read();
    } finally {
      this.forget(run);
    }
  }

  /** @param {number} handle */
  forget(handle) {
    if (!this.stopped) this.exports.lp_free(handle);
  }

  /** A copy of numbers, which are given back. @param {number} handle */
  take(handle) {
    const [at, length] = [this.count("lp_pointer", handle), this.count("lp_length", handle)];
    const numbers = new Float64Array(this.exports.memory.buffer, at, length).slice();
    this.forget(handle);
    return numbers;
  }

  /** A text, which is given back. @param {number} handle */
  text(handle) {
    const [at, length] = [this.count("lp_pointer", handle), this.count("lp_length", handle)];
    const text = new TextDecoder().decode(new Uint8Array(this.exports.memory.buffer, at, length));
    this.forget(handle);
    return text;
  }

  /** A copy of a part of a result. @param {number} run @param {number} index */
  part(run, index) {
    const [at, length] = [this.count("lp_part", run, index), this.count("lp_part_length", run, index)];
    return new Float64Array(this.exports.memory.buffer, at, length).slice();
  }

  /** @param {number} run @returns {Ends} */
  ends(run) {
    const outcome = Array.from(this.part(run, 0), (code) => this.outcomes[code]);
    return { outcome, endTime: this.part(run, 1), nSteps: this.part(run, 2), endState: this.part(run, 3) };
  }
}
