/** ms within which going back counts as the gamepad's */
const SOON = 500;
const MARK = 'gamepad';
/** Keys into which some systems turn a gamepad's buttons. */
const BACK_KEYS = new Set(['BrowserBack', 'GoBack', 'GamepadB']);

/**
 * Keep a gamepad's button from leaving the page: some systems take one, B mostly, for *back*.
 *
 * The address has a second entry in the history, so that going back stays on the page; whoever goes back otherwise goes on back.
 */
export function holdPage(): { readonly pressed: () => void; readonly end: () => void } {
  let last = -Infinity;
  const mark = () => history.pushState(MARK, '');
  const { href } = location;
  const stay = (event: PopStateEvent) => {
    // A link to another page comes here, too.
    if (event.state === MARK || location.href !== href) return;
    if (performance.now() - last < SOON) mark();
    else history.back();
  };
  const swallow = (event: KeyboardEvent) => {
    if (BACK_KEYS.has(event.key) || BACK_KEYS.has(event.code)) event.preventDefault();
  };
  if (history.state !== MARK) mark();
  window.addEventListener('popstate', stay);
  window.addEventListener('keydown', swallow, true);
  return {
    pressed: () => {
      last = performance.now();
    },
    end: () => {
      window.removeEventListener('popstate', stay);
      window.removeEventListener('keydown', swallow, true);
    },
  };
}
