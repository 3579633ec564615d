import { Draft } from '../../parts/draft';

export const draft = new Draft('mucat-comm-test');
