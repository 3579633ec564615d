/** What a browser has and Node lacks; and the end of each file, since the files of a thread share its globals and modules. */
import { afterAll, vi } from 'vitest';

const { Request: NodeRequest } = globalThis;

/** With the address of the page, from which those of its requests go out. */
class PageRequest extends NodeRequest {
  constructor(input: RequestInfo | URL, init?: RequestInit) {
    super(typeof input === 'string' ? new URL(input, 'http://localhost:8000') : input, init);
  }
}

if (NodeRequest.name !== PageRequest.name) globalThis.Request = PageRequest;

afterAll(() => {
  vi.unstubAllGlobals();
  vi.restoreAllMocks();
  vi.useRealTimers();
});
