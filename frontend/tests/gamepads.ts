import type { SeenPad } from '../src/drive/padReader';

const STANDARD_ID = 'Pad A (STANDARD GAMEPAD Vendor: 0001 Product: 0001)';

/** A gamepad at one moment; its time stamp is that of the look unless `more` says another. */
export function pad(axes: number[], down: number[] = [], more: Partial<SeenPad> = {}): SeenPad {
  const buttons = Array.from({ length: 17 }, (_, index) => ({ pressed: down.includes(index), touched: false, value: down.includes(index) ? 1 : 0 }));
  return { id: STANDARD_ID, index: 0, connected: true, mapping: 'standard', timestamp: 0, axes, buttons, ...more };
}
