/** Calls to the server, typed by its interface: what each carries, how long it may take, and what went wrong in words. */
import createClient, { createFinalURL, createQuerySerializer, defaultPathSerializer, type ClientPathsWithMethod, type MethodResponse } from 'openapi-fetch';
import type { paths, Problem } from './generated/api';
import { secretHeader } from './pageSecret';
import { connection } from './texts/connection';

export type Answer<T> = { readonly value: T } | Refusal;

/** Why there is no value, in words; `kind` tells what can be done, where the words alone do not. */
export interface Refusal {
  readonly problem: string;
  readonly kind?: string;
}

const texts = connection.requests;
/** ms */
const TIMEOUT = 5000;
const SAFE = 'GET';
const UNAUTHORISED = 401;
const FORBIDDEN = 403;
const TOO_MANY = 429;
/** s; a longer wait than this is left to who uses the page */
const WAIT = 2;
/** ms before what changes nothing is asked for once more, each time that no answer came */
const PAUSES = [500, 2000];
/** of a refusal that is none: no answer came */
export const NO_ANSWER = 'silence';

/** what names the live socket of this page as the one that asks; null while there is none */
let clientKey: string | null = null;
let signedOut: (why: string) => void = () => undefined;
let confirmed: () => Promise<boolean> = () => Promise.resolve(false);
/** why the robot cannot be commanded from this page now; STOP always can */
let barred: string | null = null;

/** Send this key of the page with every call that changes something; null sends none. */
export function nameClient(key: string | null): void {
  clientKey = key;
}

/** Have this called wherever the server says that nobody is signed in here. */
export function onSignedOut(call: (why: string) => void): void {
  signedOut = call;
}

/** Have this called where the server asks for a confirmation; it answers whether there is one now. */
export function onUnconfirmed(call: () => Promise<boolean>): void {
  confirmed = call;
}

/** Refuse every command to the robot but STOP, with this reason, until told otherwise by null. */
export function refuseCommands(reason: string | null): void {
  barred = reason;
}

/** The server as everybody may ask it. */
export const server = createClient<paths>({ fetch: within(TIMEOUT) });
/** The same for what the robot obeys, which may be refused from this page. */
export const robot = createClient<paths>({ fetch: unlessBarred(TIMEOUT) });

type Send = (request: Request) => Promise<Response>;

/**
 * Return what sends a request, each attempt for at most so many ms; null sets no limit. It is sent once more where the
 * server names a short time to wait, since somebody may have mistyped a code here, and where it gets the confirmation
 * that it asks for. What changes nothing is sent anew where a busy or restarting server gives no answer.
 */
export function within(timeout: number | null): Send {
  return async (request) => {
    let response = await insist(request, timeout);
    const wait = Number(response.headers.get('Retry-After') ?? Infinity);
    if (response.status === TOO_MANY && wait <= WAIT) {
      await pause(1000 * wait);
      response = await attempt(request, timeout);
    }
    const again = response.status === FORBIDDEN && (await asksConfirmation(response)) && (await confirmed());
    return again ? attempt(request, timeout) : response;
  };
}

/** As `within`, and nothing is sent while commands are refused. */
export function unlessBarred(timeout: number): Send {
  return (request) => (barred === null ? within(timeout)(request) : Promise.resolve(Response.json({ detail: barred }, { status: FORBIDDEN })));
}

const pause = (time: number) => new Promise((resolve) => setTimeout(resolve, time));

async function insist(request: Request, timeout: number | null): Promise<Response> {
  for (const time of request.method === SAFE ? PAUSES : []) {
    try {
      return await attempt(request, timeout);
    } catch (error) {
      // What takes long would burden a busy server twice.
      if (timeout !== null && timeout > TIMEOUT && (error as Error).name === 'TimeoutError') throw error;
      await pause(time);
    }
  }
  return attempt(request, timeout);
}

/** Send a request as this page, which may have been signed in anew since the last attempt. */
function attempt(request: Request, timeout: number | null): Promise<Response> {
  const sent = new Request(request.clone(), timeout === null ? {} : { signal: AbortSignal.timeout(timeout) });
  for (const [name, value] of Object.entries(credentials(request.method))) sent.headers.set(name, value);
  return fetch(sent);
}

function credentials(method: string): Record<string, string> {
  return { ...secretHeader(), ...(method === SAFE || clientKey === null ? {} : { 'X-Mucat-Client': clientKey }) };
}

async function asksConfirmation(response: Response): Promise<boolean> {
  const problem: unknown = await response.clone().json().catch(() => null);
  return read(problem).kind === 'confirmation';
}

/** The fields of an error; none where something between the page and the server answered in its place. */
function read(error: unknown): Partial<Record<keyof Problem, unknown>> {
  return Object(error) as object;
}

function refused(status: number, error: unknown): Refusal {
  const { detail, kind } = read(error);
  const problem = typeof detail === 'string' ? detail : texts.noReason(status);
  if (status === UNAUTHORISED) signedOut(problem);
  return { problem, kind: typeof kind === 'string' ? kind : '' };
}

type Call<T> = Promise<{ readonly data?: T; readonly error?: unknown; readonly response: Response }>;

/** What a call brings, or why it brings nothing. */
export function ask<T>(call: Call<T>): Promise<Answer<T>> {
  return askFor(call, (data) => data);
}

/** What is read from the answer to a call; `failure` are the words where none comes. */
export async function askFor<T, Value>(
  call: Call<T>,
  take: (data: T, response: Response) => Value | Promise<Value>,
  failure: string = texts.noAnswer,
): Promise<Answer<Value>> {
  try {
    const { data, error, response } = await call;
    return response.ok ? { value: await take(data as T, response) } : refused(response.status, error);
  } catch {
    return { problem: failure, kind: NO_ANSWER };
  }
}

/** What came as bytes: the client says undefined where a body is empty. */
export function bytes(body: ArrayBuffer | undefined): ArrayBuffer {
  return body ?? new ArrayBuffer(0);
}

/** Have something done. Answers why it was not, in words; null where it was. */
export async function command(call: Call<unknown>): Promise<string | null> {
  const answer = await ask(call);
  return 'problem' in answer ? answer.problem : null;
}

/** Several answers as one: all values, or the first problem. */
export async function together<T>(requests: readonly Promise<Answer<T>>[]): Promise<Answer<T[]>> {
  const answers = await Promise.all(requests);
  const failed = answers.find((answer) => 'problem' in answer);
  return failed ?? { value: answers.flatMap((answer) => ('value' in answer ? [answer.value] : [])) };
}

type Readable = ClientPathsWithMethod<typeof server, 'get'>;
interface Parameters {
  readonly path?: Record<string, unknown>;
  readonly query?: Record<string, unknown>;
}
type ParametersOf<Path extends Readable> = paths[Path] extends { get: { parameters: infer Given extends Parameters } } ? Given : never;

/** The address of something that the browser fetches by itself. */
export function address<Path extends Readable>(path: Path, params: ParametersOf<Path>): string {
  return createFinalURL(path, { baseUrl: '', params, querySerializer: createQuerySerializer(), pathSerializer: defaultPathSerializer });
}

type Writable = ClientPathsWithMethod<typeof server, 'post'>;

/** Send a file. Fetch tells nothing of how far it has sent a body. */
export function upload<Path extends Writable>(path: Path, file: File, progress: (share: number) => void): Promise<Answer<MethodResponse<typeof server, 'post', Path>>> {
  return new Promise((resolve) => {
    const sending = new XMLHttpRequest();
    sending.responseType = 'json';
    sending.upload.onprogress = (event) => event.lengthComputable && progress(event.loaded / event.total);
    sending.onload = () => {
      if (sending.status >= 400) resolve(refused(sending.status, sending.response));
      else resolve({ value: sending.response as MethodResponse<typeof server, 'post', Path> });
    };
    sending.onerror = () => resolve({ problem: texts.uploadFailed(file.name) });
    sending.open('POST', path);
    for (const [name, value] of Object.entries(credentials('POST'))) sending.setRequestHeader(name, value);
    sending.send(file);
  });
}

export interface Downloaded {
  readonly blob: Blob;
  readonly name: string;
}

type Stream = Response['body'];
type Progress = (received: number, total: number) => void;

/** A file; `progress` is told of its bytes. */
export function download(call: Call<Stream>, progress: Progress = () => undefined): Promise<Answer<Downloaded>> {
  return askFor(call, (body, { headers }) => gather(body, headers, progress), texts.downloadFailed);
}

async function gather(body: Stream, headers: Headers, progress: Progress): Promise<Downloaded> {
  const total = Number(headers.get('Content-Length'));
  let received = 0;
  const counted = new TransformStream<Uint8Array, Uint8Array>({
    transform(piece, passed) {
      progress((received += piece.byteLength), total);
      passed.enqueue(piece);
    },
  });
  // The browser may keep a blob on the disk, which it does not with pieces that are gathered here.
  const blob = await new Response(body?.pipeThrough(counted)).blob();
  return { blob, name: /filename="([^"]+)"/.exec(headers.get('Content-Disposition') ?? '')?.[1] ?? 'download' };
}
