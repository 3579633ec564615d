export const SWEEPS = '#/scenarios/sweeps';
export const NEW_SWEEP = `${SWEEPS}/new`;

export const sweepLink = (sweep: number): string => `${SWEEPS}/${sweep}`;
