/** Addresses within the page. */

export const LIBRARY = '#/missions';
/** of what is being written, whatever it is called */
export const DRAFT = `${LIBRARY}/draft`;
export const missionLink = (name: string): string => `${LIBRARY}/edit/${name}`;
