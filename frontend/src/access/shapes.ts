/** Who may do what, as the server tells it. */
import type { components } from '../generated/api';

type Schemas = components['schemas'];
export type Identity = Schemas['Known'];
export type Role = Identity['role'];
export type Me = Schemas['Me'];
export type Device = Schemas['DeviceShape'];
export type Invitation = Schemas['MadeCode'];
export type Token = Schemas['MadeToken'];
