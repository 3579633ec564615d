/** What can be found: by words that all stand in a name, those that begin with them first. */
export interface Finding {
  readonly kind: 'page' | 'action' | 'parameter' | 'session' | 'help';
  readonly name: string;
  readonly go: () => void;
}

const MOST = 8;

/** The findings whose names have all these words, without regard to case. */
export function matching(all: readonly Finding[], typed: string): Finding[] {
  const words = typed.toLowerCase().split(/\s+/).filter((word) => word !== '');
  const place = ({ name }: Finding) => name.toLowerCase().indexOf(words[0] ?? '');
  return all
    .filter(({ name }) => words.every((word) => name.toLowerCase().includes(word)))
    .sort((one, other) => Number(place(one) > 0) - Number(place(other) > 0))
    .slice(0, MOST);
}
