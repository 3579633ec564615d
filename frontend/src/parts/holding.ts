/** The events of a button that is held: by a pointer, by Space or Enter, and pressed by whoever cannot hold. */

interface Held {
  begin: () => void;
  release: () => void;
  /** a press without a pointer: of a switch, a screen reader or a voice, which cannot hold */
  press: () => void;
  /** a key is let go; else as `release` */
  lift?: () => void;
}

const isPress = ({ key }: KeyboardEvent) => key === ' ' || key === 'Enter';

/** Attributes for the button. */
export function holding({ begin, release, press, lift = release }: Held) {
  return {
    onpointerdown: (event: PointerEvent) => {
      if (event.button === 0) begin();
    },
    onpointerup: release,
    onpointerleave: release,
    onpointercancel: release,
    onblur: release,
    oncontextmenu: (event: MouseEvent) => event.preventDefault(),
    onkeydown: (event: KeyboardEvent) => {
      if (!isPress(event)) return;
      event.preventDefault();
      if (!event.repeat) begin();
    },
    onkeyup: (event: KeyboardEvent) => {
      if (!isPress(event)) return;
      event.preventDefault();
      lift();
    },
    onclick: (event: MouseEvent) => {
      if (event.detail === 0) press();
    },
  };
}
