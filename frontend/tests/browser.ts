/** What a browser has and Node lacks: the address of the page, from which those of its requests go out. */
const { Request: NodeRequest } = globalThis;

globalThis.Request = class extends NodeRequest {
  constructor(input: RequestInfo | URL, init?: RequestInit) {
    super(typeof input === 'string' ? new URL(input, 'http://localhost:8000') : input, init);
  }
};
