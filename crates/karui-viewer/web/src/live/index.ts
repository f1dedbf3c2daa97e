// Live refinement: the server cuts a hierarchy as the camera and the light move.

import { Mesh, MeshBasicMaterial } from 'three';
import type { Summary } from '../api';
import { Choice, check } from '../dom';
import { bytes, count, number } from '../format';
import type { Host, Mode } from '../mode';
import { Facts, type Knob, part, slider } from './controls';
import type { Ready } from './link';
import { Recorder } from './record';
import { type Asker, type Numbers, quantile, Watch } from './watch';

/** Width at which a picture is worth dividing, CSS pixels. */
const ROOM = 600;

type Which = 'half-edge' | 'clusters';

/** What can be asked for, under the names of the protocol. */
const KNOBS: Record<Which, Record<string, Knob>> = {
  'half-edge': {
    area: { label: 'Area τ', unit: 'px²', from: 1, to: 4000, log: true, value: 100, hint: 'Least area on the screen of what a vertex touches' },
    flatness: { label: 'Flatness φ', unit: '°', from: 0, to: 45, step: 0.5, value: 3, hint: 'Least angle between normals' },
    silhouette: { label: 'Silhouettes', unit: 'px²', from: 1, to: 4000, log: true, value: 25, hint: 'Kept down to this area' },
    light_silhouette: { label: 'Shadow line', unit: 'px²', from: 1, to: 4000, log: true, value: 25, hint: 'Where light and dark part: kept down to this area' },
    highlight: { label: 'Highlight ρ', unit: '°', from: 0, to: 60, step: 1, value: 15, hint: 'Kept within this angle of the mirrored light' },
    highlight_area: { label: 'Highlight area', unit: 'px²', from: 1, to: 4000, log: true, value: 25, hint: 'Highlights are kept down to this area' },
  },
  clusters: {
    threshold: { label: 'Error', unit: 'px', from: 0.1, to: 50, log: true, value: 1, hint: 'Largest error on the screen' },
    light_factor: { label: 'In light', unit: '×', from: 0.05, to: 1, log: true, value: 1, hint: 'Factor to the error in highlights and where light and dark part' },
  },
};

const TRIANGLES: Knob = { label: 'At most', unit: '', from: 500, to: 2_000_000, log: true, value: 100_000 };
const TIME: Knob = { label: 'About', unit: 'ms', from: 0.5, to: 50, log: true, value: 5, hint: 'Of the refinement; the rest waits for the next frame' };

class Live implements Mode, Asker {
  readonly tab = 'live';
  readonly label = 'Live';
  readonly keys = [['O', 'second window: the same triangles from outside'], ['P', 'record a camera path']] as const;
  private host: Host | null = null;
  private file: Summary | null = null;
  private watch: Watch | null = null;
  private recorder: Recorder | null = null;
  private which: Which = 'half-edge';
  private readonly options: Record<Which, Record<string, number | boolean>> = {
    'half-edge': { frustum: true, back_facing: true },
    clusters: { frustum: true, back_facing: false },
  };
  private readonly budget = { triangles: TRIANGLES.value, milliseconds: TIME.value };
  private readonly limits = { triangles: false, milliseconds: false };
  /** Not chosen yet: where there is room. */
  private outside: boolean | null = null;
  private flat = false;
  private wire = false;
  private readonly facts = new Facts();

  accepts(file: Summary): boolean {
    return file.kind === 'model' && (file.can.live || file.can.clusters);
  }

  async enter(host: Host, file: Summary): Promise<void> {
    [this.host, this.file] = [host, file];
    this.outside ??= host.stage.canvas.clientWidth >= ROOM;
    this.start();
  }

  leave(): void {
    this.recorder?.stop();
    this.watch?.close();
    this.watch = this.recorder = this.host = null;
  }

  key(event: KeyboardEvent): boolean {
    if (event.key === 'o') this.setOutside(!this.outside);
    else if (event.key === 'p') this.recorder?.toggle();
    else return false;
    return true;
  }

  ask(): object {
    const budget: Record<string, number> = {};
    if (this.limits.triangles) budget['triangles'] = Math.round(this.budget.triangles);
    if (this.limits.milliseconds) budget['milliseconds'] = this.budget.milliseconds;
    return { options: this.options[this.which], budget };
  }

  ready(about: Ready): void {
    const { watch, host } = this;
    if (!watch?.surface || !host) return;
    const line = new MeshBasicMaterial({ color: 0x0b0d10, wireframe: true, transparent: true, opacity: 0.5, polygonOffset: true, polygonOffsetFactor: -1, polygonOffsetUnits: -1 });
    const wire = new Mesh(watch.surface.geometry, line);
    wire.frustumCulled = false;
    watch.edges(wire);
    watch.paint(this.flat, this.wire);
    watch.look(this.outside === true);
    this.facts.clear();
    this.facts.set('Finest', count(about.triangles ?? 0));
    this.facts.set('Coarsest', count(about.coarsest ?? 0));
    this.facts.set('Prepared in', `${number(about.seconds ?? 0)} s`);
    Object.assign(window.karui, { live: this.tests(watch) });
  }

  progress(message: string): void {
    this.facts.set('Preparing', message);
  }

  answered(numbers: Numbers): void {
    const { facts } = this;
    facts.set('Triangles', count(numbers.triangles));
    facts.set(this.which === 'clusters' ? 'Came, went' : 'Splits, collapses', numbers.changes.map(count).join(', '));
    facts.set('Frame', bytes(numbers.bytes));
    facts.set('Answer', `${number(quantile(numbers.latencies, 0.5))} ms, 95 %: ${number(quantile(numbers.latencies, 0.95))}`);
    facts.set('Server', `${number(numbers.server)} ms`);
    const unit = this.which === 'clusters' ? 'px' : 'px²';
    facts.set('Left out below', numbers.truncated ? `${number(numbers.level)} ${unit}` : 'nothing');
    Object.assign(window.karui, { triangles: numbers.triangles, ready: true });
  }

  /** What tests read and set. */
  private tests(watch: Watch): object {
    return {
      numbers: watch.numbers,
      go: watch.go.bind(watch),
      mesh: () => watch.surface?.mesh(),
      path: () => this.recorder?.json(),
      options: this.options[this.which],
      setLamp: (azimuth: number, elevation: number) => this.turnLamp(azimuth, elevation),
    };
  }

  private start(): void {
    const { host, file } = this;
    if (!host || !file) return;
    this.recorder?.stop();
    this.watch?.close();
    Object.assign(window.karui, { ready: false });
    this.facts.clear();
    this.watch = new Watch(host, `files/${file.id}/live?kind=${this.which}`, this);
    this.recorder = new Recorder(this.watch, file.name);
    host.panel.replaceChildren(...this.controls());
  }

  private controls(): HTMLElement[] {
    const pick = (which: Which): void => {
      this.which = which;
      this.start();
    };
    const kinds = new Choice<Which>('Hierarchy', [['half-edge', 'Half-edges'], ['clusters', 'Clusters']], pick);
    kinds.set(this.which);
    const hidden = this.which === 'clusters' ? 'Left out' : 'Coarse';
    return [
      part('Hierarchy', kinds.element, this.facts.element),
      part('What is kept', ...this.knobs(), this.box(`${hidden} outside the picture`, 'frustum'), this.box(`${hidden} where it faces away`, 'back_facing')),
      part('Budget', ...this.limit('triangles', TRIANGLES), ...(this.which === 'half-edge' ? this.limit('milliseconds', TIME) : [])),
      part('Light', ...this.lamp()),
      part('View', ...this.views()),
      part('Camera path', this.recorder!.element),
    ];
  }

  private knobs(): HTMLElement[] {
    const options = this.options[this.which];
    return Object.entries(KNOBS[this.which]).map(([name, knob]) => {
      options[name] ??= knob.value;
      return slider({ ...knob, value: options[name] as number }, (value) => {
        options[name] = value;
        this.watch?.ask();
      });
    });
  }

  private box(label: string, name: string): HTMLElement {
    const options = this.options[this.which];
    const [element, box] = check(label, '', (on) => {
      options[name] = on;
      this.watch?.ask();
    });
    box.checked = options[name] as boolean;
    return element;
  }

  private limit(name: 'triangles' | 'milliseconds', knob: Knob): HTMLElement[] {
    const set = (value: number): void => {
      this.budget[name] = value;
      if (this.limits[name]) this.watch?.ask();
    };
    const row = slider({ ...knob, value: this.budget[name] }, set);
    const [element, box] = check(name === 'triangles' ? 'Limit triangles' : 'Limit time', '', (on) => {
      this.limits[name] = on;
      this.watch?.ask();
    });
    box.checked = this.limits[name];
    return [element, row];
  }

  private lamp(): HTMLElement[] {
    const angles = { azimuth: -40, elevation: 45 };
    const knob = (label: string, most: number, name: keyof typeof angles): HTMLElement =>
      slider({ label, unit: '°', from: -most, to: most, step: 1, value: angles[name] }, (value) => {
        angles[name] = value;
        this.turnLamp(angles.azimuth, angles.elevation);
      });
    const [element, box] = check('Light counts', '', (on) => {
      if (!this.watch) return;
      this.watch.lit = on;
      this.watch.ask();
    });
    box.checked = true;
    return [element, knob('Around', 180, 'azimuth'), knob('Up', 90, 'elevation')];
  }

  private turnLamp(azimuth: number, elevation: number): void {
    this.watch?.lamp?.at(azimuth, elevation);
    this.watch?.ask();
  }

  private views(): HTMLElement[] {
    const paint = (): void => this.watch?.paint(this.flat, this.wire);
    const [outside, first] = check('Second window from outside', 'O', (on) => this.setOutside(on));
    const [flat, second] = check('Flat', '', (on) => {
      this.flat = on;
      paint();
    });
    const [wire, third] = check('Wireframe', '', (on) => {
      this.wire = on;
      paint();
    });
    [first.checked, second.checked, third.checked] = [this.outside === true, this.flat, this.wire];
    first.dataset['outside'] = '';
    return [outside, flat, wire];
  }

  private setOutside(on: boolean): void {
    this.outside = on;
    const box = this.host?.panel.querySelector<HTMLInputElement>('[data-outside]');
    if (box) box.checked = on;
    this.watch?.look(on);
  }
}

export const live: Mode = new Live();
