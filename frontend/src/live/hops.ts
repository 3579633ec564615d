import type { PartHealth } from '../api';
import { connection as connectionTexts } from '../texts/connection';

const texts = connectionTexts.hops;

/** The three hops between a person and the robot's chip. */
export const HOPS = [
  { name: 'browser-server', from: texts.page, to: texts.server },
  { name: 'server-runtime', from: texts.server, to: texts.runtime },
  { name: 'runtime-board', from: texts.runtime, to: texts.board },
] as const;

export interface Broken {
  /** place in HOPS */
  readonly hop: 0 | 1 | 2;
  readonly title: string;
  readonly what: string;
  /** whether nothing is wrong: the board is at other work */
  readonly reserved?: boolean;
}

export interface Heard {
  readonly connection: 'connecting' | 'open' | 'lost';
  /** why the server ended the connection, where it said so */
  readonly farewell: string;
  /** whether the server answers by HTTPS, and the live connection never opened */
  readonly untrusted: boolean;
  readonly parts: readonly PartHealth[];
  /** whether the runtime's state has not come to this page for a while */
  readonly silent: boolean;
  /** what it says of the serial link */
  readonly state: { readonly connected: boolean; readonly connection: string } | null;
}

/** The first hop, seen from the page, that does not carry; null where all do or nothing is known yet. */
export function findBroken({ connection, farewell, untrusted, parts, silent, state }: Heard): Broken | null {
  if (connection === 'lost' && untrusted) {
    return { hop: 0, title: texts.untrusted, what: texts.trustIt };
  }
  if (connection === 'lost') {
    return {
      hop: 0,
      title: farewell === '' ? texts.serverSilent : texts.serverEnded,
      what: `${sentence(farewell)}${texts.pageReconnects}`,
    };
  }
  if (connection === 'connecting') return null;
  const runtime = parts.find((part) => part.name === 'runtime');
  if (runtime?.state === 'starting') {
    return { hop: 1, title: texts.runtimeStarting, what: runtime.text };
  }
  // The server ends the runtime while another program uses the board, and says which.
  if (runtime?.state === 'absent') {
    return { hop: 1, title: texts.boardReserved, what: runtime.text, reserved: true };
  }
  if (runtime?.state === 'failed' || (runtime !== undefined && silent)) {
    return {
      hop: 1,
      title: texts.runtimeSilent,
      what: `${sentence(runtime.state === 'ok' ? texts.noData : runtime.text)}${texts.serverRestarts}`,
    };
  }
  if (state?.connected === false) {
    return {
      hop: 2,
      title: texts.boardSilent,
      what: `${sentence(state.connection)}${texts.runtimeReconnects}`,
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
