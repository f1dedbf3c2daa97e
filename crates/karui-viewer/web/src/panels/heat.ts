// Heat maps and what their colours stand for.

import * as api from '../api';
import { h } from '../dom';
import { number, percent } from '../format';
import type { Host } from '../mode';
import { type Display, FLIP } from '../model/display';

const NAMES: Record<string, [string, string]> = {
  curvature: ['Curvature', 'How strongly the surface bends, 0 to 1'],
  mesh: ['Mesh saliency', 'Where it bends otherwise than around it, 0 to 1'],
  image: ['Image saliency', 'What stands out in pictures from all around, 0 to 1'],
  hybrid: ['Hybrid saliency', 'Curvature, mesh and image saliency, whichever says most, 0 to 1'],
  error: ['Surface error', 'Distance of the level to the original'],
  flip: ['FLIP', 'How different level and original look from here, 0 to 1'],
};

/** Magma, as the server colours FLIP. */
const MAGMA = ['#000004', '#3b0f70', '#8c2981', '#de4968', '#fe9f6d', '#fcfdbf'];

export class HeatPanel {
  readonly element: HTMLElement;
  readonly legend = h('figure', { class: 'legend', hidden: true });
  private readonly pick: HTMLSelectElement;
  private asked = '';
  private mean: number | undefined;
  private report: api.JobReport | undefined;
  private readonly bar = h('progress', { max: 1, value: 0, 'aria-label': 'Progress' });
  private readonly far = h('output', { class: 'told' });

  constructor(
    private readonly host: Host,
    private readonly display: Display,
  ) {
    const kinds = ['', ...display.file.can.heat, FLIP];
    const options = kinds.map((kind) => h('option', { value: kind }, kind ? (NAMES[kind]?.[0] ?? kind) : 'None'));
    const choose = () => host.store.set({ heat: this.pick.value });
    this.pick = h('select', { 'aria-label': 'Heat map', onchange: choose }, ...options);
    this.element = h('div', {}, this.pick);
  }

  refresh(): void {
    const { heat } = this.host.store.state;
    this.pick.value = heat;
    const there = heat === FLIP || heat === this.display.heat;
    this.legend.hidden = !heat || !(there || this.report);
    if (this.report) return;
    const { level, file } = this.display;
    const key = heat && there ? `${heat} ${level} ${JSON.stringify(file.levels[level])}` : '';
    if (key === this.asked) return;
    this.asked = key;
    if (key && heat === FLIP) this.show(FLIP, { min: 0, max: 1, unit: 'FLIP', map: 'magma', colors: MAGMA });
    else if (key) void this.ask(heat, key);
  }

  /** How far the map is that is waited for; nothing once none is. */
  wait(report: api.JobReport | undefined): void {
    const begins = !this.report;
    this.report = report;
    Object.assign(window.karui, { waiting: report ?? null });
    if (!report) {
      this.asked = '';
      return this.refresh();
    }
    this.pick.value = this.host.store.state.heat;
    this.bar.value = report.fraction;
    this.far.textContent = `${report.stage}, ${percent(Math.round(100 * report.fraction) / 100)}`;
    if (!begins) return;
    this.legend.hidden = false;
    const [name] = NAMES[this.host.store.state.heat] ?? [''];
    const stop = h('button', { type: 'button', onclick: () => this.host.store.set({ heat: '' }) }, 'Cancel');
    this.legend.replaceChildren(h('figcaption', {}, name), this.bar, h('div', { class: 'ends' }, this.far, stop));
  }

  /** The mean of the FLIP that is shown; none while there is none. */
  setMean(mean: number | undefined): void {
    this.mean = mean;
    const line = this.legend.querySelector('.mean');
    if (line) line.textContent = this.told();
  }

  private told(): string {
    return this.mean === undefined ? 'drawing …' : `mean ${number(this.mean)}`;
  }

  private async ask(kind: string, key: string): Promise<void> {
    try {
      const legend = await api.legend(this.display.file.id, kind, Math.max(0, this.display.level));
      if (key === this.asked) this.show(kind, legend);
    } catch (error) {
      this.host.say((error as Error).message, 'error');
    }
  }

  private show(kind: string, { min, max, unit, map, colors }: api.Legend): void {
    const [name, what] = NAMES[kind] ?? [kind, ''];
    const bar = h('div', { class: 'ramp', role: 'img', 'aria-label': `${map}: ${number(min)} to ${number(max)} ${unit}` });
    bar.style.background = `linear-gradient(to right, ${colors.join(', ')})`;
    const { diagonal, unit: metre } = this.display.file;
    const own = metre ?? 'model units';
    const length = kind === 'error' ? ` ${own}` : '';
    const ends = h('div', { class: 'ends' }, h('span', {}, number(min)), h('span', {}, number(max) + length));
    const share = kind === 'error' && diagonal > 0 ? `at most ${percent(max / diagonal)} of the diagonal` : '';
    const more = kind === FLIP ? this.told() : share;
    const mean = more ? h('div', { class: 'mean' }, more) : null;
    this.legend.replaceChildren(h('figcaption', { title: what }, name), bar, ends, ...(mean ? [mean] : []));
  }
}
