/** Texts of snapshots, as they are taken. */
export const capture = {
  label: 'Snapshots',
  take: 'Snapshot',
  hint: 'Keep the picture at full size in the session that records (P)',
  taking: 'Taking…',
  kept: (time: string) => `Snapshot kept at ${time}.`,
  show: 'Show album',
  noRecording: 'Nothing is being recorded. Start a recording, then take the snapshot.',
} as const;
