// The packages of a lock file that fit this machine, for machines without npm: node report_packages.mjs LOCK
// One a line: folder, address, SHA-512 in hexadecimal.
import { readFileSync } from 'node:fs';

const registry = (process.env.npm_config_registry ?? 'https://registry.npmjs.org').replace(/\/$/, '');
const { packages } = JSON.parse(readFileSync(process.argv[2], 'utf8'));
for (const [folder, { version, integrity, os, cpu }] of Object.entries(packages)) {
  if (folder === '' || (os && !os.includes(process.platform)) || (cpu && !cpu.includes(process.arch))) continue;
  const name = folder.replace(/^.*node_modules\//, '');
  const [, hash] = integrity.match(/^sha512-(.+)$/);
  const file = `${name.replace(/^.*\//, '')}-${version}.tgz`;
  console.log(`${folder} ${registry}/${name}/-/${file} ${Buffer.from(hash, 'base64').toString('hex')}`);
}
