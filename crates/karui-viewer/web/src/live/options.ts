// What can be chosen of live refinement, and what is asked for then.

import type { About } from '../options';
import type { Knob } from './controls';
import { LAMP } from './lamp';

export type Which = 'half-edge' | 'clusters';

/** What can be asked for, under the names of the protocol. */
export const KNOBS = {
  'half-edge': {
    'half-edge.area': { label: 'Area τ', unit: 'px²', from: 1, to: 4000, log: true, value: 100, hint: 'Least area on the screen of what a vertex touches' },
    'half-edge.flatness': { label: 'Flatness φ', unit: '°', from: 0, to: 45, step: 0.5, value: 3, hint: 'Least angle between normals' },
    'half-edge.silhouette': { label: 'Silhouettes', unit: 'px²', from: 1, to: 4000, log: true, value: 25, hint: 'Kept down to this area' },
    'half-edge.light_silhouette': { label: 'Shadow line', unit: 'px²', from: 1, to: 4000, log: true, value: 25, hint: 'Where light and dark part: kept down to this area' },
    'half-edge.highlight': { label: 'Highlight ρ', unit: '°', from: 0, to: 60, step: 1, value: 15, hint: 'Kept within this angle of the mirrored light' },
    'half-edge.highlight_area': { label: 'Highlight area', unit: 'px²', from: 1, to: 4000, log: true, value: 25, hint: 'Highlights are kept down to this area' },
  },
  clusters: {
    'clusters.threshold': { label: 'Error', unit: 'px', from: 0.1, to: 50, log: true, value: 1, hint: 'Largest error on the screen' },
    'clusters.light_factor': { label: 'In light', unit: '×', from: 0.05, to: 1, log: true, value: 1, hint: 'Factor to the error in highlights and where light and dark part' },
  },
} satisfies Record<Which, Record<string, Knob>>;

export const TRIANGLES: Knob = { label: 'At most', unit: '', from: 500, to: 2_000_000, log: true, value: 100_000 };
export const TIME: Knob = { label: 'About', unit: 'ms', from: 0.5, to: 50, log: true, value: 5, hint: 'Of the refinement; the rest waits for the next frame' };

type Names<W extends Which> = keyof (typeof KNOBS)[W];

/** Where the sliders stand at first. */
const usual = <W extends Which>(which: W): Record<Names<W>, number> =>
  Object.fromEntries(Object.entries(KNOBS[which]).map(([name, knob]) => [name, (knob as Knob).value])) as Record<Names<W>, number>;

const defaults = {
  kind: 'half-edge',
  ...usual('half-edge'),
  'half-edge.frustum': true,
  'half-edge.back_facing': true,
  ...usual('clusters'),
  'clusters.frustum': true,
  'clusters.back_facing': false,
  limit_triangles: false,
  triangles: TRIANGLES.value,
  limit_time: false,
  milliseconds: TIME.value,
  lit: true,
  ...LAMP,
  /** The second window: where there is room, or yes or no. */
  outside: 'room',
  flat: false,
  wire: false,
  colors: 'clay',
};

export type LiveOptions = typeof defaults;

export const ABOUT: About<LiveOptions> = {
  defaults,
  words: { kind: ['half-edge', 'clusters'], outside: ['room', 'yes', 'no'], colors: ['clay', 'cluster', 'level'] },
};

/** Options that change what is drawn, but not what is asked for. */
export const LOOKS: ReadonlySet<keyof LiveOptions> = new Set(['flat', 'wire', 'colors'] as const);

/** Options of a message, under the names of the protocol. */
export function asked(values: Readonly<LiveOptions>): Record<string, number | boolean> {
  const own = Object.entries(values).filter(([name]) => name.startsWith(`${values.kind}.`));
  return Object.fromEntries(own.map(([name, value]) => [name.slice(values.kind.length + 1), value as number | boolean]));
}

/** The budget of a message. */
export function budget(values: Readonly<LiveOptions>): Record<string, number> {
  return {
    ...(values.limit_triangles && { triangles: Math.round(values.triangles) }),
    ...(values.limit_time && values.kind === 'half-edge' && { milliseconds: values.milliseconds }),
  };
}
