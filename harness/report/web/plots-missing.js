/* Takes the place of plotly.js in a program that was built where npm could not fetch it: says in each plot's place what is
   missing, and leaves the tables and texts of the report as they are. */
const Plotly = {
  newPlot(host) {
    host.textContent = 'This plot needs the web parts, which were not to be had when Touchstone was built. ' +
      'Configure again with npm, or with -DTOUCHSTONE_PLOTLY=plotly-gl3d.min.js (version in harness/report/web/package.json).';
    host.classList.add('plot-missing');
    host.on = () => {};
    return Promise.resolve(host);
  },
  relayout() { return Promise.resolve(); },
  Plots: { resize() {} },
};
