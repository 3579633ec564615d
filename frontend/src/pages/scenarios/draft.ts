import { Draft } from '../../parts/draft';

export const draft = new Draft('mucat-scenario');
/** one's own text, while another of the list is chosen, and what each began as */
export const ownDraft = new Draft('mucat-scenario-origin');
