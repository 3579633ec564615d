/** The film of a session. */
export const film = {
  label: 'Film of the camera',
  unplayable: 'This browser cannot play the film. Export it as MP4, and open it with a player.',
  loading: 'The film is being fetched.',
} as const;
