// Sliders over wide ranges.

import { field, h, section } from '../dom';
import { count, number } from '../format';

/** A number that is chosen by a slider. */
export interface Knob {
  label: string;
  unit: string;
  hint?: string;
  from: number;
  to: number;
  /** Equal ways are equal factors; `from` is more than 0 then. */
  log?: boolean;
  step?: number;
  /** Where it stands if nothing else is said. */
  value: number;
}

/** A titled part of the panel, line by line. */
export const part = (title: string, ...lines: HTMLElement[]): HTMLElement => section(title, h('div', {}, ...lines));

/** A slider with what it says beside it, and what makes it stand elsewhere. */
export function slider(knob: Knob, change: (value: number) => void): { element: HTMLElement; show(value: number): void } {
  const { from, to, log, unit } = knob;
  const place = (v: number): number => (log ? (1000 * Math.log(Math.max(v, from) / from)) / Math.log(to / from) : v);
  const value = (p: number): number => (log ? Number((from * (to / from) ** (p / 1000)).toPrecision(2)) : p);
  const told = h('output', {});
  const input = h('input', {
    type: 'range',
    min: String(log ? 0 : from),
    max: String(log ? 1000 : to),
    step: String(log ? 1 : (knob.step ?? (to - from) / 200)),
    oninput: () => {
      const now = value(Number(input.value));
      tell(now);
      change(now);
    },
  });
  const tell = (now: number): void => {
    told.textContent = unit ? `${number(now)} ${unit}` : count(now);
    input.setAttribute('aria-valuetext', told.textContent);
  };
  const show = (now: number): void => {
    // A slider that is dragged stands where the hand is.
    if (value(Number(input.value)) !== now) input.value = String(place(now));
    tell(now);
  };
  show(knob.value);
  const element = field(knob.label, input, knob.hint);
  element.classList.add('knob');
  element.append(told);
  return { element, show };
}

/** Names and values in two columns. */
export class Facts {
  readonly element = h('dl', { class: 'stats' });
  private readonly values = new Map<string, HTMLElement>();

  set(name: string, value: string): void {
    let place = this.values.get(name);
    if (!place) {
      place = h('dd', {});
      this.values.set(name, place);
      this.element.append(h('dt', {}, name), place);
    }
    place.textContent = value;
  }

  clear(): void {
    this.values.clear();
    this.element.replaceChildren();
  }
}
