// The program that is looked at, and the browser that looks.
import { spawn } from 'node:child_process';
import { createRequire } from 'node:module';
import path from 'node:path';

const kFlags = ['--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run', '--disable-background-networking', '--disable-component-update', '--disable-sync'];
const kStart = 120_000; // ms

/** Starts `command` and waits for the address that it prints. */
export function start(command, args) {
  const child = spawn(command, args, { stdio: ['ignore', 'pipe', 'pipe'] });
  let text = '';
  const url = new Promise((resolve, reject) => {
    const timer = setTimeout(() => reject(new Error(`${command} prints no address: ${text}`)), kStart);
    const read = (part) => {
      text += part;
      const [address] = text.match(/http:\/\/127\.0\.0\.1:\d+\/#\S+/) ?? [];
      if (!address) return;
      clearTimeout(timer);
      resolve(address);
    };
    child.stdout.on('data', read);
    child.stderr.on('data', read);
    child.on('exit', (code) => reject(new Error(`${command} ends with ${code}: ${text}`)));
  });
  return { child, url, text: () => text };
}

export function browserOf(modules) {
  const requireFrom = createRequire(path.join(path.resolve(modules), 'package.json'));
  return { launch: (executablePath) => requireFrom('playwright-core').chromium.launch({ executablePath, args: kFlags }), axe: requireFrom.resolve('axe-core/axe.min.js') };
}

/** A page of which every fault is kept: exceptions, errors on the console, requests to anywhere but the program. */
export async function open(browser, url, { width, height, scheme = 'light', motion = 'no-preference' }, fault) {
  const context = await browser.newContext({ viewport: { width, height }, colorScheme: scheme, reducedMotion: motion, permissions: ['clipboard-write', 'clipboard-read'] });
  const page = await context.newPage();
  const home = new URL(url).host;
  const quiet = { on: false }; // while the program is away, the browser itself says that it is
  page.on('pageerror', (error) => fault(`the page throws: ${error.message}`));
  page.on('console', (message) => { if (message.type() === 'error' && !quiet.on && !/status of [45]\d\d/.test(message.text())) fault(`the page says: ${message.text()}`); });
  page.on('response', async (response) => { if (response.status() >= 500) fault(`${response.url()} answers ${response.status()}: ${await response.text().catch(() => '')}, asked ${response.request().postData()}`); });
  page.on('request', (request) => { if (!request.url().startsWith(`http://${home}/`) && !/^(data|blob):/.test(request.url())) fault(`the page asks for ${request.url()}`); });
  await page.goto(url, { timeout: kStart });
  return { context, page, quiet };
}
