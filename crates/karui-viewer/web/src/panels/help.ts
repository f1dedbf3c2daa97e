// The help sheet: which keys do what.

import { h } from '../dom';

const COMMON = [
  ['drag, arrow keys', 'turn (with the picture in focus)'],
  ['wheel, + -', 'closer, further'],
  ['right drag', 'shift'],
  ['R', 'see the whole'],
  ['S', 'copy a link to this view'],
  ['?', 'this sheet'],
] as const;

export class Help {
  private readonly dialog = h('dialog', { class: 'help', 'aria-labelledby': 'help-title' });

  /** Opens the sheet with the keys of a mode. */
  open(keys: readonly (readonly [string, string])[]): void {
    if (this.dialog.open) return this.dialog.close();
    const row = ([key, what]: readonly [string, string]) => h('tr', {}, h('th', { scope: 'row' }, h('kbd', {}, key)), h('td', {}, what));
    const close = h('button', { type: 'button', onclick: () => this.dialog.close() }, 'Close');
    const table = h('table', {}, h('tbody', {}, ...[...keys, ...COMMON].map(row)));
    const licenses = h('a', { class: 'button', href: 'assets/licenses.txt', target: '_blank', rel: 'noopener' }, 'Licences');
    this.dialog.replaceChildren(h('h2', { id: 'help-title' }, 'Keys'), table, h('div', { class: 'ends' }, close, licenses));
    if (!this.dialog.isConnected) document.body.append(this.dialog);
    this.dialog.showModal();
  }
}
