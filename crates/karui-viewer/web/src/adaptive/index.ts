// Adaptive subdivision: a control mesh made smooth where it is looked at.

import { BufferAttribute, BufferGeometry, LineBasicMaterial, LineSegments } from 'three';
import type { Summary } from '../api';
import { check, field, h } from '../dom';
import { bytes, count, number } from '../format';
import { Facts, part, slider } from '../live/controls';
import type { Ready } from '../live/link';
import { type Asker, type Numbers, quantile, Watch } from '../live/watch';
import type { Host, Mode } from '../mode';

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

class AdaptiveMode implements Mode, Asker {
  readonly tab = 'adaptive';
  readonly label = 'Subdivide';
  readonly keys = [['O', 'second window: the same faces from outside'], ['C', 'control mesh']] as const;
  private host: Host | null = null;
  private watch: Watch | null = null;
  private cage: LineSegments | null = null;
  private scheme = 'adaptive';
  private pixels = 1;
  private levels = 2;
  private readonly rules: Record<keyof typeof RULES, string> = { boundary: '', creases: '', triangles: '' };
  private twoSided = false;
  private readonly shown = { outside: false, cage: true, wire: true, flat: false };
  private readonly facts = new Facts();

  accepts(file: Summary): boolean {
    return file.kind === 'model' && file.can.subdivide;
  }

  async enter(host: Host, file: Summary): Promise<void> {
    this.host = host;
    this.facts.clear();
    Object.assign(window.karui, { ready: false });
    this.watch = new Watch(host, `files/${file.id}/adaptive`, this);
    this.draw();
  }

  leave(): void {
    this.watch?.close();
    this.cage?.geometry.dispose();
    this.watch = this.cage = this.host = null;
  }

  key(event: KeyboardEvent): boolean {
    if (event.key === 'o') this.shown.outside = !this.shown.outside;
    else if (event.key === 'c') this.shown.cage = !this.shown.cage;
    else return false;
    this.show();
    this.draw();
    return true;
  }

  ask(): object {
    const how =
      this.scheme === 'adaptive'
        ? { scheme: 'adaptive', pixels: this.pixels, two_sided: this.twoSided }
        : { scheme: this.scheme, levels: this.levels };
    const given = Object.entries(this.rules).filter(([, rule]) => rule);
    return { options: { how, ...Object.fromEntries(given) } };
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
    this.show();
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
        this.scheme = scheme;
        if (scheme === 'adaptive') this.pixels = amount;
        else this.levels = amount;
        this.draw();
        watch.ask();
      },
    };
  }

  private show(): void {
    const { watch, cage, shown } = this;
    if (cage) cage.visible = shown.cage;
    watch?.paint(shown.flat, shown.wire);
    watch?.look(shown.outside);
  }

  private draw(): void {
    this.host?.panel.replaceChildren(
      part('Surface', this.select('Scheme', SCHEMES, this.scheme, (scheme) => this.pick(scheme)), ...this.amount()),
      part('Rules', ...this.selects()),
      part('View', ...this.boxes()),
      part('Now', this.facts.element),
    );
  }

  private pick(scheme: string): void {
    this.scheme = scheme;
    this.draw();
    this.watch?.ask();
  }

  private amount(): HTMLElement[] {
    if (this.scheme !== 'adaptive') {
      return [slider({ label: 'Steps', unit: '', from: 0, to: 6, step: 1, value: this.levels }, (levels) => this.set({ levels }))];
    }
    const hint = 'Distance to the limit surface on the screen; silhouettes are twice as close';
    const [element, box] = check('Seen from both sides', '', (twoSided) => this.set({ twoSided }));
    box.checked = this.twoSided;
    return [
      slider({ label: 'Tolerance', unit: 'px', from: 0.05, to: 20, log: true, value: this.pixels, hint }, (pixels) => this.set({ pixels })),
      element,
    ];
  }

  private set(what: Partial<{ levels: number; pixels: number; twoSided: boolean }>): void {
    Object.assign(this, what);
    this.watch?.ask();
  }

  private selects(): HTMLElement[] {
    const names = Object.keys(RULES) as (keyof typeof RULES)[];
    return names.map((name) =>
      this.select(NAMES[name], RULES[name], this.rules[name], (rule) => {
        this.rules[name] = rule;
        this.watch?.ask();
      }),
    );
  }

  private select(label: string, options: readonly (readonly [string, string])[], chosen: string, pick: (value: string) => void): HTMLElement {
    const items = options.map(([value, text]) => h('option', { value, selected: value === chosen }, text));
    const select = h('select', { onchange: () => pick(select.value) }, ...items);
    return field(label, select);
  }

  private boxes(): HTMLElement[] {
    const labels = { outside: ['Second window from outside', 'O'], cage: ['Control mesh', 'C'], wire: ['Sides of faces', ''], flat: ['Flat', ''] } as const;
    return (Object.keys(labels) as (keyof typeof labels)[]).map((name) => {
      const [element, box] = check(labels[name][0], labels[name][1], (on) => {
        this.shown[name] = on;
        this.show();
      });
      box.checked = this.shown[name];
      return element;
    });
  }
}

export const adaptive: Mode = new AdaptiveMode();
