// Speaks the workbench's protocol with a simulated campaign: node mock_server.mjs PAGE.html [CAMPAIGN.toml] [--readings N] [--port P]
import { randomBytes } from 'node:crypto';
import { readFileSync, watchFile } from 'node:fs';
import { createServer } from 'node:http';
import { parseArgs } from 'node:util';
import { Session } from './mock_session.mjs';

const { values, positionals } = parseArgs({ options: { readings: { type: 'string', default: '6048' }, port: { type: 'string', default: '0' } }, allowPositionals: true });
const [page, campaign] = positionals;
const token = randomBytes(16).toString('hex');
const lines = new Map();
const session = new Session({ readings: Number(values.readings), campaign, tell: (name, data) => { for (const [tab, line] of lines) send(line, name, name === 'state' ? session.state(tab) : data); } });

const send = (line, name, data) => line.write(`event: ${name}\ndata: ${JSON.stringify(data)}\n\n`);

async function bodyOf(request) {
  const parts = [];
  for await (const part of request) parts.push(part);
  return JSON.parse(Buffer.concat(parts).toString() || '{}');
}

function events(tab, response) {
  response.writeHead(200, { 'Content-Type': 'text/event-stream', 'Cache-Control': 'no-store' });
  response.write(': here\n\n');
  lines.set(tab, response);
  session.connected(tab);
  const beat = setInterval(() => response.write(': here\n\n'), 2000);
  response.on('close', () => {
    clearInterval(beat);
    lines.delete(tab);
    session.left(tab);
  });
}

function answer(response, result) {
  if (result instanceof Uint8Array) response.writeHead(200, { 'Content-Type': 'application/octet-stream' }).end(Buffer.from(result.buffer, result.byteOffset, result.byteLength));
  else response.writeHead(200, { 'Content-Type': 'application/json' }).end(JSON.stringify(result));
}

async function api(name, request, response) {
  const tab = request.headers['x-volcal-tab'];
  if (request.headers['x-volcal-token'] !== token) return response.writeHead(403, { 'Content-Type': 'application/json' }).end(JSON.stringify({ error: 'wrong token' }));
  if (name === 'events') return events(tab, response);
  try {
    answer(response, session.answer(name, await bodyOf(request), tab));
    if (name === 'quit') setTimeout(() => process.exit(0), 50);
  } catch (error) {
    if (!error.status && !error.column) console.error(error);
    response.writeHead(error.status ?? 400, { 'Content-Type': 'application/json' }).end(JSON.stringify({ error: error.message, remedy: error.remedy ?? null, column: error.column ?? null }));
  }
  return undefined;
}

const server = createServer((request, response) => {
  if (request.url === '/') {
    const html = readFileSync(page, 'utf8');
    const policy = html.match(/http-equiv="Content-Security-Policy" content="([^"]*)"/)[1];
    response.writeHead(200, { 'Content-Type': 'text/html; charset=utf-8', 'Content-Security-Policy': `${policy}; frame-ancestors 'none'` }).end(html);
  } else if (request.url.startsWith('/api/')) api(request.url.slice(5), request, response);
  else response.writeHead(404).end();
});
server.listen(Number(values.port), '127.0.0.1', () => console.log(`http://127.0.0.1:${server.address().port}/#${token}`));
if (campaign) watchFile(campaign, { interval: 200 }, () => session.read());
