import {defineConfig} from 'vite';

// The page goes to build/web of the checkout, where the C++ build takes it from. No request may leave the machine, and
// the content security policy is default-src 'self': nothing is inlined, nothing is preloaded by script.
export default defineConfig({
  base: '/',
  build: {
    outDir: '../../build/web',
    emptyOutDir: true,
    target: 'es2020',
    assetsInlineLimit: 0,
    modulePreload: {polyfill: false},
    chunkSizeWarningLimit: 2000,
    rollupOptions: {output: {entryFileNames: 'page.js', chunkFileNames: '[name].js', assetFileNames: '[name][extname]'}},
  },
});
