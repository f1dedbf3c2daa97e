// Options of a mode: in the address, on its controls, in what it asks for.

import { check, field, h } from './dom';
import { type Knob, slider } from './live/controls';
import type { State, Store } from './state';

type Value = number | boolean | string;

/** Keys of the state that hold options in a row. */
export type OptionsKey = { [K in keyof State]: K extends 'live' | 'adaptive' | 'tiles' ? K : never }[keyof State];

type Of<T, V> = { [K in keyof T & string]: T[K] extends V ? K : never }[keyof T & string];

/** What options there are. */
export interface About<T> {
  /** What holds where the address says nothing. */
  defaults: Readonly<T>;
  /** Words that an option may be; any number and either boolean are taken. */
  words: { readonly [K in Of<T, string>]: readonly string[] };
}

const word = (value: Value): string =>
  typeof value === 'boolean' ? (value ? '1' : '0') : typeof value === 'number' ? String(Number(value.toPrecision(6))) : value;

/** What is not as usual: `name:value`, with commas between. */
function written<T extends Record<string, Value>>(values: T, { defaults }: About<T>): string {
  const given = Object.entries(values).filter(([name, value]) => word(value) !== word(defaults[name]!));
  return given.map(([name, value]) => `${name}:${word(value)}`).join(',');
}

/** The options that a text stands for; what makes no sense is as usual. */
function read<T extends Record<string, Value>>(text: string, { defaults, words }: About<T>): T {
  const values: Record<string, Value> = { ...defaults };
  for (const [name, value] of text.split(',').map((pair) => pair.split(':') as [string, string?])) {
    const usual = Object.hasOwn(defaults, name) ? defaults[name] : undefined;
    if (value === undefined || usual === undefined) continue;
    const own = (words as Record<string, readonly string[]>)[name];
    if (typeof usual === 'boolean') values[name] = value === '1';
    else if (typeof usual === 'number') values[name] = value !== '' && Number.isFinite(Number(value)) ? Number(value) : usual;
    else if (own?.includes(value)) values[name] = value;
  }
  return values as T;
}

export class Options<T extends Record<string, Value>> {
  private now: T;
  private shown: (() => void)[] = [];
  private readonly unsubscribe: () => void;

  /** `changed` is called with the names of what is not what it was, whoever has changed it. */
  constructor(
    private readonly store: Store,
    private readonly key: OptionsKey,
    private readonly about: About<T>,
    private readonly changed: (names: ReadonlySet<keyof T>) => void,
  ) {
    this.now = read(store.state[key], about);
    this.unsubscribe = store.subscribe((state, keys) => keys.has(key) && this.follow(state[key]));
  }

  get values(): Readonly<T> {
    return this.now;
  }

  /** Changes options, in the address too. */
  set(patch: Partial<T>): void {
    this.store.set({ [this.key]: written({ ...this.now, ...patch }, this.about) });
  }

  close(): void {
    this.unsubscribe();
    this.shown = [];
  }

  /** The controls so far are not on the page any more. */
  forget(): void {
    this.shown = [];
  }

  /** A number as a slider. */
  slider(name: Of<T, number>, knob: Knob): HTMLElement {
    const { element, show } = slider(knob, (value) => this.set({ [name]: value } as Partial<T>));
    return this.control(element, () => show(this.now[name] as number));
  }

  /** A yes or no as a box. */
  box(name: Of<T, boolean>, label: string, key = ''): HTMLElement {
    const [element, box] = check(label, key, (on) => this.set({ [name]: on } as Partial<T>));
    return this.control(element, () => (box.checked = this.now[name] as boolean));
  }

  /** A word as a list to choose from. */
  select(name: Of<T, string>, label: string, words: readonly (readonly [string, string])[]): HTMLElement {
    const list = h('select', { onchange: () => this.set({ [name]: list.value } as Partial<T>) }, ...words.map(([value, text]) => h('option', { value }, text)));
    return this.control(field(label, list), () => (list.value = this.now[name] as string));
  }

  /** Any control, and what makes it show what is chosen. */
  control<E extends HTMLElement>(element: E, show: () => void): E {
    this.shown.push(show);
    show();
    return element;
  }

  private follow(text: string): void {
    const before = this.now;
    this.now = read(text, this.about);
    const names = new Set<keyof T>(Object.keys(this.now).filter((name) => this.now[name] !== before[name]));
    if (names.size === 0) return;
    for (const show of this.shown) show();
    this.changed(names);
  }
}
