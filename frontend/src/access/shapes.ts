/** Who may do what, as the server tells it. */

export type Role = 'viewer' | 'operator';

export interface Identity {
  /** the number of the browser or program that was paired; 0 is the robot's own shell */
  readonly device: number;
  readonly name: string;
  readonly role: Role;
  readonly kind: 'browser' | 'program' | 'shell';
}

export interface Me {
  readonly signed_in: boolean;
  readonly robot: string;
  readonly identity: Identity | null;
  /** whether a code waits to be used */
  readonly pairing_open: boolean;
}

export interface Device {
  readonly id: number;
  readonly name: string;
  readonly role: Role;
  readonly kind: Identity['kind'];
  /** s since 1970 */
  readonly paired: number;
  readonly seen: number;
  /** whether it is the one that asks */
  readonly you: boolean;
}

export interface Invitation {
  readonly code: string;
  readonly link: string;
  readonly role: Role;
  /** s since 1970 */
  readonly expires: number;
  readonly qr_svg: string;
}

export interface Token {
  readonly token: string;
  readonly device: Device;
}
