/** A chapter of the help, by its address below /help/. */
export interface Chapter {
  readonly location: string;
  readonly title: string;
}

/** The chapters with their pages' titles, as several have one name, from the index of the help's own search; none where there is no help. */
export async function readChapters(): Promise<Chapter[]> {
  try {
    const { docs } = (await (await fetch('/help/search/search_index.json')).json()) as { docs: Chapter[] };
    const pages = new Map(docs.map(({ location, title }) => [location, title]));
    return docs.map(({ location, title }) => {
      const page = pages.get(location.replace(/#.*/, '')) ?? title;
      return { location, title: page === title ? title : `${title} · ${page}` };
    });
  } catch {
    return [];
  }
}
