/**
 * typescript-eslint's parser with one TypeScript program for all files.
 *
 * TypeScript cannot read components. The rules see TypeScript that svelte-eslint-parser writes for each of them. By
 * itself typescript-eslint learns of it when the component is linted, and each time makes a new program with all
 * types anew. Here the program has it from the start. A file that is not in the program, or has another text there
 * (in an editor), is parsed by typescript-eslint's project service.
 */
import { readFileSync } from 'node:fs';
import { dirname } from 'node:path';
import { parseForESLint as parseSvelte } from 'svelte-eslint-parser';
import typescript from 'typescript';
import ts from 'typescript-eslint';
import svelteConfig from '../svelte.config.js';

const CONFIG = new URL('../tsconfig.json', import.meta.url).pathname;
const TRANSLATED = /\.svelte(\.ts)?$/;
let program;

class Found extends Error {
  constructor(code) {
    super();
    this.code = code;
  }
}

function isTyped(options) {
  return Boolean(options?.projectService);
}

/** The TypeScript that the rules see in place of a component. */
function translate(path) {
  const parser = {
    ...ts.parser,
    parseForESLint(code, options) {
      if (isTyped(options)) throw new Found(code);
      return ts.parser.parseForESLint(code, options);
    },
  };
  const text = readFileSync(path, 'utf8');
  try {
    parseSvelte(text, { filePath: path, parser, svelteConfig, projectService: true });
  } catch (error) {
    if (error instanceof Found) return error.code;
    // Linting the component reports the error.
  }
  return text;
}

function createProgram() {
  const { config } = typescript.readConfigFile(CONFIG, typescript.sys.readFile);
  const extra = [{ extension: '.svelte', isMixedContent: true, scriptKind: typescript.ScriptKind.Deferred }];
  const { fileNames, options } = typescript.parseJsonConfigFileContent(
    config,
    typescript.sys,
    dirname(CONFIG),
    undefined,
    CONFIG,
    undefined,
    extra,
  );
  const host = typescript.createCompilerHost(options, true);
  const read = host.readFile;
  host.readFile = (path) => (TRANSLATED.test(path) ? translate(path) : read(path));
  return typescript.createProgram(fileNames, { ...options, allowNonTsExtensions: true }, host);
}

export const parser = {
  ...ts.parser,
  parseForESLint(code, options) {
    if (isTyped(options)) {
      program ??= createProgram();
      if (program.getSourceFile(options.filePath)?.text === code) {
        return ts.parser.parseForESLint(code, { ...options, projectService: undefined, programs: [program] });
      }
    }
    return ts.parser.parseForESLint(code, options);
  },
};
