// A light that can be dragged.

import {
  Color, type Camera, HemisphereLight, Mesh, MeshBasicMaterial, Plane, PointLight, Raycaster, type Scene, type Sphere,
  SphereGeometry, Vector2, Vector3,
} from 'three';
import type { Stage } from '../view/stage';

export class Lamp {
  private readonly bulb: Mesh<SphereGeometry, MeshBasicMaterial>;
  private readonly light = new PointLight(0xfff4e0);
  private readonly sky = new HemisphereLight(0xf2f5ff, 0x4a4640, 1.0);
  private readonly ray = new Raycaster();
  private readonly plane = new Plane();
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
    this.bulb = new Mesh(new SphereGeometry(0.045 * bounds.radius, 20, 12), material);
    scene.add(this.bulb, this.light, this.sky);
    for (const [name, handler] of Object.entries(this.handlers)) {
      // Before the camera takes it.
      stage.canvas.addEventListener(name, handler as EventListener, { capture: true });
    }
    this.at(-40, 45);
  }

  get position(): Vector3 {
    return this.bulb.position;
  }

  /** Puts it somewhere, model units. */
  set(position: Vector3): void {
    this.bulb.position.copy(position);
    this.light.position.copy(position);
    const distance = Math.max(position.distanceTo(this.bounds.center), 1e-3 * this.bounds.radius);
    // White at the middle of the model, wherever it is.
    this.light.intensity = 3.2 * distance * distance;
    this.stage.invalidate();
  }

  /** Puts it on a sphere around the model, degrees: before the near plane of `Stage`, which is 1.5 radii away. */
  at(azimuth: number, elevation: number): void {
    const [a, e] = [azimuth, elevation].map((x) => (x * Math.PI) / 180) as [number, number];
    const direction = new Vector3(Math.sin(a) * Math.cos(e), Math.sin(e), Math.cos(a) * Math.cos(e));
    this.set(direction.multiplyScalar(1.35 * this.bounds.radius).add(this.bounds.center));
  }

  dispose(): void {
    for (const [name, handler] of Object.entries(this.handlers)) {
      this.stage.canvas.removeEventListener(name, handler as EventListener, { capture: true });
    }
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
