/** The text messages of the live socket. */
import type { Cell, ControlState, PartHealth, Role, ScenarioState, Session, SweepSummary, TuningState } from '../api';
import type { Alarm } from '../generated/topics';
import type { Instant } from './clock';

/** A page as the server knows it. `client` is its number at the control lease, for as long as the live socket is open. */
export interface You {
  readonly name: string;
  readonly role: Role;
  readonly client: number;
}

export interface Hello {
  definitions: string;
  robot: string;
  /** s, the robot's steady clock */
  steady: number;
  /** the same instant, s since 1970 */
  utc: number;
  page_version: string;
  /** the features of the server that are on */
  features: readonly string[];
  you: You;
  /** shows that a command comes from this page */
  client_key: string;
}

/** The communication test that runs. */
export interface CommTestActive {
  run: number;
  name: string;
  place: 'emulated' | 'robot';
  /** which of the document's tests this is, from 0 on, and how many there are */
  test: number;
  tests: number;
  cells: number;
  done: number;
  /** s */
  elapsed: number;
  /** s; null while unknown */
  remaining: number | null;
  /** by number of cell, of those under way */
  phase: Readonly<Record<string, 'compile' | 'upload' | 'run'>>;
}

/** What the server sends, by the operation `op` of the message. */
export interface Messages {
  readonly hello: Hello;
  readonly health: { readonly parts: PartHealth[] };
  readonly session: { readonly recording: Session | null };
  readonly summary: { readonly session: number };
  readonly comm_test: { readonly active: CommTestActive | null; readonly cell: (Cell & { readonly run: number }) | null };
  readonly scenario: ScenarioState;
  readonly sweeps: { readonly sweeps: readonly SweepSummary[] };
  readonly tuning: TuningState;
  readonly control: ControlState;
  readonly alarms: { readonly alarms: Alarm[] };
  readonly error: { readonly text: string };
  readonly pong: Instant & { readonly id: number };
}

export type Listeners = { readonly [Operation in keyof Messages]: (message: Messages[Operation]) => void };

/** Give the message in `text` to the listener of its operation. One that this page does not know is ignored. */
export function deliver(text: string, listeners: Listeners): void {
  const message = Object(JSON.parse(text)) as { readonly op?: keyof Messages };
  if (message.op !== undefined && Object.hasOwn(listeners, message.op)) (listeners[message.op] as (message: unknown) => void)(message);
}
