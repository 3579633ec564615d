/** Texts that a person reads or hears stand in src/texts, one module per page, not in the markup. */

/** Attributes and properties of components that a person reads or hears. */
const READ = new Set([
  'about', 'alt', 'aria-description', 'aria-label', 'aria-roledescription', 'aria-valuetext', 'caption', 'data-label', 'heading', 'hint', 'label',
  'legend', 'meaning', 'placeholder', 'problem', 'text', 'title', 'words', 'zero',
]);

const WORD = /\p{L}{2}/u;
/** Symbols of units, the same in every language. */
const UNITS = new Set(['Hz', 'ms']);

/** The literal texts that an expression may show: its own, and those of its branches and its template. */
function literals(expression) {
  switch (expression.type) {
    case 'Literal':
      return typeof expression.value === 'string' ? [expression] : [];
    case 'TemplateLiteral':
      return [...expression.quasis, ...expression.expressions.flatMap(literals)];
    case 'ConditionalExpression':
      return [expression.consequent, expression.alternate].flatMap(literals);
    case 'LogicalExpression':
    case 'BinaryExpression':
      return expression.operator === '+' || expression.type === 'LogicalExpression' ? [expression.left, expression.right].flatMap(literals) : [];
    default:
      return [];
  }
}

const words = (node) => (node.type === 'TemplateElement' ? node.value.cooked : String(node.value));

/** True where what stands directly in this node is code, for machines: an element of styles, of a script or of code. */
function isCode(node) {
  return ['SvelteStyleElement', 'SvelteScriptElement'].includes(node.type) || (node.type === 'SvelteElement' && node.name.name === 'code');
}

/** A sentence, or the part of one between its values: two words and more. */
const SENTENCE = /\p{L}[\p{L}’']+ \p{L}{2}/u;
/** Selectors, markup and functions of styles. */
const CODE = /[=[]|\w\(/;

/** True where a text below this node is for programs: of an error that is thrown, compared, or a type. */
const isForPrograms = (node) => ['NewExpression', 'BinaryExpression', 'TSLiteralType'].includes(node?.type) && node.operator !== '+';

/** For modules and scripts: a sentence belongs in src/texts, whatever it is used for. */
export const sentencesApart = {
  meta: { type: 'problem', messages: { sentence: '“{{ words }}” is a sentence: it belongs in src/texts.' }, schema: [] },
  create(context) {
    if (!/\/src\/(?!texts\/)/.test(context.filename)) return {};
    function check(node) {
      const text = words(node);
      if (SENTENCE.test(text) && !CODE.test(text)) context.report({ node, messageId: 'sentence', data: { words: text } });
    }
    return {
      Literal: (node) => typeof node.value !== 'string' || isForPrograms(node.parent) || check(node),
      TemplateElement: (node) => isForPrograms(node.parent.parent) || check(node),
    };
  },
};

export const textsApart = {
  meta: { type: 'problem', messages: { literal: '“{{ words }}” is read by people: it belongs in src/texts.' }, schema: [] },
  create(context) {
    if (!/\/src\/.*\.svelte$/.test(context.filename)) return {};
    function check(node) {
      const text = words(node).trim();
      if (WORD.test(text) && !UNITS.has(text)) context.report({ node, messageId: 'literal', data: { words: text } });
    }
    function checkAttribute(node) {
      if (!READ.has(node.key.name)) return;
      for (const value of node.value) {
        if (value.type === 'SvelteLiteral') check(value);
        else literals(value.expression).forEach(check);
      }
    }
    function checkExpression(node) {
      if (!['SvelteAttribute', 'SvelteStyleDirective'].includes(node.parent.type)) literals(node.expression).forEach(check);
    }
    return {
      SvelteText: (node) => isCode(node.parent) || check(node),
      SvelteAttribute: checkAttribute,
      SvelteMustacheTag: checkExpression,
    };
  },
};
