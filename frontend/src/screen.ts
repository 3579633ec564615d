import { MediaQuery } from 'svelte/reactivity';

/** A phone or an upright tablet: the bar of states takes two rows, and the pages' names go to the bottom. */
export const narrow = new MediaQuery('(max-width: 899px)');

/** Too narrow for all that the bar of states could say at length. */
export const snug = new MediaQuery('(max-width: 2199px)');

/** Too narrow for the panels to stand side by side on one screen. */
export const compact = new MediaQuery('(max-width: 1099px)');

/** A phone that lies: what stands above and below leaves little between. */
export const low = new MediaQuery('(max-height: 499px)');
