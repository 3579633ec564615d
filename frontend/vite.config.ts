import { svelte } from '@sveltejs/vite-plugin-svelte';
import { defineConfig } from 'vitest/config';
import { precompress } from './precompress.ts';

interface Modules {
  getModuleInfo(id: string): { readonly importedIds: readonly string[]; readonly isEntry: boolean; readonly importers: readonly string[] } | null;
}

/** Whether the entry imports it, at once or by others: what the first view needs. Many small files would compress worse. */
function isFirst(id: string, modules: Modules, seen = new Set<string>()): boolean {
  if (seen.has(id)) return false;
  seen.add(id);
  const info = modules.getModuleInfo(id);
  return info !== null && (info.isEntry || info.importers.some((importer) => isFirst(importer, modules, seen)));
}

export default defineConfig({
  plugins: [svelte(), precompress()],
  build: {
    outDir: '../server/page',
    emptyOutDir: true,
    target: 'es2022',
    // The page's content security policy has no room for data: addresses.
    assetsInlineLimit: 0,
    // Plotly, which only comm tests and comparisons fetch.
    chunkSizeWarningLimit: 1200,
    modulePreload: { polyfill: false },
    rolldownOptions: { output: { codeSplitting: { groups: [{ name: (id, modules) => (isFirst(id, modules) ? 'first' : null) }] } } },
  },
  server: { proxy: { '/api': { target: 'http://127.0.0.1:8000', ws: true } } },
  test: { include: ['tests/**/*.test.ts'], environment: 'node', pool: 'threads', setupFiles: ['tests/browser.ts'] },
});
