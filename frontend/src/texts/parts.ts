/** Words that several pages share. */
export const parts = {
  loading: 'Loading…',
  checking: 'Checking…',
  starting: 'Starting…',
  saving: 'Saving…',
  cancel: 'Cancel',
  replay: 'Replay',
} as const;
