// Drives headless Chromium over its debugging pipe (file descriptors 3 and 4): no network port, no package.
import { spawn } from 'node:child_process';
import { existsSync, mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

const FLAGS = ['--headless', '--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run', '--disable-background-networking',
  '--disable-component-update', '--disable-sync', '--disable-default-apps', '--disable-extensions', '--disable-dev-shm-usage',
  '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--hide-scrollbars', '--force-color-profile=srgb'];

export function findChromium() {
  const names = [process.env.CHROMIUM, '/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'];
  return names.find((name) => name && existsSync(name));
}

// Does not keep the program alive by itself.
const atMost = (ms) => new Promise((resolve) => setTimeout(resolve, ms).unref());

// The browser and its helpers.
function killGroup(pid) {
  try {
    process.kill(-pid, 'SIGKILL');
  } catch (error) {
    if (error.code !== 'ESRCH') throw error;
  }
}

// A helper that dies later than the browser may still write into the folder. The retries of rmSync list a folder once
// and would never see what came since, so each attempt here lists it anew. A folder left behind falsifies nothing that
// the page has shown: no error.
async function removeFolder(path) {
  for (let attempt = 0; attempt < 100; ++attempt) {
    try {
      rmSync(path, { recursive: true, force: true });
      return;
    } catch {
      await new Promise((resolve) => setTimeout(resolve, 100));
    }
  }
}

// Opens a page; gives { send, on, close }. `send` is a method of the DevTools protocol on that page.
export async function openPage(executable, width, height) {
  const profile = mkdtempSync(join(tmpdir(), 'touchstone-chromium-'));
  const child = spawn(executable, [...FLAGS, '--remote-debugging-pipe', '--user-data-dir=' + profile, `--window-size=${width},${height}`, 'about:blank'],
    { stdio: ['ignore', 'ignore', 'ignore', 'pipe', 'pipe'], detached: true });
  const [, , , toBrowser, fromBrowser] = child.stdio;
  const waiting = new Map();
  const listeners = [];
  let next = 1;
  let buffered = [];
  let fail;
  const died = new Promise((_, reject) => { fail = reject; });
  died.catch(() => {});
  child.on('exit', (code) => fail(new Error('Chromium ended with status ' + code)));
  child.on('error', fail);
  toBrowser.on('error', fail);
  fromBrowser.on('data', (chunk) => {
    let start = 0;
    for (let end = chunk.indexOf(0); end >= 0; start = end + 1, end = chunk.indexOf(0, start)) {
      buffered.push(chunk.subarray(start, end));
      const message = JSON.parse(Buffer.concat(buffered).toString('utf8'));
      buffered = [];
      if (message.id && waiting.has(message.id)) {
        const { resolve, reject } = waiting.get(message.id);
        waiting.delete(message.id);
        if (message.error) reject(new Error(message.error.message));
        else resolve(message.result);
      } else {
        for (const listener of listeners) listener(message.method, message.params);
      }
    }
    buffered.push(chunk.subarray(start));
  });
  const raw = (method, params, sessionId) => {
    const id = next++;
    const answer = new Promise((resolve, reject) => waiting.set(id, { resolve, reject }));
    toBrowser.write(JSON.stringify({ id, method, params: params || {}, sessionId }) + '\0');
    return Promise.race([answer, died]);
  };
  const { targetInfos } = await raw('Target.getTargets');
  const page = targetInfos.find((target) => target.type === 'page');
  const { sessionId } = await raw('Target.attachToTarget', { targetId: page.targetId, flatten: true });
  return {
    send: (method, params) => raw(method, params, sessionId),
    on: (listener) => listeners.push(listener),
    close: async () => {
      const gone = new Promise((resolve) => (child.exitCode === null && child.signalCode === null ? child.on('exit', resolve) : resolve()));
      raw('Browser.close').catch(() => {});
      await Promise.race([gone, atMost(5000)]);
      killGroup(child.pid);
      await gone;
      await removeFolder(profile);
    },
  };
}

// The value of an expression in the page; promises are awaited.
export async function evaluate(page, expression) {
  const { result, exceptionDetails } = await page.send('Runtime.evaluate', { expression, awaitPromise: true, returnByValue: true });
  if (exceptionDetails) throw new Error(exceptionDetails.exception?.description || exceptionDetails.text);
  return result.value;
}

// Loads a file and waits until the report in it has drawn everything.
export async function openReport(page, path, seconds) {
  await page.send('Page.enable');
  await page.send('Page.navigate', { url: 'file://' + encodeURI(path) });
  const end = Date.now() + seconds * 1000;
  for (;;) {
    if (await evaluate(page, '!!(window.touchstoneReport && window.touchstoneReport.ready)').catch(() => false)) return;
    if (Date.now() > end) throw new Error(`the report was not drawn within ${seconds} s`);
    await new Promise((resolve) => setTimeout(resolve, 100));
  }
}
