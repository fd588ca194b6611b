// Bundles the report's page into one HTML file: node build.mjs NODE_MODULES OUTPUT
import { readFile, writeFile } from 'node:fs/promises';
import { createRequire } from 'node:module';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { addressesIn, offline } from './library.mjs';

const [modules, output] = process.argv.slice(2).map((argument) => path.resolve(argument));
const source = path.join(path.dirname(fileURLToPath(import.meta.url)), 'src');
const requireFrom = createRequire(path.join(modules, 'package.json'));
const esbuild = requireFrom('esbuild');

// No text inside a script element may close it.
const forScript = (text) => text.replaceAll('</script', '<\\/script');

const bundle = await esbuild.build({
  entryPoints: [path.join(source, 'main.js')],
  bundle: true,
  minify: true,
  write: false,
  format: 'iife',
  target: 'es2020',
  charset: 'utf8',
});
const parts = {
  STYLE: await readFile(path.join(source, 'report.css'), 'utf8'),
  LIBRARY: forScript(offline(await readFile(requireFrom.resolve('plotly.js-gl3d-dist-min'), 'utf8'))),
  CODE: forScript(bundle.outputFiles[0].text),
};

let page = await readFile(path.join(source, 'template.html'), 'utf8');
for (const [name, content] of Object.entries(parts)) {
  page = page.replace(`@VOLCAL_REPORT_${name}@`, () => content);
}
for (const slot of ['@VOLCAL_REPORT_TITLE@', '@VOLCAL_REPORT_DATA@']) {
  if (page.split(slot).length !== 2) throw new Error(`the page must hold ${slot} once`);
}
const addresses = addressesIn(page);
if (addresses.length > 0) throw new Error(`the page names addresses: ${addresses.join(', ')}`);
await writeFile(output, page);
