// Tables: sorted by a click on a heading, long ones shortened and searched; rows with an id are chosen.

const rowsAtFirst = 500;  // more make the page slow to lay out
const rowsWorthSearching = 25;

/** What a cell is sorted by: a number, a text, or null of an empty one. */
function sortKey(cell, isNumber) {
  if (isNumber) return cell?.dataset.value ? Number(cell.dataset.value) : null;
  return cell?.textContent.trim() || null;
}

/** Order of two keys; empty ones come last either way. */
function compareKeys(left, right, sign) {
  if (left === null || right === null) return (left === null) - (right === null);
  if (typeof left === 'number') return sign * (left - right);
  return sign * left.localeCompare(right, undefined, {numeric: true});
}

class SortableTable {
  constructor(figure) {
    this.figure = figure;
    this.body = figure.querySelector('tbody');
    this.headings = [...figure.querySelectorAll('thead th')];
    this.original = [...this.body.rows];
    this.rows = this.original;
    this.limit = rowsAtFirst;
    this.search = '';
    this.headings.forEach((heading, column) => this.makeSortable(heading, column));
    this.addTools();
    this.makeRowsChoosable();
    if (this.original.length > this.limit) this.show();
  }

  makeSortable(heading, column) {
    if (this.original.length < 2 || this.headings.length < 2) return;
    const button = make('button', {type: 'button', onclick: () => this.sortBy(column)});
    button.append(...heading.childNodes);
    heading.append(button);
  }

  /** First upwards, then downwards, then in the order of the file again. */
  sortBy(column) {
    const heading = this.headings[column];
    const next = {none: 'ascending', ascending: 'descending', descending: 'none'};
    const order = next[heading.getAttribute('aria-sort') ?? 'none'];
    this.headings.forEach((other) => other.removeAttribute('aria-sort'));
    if (order !== 'none') heading.setAttribute('aria-sort', order);
    this.rows = order === 'none' ? this.original : this.sorted(column, order === 'ascending' ? 1 : -1);
    this.show();
  }

  sorted(column, sign) {
    const isNumber = this.headings[column].classList.contains('number');
    return this.original
      .map((row) => ({row, key: sortKey(row.cells[column], isNumber)}))
      .sort((left, right) => compareKeys(left.key, right.key, sign))
      .map(({row}) => row);
  }

  /** Below long tables: what is shown of them, and a search. */
  addTools() {
    const count = this.original.length;
    if (count < rowsWorthSearching) return;
    const search = make('input', {type: 'search', placeholder: 'Search rows', 'aria-label': 'Search rows',
      oninput: () => { this.search = search.value.toLowerCase(); this.show(); }});
    this.count = make('span', {}, `${count} rows`);
    this.all = make('button', {type: 'button', hidden: true, onclick: () => {
      this.limit = Infinity;
      this.show();
    }}, `Show all ${count} rows`);
    this.figure.append(make('div', {class: 'tools'}, search, this.count, this.all));
  }

  show() {
    const found = this.search
      ? this.rows.filter((row) => row.textContent.toLowerCase().includes(this.search)) : this.rows;
    this.body.replaceChildren(...found.slice(0, this.limit));
    if (!this.count) return;
    const shown = Math.min(found.length, this.limit);
    this.count.textContent = shown < this.original.length
      ? `${shown} of ${this.original.length} rows` : `${shown} rows`;
    this.all.hidden = found.length <= this.limit;
  }

  /** One row is in the order of the Tab key; arrows move to the others. */
  makeRowsChoosable() {
    const rows = this.original.filter((row) => row.dataset.id);
    rows.forEach((row, index) => { row.tabIndex = index === 0 ? 0 : -1; });
    this.body.addEventListener('click', (event) => this.chooseRow(event.target.closest('tr')));
    this.body.addEventListener('keydown', (event) => this.moveByKey(event));
    whenChosen((id) => rows.forEach((row) => {
      if (row.dataset.id === id) row.setAttribute('aria-current', 'true');
      else row.removeAttribute('aria-current');
    }));
  }

  chooseRow(row) {
    if (!row?.dataset.id || getSelection().type === 'Range') return;
    this.focusRow(row);
    choose(row.dataset.id);
  }

  focusRow(row) {
    this.body.querySelectorAll('tr[tabindex="0"]').forEach((other) => { other.tabIndex = -1; });
    row.tabIndex = 0;
    row.focus();
  }

  moveByKey(event) {
    const row = event.target.closest('tr');
    if (event.key === 'Enter' || event.key === ' ') this.chooseRow(row);
    else if (event.key === 'ArrowDown' && row.nextElementSibling) this.focusRow(row.nextElementSibling);
    else if (event.key === 'ArrowUp' && row.previousElementSibling) this.focusRow(row.previousElementSibling);
    else return;
    event.preventDefault();
  }
}
