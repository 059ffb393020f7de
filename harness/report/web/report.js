// Draws a report from the JSON document in the page. Text from input files reaches the page by textContent only, and
// plot labels with the characters of markup replaced: nothing in the data is ever read as HTML.
'use strict';
(function () {
  const TONES = {
    measured: '#0072B2', rendered: '#D55E00', error: '#8F2D6B', reference: '#7A8794',
    good: '#009E73', warning: '#E69F00', neutral: '#33414F',
  };
  // Viridis (van der Walt and Smith 2015): even steps of lightness, readable without colour vision and in print.
  const SCALE = ['#440154', '#482878', '#3e4a89', '#31688e', '#26828e', '#1f9e89', '#35b779', '#6ece58', '#b5de2b', '#fde725'];
  const UNTOUCHED = 'rgb(205,211,217)';
  const FONT = { family: 'system-ui, -apple-system, "Segoe UI", Roboto, "DejaVu Sans", sans-serif', size: 12.5, color: '#33414F' };

  const status = { blocks: 0, plots: 0, drawn: 0, ready: false, failures: [] };
  window.touchstoneReport = status;
  const groups = new Map();  // link group -> plots that zoom together
  const pending = [];        // plots, drawn one after the other so that the page answers meanwhile

  function element(tag, attributes, ...children) {
    const made = document.createElement(tag);
    for (const [key, value] of Object.entries(attributes || {})) {
      if (value !== '' && value !== undefined && value !== null) made.setAttribute(key, value);
    }
    for (const child of children) {
      if (child === null || child === undefined || child === '') continue;
      made.append(typeof child === 'string' ? document.createTextNode(child) : child);
    }
    return made;
  }

  // Plotly reads a small markup in labels.
  const plain = (text) => String(text).replace(/&/g, '&amp;').replace(/</g, '&lt;').replace(/>/g, '&gt;');

  function axis(label, extra) {
    return Object.assign({
      title: { text: plain(label), standoff: 8, font: { size: 12.5 } }, gridcolor: '#e6eaee', zerolinecolor: '#b8c1ca',
      linecolor: '#b8c1ca', ticks: 'outside', tickcolor: '#b8c1ca', ticklen: 4, automargin: true, exponentformat: 'power',
    }, extra);
  }

  const LOG = { type: 'log', dtick: 'D2' };

  function layoutOf(block, extra) {
    return Object.assign({
      height: block.height, margin: { l: 64, r: 14, t: 8, b: 44 }, font: FONT, paper_bgcolor: '#fff', plot_bgcolor: '#fff',
      hovermode: 'x', hoverlabel: { font: { size: 12.5 } }, dragmode: 'zoom',
      legend: { orientation: 'h', x: 0, y: 1.02, yanchor: 'bottom', font: { size: 12.5 } },
      xaxis: axis(block.x_label), yaxis: axis(block.y_label),
    }, extra);
  }

  // Only what works offline and means something here.
  const config = (...buttons) => ({ responsive: true, displaylogo: false, showTips: false, displayModeBar: 'hover', modeBarButtons: [buttons] });
  const CONFIG = config('zoom2d', 'pan2d', 'resetScale2d', 'toImage');
  const CONFIG_3D = config('orbitRotation', 'tableRotation', 'pan3d', 'resetCameraDefault3d', 'toImage');

  function link(group, plot) {
    if (!group) return;
    if (!groups.has(group)) groups.set(group, []);
    const members = groups.get(group);
    members.push(plot);
    plot.on('plotly_relayout', (change) => {
      if (plot.following) return;
      if (change['xaxis.autorange']) follow(members, plot, { 'xaxis.autorange': true });
      else if (change['xaxis.range[0]'] !== undefined) {
        follow(members, plot, { 'xaxis.range': [change['xaxis.range[0]'], change['xaxis.range[1]']] });
      }
    });
  }

  function follow(members, except, change) {
    for (const other of members) {
      if (other === except) continue;
      other.following = true;
      Plotly.relayout(other, Object.assign({}, change)).finally(() => { other.following = false; });
    }
  }

  function zoomTo(group, range) {
    const members = groups.get(group) || [];
    follow(members, null, { 'xaxis.range': range });
    if (members.length) members[0].scrollIntoView({ block: 'center', behavior: 'smooth' });
  }

  function drawLines(block, host) {
    const traces = block.lines.map((line) => ({
      type: 'scatter', mode: line.markers ? (line.x.length > 1 ? 'lines+markers' : 'markers') : 'lines', name: plain(line.name), x: line.x, y: line.y,
      line: { color: TONES[line.tone], width: 1.4, dash: line.dashed ? 'dot' : 'solid' }, marker: { color: TONES[line.tone], size: 6 },
      connectgaps: false,
    }));
    const shapes = block.bands.map(([from, to]) => ({
      type: 'rect', xref: 'x', yref: 'paper', x0: from, x1: to, y0: 0, y1: 1, fillcolor: '#56B4E9', opacity: 0.14, line: { width: 0 }, layer: 'below',
    }));
    const annotations = [];
    for (const level of block.levels) {
      shapes.push({ type: 'line', xref: 'paper', x0: 0, x1: 1, y0: level.value, y1: level.value, line: { color: TONES.reference, width: 1.2, dash: 'dash' } });
      annotations.push({
        xref: 'paper', x: 1, xanchor: 'right', y: block.log_y ? Math.log10(level.value) : level.value, yanchor: 'bottom', text: plain(level.label), showarrow: false,
        font: { size: 11.5, color: '#5b6875' }, bgcolor: 'rgba(255,255,255,0.75)',
      });
    }
    const named = block.lines.length > 1;
    const places = block.x_names.map((one) => one.at);
    // Half a place of room at either end, where names would not fit otherwise.
    const names = places.length ? {
      tickmode: 'array', tickvals: places, ticktext: block.x_names.map((one) => plain(one.name)),
      range: [Math.min(...places) - 0.5, Math.max(...places) + 0.5],
    } : {};
    return Plotly.newPlot(host, traces, layoutOf(block, {
      xaxis: axis(block.x_label, block.log_x ? LOG : names), yaxis: axis(block.y_label, block.log_y ? LOG : {}),
      shapes, annotations, showlegend: named, margin: { l: 64, r: 14, t: named ? 30 : 10, b: 44 },
    }), CONFIG).then(() => link(block.link, host));
  }

  // Bars as a filled outline of steps: the plotting bundle has no bar chart.
  function drawBars(block, host) {
    const x = [], y = [];
    const floor = block.log_y ? null : 0;
    block.heights.forEach((height, i) => {
      const left = block.first + i * block.width;
      const value = block.log_y && !(height > 0) ? 0.5 : height;
      x.push(left, left + block.width);
      y.push(value, value);
    });
    const trace = {
      type: 'scatter', mode: 'lines', x, y, fill: 'tozeroy', line: { color: TONES.error, width: 1 }, cliponaxis: false, fillcolor: 'rgba(143,45,107,0.28)',
      hovertemplate: '%{x:.4g}: %{y}<extra></extra>',
    };
    const top = Math.max(1, ...block.heights);
    const yaxis = axis(block.y_label, block.log_y ? { type: 'log', range: [Math.log10(0.5), Math.log10(top * 1.6)] } : { rangemode: 'tozero' });
    if (floor === null) yaxis.dtick = 1;
    return Plotly.newPlot(host, [trace], layoutOf(block, { yaxis, showlegend: false }), CONFIG);
  }

  function shade(fraction) {
    const at = Math.min(1, Math.max(0, fraction)) * (SCALE.length - 1);
    const low = Math.min(SCALE.length - 2, Math.floor(at));
    const part = at - low;
    const channel = (hex, i) => parseInt(hex.slice(1 + 2 * i, 3 + 2 * i), 16);
    const mix = [0, 1, 2].map((i) => Math.round(channel(SCALE[low], i) * (1 - part) + channel(SCALE[low + 1], i) * part));
    return 'rgb(' + mix.join(',') + ')';
  }

  const column = (flat, i) => { const out = []; for (let k = i; k < flat.length; k += 3) out.push(flat[k]); return out; };

  function drawScene(block, host) {
    let top = 0;
    for (const value of block.values) if (value !== null && value > top) top = value;
    const colours = block.values.map((value) => (value === null ? UNTOUCHED : shade(top > 0 ? value / top : 0)));
    const traces = [{
      type: 'mesh3d', name: 'object', x: column(block.vertices, 0), y: column(block.vertices, 1), z: column(block.vertices, 2),
      i: column(block.triangles, 0), j: column(block.triangles, 1), k: column(block.triangles, 2), vertexcolor: colours,
      lighting: { ambient: 0.68, diffuse: 0.5, specular: 0.08, roughness: 0.9, fresnel: 0.05 },
      lightposition: { x: 2e4, y: -4e4, z: 6e4 }, flatshading: false,
      text: block.values.map((value) => (value === null ? 'not touched' : plain(block.value_label) + ': ' + value.toPrecision(3))),
      hovertemplate: '%{text}<extra></extra>', showlegend: true,
    }];
    // Carries the colour scale only.
    if (block.vertices.length >= 3 && top > 0) {
      traces.push({
        type: 'scatter3d', mode: 'markers', x: [block.vertices[0]], y: [block.vertices[1]], z: [block.vertices[2]], hoverinfo: 'skip', showlegend: false,
        marker: {
          size: 0.001, opacity: 0, color: [0], cmin: 0, cmax: top, colorscale: SCALE.map((colour, i) => [i / (SCALE.length - 1), colour]), showscale: true,
          colorbar: { title: { text: plain(block.value_label), side: 'right', font: { size: 12.5 } }, thickness: 14, len: 0.75, outlinewidth: 0, tickfont: { size: 12 } },
        },
      });
    }
    for (const path of block.paths) {
      traces.push({
        type: 'scatter3d', mode: 'lines', name: plain(path.name), x: column(path.points, 0), y: column(path.points, 1), z: column(path.points, 2),
        line: { color: TONES[path.tone], width: 2.5 }, hoverinfo: 'skip',
      });
    }
    if (block.marks.length) {
      traces.push({
        type: 'scatter3d', mode: 'markers', name: 'worst places', x: block.marks.map((mark) => mark.p[0]), y: block.marks.map((mark) => mark.p[1]),
        z: block.marks.map((mark) => mark.p[2]), text: block.marks.map((mark) => plain(mark.label)), hovertemplate: '%{text}<extra></extra>',
        marker: { size: 5, color: '#D55E00', line: { color: '#fff', width: 1.5 }, symbol: 'diamond' },
      });
    }
    const side = (name) => ({ title: { text: name + ' [' + plain(block.unit) + ']' }, backgroundcolor: '#fff', gridcolor: '#e6eaee', zerolinecolor: '#d4dae0', showspikes: false });
    return Plotly.newPlot(host, traces, {
      height: block.height, margin: { l: 0, r: 0, t: 8, b: 0 }, font: FONT, paper_bgcolor: '#fff',
      legend: { orientation: 'h', x: 0, y: 1, yanchor: 'bottom' },
      scene: { aspectmode: 'data', xaxis: side('x'), yaxis: side('y'), zaxis: side('z'), camera: { eye: { x: 1.15, y: -1.35, z: 0.95 } } },
    }, CONFIG_3D);
  }

  function plotBlock(block, draw) {
    const host = element('div', { class: 'plot', 'data-kind': block.kind, style: 'min-height:' + Number(block.height) + 'px' });
    status.plots += 1;
    pending.push({ block, host, draw });
    return [element('h3', {}, block.title), host, block.note ? element('div', { class: 'plot-note' }, block.note) : null];
  }

  function drawn(tag, attributes, ...children) {
    const made = document.createElementNS('http://www.w3.org/2000/svg', tag);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    for (const child of children) if (child) made.append(child);
    return made;
  }

  // Blue over white to vermilion (Okabe and Ito), the same lightness on both sides.
  function diverging(fraction) {
    const end = fraction < 0 ? [0, 114, 178] : [213, 94, 0];
    const share = Math.min(1, Math.abs(fraction));
    return 'rgb(' + end.map((channel) => Math.round(255 + share * (channel - 255))).join(',') + ')';
  }

  // A flat map as a picture of its own, so that it is there without the plotting library too.
  function cellsBlock(block) {
    status.plots += 1;
    const xs = block.cells.flatMap((cell) => cell.corners.map((corner) => corner[0]));
    const ys = block.cells.flatMap((cell) => cell.corners.map((corner) => corner[1]));
    const [left, right, low, high] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
    const scale = Math.min(440 / (right - left), 440 / (high - low));
    const [wide, tall] = [Math.max(190, scale * (right - left)), scale * (high - low)];
    const place = ([x, y]) => [62 + scale * (x - left), 10 + scale * (high - y)];
    const svg = drawn('svg', { class: 'cells', viewBox: '0 0 ' + (wide + 76) + ' ' + (tall + 116), role: 'img', 'aria-label': block.title + ': ' + block.summary });
    svg.append(drawn('defs', {}, drawn('pattern', { id: 'unknown', width: 6, height: 6, patternUnits: 'userSpaceOnUse', patternTransform: 'rotate(45)' },
      drawn('rect', { width: 6, height: 6, fill: '#eef1f4' }), drawn('line', { x1: 0, y1: 0, x2: 0, y2: 6, stroke: '#9aa5b0', 'stroke-width': 2 }))));
    const words = (x, y, text, extra) => { const made = drawn('text', Object.assign({ x, y }, extra)); made.textContent = text; return made; };
    for (const cell of block.cells) {
      const corners = cell.corners.map(place);
      const known = cell.value !== null;
      const shape = drawn('polygon', { points: corners.map((corner) => corner.join(',')).join(' '), fill: known ? diverging(cell.value / block.most) : 'url(#unknown)', class: known ? 'known' : 'unknown' });
      const title = drawn('title', {});
      title.textContent = cell.text;
      shape.append(title);
      svg.append(shape);
      const side = Math.hypot(corners[1][0] - corners[0][0], corners[1][1] - corners[0][1]);
      if (known && side > 26) {
        const middle = [0, 1].map((i) => corners.reduce((sum, corner) => sum + corner[i], 0) / 4);
        svg.append(words(middle[0], middle[1] + 4, Math.abs(cell.value) < 0.05 ? '0' : (cell.value > 0 ? '+' : '') + cell.value.toFixed(1).replace('-', '\u2212'), { class: 'figure', fill: Math.abs(cell.value) > 0.75 * block.most ? '#fff' : '#1c2733' }));
      }
    }
    const step = (from, to) => { const raw = (to - from) / 5; const unit = Math.pow(10, Math.floor(Math.log10(raw))); return unit * ([1, 2, 5, 10].find((times) => times * unit >= raw)); };
    for (let x = Math.ceil(left / step(left, right)) * step(left, right); x <= right; x += step(left, right)) svg.append(words(place([x, 0])[0], tall + 26, String(+x.toPrecision(6)), { class: 'tick', 'text-anchor': 'middle' }));
    for (let y = Math.ceil(low / step(left, right)) * step(left, right); y <= high; y += step(left, right)) svg.append(words(56, place([0, y])[1] + 4, String(+y.toPrecision(6)), { class: 'tick', 'text-anchor': 'end' }));
    svg.append(words(62 + wide / 2, tall + 44, block.x_label, { 'text-anchor': 'middle' }));
    svg.append(words(0, 0, block.y_label, { 'text-anchor': 'middle', transform: 'translate(14,' + (10 + tall / 2) + ') rotate(-90)' }));
    for (let i = 0; i < 9; ++i) svg.append(drawn('rect', { x: 62 + i * 12, y: tall + 60, width: 12, height: 12, fill: diverging((i - 4) / 4) }));
    svg.append(words(62, tall + 86, '\u2212' + block.most + ' ' + block.below, {}), words(62, tall + 102, '+' + block.most + ' ' + block.above, {}));
    svg.append(drawn('rect', { x: 186, y: tall + 60, width: 12, height: 12, fill: 'url(#unknown)' }), words(202, tall + 70, 'cannot tell', {}));
    status.drawn += 1;
    return [element('h3', {}, block.title), svg, element('div', { class: 'plot-note' }, block.summary)];
  }

  function tableBlock(block) {
    const numeric = block.columns.map((_, i) => block.rows.length > 0 && block.rows.every((row) => row.cells[i] && row.cells[i].number));
    const zooms = block.rows.some((row) => row.zoom);
    const head = element('tr', {}, ...block.columns.map((name, i) => element('th', { class: numeric[i] ? 'number' : '' }, name)), zooms ? element('th') : null);
    const body = element('tbody');
    for (const row of block.rows) {
      const cells = row.cells.map((cell, i) => element('td', { 'data-column': block.columns[i], class: [cell.number ? 'number' : '', cell.tone === 'neutral' ? '' : cell.tone].join(' ').trim() },
        cell.text, i === 0 && row.detail ? element('div', { class: 'detail' }, row.detail) : null));
      if (zooms) {
        const last = element('td', { class: 'number' });
        if (row.zoom) {
          const button = element('button', { class: 'zoom', type: 'button' }, 'show');
          button.addEventListener('click', () => zoomTo(block.zoom_link, row.zoom));
          last.append(button);
        }
        cells.push(last);
      }
      body.append(element('tr', {}, ...cells));
    }
    return [block.caption ? element('h3', {}, block.caption) : null, element('div', { class: 'scroll' }, element('table', {}, element('thead', {}, head), body))];
  }

  const BUILDERS = {
    text: (block) => [block.tone === 'neutral' ? element('p', {}, block.text) : element('div', { class: 'message ' + block.tone }, block.text)],
    table: tableBlock,
    lines: (block) => plotBlock(block, drawLines),
    bars: (block) => plotBlock(block, drawBars),
    scene: (block) => plotBlock(block, drawScene),
    cells: cellsBlock,
    facts: (block) => [element('dl', {}, ...block.rows.flatMap(([label, value]) => [element('dt', {}, label), element('dd', {}, value)]))],
    code: (block) => [block.caption ? element('h3', {}, block.caption) : null, element('pre', {}, block.text)],
  };

  function sectionOf(section, index) {
    const blocks = element('div', { class: 'blocks' });
    for (const block of section.blocks) {
      status.blocks += 1;
      blocks.append(element('div', { class: block.half ? 'block half' : 'block' }, ...BUILDERS[block.kind](block)));
    }
    const intro = section.intro ? element('p', { class: 'intro' }, section.intro) : null;
    const id = 'section-' + index;
    if (section.folded) {
      const folded = element('details', { class: 'section', id }, element('summary', {}, section.title), intro, blocks);
      folded.addEventListener('toggle', () => folded.querySelectorAll('.js-plotly-plot').forEach((plot) => Plotly.Plots.resize(plot)));
      return folded;
    }
    return element('section', { id }, element('h2', {}, section.title), intro, blocks);
  }

  function build(page) {
    const root = document.getElementById('report');
    root.replaceChildren();
    root.append(element('header', {}, element('h1', {}, page.title), page.subtitle ? element('p', {}, page.subtitle) : null,
      element('nav', {}, ...page.sections.map((section, i) => {
        const anchor = element('a', { href: '#section-' + i }, section.title);
        anchor.addEventListener('click', () => { const target = document.getElementById('section-' + i); if (target.tagName === 'DETAILS') target.open = true; });
        return anchor;
      }))));
    if (page.headlines.length) {
      root.append(element('div', { class: 'headlines' }, ...page.headlines.map((one) => element('div', { class: 'headline ' + one.tone },
        element('div', { class: 'label' }, one.label),
        element('div', { class: 'value' }, one.value, one.unit ? element('span', { class: 'unit' }, one.unit) : null),
        one.note ? element('div', { class: 'note' }, one.note) : null))));
    }
    page.sections.forEach((section, i) => root.append(sectionOf(section, i)));
    if (page.footer) root.append(element('footer', {}, page.footer));
  }

  async function drawAll() {
    for (const { block, host, draw } of pending) {
      try {
        await draw(block, host);
        status.drawn += 1;
      } catch (error) {
        status.failures.push(block.title + ': ' + error);
        host.append(element('div', { class: 'message' }, 'This plot could not be drawn: ' + error));
      }
      await new Promise((resolve) => setTimeout(resolve, 0));
    }
    status.ready = true;
    document.body.setAttribute('data-ready', 'true');
  }

  build(JSON.parse(document.getElementById('data').textContent));
  drawAll();
})();
