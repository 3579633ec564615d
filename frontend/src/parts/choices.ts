import { hasWords } from '../searching';

/** Signals to choose from, whatever chart they are for. */
export interface Choice {
  readonly name: string;
  /** in words, without the topic */
  readonly label: string;
  readonly unit: string;
  readonly meaning: string;
  /** what else there is to say of it */
  readonly note?: string;
}

export interface ChoiceGroup {
  readonly topic: string;
  readonly meaning: string;
  readonly choices: readonly Choice[];
}

/** The choices in which every word of `search` occurs; no empty groups. */
export function searchChoices(groups: readonly ChoiceGroup[], search: string): ChoiceGroup[] {
  return groups
    .map(({ topic, meaning, choices }) => ({
      topic,
      meaning,
      choices: choices.filter((one) =>
        hasWords(`${topic} ${one.label} ${one.name} ${one.unit} ${one.meaning}`, search),
      ),
    }))
    .filter(({ choices }) => choices.length > 0);
}
