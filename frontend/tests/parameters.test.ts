import { expect, test } from 'vitest';
import type { Loop, TunableParameter } from '../src/generated/topics';
import { differences, find, group, groupTitle, valueWords, words, wrong } from '../src/pages/tune/parameters/list';

function parameter(name: string, changes: Partial<TunableParameter> = {}): TunableParameter {
  return {
    name,
    type: 'number',
    value: 3,
    default: 3,
    minimum: 0,
    maximum: 5,
    unit: 'm',
    meaning: 'what it is',
    choices: [],
    where: 'runtime',
    while_armed: true,
    pending: false,
    ...changes,
  };
}

const ALL = [
  parameter('depth.controller', { type: 'choice', value: 'pid', default: 'bang_bang', choices: ['pid', 'bang_bang'] }),
  parameter('depth.pid.kp', { meaning: 'command for each metre' }),
  parameter('depth.pid.ki', { value: 4 }),
  parameter('fins.frequency', { unit: 'Hz' }),
];

test('parameters are found by each word of name, meaning and unit', () => {
  expect(find(ALL, 'PID metre', false).map((one) => one.name)).toEqual(['depth.pid.kp']);
  expect(find(ALL, 'hz', false).map((one) => one.name)).toEqual(['fins.frequency']);
  expect(find(ALL, '', true).map((one) => one.name)).toEqual(['depth.controller', 'depth.pid.ki']);
});

test('they are grouped by all of their name but its end, in their order', () => {
  expect(group(ALL).map((one) => [one.name, one.parameters.length])).toEqual([
    ['depth', 1],
    ['depth.pid', 2],
    ['fins', 1],
  ]);
});

test.each([
  [{}, 5, null],
  [{}, 5.1, 'Out of range'],
  [{}, NaN, 'Enter a number'],
  [{ type: 'whole' }, 1.5, 'Enter a whole number'],
  [{ type: 'choice', choices: ['a'] }, 'b', 'Not one of the choices'],
  [{ type: 'switch' }, true, null],
] as const)('%o as %s: %s', (changes, value, problem) => {
  expect(wrong(parameter('x', changes as Partial<TunableParameter>), value)).toBe(problem);
});

test('what differs is told of both sides, also where one lacks it', () => {
  expect(differences({ a: 1, b: 'x', old: true }, { a: 2, b: 'x', new: 3 })).toEqual([
    { name: 'a', left: 1, right: 2 },
    { name: 'old', left: true, right: null },
    { name: 'new', left: null, right: 3 },
  ]);
  expect([words(0.1 + 0.2), words('bang_bang'), words(true), words(null)]).toEqual(['0.3', 'bang bang', 'on', '–']);
});

test('a controller has the title that the robot gives it, in values and in groups', () => {
  const controllers = [
    { name: 'pid', title: 'PID', gains: [] },
    { name: 'predictive', title: 'Model-based', gains: [] },
  ];
  const loops: Loop[] = [{ name: 'depth', on: false, set_point: 0, controller: 'pid', controllers }];
  expect(valueWords(loops, 'depth.controller', 'predictive')).toBe('Model-based');
  expect(groupTitle(loops, 'depth.predictive')).toBe('depth · Model-based');
  // Nothing else is called so, and an older robot's controller keeps its own name.
  expect(valueWords(loops, 'vision.colour', 'predictive')).toBe('predictive');
  expect(valueWords(loops, 'depth.controller', 'bang_bang')).toBe('bang bang');
  expect(valueWords([], 'depth.controller', 'predictive')).toBe('predictive');
  expect(groupTitle(loops, 'depth.trim_speed')).toBe('depth · trim speed');
});
