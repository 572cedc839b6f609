// Puts the parts to work. Without this script the page has its texts, tables and pictures.

/** Links to the sections, beside the page or above it. */
function addOutline() {
  const sections = [...document.querySelectorAll('main > h2[id]')];
  if (sections.length < 3) return;
  const links = sections.map((section) => make('a', {href: `#${section.id}`}, section.textContent));
  document.querySelector('main').before(make('nav', {class: 'outline', 'aria-label': 'Sections'}, ...links));
}

/** Runs one part; what fails there is told where it stands and leaves the rest of the page alone. */
async function enhance(figure, part) {
  try {
    await part(figure);
  } catch (error) {
    figure.append(make('p', {class: 'problem'}, `This cannot be shown: ${error.message}`));
  }
}

document.body.append(statusLine);
document.body.classList.add('enhanced');
addOutline();
startDetails();
document.body.classList.toggle('with-side', document.querySelector('.outline, template.detail') !== null);
document.querySelectorAll('pre.command').forEach(addCopyButton);
for (const figure of document.querySelectorAll('figure.table')) enhance(figure, (table) => new SortableTable(table));
for (const figure of document.querySelectorAll('figure.comparison')) enhance(figure, (pair) => new Comparison(pair));
for (const figure of document.querySelectorAll('figure.map')) enhance(figure, (map) => new ValueMap(map).load());
enhance(document.querySelector('main'), startCharts);
