// Bundles a page into one HTML file: node build.mjs NODE_MODULES OUTPUT [--page report|workbench]
import { createHash } from 'node:crypto';
import { readFile, writeFile } from 'node:fs/promises';
import { createRequire } from 'node:module';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';
import { addressesIn, offline, withoutAddresses } from './library.mjs';

const { values, positionals } = parseArgs({ options: { page: { type: 'string', default: 'report' } }, allowPositionals: true });
const [modules, output] = positionals.map((argument) => path.resolve(argument));
const here = path.dirname(fileURLToPath(import.meta.url));
const report = path.join(here, 'src');
const workbench = path.join(here, '../../workbench/web/src');
const requireFrom = createRequire(path.join(modules, 'package.json'));
const esbuild = requireFrom('esbuild');

// No text inside a script element may close it.
const forScript = (text) => text.replaceAll('</script', '<\\/script');

const styles = async (...files) => (await Promise.all(files.map((file) => readFile(file, 'utf8')))).join('\n');
const library = async () => forScript(offline(await readFile(requireFrom.resolve('plotly.js-gl3d-dist-min'), 'utf8')));

async function code(entry, target) {
  const bundle = await esbuild.build({
    entryPoints: [entry], bundle: true, minify: true, write: false, format: 'iife', target, charset: 'utf8', nodePaths: [modules], jsx: 'automatic', jsxImportSource: 'preact',
  });
  return forScript(bundle.outputFiles[0].text);
}

const asElement = (text) => `\n${text}\n`;
const hashOf = (text) => `'sha256-${createHash('sha256').update(text).digest('base64')}'`;

const pages = {
  report: async () => ({
    template: path.join(report, 'template.html'),
    parts: {
      STYLE: await styles(path.join(report, 'theme.css'), path.join(report, 'report.css')),
      LIBRARY: await library(),
      CODE: await code(path.join(report, 'main.js'), 'es2020'),
    },
    slots: ['@VOLCAL_REPORT_TITLE@', '@VOLCAL_REPORT_DATA@'],
  }),
  // Its policy names its two scripts by their hashes, so that no other script runs.
  workbench: async () => {
    const scripts = { LIBRARY: asElement(await library()), CODE: asElement(withoutAddresses(await code(path.join(workbench, 'main.jsx'), 'es2022'))) };
    return {
      template: path.join(workbench, 'template.html'),
      parts: { STYLE: await styles(path.join(report, 'theme.css'), path.join(workbench, 'workbench.css')), ...scripts, HASHES: Object.values(scripts).map(hashOf).join(' ') },
      slots: [],
    };
  },
};

if (!(values.page in pages)) throw new Error(`no page is called ${values.page}: one of ${Object.keys(pages).join(', ')}`);
const { template, parts, slots } = await pages[values.page]();
let page = await readFile(template, 'utf8');
for (const [name, content] of Object.entries(parts)) {
  page = page.replace(`@VOLCAL_REPORT_${name}@`, () => content);
}
for (const slot of slots) {
  if (page.split(slot).length !== 2) throw new Error(`the page must hold ${slot} once`);
}
const addresses = addressesIn(page);
if (addresses.length > 0) throw new Error(`the page names addresses: ${addresses.join(', ')}`);
await writeFile(output, page);
