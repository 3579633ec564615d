/** Plotly, for figures that are kept: about 400 kB, fetched when the first one is drawn. */
import type Plotly from 'plotly.js-basic-dist-min';
import './plotly.css';

export type PlotlyModule = typeof Plotly;

const MARK = 'plotly.js-style-global';

/**
 * Plotly puts its rules into a style element, which the page's content security policy refuses. It does not try
 * where something of this name and class is there already; plotly.css has the rules that a figure needs.
 */
export async function loadPlotly(): Promise<PlotlyModule> {
  if (document.getElementById(MARK) === null) {
    const mark = document.createElement('template');
    mark.id = MARK;
    mark.className = 'no-inline-styles';
    document.head.append(mark);
  }
  const { default: plotly } = await import('plotly.js-basic-dist-min');
  return plotly;
}
