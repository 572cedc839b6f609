// node draw_files.js CHARTS.js FOLDER…: what script/charts does.
import {readFileSync, readdirSync, writeFileSync} from 'node:fs';
import {join} from 'node:path';
import {runInThisContext} from 'node:vm';

const extension = '.vl.json';
const config = {
  background: '#ffffff', padding: 10, font: 'DejaVu Sans, Verdana, sans-serif',
  view: {stroke: null}, axis: {labelFontSize: 12, titleFontSize: 12, titleFontWeight: 'normal', gridColor: '#dde2e7'},
  legend: {labelFontSize: 12, labelLimit: 320}, title: {fontSize: 14, anchor: 'start', offset: 10},
};

async function drawSpecifications(folder, names) {
  for (const name of names.filter((file) => file.endsWith(extension))) {
    const text = await wobblebenchCharts.svg(JSON.parse(readFileSync(join(folder, name), 'utf8')), config);
    writeFileSync(join(folder, name.replace(extension, '.svg')), `${text}\n`);
    console.log(join(folder, name.replace(extension, '.svg')));
  }
}

/** Links to specifications become pictures. */
function showCharts(folder, names) {
  for (const name of names.filter((file) => file.endsWith('.md'))) {
    const before = readFileSync(join(folder, name), 'utf8');
    const after = before.replace(/\[Chart: ([^\]]*)\]\(([^)]+)\.vl\.json\)/g, '![$1]($2.svg)');
    if (after !== before) writeFileSync(join(folder, name), after);
  }
}

const [charts, ...folders] = process.argv.slice(2);
runInThisContext(readFileSync(charts, 'utf8'), {filename: charts});
for (const folder of folders) {
  const names = readdirSync(folder);
  await drawSpecifications(folder, names);
  showCharts(folder, names);
}
