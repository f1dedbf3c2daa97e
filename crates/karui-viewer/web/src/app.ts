// The frame around all modes: bar, picture, panel, strip.

import * as api from './api';
import { h } from './dom';
import type { Host, Mode } from './mode';
import { modes } from './modes';
import { dropping } from './panels/drop';
import { Help } from './panels/help';
import { Toasts } from './panels/toasts';
import { expose } from './probe';
import type { State, Store, Tab } from './state';
import { Stage } from './view/stage';

/** Time between two looks at what other pages have done, ms. */
const LOOK_EVERY = 2000;

export class App implements Host {
  readonly root: HTMLElement;
  readonly stage: Stage;
  readonly panel = h('aside', { class: 'panel', 'aria-label': 'Controls' });
  readonly strip = h('footer', { class: 'strip' });
  readonly overlay = h('div', { class: 'overlay' });
  private readonly toasts = new Toasts();
  private readonly help = new Help();
  private readonly tabs = h('nav', { class: 'tabs', role: 'tablist', 'aria-label': 'Ways to look' });
  private readonly files = h('select', { 'aria-label': 'File', onchange: () => this.pick(Number(this.files.value)) });
  private mode: Mode | undefined;
  private file: api.Summary | undefined;
  private entering = 0;
  private looking = false;

  constructor(readonly store: Store) {
    const place = h('main', { class: 'stage' }, this.overlay, this.toasts.element);
    this.root = h('div', { class: 'app' }, this.bar(), place, this.panel, this.strip);
    this.stage = new Stage(place);
    this.stage.moved.add(() => store.set({ camera: this.stage.pose() }));
    store.subscribe((state, changed) => this.follow(state, changed));
    document.addEventListener('keydown', (event) => this.key(event));
    dropping(this.root, (file) => this.take(file));
    expose(this);
  }

  /** Shows what the address asks for, of the files there are. */
  async start(state: api.ServerState): Promise<void> {
    this.list(state);
    setInterval(() => void this.look(), LOOK_EVERY);
    if (state.files.length === 0) return this.say('Drop a model on this page.');
    const { file } = this.store.state;
    if (!state.files.some((f) => f.id === file)) this.store.set({ file: state.files[0]!.id });
    await this.reload();
  }

  say(message: string, kind: 'note' | 'error' = 'note'): void {
    this.toasts.say(message, kind);
  }

  fail(error: unknown): void {
    this.say(error instanceof Error ? error.message : String(error), 'error');
  }

  async reload(): Promise<void> {
    const entry = ++this.entering;
    const file = await api.summary(this.store.state.file);
    if (entry !== this.entering) return;
    this.file = file;
    document.title = `${file.name} - Karui`;
    const open = modes.filter((m) => m.accepts(file));
    const mode = open.find((m) => m.tab === this.store.state.tab) ?? open[0];
    this.mode?.leave();
    this.mode = mode;
    for (const part of [this.panel, this.strip, this.overlay]) part.replaceChildren();
    this.showTabs(open, mode?.tab);
    if (!mode) return this.say(`${file.name} cannot be shown here.`, 'error');
    this.store.set({ tab: mode.tab });
    await mode.enter(this, file);
  }

  get keys(): readonly (readonly [string, string])[] {
    return this.mode?.keys ?? [];
  }

  get current(): Mode | undefined {
    return this.mode;
  }

  private bar(): HTMLElement {
    const copy = h('button', { type: 'button', title: 'Copy a link to this view (S)', onclick: () => void this.share() }, 'Link');
    const help = h('button', { type: 'button', class: 'only-large', title: 'Keys (?)', onclick: () => this.help.open(this.keys) }, 'Keys');
    const input = h('input', { type: 'file', hidden: true, onchange: () => input.files?.[0] && this.take(input.files[0]) });
    const open = h('button', { type: 'button', title: 'Open a model; or drop it on the page', onclick: () => input.click() }, 'Open');
    const sheet = h('button', { type: 'button', class: 'only-small', 'aria-expanded': 'false', onclick: () => this.toggle(sheet) }, 'Controls');
    return h('header', { class: 'bar' }, h('h1', {}, 'Karui'), this.files, this.tabs, h('span', { class: 'space' }), open, input, copy, help, sheet);
  }

  /** Levels and files of other pages of this server. */
  private async look(): Promise<void> {
    if (document.hidden || this.looking) return;
    this.looking = true;
    try {
      const state = await api.state();
      if (state.files.length !== this.files.options.length) this.list(state);
      const version = state.files[this.file?.id ?? -1]?.version;
      if (version !== undefined) await this.mode?.refresh?.(version);
    } catch {
      // Whoever asks for something is told that there is no answer.
    } finally {
      this.looking = false;
    }
  }

  private toggle(button: HTMLElement): void {
    const open = this.root.classList.toggle('sheet');
    button.setAttribute('aria-expanded', String(open));
  }

  private list(state: api.ServerState): void {
    this.files.replaceChildren(...state.files.map((f) => h('option', { value: String(f.id) }, f.name)));
    this.files.value = String(this.store.state.file);
    this.files.hidden = state.files.length < 1;
  }

  private showTabs(open: readonly Mode[], tab: Tab | undefined): void {
    const button = (mode: Mode) => {
      const own = { role: 'tab', type: 'button', 'aria-selected': String(mode.tab === tab) };
      return h('button', { ...own, onclick: () => this.store.set({ tab: mode.tab }) }, mode.label);
    };
    this.tabs.replaceChildren(...(open.length > 1 ? open.map(button) : []));
  }

  private follow(state: Readonly<State>, changed: ReadonlySet<keyof State>): void {
    const other = changed.has('file') || (changed.has('tab') && state.tab !== this.mode?.tab);
    if (other && this.file) {
      this.files.value = String(state.file);
      this.reload().catch((error: unknown) => this.fail(error));
    } else if (changed.has('camera') && state.camera.length === 6 && String(this.stage.pose()) !== String(state.camera)) {
      this.stage.setPose([...state.camera]);
    }
  }

  private pick(file: number): void {
    this.store.set({ file, level: 0, heat: '', camera: [] });
  }

  private async take(file: File): Promise<void> {
    this.say(`Reading ${file.name} …`);
    try {
      const { id } = await api.upload(file);
      this.list(await api.state());
      this.toasts.clear();
      const first = !this.file;
      this.pick(id);
      if (first) await this.reload();
    } catch (error) {
      this.toasts.clear();
      this.fail(error);
    }
  }

  private async share(): Promise<void> {
    const link = this.store.link();
    try {
      await navigator.clipboard.writeText(link);
      this.say('The link is copied. It works while this viewer runs.');
    } catch {
      this.say(link);
    }
  }

  private key(event: KeyboardEvent): void {
    const target = event.target as HTMLElement;
    const typing = target.matches('input:not([type=checkbox],[type=range],[type=file]), select, textarea');
    if (typing || event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented) return;
    if (this.common(event.key) || this.mode?.key?.(event)) event.preventDefault();
  }

  private common(key: string): boolean {
    if (key === '?') this.help.open(this.keys);
    else if (key === 's') void this.share();
    else if (key === 'r') this.stage.frame();
    else return false;
    return true;
  }
}
