/** A chapter of the help, by its address below /help/. */
export interface Chapter {
  readonly location: string;
  readonly title: string;
}

/** The chapters, from the index of the help's own search; none where there is no help. */
export async function readChapters(): Promise<Chapter[]> {
  try {
    const { docs } = (await (await fetch('/help/search/search_index.json')).json()) as { docs: Chapter[] };
    return docs.map(({ location, title }) => ({ location, title }));
  } catch {
    return [];
  }
}
