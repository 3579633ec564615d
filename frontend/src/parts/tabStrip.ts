const FADE = '32px';
const CURRENT = '[aria-current="page"], [aria-selected="true"]';

/**
 * Attachment of a strip of tabs that can be longer than the screen is wide: the current tab is scrolled into view,
 * and the strip fades at an end beyond which there is more.
 */
export function tabStrip(strip: HTMLElement): () => void {
  const fade = () => {
    const before = strip.scrollLeft > 1;
    const after = strip.scrollLeft < strip.scrollWidth - strip.clientWidth - 1;
    const [start, end] = [before, after].map((more) => (more ? 'transparent' : 'black'));
    strip.style.maskImage =
      before || after ? `linear-gradient(to right, ${start}, black ${FADE}, black calc(100% - ${FADE}), ${end})` : '';
  };
  const middle = ({ left, width }: DOMRect) => left + width / 2;
  const show = () => {
    const tab = strip.querySelector(CURRENT);
    if (tab !== null) strip.scrollLeft += middle(tab.getBoundingClientRect()) - middle(strip.getBoundingClientRect());
    fade();
  };
  // Fonts that arrive late make tabs wider.
  const resizing = new ResizeObserver(show);
  for (const one of [strip, ...strip.children]) resizing.observe(one);
  const turning = new MutationObserver(show);
  turning.observe(strip, { subtree: true, attributeFilter: ['aria-current', 'aria-selected'] });
  strip.addEventListener('scroll', fade);
  return () => {
    resizing.disconnect();
    turning.disconnect();
    strip.removeEventListener('scroll', fade);
  };
}
