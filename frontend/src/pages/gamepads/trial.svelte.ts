import { SvelteMap } from 'svelte/reactivity';
import { holdPage } from '../../drive/backGuard';
import { combine, NEUTRAL } from '../../drive/axes';
import { deflection, downOf, pushesOf, UNASSIGNED, type PadProfile } from '../../drive/gamepad';
import { padKey, PadReader, type PadLook, type SeenPad } from '../../drive/padReader';
import { profileOf, storeChoice, storedChoice, storeProfile } from '../../drive/padProfiles';
import { assigned, cleared, type Task } from './assigning';

/** ms between two looks */
const LOOK = 40;
/** An axis that has stood still for so long (s), within so much, is not held by a hand. */
const STILL = 2;
const TREMBLING = 0.02;
/** from here on a stick at rest is worth a word */
const DRIFT = 0.08;

/** A browser may change its own object under the page. */
const copyOf = ({ id, index, connected, mapping, axes, buttons, timestamp }: SeenPad): SeenPad => ({
  id,
  index,
  connected,
  mapping,
  axes: [...axes],
  buttons: buttons.map(({ pressed, touched, value }) => ({ pressed, touched, value })),
  timestamp,
});

/** Gamepads on a page where they drive nothing. */
export class PadTrial {
  pads = $state.raw<readonly SeenPad[]>([]);
  /** what would drive */
  look = $state.raw<PadLook | null>(null);
  /** the key of the one that shall drive; null: the one that is moved */
  choice = $state(storedChoice());
  /** what is being assigned */
  task = $state.raw<Task | null>(null);
  /** numbers of the axes that stand still */
  still = $state.raw<readonly number[]>([]);
  readonly #edited = new SvelteMap<string, PadProfile>();
  #from: SeenPad | null = null;
  #stood: { id: string; values: number[]; since: number[] } = { id: '', values: [], since: [] };
  readonly #reader = new PadReader(
    (pad) => this.#edited.get(pad.id) ?? profileOf(pad),
    () => this.choice,
  );

  /** the one that is shown: the chosen one, the one that would drive, or one with sticks */
  readonly pad = $derived.by(() => {
    const chosen = this.pads.find((pad) => padKey(pad, this.pads) === this.choice);
    const driving = this.pads.find(({ index }) => index === this.look?.pad?.index);
    return chosen ?? driving ?? this.pads.find(({ axes }) => axes.length >= 2) ?? this.pads[0] ?? null;
  });
  readonly profile = $derived(this.pad === null ? null : (this.#edited.get(this.pad.id) ?? profileOf(this.pad) ?? UNASSIGNED));
  readonly command = $derived(this.pad === null || this.profile === null ? NEUTRAL : combine([pushesOf(this.pad, this.profile)]));
  readonly down = $derived(this.pad === null || this.profile === null ? [] : downOf(this.pad, this.profile));
  /** sticks that rest away from the middle, though within their dead zones */
  readonly drifting = $derived.by(() => {
    const { pad, profile, still } = this;
    if (pad === null || profile === null) return [];
    return profile.motions.flatMap(({ stick }) => {
      const value = stick === null ? 0 : deflection(pad, stick);
      const drifts = stick !== null && still.includes(stick.index) && Math.abs(value) > DRIFT && Math.abs(value) <= stick.dead;
      return drifts ? [{ index: stick.index, value, dead: stick.dead }] : [];
    });
  });

  /** Look at the gamepads. Returns what ends it. */
  readonly start = (): (() => void) => {
    const guard = holdPage();
    const look = () => {
      this.#look();
      if (this.pads.some(({ buttons }) => buttons.some(({ pressed }) => pressed))) guard.pressed();
    };
    const looking = setInterval(look, LOOK);
    look();
    return () => {
      clearInterval(looking);
      guard.end();
    };
  };

  readonly choose = (key: string | null): void => {
    this.choice = key;
    this.task = null;
    storeChoice(key);
  };

  /** @param profile null: the usual ones again */
  readonly change = (profile: PadProfile | null): void => {
    if (this.pad === null) return;
    storeProfile(this.pad.id, profile);
    if (profile === null) this.#edited.delete(this.pad.id);
    else this.#edited.set(this.pad.id, profile);
  };

  readonly assign = (task: Task): void => {
    this.task = task;
    this.#from = this.pad;
  };

  readonly clear = (task: Task): void => {
    this.task = null;
    if (this.profile !== null) this.change(cleared(this.profile, task));
  };

  #look(): void {
    const now = performance.now() / 1000;
    this.pads = [...navigator.getGamepads()].flatMap((pad) => (pad?.connected ? [copyOf(pad)] : []));
    this.look = this.#reader.look(this.pads, now, true);
    this.#watchStill(now);
    this.#finish();
  }

  #watchStill(now: number): void {
    const { pad } = this;
    if (pad?.id !== this.#stood.id) this.#stood = { id: pad?.id ?? '', values: [], since: [] };
    const { values, since } = this.#stood;
    pad?.axes.forEach((value, index) => {
      if (Math.abs(value - (values[index] ?? Infinity)) <= TREMBLING) return;
      values[index] = value;
      since[index] = now;
    });
    const still = since.flatMap((at, index) => (now - at >= STILL ? [index] : []));
    if (still.join() !== this.still.join()) this.still = still;
  }

  /** Take what has been moved or pressed since the task began. */
  #finish(): void {
    const { pad, profile, task } = this;
    if (pad === null || profile === null || task === null) return;
    if (this.#from?.id !== pad.id) this.#from = pad;
    const next = assigned(profile, task, this.#from, pad);
    if (next === null) return;
    this.task = null;
    this.change(next);
  }
}
