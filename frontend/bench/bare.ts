/** The same traces by uPlot as it comes: every sample of the minute, at every frame. */
import uPlot from 'uplot';
import 'uplot/dist/uPlot.min.css';
import { source } from '../src/charts/painter';
import { findSignals } from '../src/charts/signals';
import { NAMES, place, SECONDS, startFeed } from './feed';

const TOGETHER = 3;
const COLOURS = ['#56b4e9', '#e69f00', '#cc79a7'];
const { live } = startFeed();
const lines = findSignals(NAMES).map((signal) => source(live, signal));
const height = Math.floor(window.innerHeight / (lines.length / TOGETHER));

const plots = Array.from({ length: lines.length / TOGETHER }, (_, at) => {
  const mine = lines.slice(at * TOGETHER, (at + 1) * TOGETHER);
  const plot = new uPlot(
    {
      width: window.innerWidth,
      height,
      legend: { show: false },
      scales: { x: { time: false } },
      series: [{}, ...mine.map((_line, place): uPlot.Series => ({ stroke: COLOURS[place] ?? 'black', points: { show: false } }))],
    },
    [[], ...mine.map(() => [])],
    place(),
  );
  return { plot, mine };
});

requestAnimationFrame(function draw() {
  const now = live.instantNow;
  for (const { plot, mine } of plots) {
    const ring = mine[0]?.ring;
    if (ring === undefined || Number.isNaN(now)) continue;
    const first = ring.firstSince(now - SECONDS);
    const many = ring.length - first;
    const times = new Float64Array(many);
    const values = mine.map(() => new Float64Array(many));
    for (let order = 0; order < many; order += 1) {
      const from = ring.place(first + order);
      times[order] = (ring.time[from] ?? NaN) - now;
      for (const [at, one] of mine.entries()) (values[at] ?? times)[order] = one.column[from] ?? NaN;
    }
    plot.setData([times, ...values]);
  }
  requestAnimationFrame(draw);
});
