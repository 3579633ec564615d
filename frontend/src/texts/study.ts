/** Texts of a session's study. */

export const study = {
  loading: 'The signals are being read…',
  none: { title: 'Nothing to study', text: 'This session has no signals.' },
  reading: 'Computing…',
  failed: 'Charts could not be loaded from the server.',
  unknown: (names: string) => `This session has no signal ${names}. It is passed over.`,
  pair: {
    title: 'One signal against another',
    label: (y: string, x: string) => `${y} against ${x}`,
    x: 'Across (x)',
    y: 'Upward (y)',
    none: 'No samples of both signals in this range. Choose a longer one.',
  },
  spectrum: {
    title: 'Spectrum',
    label: 'Power spectral density of the chosen signals',
    signals: 'Signals',
    choose: 'Choose a signal to see its spectrum.',
    frequency: 'Frequency (Hz)',
    density: (unit: string) => `Density (${unit}² / Hz)`,
    anyUnit: 'unit',
    peak: (frequency: string, amplitude: string, unit: string, share: number) => `strongest at ${frequency} Hz, amplitude ${amplitude}${unit === '' ? '' : ` ${unit}`}, ${share} % of the variance`,
    constant: 'does not change: no peak',
  },
  axis: {
    least: (axis: string) => `${axis}, least`,
    most: (axis: string) => `${axis}, most`,
    automatic: 'auto',
    order: (axis: string) => `${axis}: the least must be below the most.`,
    positive: (axis: string) => `${axis}: this scale is logarithmic, values must be above 0.`,
    frequencyName: 'Frequency',
    densityName: 'Density',
    to: 'to',
  },
} as const;
