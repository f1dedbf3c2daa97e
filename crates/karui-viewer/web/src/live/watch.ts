// What live modes share: a socket, the triangles it tells of, a second window, a lamp.

import './style.css';
import { Box3, Mesh, Scene, Vector3 } from 'three';
import type { Host } from '../mode';
import { FOV } from '../view/stage';
import { clay, colored } from '../view/paint';
import { Lamp } from './lamp';
import { Link, type Ready } from './link';
import { Outside } from './outside';
import { type Frame, TRUNCATED } from './protocol';
import { Surface } from './surface';

/** A frame of a path, as `karui hierarchy refine --path` reads it. */
export interface PathFrame {
  camera: { eye: number[]; target: number[]; fov: number };
  lights: { type: 'point'; position: number[]; intensity: number }[];
}

/** What is known of the last answer and those before. */
export interface Numbers {
  triangles: number;
  slots: number;
  bytes: number;
  /** Of the last 200 answers, milliseconds: from the request to the answer. */
  latencies: number[];
  /** Time the server took, milliseconds. */
  server: number;
  changes: [number, number];
  level: number;
  truncated: boolean;
  answers: number;
}

/** What a mode adds. */
export interface Asker {
  /** Options and budget of the next request. */
  ask(): object;
  ready(about: Ready): void;
  /** What the server is at, before it is ready. */
  progress(message: string): void;
  answered(numbers: Numbers): void;
  /** The lamp was dragged. */
  lampMoved(): void;
}

export class Watch {
  readonly scene = new Scene();
  readonly numbers: Numbers = {
    triangles: 0, slots: 0, bytes: 0, latencies: [], server: 0, changes: [0, 0], level: 0, truncated: false, answers: 0,
  };
  lamp: Lamp | null = null;
  surface: Surface | null = null;
  /** Called with every frame that is asked for. */
  onask: ((frame: PathFrame) => void) | null = null;
  lit = true;
  private asking = false;
  private readonly link: Link;
  private outside: Outside | null = null;
  private mesh: Mesh | null = null;
  private readonly waiting: ((numbers: Numbers) => void)[] = [];
  private readonly moved = () => this.ask();

  constructor(
    private readonly host: Host,
    path: string,
    private readonly asker: Asker,
  ) {
    this.scene.userData['lit'] = true;
    host.stage.panes = [{ scene: this.scene, from: 0, to: 1, cut: false }];
    this.link = new Link(path, {
      ready: (about) => this.begin(about),
      progress: (stage, fraction) => asker.progress(`${stage} ${Math.round(100 * fraction)} %`),
      frame: (frame, latency) => this.take(frame, latency),
      error: (message) => this.failed(message),
    });
  }

  close(): void {
    this.link.close();
    this.host.stage.moved.delete(this.moved);
    this.look(false);
    this.lamp?.dispose();
    this.lamp = null;
    this.surface?.dispose();
    this.host.stage.panes = [];
  }

  /** Asks for what is seen then, once all that is to change now has. */
  ask(): void {
    if (!this.lamp || this.asking) return;
    this.asking = true;
    queueMicrotask(() => {
      this.asking = false;
      if (this.lamp) this.askNow();
    });
  }

  private askNow(): void {
    const frame = this.frame();
    this.onask?.(frame);
    this.link.ask({ frame, size: this.size(), ...this.asker.ask() });
  }

  /** Puts the camera there and waits for the answer. */
  go(frame: PathFrame): Promise<Numbers> {
    const { eye, target } = frame.camera;
    const light = frame.lights[0];
    if (light) this.lamp?.set(new Vector3().fromArray(light.position));
    return new Promise((resolve) => {
      this.waiting.push(resolve);
      this.host.stage.setPose([...eye, ...target]);
      this.ask();
    });
  }

  /** Opens or closes the second window. */
  look(outside: boolean): void {
    const { stage, overlay } = this.host;
    this.outside?.dispose();
    this.outside = outside ? new Outside(stage, this.scene, overlay) : null;
    const first = { scene: this.scene, from: 0, to: outside ? 0.5 : 1, cut: false };
    const second = this.outside && { scene: this.scene, from: 0.5, to: 1, cut: false, camera: this.outside.camera };
    stage.panes = second ? [first, second] : [first];
    stage.invalidate();
    this.ask();
  }

  /** `painted`: in the colours of the vertices rather than in clay. */
  paint(flat: boolean, wire: boolean, painted = false): void {
    if (!this.mesh) return;
    this.mesh.material = painted ? colored(flat) : clay(flat);
    const edges = this.mesh.children[0];
    if (edges) edges.visible = wire;
    this.host.stage.invalidate();
  }

  /** The edges that are shown over the surface, if they are. */
  edges(object: Mesh['children'][number]): void {
    object.visible = false;
    this.mesh?.add(object);
  }

  private begin(about: Ready): void {
    const { stage } = this.host;
    const bounds = new Box3(new Vector3().fromArray(about.bounds.min), new Vector3().fromArray(about.bounds.max));
    stage.setBounds(bounds);
    this.surface = new Surface(about.slot ?? 0);
    this.mesh = new Mesh(this.surface.geometry, clay(false));
    this.mesh.frustumCulled = false;
    this.scene.add(this.mesh);
    this.lamp = new Lamp(stage, this.scene, stage.bounds.clone(), () => this.asker.lampMoved());
    this.asker.ready(about);
    // After the windows have been laid out: the first one is to show all.
    const { camera } = this.host.store.state;
    if (camera.length === 6) stage.setPose([...camera]);
    else stage.frame();
    stage.moved.add(this.moved);
    this.ask();
  }

  private frame(): PathFrame {
    const { camera, controls } = this.host.stage;
    const lights: PathFrame['lights'] = [];
    if (this.lit && this.lamp) lights.push({ type: 'point', position: this.lamp.position.toArray(), intensity: 1 });
    return { camera: { eye: camera.position.toArray(), target: controls.target.toArray(), fov: FOV }, lights };
  }

  /** Of the first window, device pixels. */
  private size(): [number, number] {
    const { canvas, panes } = this.host.stage;
    const share = panes[0] ? panes[0].to - panes[0].from : 1;
    return [Math.max(1, Math.round(share * canvas.width)), Math.max(1, canvas.height)];
  }

  private take(frame: Frame, latency: number): void {
    this.surface?.apply(frame);
    const { numbers } = this;
    numbers.latencies = [...numbers.latencies.slice(-199), latency];
    Object.assign(numbers, {
      triangles: frame.triangles, slots: frame.slots, bytes: frame.bytes, server: frame.microseconds / 1000,
      changes: frame.changes, level: frame.level, truncated: (frame.flags & TRUNCATED) !== 0, answers: numbers.answers + 1,
    });
    this.host.stage.invalidate();
    this.asker.answered(numbers);
    if (this.link.idle) for (const resolve of this.waiting.splice(0)) resolve(numbers);
  }

  private failed(message: string): void {
    this.host.say(message, 'error');
    for (const resolve of this.waiting.splice(0)) resolve(this.numbers);
  }
}

/** The value that a share of all does not exceed. */
export function quantile(values: readonly number[], share: number): number {
  const sorted = [...values].sort((a, b) => a - b);
  return sorted[Math.round(share * (sorted.length - 1))] ?? 0;
}
