/** Chromium alone has it, and in secure contexts alone. */
interface Keyboard {
  getLayoutMap(): Promise<ReadonlyMap<string, string>>;
}

/** Letters on the keys of this keyboard by their codes; none where the browser does not tell. */
export async function readLetters(): Promise<ReadonlyMap<string, string>> {
  const { keyboard } = navigator as Navigator & { keyboard?: Keyboard };
  try {
    return new Map(await keyboard?.getLayoutMap());
  } catch {
    return new Map();
  }
}

/** What stands on a key: its own letter where it is known, else that of a US keyboard. */
export const capOf = (letters: ReadonlyMap<string, string>, code: string, us: string): string => letters.get(code)?.toUpperCase() ?? us;
