/** The tones, made by the browser itself: no file is fetched. */
import type { SoundKind } from './events';

/** Hz and s of each note, one after the other */
type Note = readonly [number, number];

const TONES: Readonly<Record<SoundKind, readonly Note[]>> = {
  alarm: [[880, 0.15], [660, 0.15], [880, 0.15], [660, 0.15]],
  battery: [[440, 0.2], [370, 0.2], [311, 0.3]],
  lost: [[520, 0.15], [390, 0.3]],
  mission: [[523, 0.12], [659, 0.12], [784, 0.25]],
  armed: [[587, 0.1], [880, 0.2]],
  disarmed: [[880, 0.1], [587, 0.2]],
};
/** ms of vibration and rest, in turn */
const VIBRATIONS: Partial<Record<SoundKind, readonly number[]>> = { alarm: [200, 100, 200, 100, 400], battery: [200, 100, 200], armed: [80] };
/** s in which a note begins and ends, so that it does not click */
const EDGE = 0.01;

/** Play the tone of a kind, `gain` from 0 to 1, on an audio that runs. */
export function playTone(audio: AudioContext, kind: SoundKind, gain: number): void {
  let start = audio.currentTime;
  for (const [frequency, length] of TONES[kind]) {
    const [oscillator, envelope] = [audio.createOscillator(), audio.createGain()];
    oscillator.frequency.value = frequency;
    envelope.gain.setValueAtTime(0, start);
    envelope.gain.linearRampToValueAtTime(gain, start + EDGE);
    envelope.gain.setValueAtTime(gain, start + length - EDGE);
    envelope.gain.linearRampToValueAtTime(0, start + length);
    oscillator.connect(envelope).connect(audio.destination);
    oscillator.start(start);
    oscillator.stop(start + length);
    start += length;
  }
}

/** Vibrate, where the device can and may. */
export function vibrate(kind: SoundKind): void {
  const pattern = VIBRATIONS[kind];
  // A browser that refuses returns false; one that cannot has no such function.
  if (pattern !== undefined) (navigator as Partial<Navigator>).vibrate?.([...pattern]);
}
