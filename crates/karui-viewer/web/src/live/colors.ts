// Colours of clusters: each its own, or by level, and what they stand for.

import { h } from '../dom';
import type { Surface } from './surface';

export type Colors = 'clay' | 'cluster' | 'level';

type Rgb = readonly [number, number, number];

/** Colours that the colour-blind tell apart (M. Okabe, K. Ito: Color Universal Design, 2008), without black. */
const OKABE_ITO: readonly Rgb[] = [
  [230, 159, 0], [86, 180, 233], [0, 158, 115], [240, 228, 66], [0, 114, 178], [213, 94, 0], [204, 121, 167],
];

/** From coarse to fine: cividis, which rises in brightness throughout. */
const CIVIDIS: readonly Rgb[] = [[0, 32, 76], [49, 68, 107], [87, 93, 109], [124, 123, 120], [166, 157, 117], [211, 193, 100], [255, 233, 69]];

/** Brightness of a cluster's colour, least and most; share of white in it, at most. */
const [DARK, BRIGHT, PALE] = [0.5, 1.0, 0.3];

/** Numbers in a row become numbers far apart, no two the same (A. Appleby: MurmurHash3, 2011). */
function scattered(number: number): number {
  let hash = Math.imul(number ^ (number >>> 16), 0x85ebca6b);
  hash = Math.imul(hash ^ (hash >>> 13), 0xc2b2ae35);
  return (hash ^ (hash >>> 16)) >>> 0;
}

/** The colour of a cluster, from its number in the graph alone: neighbours have numbers in a row. */
export function ofCluster(cluster: number): Rgb {
  const hash = scattered(cluster + 1);
  const [bright, pale] = [DARK + (BRIGHT - DARK) * ((hash >>> 24) / 255), PALE * (((hash >>> 16) & 255) / 255)];
  const mixed = (x: number) => bright * (x + pale * (255 - x));
  const [r, g, b] = OKABE_ITO[hash % OKABE_ITO.length]!;
  return [mixed(r), mixed(g), mixed(b)];
}

/** The colour of a level, 0 the finest of so many. */
export function ofLevel(level: number, levels: number): Rgb {
  const at = levels > 1 ? (1 - level / (levels - 1)) * (CIVIDIS.length - 1) : CIVIDIS.length - 1;
  const from = Math.min(Math.max(0, Math.floor(at)), CIVIDIS.length - 2);
  const [a, b] = [CIVIDIS[from]!, CIVIDIS[from + 1]!];
  return [0, 1, 2].map((k) => a[k]! + (at - from) * (b[k]! - a[k]!)) as unknown as Rgb;
}

const css = (color: Rgb): string => `rgb(${color.map(Math.round).join(' ')})`;

/** Colours a surface of clusters, with a legend over the picture. */
export class Colouring {
  private readonly legend = h('figure', { class: 'legend', hidden: true });

  constructor(
    private readonly surface: Surface,
    private readonly levels: number,
    overlay: HTMLElement,
  ) {
    overlay.append(this.legend);
  }

  show(colors: Colors): void {
    this.legend.hidden = colors === 'clay';
    if (colors === 'clay') return;
    this.surface.color(colors === 'cluster' ? ofCluster : (_, level) => ofLevel(level, this.levels));
    this.legend.replaceChildren(...(colors === 'cluster' ? this.ofClusters() : this.ofLevels()));
  }

  close(): void {
    this.legend.remove();
  }

  private ofClusters(): HTMLElement[] {
    const some = OKABE_ITO.map((color) => css(color)).join(', ');
    return [this.caption('Clusters'), this.ramp(some), h('div', { class: 'mean' }, 'The colour of a cluster comes from its number in the graph: it keeps it wherever the camera goes.')];
  }

  private ofLevels(): HTMLElement[] {
    const all = Array.from({ length: this.levels }, (_, i) => css(ofLevel(this.levels - 1 - i, this.levels)));
    const ends = h('div', { class: 'ends' }, h('span', {}, `${this.levels - 1}, coarsest`), h('span', {}, '0, finest'));
    return [this.caption('Level of the cluster'), this.ramp(all.join(', ')), ends];
  }

  private caption(text: string): HTMLElement {
    return h('figcaption', {}, text);
  }

  /** Steps of equal width, without blending: they are colours that are there. */
  private ramp(colors: string): HTMLElement {
    const ramp = h('div', { class: 'ramp', 'aria-hidden': 'true' });
    const all = colors.split(', ');
    const stop = (color: string, i: number) => `${color} ${(100 * i) / all.length}% ${(100 * (i + 1)) / all.length}%`;
    ramp.style.background = `linear-gradient(to right, ${all.map(stop).join(', ')})`;
    return ramp;
  }
}
