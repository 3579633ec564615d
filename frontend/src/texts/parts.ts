/** Words that several pages share. */
export const parts = {
  loading: 'Loading…',
  checking: 'Checking…',
  starting: 'Starting…',
  saving: 'Saving…',
  cancel: 'Cancel',
  copy: 'Copy',
  save: 'Save',
  replay: 'Replay',
  tryAgain: 'Try again',
} as const;
