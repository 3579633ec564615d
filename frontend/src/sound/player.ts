/** Plays sounds as far as the browser lets it. What it refuses is said in words, and nothing else fails. */
import { sound as texts } from '../texts/sound';
import { KINDS, type SoundEvent } from './events';
import type { Volume } from './sound.svelte';
import { playTone, vibrate } from './tones';

const GAINS: Readonly<Record<Volume, number>> = { off: 0, low: 0.06, full: 0.3 };

export class SoundPlayer {
  #audio: AudioContext | null = null;

  /** Let the browser play from now on; it does so after a press on the page. */
  async wake(): Promise<void> {
    try {
      this.#audio ??= new AudioContext();
      if (this.#audio.state !== 'running') await this.#audio.resume();
    } catch {
      // `problem` says so.
    }
  }

  /** Why nothing is heard now, in words; '' where something is. */
  problem(spoken: boolean): string {
    if (!('AudioContext' in globalThis)) return texts.noAudio;
    if (this.#audio?.state !== 'running') return texts.silenced;
    return spoken && !('speechSynthesis' in globalThis) ? texts.noSpeech : '';
  }

  /** Play one tone for all that came at once, and speak of each. */
  play(events: readonly SoundEvent[], volume: Volume, spoken: boolean): void {
    const [first] = events;
    if (first === undefined || volume === 'off') return;
    this.#attempt(() => {
      if (this.#audio?.state === 'running') playTone(this.#audio, first.kind, GAINS[volume]);
    });
    this.#attempt(() => {
      vibrate(first.kind);
    });
    if (!spoken) return;
    this.#attempt(() => {
      for (const { kind, words } of events) this.#speak(words, volume, kind === KINDS[0]);
    });
  }

  close(): void {
    void this.#audio?.close().catch(() => undefined);
    this.#audio = null;
  }

  /** What the browser refuses holds up neither the page nor the other sounds. */
  #attempt(sound: () => void): void {
    try {
      sound();
    } catch {
      // It stays silent.
    }
  }

  #speak(words: string, volume: Volume, urgent: boolean): void {
    if (!('speechSynthesis' in globalThis)) return;
    if (urgent) speechSynthesis.cancel();
    else if (speechSynthesis.pending) return;
    const utterance = new SpeechSynthesisUtterance(words.slice(0, 200));
    utterance.lang = 'en';
    utterance.volume = volume === 'full' ? 1 : 0.4;
    speechSynthesis.speak(utterance);
  }
}
