import js from '@eslint/js';
import svelte from 'eslint-plugin-svelte';
import globals from 'globals';
import ts from 'typescript-eslint';
import { house } from './eslint/house.js';
import { parser } from './eslint/one_program.js';
import svelteConfig from './svelte.config.js';

export default ts.config(
  { ignores: ['src/generated/**', 'node_modules/**'] },
  js.configs.recommended,
  ts.configs.strictTypeChecked,
  ts.configs.stylisticTypeChecked,
  { languageOptions: { parser } },
  svelte.configs.recommended,
  {
    languageOptions: {
      globals: { ...globals.browser },
      parserOptions: {
        projectService: { allowDefaultProject: ['*.js', 'eslint/*.js'] },
        extraFileExtensions: ['.svelte'],
      },
    },
    plugins: { house },
    rules: {
      'house/rooms': 'error',
      'house/number-input': 'error',
      'house/component-once': 'error',
      'house/texts-apart': 'error',
      'house/sentences-apart': 'error',
      eqeqeq: 'error',
      'no-console': 'error',
      // `void signal` is how an effect depends on a signal that it does not use.
      '@typescript-eslint/no-meaningless-void-operator': 'off',
      '@typescript-eslint/restrict-template-expressions': ['error', { allowNumber: true }],
      '@typescript-eslint/no-confusing-void-expression': ['error', { ignoreArrowShorthand: true }],
    },
  },
  {
    files: ['**/*.svelte', '**/*.svelte.ts'],
    languageOptions: { parserOptions: { parser, svelteConfig } },
  },
  { files: ['*.js', 'eslint/*.js'], extends: [ts.configs.disableTypeChecked], languageOptions: { globals: { ...globals.node } } },
);
