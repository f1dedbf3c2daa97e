// The second window: the same triangles from elsewhere, with the first one's frustum.

import { CameraHelper, Color, PerspectiveCamera, type Scene, Vector3 } from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { h } from '../dom';
import { FOV, type Stage } from '../view/stage';

/** Layer of what only the second window shows. */
const LAYER = 1;

export class Outside {
  readonly camera = new PerspectiveCamera(FOV, 1, 0.01, 100);
  /** Takes what is dragged over the second window. */
  private readonly pad = h('div', { class: 'outside', tabIndex: 0, 'aria-label': 'The same triangles from outside. Drag to turn.' });
  private readonly controls: OrbitControls;
  private readonly helper: CameraHelper;
  private readonly update = () => this.refresh();
  /** Whether it goes along with the eye: until it is turned by hand. */
  private follows = true;

  constructor(
    private readonly stage: Stage,
    private readonly scene: Scene,
    overlay: HTMLElement,
  ) {
    this.camera.layers.enable(LAYER);
    this.helper = new CameraHelper(stage.camera);
    this.helper.layers.set(LAYER);
    const [edge, axis] = [new Color(0xffb454), new Color(0x4b5261)];
    this.helper.setColors(edge, edge, edge, axis, axis);
    scene.add(this.helper);
    this.pad.append(h('span', {}, 'From outside'));
    overlay.append(this.pad);
    this.controls = new OrbitControls(this.camera, this.pad);
    this.controls.addEventListener('start', () => (this.follows = false));
    this.controls.addEventListener('change', () => stage.invalidate());
    stage.before.add(this.update);
    this.refresh();
  }

  dispose(): void {
    this.stage.before.delete(this.update);
    this.controls.dispose();
    this.pad.remove();
    this.scene.remove(this.helper);
    this.helper.dispose();
  }

  private refresh(): void {
    this.helper.update();
    if (!this.follows) return;
    const { camera, bounds } = this.stage;
    const arm = camera.position.clone().sub(bounds.center).setY(0);
    if (arm.lengthSq() === 0) arm.set(0, 0, 1);
    arm.normalize().applyAxisAngle(new Vector3(0, 1, 0), 1.25).setY(0.45).normalize();
    this.camera.position.copy(bounds.center).addScaledVector(arm, 5.5 * bounds.radius);
    this.camera.lookAt(bounds.center);
    this.controls.target.copy(bounds.center);
  }
}
