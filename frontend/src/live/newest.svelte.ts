/** The newest value of each name; null before its first one. */
type NewestOf<Values> = { readonly [Name in keyof Values]: { value: Values[Name] | null } };

class Newest {
  value = $state.raw<unknown>(null);
}

/** One for each name, so that who reads one runs again for that one alone. */
export function createNewest<Values>(names: readonly (keyof Values)[]): NewestOf<Values> {
  return Object.fromEntries(names.map((name) => [name, new Newest()])) as NewestOf<Values>;
}
