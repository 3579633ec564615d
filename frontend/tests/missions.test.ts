import { execFileSync } from 'node:child_process';
import { existsSync, readdirSync, readFileSync } from 'node:fs';
import { describe, expect, it } from 'vitest';
import type { MissionNodeKind } from '../src/api';
import {
  cardAt,
  copy,
  freeName,
  hasRoom,
  moveTo,
  neighbour,
  newDocument,
  pathOf,
  placeText,
  kindsFor,
  readCards,
  removeAt,
  setKind,
  withEntry,
  tableOf,
  walk,
  type Card,
  type Direction,
  type Path,
  type Table,
} from '../src/pages/missions/cards';
import { fieldText, fieldWords, numberProblem, readField, unknownFields } from '../src/pages/missions/fields';
import { amend, begin, go, record } from '../src/pages/missions/history';
import { HEAD, ofField, placeProblems, problemsAt } from '../src/pages/missions/problems';
import { writeMission } from '../src/pages/missions/toml';
import { figuresOf, outcomeOf, ticks } from '../src/pages/missions/trial';
import { time } from '../src/pages/missions/words';

const ROOT = new URL('../..', import.meta.url).pathname;
const PYTHON = `${ROOT}.venv/bin/python`;

/** The documents in texts, as the server reads them. */
function readToml(...texts: string[]): Table[] {
  const code = 'import json,sys; from robot_runtime.contract.toml_text import read_toml; print(json.dumps([read_toml(one) for one in json.load(sys.stdin)]))';
  return JSON.parse(execFileSync(PYTHON, ['-c', code], { input: JSON.stringify(texts), cwd: ROOT, encoding: 'utf8' })) as Table[];
}

const field = (name: string, more: Partial<MissionNodeKind['fields'][number]> = {}): MissionNodeKind['fields'][number] => ({
  name,
  kind: 'number',
  meaning: '',
  unit: 's',
  minimum: null,
  maximum: null,
  required: true,
  default: null,
  ...more,
});
const kind = (name: string, most: number | null, ...fields: MissionNodeKind['fields']): MissionNodeKind => ({ do: name, branch: most !== 0, least: 0, most, meaning: '', fields });
const KINDS = [
  kind('hold', 0, field('seconds'), field('within', { unit: 'm' })),
  kind('turn', 0, field('by', { unit: 'rad' }), field('within', { unit: 'rad' })),
  kind('sequence', null),
  kind('repeat', null, field('times', { kind: 'whole', unit: '' })),
  kind('invert', 1),
];

/** A tree in brackets: a(b c(d)), with each step's note as its letter. */
function tree({ fields, steps }: Card): string {
  return `${String(fields.note)}${steps === undefined ? '' : `(${steps.map(tree).join(' ')})`}`;
}

const leaf = (note: string): Table => ({ do: 'hold', note });
const branch = (note: string, ...steps: unknown[]): Table => ({ do: 'sequence', note, steps });
const { root } = readCards({ mission: branch('m', leaf('a'), branch('b', leaf('c'), branch('d')), leaf('e')) });

function moved(path: Path, direction: Direction): string | null {
  const place = neighbour(root, path, direction, KINDS);
  const after = place && moveTo(root, path, place, KINDS);
  return after && tree(after);
}

describe('cards', () => {
  it('are the document, also what is wrong in it', () => {
    const document = {
      format: 1,
      colour: ['deep', { of: 1 }],
      mission: { do: 'fly', steps: [{ do: 'hold', steps: 3 }, 'nothing', { steps: [] }] },
      trial: { seed: 4 },
    };
    expect(tableOf(readCards(document))).toEqual(document);
    expect(tableOf(readCards({ mission: 7 }))).toEqual({ mission: 7 });
    expect(tableOf(readCards({}))).toEqual({ mission: {} });
  });

  it('move up, down, in and out, and nowhere else', () => {
    expect(tree(root)).toBe('m(a b(c d()) e)');
    expect(moved([1], 'up')).toBe('m(b(c d()) a e)');
    expect(moved([1], 'down')).toBe('m(a e b(c d()))');
    expect(moved([2], 'in')).toBe('m(a b(c d() e))');
    expect(moved([0], 'in')).toBe('m(b(a c d()) e)');
    expect(moved([1, 1], 'out')).toBe('m(a b(c) d() e)');
    expect(moved([1, 0], 'in')).toBe('m(a b(d(c)) e)');
    expect(moved([0], 'up')).toBeNull();
    expect(moved([2], 'down')).toBeNull();
    expect(moved([0], 'out')).toBeNull();
    expect(moved([], 'down')).toBeNull();
  });

  it('are the same steps after a move', () => {
    const id = cardAt(root, [1, 0])?.id ?? Symbol();
    const after = moveTo(root, [1, 0], { parent: [], index: 3 }, KINDS);
    expect(after && tree(after)).toBe('m(a b(d()) e c)');
    expect(after && pathOf(after, id)).toEqual([3]);
    expect(placeText([3, 0])).toBe('4.1');
  });

  it('do not move into themselves or where there is no room', () => {
    expect(moveTo(root, [1], { parent: [1, 1], index: 0 }, KINDS)).toBeNull();
    expect(moveTo(root, [0], { parent: [2], index: 0 }, KINDS)).toBeNull();
    const full = readCards({ mission: { do: 'invert', steps: [leaf('a')] } }).root;
    expect(hasRoom(full, KINDS)).toBe(false);
    expect(hasRoom({ ...full, steps: [] }, KINDS)).toBe(true);
    expect(hasRoom(readCards({ mission: { do: 'sequence', steps: 'none' } }).root, KINDS)).toBe(false);
  });

  it('are removed, and copied with all below them', () => {
    expect(tree(removeAt(root, [1, 0]))).toBe('m(a b(d()) e)');
    const second = copy(root);
    expect(tree(second)).toBe(tree(root));
    const ids = [...walk(root), ...walk(second)].map(({ card }) => card.id);
    expect(new Set(ids).size).toBe(ids.length);
  });

  it('lose a field that is emptied, and with another kind those that it does not have', () => {
    const { root: one } = readCards({ mission: { do: 'hold', seconds: 3, within: 0.2, note: 'n' } });
    expect(withEntry(one.fields, 'seconds', undefined)).toEqual({ do: 'hold', within: 0.2, note: 'n' });
    const turn = KINDS[1];
    expect(turn && setKind(one, [], turn).fields).toEqual({ do: 'turn', within: 0.2, note: 'n' });
  });

  it('without steps may become any kind: a mission may be a single step', () => {
    const empty = newDocument([]).root;
    expect(kindsFor(empty, KINDS)).toEqual(KINDS);
    const leaf = kindsFor(empty, KINDS).find(({ do: name }) => name === 'hold');
    if (leaf === undefined) throw new Error('no such kind');
    const single = setKind(empty, [], leaf);
    expect(tableOf({ head: {}, root: single })).toEqual({ mission: { do: 'hold' } });
    const sequence = kindsFor(single, KINDS).find(({ do: name }) => name === 'sequence');
    expect(sequence && tableOf({ head: {}, root: setKind(single, [], sequence) })).toEqual({ mission: { do: 'sequence', steps: [] } });
  });

  it('with steps stay such as have steps', () => {
    const { root: one } = readCards({ mission: { do: 'sequence', steps: [{ do: 'hold' }] } });
    expect(kindsFor(one, KINDS)).toEqual(KINDS.filter(({ most }) => most !== 0));
  });

  it('begin with a name that is free', () => {
    expect(freeName('dive', ['dive'])).toBe('dive_2');
    expect(freeName('dive_2', ['dive', 'dive_2'])).toBe('dive_3');
    expect(newDocument(['my_mission']).head.name).toBe('my_mission_2');
  });
});

describe('TOML', () => {
  const FOLDER = `${ROOT}robot_runtime/missions/shipped/`;

  it('of the shipped missions says the same after it is written', () => {
    const texts = readdirSync(FOLDER).map((name) => readFileSync(FOLDER + name, 'utf8'));
    expect(texts.length).toBeGreaterThan(5);
    const tables = readToml(...texts);
    const written = tables.map((table) => writeMission(tableOf(readCards(table))));
    expect(readToml(...written)).toEqual(tables);
  });

  it('says every value as it is', () => {
    expect(existsSync(PYTHON)).toBe(true);
    const odd = 'a "b" \\ \t\u0001\u007f€😀\r';
    const document = {
      format: 1,
      name: odd,
      description: `${odd}\n\n """ ''' \n`,
      'a key': [1, 2.5, -1e-9, 1e21, true, odd],
      'dotted.key': { 'ü': {}, deep: { 'of it': [] } },
      limits: {},
      mission: { do: 'all', note: 'two\nlines', steps: [{ do: 'repeat', steps: [{ do: 'set', value: false }, {}, { steps: [] }], times: 2 }] },
      trial: { vision: { markers: 'x' }, events: [{ at: 40, card: { size: 1 } }, { at: 50 }], mixed: [1, { a: 2 }], seed: 3 },
      list: [{ a: 1 }, { b: [{ c: 2 }] }],
    };
    expect(readToml(writeMission(document))).toEqual([document]);
  });

  it('of random trees says the same', () => {
    let seed = 7;
    const next = (most: number) => (seed = (seed * 48271) % 2147483647) % most;
    const grow = (deep: number): Table => ({
      do: `kind_${next(9)}`,
      ...(next(2) === 0 ? { depth: next(1000) / 100 } : {}),
      ...(next(3) === 0 ? { note: 'x"\n'.repeat(next(4)) } : {}),
      ...(deep > 0 && next(3) > 0 ? { steps: Array.from({ length: next(5) }, () => grow(deep - 1)) } : {}),
    });
    const tables = Array.from({ length: 200 }, () => ({ format: 1, mission: grow(6) }));
    expect(readToml(...tables.map((table) => writeMission(tableOf(readCards(table)))))).toEqual(tables);
  });

  it('has a step to a line', () => {
    const document = { format: 1, mission: { do: 'sequence', steps: [leaf('a'), branch('b', leaf('c'))] } };
    expect(writeMission(document)).toBe(`format = 1

[mission]
do = "sequence"
steps = [
  { do = "hold", note = "a" },
  { do = "sequence", note = "b", steps = [
      { do = "hold", note = "c" },
  ] },
]
`);
  });
});

describe('undo', () => {
  it('goes back and forth, and letters of one field are one change', () => {
    let history = begin('');
    history = record(history, '0', 'depth');
    history = record(history, '0.6', 'depth');
    history = record(history, '0.6 m', 'note');
    expect(history.entries).toEqual(['', '0.6', '0.6 m']);
    history = go(go(history, -1), -1);
    expect(history.entries[history.at]).toBe('');
    expect(go(history, -1)).toBe(history);
    history = go(history, 1);
    history = amend(history, 'read');
    history = record(history, 'other', '');
    expect(history.entries).toEqual(['', 'read', 'other']);
    expect(go(history, 1)).toBe(history);
  });

  it('does not put a change together with one before going back', () => {
    let history = record(record(begin('a'), 'b', 'depth'), 'c', 'note');
    history = record(go(history, -1), 'd', 'depth');
    expect(history.entries).toEqual(['a', 'b', 'd']);
  });

  it('has an end', () => {
    let history = begin(0);
    for (let count = 1; count < 500; count += 1) history = record(history, count, '');
    expect(history.entries.length).toBe(200);
    expect(history.entries[history.at]).toBe(499);
  });
});

describe('problems', () => {
  const placed = placeProblems([
    { path: ['mission', 'steps', 2, 'steps', 0, 'times'], text: 'step 3.1: times is 0', words: 'is 0' },
    { path: ['mission', 'steps', 1], text: 'step 2: needs one', words: 'needs one' },
    { path: ['mission', 'steps'], text: 'steps has 0', words: 'has 0' },
    { path: ['limits', 'depth'], text: 'limits.depth is 9', words: 'is 9' },
    { path: [], text: 'It is no TOML', words: 'It is no TOML' },
  ]);

  it('are at their step and field', () => {
    expect(problemsAt(placed, [2, 0])).toEqual([{ field: 'times', words: 'times is 0' }]);
    expect(problemsAt(placed, [1])).toEqual([{ field: '', words: 'needs one' }]);
    expect(problemsAt(placed, [])).toEqual([{ field: 'steps', words: 'steps has 0' }]);
    expect(problemsAt(placed, [5])).toEqual([]);
    expect(ofField(placed.get(HEAD) ?? [], 'limits.depth')).toEqual(['limits.depth is 9']);
    expect(ofField(placed.get(HEAD) ?? [], '')).toEqual(['It is no TOML']);
  });
});

describe('fields', () => {
  it('are read as they are typed, and what is no number stays', () => {
    expect(readField('number', '0,5')).toBe(0.5);
    expect(readField('number', '0,5 m', 'm')).toBe(0.5);
    expect(readField('number', 'deep')).toBe('deep');
    for (const text of ['1,234', '0x10', '1,2,3']) {
      expect(readField('number', text)).toBe(text);
      expect(readField('value', text)).toBe(text);
      expect(numberProblem(field('depth', { kind: 'number' }), text)).not.toBe('');
    }
    expect(numberProblem(field('value', { kind: 'value' }), '1,234')).toContain('1.234 or 1234');
    expect(numberProblem(field('value', { kind: 'value' }), 'red')).toBe('');
    expect(readField('number', '')).toBeUndefined();
    expect(readField('text', '5')).toBe('5');
    expect([readField('value', 'true'), readField('value', '2'), readField('value', '"2"'), readField('value', 'red')]).toEqual([true, 2, '2', 'red']);
  });

  it('of any value are typed and read as the same', () => {
    for (const value of [true, 2.5, 'red', '2', 'true', '"', '"2"', '']) expect(readField('value', fieldText('value', value)) ?? '').toBe(value);
  });

  it('are told in words', () => {
    const turn = KINDS[1]?.fields ?? [];
    expect(fieldWords({ do: 'turn', by: Math.PI / 2, within: 'far', note: 'n', odd: 1 }, turn)).toBe('by 90°, within far rad, odd 1');
    expect(unknownFields({ id: Symbol(), fields: { do: 'turn', by: 1, odd: 1, note: '' } }, turn)).toEqual(['odd']);
  });
});

describe('a dry run', () => {
  const run = (seed: number, phase: 'succeeded' | 'failed' | 'ended' | null, elapsed: number, failed: string | null) => ({ seed, phase, elapsed, failed, text: `of ${seed}`, deepest: seed / 10, curve: [] });
  const trial = { run: 'a', name: 'a', text: '', running: false, seeds: 5, problem: '' };

  it('has its figures', () => {
    const results = [run(1, 'succeeded', 40, null), run(2, 'failed', 9, '2.1'), run(3, 'succeeded', 44, null), run(4, 'failed', 7, '2.1'), run(5, null, 0, null)];
    expect(results.map(outcomeOf)).toEqual(['succeeded', 'failed', 'succeeded', 'failed', 'none']);
    expect(figuresOf({ ...trial, results })).toEqual({
      succeeded: 2,
      took: [40, 44],
      deepest: 0.5,
      failures: [
        { place: '2.1', count: 2, text: 'of 2' },
        { place: '', count: 1, text: 'of 5' },
      ],
    });
    expect(figuresOf({ ...trial, results: [] }).took).toBeNull();
  });

  it('has round figures at its axes', () => {
    expect(ticks(1.3, 4)).toEqual([0, 0.5, 1]);
    expect(ticks(47, 8)).toEqual([0, 10, 20, 30, 40]);
    expect([time(47.25), time(90), time(1800), time(135)]).toEqual(['47.3 s', '90 s', '30 min', '2 min 15 s']);
  });
});
