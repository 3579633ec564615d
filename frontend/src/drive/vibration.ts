/** ms and strength */
const VIBRATIONS = {
  armed: { duration: 150, weakMagnitude: 0.6, strongMagnitude: 0 },
  alarm: { duration: 600, weakMagnitude: 1, strongMagnitude: 1 },
} as const;
export type Vibration = keyof typeof VIBRATIONS;

/** Let a gamepad vibrate; one that cannot, or may not, stays still. */
export function vibrate(pad: Gamepad | null | undefined, how: Vibration): void {
  // Missing in Firefox, and on many gamepads, whatever the types say.
  const actuator = pad?.vibrationActuator as GamepadHapticActuator | null | undefined;
  if (typeof actuator?.playEffect !== 'function') return;
  // A browser that refuses may throw at once instead.
  void (async () => actuator.playEffect('dual-rumble', VIBRATIONS[how]))().catch(() => undefined);
}
