/**
 * `node generate.js [--check]`: writes src/generated/api.ts, the types of the HTTP interface, from the OpenAPI document
 * on standard input. With `--check` it only compares.
 */
import { readFileSync, writeFileSync } from 'node:fs';
import { text as read } from 'node:stream/consumers';
import openapi, { astToString } from 'openapi-typescript';

const OUTPUT = new URL('src/generated/api.ts', import.meta.url);
const HEADER = '// Written by `make generate` from the OpenAPI document of the server. Do not edit.\n\n';

/**
 * Remove what types nothing: titles, texts of operations (docs/reference/http.md has them), and refusals, which all are
 * a `Problem`. What only answers have is never left out; what only requests have may be left out where it has a default.
 */
function reduce({ paths, components }) {
  const [asked, answered] = [new Set(), new Set()];
  for (const operation of Object.values(paths).flatMap(Object.values)) {
    delete operation.summary;
    delete operation.description;
    operation.responses = Object.fromEntries(Object.entries(operation.responses).filter(([status]) => status.startsWith('2')));
    for (const response of Object.values(operation.responses)) response.description = '';
    collect(operation.requestBody ?? {}, components.schemas, asked);
    collect(operation.responses, components.schemas, answered);
  }
  for (const [name, schema] of Object.entries(components.schemas)) {
    const properties = schema.properties ?? {};
    if (!asked.has(name) && answered.has(name)) schema.required = Object.keys(properties);
    if (asked.has(name) && !answered.has(name)) for (const property of Object.values(properties)) delete property.default;
  }
}

/** Add the names of all schemas that a part of the document refers to, directly or through others. */
function collect(part, schemas, names) {
  for (const [key, value] of Object.entries(part)) {
    const name = key === '$ref' ? value.split('/').at(-1) : null;
    if (name !== null && !names.has(name)) collect(schemas[name], schemas, names.add(name));
    else if (typeof value === 'object' && value !== null) collect(value, schemas, names);
  }
}

/** Remove members that are `never` or `unknown`, but for those that refuse a query or a body where there is none. */
function prune(text) {
  return text
    .replace(/^ +(?:get|put|post|delete|options|head|patch|trace|header|path|cookie)\?: never;\n/gm, '')
    .replace(/^ +headers: \{\n +\[name: string\]: unknown;\n +\};\n/gm, '')
    .replace(/^ +parameters: \{\n +query\?: never;\n +\};\n(?= +\w+: operations)/gm, '')
    .replace(/(parameters|204): \{\s+(\w+\?: never);\s+\};/g, '$1: { $2 };')
    .replace(/^export type (?:webhooks|\$defs) = Record<string, never>;\n/gm, '');
}

const document = JSON.parse(await read(process.stdin), (key, value) => (key === 'title' && typeof value === 'string' ? undefined : value));
reduce(document);
const types = await openapi(JSON.stringify(document), { rootTypes: true, rootTypesNoSchemaPrefix: true });
const text = HEADER + prune(astToString(types));

if (!process.argv.includes('--check')) {
  writeFileSync(OUTPUT, text);
} else if (readFileSync(OUTPUT, 'utf8') !== text) {
  process.stderr.write('api.ts is not current: run `make generate` and commit it\n');
  process.exitCode = 1;
}
