// usage: node screenshot.mjs REPORT.html OUT.png [WIDTH] [SELECTOR]: the whole report, or one element of it, as a picture.
import { existsSync, writeFileSync } from 'node:fs';
import { resolve } from 'node:path';
import { evaluate, findChromium, openPage, openReport } from './chromium.mjs';

const [report, out, width = '1280', selector] = process.argv.slice(2);
if (!report || !out) {
  console.error('usage: node screenshot.mjs REPORT.html OUT.png [WIDTH] [SELECTOR]');
  process.exit(2);
}
if (!existsSync(report)) {
  console.error(`${report}: there is no such file`);
  process.exit(3);
}
const executable = findChromium();
if (!executable) {
  console.error('Chromium was not found; install it or name it in the environment variable CHROMIUM');
  process.exit(77);
}
const page = await openPage(executable, Number(width), 900);
try {
  await openReport(page, resolve(report), 120);
  const clip = await evaluate(page, `(() => {
    const box = ${selector ? `document.querySelector(${JSON.stringify(selector)}).getBoundingClientRect()` : 'document.documentElement.getBoundingClientRect()'};
    return { x: box.left + scrollX, y: box.top + scrollY, width: box.width, height: Math.max(box.height, 1), scale: 1 };
  })()`);
  const { data } = await page.send('Page.captureScreenshot', { format: 'png', clip, captureBeyondViewport: true });
  writeFileSync(out, Buffer.from(data, 'base64'));
} finally {
  await page.close();
}
