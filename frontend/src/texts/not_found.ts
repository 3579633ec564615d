/** Texts of the page for an address that names no page. */
export const notFound = {
  text: 'There is no page at this address. The link may be old or mistyped.',
  toOperate: 'Go to Operate',
} as const;
