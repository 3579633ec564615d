import { readdirSync, readFileSync } from 'node:fs';
import { describe, expect, it } from 'vitest';

const CSS = readFileSync(new URL('../src/styles/tokens.css', import.meta.url), 'utf8');

const ROOT = ':root';
const SUNLIGHT = ":root[data-theme='sunlight']";

function block(selector: string): string {
  const start = CSS.indexOf(`${selector} {`);
  return CSS.slice(start, CSS.indexOf('}', start));
}

function colours(selector: string): Map<string, string> {
  return new Map([...block(selector).matchAll(/--([\w-]+): (#[0-9a-f]{6});/g)].map(([, name = '', value = '']) => [name, value]));
}

/** Relative luminance, as in WCAG 2. */
function luminance(hex: string): number {
  const [red = 0, green = 0, blue = 0] = [1, 3, 5].map((at) => {
    const share = parseInt(hex.slice(at, at + 2), 16) / 255;
    return share <= 0.04045 ? share / 12.92 : ((share + 0.055) / 1.055) ** 2.4;
  });
  return 0.2126 * red + 0.7152 * green + 0.0722 * blue;
}

function contrast(one: string, other: string): number {
  const [low = 0, high = 0] = [luminance(one), luminance(other)].sort((a, b) => a - b);
  return (high + 0.05) / (low + 0.05);
}

/** The ground that a soft colour gives where it lies on another one. */
function lay(selector: string, soft: string, ground: string): string {
  const found = new RegExp(`--${soft}: rgb\\((\\d+) (\\d+) (\\d+) / (\\d+)%\\)`).exec(block(selector)) ?? [];
  const [, red, green, blue, percent] = found.map(Number);
  const mixed = [red, green, blue].map((part = NaN, at) => {
    const under = parseInt(ground.slice(1 + 2 * at, 3 + 2 * at), 16);
    return Math.round(under + ((part - under) * (percent ?? NaN)) / 100);
  });
  return `#${mixed.map((part) => part.toString(16).padStart(2, '0')).join('')}`;
}

const dark = colours(ROOT);
const sunlight = new Map([...dark, ...colours(SUNLIGHT)]);

describe.each([
  ['dark', ROOT, dark, 4.5, 3],
  ['sunlight', SUNLIGHT, sunlight, 7, 4.5],
] as const)('%s', (_theme, selector, tokens, textLeast, lineLeast) => {
  const of = (name: string) => tokens.get(name) ?? '';

  it.each(['text', 'muted', 'accent', 'caution', 'alarm', 'replay'])('text in %s can be read on every ground', (name) => {
    for (const ground of ['ground', 'panel', 'well']) {
      expect(contrast(of(name), of(ground)), `${name} on ${ground}`).toBeGreaterThanOrEqual(textLeast);
    }
  });

  it.each(['text', 'muted', 'accent', 'code-text', 'code-number'])('%s of a document can be read, in the line with the cursor, too', (name) => {
    for (const ground of ['well', 'raised']) expect(contrast(of(name), of(ground)), ground).toBeGreaterThanOrEqual(textLeast);
  });

  it('an alarm can be read on its own ground', () => {
    for (const ground of ['ground', 'panel']) {
      expect(contrast(of('alarm'), lay(selector, 'alarm-soft', of(ground))), ground).toBeGreaterThanOrEqual(textLeast);
    }
  });

  it('buttons can be read', () => {
    expect(contrast(of('text'), of('raised'))).toBeGreaterThanOrEqual(textLeast);
    expect(contrast(of('on-accent'), of('accent'))).toBeGreaterThanOrEqual(textLeast);
    expect(contrast(of('on-replay'), of('replay'))).toBeGreaterThanOrEqual(textLeast);
    expect(contrast(of('on-stop'), of('stop'))).toBeGreaterThanOrEqual(4.5);
    expect(contrast(of('on-armed'), of('armed'))).toBeGreaterThanOrEqual(textLeast);
  });

  it.each(['series-measured', 'series-wanted', 'series-third', 'series-4', 'series-5', 'series-6', 'series-7'])('the line %s stands out', (name) => {
    expect(contrast(of(name), of('panel'))).toBeGreaterThanOrEqual(lineLeast);
  });
});

const SOURCES = new URL('../src/', import.meta.url);
/** Colours that are data or print, not the page's own. */
const OWN_COLOURS: Readonly<Record<string, string>> = {
  'charts/shades.ts': 'black and white, one of which can be read on any colour',
  'pages/comm_tests/scale.ts': 'a scale of rates, the same in both themes and in files',
  'pages/comm_tests/figure.ts': 'no colour at all',
  'pages/sessions/compare/figure.ts': 'no colour at all',
  'pages/sessions/compare/save.ts': 'files to print, on white',
};

const read = (file: string) => readFileSync(new URL(file, SOURCES), 'utf8').replaceAll(/\/\*[^]*?\*\/|<!--[^]*?-->/g, '');
/** What a file says of styles: all of a style sheet, of a component its styles and its markup's. */
const stylesOf = (file: string) =>
  file.endsWith('.css') ? read(file) : [...read(file).matchAll(/<style>[^]*<\/style>|style(:[\w-]+)?="[^"]*"/g)].join('\n');
const files = readdirSync(SOURCES, { recursive: true, encoding: 'utf8' }).filter((file) => !file.startsWith('generated') && file !== 'styles/tokens.css');

/** Widths of the window (px) at which something changes: at most the first, at least the second. */
const WIDTHS = ['max-width: 389px', 'max-width: 479px', 'max-width: 899px', 'min-width: 900px', 'max-width: 1099px', 'max-width: 1719px', 'max-width: 2199px'];
/** Of what stands within a thing, and between things; a negative margin takes back what another rule gives. */
const ROOM = /(?:^|[\s;{"])(?:padding|margin|gap|row-gap|column-gap)(?:-[a-z]+)?: [^;}]*?(?<![-\w.])[\d.]+(?:px|rem)[^;}]*/g;

describe('sizes and colours come from tokens.css', () => {
  const styled = files.filter((file) => /\.(css|svelte)$/.test(file));

  it.each(styled)('%s has no font size of its own', (file) => {
    expect(stylesOf(file).match(/font(-size)?:[^;}]*\d(px|rem|em|%|pt)[^;}]*/g) ?? []).toEqual([]);
  });

  it.each(styled)('%s has no spacing of its own', (file) => {
    expect(stylesOf(file).match(ROOM) ?? []).toEqual([]);
  });

  it.each(files.filter((file) => /\.(css|svelte|ts)$/.test(file)))('%s changes at the page’s widths alone', (file) => {
    expect((read(file).replaceAll(/@container[^{]*/g, '').match(/(?:max|min)-width: \d+px(?=\))/g) ?? []).filter((width) => !WIDTHS.includes(width))).toEqual([]);
  });

  it.each(styled)('%s has no colour of its own', (file) => {
    expect(stylesOf(file).match(/#[0-9a-f]{3,8}\b|\b(rgba?|hsla?|oklch|lab)\(|:\s*(white|black|red|green|blue|yellow|gr[ae]y|orange)\b/gi) ?? []).toEqual([]);
  });

  it.each(files.filter((file) => /\.(ts|svelte)$/.test(file) && !(file in OWN_COLOURS)))('the code of %s names no colour', (file) => {
    expect(read(file).match(/['"`]#[0-9a-f]{3,8}['"`]|['"`](rgba?|hsla?)\(\d/gi) ?? []).toEqual([]);
  });

  it.each(files.filter((file) => /\.(ts|svelte)$/.test(file)))('every token that %s names exists', (file) => {
    const named = [...read(file).matchAll(/var\(--([\w-]+)/g), ...read(file).matchAll(/\btoken\('([\w-]+)'\)/g)].map(([, name = '']) => name);
    const own = new Set([...read(file).matchAll(/style:--([\w-]+)|(?:^|[\s;"])--([\w-]+)\s*:/gm)].map(([, one, other]) => one ?? other ?? ''));
    expect(named.filter((name) => !CSS.includes(`--${name}:`) && !own.has(name))).toEqual([]);
  });
});

/** Where a colour of state may stand; a folder ends with a slash. */
const PLACES: Readonly<Record<string, readonly string[]>> = {
  armed: ['parts/state/ArmedState.svelte', 'pages/operate/Arm.svelte', 'shell/RobotNow.svelte', 'pages/robots/RobotTile.svelte', 'flight/'],
  recording: ['shell/Recording.svelte', 'pages/sessions/RecordingNow.svelte', 'pages/sessions/SessionRow.svelte', 'flight/'],
  replay: ['pages/replay/', 'parts/Panel.svelte', 'shell/', 'App.svelte', 'styles/'],
  stop: ['shell/StopButton.svelte', 'pages/robots/StopAll.svelte', 'pages/operate/drive/PadMap.svelte', 'drive/', 'flight/'],
  alarm: [
    // alarms, faults and a lost link
    'shell/', 'flight/', 'panels/events/', 'panels/console/', 'parts/Sheet.svelte', 'parts/state/', 'pages/operate/Failsafe.svelte', 'pages/replay/SeekBar.svelte', 'pages/sessions/SessionRow.svelte', 'story/', 'pages/sessions/dive/MomentCard.svelte', 'pages/robots/RobotTile.svelte',
    // a check that the robot did not pass
    'parts/Sign.svelte', 'parts/Judged.svelte', 'pages/bring_up/StepResults.svelte', 'pages/bring_up/DeviceChips.svelte',
    // a drawing of what is red itself: a wire, a magnet's pole
    'pages/bring_up/MotorPicture.svelte', 'pages/bring_up/MagnetPicture.svelte', 'pages/bring_up/MeterPicture.svelte',
  ],
};
/** Amber as a mark in a drawing, a few pixels large, which nobody takes for a state. */
const AMBER_MARKS = ['pages/replay/SeekBar.svelte', 'pages/replay/DepthSlider.svelte', 'pages/missions/TrialResults.svelte'];

describe('one language of state', () => {
  const styled = files.filter((file) => /\.(css|svelte)$/.test(file));

  it.each(Object.entries(PLACES))('the colour of %s stands only where that is meant', (name, places) => {
    const users = styled.filter((file) => new RegExp(`var\\(--(on-)?${name}(-\\w+)?\\)`).test(read(file)));
    expect(users.length).toBeGreaterThan(0);
    expect(users.filter((file) => !places.some((place) => (place.endsWith('/') ? file.startsWith(place) : file === place)))).toEqual([]);
  });

  it('caution is text and outline, never a ground: filled amber is ARMED alone', () => {
    expect(styled.filter((file) => !AMBER_MARKS.includes(file) && /background(-color)?:[^;}]*--caution/.test(read(file)))).toEqual([]);
    expect(CSS).not.toContain('--caution-soft');
  });
});
