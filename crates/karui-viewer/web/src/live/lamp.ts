// A light that can be dragged.

import {
  Color, type Camera, HemisphereLight, Mesh, MeshBasicMaterial, Plane, PointLight, Raycaster, type Scene, Sphere,
  SphereGeometry, Vector2, Vector3,
} from 'three';
import type { Stage } from '../view/stage';
import type { Knob } from './controls';

/** Where it stands at first, as options: degrees around and up, radii of the model away from its middle. */
export const LAMP = { around: 0, up: 35, away: 1.35 };

/** Size of the bulb, radii of the model. */
const BULB = 0.045;

/** Sliders for where a lamp stands. */
export function lampControls(options: { slider(name: keyof typeof LAMP, knob: Knob): HTMLElement }): HTMLElement[] {
  return [
    options.slider('around', { label: 'Around', unit: '°', from: -180, to: 180, step: 1, value: LAMP.around }),
    options.slider('up', { label: 'Up', unit: '°', from: -90, to: 90, step: 1, value: LAMP.up }),
    options.slider('away', { label: 'Away', unit: 'radii', from: 0.1, to: 20, log: true, value: LAMP.away, hint: 'From the middle of the model' }),
  ];
}

export class Lamp {
  private readonly bulb: Mesh<SphereGeometry, MeshBasicMaterial>;
  private readonly light = new PointLight(0xfff4e0);
  private readonly sky = new HemisphereLight(0xf2f5ff, 0x4a4640, 1.0);
  private readonly ray = new Raycaster();
  private readonly plane = new Plane();
  /** What is not to be clipped of it. */
  private readonly extent = new Sphere();
  private dragged = false;
  private readonly handlers = {
    pointerdown: (event: PointerEvent) => this.down(event),
    pointermove: (event: PointerEvent) => this.move(event),
    pointerup: () => this.up(),
    pointercancel: () => this.up(),
  };

  constructor(
    private readonly stage: Stage,
    private readonly scene: Scene,
    private readonly bounds: Sphere,
    private readonly moved: () => void,
  ) {
    const material = new MeshBasicMaterial({ color: new Color(0xffd27a) });
    this.bulb = new Mesh(new SphereGeometry(BULB * bounds.radius, 20, 12), material);
    scene.add(this.bulb, this.light, this.sky);
    this.extent.radius = BULB * bounds.radius;
    stage.besides.add(this.extent);
    for (const [name, handler] of Object.entries(this.handlers)) {
      // Before the camera takes it.
      stage.canvas.addEventListener(name, handler as EventListener, { capture: true });
    }
    this.at(LAMP.around, LAMP.up, LAMP.away);
  }

  get position(): Vector3 {
    return this.bulb.position;
  }

  /** Puts it somewhere, model units. */
  set(position: Vector3): void {
    this.bulb.position.copy(position);
    this.light.position.copy(position);
    this.extent.center.copy(position);
    const distance = Math.max(position.distanceTo(this.bounds.center), 1e-3 * this.bounds.radius);
    // White at the middle of the model, wherever it is.
    this.light.intensity = 3.2 * distance * distance;
    this.stage.invalidate();
  }

  /** Puts it around the model: degrees, and radii of the model from its middle. */
  at(around: number, up: number, away: number): void {
    const [a, e] = [around, up].map((x) => (x * Math.PI) / 180) as [number, number];
    const direction = new Vector3(Math.sin(a) * Math.cos(e), Math.sin(e), Math.cos(a) * Math.cos(e));
    this.set(direction.multiplyScalar(away * this.bounds.radius).add(this.bounds.center));
  }

  /** Where it is, as `at` takes it. */
  place(): typeof LAMP {
    const { x, y, z } = this.position.clone().sub(this.bounds.center).divideScalar(this.bounds.radius);
    const away = Math.hypot(x, y, z);
    const degrees = (angle: number) => (angle * 180) / Math.PI;
    return { around: degrees(Math.atan2(x, z)), up: away > 0 ? degrees(Math.asin(y / away)) : 0, away };
  }

  dispose(): void {
    for (const [name, handler] of Object.entries(this.handlers)) {
      this.stage.canvas.removeEventListener(name, handler as EventListener, { capture: true });
    }
    this.stage.besides.delete(this.extent);
    this.scene.remove(this.bulb, this.light, this.sky);
    this.bulb.geometry.dispose();
    this.bulb.material.dispose();
  }

  private aim(event: PointerEvent): Camera {
    const { canvas, camera, panes } = this.stage;
    const rect = canvas.getBoundingClientRect();
    const pane = panes[0] ?? { from: 0, to: 1 };
    const width = rect.width * (pane.to - pane.from);
    const x = (event.clientX - rect.left - rect.width * pane.from) / width;
    const y = (event.clientY - rect.top) / rect.height;
    this.ray.setFromCamera(new Vector2(2 * x - 1, 1 - 2 * y), camera);
    return camera;
  }

  private down(event: PointerEvent): void {
    const camera = this.aim(event);
    if (this.ray.intersectObject(this.bulb).length === 0) return;
    event.stopImmediatePropagation();
    this.stage.canvas.setPointerCapture(event.pointerId);
    const towards = camera.getWorldDirection(new Vector3());
    this.plane.setFromNormalAndCoplanarPoint(towards, this.bulb.position);
    this.dragged = true;
  }

  private move(event: PointerEvent): void {
    if (!this.dragged) return;
    event.stopImmediatePropagation();
    this.aim(event);
    const hit = this.ray.ray.intersectPlane(this.plane, new Vector3());
    if (!hit) return;
    this.set(hit);
    this.moved();
  }

  private up(): void {
    this.dragged = false;
  }
}
