// A point of a chart and a row of a table may have the same id. Choosing one marks all that have it, and shows its
// detail, a <template> of the page, in an aside.

const choiceListeners = [];
let chosenId = null;
let aside = null;
let focusBefore = null;

/** Calls `listener(id)` whenever another id is chosen; null: none. */
function whenChosen(listener) {
  choiceListeners.push(listener);
}

function choose(id) {
  chosenId = id;
  for (const listener of choiceListeners) listener(id);
  showDetail(id);
}

function templateOf(id) {
  return [...document.querySelectorAll('template.detail')].find((template) => template.dataset.id === id);
}

function showDetail(id) {
  const template = id === null ? undefined : templateOf(id);
  document.body.classList.toggle('detail-open', template !== undefined);
  aside.hidden = template === undefined;
  if (!template) return;
  if (!aside.contains(document.activeElement)) focusBefore = document.activeElement;
  const content = aside.querySelector('.content');
  content.replaceChildren(template.content.cloneNode(true));
  content.querySelectorAll('pre.command').forEach(addCopyButton);
  aside.scrollTop = 0;
  announce(`Details shown: ${content.querySelector('h3')?.textContent ?? id}. Escape closes them.`);
}

function closeDetail() {
  if (chosenId === null) return;
  choose(null);
  announce('Details closed');
  focusBefore?.focus?.();
}

function startDetails() {
  const close = make('button', {type: 'button', class: 'close', 'aria-label': 'Close details', onclick: closeDetail}, '×');
  aside = make('aside', {class: 'detail', 'aria-label': 'Details', tabindex: '-1', hidden: true},
    close, make('div', {class: 'content'}));
  document.querySelector('main').after(aside);
  document.addEventListener('keydown', (event) => {
    if (event.key === 'Escape') closeDetail();
  });
}
