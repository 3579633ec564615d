import type { Role } from '../access/shapes';

/** Who a page is to the robot. A seat is what can have the control; it lasts as long as the live socket. */
export interface You {
  readonly name: string;
  readonly role: Role;
  readonly seat: number;
}

/** `until` in s, the robot's steady clock. */
export interface ControlMessage {
  readonly op: 'control';
  /** grows whenever control goes to another seat; what was meant for an earlier one is dropped */
  readonly epoch: number;
  readonly holder: { readonly seat: number; readonly name: string } | null;
  readonly request: { readonly seat: number; readonly name: string; readonly until: number } | null;
  readonly refused: { readonly seat: number; readonly until: number } | null;
}
