import { Draft } from '../../../parts/draft';

export const sweepDraft = new Draft('mucat-sweep');
