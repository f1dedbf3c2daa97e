// The strip below the picture: the slider of levels and what the level is.

import { h } from '../dom';
import { bytes, count, number, percent } from '../format';
import type { Host } from '../mode';
import type { Display } from '../model/display';
import { pixels } from '../model/choose';

export class Strip {
  readonly element: HTMLElement;
  private readonly slider = h('input', { type: 'range', min: '0', step: '1', 'aria-label': 'Level of detail', oninput: () => this.pick() });
  private readonly ticks = h('div', { class: 'ticks', 'aria-hidden': 'true' });
  private readonly text = h('output', { class: 'told' });
  private readonly auto: HTMLButtonElement;
  private readonly levels: HTMLElement;
  private readonly none: HTMLElement;
  private readonly why = h('span', { class: 'told' });
  private readonly button: HTMLButtonElement;

  constructor(
    private readonly host: Host,
    private readonly display: Display,
    make: () => void,
  ) {
    const flip = () => host.store.set({ auto: !host.store.state.auto, level: display.level });
    this.auto = h('button', { type: 'button', title: 'Let the distance choose (A)', onclick: flip }, 'By distance');
    this.levels = h('div', { class: 'levels' }, this.auto, h('div', { class: 'slide' }, this.slider, this.ticks));
    this.button = h('button', { type: 'button', class: 'main', onclick: make }, 'Make levels');
    this.none = h('div', { class: 'levels' }, this.why, this.button);
    this.work('');
    this.element = h('div', { class: 'lods' }, this.levels, this.none, this.text);
  }

  refresh(): void {
    const { display, host } = this;
    const { levels } = display.file;
    this.none.hidden = levels.length > 1;
    this.levels.hidden = levels.length <= 1;
    this.slider.max = String(levels.length - 1);
    this.slider.value = String(display.level);
    this.auto.setAttribute('aria-pressed', String(host.store.state.auto));
    const names = levels.map((l) => (l.level === 0 ? 'original' : count(l.triangles)));
    if (this.ticks.textContent !== names.join('')) this.ticks.replaceChildren(...names.map((n) => h('span', {}, n)));
    this.text.textContent = this.line();
  }

  /** How the making of levels goes; nothing if none are made. */
  work(line: string): void {
    this.why.textContent = line ? `Making levels: ${line}` : 'This model has one level: the original.';
    this.button.hidden = line !== '';
  }

  private line(): string {
    const { display, host } = this;
    const row = display.file.levels[display.level];
    if (!row) return '';
    const share = row.triangles / Math.max(1, display.file.triangles);
    const seen = pixels(row.error.max, display.distance(), host.stage.pixelsPerRadian);
    const name = row.level === 0 ? 'Original' : `Level ${row.level}`;
    const size = `${count(row.triangles)} triangles${row.level ? ` (${percent(share)})` : ''}, ${bytes(row.bytes)}`;
    const error = row.level ? `, off by at most ${number(row.error.max)} (${number(seen)} px here)` : '';
    this.slider.setAttribute('aria-valuetext', `${name}: ${size}${error}`);
    return `${name}: ${size}${error}`;
  }

  private pick(): void {
    this.host.store.set({ auto: false, level: Number(this.slider.value) });
  }
}
