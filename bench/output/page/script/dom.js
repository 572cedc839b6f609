// What the parts of the page share. All parts are joined to one script (cmake/PageAssets.cmake), in one scope.

/** An element with attributes, listeners ("onclick") and children; strings become text, never markup. */
function make(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith('on')) element.addEventListener(name.slice(2), value);
    else if (typeof value === 'boolean') element.toggleAttribute(name, value);
    else element.setAttribute(name, value);
  }
  element.append(...children);
  return element;
}

const statusLine = make('p', {class: 'visually-hidden', role: 'status'});

/** Tells those who do not see the page what has changed on it. */
function announce(text) {
  statusLine.textContent = text;
}

let groups = 0;

/** One of several: radio buttons in a row. The first is chosen; `choose` gets the index of another. */
function choice(legend, names, choose) {
  const group = `choice-${groups++}`;
  const options = names.map((name, index) => make('label', {},
    make('input', {type: 'radio', name: group, checked: index === 0, onchange: () => choose(index)}),
    make('span', {}, name)));
  return make('fieldset', {class: 'choice'}, make('legend', {class: 'visually-hidden'}, legend), ...options);
}

/** The JSON that a figure carries. */
function dataOf(element) {
  return JSON.parse(element.querySelector('script[type="application/json"]').textContent);
}

/** Text to the clipboard; pages from a file may lack navigator.clipboard. */
async function copyText(source) {
  if (navigator.clipboard) {
    await navigator.clipboard.writeText(source.textContent);
    return;
  }
  getSelection().selectAllChildren(source);
  document.execCommand('copy');
}

function addCopyButton(command) {
  const button = make('button', {type: 'button', class: 'copy', onclick: () =>
    copyText(command).then(() => { button.textContent = 'Copied'; announce('Command copied'); },
      () => getSelection().selectAllChildren(command))}, 'Copy');
  const row = make('div', {class: 'command-row'});
  command.replaceWith(row);
  row.append(command, button);
}
