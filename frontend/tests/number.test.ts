import { describe, expect, it } from 'vitest';
import { numberText, readNumber, readNumbers, type NumberRules } from '../src/number';

const value = (text: string, rules?: NumberRules) => readNumber(text, rules).value;
const problem = (text: string, rules?: NumberRules) => readNumber(text, rules).problem;

describe('a number', () => {
  it.each([
    ['0.6', 0.6],
    ['0,6', 0.6],
    ['3,5', 3.5],
    ['.5', 0.5],
    [',5', 0.5],
    ['5.', 5],
    ['5,', 5],
    ['007', 7],
    ['  12 ', 12],
    ['+1.5', 1.5],
    ['-0.3', -0.3],
    ['\u22120.3', -0.3],
    ['\u20130,3', -0.3],
    ['\u2212 0.3', -0.3],
    ['-0', 0],
    ['1e3', 1000],
    ['2,5E-4', 0.00025],
    ['1e\u22123', 0.001],
    ['0,123', 0.123],
    ['0.123', 0.123],
    ['1.234', 1.234],
    ['1,2345', 1.2345],
    ['1234,567', 1234.567],
  ])('%j is %d', (text, expected) => expect(value(text)).toBe(expected));

  it.each([
    ['1.234,5', 1234.5],
    ['1,234.5', 1234.5],
    ['1.234.567', 1234567],
    ['1,234,567.25', 1234567.25],
    ['12 345', 12345],
    ['12\u202f345,5', 12345.5],
    ['12\u00a0345', 12345],
    ['12\u2009345', 12345],
    ["1'234", 1234],
    ['1\u2019234.5', 1234.5],
    ['-1 234', -1234],
  ])('groups of three digits are read where nobody can take them for decimals: %j', (text, expected) => expect(value(text)).toBe(expected));

  it('that two people read as two numbers is refused, and both are named', () => {
    expect(problem('1,234')).toBe('“1,234” can be 1.234 or 1234: enter one of these.');
    expect(problem('-12,345')).toBe('“-12,345” can be -12.345 or -12345: enter one of these.');
    expect(problem('1,234 m', { unit: 'm' })).toContain('1.234 or 1234');
    expect(problem('1,234', { whole: true })).toContain('1.234 or 1234');
  });

  it.each(['1,2,3', '1.2.3', '0,6,', '0 6', '1 23', "5'30", '0.123.456', '1.234.56', '1,234 567', '1_234', '0x10', '0b1', 'NaN', 'Infinity', '-', '.', ',', '--5', '5-', '1e', 'e3', '1e3.5', '1/2', '½', '5²', '0..6', '0.6.', '٣', '０.６', 'six', '5 5', '(5)', '1,5,', '1.5-2'])(
    '%j is none',
    (text) => expect(value(text)).toBeNull(),
  );

  it('may bear its own unit, and no other', () => {
    expect(value('0.6 m', { unit: 'm' })).toBe(0.6);
    expect(value('0,6m', { unit: 'm' })).toBe(0.6);
    expect(value('30\u202f%', { unit: '%' })).toBe(30);
    expect(value('-4°', { unit: '°' })).toBe(-4);
    expect(problem('60 cm', { unit: 'm' })).toBe('“60 cm” has another unit: enter a number in m.');
    expect(problem('5 kg')).toBe('“5 kg” has another unit: enter a number without a unit.');
    expect(value('m', { unit: 'm' })).toBeNull();
    expect(value('1e3 s', { unit: 's' })).toBe(1000);
  });

  it('that cannot be stored as it is typed is refused', () => {
    for (const text of ['9007199254740993', '1e999', '1e-999', '-1e400']) expect(problem(text)).toContain('too many digits');
    expect(value('0e-999')).toBe(0);
  });

  it('outside of its range is named with it', () => {
    expect(problem('60', { unit: 'm', range: [0, 10] })).toBe('60 is outside of 0 to 10 m.');
    expect(problem('\u22125', { unit: 's', range: [0, Infinity] })).toBe('-5 is below 0 s.');
    expect(problem('0,5', { whole: true, range: [0, 10] })).toBe('“0,5” is not a whole number.');
    expect(value('10', { range: [0, 10] })).toBe(10);
    expect(problem(' ')).toBe('Enter a number.');
  });

  it('is read as it is written', () => {
    for (const one of [0, -0.3, 1.234, 12.345, 123.456, 1e-7, 2.5e-10, 0.1 + 0.2, 115200, -1234.567]) expect(value(numberText(one))).toBe(one);
  });
});

describe('a list', () => {
  const list = (text: string, rules?: NumberRules) => readNumbers(text, rules).values;
  const refusal = (text: string, rules?: NumberRules) => readNumbers(text, rules).problem;

  it.each([
    ['0, 0.5, 1', [0, 0.5, 1]],
    ['0 0.5\n1', [0, 0.5, 1]],
    ['0,5; 1; 1,5', [0.5, 1, 1.5]],
    ['0; 0.5 ;1', [0, 0.5, 1]],
    ['0,\n1', [0, 1]],
    ['0, ', [0]],
    ['0,', [0]],
    ['', []],
    ['1e3', [1000]],
    ['9600 57600 115200', [9600, 57600, 115200]],
    ['\u22120.3, 2', [-0.3, 2]],
    ['0.5,1.5', null],
  ])('%j', (text, expected) => (expected === null ? expect(refusal(text)).not.toBe('') : expect(list(text)).toEqual(expected)));

  it('refuses an entry that is one number to some and several to others', () => {
    expect(refusal('0,6')).toBe('“0,6” can be one number, 0.6, or several, 0, 6: enter one of these.');
    expect(refusal('0, 0,5')).toContain('0.5, or several, 0, 5');
    expect(refusal('115 200')).toContain('115200, or several, 115, 200');
    expect(refusal('0,1,2')).toContain('a space after each comma');
    expect(refusal('1,234;5')).toContain('1.234 or 1234');
    expect(refusal('9600,57600')).toContain('9600.57600');
    expect(list('0,6')).toEqual([]);
  });

  it('of whole numbers has no decimal commas', () => {
    expect(list('9600,57600,115200', { whole: true })).toEqual([9600, 57600, 115200]);
    expect(list('5,17', { whole: true })).toEqual([5, 17]);
    expect(refusal('57,600', { whole: true })).toContain('one number, 57600, or several, 57, 600');
    expect(refusal('0.5', { whole: true })).toContain('not a whole number');
    expect(refusal('7, 2000', { whole: true, range: [0, 1023] })).toBe('2000 is outside of 0 to 1023.');
  });

  it.each(['fast', '0x10', 'Infinity', '1, two', '1;;x'])('%j holds what is no number', (text) => expect(refusal(text)).toContain('is not a number'));
});
