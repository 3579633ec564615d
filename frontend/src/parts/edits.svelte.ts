type Values<Value> = Readonly<Record<string, Value>>;

/** s; the robot tells of what it has taken well before */
const TELLING = 1;

/** Values of the robot as somebody changes them: what is in force, what is written over it, and what is to be applied. */
export class Edits<Value extends string | number | boolean> {
  /** what was written here and not applied yet */
  edited = $state.raw<Values<Value>>({});
  #applied = $state.raw<{ readonly values: Values<Value>; readonly before: Values<Value>; readonly time: number } | null>(null);
  readonly #told: () => Values<Value>;
  readonly #time: () => number;

  /** What the robot has taken and not told of yet counts: no field goes back to the old value meanwhile. */
  readonly inForce: Values<Value> = $derived.by(() => {
    const told = this.#told();
    const applied = this.#applied;
    if (applied === null || this.#time() - applied.time > TELLING) return told;
    return Object.fromEntries(Object.entries(told).map(([name, value]) => [name, Object.is(value, applied.before[name]) ? (applied.values[name] ?? value) : value]));
  });
  readonly wanted: Values<Value> = $derived({ ...this.inForce, ...this.edited });

  /** `told`: the values that the robot has told of; `time`: that of its newest state, s. */
  constructor(told: () => Values<Value>, time: () => number) {
    this.#told = told;
    this.#time = time;
  }

  readonly changed = (name: string) => this.wanted[name] !== this.inForce[name];

  write(name: string, value: Value) {
    this.edited = { ...this.edited, [name]: value };
  }

  forget(name: string) {
    this.edited = Object.fromEntries(Object.entries(this.edited).filter(([other]) => other !== name));
  }

  reset() {
    this.edited = {};
  }

  /** The robot has taken `sent`; what was written since is not applied with it, however late its answer came. */
  taken(sent: Values<Value>) {
    this.#applied = { values: sent, before: this.#told(), time: this.#time() };
    this.edited = Object.fromEntries(Object.entries(this.edited).filter(([name, value]) => !(name in sent) || !Object.is(sent[name], value)));
  }
}
