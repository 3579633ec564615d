/** Times that are still to come, as people say them. */
export const remaining = {
  title: 'Remaining',
  unknown: 'not known yet',
  moment: 'a moment',
  seconds: (seconds: number) => `about ${seconds} s`,
  minutes: (minutes: number) => `about ${minutes} min`,
  hours: (hours: number, minutes: number) => `about ${hours} h${minutes === 0 ? '' : ` ${minutes} min`}`,
  days: (days: string) => `about ${days} days`,
} as const;
