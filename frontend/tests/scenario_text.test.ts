import { readFileSync } from 'node:fs';
import { describe, expect, it } from 'vitest';
import { addEvent, fieldSource, Raw, readEvents, removeEvent, setField } from '../src/pages/scenarios/eventText';
import { jsonPlaces, namedPlace, tomlPlaces } from '../src/parts/code/places';
import { resultWords } from '../src/pages/scenarios/result';

const SHIPPED = new URL('../../robot_runtime/experiments/scenario/shipped/', import.meta.url);
const TEXT = `# the head
name = "x" # a name
duration = 60

[scene]
kind = "pool"

# first it is armed
[[events]]
at = 1 # early
do = "arm"

# then a card
[[events]]
at = 15
do = "card"
colour = "yellow" # of cardboard

[[events]]
at = 30
do = "controller"
name = "pid"
[events.gains]
kp = 2
`;
const INLINE = 'name = "x"\nevents = [{ at = 1, do = "arm" }, { at = 2, do = "stop" }]\n';

describe('the events of a scenario’s text', () => {
  it('are read in their order', () => {
    expect(readEvents(TEXT)).toEqual([
      { at: 1, do: 'arm' },
      { at: 15, do: 'card', colour: 'yellow' },
      { at: 30, do: 'controller', name: 'pid', gains: { kp: 2 } },
    ]);
    expect(readEvents(INLINE)).toEqual([{ at: 1, do: 'arm' }, { at: 2, do: 'stop' }]);
    expect(readEvents('name = "x"')).toEqual([]);
    for (const broken of ['events = [', 'events = 3', 'events = [1]']) expect(readEvents(broken)).toBeNull();
  });

  it('are moved without another character changed', () => {
    expect(setField(TEXT, 1, 'at', 17.5)).toBe(TEXT.replace('at = 15', 'at = 17.5'));
    expect(setField(TEXT, 0, 'at', 2)).toBe(TEXT.replace('at = 1 # early', 'at = 2 # early'));
    expect(setField(INLINE, 1, 'at', 3)).toBe(INLINE.replace('at = 2', 'at = 3'));
    expect(setField('events = [', 0, 'at', 3)).toBe('events = [');
    expect(setField(TEXT, 7, 'at', 3)).toBe(TEXT);
  });

  it('get and lose fields', () => {
    const without = setField(TEXT, 1, 'colour', undefined);
    expect(readEvents(without)?.[1]).toEqual({ at: 15, do: 'card' });
    expect(without).toContain('# of cardboard');
    expect(readEvents(setField(without, 1, 'colour', 'a "b" \\'))?.[1]).toEqual({ at: 15, do: 'card', colour: 'a "b" \\' });
    expect(setField(TEXT, 0, 'alone', undefined)).toBe(TEXT);
    const inline = setField(setField(INLINE, 0, 'alone', 5), 0, 'do', 'arm');
    expect(readEvents(inline)).toEqual([{ at: 1, do: 'arm', alone: 5 }, { at: 2, do: 'stop' }]);
    expect(setField(inline, 0, 'alone', undefined)).toBe(INLINE);
    expect(readEvents(setField(TEXT, 0, 'gains', new Raw('{ kp = 1 }')))?.[0]).toEqual({ at: 1, do: 'arm', gains: { kp: 1 } });
    expect(fieldSource(setField(TEXT, 0, 'gains', new Raw('{ kp = 1 }')), 0, 'gains')).toBe('{ kp = 1 }');
  });

  it('are added and deleted, and comments stay', () => {
    for (const text of [TEXT, INLINE, 'name = "x"']) {
      const before = readEvents(text) ?? [];
      expect(readEvents(addEvent(text, { at: 5, do: 'marker', text: 'here' }))).toEqual([...before, { at: 5, do: 'marker', text: 'here' }]);
    }
    const less = removeEvent(TEXT, 0);
    expect(readEvents(less)).toEqual(readEvents(TEXT)?.slice(1));
    expect(less).toContain('# first it is armed');
    expect(less).toContain('# then a card');
    expect(readEvents(removeEvent(TEXT, 2))).toEqual(readEvents(TEXT)?.slice(0, 2));
    for (const index of [0, 1]) expect(readEvents(removeEvent(INLINE, index))).toEqual((readEvents(INLINE) ?? []).toSpliced(index, 1));
    expect(removeEvent(TEXT, 9)).toBe(TEXT);
  });

  it('of five hundred are moved soon enough to be dragged', () => {
    const many = Array.from({ length: 500 }, (_, at) => `[[events]]\nat = ${at}\ndo = "arm"\n`).join('\n');
    expect(readEvents(setField(many, 499, 'at', 1))?.[499]).toEqual({ at: 1, do: 'arm' });
  });

  it('of the shipped scenarios are all found, and any can be deleted', () => {
    for (const name of ['figure_14', 'sea_trial', 'lost_link', 'hover_in_a_current']) {
      const text = readFileSync(new URL(`${name}.toml`, SHIPPED), 'utf8');
      const events = readEvents(text) ?? [];
      expect(events.length).toBeGreaterThan(3);
      for (const index of [0, 2, events.length - 1]) expect(readEvents(removeEvent(text, index))).toEqual(events.toSpliced(index, 1));
    }
  });
});

describe('the place of an entry', () => {
  const line = (text: string, at: number | undefined) => text.slice(0, at).split('\n').length;

  it('in TOML', () => {
    const find = tomlPlaces(TEXT);
    expect(line(TEXT, find(['duration'])?.at)).toBe(3);
    expect(line(TEXT, find(['scene', 'kind'])?.at)).toBe(6);
    expect(line(TEXT, find(['scene', 'depth'])?.at)).toBe(5);
    expect(line(TEXT, find(['events', 1, 'colour'])?.at)).toBe(17);
    expect(line(TEXT, find(['events', 1, 'size'])?.at)).toBe(14);
    expect(line(TEXT, find(['events', 2, 'gains', 'kp'])?.at)).toBe(24);
    expect(find([])).toBeNull();
    expect(find(['nowhere'])).toBeNull();
    const mission = '[mission]\ndo = "sequence"\nsteps = [\n  { do = "dive", depth = 12 },\n  { do = "try", steps = [\n    { do = "hold" },\n  ] },\n]\n';
    expect(line(mission, tomlPlaces(mission)(['mission', 'steps', 0, 'depth'])?.at)).toBe(4);
    expect(line(mission, tomlPlaces(mission)(['mission', 'steps', 1, 'steps', 0, 'seconds'])?.at)).toBe(6);
    const broken = 'a = 1\nb = \n';
    expect(tomlPlaces(broken)(['a'])).toBeNull();
    expect(line(broken, namedPlace(broken, 'is not TOML: Invalid value (at line 2, column 5)')?.at)).toBe(2);
    expect(namedPlace(broken, 'is missing')).toBeNull();
    expect(namedPlace(broken, 'in line 99')?.at).toBe(broken.length);
  });

  it('in JSON', () => {
    const text = '[\n  {\n    "name": "a",\n    "sizes": [1, 2]\n  },\n  {\n    "name": "b"\n  }\n]';
    const find = jsonPlaces(text);
    expect(line(text, find([0, 'sizes', 1])?.at)).toBe(4);
    expect(line(text, find([1, 'name'])?.at)).toBe(7);
    expect(line(text, find([1, 'missing'])?.at)).toBe(6);
    expect(jsonPlaces('{"a": ')(['a'])).not.toBeNull();
  });
});

describe('what came of a run', () => {
  const SUMMARY = { depth: 1.048, armed: 59, controllers: ['PID'], modes: [], cards: [], mission: '', alarms: 2, curve: [], face: null, damaged: false };

  it('is its greatest depth and its alarms, once it has been read', () => {
    expect(resultWords(SUMMARY)).toEqual(['deepest 1.05 m', '2 alarms']);
    expect(resultWords({ ...SUMMARY, depth: null, alarms: 0 })).toEqual(['no alarm']);
    expect(resultWords(null)).toEqual([]);
  });
});
