import { Draft } from '../../parts/draft';

export const draft = new Draft('mucat-comm-test');
/** one's own text, while another of the list is chosen, and what each began as */
export const ownDraft = new Draft('mucat-comm-test-origin');
