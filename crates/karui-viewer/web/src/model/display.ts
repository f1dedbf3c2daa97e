// What is in the panes: a level, the original beside it, painted as the state says.

import { Box3, type Group, Scene, Vector3 } from 'three';
import * as api from '../api';
import type { Host } from '../mode';
import type { State } from '../state';
import { Shelf, triangles } from '../view/load';
import { dispose, paint, twin } from '../view/paint';
import { mirrors, surround } from '../view/room';
import { choose } from './choose';

/** Heat maps that are pictures over the model rather than colours of its vertices. */
export const FLIP = 'flip';

export class Display {
  /** The level that is shown; -1 for none yet. */
  level = -1;
  /** Triangles of it. */
  triangles = 0;
  /** Heat map that it is shown with, or none; FLIP is none. */
  heat = '';
  /** Called with how far the heat map is that is waited for, and with nothing once none is. */
  readonly waits = new Set<(report: api.JobReport | undefined) => void>();
  /** Called when another level is shown, or the same one painted otherwise. */
  readonly shown = new Set<() => void>();
  readonly box: Box3;
  private readonly shelf = new Shelf();
  private readonly front = new Scene();
  private readonly back = new Scene();
  private asked = '';
  private request = 0;
  /** The heat map that is waited for. */
  private wait: { path: string; abort: AbortController } | undefined;
  /** Groups on the screen that are not on the shelf any more. */
  private readonly gone = new Set<Group>();

  constructor(
    private readonly host: Host,
    public file: api.ModelSummary,
  ) {
    const { min, max } = file.bounds;
    this.box = new Box3(new Vector3(...min), new Vector3(...max));
  }

  get state(): Readonly<State> {
    return this.host.store.state;
  }

  /** Distance of the eye from the nearest point of the model's box, model units. */
  distance(): number {
    return this.box.distanceToPoint(this.host.stage.camera.position);
  }

  /** The level that the state asks for, seen from here. */
  wanted(): number {
    const { auto, level, tolerance, budget } = this.state;
    const { levels } = this.file;
    if (!auto) return Math.min(level, levels.length - 1);
    return choose(levels, this.distance(), this.host.stage.pixelsPerRadian, tolerance, budget);
  }

  /** Brings the panes up to date; of several calls, the last one counts. */
  async update(): Promise<void> {
    const level = this.wanted();
    const { compare } = this.state;
    const key = `${this.path(level)} ${compare}`;
    if (key === this.asked) return this.repaint();
    this.asked = key;
    const request = ++this.request;
    const { heat } = this.state;
    const paths = [this.path(level), ...(compare === 'off' ? [] : [this.path(0)])];
    if (this.wait && !paths.includes(this.wait.path)) this.stop();
    try {
      const [front, back] = await this.fetch(paths, request);
      if (request !== this.request || !front) return;
      this.put(front, back);
      this.level = level;
      this.heat = heat === FLIP ? '' : heat;
      this.triangles = triangles(front);
      this.repaint();
      if (!this.front.environment && mirrors(front)) this.furnish();
    } catch (error) {
      // What was broken off nobody waits for.
      if (request !== this.request) return;
      this.asked = '';
      throw error;
    }
  }

  /** Breaks off the heat map that is waited for. */
  stop(): void {
    this.wait?.abort.abort();
    this.wait = undefined;
    this.waits.forEach((call) => call(undefined));
  }

  /** Other levels have been made of the same model. */
  async renew(file: api.ModelSummary): Promise<void> {
    this.file = file;
    this.asked = '';
    this.request += 1;
    this.stop();
    await this.shelf.clear((group) => this.free(group));
    await this.update();
  }

  async close(): Promise<void> {
    this.request += 1;
    this.stop();
    this.host.stage.panes = [];
    await this.shelf.clear(dispose);
  }

  /** How much of the canvas shows the original. */
  arrange(): void {
    const { compare, wipe } = this.state;
    const [side, cut] = { off: [0, true], side: [0.5, false], wipe: [wipe, true] }[compare] as [number, boolean];
    const panes = [{ scene: this.front, from: side, to: 1, cut }];
    if (side > 0) panes.unshift({ scene: this.back, from: 0, to: side, cut });
    this.host.stage.panes = panes;
    this.host.stage.invalidate();
  }

  /** Plain levels at once, heat maps one after the other: each keeps the server busy. */
  private async fetch(paths: string[], request: number): Promise<Group[]> {
    const { heat } = this.state;
    if (heat === '' || heat === FLIP) return Promise.all(paths.map((path) => this.shelf.get(path)));
    const groups: Group[] = [];
    for (const path of paths) {
      if (request !== this.request) break;
      groups.push(await this.shelf.get(path, (missing) => this.heated(missing)));
    }
    return groups;
  }

  private async heated(path: string): Promise<ArrayBuffer> {
    const wait = (this.wait = { path, abort: new AbortController() });
    const tell = (report: api.JobReport | undefined) => this.waits.forEach((call) => call(report));
    tell({ state: 'running', stage: 'starting', fraction: 0 });
    try {
      return await api.heat(path, { signal: wait.abort.signal, tell });
    } finally {
      if (this.wait === wait) {
        this.wait = undefined;
        tell(undefined);
      }
    }
  }

  private path(level: number): string {
    const { heat } = this.state;
    const plain = heat === '' || heat === FLIP;
    return plain ? api.levelPath(this.file.id, level) : api.heatPath(this.file.id, heat, level);
  }

  private put(front: Group, back: Group | undefined): void {
    const show = (scene: Scene, group: Group | undefined) => {
      for (const old of scene.children.filter((c): c is Group => c.type === 'Group' && c !== group)) {
        scene.remove(old);
        if (this.gone.delete(old)) dispose(old);
      }
      if (group) scene.add(group);
    };
    show(this.front, front);
    show(this.back, back === front ? twin(front) : back);
  }

  private repaint(): void {
    const { look, flat, wire } = this.state;
    const finish = { look, flat, wire, heat: this.heat !== '' };
    for (const scene of [this.front, this.back]) paint(scene, finish);
    this.arrange();
    for (const call of [...this.shown]) call();
  }

  /** After the first picture, which is to come at once. */
  private furnish(): void {
    setTimeout(() => {
      for (const scene of [this.front, this.back]) surround(scene, this.host.stage.renderer);
      this.host.stage.invalidate();
    }, 50);
  }

  /** What is on the screen stays until there is something else to show. */
  private free(group: Group): void {
    if (group.parent) this.gone.add(group);
    else dispose(group);
  }
}
