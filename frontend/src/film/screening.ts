import type { Answer, FilmDescription, FilmPart } from '../api';
import { NO_ANSWER } from '../http';
import { film as texts } from '../texts/film';
import type { Span } from './spans';

/** s of one part; the first one after a seek is short, so that it comes soon */
const PART = 10;
const FIRST = 1;
/** s of the film in store ahead below which more is fetched, and behind beyond which it is given up */
const AHEAD = 15;
const BEHIND = 60;
/** s by which pictures that follow each other may seem to be apart */
const NEAR = 0.2;
/** ms until a part is asked for again that a busy server did not bring */
const AGAIN = 2000;

/** Which part is to be fetched for a film that stands at `at`, if any, of what is `stored` of its `spans`. */
export function nextPart(at: number, stored: readonly Span[], spans: readonly Span[]): { start: number; seconds: number } | null {
  let end = at;
  for (const one of stored) if (one.start - NEAR <= end && one.end > end) end = one.end;
  // Where it stands on a picture that is not in store, that one comes first, even the last of its span.
  const here = end === at ? spans.find((one) => one.start <= at && at <= one.end) : undefined;
  const span = here ?? spans.find((one) => one.end > end + NEAR);
  if (span === undefined) return null;
  const start = Math.max(end, span.start);
  if (start - at > AHEAD) return null;
  // What is in store is not written over: later pictures of it build on the first ones.
  const room = (stored.find((one) => one.start > start)?.start ?? Infinity) - start;
  return { start, seconds: Math.min(end === at ? FIRST : PART, room) };
}

/** Fetches the film of a session part by part into a video, whose time is s since the session's start. */
export class Screening {
  readonly #source = new MediaSource();
  readonly #url = URL.createObjectURL(this.#source);
  #buffer: SourceBuffer | null = null;
  #fetching = false;
  #closed = false;
  /** where the last part was asked for: one that brings nothing is not asked for again */
  #asked = NaN;

  /** @param tell gets what went wrong, in words; '' once it goes on */
  constructor(
    private readonly video: HTMLVideoElement,
    private readonly film: FilmDescription,
    private readonly fetchPart: (start: number, seconds: number) => Promise<Answer<FilmPart>>,
    private readonly tell: (problem: string) => void,
  ) {
    this.#source.addEventListener('sourceopen', this.#open, { once: true });
    video.addEventListener('seeking', this.#sought);
    video.addEventListener('timeupdate', this.#fill);
    video.addEventListener('error', this.#fail);
    video.src = this.#url;
  }

  /** Whether this browser can play it. */
  static possible({ codec }: FilmDescription): boolean {
    return typeof MediaSource !== 'undefined' && MediaSource.isTypeSupported(mime(codec));
  }

  /** Nothing more is fetched. */
  close(): void {
    this.#closed = true;
    this.#buffer = null;
    this.video.removeEventListener('seeking', this.#sought);
    this.video.removeEventListener('timeupdate', this.#fill);
    this.video.removeEventListener('error', this.#fail);
    this.video.removeAttribute('src');
    this.video.load();
    URL.revokeObjectURL(this.#url);
  }

  readonly #open = (): void => {
    if (this.#closed) return;
    this.#source.duration = this.film.spans.at(-1)?.end ?? 0;
    this.#buffer = this.#source.addSourceBuffer(mime(this.film.codec));
    this.#buffer.addEventListener('updateend', this.#fill);
    this.#sought();
  };

  readonly #sought = (): void => {
    this.#asked = NaN;
    this.#fill();
  };

  readonly #fail = (): void => this.tell(texts.unplayable);

  readonly #fill = (): void => void this.#fetch();

  async #fetch(): Promise<void> {
    const buffer = this.#buffer;
    if (buffer === null || this.#fetching || buffer.updating) return;
    const at = this.video.currentTime;
    const stored = Array.from({ length: buffer.buffered.length }, (_, place) => ({ start: buffer.buffered.start(place), end: buffer.buffered.end(place) }));
    const old = stored[0];
    if (old !== undefined && old.start < at - 2 * BEHIND) {
      buffer.remove(old.start, at - BEHIND);
      return;
    }
    const part = nextPart(at, stored, this.film.spans);
    if (part === null || part.start === this.#asked) return;
    this.#asked = part.start;
    this.#fetching = true;
    const answer = await this.fetchPart(part.start, part.seconds);
    this.#fetching = false;
    // Meanwhile it may have been closed, which removes the buffer.
    if (this.#buffer === null) return;
    this.tell('problem' in answer ? answer.problem : '');
    if ('problem' in answer) {
      // A film that stands still would not come to ask again by itself.
      if (answer.kind === NO_ANSWER) setTimeout(this.#sought, AGAIN);
      return;
    }
    buffer.timestampOffset = answer.value.start;
    buffer.appendBuffer(answer.value.data);
  }
}

const mime = (codec: string): string => `video/mp4; codecs="${codec}"`;
