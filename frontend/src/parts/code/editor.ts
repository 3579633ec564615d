/** The editor of documents, CodeMirror: fetched when somebody edits. */
import { defaultKeymap, history, historyKeymap } from '@codemirror/commands';
import { json } from '@codemirror/lang-json';
import { bracketMatching, HighlightStyle, indentUnit, StreamLanguage, syntaxHighlighting } from '@codemirror/language';
import { toml } from '@codemirror/legacy-modes/mode/toml';
import { lintGutter, nextDiagnostic, setDiagnostics, type Diagnostic } from '@codemirror/lint';
import { Annotation, Compartment, EditorState } from '@codemirror/state';
import { EditorView, highlightActiveLine, keymap, lineNumbers } from '@codemirror/view';
import { tags } from '@lezer/highlight';
import type { EntryPath } from './places';
import { jsonPlaces, namedPlace, tomlPlaces } from './places';

export type Language = 'toml' | 'json';

export interface CodeProblem {
  readonly path: EntryPath;
  readonly text: string;
}

/** A problem with its line, from 1; null where it is about the whole document. */
export interface ShownProblem {
  readonly line: number | null;
  readonly text: string;
}

export interface CodeEditor {
  /** the text as it is by now, where somebody else has changed it */
  take: (text: string) => void;
  /** the problems of a text, which is the present one or older: then they stay out of the lines */
  show: (problems: readonly CodeProblem[], of: string) => readonly ShownProblem[];
  /** give the focus to a line */
  go: (line: number) => void;
  lock: (locked: boolean) => void;
  close: () => void;
}

const FROM_OUTSIDE = Annotation.define<boolean>();

const colours = HighlightStyle.define([
  { tag: [tags.propertyName, tags.definition(tags.propertyName)], color: 'var(--text)' },
  { tag: tags.atom, color: 'var(--accent)', fontWeight: '600' },
  { tag: [tags.string, tags.special(tags.string)], color: 'var(--code-text)' },
  { tag: [tags.number, tags.bool], color: 'var(--code-number)' },
  { tag: tags.comment, color: 'var(--muted)', fontStyle: 'italic' },
]);

const look = EditorView.theme({
  '&': { height: '100%', color: 'var(--text)', fontSize: 'var(--label)' },
  '&.cm-focused': { outline: 'none' },
  '.cm-scroller': { fontFamily: 'var(--mono)', lineHeight: '1.5' },
  '.cm-content': { caretColor: 'var(--text)' },
  '.cm-gutters': { backgroundColor: 'var(--well)', color: 'var(--muted)', border: '0' },
  '.cm-activeLine': { backgroundColor: 'var(--raised)' },
  '.cm-activeLine.cm-line:not(:focus)': { backgroundColor: 'transparent' },
  '&.cm-focused .cm-activeLine': { backgroundColor: 'var(--raised)' },
  '.cm-lintRange-error': { backgroundImage: 'none', textDecoration: 'underline wavy var(--caution)', textUnderlineOffset: '3px' },
  '.cm-lint-marker-error': { content: 'none', width: '8px', height: '8px', borderRadius: '50%', background: 'var(--caution)', margin: '5px 0 0 2px' },
  '.cm-diagnostic-error': { borderLeftColor: 'var(--caution)' },
  '.cm-tooltip': { backgroundColor: 'var(--panel)', color: 'var(--text)', border: '1px solid var(--line-strong)', maxWidth: '420px' },
});

/**
 * Open an editor in an element. It stands in a shadow root: there its style sheet is adopted, where an element of styles
 * would be refused by the page's content security policy. Tab goes on to what follows, as everywhere on the page.
 */
export function openEditor(element: HTMLElement, language: Language, label: string, text: string, change: (text: string) => void): CodeEditor {
  const root = element.shadowRoot ?? element.attachShadow({ mode: 'open' });
  const locking = new Compartment();
  const view = new EditorView({
    root,
    parent: root,
    state: EditorState.create({
      doc: text,
      extensions: [
        lineNumbers(),
        lintGutter(),
        history(),
        bracketMatching(),
        highlightActiveLine(),
        indentUnit.of('  '),
        keymap.of([{ key: 'F8', run: nextDiagnostic }, ...defaultKeymap, ...historyKeymap]),
        language === 'toml' ? StreamLanguage.define(toml) : json(),
        syntaxHighlighting(colours),
        look,
        // What can be edited has the focus without a tabindex; axe-core looks for one.
        EditorView.contentAttributes.of({ 'aria-label': label, tabindex: '0', spellcheck: 'false', autocapitalize: 'off', autocorrect: 'off' }),
        locking.of(EditorState.readOnly.of(false)),
        EditorView.updateListener.of((update) => {
          if (update.docChanged && !update.transactions.some((one) => one.annotation(FROM_OUTSIDE))) change(update.state.doc.toString());
        }),
      ],
    }),
  });

  const places = language === 'toml' ? tomlPlaces : jsonPlaces;
  return {
    take(next) {
      const before = view.state.doc.toString();
      if (next === before) return;
      view.dispatch({ changes: difference(before, next), annotations: FROM_OUTSIDE.of(true) });
    },
    show(problems, of) {
      const present = view.state.doc.toString();
      const find = places(of);
      const size = view.state.doc.length;
      const found = problems.map((problem) => ({ problem, place: find(problem.path) ?? (problem.path.length === 0 ? namedPlace(of, problem.text) : null) }));
      const diagnostics = found.flatMap(({ problem, place }): Diagnostic[] =>
        place === null || of !== present ? [] : [{ from: Math.min(place.at, size), to: Math.min(place.end, size), severity: 'error', message: problem.text }],
      );
      if (of === present) view.dispatch(setDiagnostics(view.state, diagnostics));
      return found.map(({ problem, place }) => ({ text: problem.text, line: place === null ? null : of.slice(0, place.at).split('\n').length }));
    },
    go(line) {
      const { from } = view.state.doc.line(Math.min(line, view.state.doc.lines));
      view.dispatch({ selection: { anchor: from }, effects: EditorView.scrollIntoView(from, { y: 'center' }) });
      view.focus();
    },
    lock(locked) {
      view.dispatch({ effects: locking.reconfigure(EditorState.readOnly.of(locked)) });
    },
    close: () => view.destroy(),
  };
}

/** The change from one text to another that leaves alone what is the same before and after, and the cursor with it. */
function difference(before: string, after: string): { from: number; to: number; insert: string } {
  const most = Math.min(before.length, after.length);
  let from = 0;
  while (from < most && before[from] === after[from]) from += 1;
  let same = 0;
  while (same < most - from && before[before.length - 1 - same] === after[after.length - 1 - same]) same += 1;
  return { from, to: before.length - same, insert: after.slice(from, after.length - same) };
}
