// node bundle.js OUT.js: bundles charts.js with the packages beside it, and their licences as
// `wobblebenchCharts.licences`, which pages show.
import {build} from 'esbuild';
import {existsSync, readFileSync, readdirSync, writeFileSync} from 'node:fs';
import {dirname, join} from 'node:path';

/** The folder of the package that a bundled file belongs to, or nothing. */
function packageOf(file) {
  for (let folder = dirname(file); folder.includes('node_modules'); folder = dirname(folder)) {
    const description = join(folder, 'package.json');
    if (existsSync(description) && JSON.parse(readFileSync(description)).version) return folder;
  }
  return undefined;
}

/** "NAME VERSION" of the packages with one licence text, by that text. */
function namesByLicence(folders) {
  const names = new Map();
  for (const folder of folders) {
    const {name, version, license} = JSON.parse(readFileSync(join(folder, 'package.json')));
    const file = readdirSync(folder).find((entry) => /^licen[cs]e/i.test(entry));
    const text = file ? readFileSync(join(folder, file), 'utf8').trim() : license;
    if (!text) throw new Error(`${name}: no licence`);
    names.set(text, [...(names.get(text) ?? []), `${name} ${version}`]);
  }
  return names;
}

const {outputFiles, metafile} = await build({
  entryPoints: ['charts.js'], bundle: true, minify: true, format: 'iife', target: 'es2022',
  legalComments: 'none', metafile: true, write: false, logLevel: 'warning',
});
const folders = new Set(Object.keys(metafile.inputs).map(packageOf).filter(Boolean));
const licences = [...namesByLicence([...folders].sort())]
  .map(([text, names]) => `${names.join(', ')}\n\n${text}\n`).join(`\n${'-'.repeat(72)}\n\n`);
// "<" escaped: the text stands within <script>.
const literal = JSON.stringify(licences).replaceAll('<', '\\u003c');
const bundle = `${outputFiles[0].text}wobblebenchCharts.licences=${literal};\n`;
const output = process.argv[2];
// An equal file keeps its time, so that nothing is built again.
if (!existsSync(output) || readFileSync(output, 'utf8') !== bundle) writeFileSync(output, bundle);
