/** The live socket: opens again, forever, whenever it closes or falls silent. */

import { socketProtocols } from '../pageSecret';

const PING_EVERY = 1000;
const SILENT_AFTER = 4000;
/** ms that a connection has to show that it lives, after its computer may have slept */
const WOKEN_AFTER = 1000;
const RETRY_FIRST = 250;
const RETRY_MOST = 3000;
/** close code of a server that will not serve this page (RFC 6455, 7.4.1) */
const POLICY_VIOLATION = 1008;

interface SocketEvents {
  opened(): void;
  /**
   * The connection is gone; the next attempt comes by itself. `reason` is the server's, where it gave one; `refused`
   * says that the server may have meant this page rather than the connection.
   */
  closed(reason: string, refused: boolean): void;
  text(text: string): void;
  bytes(buffer: ArrayBuffer): void;
  /** Time from a ping to its answer, ms. */
  roundTrip(milliseconds: number): void;
}

export class LiveSocket {
  #socket: WebSocket | null = null;
  #attempt = 0;
  #pings = 0;
  #pinged = new Map<number, number>();
  #heard = 0;
  #timer: ReturnType<typeof setTimeout> | undefined;
  #pulse: ReturnType<typeof setInterval> | undefined;
  #ended = false;

  constructor(
    private readonly url: string,
    private readonly events: SocketEvents,
  ) {}

  start(): void {
    this.#ended = false;
    this.#pulse = setInterval(() => this.#beat(), PING_EVERY);
    this.#open();
  }

  end(): void {
    this.#ended = true;
    clearTimeout(this.#timer);
    clearInterval(this.#pulse);
    this.#socket?.close();
  }

  /** Send a message where the socket is open. Returns whether it was. */
  send(message: object): boolean {
    if (this.#socket?.readyState !== WebSocket.OPEN) return false;
    this.#socket.send(JSON.stringify(message));
    return true;
  }

  /** An answer to a ping came. */
  answered(id: number): void {
    const sent = this.#pinged.get(id);
    if (sent === undefined) return;
    this.#pinged.delete(id);
    this.events.roundTrip(performance.now() - sent);
  }

  /** Try again at once rather than at the next turn. */
  retryNow(): void {
    if (this.#socket !== null || this.#ended) return;
    clearTimeout(this.#timer);
    this.#open();
  }

  /** The page is looked at again, perhaps after a sleep in which the connection died, and its clock stood still. */
  woke(): void {
    this.retryNow();
    this.#heard = Math.min(this.#heard, performance.now() - SILENT_AFTER + WOKEN_AFTER);
    this.#beat();
  }

  #open(): void {
    const socket = new WebSocket(this.url, socketProtocols());
    socket.binaryType = 'arraybuffer';
    this.#socket = socket;
    this.#heard = performance.now();
    let opened = false;
    socket.onopen = () => {
      opened = true;
      this.#attempt = 0;
      this.#heard = performance.now();
      this.#pinged.clear();
      this.events.opened();
    };
    socket.onmessage = (message: MessageEvent<string | ArrayBuffer>) => {
      this.#heard = performance.now();
      if (typeof message.data === 'string') this.events.text(message.data);
      else this.events.bytes(message.data);
    };
    socket.onclose = (event) => this.#lost(socket, event.reason, !opened || event.code === POLICY_VIOLATION);
  }

  #lost(socket: WebSocket, reason = '', refused = false): void {
    if (this.#socket !== socket) return;
    this.#socket = null;
    if (this.#ended) return;
    const retry = Math.min(RETRY_MOST, RETRY_FIRST * 2 ** this.#attempt);
    this.#attempt += 1;
    this.#timer = setTimeout(() => this.#open(), retry);
    this.events.closed(reason, refused);
  }

  #beat(): void {
    const socket = this.#socket;
    if (socket === null) return;
    if (performance.now() - this.#heard > SILENT_AFTER) {
      // A browser may take minutes to close a connection whose other end is gone: give it up without waiting.
      socket.onclose = null;
      socket.onmessage = null;
      socket.onopen = null;
      socket.close();
      this.#lost(socket);
      return;
    }
    this.#pings += 1;
    if (this.send({ op: 'ping', id: this.#pings })) this.#pinged.set(this.#pings, performance.now());
  }
}
