// Lines for the user, over the picture.

import { h } from '../dom';

const NOTE_STAYS = 5000;

export class Toasts {
  readonly element = h('div', { class: 'toasts', role: 'status', 'aria-live': 'polite' });

  /** Shows a line: a note goes by itself, an error when it is dismissed. */
  say(message: string, kind: 'note' | 'error'): void {
    const close = h('button', { type: 'button', 'aria-label': 'Dismiss', onclick: () => line.remove() }, '×');
    const line = h('div', { class: `toast ${kind}`, role: kind === 'error' ? 'alert' : 'note' }, h('span', {}, message), close);
    const same = [...this.element.children].find((c) => c.firstChild?.textContent === message);
    same?.remove();
    this.element.append(line);
    if (kind === 'note') setTimeout(() => line.remove(), NOTE_STAYS);
  }

  /** Takes notes away; errors stay until they are dismissed. */
  clear(): void {
    this.element.querySelectorAll('.note').forEach((note) => note.remove());
  }
}
