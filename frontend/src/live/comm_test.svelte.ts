import type { Cell } from '../api';
import { mergeCells } from './cells';
import type { CommTestActive } from './messages';

/** The communication test that runs, started on this page or on another, as the live socket tells of it. */
export class CommTestWatch {
  /** null while none runs, and until the server has said whether one does */
  active = $state.raw<CommTestActive | null>(null);
  /** ms of this page's own clock at which `active` came */
  heard = $state(0);
  /** cells that came since this page was opened, of the run `run` */
  cells = $state.raw<readonly Cell[]>([]);
  run = $state<number | null>(null);

  /** A new connection begins; where a test runs, the server says so at once. */
  reconnect(): void {
    this.active = null;
    this.run = null;
    this.cells = [];
  }

  take(active: CommTestActive | null, cell: (Cell & { run: number }) | null): void {
    this.active = active;
    this.heard = performance.now();
    const run = active?.run ?? cell?.run ?? null;
    if (run !== null && run !== this.run) {
      this.run = run;
      this.cells = [];
    }
    if (cell !== null && cell.run === this.run) this.cells = mergeCells(this.cells, [cell]);
  }
}
