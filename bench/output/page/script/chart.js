// Charts: Vega-Lite specifications, drawn by the bundle (charts.js) in the colours and the width of the page.

const chartFont = 'system-ui, "Segoe UI", Roboto, sans-serif';

/** Colours are those of page.css, so that dark, light and print need no drawing again. */
function chartConfig(narrow) {
  const texts = {labelColor: 'var(--soft)', titleColor: 'var(--ink)', labelFontSize: 12, titleFontSize: 12,
    titleFontWeight: 500};
  return {
    background: 'transparent', font: chartFont, padding: 2, aria: false,
    view: {stroke: null},
    axis: {...texts, gridColor: 'var(--line)', domainColor: 'var(--soft)', tickColor: 'var(--soft)', labelLimit: 140},
    legend: {...texts, labelLimit: 260, ...(narrow ? {orient: 'bottom', direction: 'vertical'} : {})},
    title: {color: 'var(--ink)', fontSize: 13, fontWeight: 600, anchor: 'start', offset: 10},
    text: {color: 'var(--ink)'},
    rule: {color: 'var(--soft)'},
  };
}

/** The specification for a box of this width: axes and legend included, if it is one plot. */
function fitted(specification, width) {
  const isOnePlot = !['hconcat', 'vconcat', 'concat', 'facet', 'repeat'].some((key) => key in specification);
  if (!isOnePlot) return specification;
  return {...specification, width, autosize: {type: 'fit-x', contains: 'padding'}};
}

const tooltip = make('div', {class: 'tooltip', hidden: true});

/** As vega.View calls it: `value` is what the specification says of the mark under the pointer. */
function showTooltip(handler, event, item, value) {
  tooltip.hidden = value === null || value === undefined || value === '';
  if (tooltip.hidden) return;
  const isTable = typeof value === 'object' && !Array.isArray(value);
  const all = isTable ? Object.entries(value) : [['', value]];
  const rows = all.filter(([, text]) => !['NaN', 'null', 'undefined'].includes(String(text)));  // nothing to say
  tooltip.replaceChildren(...rows.flatMap(([name, text]) => [make('b', {}, name), make('span', {}, String(text))]));
  const box = tooltip.getBoundingClientRect();
  const x = event.clientX + 14 + box.width > innerWidth ? event.clientX - 14 - box.width : event.clientX + 14;
  tooltip.style.left = `${Math.max(4, x)}px`;
  tooltip.style.top = `${Math.min(event.clientY + 14, innerHeight - box.height - 4)}px`;
}

class ChartPanel {
  constructor(panel) {
    this.panel = panel;
    this.specification = dataOf(panel);
    this.plot = make('div', {class: 'plot', 'aria-hidden': 'true'});  // the panel says what it shows
    panel.append(this.plot);
    whenChosen((id) => this.mark(id));
  }

  async draw() {
    const width = Math.floor(this.panel.clientWidth);
    if (width === 0 || width === this.width) return;
    this.width = width;
    this.view?.finalize();
    this.view = await wobblebenchCharts.draw(this.plot, fitted(this.specification, width),
      {config: chartConfig(width < 480), onPick: choose, tooltip: showTooltip});
    this.mark(chosenId);
  }

  /** Marks the points of an id; vega keeps the item that an element draws in __data__. */
  mark(id) {
    for (const element of this.plot.querySelectorAll('svg path, svg rect')) {
      const itemId = element.__data__?.datum?.id;
      element.classList.toggle('chosen', id !== null && String(itemId) === id);
    }
  }
}

async function startCharts() {
  const panels = [...document.querySelectorAll('figure.chart .panel')];
  if (panels.length === 0 || !globalThis.wobblebenchCharts) return;
  document.body.append(tooltip);
  document.addEventListener('scroll', () => { tooltip.hidden = true; }, {capture: true, passive: true});
  showLicences(wobblebenchCharts.licences);
  const charts = new Map(panels.map((panel) => [panel, new ChartPanel(panel)]));
  // Draws each at once, and again when its width changes.
  const observer = new ResizeObserver((entries) => entries.forEach(({target}) =>
    enhance(target, () => charts.get(target).draw())));
  panels.forEach((panel) => observer.observe(panel));
}

/** Those of the packages that draw the charts. */
function showLicences(texts) {
  document.querySelector('main').append(make('details', {class: 'listing licences'},
    make('summary', {}, 'Licences of the libraries that draw the charts of this page'), make('pre', {}, texts)));
}
