/** The calls about sweeps: apart from the others, which the first view of the page fetches. */
import { address, ask, command, server, within } from '../../../http';

/** ms; tens of thousands of runs are read */
const TIMEOUT_RUNS = 60_000;

export const calls = {
  list: () => ask(server.GET('/api/sweeps')),
  check: (text: string) => ask(server.POST('/api/sweeps/check', { body: { text }, fetch: within(TIMEOUT_RUNS) })),
  /** a sweep of this scenario to begin with */
  template: (scenario: string) => ask(server.GET('/api/sweeps/template', { params: { query: { scenario } } })),
  start: (text: string) => ask(server.POST('/api/sweeps', { body: { text }, fetch: within(TIMEOUT_RUNS) })),
  detail: (sweep: number) => ask(server.GET('/api/sweeps/{sweep}', { params: { path: { sweep } }, fetch: within(TIMEOUT_RUNS) })),
  /** the runs of a variant, or with null those of all */
  runs: (sweep: number, variant: number | null) =>
    ask(server.GET('/api/sweeps/{sweep}/runs', { params: { path: { sweep }, query: variant === null ? {} : { variant } }, fetch: within(TIMEOUT_RUNS) })),
  table: (sweep: number) => address('/api/sweeps/{sweep}/table', { path: { sweep } }),
  cancel: (sweep: number) => command(server.POST('/api/sweeps/{sweep}/cancel', { params: { path: { sweep } }, fetch: within(TIMEOUT_RUNS) })),
  resume: (sweep: number) => command(server.POST('/api/sweeps/{sweep}/resume', { params: { path: { sweep } } })),
  remove: (sweep: number) => command(server.DELETE('/api/sweeps/{sweep}', { params: { path: { sweep } } })),
  /** make this run a session, by the scenarios' own runner */
  record: (sweep: number, run: number) => ask(server.POST('/api/sweeps/{sweep}/runs/{run}/session', { params: { path: { sweep, run } } })),
  saveProfile: (sweep: number, variant: number, name: string) => ask(server.POST('/api/sweeps/{sweep}/profile', { params: { path: { sweep } }, body: { variant, name } })),
};
