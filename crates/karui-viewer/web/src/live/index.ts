// Live refinement: the server cuts a hierarchy as the camera and the light move.

import { Mesh, MeshBasicMaterial } from 'three';
import type { Summary } from '../api';
import { check, Choice } from '../dom';
import { bytes, count, number } from '../format';
import type { Host, Mode } from '../mode';
import { Options } from '../options';
import { type Colors, Colouring } from './colors';
import { Facts, type Knob, part } from './controls';
import { lampControls } from './lamp';
import type { Ready } from './link';
import { ABOUT, asked, budget, KNOBS, type LiveOptions, LOOKS, TIME, TRIANGLES, type Which } from './options';
import { Recorder } from './record';
import { type Asker, type Numbers, quantile, Watch } from './watch';

/** Width at which a picture is worth dividing, CSS pixels. */
const ROOM = 600;

class Live implements Mode, Asker {
  readonly tab = 'live';
  readonly label = 'Live';
  readonly keys = [['O', 'second window: the same triangles from outside'], ['P', 'record a camera path'], ['K', 'colours of clusters']] as const;
  private host: Host | null = null;
  private file: Summary | null = null;
  private watch: Watch | null = null;
  private recorder: Recorder | null = null;
  private options: Options<LiveOptions> | null = null;
  private colouring: Colouring | null = null;
  private readonly facts = new Facts();

  accepts(file: Summary): boolean {
    return file.kind === 'model' && (file.can.live || file.can.clusters);
  }

  async enter(host: Host, file: Summary): Promise<void> {
    [this.host, this.file] = [host, file];
    this.options = new Options(host.store, 'live', ABOUT, (names) => this.follow(names));
    this.start();
  }

  leave(): void {
    this.recorder?.stop();
    this.watch?.close();
    this.options?.close();
    this.watch = this.recorder = this.host = this.options = this.colouring = null;
  }

  key(event: KeyboardEvent): boolean {
    const order: Colors[] = ['clay', 'cluster', 'level'];
    if (event.key === 'o') this.options?.set({ outside: this.outside ? 'no' : 'yes' });
    else if (event.key === 'p') this.recorder?.toggle();
    else if (event.key === 'k' && this.values.kind === 'clusters') {
      this.options?.set({ colors: order[(order.indexOf(this.values.colors as Colors) + 1) % order.length]! });
    } else return false;
    return true;
  }

  ask(): object {
    return { options: asked(this.values), budget: budget(this.values) };
  }

  ready(about: Ready): void {
    const { watch, host } = this;
    if (!watch?.surface || !host) return;
    const line = new MeshBasicMaterial({ color: 0x0b0d10, wireframe: true, transparent: true, opacity: 0.5, polygonOffset: true, polygonOffsetFactor: -1, polygonOffsetUnits: -1 });
    const wire = new Mesh(watch.surface.geometry, line);
    wire.frustumCulled = false;
    watch.edges(wire);
    this.colouring = about.levels === undefined ? null : new Colouring(watch.surface, about.levels, host.overlay);
    this.light();
    this.paint();
    watch.look(this.outside);
    this.facts.clear();
    this.facts.set('Finest', count(about.triangles ?? 0));
    this.facts.set('Coarsest', count(about.coarsest ?? 0));
    this.facts.set('Prepared in', `${number(about.seconds ?? 0)} s`);
    Object.assign(window.karui, { live: this.tests(watch) });
  }

  progress(message: string): void {
    this.facts.set('Preparing', message);
  }

  lampMoved(): void {
    const { watch } = this;
    if (watch?.lamp) this.options?.set(watch.lamp.place());
  }

  answered(numbers: Numbers): void {
    const { facts } = this;
    const clusters = this.values.kind === 'clusters';
    facts.set('Triangles', count(numbers.triangles));
    if (clusters) facts.set('Clusters', count(numbers.slots));
    facts.set(clusters ? 'Came, went' : 'Splits, collapses', numbers.changes.map(count).join(', '));
    facts.set('Frame', bytes(numbers.bytes));
    facts.set('Answer', `${number(quantile(numbers.latencies, 0.5))} ms, 95 %: ${number(quantile(numbers.latencies, 0.95))}`);
    facts.set('Server', `${number(numbers.server)} ms`);
    facts.set('Left out below', numbers.truncated ? `${number(numbers.level)} ${clusters ? 'px' : 'px²'}` : 'nothing');
    Object.assign(window.karui, { triangles: numbers.triangles, ready: true });
  }

  private get values(): Readonly<LiveOptions> {
    return this.options?.values ?? ABOUT.defaults;
  }

  private get outside(): boolean {
    const { outside } = this.values;
    return outside === 'room' ? (this.host?.stage.canvas.clientWidth ?? 0) >= ROOM : outside === 'yes';
  }

  /** What tests read and set. */
  private tests(watch: Watch): object {
    return {
      numbers: watch.numbers,
      go: watch.go.bind(watch),
      mesh: () => watch.surface?.mesh(),
      colors: () => watch.surface?.colors(),
      lamp: () => watch.lamp?.position.toArray(),
      path: () => this.recorder?.json(),
      options: asked(this.values),
      setLamp: (around: number, up: number) => this.options?.set({ around, up }),
    };
  }

  private start(): void {
    const { host, file } = this;
    if (!host || !file) return;
    this.recorder?.stop();
    this.watch?.close();
    this.options?.forget();
    this.colouring?.close();
    this.colouring = null;
    Object.assign(window.karui, { ready: false });
    this.facts.clear();
    this.watch = new Watch(host, `files/${file.id}/live?kind=${this.values.kind}`, this);
    this.recorder = new Recorder(this.watch, file.name);
    host.panel.replaceChildren(...this.controls());
  }

  /** The options have changed, by whatever. */
  private follow(names: ReadonlySet<keyof LiveOptions>): void {
    const { watch } = this;
    if (names.has('kind')) return this.start();
    if (!watch?.lamp) return;
    this.light();
    this.paint();
    if (names.has('outside')) watch.look(this.outside);
    Object.assign(window.karui['live'] as object, { options: asked(this.values) });
    if ([...names].some((name) => !LOOKS.has(name))) watch.ask();
  }

  private light(): void {
    const { around, up, away, lit } = this.values;
    if (!this.watch) return;
    this.watch.lit = lit;
    this.watch.lamp?.at(around, up, away);
  }

  private paint(): void {
    const { flat, wire, colors } = this.values;
    const painted = this.colouring !== null && colors !== 'clay';
    this.colouring?.show(colors as Colors);
    this.watch?.paint(flat, wire, painted);
  }

  private controls(): HTMLElement[] {
    const { kind } = this.values;
    return [
      part('Hierarchy', this.choice('Hierarchy', 'kind', [['half-edge', 'Half-edges'], ['clusters', 'Clusters']]), this.facts.element),
      part('What is kept', ...this.kept(kind as Which)),
      part('Budget', ...this.limit('limit_triangles', 'triangles', TRIANGLES), ...(kind === 'half-edge' ? this.limit('limit_time', 'milliseconds', TIME) : [])),
      part('Light', this.options!.box('lit', 'Light counts'), ...lampControls(this.options!)),
      part('View', ...this.views(kind as Which)),
      part('Camera path', this.recorder!.element),
    ];
  }

  private choice(label: string, name: 'kind' | 'colors', words: readonly (readonly [string, string])[]): HTMLElement {
    const options = this.options!;
    const choice = new Choice<string>(label, words, (value) => options.set({ [name]: value }));
    return options.control(choice.element, () => choice.set(options.values[name]));
  }

  private kept(which: Which): HTMLElement[] {
    const options = this.options!;
    type Numbers = keyof (typeof KNOBS)['half-edge'] | keyof (typeof KNOBS)['clusters'];
    const knobs = Object.entries(KNOBS[which]) as [Numbers, Knob][];
    const hidden = which === 'clusters' ? 'Left out' : 'Coarse';
    return [
      ...knobs.map(([name, knob]) => options.slider(name, knob)),
      options.box(`${which}.frustum`, `${hidden} outside the picture`),
      options.box(`${which}.back_facing`, `${hidden} where it faces away`),
    ];
  }

  private limit(on: 'limit_triangles' | 'limit_time', name: 'triangles' | 'milliseconds', knob: Knob): HTMLElement[] {
    return [this.options!.box(on, name === 'triangles' ? 'Limit triangles' : 'Limit time'), this.options!.slider(name, knob)];
  }

  private views(which: Which): HTMLElement[] {
    const options = this.options!;
    const colors = this.choice('Colours', 'colors', [['clay', 'Clay'], ['cluster', 'Clusters'], ['level', 'Levels']]);
    return [
      this.outsideBox(),
      options.box('flat', 'Flat'),
      options.box('wire', 'Wireframe'),
      ...(which === 'clusters' ? [colors] : []),
    ];
  }

  private outsideBox(): HTMLElement {
    const [element, box] = check('Second window from outside', 'O', (on) => this.options?.set({ outside: on ? 'yes' : 'no' }));
    return this.options!.control(element, () => (box.checked = this.outside));
  }
}

export const live: Mode = new Live();
