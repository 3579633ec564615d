/** The text messages of the live socket. */
import type { Cell, Part, Role, ScenarioState, Session, TuningState } from '../api';
import type { components } from '../generated/api';
import type { Alarm } from '../generated/topics';
import type { Instant } from './clock';

/** A page as the server knows it. `client` is its number at the control lease, for as long as the live socket is open. */
export interface You {
  readonly name: string;
  readonly role: Role;
  readonly client: number;
}

/** `epoch` grows whenever control goes to another client: what was meant for an earlier one is dropped. */
export type ControlMessage = { readonly op: 'control' } & Readonly<components['schemas']['ControlState']>;

export interface Hello {
  op: 'hello';
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

export type ServerMessage =
  | Hello
  | { op: 'health'; parts: Part[] }
  | { op: 'session'; recording: Session | null }
  | { op: 'comm_test'; active: CommTestActive | null; cell: (Cell & { run: number }) | null }
  | ({ op: 'scenario' } & ScenarioState)
  | ({ op: 'tuning' } & TuningState)
  | ControlMessage
  | { op: 'alarms'; alarms: Alarm[] }
  | { op: 'error'; text: string }
  | ({ op: 'pong'; id: number } & Instant);

const OPERATIONS: ReadonlySet<unknown> = new Set<ServerMessage['op']>([
  'hello',
  'health',
  'session',
  'comm_test',
  'scenario',
  'tuning',
  'control',
  'alarms',
  'error',
  'pong',
]);

/** The message in `text`; null where this page does not know its operation. */
export function readMessage(text: string): ServerMessage | null {
  const message: unknown = JSON.parse(text);
  const known = typeof message === 'object' && message !== null && 'op' in message && OPERATIONS.has(message.op);
  return known ? (message as ServerMessage) : null;
}
