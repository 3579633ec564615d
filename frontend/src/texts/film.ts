/** The film of a session. */
export const film = {
  label: 'Film of the camera',
  unplayable: 'This browser cannot play the film. Export it as MP4, and open it with a player.',
  loading: 'The film is being fetched.',
  choice: {
    title: 'Film',
    off: 'Off',
    low: 'Low',
    medium: 'Medium',
    high: 'High',
    rate: 'Pictures a second',
    takes: (minute: string, room: string) => `About ${minute} MB a minute; the disk has room for ${room}.`,
    measured: 'Measured in earlier films of this robot.',
    arming: 'Also for sessions that begin when you arm.',
    without: 'A small picture every 2 s.',
    asJpeg: 'The package av is missing, so pictures are stored as JPEG: some five times as large.',
    minutes: (count: number) => `${count} min`,
    hours: (count: number) => `${count} h`,
    days: (count: number) => `${count} days`,
  },
} as const;
