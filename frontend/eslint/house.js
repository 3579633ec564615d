/** Rules of the page's house: which room may import which, that a component's name is there once, and that texts stand apart. */
import { existsSync, readdirSync } from 'node:fs';
import path from 'node:path';
import { sentencesApart, textsApart } from './texts.js';

const SOURCES = path.resolve(import.meta.dirname, '../src');

/**
 * The rooms from the ground up, `*` for each of the folders there. A room imports from itself and from the layers
 * below it, so that there is no circle; rooms of one layer do not import each other.
 */
const LAYERS = [
  ['generated', 'styles'],
  ['texts'],
  ['floor'],
  ['access', 'drive'],
  ['live'],
  ['capture', 'film', 'sound'],
  ['parts'],
  ['charts'],
  ['story'],
  ['panels/*'],
  ['panels'],
  ['layout'],
  ['guide'],
  ['shell', 'pages/*'],
  ['flight', 'finder'],
  ['app'],
];
/** Files beside the rooms' folders. */
const FLOOR = ['address', 'api', 'attitude', 'files', 'finder', 'flight', 'format', 'http', 'number', 'pageSecret', 'polling', 'resource', 'router', 'screen', 'searching', 'shortcuts', 'storage', 'theme'];
const APP = ['App', 'ReaderPage', 'Root', 'lazyPages', 'main'];
/** A single panel is reached through the registry (panels/registry.ts), and by the flight view, which shows parts of some. */
const DOORS = { 'panels/*': ['panels', 'flight'] };
/** The one page that shows another: a replay is Operate, filled from a recording. */
const SHOWN = { 'pages/replay': 'pages/operate/Operate.svelte' };

const NO_ROOM = 'a file without a room: name its folder in eslint/house.js';

/** The room of a file given by its path below src; null where it has none. */
function roomOf(file) {
  const folders = file.split(path.sep);
  const [first, second] = folders;
  if (folders.length === 1) {
    const [stem] = first.split('.');
    return APP.includes(stem) ? 'app' : FLOOR.includes(stem) ? 'floor' : null;
  }
  const room = folders.length > 2 && (first === 'panels' || first === 'pages') ? `${first}/${second}` : first;
  return levelOf(room) < 0 ? null : room;
}

const kindOf = (room) => room.replace(/^(pages|panels)\/.*/, '$1/*');
const levelOf = (room) => LAYERS.findIndex((layer) => layer.includes(kindOf(room)));

/** Why one file must not import another, both given by their paths below src, the first of them in a room; null where it may. */
function refusal(from, to) {
  const [here, there] = [roomOf(from), roomOf(to)];
  if (there === null) return `${to}: ${NO_ROOM}`;
  if (here === there || SHOWN[here] === to) return null;
  if (levelOf(there) > levelOf(here)) return `${there} lies above ${here}`;
  if (levelOf(there) === levelOf(here)) return `${here} and ${there} do not import each other: what both need belongs in a room below`;
  const doors = DOORS[kindOf(there)];
  return doors === undefined || doors.includes(here) ? null : `${there} is reached through ${doors.join(', ')} alone`;
}

/** The file that an import names, as a path below src; null where it is a package or lies outside. */
function resolve(from, source) {
  if (!source.startsWith('.')) return null;
  const base = path.resolve(path.dirname(from), source);
  const file = [`${base}.ts`, `${base}.svelte`, base].find(existsSync);
  return file === undefined ? null : below(file);
}

function below(file) {
  const inside = path.relative(SOURCES, file);
  return inside.startsWith('..') ? null : inside;
}

const rooms = {
  meta: { type: 'problem', messages: { room: '{{ why }}.' }, schema: [] },
  create(context) {
    const from = below(context.filename);
    if (from === null) return {};
    if (roomOf(from) === null) return { Program: (node) => context.report({ node, messageId: 'room', data: { why: NO_ROOM } }) };
    function check(node) {
      const to = typeof node.source?.value === 'string' ? resolve(context.filename, node.source.value) : null;
      const why = to === null ? null : refusal(from, to);
      if (why !== null) context.report({ node, messageId: 'room', data: { why } });
    }
    return { ImportDeclaration: check, ImportExpression: check, ExportNamedDeclaration: check, ExportAllDeclaration: check };
  },
};

// Read once: for each component anew it would take a fifteenth of the time.
let files;

const componentOnce = {
  meta: { type: 'problem', messages: { twice: '{{ other }} has this name too: name each by what it shows.' }, schema: [] },
  create(context) {
    const own = below(context.filename);
    if (own === null || !own.endsWith('.svelte')) return {};
    files ??= readdirSync(SOURCES, { recursive: true });
    const other = files.find((one) => one !== own && path.basename(one) === path.basename(own));
    return other === undefined ? {} : { Program: (node) => context.report({ node, messageId: 'twice', data: { other } }) };
  },
};

const FIELD = 'src/parts/NumberInput.svelte: a browser drops the comma of another language, and gives 6 for 0,6';

const numberInput = {
  meta: { type: 'problem', messages: { browser: 'Numbers are typed into {{ field }}.' }, schema: [] },
  create(context) {
    return {
      "SvelteAttribute[key.name='type'] > SvelteLiteral[value='number']": (node) => context.report({ node, messageId: 'browser', data: { field: FIELD } }),
      "SvelteAttribute[key.name='type'] Literal[value='number']": (node) => context.report({ node, messageId: 'browser', data: { field: FIELD } }),
    };
  },
};

export const house = { rules: { rooms, 'number-input': numberInput, 'component-once': componentOnce, 'texts-apart': textsApart, 'sentences-apart': sentencesApart } };
