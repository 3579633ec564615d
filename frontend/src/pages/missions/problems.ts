/** The server's problems of a document, at the step and the field that they are about. */
import type { EntryProblem } from '../../api';
import { placeText, type Path } from './cards';

/** `field` is empty where the step itself is meant; `words` are a sentence. */
export interface PlacedProblem {
  readonly field: string;
  readonly words: string;
}

/** by the place of the step, as "3.1.2"; `head` is of the document without its steps */
type PlacedProblems = ReadonlyMap<string, readonly PlacedProblem[]>;

export const HEAD = 'head';

export function placeProblems(problems: readonly EntryProblem[]): PlacedProblems {
  const found = new Map<string, PlacedProblem[]>();
  for (const problem of problems) {
    const { place, field } = locate(problem.path);
    // The server's words go on from the field's name, and stand for themselves where there is none.
    const words = field === '' ? problem.words : `${field} ${problem.words}`;
    found.set(place, [...(found.get(place) ?? []), { field, words }]);
  }
  return found;
}

function locate(path: EntryProblem['path']): { place: string; field: string } {
  if (path[0] !== 'mission') return { place: HEAD, field: path.join('.') };
  const step: number[] = [];
  let at = 1;
  for (let index = path[at + 1]; path[at] === 'steps' && typeof index === 'number'; index = path[at + 1]) {
    step.push(index);
    at += 2;
  }
  return { place: placeText(step), field: path.slice(at).join('.') };
}

export const problemsAt = (problems: PlacedProblems, path: Path): readonly PlacedProblem[] => problems.get(placeText(path)) ?? [];

/** Those of one field, in words. */
export const ofField = (problems: readonly PlacedProblem[], field: string): string[] =>
  problems.filter((one) => one.field === field).map(({ words }) => words);
