/** Calls to the server: what each carries, how long it may take, and what went wrong in words. */
import { secretHeader } from './pageSecret';
import { connection } from './texts/connection';

export type Answer<T> = { readonly value: T } | Refusal;

/** Why there is no value, in words; `kind` tells what can be done, where the words alone do not. */
export interface Refusal {
  readonly problem: string;
  readonly kind?: string;
}

const texts = connection.requests;
const TIMEOUT = 5000;
const SAFE = 'GET';
const UNAUTHORISED = 401;
const FORBIDDEN = 403;
const TOO_MANY = 429;
/** s; a longer wait than this is left to who uses the page */
const WAIT = 2;

/** what names the live socket of this page as the one that asks; null while there is none */
let clientKey: string | null = null;
let signedOut: (why: string) => void = () => undefined;
let confirmed: () => Promise<boolean> = () => Promise.resolve(false);

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

/** Fetch, and once more where the server names a short time to wait: somebody may have mistyped a code here. */
async function fetchPatiently(path: string, options: () => RequestInit): Promise<Response> {
  const response = await fetch(`/api${path}`, options());
  const wait = Number(response.headers.get('Retry-After') ?? Infinity);
  if (response.status !== TOO_MANY || !(wait <= WAIT)) return response;
  await new Promise((resolve) => setTimeout(resolve, 1000 * wait));
  return fetch(`/api${path}`, options());
}

/** Fetch, and once more where the server asks for a confirmation and gets it. */
async function fetchConfirmed(path: string, options: () => RequestInit): Promise<Response> {
  const response = await fetchPatiently(path, options);
  if (response.status !== FORBIDDEN) return response;
  const asked = readProblem(await response.clone().text()).kind === 'confirmation';
  return asked && (await confirmed()) ? fetch(`/api${path}`, options()) : response;
}

/** The fields of an error; none where something between the page and the server answered in its place. */
function readProblem(text: string): { detail?: unknown; kind?: unknown } {
  try {
    return Object(JSON.parse(text)) as object;
  } catch {
    return {};
  }
}

function headers(method: string): Record<string, string> {
  if (method === SAFE || clientKey === null) return secretHeader();
  return { ...secretHeader(), 'X-Mucat-Client': clientKey };
}

function refused(status: number, text: string): Refusal {
  const problem = describe(status, text);
  if (status === UNAUTHORISED) signedOut(problem);
  const { kind } = readProblem(text);
  return { problem, kind: typeof kind === 'string' ? kind : '' };
}

export async function send<T>(
  method: string,
  path: string,
  body: object | undefined,
  timeout: number | undefined,
  read: (response: Response) => Promise<T>,
): Promise<Answer<T>> {
  try {
    const response = await fetchConfirmed(path, () => ({
      method,
      headers: { ...headers(method), ...(body ? { 'Content-Type': 'application/json' } : {}) },
      ...(body ? { body: JSON.stringify(body) } : {}),
      signal: AbortSignal.timeout(timeout ?? TIMEOUT),
    }));
    if (!response.ok) return refused(response.status, await response.text());
    return { value: await read(response) };
  } catch {
    return { problem: texts.noAnswer };
  }
}

export function request<T>(method: string, path: string, body?: object, timeout?: number): Promise<Answer<T>> {
  return send(method, path, body, timeout, async (response) => {
    const text = await response.text();
    return (text === '' ? null : JSON.parse(text)) as T;
  });
}

/** Several answers as one: all values, or the first problem. */
export async function together<T>(requests: readonly Promise<Answer<T>>[]): Promise<Answer<T[]>> {
  const answers = await Promise.all(requests);
  const failed = answers.find((answer) => 'problem' in answer);
  return failed ?? { value: answers.flatMap((answer) => ('value' in answer ? [answer.value] : [])) };
}

export async function command(method: string, path: string, body?: object, timeout?: number): Promise<string | null> {
  const answer = await request<null>(method, path, body, timeout);
  return 'problem' in answer ? answer.problem : null;
}

/** Fetch tells nothing of how far it has sent a body. */
export function upload<T>(path: string, file: File, progress: (share: number) => void): Promise<Answer<T>> {
  return new Promise((resolve) => {
    const sending = new XMLHttpRequest();
    sending.upload.onprogress = (event) => event.lengthComputable && progress(event.loaded / event.total);
    sending.onload = () => {
      if (sending.status >= 400) resolve(refused(sending.status, sending.responseText));
      else resolve({ value: JSON.parse(sending.responseText) as T });
    };
    sending.onerror = () => resolve({ problem: texts.uploadFailed(file.name) });
    sending.open('POST', `/api${path}`);
    for (const [name, value] of Object.entries(headers('POST'))) sending.setRequestHeader(name, value);
    sending.send(file);
  });
}

export interface Downloaded {
  readonly blob: Blob;
  readonly name: string;
}

/** A file; `progress` is told of its bytes. It may take as long as it takes: a large one is copied first. */
export async function download(path: string, progress: (received: number, total: number) => void): Promise<Answer<Downloaded>> {
  try {
    const response = await fetchConfirmed(path, () => ({ headers: headers(SAFE) }));
    if (!response.ok || response.body === null) return refused(response.status, await response.text());
    const total = Number(response.headers.get('Content-Length'));
    const name = /filename="([^"]+)"/.exec(response.headers.get('Content-Disposition') ?? '')?.[1] ?? 'download';
    let received = 0;
    const counted = new TransformStream<Uint8Array, Uint8Array>({
      transform(piece, passed) {
        progress((received += piece.byteLength), total);
        passed.enqueue(piece);
      },
    });
    // The browser may keep a blob on the disk, which it does not with pieces that are gathered here.
    const blob = await new Response(response.body.pipeThrough(counted)).blob();
    return { value: { blob, name } };
  } catch {
    return { problem: texts.downloadFailed };
  }
}

function describe(status: number, text: string): string {
  const { detail } = readProblem(text);
  if (typeof detail === 'string') return detail;
  if (Array.isArray(detail)) return detail.map((one: { msg?: string }) => one.msg ?? '').join('; ');
  return texts.noReason(status);
}
