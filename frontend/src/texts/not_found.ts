/** Texts of the page for an address that names no page. */
export const notFound = {
  text: 'There is no page at this address. The link may be old or mistyped.',
  to: (page: string) => `Go to ${page}`,
} as const;
