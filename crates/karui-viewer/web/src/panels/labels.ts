// Which half is which, and the handle of the wipe.

import { h } from '../dom';
import { count } from '../format';
import type { Host } from '../mode';
import type { Display } from '../model/display';

export class Labels {
  readonly element: HTMLElement;
  private readonly left = h('span', { class: 'label left' });
  private readonly right = h('span', { class: 'label right' });
  private readonly handle: HTMLElement;

  constructor(
    private readonly host: Host,
    private readonly display: Display,
  ) {
    this.handle = h('div', {
      class: 'handle', role: 'slider', tabIndex: 0, 'aria-label': 'Wipe', 'aria-valuemin': '0', 'aria-valuemax': '100',
      onpointerdown: (event: PointerEvent) => this.grab(event),
      onkeydown: (event: KeyboardEvent) => this.step(event),
    });
    this.element = h('div', { class: 'labels' }, this.left, this.right, this.handle);
  }

  refresh(): void {
    const { compare, wipe } = this.host.store.state;
    const { file, level } = this.display;
    this.element.hidden = compare === 'off';
    this.handle.hidden = compare !== 'wipe';
    const at = compare === 'wipe' ? wipe : 0.5;
    this.element.style.setProperty('--at', `${100 * at}%`);
    this.handle.setAttribute('aria-valuenow', String(Math.round(100 * at)));
    this.left.textContent = `Original: ${count(file.triangles)} triangles`;
    const row = file.levels[level];
    this.right.textContent = row ? `${level ? `Level ${level}` : 'Original'}: ${count(row.triangles)}` : '';
  }

  private grab(event: PointerEvent): void {
    event.preventDefault();
    this.handle.focus();
    this.handle.setPointerCapture(event.pointerId);
    const move = (to: PointerEvent) => {
      const { left, width } = this.element.getBoundingClientRect();
      this.set((to.clientX - left) / Math.max(1, width));
    };
    this.handle.addEventListener('pointermove', move);
    this.handle.addEventListener('lostpointercapture', () => this.handle.removeEventListener('pointermove', move), { once: true });
  }

  private step(event: KeyboardEvent): void {
    const by = { ArrowLeft: -0.02, ArrowRight: 0.02, PageDown: -0.1, PageUp: 0.1, Home: -1, End: 1 }[event.key];
    if (!by) return;
    event.preventDefault();
    this.set(this.host.store.state.wipe + by);
  }

  private set(wipe: number): void {
    this.host.store.set({ wipe: Math.min(1, Math.max(0, wipe)) });
  }
}
