import { svelte } from '@sveltejs/vite-plugin-svelte';
import { defineConfig } from 'vitest/config';
import { precompress } from './precompress.ts';

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
  },
  server: { proxy: { '/api': { target: 'http://127.0.0.1:8000', ws: true } } },
  test: { include: ['tests/**/*.test.ts'], environment: 'node', pool: 'threads' },
});
