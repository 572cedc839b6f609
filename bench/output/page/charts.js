// Draws Vega-Lite specifications as SVG, for pages (script/chart.js) and for script/charts. Bundled by esbuild
// (cmake/PageAssets.cmake). Expressions are interpreted, so that the page's Content-Security-Policy needs no
// 'unsafe-eval'.
import * as vega from 'vega';
import {compile} from 'vega-lite';
import {expressionInterpreter} from 'vega-interpreter';

// Specifications hold their data; nothing is ever loaded.
const noLoader = {
  load: () => Promise.reject(new Error('charts load nothing')),
  sanitize: () => Promise.reject(new Error('charts link nowhere')),
};

/** A view of a specification; `config` is Vega-Lite's, for colours and type. */
function makeView(specification, config, options) {
  const compiled = compile(specification, {config, logger: vega.logger(vega.Error)}).spec;
  return new vega.View(vega.parse(compiled, null, {ast: true}),
    {expr: expressionInterpreter, loader: noLoader, logLevel: vega.Error, ...options});
}

/**
 * Draws in an element, in place of what is there. `onPick(id)` is called when a mark whose row has an
 * "id" is clicked; `tooltip` is vega.View's. Call finalize() of the result before drawing there again.
 */
async function draw(element, specification, {config = {}, onPick = () => {}, tooltip} = {}) {
  const view = makeView(specification, config, {renderer: 'svg', container: element, hover: true, tooltip});
  view.addEventListener('click', (event, item) => {
    const id = item?.datum?.id;
    if (id !== undefined && id !== null && id !== '') onPick(String(id));
  });
  return view.runAsync();
}

/** The text of an SVG file. */
async function svg(specification, config = {}) {
  return makeView(specification, config, {renderer: 'none'}).toSVG();
}

globalThis.wobblebenchCharts = {draw, svg};
