import { api, type VisionSettings } from '../../../api';
import type { Live } from '../../../live/live.svelte';

const UNDO_MAX = 50;
/** ms; changes of the same setting that follow each other faster are undone as one */
const TOGETHER = 1000;

/** The vision node's settings as this page shows and changes them. A change holds at once, and can be undone. */
export class VisionTuning {
  problem = $state('');
  /** whether somebody else has changed them meanwhile, so that this page's were not taken */
  changed = $state(false);
  /** of robot.toml; null until known */
  configured = $state.raw<VisionSettings | null>(null);
  #loaded = $state.raw<VisionSettings | null>(null);
  #draft = $state.raw<VisionSettings | null>(null);
  #before = $state.raw<readonly VisionSettings[]>([]);
  #sending = false;
  /** what the robot has to have for a change of this page to be taken */
  #base: VisionSettings | null = null;
  /** what this page has set last */
  #mine: VisionSettings | null = null;
  #refused: VisionSettings | null = null;
  #changed = { what: '', at: -Infinity };

  constructor(private readonly live: Live) {}

  /** null until known */
  get settings(): VisionSettings | null {
    return this.#draft ?? this.live.documents.vision.value?.settings ?? this.#loaded;
  }

  get undoable(): boolean {
    return this.#before.length > 0;
  }

  /** whether they are those of robot.toml */
  get asConfigured(): boolean {
    return same(this.settings, this.configured);
  }

  async load(): Promise<void> {
    const answer = await api.visionSettings();
    if ('problem' in answer) {
      this.problem = answer.problem;
      return;
    }
    this.problem = '';
    this.changed = false;
    this.#loaded = answer.value.settings;
    this.configured = answer.value.configured;
  }

  /** Change some; `what` names them, so that a slider's many steps are one to undo. */
  change(what: string, changes: Partial<VisionSettings>): void {
    const { settings } = this;
    if (settings === null) return;
    const now = performance.now();
    const goesOn = what === this.#changed.what && now - this.#changed.at < TOGETHER;
    if (!goesOn || !this.undoable) this.#before = [...this.#before, settings].slice(-UNDO_MAX);
    this.#changed = { what, at: now };
    this.#take({ ...settings, ...changes }, settings);
  }

  undo(): void {
    const last = this.#before.at(-1);
    if (last === undefined) return;
    this.#before = this.#before.slice(0, -1);
    this.#changed = { what: '', at: -Infinity };
    // Not what is in force: somebody else may have changed something since, which undoing would undo, too.
    this.#take(last, this.#mine);
  }

  /** Something came from the robot: it holds from now on, unless this page is about to change it. */
  hear(): void {
    if (!this.#sending) this.#draft = null;
  }

  /** Set over those of somebody else what was refused. */
  saveMine(): void {
    if (this.#refused !== null) this.#take(this.#refused, null);
  }

  /** Show those of somebody else; what this page has set before them cannot be undone any more. */
  async openTheirs(): Promise<void> {
    this.#before = [];
    await this.load();
  }

  #take(settings: VisionSettings, base: VisionSettings | null): void {
    this.#draft = settings;
    if (this.#sending) return;
    this.#base = base;
    void this.#send();
  }

  /** Send the newest, and once more where it was changed meanwhile. */
  async #send(): Promise<void> {
    this.#sending = true;
    let sent: VisionSettings | null;
    do {
      sent = this.#draft;
      const answer = sent === null ? { value: null } : await api.editVision(sent, this.#base);
      this.problem = 'problem' in answer ? answer.problem : '';
      this.changed = 'problem' in answer && answer.kind === 'changed';
      if (this.problem === '') this.#base = this.#mine = sent;
    } while (sent !== this.#draft && this.problem === '');
    this.#refused = this.changed ? this.#draft : null;
    this.#sending = false;
    if (this.problem === '') this.#loaded = sent;
    if (this.problem !== '' || same(this.live.documents.vision.value?.settings ?? null, sent)) this.#draft = null;
  }
}

function same(one: VisionSettings | null, other: VisionSettings | null): boolean {
  // Orders count, too: of actions, for one.
  return one !== null && other !== null && JSON.stringify(one, sorted) === JSON.stringify(other, sorted);
}

/** The fields of the settings themselves come in any order. */
function sorted(key: string, value: unknown): unknown {
  if (key !== '' || typeof value !== 'object' || value === null) return value;
  return Object.fromEntries(Object.entries(value).sort(([a], [b]) => a.localeCompare(b)));
}
