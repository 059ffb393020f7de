// usage: node check_report.mjs REPORT.html: opens it as a reader would and prints what a test must know, as JSON.
import { resolve } from 'node:path';
import { evaluate, findChromium, openPage, openReport } from './chromium.mjs';

const executable = findChromium();
if (!executable) {
  console.error('Chromium was not found; install it or name it in the environment variable CHROMIUM');
  process.exit(77);
}
const page = await openPage(executable, 1280, 900);
const seen = { requests: [], console: [], dialogs: [] };
page.on((method, params) => {
  if (method === 'Network.requestWillBeSent') seen.requests.push(params.request.url.slice(0, 200));
  if (method === 'Runtime.consoleAPICalled' && ['error', 'assert'].includes(params.type)) {
    seen.console.push(params.type + ': ' + params.args.map((arg) => arg.value ?? arg.description).join(' '));
  }
  if (method === 'Runtime.exceptionThrown') seen.console.push('exception: ' + (params.exceptionDetails.exception?.description || params.exceptionDetails.text));
  if (method === 'Log.entryAdded' && params.entry.level === 'error') seen.console.push(params.entry.level + ': ' + params.entry.text);
  if (method === 'Page.javascriptDialogOpening') {
    seen.dialogs.push(params.message);
    page.send('Page.handleJavaScriptDialog', { accept: false });
  }
});
try {
  for (const domain of ['Network', 'Runtime', 'Log']) await page.send(domain + '.enable');
  await openReport(page, resolve(process.argv[2]), 120);
  seen.status = await evaluate(page, 'window.touchstoneReport');
  seen.title = await evaluate(page, 'document.querySelector("h1").textContent');
  seen.stolen = await evaluate(page, 'String(window.stolen)');
  seen.injected = await evaluate(page, 'document.querySelectorAll("main img, main script, main iframe").length');
  // A line plot is drawn where every trace has a path with points.
  seen.plots = await evaluate(page, `[...document.querySelectorAll('.plot')].map((plot) => ({
    kind: plot.dataset.kind, width: plot.getBoundingClientRect().width,
    traces: plot.data ? plot.data.length : 0,
    paths: [...plot.querySelectorAll('.scatterlayer path.js-line')].filter((path) => (path.getAttribute('d') || '').length > 10).length,
  }))`);
  // Maps by their cells: how many are known and not, how many colours, and whether a cell lies outside the picture.
  seen.maps = await evaluate(page, `[...document.querySelectorAll('svg.cells')].map((map) => {
    const frame = map.getBoundingClientRect();
    const cells = [...map.querySelectorAll('polygon')];
    return {
      known: cells.filter((cell) => cell.classList.contains('known')).length, unknown: cells.filter((cell) => cell.classList.contains('unknown')).length,
      colours: new Set(cells.map((cell) => cell.getAttribute('fill'))).size, titles: cells.filter((cell) => cell.textContent.length > 0).length,
      figures: map.querySelectorAll('.figure').length, label: map.getAttribute('aria-label'),
      outside: cells.filter((cell) => { const box = cell.getBoundingClientRect(); return box.left < frame.left - 1 || box.right > frame.right + 1 || box.top < frame.top - 1 || box.bottom > frame.bottom + 1; }).length,
    };
  })`);
  // What runs off the page where it is narrow.
  seen.wider_than_page = {};
  for (const width of [1100, 390]) {
    await page.send('Emulation.setDeviceMetricsOverride', { width, height: 900, deviceScaleFactor: 1, mobile: width < 500 });
    seen.wider_than_page[width] = await evaluate(page, `(async () => {
      for (const folded of document.querySelectorAll('details')) folded.open = true;
      for (const plot of document.querySelectorAll('.js-plotly-plot')) await Plotly.Plots.resize(plot);
      return [...document.querySelectorAll('.scroll')].filter((one) => one.scrollWidth > one.clientWidth + 1).map((one) => one.querySelector('th').textContent + ': ' + one.scrollWidth)
        .concat(document.documentElement.scrollWidth > ${width} ? ['page: ' + document.documentElement.scrollWidth] : []);
    })()`);
  }
  await page.send('Emulation.clearDeviceMetricsOverride');
  // The 3-D view as it looks: how many colours, and how much of it is not the background.
  seen.scenes = [];
  const count = await evaluate(page, 'document.querySelectorAll(".plot[data-kind=scene]").length');
  for (let i = 0; i < count; ++i) {
    seen.scenes.push(await evaluate(page, `(async () => {
      const plot = document.querySelectorAll('.plot[data-kind=scene]')[${i}];
      const url = await Plotly.toImage(plot, { format: 'png', width: 600, height: 400 });
      const image = new Image();
      image.src = url;
      await image.decode();
      const canvas = document.createElement('canvas');
      canvas.width = 600;
      canvas.height = 400;
      const context = canvas.getContext('2d');
      context.drawImage(image, 0, 0);
      const pixels = context.getImageData(0, 0, 600, 400).data;
      const colours = new Set();
      let coloured = 0;
      for (let k = 0; k < pixels.length; k += 4) {
        const [r, g, b, a] = [pixels[k], pixels[k + 1], pixels[k + 2], pixels[k + 3]];
        if (a > 0 && Math.max(r, g, b) - Math.min(r, g, b) > 40) { coloured += 1; colours.add((r >> 3) << 10 | (g >> 3) << 5 | (b >> 3)); }
      }
      return { coloured: coloured / (600 * 400), colours: colours.size };
    })()`));
  }
  console.log(JSON.stringify(seen, null, 1));
} finally {
  await page.close();
}
