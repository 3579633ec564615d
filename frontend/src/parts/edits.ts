/** The entries that were written after `sent` was: they are not applied with it, however late its answer comes. */
export function writtenSince<Value>(edited: Readonly<Record<string, Value>>, sent: Readonly<Record<string, Value>>): Record<string, Value> {
  return Object.fromEntries(Object.entries(edited).filter(([name, value]) => !(name in sent) || !Object.is(sent[name], value)));
}
