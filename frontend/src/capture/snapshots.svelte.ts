import { createContext } from 'svelte';
import type { Access } from '../access/access.svelte';
import { api, type TakenSnapshot } from '../api';
import type { Live } from '../live/live.svelte';
import { capture as texts } from '../texts/capture';

/** Snapshots of the camera, one at a time. A button, the key P and a pad's button all call `snapshot`. */
export class Snapshots {
  busy = $state(false);
  /** the last one, for the notice of it */
  taken = $state.raw<TakenSnapshot | null>(null);
  /** why there is none, in words; '' where nothing failed */
  problem = $state('');

  constructor(
    private readonly live: Pick<Live, 'recording' | 'replayed'>,
    private readonly access: Pick<Access, 'refusal'>,
  ) {}

  /** Why no snapshot can be taken from here, in words; null where one can. */
  get refused(): string | null {
    return this.access.refusal('takeSnapshot') ?? (this.live.recording === null ? texts.noRecording : null);
  }

  /** Take one. What came of it is in `taken` and `problem`. */
  readonly snapshot = async (): Promise<void> => {
    if (this.busy || this.live.replayed) return;
    this.forget();
    const refused = this.refused;
    if (refused !== null) {
      this.problem = refused;
      return;
    }
    this.busy = true;
    const answer = await api.takeSnapshot();
    this.busy = false;
    if ('value' in answer) this.taken = answer.value;
    else this.problem = answer.problem;
  };

  readonly forget = (): void => {
    this.taken = null;
    this.problem = '';
  };
}

export const [useSnapshots, provideSnapshots] = createContext<Snapshots>();
