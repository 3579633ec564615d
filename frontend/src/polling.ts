/**
 * Look again and again, `pause` ms after each answer, while the page is visible. Answers how to end it.
 *
 * A changed `pause` restarts an effect that reads it, and so looks at once.
 */
export function poll(look: () => Promise<unknown>, pause: number): () => void {
  let ended = false;
  let timer: ReturnType<typeof setTimeout> | undefined;
  const again = async () => {
    if (!document.hidden) await look();
    if (!ended) timer = setTimeout(() => void again(), pause);
  };
  void again();
  return () => {
    ended = true;
    clearTimeout(timer);
  };
}
