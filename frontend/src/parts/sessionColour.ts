import { token, type Theme } from '../theme.svelte';

const SERIES = ['measured', 'wanted', 'third', '4', '5', '6', '7'];

/** The colour of the session at this place, in the theme that the page has now. */
export function sessionColour(place: number, theme: Theme['current']): string {
  void theme;
  return token(`series-${SERIES[place % SERIES.length] ?? ''}`);
}
