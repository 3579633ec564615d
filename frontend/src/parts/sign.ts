import Check from '@lucide/svelte/icons/check';
import CircleQuestionMark from '@lucide/svelte/icons/circle-question-mark';
import Ellipsis from '@lucide/svelte/icons/ellipsis';
import Info from '@lucide/svelte/icons/info';
import Minus from '@lucide/svelte/icons/minus';
import TriangleAlert from '@lucide/svelte/icons/triangle-alert';
import X from '@lucide/svelte/icons/x';

/** Icons of verdicts. */
export const SIGNS = { good: Check, note: Info, look: TriangleAlert, wrong: X, starting: Ellipsis, none: Minus, unknown: CircleQuestionMark } as const;
export type Verdict = keyof typeof SIGNS;
