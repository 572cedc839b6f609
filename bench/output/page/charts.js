// Draws the charts of report.html: Vega-Lite specifications, as SVG. Bundled by esbuild
// (cmake/PageAssets.cmake); page.js is the one caller. Expressions are interpreted, so that the page's
// Content-Security-Policy needs no 'unsafe-eval'.
import * as vega from 'vega';
import {compile} from 'vega-lite';
import {expressionInterpreter} from 'vega-interpreter';

// Specifications hold their data; nothing is ever loaded.
const noLoader = {
  load: () => Promise.reject(new Error('charts load nothing')),
  sanitize: () => Promise.reject(new Error('charts link nowhere')),
};

/**
 * Draws a specification in an element, in place of what is there. Options:
 * `config`: Vega-Lite's, for colours and type; `onPick(id)`: called when a mark whose row has an "id"
 * is clicked; `tooltip(handler, event, item, value)`: as vega.View takes it.
 * Returns the view; call finalize() before the element is drawn again.
 */
async function draw(element, specification, {config = {}, onPick = () => {}, tooltip} = {}) {
  const compiled = compile(specification, {config, logger: vega.logger(vega.Error)}).spec;
  const view = new vega.View(vega.parse(compiled, null, {ast: true}), {
    expr: expressionInterpreter, renderer: 'svg', container: element, hover: true, loader: noLoader,
    tooltip, logLevel: vega.Error,
  });
  view.addEventListener('click', (event, item) => {
    const id = item?.datum?.id ?? item?.datum?.datum?.id;
    if (id !== undefined && id !== null && id !== '') onPick(String(id));
  });
  await view.runAsync();
  return view;
}

globalThis.wobblebenchCharts = {draw};
