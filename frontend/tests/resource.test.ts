import { describe, expect, it } from 'vitest';
import { together, type Answer } from '../src/http';
import { Resource } from '../src/resource.svelte';

/** A request that is answered when the test says so. */
function asked<T>() {
  let answer: (given: Answer<T>) => void = () => undefined;
  const request = new Promise<Answer<T>>((resolve) => (answer = resolve));
  return { request, answer };
}

describe('Resource', () => {
  it('keeps what is loaded, and is busy meanwhile', async () => {
    const resource = new Resource<number>();
    const { request, answer } = asked<number>();
    const loaded = resource.load(request);
    expect(resource.busy).toBe(true);
    answer({ value: 7 });
    expect(await loaded).toBe(7);
    expect([resource.value, resource.busy, resource.problem]).toEqual([7, false, '']);
  });

  it('says why a request failed, and keeps what was there', async () => {
    const resource = new Resource<number>();
    await resource.load(Promise.resolve({ value: 7 }));
    expect(await resource.load(Promise.resolve({ problem: 'The server does not answer.' }))).toBeNull();
    expect([resource.value, resource.busy, resource.problem]).toEqual([7, false, 'The server does not answer.']);
    await resource.load(Promise.resolve({ value: 8 }));
    expect([resource.value, resource.problem]).toEqual([8, '']);
  });

  it('does not take an old answer for a new one', async () => {
    const resource = new Resource<string>();
    const [first, second] = [asked<string>(), asked<string>()];
    const loads = [resource.load(first.request), resource.load(second.request)];
    second.answer({ value: 'second' });
    await loads[1];
    first.answer({ problem: 'late' });
    await loads[0];
    expect([resource.value, resource.busy, resource.problem]).toEqual(['second', false, '']);
  });

  it('answers whether a command was done', async () => {
    const resource = new Resource();
    expect(await resource.run(Promise.resolve('It is armed.'))).toBe(false);
    expect(resource.problem).toBe('It is armed.');
    expect(await resource.run(Promise.resolve(null))).toBe(true);
    expect(resource.problem).toBe('');
  });
});

describe('together', () => {
  it('has all values, or the first problem', async () => {
    expect(await together([Promise.resolve({ value: 1 }), Promise.resolve({ value: 2 })])).toEqual({ value: [1, 2] });
    expect(await together([Promise.resolve({ value: 1 }), Promise.resolve({ problem: 'gone' })])).toEqual({ problem: 'gone' });
  });
});
