import type { Role } from '../access/shapes';
import type { components } from '../generated/api';

/** Who a page is to the robot. A seat is what can have the control; it lasts as long as the live socket. */
export interface You {
  readonly name: string;
  readonly role: Role;
  readonly seat: number;
}

/** `epoch` grows whenever control goes to another seat: what was meant for an earlier one is dropped. */
export type ControlMessage = { readonly op: 'control' } & Readonly<components['schemas']['ControlState']>;
