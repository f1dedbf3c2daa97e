// One model: its levels, how it is looked at, how levels are made.

import type * as api from '../api';
import * as server from '../api';
import { section } from '../dom';
import type { Host, Mode } from '../mode';
import { Files } from '../panels/files';
import { HeatPanel } from '../panels/heat';
import { Labels } from '../panels/labels';
import { LevelsPanel } from '../panels/levels';
import { LookPanel } from '../panels/look';
import { MakePanel } from '../panels/make';
import { StatsPanel } from '../panels/stats';
import { Strip } from '../panels/strip';
import type { State } from '../state';
import { Display } from './display';
import { FlipLayer } from './flip';
import { keys, press } from './keys';

/** Models up to this size get levels without being asked, triangles. */
const AT_ONCE = 300_000;

export class ModelMode implements Mode {
  readonly tab = 'model';
  readonly label = 'Model';
  readonly keys = keys;
  private host: Host | undefined;
  private display: Display | undefined;
  private make: MakePanel | undefined;
  private leaving: (() => void)[] = [];

  accepts(file: api.Summary): boolean {
    return file.kind === 'model';
  }

  async enter(host: Host, file: api.Summary): Promise<void> {
    if (file.kind !== 'model') return;
    this.host = host;
    const display = (this.display = new Display(host, file));
    this.build(host, display);
    this.listen(host, display);
    host.stage.setBounds(display.box);
    const { camera } = host.store.state;
    if (camera.length === 6) host.stage.setPose([...camera]);
    else host.stage.frame();
    for (const warning of file.warnings.slice(0, 3)) host.say(warning);
    await display.update();
    if (file.levels.length === 1 && file.triangles <= AT_ONCE) this.make?.start();
  }

  leave(): void {
    this.leaving.splice(0).forEach((call) => call());
    void this.display?.close();
    this.make = this.display = this.host = undefined;
  }

  key(event: KeyboardEvent): boolean {
    if (!this.host || !this.display) return false;
    if (event.key === 'm') this.make?.start();
    else return press(event, this.host.store, this.display);
    return true;
  }

  private build(host: Host, display: Display): void {
    const make = (this.make = new MakePanel(host, display, () => this.renew()));
    const heat = new HeatPanel(host, display);
    const strip = new Strip(host, display, () => make.start());
    make.tell.add((line) => strip.work(line));
    const parts = [new LevelsPanel(host, display), new LookPanel(host, display), heat, new StatsPanel(host, display), new Labels(host, display)];
    const flip = new FlipLayer(host, display, (mean) => heat.setMean(mean), (report) => heat.wait(report));
    display.waits.add((report) => heat.wait(report));
    const [levels, look, , stats] = parts.map((part) => part.element);
    host.panel.append(
      section('Levels', levels!),
      section('Look', look!),
      section('Heat map', heat.element),
      section('Numbers', stats!),
      section('Make levels', make.element),
      section('Download', new Files(display).element),
    );
    host.strip.append(strip.element);
    host.overlay.append(flip.element, heat.legend, parts[4]!.element);
    const all = [...parts, strip];
    display.shown.add(() => {
      all.forEach((part) => part.refresh());
      flip.schedule();
      this.expose(display);
    });
    this.leaving.push(() => flip.close(), () => make.close());
  }

  private listen(host: Host, display: Display): void {
    const update = () => display.update().catch((error: Error) => host.say(error.message, 'error'));
    const moved = () => {
      if (host.store.state.auto && display.wanted() !== display.level) void update();
      display.shown.forEach((call) => call());
    };
    const follow = (_: State, changed: ReadonlySet<keyof State>) => {
      if (changed.has('file') || changed.has('tab') || (changed.size === 1 && changed.has('camera'))) return;
      window.karui.ready = false;
      void update();
    };
    host.stage.moved.add(moved);
    this.leaving.push(host.store.subscribe(follow), () => host.stage.moved.delete(moved));
  }

  async refresh(version: number): Promise<void> {
    if (this.display && this.display.file.version !== version) await this.renew();
  }

  private async renew(): Promise<void> {
    const { display, host } = this;
    if (!display || !host) return;
    const file = await server.summary(display.file.id);
    if (file.kind !== 'model' || display !== this.display) return;
    await display.renew(file);
  }

  private expose(display: Display): void {
    const { level, triangles } = display;
    Object.assign(window.karui, { level, triangles, levels: display.file.levels, ready: level === display.wanted() });
  }
}
