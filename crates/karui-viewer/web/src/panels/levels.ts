// All levels in a table, and how the distance chooses one.

import { check, field, h } from '../dom';
import { bytes, count, number } from '../format';
import type { Host } from '../mode';
import { errors } from '../model/choose';
import type { Display } from '../model/display';

/** Tolerances of the slider, pixels. */
const TOLERANCES = [0.25, 0.5, 1, 1.5, 2, 3, 4, 6, 8, 12, 16, 24, 32];

export class LevelsPanel {
  readonly element: HTMLElement;
  private readonly rows = h('tbody');
  private readonly auto: HTMLInputElement;
  private readonly tolerance: HTMLInputElement;
  private readonly told = h('output');
  private readonly budget: HTMLInputElement;
  private built = '';

  constructor(
    private readonly host: Host,
    private readonly display: Display,
  ) {
    const { store } = host;
    const [label, auto] = check('Choose by distance', 'A', (on) => store.set({ auto: on, level: display.level }));
    this.auto = auto;
    const last = String(TOLERANCES.length - 1);
    const pick = () => store.set({ auto: true, tolerance: TOLERANCES[Number(this.tolerance.value)] ?? 1 });
    this.tolerance = h('input', { type: 'range', min: '0', max: last, step: '1', oninput: pick });
    const limit = () => store.set({ auto: true, budget: Math.max(0, Math.round(Number(this.budget.value)) || 0) });
    this.budget = h('input', { type: 'number', min: '0', step: '1000', placeholder: 'any', onchange: limit });
    const head = ['', 'triangles', 'size', 'max error', 'beyond'].map((t) => h('th', { scope: 'col', title: t === 'beyond' ? 'Distance beyond which it may be shown' : '' }, t));
    const slide = h('span', { class: 'slide' }, this.tolerance, this.told);
    const tolerance = field('Tolerance', slide, 'Largest error on the screen');
    this.tolerance.setAttribute('aria-label', 'Tolerance in pixels');
    this.element = h('div', {},
      h('div', { class: 'scroll' }, h('table', { class: 'rows' }, h('thead', {}, h('tr', {}, ...head)), this.rows)),
      label, tolerance, field('Triangles at most', this.budget, 'Chooses a coarser level where this is exceeded'),
    );
  }

  refresh(): void {
    const { state } = this.host.store;
    this.auto.checked = state.auto;
    const nearest = TOLERANCES.findIndex((t) => t >= state.tolerance);
    this.tolerance.value = String(nearest < 0 ? TOLERANCES.length - 1 : nearest);
    this.told.textContent = `${number(state.tolerance)} px`;
    if (document.activeElement !== this.budget) this.budget.value = state.budget ? String(state.budget) : '';
    this.fill(state.tolerance);
    [...this.rows.children].forEach((row, i) => row.setAttribute('aria-current', String(i === this.display.level)));
  }

  private fill(tolerance: number): void {
    const { levels } = this.display.file;
    const scale = this.host.stage.pixelsPerRadian;
    const key = `${JSON.stringify(levels)} ${tolerance} ${scale}`;
    if (key === this.built) return;
    this.built = key;
    const largest = errors(levels);
    const row = (i: number) => {
      const level = levels[i]!;
      const show = () => this.host.store.set({ auto: false, level: i });
      const cells = [
        count(level.triangles),
        bytes(level.bytes),
        number(level.error.max),
        number((largest[i]! * scale) / tolerance),
      ];
      const pick = h('button', { type: 'button', 'aria-label': `Show level ${i}`, onclick: show }, String(i));
      return h('tr', { onclick: show }, h('th', { scope: 'row' }, pick), ...cells.map((c) => h('td', {}, c)));
    };
    this.rows.replaceChildren(...levels.map((_, i) => row(i)));
  }
}
