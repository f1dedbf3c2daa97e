// Adaptive subdivision: a control mesh made smooth where it is looked at.

import { BufferAttribute, BufferGeometry, LineBasicMaterial, LineSegments } from 'three';
import type { Summary } from '../api';
import { bytes, count, number } from '../format';
import { Facts, part } from '../live/controls';
import { LAMP, lampControls } from '../live/lamp';
import type { Ready } from '../live/link';
import { type Asker, type Numbers, quantile, Watch } from '../live/watch';
import type { Host, Mode } from '../mode';
import { type About, Options } from '../options';

const SCHEMES = [
  ['adaptive', 'Adaptive (√2 steps)'],
  ['catmull-clark', 'Catmull-Clark'],
  ['sqrt2', '√2'],
  ['loop', 'Loop (triangles)'],
  ['sqrt3', '√3 (triangles)'],
  ['bilinear', 'Bilinear'],
] as const;

const RULES = {
  boundary: [['', 'As the file says'], ['corner', 'Smooth, corners stay'], ['edge', 'Smooth, corners round'], ['none', 'Left out']],
  creases: [['', 'As the file says'], ['uniform', 'Uniform'], ['chaikin', 'Chaikin']],
  triangles: [['', 'As the file says'], ['catmull-clark', 'Catmull-Clark'], ['smooth', 'Smooth']],
} as const;

const NAMES = { boundary: 'Boundary', creases: 'Creases', triangles: 'Triangles' };

const defaults = {
  scheme: 'adaptive',
  pixels: 1,
  levels: 2,
  two_sided: false,
  boundary: '',
  creases: '',
  triangles: '',
  ...LAMP,
  outside: false,
  cage: true,
  wire: true,
  flat: false,
};

type SubdivOptions = typeof defaults;

const first = (words: readonly (readonly [string, string])[]): string[] => words.map(([word]) => word);

const ABOUT: About<SubdivOptions> = {
  defaults,
  words: { scheme: first(SCHEMES), boundary: first(RULES.boundary), creases: first(RULES.creases), triangles: first(RULES.triangles) },
};

/** Options that change what is drawn, but not what is asked for. */
const LOOKS: ReadonlySet<keyof SubdivOptions> = new Set(['cage', 'wire', 'flat'] as const);

class AdaptiveMode implements Mode, Asker {
  readonly tab = 'adaptive';
  readonly label = 'Subdivide';
  readonly keys = [['O', 'second window: the same faces from outside'], ['C', 'control mesh']] as const;
  private host: Host | null = null;
  private watch: Watch | null = null;
  private cage: LineSegments | null = null;
  private options: Options<SubdivOptions> | null = null;
  private readonly facts = new Facts();

  accepts(file: Summary): boolean {
    return file.kind === 'model' && file.can.subdivide;
  }

  async enter(host: Host, file: Summary): Promise<void> {
    this.host = host;
    this.facts.clear();
    Object.assign(window.karui, { ready: false });
    this.options = new Options(host.store, 'adaptive', ABOUT, (names) => this.follow(names));
    this.watch = new Watch(host, `files/${file.id}/adaptive`, this);
    this.draw();
  }

  leave(): void {
    this.watch?.close();
    this.cage?.geometry.dispose();
    this.options?.close();
    this.watch = this.cage = this.host = this.options = null;
  }

  key(event: KeyboardEvent): boolean {
    if (event.key === 'o') this.options?.set({ outside: !this.values.outside });
    else if (event.key === 'c') this.options?.set({ cage: !this.values.cage });
    else return false;
    return true;
  }

  ask(): object {
    const { scheme, pixels, levels, two_sided } = this.values;
    const how = scheme === 'adaptive' ? { scheme, pixels, two_sided } : { scheme, levels };
    const rules = (Object.keys(RULES) as (keyof typeof RULES)[]).map((name) => [name, this.values[name]]);
    return { options: { how, ...Object.fromEntries(rules.filter(([, rule]) => rule)) } };
  }

  ready({ cage, faces }: Ready): void {
    const { watch } = this;
    if (!watch?.surface || !cage) return;
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(new Float32Array(cage.positions), 3));
    geometry.setIndex(new BufferAttribute(new Uint32Array(cage.edges), 1));
    this.cage = new LineSegments(geometry, new LineBasicMaterial({ color: 0xffb454 }));
    watch.scene.add(this.cage);
    const line = new LineBasicMaterial({ color: 0x0b0d10, transparent: true, opacity: 0.45 });
    const sides = new LineSegments(watch.surface.sides, line);
    sides.frustumCulled = false;
    watch.edges(sides);
    this.facts.set('Cage', `${count(faces ?? 0)} faces`);
    Object.assign(window.karui, { adaptive: this.tests(watch) });
    this.light();
    this.show();
    watch.look(this.values.outside);
  }

  lampMoved(): void {
    const { watch } = this;
    if (watch?.lamp) this.options?.set(watch.lamp.place());
  }

  progress(message: string): void {
    this.facts.set('Preparing', message);
  }

  answered(numbers: Numbers): void {
    const { facts } = this;
    facts.set('Faces', count(numbers.changes[0]));
    facts.set('Triangles', count(numbers.triangles));
    facts.set('Frame', bytes(numbers.bytes));
    facts.set('Answer', `${number(quantile(numbers.latencies, 0.5))} ms, 95 %: ${number(quantile(numbers.latencies, 0.95))}`);
    facts.set('Complete', numbers.truncated ? 'no: too many faces' : 'yes');
    Object.assign(window.karui, { triangles: numbers.triangles, ready: true });
  }

  /** What tests read and set. */
  private tests(watch: Watch): object {
    return {
      numbers: watch.numbers,
      go: watch.go.bind(watch),
      set: (scheme: string, amount: number) => {
        this.options?.set({ scheme, ...(scheme === 'adaptive' ? { pixels: amount } : { levels: amount }) });
      },
    };
  }

  private get values(): Readonly<SubdivOptions> {
    return this.options?.values ?? defaults;
  }

  /** The options have changed, by whatever. */
  private follow(names: ReadonlySet<keyof SubdivOptions>): void {
    if (names.has('scheme')) this.draw();
    if (!this.watch?.lamp) return;
    this.light();
    this.show();
    if (names.has('outside')) this.watch.look(this.values.outside);
    if ([...names].some((name) => !LOOKS.has(name))) this.watch.ask();
  }

  private light(): void {
    const { around, up, away } = this.values;
    this.watch?.lamp?.at(around, up, away);
  }

  private show(): void {
    const { watch, cage, values } = this;
    if (cage) cage.visible = values.cage;
    watch?.paint(values.flat, values.wire);
  }

  private draw(): void {
    const options = this.options!;
    options.forget();
    const rules = (Object.keys(RULES) as (keyof typeof RULES)[]).map((name) => options.select(name, NAMES[name], RULES[name]));
    this.host?.panel.replaceChildren(
      part('Surface', options.select('scheme', 'Scheme', SCHEMES), ...this.amount(options)),
      part('Rules', ...rules),
      part('Light', ...lampControls(options)),
      part('View', options.box('outside', 'Second window from outside', 'O'), options.box('cage', 'Control mesh', 'C'), options.box('wire', 'Sides of faces'), options.box('flat', 'Flat')),
      part('Now', this.facts.element),
    );
  }

  private amount(options: Options<SubdivOptions>): HTMLElement[] {
    if (this.values.scheme !== 'adaptive') {
      return [options.slider('levels', { label: 'Steps', unit: '', from: 0, to: 6, step: 1, value: defaults.levels })];
    }
    const hint = 'Distance to the limit surface on the screen; silhouettes are twice as close';
    return [
      options.slider('pixels', { label: 'Tolerance', unit: 'px', from: 0.05, to: 20, log: true, value: defaults.pixels, hint }),
      options.box('two_sided', 'Seen from both sides'),
    ];
  }
}

export const adaptive: Mode = new AdaptiveMode();
