// What is shown: one plain object, kept in the address behind `#`, so that a link shows the same.

export type Tab = 'model' | 'live' | 'adaptive' | 'tiles';
export type Look = 'material' | 'clay' | 'normals' | 'uv';
export type Compare = 'off' | 'side' | 'wipe';

export interface State {
  /** Number of the file. */
  file: number;
  tab: Tab;
  /** Level that is shown, 0 the original; the distance decides while `auto`. */
  level: number;
  auto: boolean;
  /** Largest error on the screen, CSS pixels, while `auto`. */
  tolerance: number;
  /** Most triangles, 0 for any number, while `auto`. */
  budget: number;
  compare: Compare;
  /** Where the wipe stands, 0 (all level) to 1 (all original). */
  wipe: number;
  look: Look;
  flat: boolean;
  wire: boolean;
  /** Kind of heat map, or none. */
  heat: string;
  /** Options of live refinement that are not as usual, `name:value,name:value` (`options.ts`). */
  live: string;
  /** The same of subdivision. */
  adaptive: string;
  /** The same of 3D Tiles. */
  tiles: string;
  /** Eye and target, model units; empty for where the model is seen whole. */
  camera: number[];
}

export const DEFAULTS: Readonly<State> = {
  file: 0,
  tab: 'model',
  level: 0,
  auto: false,
  tolerance: 1,
  budget: 0,
  compare: 'off',
  wipe: 0.5,
  look: 'material',
  flat: false,
  wire: false,
  heat: '',
  live: '',
  adaptive: '',
  tiles: '',
  camera: [],
};

const CHOICES: { [K in keyof State]?: readonly string[] } = {
  tab: ['model', 'live', 'adaptive', 'tiles'],
  compare: ['off', 'side', 'wipe'],
  look: ['material', 'clay', 'normals', 'uv'],
};

/** A value as it stands in the address. */
function written(value: State[keyof State]): string {
  if (typeof value === 'boolean') return value ? '1' : '0';
  if (Array.isArray(value)) return value.map((x) => Number(x.toPrecision(6))).join(',');
  return String(value);
}

/** A value from the address; what makes no sense is left at its default. */
function read<K extends keyof State>(key: K, text: string): State[K] {
  const fallback = DEFAULTS[key];
  let value: unknown = text;
  if (typeof fallback === 'boolean') value = text === '1';
  else if (typeof fallback === 'number') value = Number(text);
  else if (Array.isArray(fallback)) value = text.split(',').map(Number);
  const numbers = [value].flat().filter((v) => typeof v === 'number');
  const known = CHOICES[key]?.includes(text) ?? true;
  const sound = known && numbers.every(Number.isFinite) && (key !== 'camera' || numbers.length === 6);
  return sound ? (value as State[K]) : fallback;
}

export function fromHash(hash: string): State {
  const state: State = { ...DEFAULTS };
  for (const [key, text] of new URLSearchParams(hash.replace(/^#/, ''))) {
    if (Object.hasOwn(DEFAULTS, key)) Object.assign(state, { [key]: read(key as keyof State, text) });
  }
  return state;
}

export function toHash(state: State): string {
  const query = new URLSearchParams();
  for (const key of Object.keys(DEFAULTS) as (keyof State)[]) {
    const text = written(state[key]);
    if (text !== written(DEFAULTS[key])) query.set(key, text);
  }
  const text = query.toString().replaceAll('%2C', ',').replaceAll('%3A', ':');
  return text && `#${text}`;
}

type Listener = (state: Readonly<State>, changed: ReadonlySet<keyof State>) => void;

/** The state and who wants to know when it changes. */
export class Store {
  private readonly listeners = new Set<Listener>();
  private timer = 0;

  constructor(private current: State) {}

  get state(): Readonly<State> {
    return this.current;
  }

  set(patch: Partial<State>): void {
    const keys = Object.keys(patch) as (keyof State)[];
    const changed = new Set(keys.filter((k) => written(patch[k]!) !== written(this.current[k])));
    if (changed.size === 0) return;
    this.current = { ...this.current, ...patch };
    for (const listener of [...this.listeners]) listener(this.current, changed);
    // Browsers refuse addresses that change too often.
    this.timer ||= window.setTimeout(() => this.write(), 300);
  }

  /** Calls at every change, until what it returns is called. */
  subscribe(listener: Listener): () => void {
    this.listeners.add(listener);
    return () => this.listeners.delete(listener);
  }

  /** The address that shows this state. */
  link(): string {
    return location.href.replace(/#.*$/, '') + toHash(this.current);
  }

  private write(): void {
    this.timer = 0;
    history.replaceState(null, '', this.link());
  }
}
