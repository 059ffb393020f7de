// usage: node check_site.mjs INDEX.html WIDTH [SHOT.png]: opens the site as a reader would on a screen of that width and
// prints what a test must know, as JSON: what each picture draws, counted in pixels of a screenshot, whether anything is
// wider than the screen, whether a click on a head sorts, and what was requested.
import { writeFileSync } from 'node:fs';
import { resolve } from 'node:path';
import { evaluate, findChromium, openPage, openReport } from '../report/web/chromium.mjs';

const [index, width, shot] = process.argv.slice(2);
const executable = findChromium();
if (!executable) {
  console.error('Chromium was not found; install it or name it in the environment variable CHROMIUM');
  process.exit(77);
}
const page = await openPage(executable, Number(width), 900);
const seen = { requests: [], console: [] };
page.on((method, params) => {
  if (method === 'Network.requestWillBeSent') seen.requests.push(params.request.url.slice(0, 200));
  if (method === 'Runtime.exceptionThrown') seen.console.push(params.exceptionDetails.text);
  if (method === 'Log.entryAdded' && params.entry.level === 'error') seen.console.push(params.entry.text);
});
const picture = async (clip) => (await page.send('Page.captureScreenshot', { format: 'png', clip, captureBeyondViewport: true })).data;
try {
  for (const domain of ['Network', 'Runtime', 'Log']) await page.send(domain + '.enable');
  await page.send('Emulation.setDeviceMetricsOverride', { width: Number(width), height: 900, deviceScaleFactor: 1, mobile: false });
  await openReport(page, resolve(index), 60);
  seen.title = await evaluate(page, 'document.querySelector("h1").textContent');
  seen.widest = await evaluate(page, 'document.documentElement.scrollWidth');
  seen.injected = await evaluate(page, 'document.querySelectorAll("main img, main script, main iframe, td b").length + (window.stolen ? 1 : 0)');
  // Text of a picture that is cut off at its border, and heads that cannot be clicked.
  seen.cut = await evaluate(page, `[...document.querySelectorAll('svg.picture')].flatMap((svg) => {
    const box = svg.getBoundingClientRect();
    return [...svg.querySelectorAll('text')].filter((text) => {
      const own = text.getBoundingClientRect();
      return own.left < box.left - 1 || own.right > box.right + 1;
    }).map((text) => text.textContent);
  })`);
  seen.smallestText = await evaluate(page, `Math.min(...[...document.querySelectorAll('svg.picture text')].map((text) => text.getBoundingClientRect().height))`);
  seen.hiddenHeads = await evaluate(page, `[...document.querySelectorAll('th button')].filter((one) => one.getBoundingClientRect().height < 8).length`);
  seen.pictures = [];
  const boxes = await evaluate(page, `[...document.querySelectorAll('svg.picture')].map((svg) => {
    const box = svg.getBoundingClientRect();
    return { x: box.left + scrollX, y: box.top + scrollY, width: box.width, height: box.height, scale: 1 };
  })`);
  for (const clip of boxes) {
    const data = await picture(clip);
    // Of the dots' and intervals' blue, and of the ink of names: what is neither background nor grid.
    seen.pictures.push(await evaluate(page, `(async () => {
      const image = new Image();
      image.src = 'data:image/png;base64,${data}';
      await image.decode();
      const canvas = document.createElement('canvas');
      canvas.width = image.width;
      canvas.height = image.height;
      const context = canvas.getContext('2d');
      context.drawImage(image, 0, 0);
      const pixels = context.getImageData(0, 0, canvas.width, canvas.height).data;
      let blue = 0, ink = 0;
      for (let k = 0; k < pixels.length; k += 4) {
        const [r, g, b] = [pixels[k], pixels[k + 1], pixels[k + 2]];
        if (b - r > 60) ++blue;
        if (Math.max(r, g, b) < 110) ++ink;
      }
      return { width: canvas.width, height: canvas.height, blue, ink };
    })()`));
  }
  // The second click on a head turns the order round; rows that did not run stay last.
  seen.sorted = await evaluate(page, `(() => {
    const table = document.querySelector('section[id^=task] table');
    const order = () => [...table.tBodies[0].rows].map((row) => row.cells[1].textContent);
    const button = table.querySelectorAll('th button')[2];
    button.click();
    const up = order();
    button.click();
    return { up, down: order() };
  })()`);
  if (shot) {
    const all = await evaluate(page, '({ x: 0, y: 0, width: document.documentElement.scrollWidth, height: document.documentElement.scrollHeight, scale: 1 })');
    writeFileSync(shot, Buffer.from(await picture(all), 'base64'));
  }
  console.log(JSON.stringify(seen, null, 1));
} finally {
  await page.close();
}
