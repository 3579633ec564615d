/** Charts as files, dark on white, whatever the page's theme. */
import type { Comparison } from '../../../api';
import { loadPlotly } from '../../../charts/plotly';
import { saveAs } from '../../../files';
import { drawPicture, type Finer, type Look, type View } from './figure';
import { compare as texts } from '../../../texts/compare';

/** on white, told apart by colour-blind eyes */
const PRINTED = ['#0072b2', '#c25200', '#a3427d', '#00664c', '#6e5d00', '#5b3fa0', '#4a5a66'] as const;
const WIDTH = 1200;
const KEY = 22;

function printed(comparison: Comparison): Look {
  return {
    text: '#0d1a22',
    muted: '#3f515c',
    panel: '#ffffff',
    line: '#d9e0e5',
    band: 'rgba(0,0,0,0.1)',
    font: 'Inter, Helvetica, Arial, sans-serif',
    colours: comparison.sessions.map((_, place) => PRINTED[place % PRINTED.length] ?? PRINTED[0]),
  };
}

/** Save what is shown; a key with the sessions' names stands above it. */
export async function saveCharts(comparison: Comparison, finer: Finer, view: View, format: 'png' | 'svg'): Promise<void> {
  const plotly = await loadPlotly();
  const look = printed(comparison);
  const { data, layout, height } = drawPicture(comparison, finer, view, WIDTH, look);
  const above = 14 + KEY * comparison.sessions.length;
  const key = comparison.sessions.map(({ name, problem }, place) => ({
    text: `━ ${problem ? texts.save.notAligned(name) : name}`,
    xref: 'paper',
    yref: 'paper',
    x: 0,
    xanchor: 'left',
    y: 1,
    yanchor: 'bottom',
    yshift: KEY * (comparison.sessions.length - 1 - place) + 4,
    showarrow: false,
    font: { family: look.font, size: 14, color: look.colours[place] },
  }));
  const figure = {
    data,
    layout: {
      ...layout,
      height: height + above,
      margin: { ...layout.margin, t: (layout.margin?.t ?? 0) + above },
      paper_bgcolor: '#ffffff',
      plot_bgcolor: '#ffffff',
      annotations: [...(layout.annotations ?? []), ...key],
    },
  };
  const options = { format, width: WIDTH, height: height + above, scale: format === 'png' ? 2 : 1, imageDataOnly: true };
  const text = await plotly.toImage(figure as Parameters<typeof plotly.toImage>[0], options);
  const blob =
    format === 'svg'
      ? new Blob([text], { type: 'image/svg+xml' })
      : new Blob([Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0))], { type: 'image/png' });
  saveAs(blob, `comparison_${comparison.sessions.map(({ id }) => id).join('_')}.${format}`);
}
