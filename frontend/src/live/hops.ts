import type { Part } from '../api';

/** The three hops between a person and the robot's chip. */
export const HOPS = [
  { name: 'browser-server', from: 'This page', to: 'Server' },
  { name: 'server-runtime', from: 'Server', to: 'Runtime' },
  { name: 'runtime-Arduino', from: 'Runtime', to: 'Arduino' },
] as const;

export interface Broken {
  /** place in HOPS */
  readonly hop: 0 | 1 | 2;
  readonly title: string;
  readonly what: string;
}

export interface Heard {
  readonly connection: 'connecting' | 'open' | 'lost';
  /** why the server ended the connection, where it said so */
  readonly farewell: string;
  readonly parts: readonly Part[];
  /** whether the runtime's state is current, and what it says of the serial line */
  readonly stateFresh: boolean;
  readonly state: { readonly connected: boolean; readonly connection: string } | null;
}

/** The first hop, seen from the page, that does not carry; null where all do or nothing is known yet. */
export function findBroken({ connection, farewell, parts, stateFresh, state }: Heard): Broken | null {
  if (connection === 'lost') {
    return {
      hop: 0,
      title: farewell === '' ? 'The server does not answer' : 'The server ended the connection',
      what: `${sentence(farewell)}The page tries again by itself. If this lasts: is the robot switched on, is this device in its network, does the server run?`,
    };
  }
  if (connection === 'connecting') return null;
  const runtime = parts.find((part) => part.name === 'runtime');
  if (runtime?.state === 'starting') {
    return { hop: 1, title: 'The runtime is starting', what: runtime.text };
  }
  if (runtime?.state === 'failed' || runtime?.state === 'absent' || (runtime !== undefined && !stateFresh)) {
    return {
      hop: 1,
      title: 'The runtime does not answer the server',
      what: `${sentence(runtime.state === 'ok' ? 'Nothing has come from it for a while' : runtime.text)}The server starts it again by itself; System tells more.`,
    };
  }
  if (state?.connected === false) {
    return {
      hop: 2,
      title: 'The Arduino does not answer the runtime',
      what: `${sentence(state.connection)}The runtime tries again by itself; without its commands the fins rest and the robot floats up.`,
    };
  }
  return null;
}

/** `text` as a sentence that another may follow. */
function sentence(text: string): string {
  if (text === '') return '';
  const ended = /[.!?]$/.test(text) ? text : `${text}.`;
  return `${ended.charAt(0).toUpperCase()}${ended.slice(1)} `;
}
