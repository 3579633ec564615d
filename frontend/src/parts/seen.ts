/** px before an element comes into view at which it counts as seen */
const MARGIN = '300px';

/** Calls `call` whenever the element comes into view, or nearly so. */
export function whenSeen(call: () => void) {
  return (element: Element) => {
    const observer = new IntersectionObserver((entries) => {
      if (entries.some((entry) => entry.isIntersecting)) call();
    }, { rootMargin: MARGIN });
    observer.observe(element);
    return () => observer.disconnect();
  };
}
