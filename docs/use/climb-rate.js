// How fast the robot rises or sinks: the slope of the depth over the last two seconds.

export const title = 'Climb rate';
export const topics = ['depth'];

const OVER = 2; // s
const SHOWN = 30; // s
const MOST = 0.5; // m/s at the edges of the drawing

export default function panel(root) {
  root.innerHTML = `
    <style>
      body { display: flex; flex-direction: column; gap: 6px; padding: 4px 12px 12px; box-sizing: border-box; }
      output { font-size: 30px; font-weight: 500; }
      small { color: var(--muted); font-size: 14px; }
      svg { flex: 1; min-height: 0; width: 100%; background: var(--well); border-radius: 6px; }
      path { fill: none; stroke: var(--series-measured); stroke-width: 2; vector-effect: non-scaling-stroke; }
      line { stroke: var(--line-strong); vector-effect: non-scaling-stroke; }
    </style>
    <div><output>–</output> <small>m/s up</small></div>
    <svg viewBox="0 0 ${SHOWN} ${2 * MOST}" preserveAspectRatio="none" role="img" aria-label="Climb rate over ${SHOWN} s">
      <line x1="0" x2="${SHOWN}" y1="${MOST}" y2="${MOST}" /><path />
    </svg>`;
  const output = root.querySelector('output');
  const path = root.querySelector('path');
  let depths = [];
  let rates = [];

  // Called ten times a second with what has come since.
  return ({ now, rows }) => {
    depths = depths.concat(rows.depth).filter(({ time }) => time > now - OVER && time <= now);
    if (depths.length < 10) return;
    const rate = -slope(depths);
    rates = rates.concat({ time: now, rate }).filter(({ time }) => time > now - SHOWN && time <= now);
    output.textContent = `${rate < -0.005 ? '−' : '\u2007'}${Math.abs(rate).toFixed(2)}`;
    const points = rates.map((one) => `${SHOWN - (now - one.time)} ${MOST - one.rate}`);
    path.setAttribute('d', `M${points.join('L')}`);
  };
}

/** Least squares, m/s. */
function slope(rows) {
  const mean = (of) => rows.reduce((sum, row) => sum + of(row), 0) / rows.length;
  const time = mean((row) => row.time);
  const depth = mean((row) => row.depth);
  return mean((row) => (row.time - time) * (row.depth - depth)) / mean((row) => (row.time - time) ** 2);
}
