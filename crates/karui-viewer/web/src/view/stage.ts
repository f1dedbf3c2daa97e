// The canvas: one or more panes, drawn when something has changed.

import { Box3, MathUtils, PerspectiveCamera, Scene, Sphere, Vector3, WebGLRenderer } from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { Rig } from './rig';

/** A part of the canvas. */
export interface Pane {
  scene: Scene;
  /** From where to where across the canvas, 0 to 1. */
  from: number;
  to: number;
  /** Whether the picture is as wide as the canvas and cut off, rather than as wide as the pane. */
  cut: boolean;
  /** An eye of its own; the stage's without. */
  camera?: PerspectiveCamera;
}

export const FOV = 40;
const START = new Vector3(0.55, 0.35, 1).normalize();

export class Stage {
  readonly canvas: HTMLCanvasElement;
  readonly renderer: WebGLRenderer;
  readonly camera = new PerspectiveCamera(FOV, 1, 0.01, 100);
  readonly controls: OrbitControls;
  /** Around what is shown. */
  readonly bounds = new Sphere(new Vector3(), 1);
  /** Around what is shown besides, and is not to be clipped either. */
  readonly besides = new Set<Sphere>();
  panes: Pane[] = [];
  /** Called before every picture. */
  readonly before = new Set<() => void>();
  /** Called once the camera has been moved, by whatever. */
  readonly moved = new Set<() => void>();
  /** Pictures drawn so far. */
  frames = 0;
  private readonly rig = new Rig();
  private pending = 0;

  constructor(private readonly place: HTMLElement) {
    this.renderer = new WebGLRenderer({ antialias: true, powerPreference: 'high-performance' });
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.setClearColor(0x16181c);
    this.canvas = this.renderer.domElement;
    this.canvas.tabIndex = 0;
    this.canvas.setAttribute('role', 'img');
    this.canvas.setAttribute('aria-label', 'The model. Arrow keys turn it, plus and minus zoom.');
    this.canvas.addEventListener('keydown', (event) => this.key(event));
    this.canvas.addEventListener('webglcontextrestored', () => this.invalidate());
    place.prepend(this.canvas);
    this.controls = new OrbitControls(this.camera, this.canvas);
    this.controls.addEventListener('change', () => this.changed());
    new ResizeObserver(() => this.resize()).observe(place);
    this.resize();
  }

  /** Asks for a picture. */
  invalidate(): void {
    this.pending ||= requestAnimationFrame(() => this.draw());
  }

  /** What a length of 1 at a distance of 1 is on the screen, CSS pixels. */
  get pixelsPerRadian(): number {
    return this.place.clientHeight / (2 * Math.tan(MathUtils.degToRad(FOV) / 2));
  }

  /** Takes what is inside a box for the whole, without moving the camera. */
  setBounds(box: Box3): void {
    box.getBoundingSphere(this.bounds);
    this.bounds.radius = Math.max(this.bounds.radius, 1e-9);
    this.controls.minDistance = this.bounds.radius * 1e-3;
    this.controls.maxDistance = this.bounds.radius * 500;
  }

  /** Shows the whole from the front, a little from above. */
  frame(): void {
    const narrow = Math.min(1, this.aspect());
    const distance = (0.98 * this.bounds.radius) / (Math.sin(MathUtils.degToRad(FOV) / 2) * narrow);
    this.camera.position.copy(this.bounds.center).addScaledVector(START, distance);
    this.controls.target.copy(this.bounds.center);
    this.controls.update();
    this.changed();
  }

  /** Eye and target. */
  pose(): number[] {
    return [...this.camera.position.toArray(), ...this.controls.target.toArray()];
  }

  setPose(pose: number[]): void {
    this.camera.position.fromArray(pose);
    this.controls.target.fromArray(pose, 3);
    this.controls.update();
    this.changed();
  }

  /** Width by height of the first pane. */
  aspect(): number {
    const pane = this.panes[0];
    const share = pane && !pane.cut ? pane.to - pane.from : 1;
    return (share * this.place.clientWidth) / Math.max(1, this.place.clientHeight);
  }

  private changed(): void {
    this.invalidate();
    for (const call of [...this.moved]) call();
  }

  private resize(): void {
    const { clientWidth, clientHeight } = this.place;
    if (clientWidth === 0 || clientHeight === 0) return;
    this.renderer.setSize(clientWidth, clientHeight, false);
    // At once: a canvas that was resized is empty.
    this.draw();
  }

  private draw(): void {
    cancelAnimationFrame(this.pending);
    this.pending = 0;
    for (const call of [...this.before]) call();
    const { clientWidth: width, clientHeight: height } = this.place;
    const { renderer } = this;
    renderer.setScissorTest(false);
    renderer.clear();
    renderer.setScissorTest(true);
    for (const pane of this.panes) {
      const camera = pane.camera ?? this.camera;
      const [x, w] = [Math.round(pane.from * width), Math.round((pane.to - pane.from) * width)];
      if (w < 1) continue;
      renderer.setScissor(x, 0, w, height);
      renderer.setViewport(pane.cut ? 0 : x, 0, pane.cut ? width : w, height);
      this.aim(camera, (pane.cut ? width : w) / Math.max(1, height));
      this.rig.light(pane.scene, camera);
      renderer.render(pane.scene, camera);
    }
    this.frames += 1;
  }

  private aim(camera: PerspectiveCamera, aspect: number): void {
    const { center, radius } = this.bounds;
    const distance = camera.position.distanceTo(center);
    camera.aspect = aspect;
    camera.near = Math.max(distance - 1.5 * radius, 1e-3 * radius, 1e-4 * distance);
    camera.far = distance + 1.5 * radius;
    camera.updateMatrixWorld();
    for (const sphere of this.besides) {
      const depth = -sphere.center.clone().applyMatrix4(camera.matrixWorldInverse).z;
      if (depth + sphere.radius < 1e-3 * radius) continue;
      camera.near = Math.min(camera.near, Math.max(depth - sphere.radius, 1e-3 * radius));
      camera.far = Math.max(camera.far, depth + sphere.radius);
    }
    camera.updateProjectionMatrix();
  }

  private key(event: KeyboardEvent): void {
    const turn = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
    const zoom = { '+': 0.8, '=': 0.8, '-': 1.25 }[event.key];
    if ((!turn && !zoom) || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    event.stopPropagation();
    const arm = this.camera.position.clone().sub(this.controls.target);
    if (turn) {
      const [around = 0, over = 0] = turn;
      const polar = Math.acos(MathUtils.clamp(arm.y / arm.length(), -1, 1));
      const to = MathUtils.clamp(polar + over * 0.12, 0.02, Math.PI - 0.02);
      const azimuth = Math.atan2(arm.x, arm.z) + around * 0.12;
      arm.setFromSphericalCoords(arm.length(), to, azimuth);
    }
    arm.multiplyScalar(zoom ?? 1);
    this.camera.position.copy(this.controls.target).add(arm);
    this.controls.update();
    this.changed();
  }
}
